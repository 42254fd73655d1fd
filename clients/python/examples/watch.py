"""Prints the fastest bodies of the world, four times a second: python watch.py [WORLD]"""

import sys
import time

import numpy as np

from tumble import World

with World(*sys.argv[1:2]) as world:
    print(f"{len(world)} bodies in {world.name} ({world.heartbeat.scene})")
    try:
        while True:
            state = world.state
            speeds = np.linalg.norm(state.velocities, axis=1)
            fastest = np.argsort(-speeds, kind="stable")[:5]
            print(f"t = {state.time:8.3f} s", *(f"{state.names[i]} {speeds[i]:.2f} m/s" for i in fastest), sep="  ")
            time.sleep(0.25)
    except KeyboardInterrupt:
        pass
