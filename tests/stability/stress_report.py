#!/usr/bin/env python3
"""Runs the stress cases, all cores at once, and says what every way holds and what it does not.

    stress_report.py STRESS [OPTION...]     STRESS: the program; options are its own, see STRESS --help

If no case is left out, what is printed goes to README.md too, and the picture beside it; else they lie beside the
program. stress.csv, all measurements, always does. The table has a row for each case and a column for each solver; a cell
says for each step whether it holds at every level of accuracy. The picture has a column for each way and shows how far from
its bound the worst check of a case is. Exit status 1: something that was promised does not hold.
"""
import collections
import concurrent.futures
import csv
import io
import math
import os
import pathlib
import platform
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).parent
SOLVERS = ["automatic", "exact", "soft_step", "pgs", "nncg", "course_impulse"]
STEPS = ["1/60", "1/240", "1/1000"]
LEVELS = ["fast", "balanced", "exact"]
LIMIT, FULL_LIMIT = 1.5, 60  # [s] processor time of one trial


def run(program, name, options):
    """What the program prints of one case, without the title line."""
    print(f"running {name}", file=sys.stderr)
    done = subprocess.run([program, *options, "--case", name], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                          text=True, check=False)
    if done.returncode not in (0, 1):
        sys.exit(f"{program} --case {name}: status {done.returncode}")
    return done.stdout.split("\n", 1)


def read(text):
    """{case: {(solver, step, accuracy): [row]}}, cases in order."""
    cases = {}
    for row in csv.DictReader(io.StringIO(text)):
        way = row["solver"], row["step"], row["accuracy"]
        cases.setdefault(row["case"], collections.defaultdict(list))[way].append(row)
    return cases


def decided(rows):
    """Not given up for its cost."""
    return bool(rows) and all(row["holds"] != "-" for row in rows)


def holds(rows):
    return all(row["holds"] == "1" for row in rows)


def excess(row):
    """How many bounds wide a check misses (> 1) or holds (<= 1)."""
    value, bound = abs(float(row["value"])), float(row["bound"])
    if row["holds"] == "1":
        return value / bound if bound > 0.0 else 0.0
    return value / bound if bound > 0.0 else math.inf


def worst(rows):
    return max(rows, key=excess)


def cell(ways, solver):
    """One character a step: all levels hold, some do, none does, nothing was run to its end."""
    marks = ""
    for step in STEPS:
        levels = [ways[solver, step, level] for level in LEVELS if decided(ways[solver, step, level])]
        held = sum(holds(rows) for rows in levels)
        marks += "·" if not levels else "●" if held == len(levels) else "◐" if held else "○"
    promised = any(row["promised"] == "1" for way, rows in ways.items() if way[0] == solver for row in rows)
    return f"**{marks}**" if promised else marks


def failures(cases):
    """Lines on what is promised and not held."""
    for name, ways in cases.items():
        for way, rows in ways.items():
            if decided(rows) and rows[0]["promised"] == "1" and not holds(rows):
                row = worst(rows)
                yield f"| {name} | {' '.join(way)} | {row['check']} | {float(row['value']):.2g} | {float(row['bound']):.2g} |"


def misses(cases, solver):
    """What a way that promises nothing does at the default step and level, worst check a case."""
    for name, ways in cases.items():
        rows = ways[solver, "1/240", "balanced"]
        if decided(rows) and not holds(rows) and rows[0]["promised"] == "0":
            row = worst(rows)
            yield f"{name} ({row['check']}: {float(row['value']):.2g})"


