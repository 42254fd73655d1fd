#!/usr/bin/env python3
"""Runs the benchmark programs of a build and writes what they say to README.md, with the machine and the versions; those named replace their own sections.

    run_benchmarks.py BUILD [NAME...] [--long]     all programs bench_*, or those named (`step` or `bench_step`)

`stream` is stream.py, run in a network namespace of its own; `error` is error_curves.py: minutes, with --long hours.
Of bench_contacts the table has the fastest of five interleaved runs, also with its pairs in an order that never comes
back, since a processor learns the branches of a few hundred pairs by heart. Where valgrind is installed, it is also run
under callgrind for the instructions of one query: other than times they hardly differ between machines. Beside bench_NAME
a program NAME_accuracy... may print a Markdown table of its own; its first argument is the share of its full size to run,
TUMBLE_SHARE or 0.001, with --long all of it: hours. A script NAME_curves.py runs it instead, if there is one, and writes
what it draws beside the programs.
"""
import json
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).parent
OWN_KEYS = {"name", "family_index", "per_family_instance_index", "run_name", "run_type", "repetitions",
            "repetition_index", "threads", "iterations", "real_time", "cpu_time", "time_unit"}


def run_program(program, *options):
    """The parsed report of one program; its progress goes to the terminal."""
    print(" ".join(["running", program.name, *options]), file=sys.stderr)
    command = [program, "--benchmark_format=json", *options]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)


def run_interleaved(program, *options):
    """Five short runs of each measurement, all in random order, so that a slow minute hits none alone: the fastest."""
    report = run_program(program, "--benchmark_min_time=0.1", "--benchmark_repetitions=5",
                         "--benchmark_enable_random_interleaving=true", *options)
    fastest = {}
    for run in report["benchmarks"]:
        name = run["run_name"]
        if run["run_type"] == "iteration" and (name not in fastest or run["real_time"] < fastest[name]["real_time"]):
            fastest[name] = run
    return {"benchmarks": sorted(fastest.values(), key=lambda run: run["family_index"])}


def add_shuffled(program, report):
    """What the same takes if the pairs come in an order that never comes back."""
    shuffled = {run["run_name"]: run for run in run_interleaved(program, "--shuffled")["benchmarks"]}
    for run in report["benchmarks"]:
        other = shuffled[run["run_name"]]
        run["shuffled"] = f"{other['real_time']:.4g} {other['time_unit']}"


def count_instructions(program, name, queries):
    """Of one process that makes so many queries."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program,
               f"--benchmark_filter=^{name}/iterations:", f"--queries={queries}"]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stderr
    return int(re.search(r"Collected : (\d+)", said).group(1))


def add_instructions(program, report):
    """The difference of two runs, so that the start of the process and the first queries of all pairs don't count."""
    first, more = 512, 4096
    for run in report["benchmarks"]:
        print(f"counting instructions of {run['name']}", file=sys.stderr)
        counts = [count_instructions(program, run["name"], queries) for queries in (first, first + more)]
        run["instructions"] = str((counts[1] - counts[0]) // more)


def table(report):
    """A Markdown table: one measurement a line, one counter a column."""
    runs = report["benchmarks"]
    counters = list(dict.fromkeys(key for run in runs for key in run if key not in OWN_KEYS))
    lines = ["| " + " | ".join(["measurement", "time", *counters]) + " |", "|---" * (len(counters) + 2) + "|"]
    for run in runs:
        values = [f"{run[key]:.4g}" if isinstance(run.get(key), (int, float)) else str(run.get(key, ""))
                  for key in counters]
        name = run["name"].replace("/real_time", "")
        lines.append("| " + " | ".join([name, f"{run['real_time']:.4g} {run['time_unit']}", *values]) + " |")
    return "\n".join(lines)


def own_table(program, is_long):
    """What a program that prints Markdown says."""
    print(f"running {program.name}", file=sys.stderr)
    share = os.environ.get("TUMBLE_SHARE", "1" if is_long else "0.001")
    curves = HERE / f"{program.name.removesuffix('_accuracy')}_curves.py"
    command = [sys.executable, curves, program, share, program.parent] if curves.is_file() else [program, share]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def stream_table(build):
    """What stream.py says."""
    print("running stream.py", file=sys.stderr)
    root = HERE.parents[1]
    command = [root / "tests/network/in_namespace", root / ".venv/bin/python", HERE / "stream.py", build]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def error_table(build, options):
    """What error_curves.py says."""
    print("running error_curves.py", file=sys.stderr)
    programs = build / "tests/bench"
    command = [sys.executable, HERE / "error_curves.py", programs / "error_curves", programs, *options]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def first_line(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()[0]


def machine(build):
    """What the numbers depend on."""
    model = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
    compiler = re.search(r"CMAKE_CXX_COMPILER:\w+=(.*)", cache).group(1)
    build_type = re.search(r"CMAKE_BUILD_TYPE:\w+=(.*)", cache).group(1)
    commit = first_line("git", "-C", HERE, "describe", "--always", "--dirty")
    return [f"* processor: {model.group(1) if model else platform.machine()}, {os.cpu_count()} logical cores",
            f"* system: {platform.system()} {platform.release()}",
            f"* compiler: {first_line(compiler, '--version')}, {build_type}",
            f"* commit: {commit}"]


def main():
    build = pathlib.Path(sys.argv[1])
    options = [argument for argument in sys.argv[2:] if argument == "--long"]
    wanted = {name.removeprefix("bench_") for name in sys.argv[2:] if name not in options}
    programs = sorted(path for path in (build / "tests/bench").glob("bench_*") if os.access(path, os.X_OK))
    programs = [path for path in programs if path.is_file()
                and (not wanted or path.name.removeprefix("bench_") in wanted)]
    known = {path.name.removeprefix("bench_") for path in programs} | {"stream", "error"}
    if wanted - known or not (programs or wanted):
        sys.exit(f"no such benchmark: {' '.join(sorted(wanted)) or 'none is built'}")
    sections = []
    for path in programs:
        if path.name == "bench_contacts":
            report = run_interleaved(path)
            add_shuffled(path, report)
            if shutil.which("valgrind"):
                add_instructions(path, report)
        else:
            report = run_program(path)
        sections.append(f"## {path.name}\n{table(report)}")
        for accuracy in sorted(path.parent.glob(path.name.removeprefix("bench_") + "_accuracy*")):
            if accuracy.is_file():
                sections.append(f"## {accuracy.name}\n{own_table(accuracy, bool(options))}")
    if not wanted or "stream" in wanted:
        sections.append(f"## stream\n{stream_table(build)}")
    if not wanted or "error" in wanted:
        sections.append(f"## error\n{error_table(build, options)}")
    print("\n".join(sections))
    readme = HERE / "README.md"
    kept = {} if not wanted or not readme.exists() else split(readme.read_text(encoding="utf-8"))
    kept.update((section.split("\n")[0], section) for section in sections)
    kept = [f"{section.rstrip()}\n" for _, section in sorted(kept.items())]
    readme.write_text("\n".join(["# Benchmarks", "Written by `./run bench`; a counter's unit is part of its name. "
                                 "The machine and the commit are those of the newest run.", "", *machine(build), "",
                                 *kept]), encoding="utf-8")


def split(text):
    """{title line: section} of a README that this program wrote."""
    parts = re.split(r"^(?=## )", text, flags=re.M)[1:]
    return {part.split("\n")[0]: part for part in parts}


if __name__ == "__main__":
    main()
