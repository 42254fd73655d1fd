"""A recorded run can be repeated to the bit, and goes on after any death with nothing accepted lost."""
import random
import re
import shutil
import signal
import subprocess
import time

import lcm
import pytest
from log import Log
from server import CLI, SCENES, Server, run_server, run_tumble
from wire import APPLIED, QUEUED, Wire

PUSH = (0.5, 0.0, 0.0)  # [N], for one step


def replay(path):
    return run_server("--replay", path)


@pytest.fixture(name="recorded", scope="module")
def record_run(tmp_path_factory):
    """A log of a run with pushes, spawns, a removal, pauses, steps, a snapshot, its restoration and a reset."""
    folder, wire = tmp_path_factory.mktemp("recorded"), Wire()
    path = folder / "run.lcm"
    with Server(folder / "server.log", SCENES / "pyramid.sdf", "--accuracy", "fast", "--record", path,
                "--snapshot-interval", 0.5) as server:
        wire.next("HEARTBEAT", 10.0)
        do_everything(wire)
        assert server.stop() == 0
    return path


def do_everything(wire):
    ids = wire.bodies()
    names = sorted(name for name, (_, _, mass) in ids.items() if mass > 0)

    def do(verb, **fields):
        answer = wire.ask(wire.control(wire.verb(verb), **fields))
        assert answer.status == APPLIED, answer.detail
        return answer

    for name in names[:20]:
        wire.ask(wire.force(body=ids[name][0], generation=ids[name][1], force=(0.0, 0.0, 90.0), duration=0.1))
    ball = do("SPAWN", name="late", body_type=1, shape_type=1, size=(0.4, 0.0, 0.0), position=(0.0, 0.0, 9.0))
    later = wire.force(body=ball.body, generation=ball.generation, force=(5.0, 0.0, 0.0), duration=0.2,
                       start_step=ball.applied_step + 200)
    wire.send(later)
    do("SNAPSHOT", name="before")
    do("PAUSE")
    do("STEP", count=300)
    wire.next("HEARTBEAT", 60.0, lambda m: m.paused)
    do("REMOVE", body=ball.body, generation=ball.generation)
    do("STEP", count=20)
    wire.next("HEARTBEAT", 60.0, lambda m: m.paused)
    do("RESTORE", name="before")
    do("STEP", count=100)
    wire.next("HEARTBEAT", 60.0, lambda m: m.paused)
    do("RESET")
    do("RESUME")
    step = wire.next("STATE").step
    wire.next("STATE", 20.0, lambda m: m.step > step + 50)


def test_a_recorded_run_comes_out_the_same(recorded):
    log = Log(recorded)
    sessions = sorted({record.session for record in log.steps})
    assert [session - sessions[0] for session in sessions] == [0, 1, 2]
    assert {"RECORDING", "STEP", "FORCE", "CONTROL", "STATE", "CATALOG", "STATS", "SNAPSHOT"} == set(log.channels)
    done = replay(recorded)
    assert done.returncode == 0, done.stderr
    assert f"{len(log.steps)} steps" in done.stderr and "same" in done.stderr
    assert f"and {len(log.steps) // 120} snapshots" in done.stderr


def flip(path, offset):
    with open(path, "r+b") as file:
        file.seek(offset)
        byte = file.read(1)[0]
        file.seek(offset)
        file.write(bytes([byte ^ 1]))


