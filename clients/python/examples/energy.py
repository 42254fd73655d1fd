"""Plots the energy of a recorded run: python energy.py RUN.lcm [PICTURE.png]

RUN.lcm comes from `tumble-server --record` or lcm-logger; needs matplotlib.
"""

import sys

import matplotlib

if len(sys.argv) > 2:
    matplotlib.use("Agg")
import matplotlib.pyplot as plt

from tumble import Log

log = Log(sys.argv[1])
times, kinetic, potential = log.times, log.column("kinetic_energy"), log.column("potential_energy")
plt.plot(times, kinetic, label="of motion")
plt.plot(times, potential, label="of gravity and springs")
plt.plot(times, kinetic + potential, "k", label="sum")
plt.xlabel("simulated time [s]")
plt.ylabel("energy [J]")
plt.legend()
plt.title(log.world)
print(f"{len(times)} points over {times[-1] - times[0]:.2f} s, energy {(kinetic + potential)[-1]:.6g} J at the end")
if len(sys.argv) > 2:
    plt.savefig(sys.argv[2], dpi=120)
else:
    plt.show()
