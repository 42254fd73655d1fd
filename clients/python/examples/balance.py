"""Balances a rod on its end: a PD controller that holds the clock (lock-step). python balance.py [SECONDS]"""

import sys

import numpy as np

from tumble import World

seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
LENGTH, RADIUS, MASS, TILT = 1.0, 0.04, 1.0, 0.15  # [m], [m], [kg], [rad]
KP, KD = 40.0, 8.0  # [N m/rad], [N m s/rad]
up = np.array([0.0, 0.0, 1.0])


def axis(q):
    """The rod's z axis in the world, from its quaternion."""
    w, x, y, z = q
    return np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])


with World() as world, world.lock_step():
    if "rod" in world:
        world.remove("rod")
    half = LENGTH / 2 + RADIUS
    rod = world.spawn(
        "rod",
        "capsule",
        (RADIUS, LENGTH),
        at=(3 + half * np.sin(TILT), 0, half * np.cos(TILT)),
        orientation=(np.cos(TILT / 2), 0, np.sin(TILT / 2), 0),
        mass=MASS,
    )
    dt, torque = world.heartbeat.dt, np.zeros(3)
    for _ in range(round(seconds / dt)):
        rod.push(torque=torque, wait=False)  # acts in the step that comes
        now = world.step()["rod"]
        torque = KP * np.cross(axis(now.orientation), up) - KD * now.angular_velocity
    tilt = np.arccos(np.clip(axis(now.orientation) @ up, -1, 1))
    print(f"after {seconds} s the rod leans {np.degrees(tilt):.3f} degrees")
