"""Delay, duplicates and another order, by a relay between the loopbacks of two namespaces."""
import subprocess
import sys
import time

import pytest
from link import Far
from log import Truth
from server import ROOT, SCENES
from tumble import World


@pytest.fixture(name="far", scope="module")
def make_far():
    far = Far()
    yield far
    far.close()


@pytest.fixture(name="relayed")
def start_relay(far):
    """A fifth doubled, a tenth lost, 20 ms away with up to 40 ms more: an order of its own."""
    options = ("--loss", "0.1", "--duplicate", "0.2", "--delay", "0.02", "--jitter", "0.04")
    with subprocess.Popen([sys.executable, ROOT / "tests/network/relay.py", str(far.holder.pid), *options],
                          stdout=subprocess.PIPE, text=True) as relay:
        assert relay.stdout.readline() == "ready\n"
        yield far
        relay.kill()


def test_commands_act_once_each(relayed, start):
    start(SCENES / "free.sdf", wrapper=relayed.far).wait_for_output("TUMBLE_STATE", 20.0)
    with World(timeout=20.0) as world:
        ball, number = world["ball"], 100
        futures = [ball.push(force=(0, 1, 0), wait=False) for _ in range(number)]
        answers = [future.result(30.0) for future in futures]
        end = max(answer.step for answer in answers) + 1
        assert world.wait_for(lambda: ball.state.step > end, 10.0)
        assert ball.velocity[1] * ball.mass == pytest.approx(number * world.heartbeat.dt, rel=1e-12)


def test_lock_step_holds(relayed, start, tmp_path):
    """Each step is answered with the whole state after it, to the bit; time never runs by itself."""
    path = tmp_path / "run.lcm"
    server = start("--demo", "pyramid", "--record", path, "--record-interval", "1e-6", wrapper=relayed.far)
    server.wait_for_output("TUMBLE_STATE", 20.0)
    states = []
    with World(timeout=20.0) as world, world.lock_step():
        step = world.step_count
        for _ in range(10):
            states.append(world.step(3))
            step += 3
            assert states[-1].step == step
        time.sleep(0.3)
        assert world.step_count == step
    assert server.stop() == 0
    history = Truth(path)
    for state in states:
        for index, position in zip(state.ids.tolist(), state.positions.tolist()):
            assert tuple(position) == history.at(index, state.step)
