"""A force F for a time T changes the momentum of a free body by F T, whichever client asks for it."""
import pytest

from server import run_tumble
from wire import APPLIED

FORCE = (3.0, -4.0, 12.0)  # [N]
RELATIVE = 1e-12           # measured 2e-15: the round-off of 120 additions


def dt(wire):
    return wire.next("HEARTBEAT").dt


def momentum_after(wire, name, step, mass):
    """m v of the body from the first state after the step."""
    index = wire.bodies()[name][0]
    _, velocity, _ = wire.motion(index, condition=lambda m: m.step >= step)
    return [mass * v for v in velocity]


@pytest.mark.parametrize("seconds", [0.5, 0.1234, 0.0])
def test_wire(free_bodies, wire, seconds):
    index, generation, mass = wire.bodies()["ball"]
    h = dt(wire)
    answer = wire.ask(wire.force(body=index, generation=generation, force=FORCE, duration=seconds))
    assert answer.status == APPLIED
    acting = seconds or h  # 0: exactly one step
    momentum = momentum_after(wire, "ball", answer.applied_step + acting / h + 2, mass)
    assert momentum == pytest.approx([f * acting for f in FORCE], rel=RELATIVE)


def test_command_line(free_bodies, wire):
    before = wire.next("STATE").step
    done = run_tumble("push", "ball", "--force", *FORCE, "--seconds", 0.5)
    assert done.returncode == 0, done.stderr
    mass = wire.bodies()["ball"][2]
    wire.next("STATE", condition=lambda m: m.step > before + 0.5 / dt(wire))
    momentum = momentum_after(wire, "ball", wire.next("STATE").step + 0.6 / dt(wire), mass)
    assert momentum == pytest.approx([f * 0.5 for f in FORCE], rel=RELATIVE)


def test_python(free_bodies, wire):
    from tumble import World
    world = World()
    world["ball"].push(force=FORCE, seconds=0.5)
    mass = wire.bodies()["ball"][2]
    momentum = momentum_after(wire, "ball", wire.next("STATE").step + 0.6 / dt(wire), mass)
    assert momentum == pytest.approx([f * 0.5 for f in FORCE], rel=RELATIVE)


def test_force_at_a_point_turns_by_its_lever_arm(free_bodies, wire):
    """One step of F at r changes the angular momentum by r x F dt about the centre of mass."""
    index, generation, _ = wire.bodies()["box"]
    wire.ask(wire.control(wire.verb("WATCH"), body=index, generation=generation))
    wire.listen_to_body(index)
    answer = wire.ask(wire.force(body=index, generation=generation, force=(0.0, 0.0, 12.0), point=(0.5, 1.0, 0.0)))
    assert answer.status == APPLIED
    body = wire.next(f"BODY_{index}", condition=lambda m: m.step > answer.applied_step)
    h = dt(wire)
    assert list(body.angular_momentum) == pytest.approx([12.0 * h, -6.0 * h, 0.0], rel=RELATIVE, abs=1e-15)


def test_torque_for_a_time(free_bodies, wire):
    """A torque M in W for T changes the world angular momentum by M T, however the body turns meanwhile."""
    index, generation, _ = wire.bodies()["box"]
    wire.ask(wire.control(wire.verb("WATCH"), body=index, generation=generation))
    wire.listen_to_body(index)
    torque = (5.0, -2.0, 3.0)
    answer = wire.ask(wire.force(body=index, generation=generation, torque=torque, duration=0.5))
    body = wire.next(f"BODY_{index}", condition=lambda m: m.step > answer.applied_step + 0.5 / dt(wire) + 2)
    assert list(body.angular_momentum) == pytest.approx([m * 0.5 for m in torque], rel=RELATIVE)