def draw(cases, path):
    """False without matplotlib."""
    try:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plot
        from matplotlib.colors import TwoSlopeNorm
    except ImportError:
        return False
    ways = [(solver, step, level) for solver in SOLVERS for step in STEPS for level in LEVELS]
    values = []
    for rows_of in cases.values():
        line = []
        for way in ways:
            rows = rows_of[way]
            ratio = excess(worst(rows)) if decided(rows) else math.nan
            line.append(math.nan if math.isnan(ratio) else min(6.0, max(-6.0, math.log10(max(ratio, 1e-6)))))
        values.append(line)
    figure, axes = plot.subplots(figsize=(15, 0.21 * len(cases) + 2), layout="constrained")
    image = axes.imshow(values, aspect="auto", cmap="RdYlGn_r", norm=TwoSlopeNorm(0.0, -6.0, 6.0), interpolation="none")
    axes.set_yticks(range(len(cases)), cases, fontsize=8)
    axes.set_xticks(range(len(ways)), [f"{step} {level}" for _, step, level in ways], rotation=90, fontsize=6)
    for i, solver in enumerate(SOLVERS):
        axes.text(9 * i + 4, -1.2, solver, ha="center", fontsize=9)
        axes.axvline(9 * i - 0.5, color="black", linewidth=1)
    figure.colorbar(image, label="log10(worst value / its bound): green holds, red does not; white: not run, or given up", shrink=0.6)
    figure.savefig(path, dpi=110)
    return True


def first_line(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()[0]


def split_options(options, names):
    """The cases that are asked for (all, if none), and the other options."""
    wanted, others = [], []
    words = iter(options)
    for word in words:
        if word == "--case":
            wanted.append(next(words, ""))
        else:
            others.append(word)
    unknown = set(wanted) - set(names)
    if unknown:
        sys.exit(f"no such case: {' '.join(sorted(unknown))}; --list names them all")
    return [name for name in names if not wanted or name in wanted], others


def write_table(cases, claims, command):
    """Lines of Markdown."""
    model = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    trials = [rows for ways in cases.values() for rows in ways.values() if rows]
    seconds = sum(float(rows[0]["cpu_s"]) for rows in trials)
    commit = first_line("git", "-C", HERE, "describe", "--always", "--dirty")
    lines = ["# Stress", "",
             f"Written by `{command}`: {len(cases)} cases, {len(trials)} trials, {seconds:.0f} s of processor time on "
             f"{model.group(1) if model else platform.machine()}, commit {commit}. Without `--full` sizes and "
             f"times are those of the test program, the level of accuracy varies at 1/240 s only, and a trial is given "
             f"up after {LIMIT} s.",
             "", "A cell has a mark for each step of 1/60, 1/240 and 1/1000 s: ● holds at every level of accuracy, ◐ at "
             "some, ○ at none, · not run, or given up. **Bold**: promised, at least at some steps.", "",
             "| case | what must hold | " + " | ".join(SOLVERS) + " |", "|---" * (2 + len(SOLVERS)) + "|"]
    for name, ways in cases.items():
        lines.append(f"| {name} | {claims[name]} | " + " | ".join(cell(ways, s) for s in SOLVERS) + " |")
    broken = list(failures(cases))
    lines += ["", "## Promised and not held", ""]
    lines += ["| case | way | worst check | value | bound |", "|---|---|---|---|---|", *broken] if broken else ["Nothing."]
    lines += ["", "## Not promised, and not held at 1/240 s, balanced", ""]
    for solver in SOLVERS:
        missed = list(misses(cases, solver))
        lines.append(f"* {solver}: {', '.join(missed) if missed else 'nothing'}")
    return lines, bool(broken)


def main():
    program, options = pathlib.Path(sys.argv[1]), sys.argv[2:]
    listing = subprocess.run([program, "--list"], check=True, capture_output=True, text=True).stdout
    claims = dict(line.split("\t") for line in listing.splitlines())
    names, others = split_options(options, claims)
    whole = len(names) == len(claims)
    seconds = FULL_LIMIT if {"--full", "--hours"} & set(others) else LIMIT
    limit = [] if "--limit" in others else ["--limit", str(seconds)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        printed = list(pool.map(lambda name: run(program, name, [*limit, *others]), names))
    text = printed[0][0] + "\n" + "".join(rows for _, rows in printed)
    program.with_name("stress.csv").write_text(text, encoding="utf-8")
    cases = read(text)
    lines, broken = write_table(cases, claims, " ".join(["./run stress", *options]))
    out = HERE if whole else program.parent
    if draw(cases, out / "stress.png"):
        lines += ["", "![how far from its bound every case is, every way](stress.png)"]
    if whole:
        (HERE / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
