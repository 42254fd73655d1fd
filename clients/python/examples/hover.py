"""Holds a body at a height: a PD controller closing its loop over LCM. python hover.py [NAME] [HEIGHT] [SECONDS]"""

import sys

from tumble import World

name = sys.argv[1] if len(sys.argv) > 1 else "ball"
height = float(sys.argv[2]) if len(sys.argv) > 2 else 2.0
seconds = float(sys.argv[3]) if len(sys.argv) > 3 else float("inf")
GRAVITY, OMEGA = 9.81, 6.0  # [m/s^2]; natural frequency of the loop [rad/s], critically damped

with World() as world:
    body, start = world[name], world.time
    for state in world.states(timeout=2.0):
        if state.time - start > seconds:
            break
        now = state[name]
        acceleration = GRAVITY + OMEGA**2 * (height - now.position[2]) - 2 * OMEGA * now.velocity[2]
        # For as long as it takes the next state to come: pushes add up while they last.
        body.push(force=(0, 0, body.mass * acceleration), seconds=1 / world.heartbeat.publish_rate, wait=False)
    print(f"{name} is at {body.position[2]:.4f} m, wanted {height} m")
