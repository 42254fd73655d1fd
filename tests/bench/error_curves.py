#!/usr/bin/env python3
"""Run time against error of all our ways and of other engines, scene by scene.

    error_curves.py ERROR_CURVES FOLDER [--long] [SCENE...]

Runs the program ERROR_CURVES, whose lines go to FOLDER/error.csv; draws plots/error_SCENE.svg here where matplotlib is
installed; prints Markdown: whether the default is the best at every run time, and a table a scene.
"""
import collections
import csv
import math
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).parent
SHORT = ("0.8", "10,30,60,120,240,500,1000")  # CPU time allowed for one scene, method and step [s]; steps a second
LONG = ("20", "10,20,30,60,120,240,500,1000,2000,4000")
ROUNDING = 1e-12  # errors below it, or below the doubt about the truth, are equal
DEFAULT = "default"
COLOURS = {"Tumble": "tab:blue", "Bullet": "tab:red", "ODE": "tab:orange", "MuJoCo": "tab:green"}
MARKS = "osv^D"


class Point:
    """A method at one step, of one scene."""

    def __init__(self, row):
        self.engine, self.method, self.rate = row["engine"], row["method"], int(row["rate_Hz"])
        self.cpu, self.cpu_median = float(row["cpu_min"]), float(row["cpu_median"])
        self.error = max(float(row["error"]), ROUNDING, float(row["doubt"]))
        self.energy, self.momentum = float(row["energy_drift_J_kg"]), float(row["momentum_drift_m_s"])
        self.spin, self.overlap = float(row["spin_drift_rad_s"]), float(row["overlap_m"])

    @property
    def ours(self):
        return self.engine == "Tumble"


def read(file):
    """{scene: points} and {scene: (measure, doubt)}, in the file's order."""
    scenes, measures = collections.defaultdict(list), {}
    with file.open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            scenes[row["scene"]].append(Point(row))
            measures[row["scene"]] = row["measure"], float(row["doubt"])
    return scenes, measures


def rival_wins(points, rivals):
    """[(rival's point, our least error in its time or None)] where the default is not the best."""
    ours = [point for point in points if point.method == DEFAULT]
    wins = []
    for rival in rivals:
        in_time = [point.error for point in ours if point.cpu <= rival.cpu]
        if math.isfinite(rival.error) and (not in_time or min(in_time) > rival.error):
            wins.append((rival, min(in_time, default=None)))
    return wins


def verdict(points, rivals):
    """What a reader wants to know of the wins: by whom, and the largest of each."""
    wins = collections.defaultdict(list)
    for rival, ours in rival_wins(points, rivals):
        wins[rival.method].append((rival, ours))
    parts = []
    for method, won in wins.items():
        late = [rival for rival, ours in won if ours is None]
        worse = [(ours / rival.error, rival, ours) for rival, ours in won if ours is not None]
        said = []
        if worse:
            ratio, rival, ours = max(worse, key=lambda item: item[0])
            said.append(f"{rival.error:.1e} at {rival.cpu * 1e3:.2g} ms/s, ours {ours:.1e} ({ratio:.2g} times)")
        if late:
            rival = min(late, key=lambda point: point.error)
            said.append(f"{rival.error:.1e} in {rival.cpu * 1e3:.2g} ms/s, which none of our steps is as fast as")
        parts.append(f"{method}: " + "; ".join(said))
    return "<br>".join(parts) or "none"


def claim_table(scenes, measures):
    lines = ["| scene | error | truth's doubt | points of other engines beaten | by whom the default is beaten "
             "| own ways that beat the default |", "|---|---|---|---|---|---|"]
    for scene, points in scenes.items():
        others = [point for point in points if not point.ours]
        own = [point for point in points if point.ours and point.method != DEFAULT]
        beaten = len(others) - len(rival_wins(points, others))
        measure, doubt = measures[scene]
        lines.append(f"| {scene} | {measure} | {doubt:.0e} | {beaten} of {len(others)} | {verdict(points, others)} "
                     f"| {verdict(points, own)} |")
    return "\n".join(lines)


