"""A force F for a time T changes the momentum of a free body by F T, whichever client asks for it."""
import re

import pytest
from server import run_tumble
from tumble import World
from wire import APPLIED

FORCE = (3.0, -4.0, 12.0)  # [N]
RELATIVE = 1e-12           # measured 2e-15: the round-off of 120 additions


def check_momentum(wire, step, seconds):
    """FORCE acted on the ball from `step` on for `seconds`; afterwards m v is FORCE times them."""
    index, _, mass = wire.bodies()["ball"]
    end = step + seconds / wire.next("HEARTBEAT").dt + 2
    _, velocity, _ = wire.motion(index, condition=lambda m: m.step > end)
    assert [mass * v for v in velocity] == pytest.approx([f * seconds for f in FORCE], rel=RELATIVE)


@pytest.mark.parametrize("seconds", [0.5, 0.1234, 0.0])
def test_wire(free_bodies, wire, seconds):
    index, generation, _ = wire.bodies()["ball"]
    answer = wire.ask(wire.force(body=index, generation=generation, force=FORCE, duration=seconds))
    assert answer.status == APPLIED
    check_momentum(wire, answer.applied_step, seconds or wire.next("HEARTBEAT").dt)  # 0: exactly one step


def test_command_line(free_bodies, wire):
    done = run_tumble("push", "ball", "--force", *FORCE, "--seconds", 0.5)
    assert done.returncode == 0, done.stderr
    check_momentum(wire, int(re.search(r"\(step (\d+)\)", done.stdout).group(1)), 0.5)


def test_python(free_bodies, wire):
    with World() as world:
        answer = world["ball"].push(force=FORCE, seconds=0.5)
    check_momentum(wire, answer.step, 0.5)


def test_force_at_a_point_turns_by_its_lever_arm(free_bodies, wire):
    """One step of F at r changes the angular momentum by r x F dt about the centre of mass, but for the turn of r."""
    index, generation, _ = wire.bodies()["box"]
    wire.ask(wire.control(wire.verb("WATCH"), body=index, generation=generation))
    wire.listen_to_body(index)
    answer = wire.ask(wire.force(body=index, generation=generation, force=(0.0, 0.0, 12.0), point=(0.5, 1.0, 0.0)))
    assert answer.status == APPLIED
    body = wire.next(f"BODY_{index}", condition=lambda m: m.step > answer.applied_step)
    h = wire.next("HEARTBEAT").dt
    # The box, of at least 5 kg m^2, turns under the step's torque and the arm with it: by this angle at its end [rad].
    turn = 0.5 * h * h * 13.5 / 5.0
    assert turn**2 < 1e-9
    assert list(body.angular_momentum) == pytest.approx([12.0 * h, -6.0 * h, 0.0], rel=turn**2, abs=1e-15)


def test_torque_for_a_time(free_bodies, wire):
    """A torque M in W for T changes the world angular momentum by M T, however the body turns meanwhile."""
    index, generation, _ = wire.bodies()["box"]
    wire.ask(wire.control(wire.verb("WATCH"), body=index, generation=generation))
    wire.listen_to_body(index)
    torque = (5.0, -2.0, 3.0)
    answer = wire.ask(wire.force(body=index, generation=generation, torque=torque, duration=0.5))
    end = answer.applied_step + 0.5 / wire.next("HEARTBEAT").dt + 2
    body = wire.next(f"BODY_{index}", condition=lambda m: m.step > end)
    assert list(body.angular_momentum) == pytest.approx([m * 0.5 for m in torque], rel=RELATIVE)
