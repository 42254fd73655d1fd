"""What a listener gets: everything within seconds without asking, and a log that plays back."""
import signal
import subprocess
import time

import lcm
import pytest
from link import CABLE_URL
from server import SCENES, run_tumble
from wire import Wire


def test_a_late_joiner_is_complete_in_time(start):
    """Every body's description within 2 s and its state within 1 s, without asking."""
    start("--demo", "pile")
    time.sleep(3.0)
    late = Wire()
    began = time.monotonic()
    first = late.next("STATE", 2.0)
    known = set()

    def states_complete():
        known.update(i for m in late.heard["STATE"] for i in m.id[:m.n])
        late.heard["STATE"].clear()
        return len(known) >= first.num_bodies
    late.wait(states_complete, 1.0 - (time.monotonic() - began), "the state of every body")
    bodies = late.bodies(2.0 - (time.monotonic() - began))
    assert len(bodies) == first.num_bodies >= 1000
    assert {index for index, _, _ in bodies.values()} == known


def test_messages_keep_to_the_payload_limit(start, wire, tmp_path):
    log = tmp_path / "limit.log"
    with subprocess.Popen(["lcm-logger", "--quiet", log]) as logger:
        start("--demo", "pile", "--lcm-url", CABLE_URL)
        limit = wire.next("HEARTBEAT", 10.0).payload_limit
        wire.listen(1.0)
        logger.send_signal(signal.SIGINT)
    assert limit == 1400
    sizes = [len(event.data) for event in lcm.EventLog(str(log))]
    assert len(sizes) > 100 and max(sizes) <= limit


def test_log_plays_back_whole(start, tmp_path):
    log = tmp_path / "run.log"
    with subprocess.Popen(["lcm-logger", "--quiet", log]) as logger:
        server = start(SCENES / "free.sdf")
        server.wait_for_output("TUMBLE_STATE")
        time.sleep(2.0)
        run_tumble("push", "ball", "--force", 0, 0, 5, "--seconds", 0.1)
        assert server.stop() == 0
        time.sleep(0.5)  # what lcm-logger has received but not yet written is lost when it is told to stop
        logger.send_signal(signal.SIGINT)
    logged = [event.channel for event in lcm.EventLog(str(log)) if event.channel.startswith("TUMBLE_")]
    for channel in ("STATE", "STATS", "CATALOG", "HEARTBEAT", "FORCE", "ACK"):
        assert f"TUMBLE_{channel}" in logged, channel
    heard = []
    listener = lcm.LCM()
    listener.subscribe("TUMBLE_.*", lambda channel, _: heard.append(channel)).set_queue_capacity(100000)
    with subprocess.Popen(["lcm-logplayer", log], stdout=subprocess.DEVNULL) as player:
        while player.poll() is None:
            listener.handle_timeout(100)
    while listener.handle_timeout(100):
        pass
    assert heard == logged


def test_watched_body_has_a_channel(free_bodies, wire):
    index, generation, _ = wire.bodies()["ball"]
    wire.listen_to_body(index)
    wire.ask(wire.control(wire.verb("WATCH"), body=index, generation=generation))
    body = wire.next(f"BODY_{index}")
    assert (body.name, body.id) == ("ball", index)
    wire.ask(wire.control(wire.verb("UNWATCH"), body=index, generation=generation))
    wire.listen(0.2)
    seen = len(wire.heard[f"BODY_{index}"])
    wire.listen(0.5)
    assert len(wire.heard[f"BODY_{index}"]) == seen


def test_stats_agree_with_the_state(free_bodies, wire):
    ball = wire.bodies()["ball"]
    wire.ask(wire.force(body=ball[0], generation=ball[1], force=(0.0, 4.8, 0.0), duration=0.25))
    wire.listen(0.5)
    stats = wire.next("STATS")
    assert list(stats.momentum) == pytest.approx([0.0, 1.2, 0.0], rel=1e-12)
    assert stats.kinetic_energy == pytest.approx(1.2 ** 2 / (2 * ball[2]), rel=1e-12)
    assert stats.commands_applied == 1 and stats.messages_malformed == 0