def scene_table(points):
    """Error and CPU time by step, and what else drifts at 1/240 s, a line a method."""
    rates = sorted({point.rate for point in points})
    lines = ["| method | " + " | ".join(f"1/{rate}" for rate in rates) +
             " | energy [J/kg] | momentum [m/s] | spin [rad/s] | overlap [m] |", "|---" * (len(rates) + 5) + "|"]
    for method in dict.fromkeys(point.method for point in points):
        found = {point.rate: point for point in points if point.method == method}
        cells = [f"{found[rate].error:.1e} \\| {found[rate].cpu * 1e3:.2g}" if rate in found else "" for rate in rates]
        drifts = found.get(240) or found[max(found)]
        cells += [f"{value:.1e}" for value in (drifts.energy, drifts.momentum, drifts.spin, drifts.overlap)]
        lines.append(f"| {method} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def draw(scene, measure, points, file):
    from matplotlib import pyplot
    figure, axis = pyplot.subplots(figsize=(8, 4.8), layout="constrained")
    marks = collections.defaultdict(lambda: iter(MARKS))
    for method in dict.fromkeys(point.method for point in points):
        line = [point for point in points if point.method == method and point.error < 1e3]
        if not line:
            continue
        engine = line[0].engine.split()[0]
        if engine == "Tumble" and method != DEFAULT:
            style = {"color": "lightsteelblue", "marker": ".", "linewidth": 0.8, "zorder": 1}
        else:
            own = method == DEFAULT
            style = {"color": COLOURS[engine], "marker": next(marks[engine], "x"), "linewidth": 2.5 if own else 1,
                     "markersize": 4, "label": "Tumble, default" if own else method, "zorder": 3 if own else 2}
        axis.loglog([point.cpu for point in line], [point.error for point in line], **style)
    axis.plot([], [], color="lightsteelblue", marker=".", label="Tumble, other ways")
    axis.set(title=scene, xlabel="CPU time a simulated second [s]", ylabel=measure)
    axis.grid(True, alpha=0.3)
    axis.legend(fontsize="small", loc="center left", bbox_to_anchor=(1, 0.5))
    figure.savefig(file, metadata={"Date": None})
    pyplot.close(figure)


def plots(scenes, measures):
    """Markdown of the plots, drawn if that can be."""
    try:
        import matplotlib
    except ImportError:
        print("matplotlib is not installed: no plots", file=sys.stderr)
        return {}
    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "tumble"})
    (HERE / "plots").mkdir(exist_ok=True)
    pictures = {}
    for scene, points in scenes.items():
        file = HERE / "plots" / f"error_{scene}.svg"
        draw(scene, measures[scene][0], points, file)
        pictures[scene] = f"![run time against error: {scene}](plots/{file.name})"
    return pictures


def main():
    program, folder, *names = sys.argv[1:]
    seconds, rates = LONG if "--long" in names else SHORT
    names = [name for name in names if name != "--long"]
    file = pathlib.Path(folder) / "error.csv"
    methods = subprocess.run([program, HERE.parent / "scenes", file, seconds, rates, *names], check=True,
                             stdout=subprocess.PIPE, text=True).stdout
    scenes, measures = read(file)
    pictures = plots(scenes, measures)
    print(f"""Every method on the same scenes, every body read at every step. CPU time is the least of up to five runs; a method gets
{seconds} s of it for a scene and step, what takes longer is left out. Place: farthest that any point of a body is from the truth;
energy: from its start, relative; overlap: of two bodies, by our own narrow phase for all engines; each the worst of all tenths of
a second. Errors below {ROUNDING:.0e}, or below the doubt about the truth (two step sizes of the reference apart), count as that.

Is the default's error the smallest at every run time? A point of another engine is beaten if some step of our default takes no
more CPU time and errs no more.

{claim_table(scenes, measures)}

{methods}""")
    for scene, points in scenes.items():
        print(f"### {scene}: {measures[scene][0]} \\| CPU time a simulated second [ms], by step [s]; drifts at 1/240 s\n")
        if scene in pictures:
            print(pictures[scene], "\n")
        print(scene_table(points), "\n")


if __name__ == "__main__":
    main()
