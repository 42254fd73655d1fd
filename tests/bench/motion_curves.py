#!/usr/bin/env python3
"""Error against CPU time of free motion, for each method, time step and peer.

    motion_curves.py MOTION_ACCURACY SHARE FOLDER

Runs the program, adds MuJoCo's rows where its package is installed, prints Markdown, and writes FOLDER/motion.csv and,
where matplotlib is installed, FOLDER/motion.svg.
"""
import csv
import math
import pathlib
import subprocess
import sys
import time

SECONDS = 10
RATES = (60, 240, 1000)  # in the table; all are in the CSV
CASES = {  # as in motion_accuracy.cpp: moments, angular velocity, velocity, gravity
    "generic": ((0.6, 0.8, 1.0), (3.0, 0.5, -0.9), (0, 0, 0), 0.0),
    "plate": ((0.5, 0.75, 1.2), (6.0, -2.0, 4.0), (0, 0, 0), 0.0),
    "Dzhanibekov": ((1.0, 2.0, 3.0), (1e-3, 5.0, 1e-3), (0, 0, 0), 0.0),
    "gazebo_complex": ((0.97 / 12, 0.82 / 12, 0.17 / 12), (0.1, 5.0, 0.1), (-2, 2, 8), -9.8),
}


def mujoco_rows(ends):
    """Rows of MuJoCo's Runge-Kutta integrator, the most accurate it has for a free body."""
    try:
        import mujoco
    except ImportError:
        return
    for case, (moments, w, v, gravity) in CASES.items():
        for rate in sorted({round(1 / float(row["dt"])) for row in ends}):
            model = mujoco.MjModel.from_xml_string(
                f'<mujoco><option timestep="{1 / rate!r}" gravity="0 0 {gravity}" integrator="RK4"/><worldbody><body>'
                f'<freejoint/><inertial pos="0 0 0" mass="1" diaginertia="{" ".join(map(repr, moments))}"/>'
                "</body></worldbody></mujoco>")
            data = mujoco.MjData(model)
            data.qvel[:] = (*v, *w)
            begin = time.process_time()
            mujoco.mj_step(model, data, SECONDS * rate)
            cpu = time.process_time() - begin
            # The flight's own end stands for the truth: it is 1e-14 rad from the references.
            end = next(row for row in ends if row["case"] == case and row["method"] == "closed_form")
            q = [float(end[f"q{axis}"]) for axis in "wxyz"]
            half_chord = min(math.dist(q, data.qpos[3:]), math.dist([-c for c in q], data.qpos[3:])) / 2
            fall = [v[i] * SECONDS + (0.5 * gravity * SECONDS**2 if i == 2 else 0.0) for i in range(3)]
            energy = (sum(c * c for c in data.qvel[:3]) + sum(i * c * c for i, c in zip(moments, data.qvel[3:]))) / 2 \
                - gravity * data.qpos[2]
            start = (sum(c * c for c in v) + sum(i * c * c for i, c in zip(moments, w))) / 2
            yield {"case": case, "method": "mujoco_rk4", "dt": repr(1 / rate),
                   "angle_error_rad": f"{4 * math.asin(min(1.0, half_chord)):.3e}",
                   "position_error_m": f"{math.dist(fall, data.qpos[:3]):.3e}",
                   "energy_error": f"{abs(energy / start - 1):.3e}", "cpu_s": f"{cpu:.3e}"}


def table(rows):
    """Orientation error and CPU time of each method, a line each."""
    lines = [f"Orientation error [rad] after {SECONDS} s at 1/60, 1/240, 1/1000 s | CPU time of it all at 1/240 s [ms]", ""]
    cases = list(dict.fromkeys(row["case"] for row in rows))
    lines += ["| method | " + " | ".join(cases) + " |", "|---" * (len(cases) + 1) + "|"]
    for method in dict.fromkeys(row["method"] for row in rows):
        cells = []
        for case in cases:
            found = {round(1 / float(row["dt"])): row for row in rows if (row["case"], row["method"]) == (case, method)}
            errors = ", ".join(f"{float(found[rate]['angle_error_rad']):.1e}" for rate in RATES)
            cells.append(f"{errors} \\| {float(found[240]['cpu_s']) * 1e3:.2g}")
        lines.append(f"| {method} | " + " | ".join(cells) + " |")
    boxes = [row for row in rows if row["case"] == "gazebo_complex"]
    lines += ["", "Gazebo's complex box, dt = 1/1000 s: position [m] and energy [relative to the start]", "",
              "| method | position | energy |", "|---|---|---|"]
    lines += [f"| {row['method']} | {float(row['position_error_m']):.1e} | {float(row['energy_error']):.1e} |"
              for row in boxes if round(1 / float(row["dt"])) == 1000]
    return "\n".join(lines)


def draw(rows, file):
    try:
        import matplotlib
    except ImportError:
        print("matplotlib is not installed: no curves", file=sys.stderr)
        return
    matplotlib.use("svg")
    from matplotlib import pyplot
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure, axes = pyplot.subplots(2, (len(cases) + 1) // 2, figsize=(12, 9), layout="constrained")
    for axis, case in zip(axes.flat, cases):
        for method in dict.fromkeys(row["method"] for row in rows):
            points = sorted((float(row["cpu_s"]), float(row["angle_error_rad"]) + 1e-17) for row in rows
                            if (row["case"], row["method"]) == (case, method))
            axis.loglog(*zip(*points), marker=".", label=method)
        axis.set(title=case, xlabel=f"CPU time of {SECONDS} s [s]", ylabel="orientation error [rad]")
        axis.grid(True, alpha=0.3)
    axes.flat[0].legend(fontsize="small")
    figure.savefig(file)


def main():
    program, share, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    file = folder / "motion.csv"
    classes = subprocess.run([program, share, file], check=True, stdout=subprocess.PIPE, text=True).stdout
    with file.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    rows += mujoco_rows(rows)
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), restval="")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, folder / "motion.svg")
    print(classes, table(rows), sep="\n")


if __name__ == "__main__":
    main()