def test_a_damaged_log_is_read_up_to_the_damage(recorded, tmp_path):
    """One bit of a command's force, one of an event's header. Nothing can be read behind the second; behind the first there
    are snapshots to go on from."""
    data = recorded.read_bytes()
    command = data.index(b"TUMBLE_FORCE") + len("TUMBLE_FORCE") + 100
    header = data.index(b"TUMBLE_STEP", len(data) // 2) - 28
    for name, offset in (("command", command), ("header", header)):
        path = tmp_path / f"{name}.lcm"
        shutil.copy(recorded, path)
        flip(path, offset)
        done = replay(path)
        assert done.returncode == 1, name
        where = int(re.search(r"damaged at byte (\d+)", done.stderr).group(1))
        assert offset - 1000 < where <= offset + 1000, (name, offset, done.stderr)
        assert int(re.search(r"(\d+) steps", done.stderr).group(1)) < len(Log(recorded).steps)
        resumed = run_server("--resume", path, "--steps", 1)
        if name == "command":
            assert resumed.returncode == 0 and "from the snapshot after step" in resumed.stderr, resumed.stderr
        else:
            assert resumed.returncode == 1 and f"head -c {where}" in resumed.stderr
            assert path.stat().st_size == len(data), "nothing was overwritten"


def test_a_cut_log_is_read_to_its_last_step(recorded, tmp_path):
    data = recorded.read_bytes()
    for length in (len(data) - 20, len(data) // 3):
        path = tmp_path / f"{length}.lcm"
        path.write_bytes(data[:length])
        done = replay(path)
        assert done.returncode == 0, done.stderr
        steps = int(re.search(r"(\d+) steps", done.stderr).group(1))
        resumed = run_server("--resume", path, "--steps", 10, "--fast")
        assert resumed.returncode == 0, resumed.stderr
        done_again = re.search(r"from the snapshot after step \d+ (\d+) steps", resumed.stderr)
        assert int(done_again.group(1)) <= 120, "no more than what the last snapshot lacks"
        again = replay(path)
        assert again.returncode == 0 and f"{steps + 10} steps" in again.stderr


def last_snapshot_in(data):
    """Where a piece of it that is larger than 2000 bytes has its channel's name; its last piece can be shorter."""
    at = len(data)
    while True:
        at = data.rindex(b"TUMBLE_SNAPSHOT", 0, at)
        if int.from_bytes(data[at - 4:at], "big") > 2000:  # the length of the data stands before the name
            return at


def test_a_damaged_snapshot_is_told_and_the_one_before_it_taken(recorded, tmp_path):
    path = tmp_path / "snapshot.lcm"
    shutil.copy(recorded, path)
    steps = len(Log(recorded).steps)
    flip(path, last_snapshot_in(path.read_bytes()) + 1000)
    done = replay(path)
    assert done.returncode == 1 and f"{steps} steps" in done.stderr, done.stderr
    assert re.search(r"the snapshot at byte \d+ can't be used: .* is damaged", done.stderr)
    resumed = run_server("--resume", path, "--steps", 10, "--fast")
    assert resumed.returncode == 0, resumed.stderr
    assert "is damaged" in resumed.stderr
    assert 120 <= int(re.search(r"after step \d+ (\d+) steps", resumed.stderr).group(1)) < 240
    assert f"{steps + 10} steps" in replay(path).stderr


def test_another_step_is_named(recorded, tmp_path):
    """A log whose recorded hashes belong to another run."""
    path = tmp_path / "other.lcm"
    data = recorded.read_bytes()
    at = data.index(b"<gravity>") + len("<gravity>")
    end = data.index(b"<", at)
    other = b"0 0 -9.5".ljust(end - at)
    assert len(other) == end - at
    path.write_bytes(data[:at] + other + data[end:])
    done = replay(path)
    # Not the first step: what rests does so under either gravity.
    assert done.returncode == 1 and re.search(r"step \d+ of session", done.stderr)
    assert "first that differs" in done.stderr


def test_what_is_no_recording_is_refused(tmp_path):
    path = tmp_path / "x.lcm"
    path.write_bytes(b"not a log")
    done = replay(path)
    assert done.returncode == 2 and "x.lcm" in done.stderr and "not a log" in done.stderr
    done = run_server("--record", path, "--steps", 1, "--demo", "cradle")
    assert done.returncode == 1 and "exists" in done.stderr and path.read_bytes() == b"not a log"


def test_a_client_records_what_its_world_carries_and_no_other(start, wire, tmp_path):
    path = tmp_path / "bus.lcm"
    start(SCENES / "free.sdf")
    start(SCENES / "free.sdf", "--world", "TUMBLE_TOO")
    wire.next("HEARTBEAT", 10.0)
    with subprocess.Popen([CLI, "record", path], stdout=subprocess.PIPE, text=True) as recorder:
        wire.wait(lambda: path.exists() and path.stat().st_size > 0)
        answer = wire.ask(wire.force(body=wire.bodies()["ball"][0], generation=1, force=PUSH, duration=0.1))
        time.sleep(1.0)  # the whole catalogue in 0.75 s
        recorder.send_signal(signal.SIGINT)
        said = recorder.communicate(timeout=10.0)[0]
        assert recorder.returncode == 0
    events = list(lcm.EventLog(str(path)))
    assert f"{path}: {len(events)} messages" in said
    assert {event.channel for event in events} == {
        f"TUMBLE_{kind}" for kind in ("STATE", "STATS", "CATALOG", "HEARTBEAT", "FORCE", "ACK")}
    assert [force.sequence for force in Log(path).commands] == [answer.sequence]
    again = run_tumble("record", path)
    assert again.returncode == 1 and f"{path}: there is such a file" in again.stderr
    assert list(lcm.EventLog(str(path))) and path.stat().st_size > 0


def test_a_server_that_cannot_start_writes_nothing(tmp_path):
    path = tmp_path / "run.lcm"
    done = run_server("--demo", "cradle", "--record", path, "--steps", 1,
                      wrapper=("unshare", "-n", "sh", "-c", 'ip link set lo up && exec "$@"', "sh"))
    assert done.returncode == 1 and "ip route" in done.stderr and not path.exists()


class Pusher:
    """Pushes a body; like the client libraries it sends every push until that is answered."""

    def __init__(self, wire):
        self.wire, self.read = wire, 0
        self.sent, self.waiting = 0, {}

    def push(self, body, start_step):
        command = self.wire.force(body=body[0], generation=body[1], force=PUSH, start_step=start_step)
        self.waiting[command.sequence] = command
        self.sent += 1
        self.wire.send(command)

    def repeat(self, seconds):
        """Sends again what is not answered, and hears what is."""
        for command in self.waiting.values():
            self.wire.send(command)
        self.wire.listen(seconds)
        for answers in self.wire.heard["ACK"][self.read:]:
            for i in range(answers.n):
                if answers.status[i] == APPLIED:
                    self.waiting.pop(answers.sequence[i], None)
                else:
                    assert answers.status[i] == QUEUED, answers.detail[i]
        self.read = len(self.wire.heard["ACK"])


def test_fifty_deaths_lose_nothing(start, wire, tmp_path):
    """Killed at 50 random moments while a client pushes, and gone on with from the last snapshot: at the end every push
    acted once, and the bits are those of a run that never died, those of each snapshot included."""
    generator, pusher, path = random.Random(3), Pusher(wire), tmp_path / "run.lcm"
    server = start(SCENES / "free.sdf", "--record", path, "--snapshot-interval", 0.05)
    wire.next("HEARTBEAT", 20.0)
    index, generation, mass = wire.bodies()["ball"]
    for _ in range(50):
        deadline = time.monotonic() + generator.uniform(0.0, 0.15)
        while time.monotonic() < deadline:
            late = generator.randrange(99) if generator.random() < 0.5 else -wire.heard["HEARTBEAT"][-1].step
            pusher.push((index, generation), wire.heard["HEARTBEAT"][-1].step + late)
            pusher.repeat(0.005)
        server.process.kill()
        server.process.wait()
        server = start("--resume", path)
        wire.next("HEARTBEAT", 20.0)
    wire.wait(lambda: pusher.repeat(0.05) or not pusher.waiting, 20.0, "the last answer")
    wire.listen(0.6)
    assert server.stop() == 0
    log = Log(path)
    assert len({(c.client, c.sequence) for c in log.commands}) == pusher.sent > 50
    done = run_server("--replay", path)
    assert done.returncode == 0, done.stderr
    assert f"{len(log.steps)} steps with {pusher.sent} commands came out the same" in done.stderr
    assert int(re.search(r"and (\d+) snapshots", done.stderr).group(1)) > 10
    last = next(m for m in reversed(wire.heard["STATE"]) if index in m.id[:m.n])
    speed = last.vx[list(last.id).index(index)]
    assert speed * mass == pytest.approx(pusher.sent * PUSH[0] * log.head.dt, rel=1e-9)
