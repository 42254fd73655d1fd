"""Picks the ball up: looks down a ray, holds what it meets on a spring in the air. python pick.py [HEIGHT] [SECONDS]"""

import sys

import numpy as np

from tumble import World

height = float(sys.argv[1]) if len(sys.argv) > 1 else 1.5
seconds = float(sys.argv[2]) if len(sys.argv) > 2 else float("inf")
OMEGA = 8.0  # natural frequency of the spring [rad/s], critically damped

with World() as world:
    hit = world.query.ray(origin=(0, 0, 10), direction=(0, 0, -1))
    if hit is None or world[hit.body].mass == 0:
        sys.exit("nothing to pick under (0, 0)")
    body, hand, start = world[hit.body], np.array([0, 0, height]), world.time
    print(f"picked {body.name}, {hit.distance:.2f} m below the eye")
    for state in world.states(timeout=2.0):
        if state.time - start > seconds:
            break
        now = state[body.name]
        pull = OMEGA**2 * (hand - now.position) - 2 * OMEGA * now.velocity + [0, 0, 9.81]
        body.push(force=body.mass * pull, seconds=1 / world.heartbeat.publish_rate, wait=False)
    print(f"{body.name} hangs at {body.position[2]:.3f} m, the hand is at {height} m")
