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
SHORT = ("0.8", "30,60,120,240,500,1000")  # CPU time allowed for one scene, method and step [s]; steps a second
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


def wins_over(ours, rivals):
    """{method: [(rival's point, our least error in its time; None if no step of ours is as fast)]} where it errs less."""
    wins = collections.defaultdict(list)
    for rival in rivals:
        least = min((point.error for point in ours if point.cpu <= rival.cpu), default=None)
        if math.isfinite(rival.error) and (least is None or least > rival.error):
            wins[rival.method].append((rival, least))
    return wins


def better(wins):
    """Each method's largest win at a run time that the default has too."""
    said = []
    for method, won in wins.items():
        worst = max(((least / rival.error, rival, least) for rival, least in won if least is not None),
                    key=lambda item: item[0], default=None)
        if worst:
            ratio, rival, least = worst
            said.append(f"{method} {ratio:.2g} times: {rival.error:.1e} for {least:.1e} at {rival.cpu * 1e3:.2g} ms")
    return "<br>".join(said) or "none"


def faster(wins):
    """Each method's least error where it is faster than any step of ours."""
    least = {method: min((rival.error for rival, ours in won if ours is None), default=None)
             for method, won in wins.items()}
    return ", ".join(f"{method} {error:.1e}" for method, error in least.items() if error is not None) or "none"


def claim_table(scenes, measures):
    lines = ["| scene | error | doubt | default's fastest step | points of others beaten | others err less at our run times "
             "| others faster than that, and how they err | own ways that err less |", "|---" * 8 + "|"]
    for scene, points in scenes.items():
        ours = [point for point in points if point.method == DEFAULT]
        others = [point for point in points if not point.ours]
        wins = wins_over(ours, others)
        own = wins_over(ours, [point for point in points if point.ours and point.method != DEFAULT])
        first = min(ours, key=lambda point: point.cpu, default=None)
        fastest = f"{first.error:.1e} in {first.cpu * 1e3:.2g} ms" if first else "none in the time allowed"
        measure, doubt = measures[scene]
        lines.append(f"| {scene} | {measure} | {doubt:.0e} | {fastest} "
                     f"| {len(others) - sum(map(len, wins.values()))} of {len(others)} "
                     f"| {better(wins)} | {faster(wins)} | {better(own)} |")
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

Is the default's error the smallest at every run time? A point (method and step) of another engine is beaten if some step of our
default takes no more CPU time and errs no more. Times are CPU time a simulated second.

{claim_table(scenes, measures)}

{methods}""")
    for scene, points in scenes.items():
        print(f"### {scene}: {measures[scene][0]} \\| CPU time a simulated second [ms], by step [s]; drifts at 1/240 s\n")
        if scene in pictures:
            print(pictures[scene], "\n")
        print(scene_table(points), "\n")


if __name__ == "__main__":
    main()
