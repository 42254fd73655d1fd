#!/usr/bin/env python3
"""Error against CPU time of free motion, for each method, time step and peer.

    motion_curves.py MOTION_ACCURACY SHARE FOLDER

Runs the program, prints Markdown, and writes FOLDER/motion.csv and, where matplotlib is installed, FOLDER/motion.svg.
"""
import csv
import pathlib
import subprocess
import sys

SECONDS = 10
RATES = (60, 240, 1000)  # in the table; all are in the CSV


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
    draw(rows, folder / "motion.svg")
    print(classes, table(rows), sep="\n")


if __name__ == "__main__":
    main()
