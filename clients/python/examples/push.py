"""Pushes a body upwards and checks Newton's second law on the way: python push.py NAME [FORCE] [SECONDS]"""

import sys

import numpy as np

from tumble import TumbleError, World

name = sys.argv[1] if len(sys.argv) > 1 else "ball"
force = float(sys.argv[2]) if len(sys.argv) > 2 else 50.0
seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 0.5
try:
    with World() as world:
        body = world[name]
        before = body.velocity
        answer = body.push(force=(0, 0, force), seconds=seconds)
        print(f"{answer.text} from step {answer.step}")
        end = answer.step + round(seconds / world.heartbeat.dt)
        world.wait_for(lambda: world.step_count >= end, timeout=seconds + 5)
        print("velocity changed by", np.round(body.velocity - before, 4), "m/s")
        print("by the force alone  ", np.round([0, 0, force * seconds / body.mass], 4), "m/s")
except TumbleError as error:
    sys.exit(f"push.py: {error}")
