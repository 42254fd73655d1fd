#!/usr/bin/env python3
"""Checks the shape of the sources: who may include whom, and what the physics must never call.

    check_layers.py [ROOT]       prints FILE:LINE: problem, one a line; exit status 1 if there is any
    check_layers.py --self-test  shows every rule a file that breaks it, and one that keeps it
"""
import pathlib
import re
import sys
import tempfile

# A room and the rooms it may include from. The order is the order of the layers: every room names only earlier ones,
# so that there can be no cycle of folders.
ROOMS = {
    "protocol": [],
    "server/math": [],
    "server/collision": ["server/math"],
    "server/dynamics": ["server/math", "server/collision"],
    "server/world": ["server/math", "server/collision", "server/dynamics"],
    "server/scene": ["server/math", "server/collision", "server/dynamics", "server/world"],
    "server/net": ["protocol", "server/math", "server/collision", "server/dynamics", "server/world"],
    "server": ["protocol", "server/math", "server/collision", "server/dynamics", "server/world", "server/scene",
               "server/net"],
    "clients/cpp": ["protocol"],
}
PHYSICS = ["server/math", "server/collision", "server/dynamics", "server/world", "server/scene"]
STEPPED = PHYSICS[:-1]  # what runs in a step: same input, same bits
MAX_LINES = 500

LIBM = ("sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|exp|exp2|expm1|log|log2|log10|log1p|pow|"
        "cbrt|hypot|erf|erfc|tgamma|lgamma")
FORBIDDEN = [  # (rooms, pattern, reason)
    (STEPPED, rf"\bstd::({LIBM})\b|(?<![\w:.>])({LIBM})f?\s*\((?!\))",
     "the C library's bits depend on the CPU; use math/rotation.h"),
    (STEPPED, r"\bAngleAxis|\bslerp\b|\btoRotationVector\b|\beulerAngles\b",
     "Eigen calls the C library in it; use math/rotation.h"),
    (STEPPED, r"\bs?rand\s*\(|\brandom\s*\(|<random>|\bstd::(mt19937|random_device|minstd_rand)",
     "no random numbers in a step"),
    (PHYSICS, r"<(chrono|ctime|thread|mutex|future|sys/.*|lcm/.*)>|\bsystem_clock\b|\bsteady_clock\b",
     "tumble_physics has no clock, thread or socket"),
    (list(ROOMS), r"^\s*#\s*(if|ifdef|ifndef|elif)\b", "no conditional compilation"),
]
SOURCES = (".h", ".cpp", ".py", ".lcm", ".java", ".sh")


def room_of(path):
    """The room a file (path relative to the root) lives in, or None: the longest room that holds its folder."""
    folder = path.parent.as_posix()
    found = [room for room in ROOMS if folder == room or folder.startswith(room + "/")]
    return max(found, key=len, default=None)


def without_comments(text):
    """The text with comments and string literals blanked, line breaks kept."""
    def blank(match):
        token = match.group(0)
        if token.startswith(("/*", "//")):
            return "\n" * token.count("\n")
        return token[0] + token[-1]
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])*\'', blank, text,
                  flags=re.DOTALL)


def resolve(root, path, name):
    """The room that `#include "name"` in the file `path` reaches; None: no file of ours."""
    for base in ("server", "protocol", "clients/cpp", "", path.parent.as_posix()):
        target = pathlib.PurePosixPath(base) / name
        if (root / target).is_file():
            return room_of(target)
    return None


def check_file(root, path):
    """Yields (line, problem) for one file, its path relative to the root."""
    raw = (root / path).read_text(encoding="utf-8")
    lines = raw.split("\n")
    if len(lines) - 1 > MAX_LINES:
        yield len(lines) - 1, f"{len(lines) - 1} lines; the limit is {MAX_LINES}"
    room = room_of(path)
    if room is None or path.suffix not in (".h", ".cpp"):
        return
    for number, line in enumerate(lines, 1):
        include = re.match(r'\s*#\s*include\s*([<"])([^">]+)[>"]', line)
        if not include:
            continue
        quoted, name = include.group(1) == '"', include.group(2)
        target = resolve(root, path, name)
        if quoted and target is None and room in PHYSICS and name.endswith(".h"):
            yield number, f'"{name}" is no file of the server'
        if target is not None and target != room and target not in ROOMS[room]:
            yield number, f"{room} must not include {target} ({name})"
        if name == "ccd/ccd.h" and path.as_posix() != "server/collision/gjk.cpp":
            yield number, "libccd belongs behind collision/gjk.h"
    for number, line in enumerate(without_comments(raw).split("\n"), 1):
        for rooms, pattern, reason in FORBIDDEN:
            match = room in rooms and re.search(pattern, line)
            if match:
                yield number, f"{match.group(0).strip()}: {reason}"


def file_local_names(raw):
    """Yields (line, name) of every type and k... constant in the unnamed namespaces of a file."""
    for space in re.finditer(r"^namespace \{$.*?^\}  // namespace$", raw, flags=re.DOTALL | re.MULTILINE):
        for name in re.finditer(r"^(?:struct|class|enum class) (\w+)|^(?:const|static)[^=({\n]* (k[A-Z]\w*)", space.group(0),
                                flags=re.MULTILINE):
            yield raw[:space.start() + name.start()].count("\n") + 1, name.group(1) or name.group(2)


def check_file_local_names(root, paths):
    """The compiler reads many files of the physics as one, in batches that shift with every new file: what is local to one
    must not bear the name of something in another, nor of a type that a header declares."""
    physics = [path for path in paths if room_of(path) in PHYSICS]
    text = {path: (root / path).read_text(encoding="utf-8") for path in physics}
    seen = {}
    for path in physics:
        if path.suffix == ".h":
            for name in re.finditer(r"^(?:struct|class|enum class) (\w+)(?=[ :{][^;]*$)", text[path], flags=re.MULTILINE):
                seen[name.group(1)] = path
    for path in physics:
        if path.suffix == ".cpp":
            for line, name in file_local_names(text[path]):
                if seen.setdefault(name, path) != path:
                    yield f"{path}:{line}: {name} is also in {seen[name]}"


def check(root):
    """All problems under the root, as lines."""
    paths = [pathlib.PurePosixPath(file.relative_to(root)) for folder in ("protocol", "server", "clients", "tests")
             for file in sorted((root / folder).rglob("*")) if file.suffix in SOURCES]
    found = [f"{path}:{line}: {problem}" for path in paths for line, problem in check_file(root, path)]
    return found + list(check_file_local_names(root, paths))


def self_test():
    """Every rule finds what it is there to find, and nothing in a file that keeps it."""
    rooms = list(ROOMS)
    for room, below in ROOMS.items():
        assert all(rooms.index(other) < rooms.index(room) for other in below), f"{room} is not above {below}"
    good = ('#pragma once\n#include <cmath>\n#include "math/types.h"\n// std::sin is not called, nor #ifdef used\n'
            'const char* kText = "std::pow(";\ndouble f(double x) { return std::sqrt(x) + sincos(x).sin; }\n')
    cases = [  # (file, text, part of the only problem)
        ("server/dynamics/body.cpp", good, None),
        ("server/math/types.h", "struct Big { int million = 1'000'000; };\n", None),
        ("server/collision/gjk.cpp", "#include <ccd/ccd.h>\n", None),
        ("server/scene/demo.cpp", "double x = std::cos(1.0);\n", None),
        ("server/server.cpp", "#include <chrono>\n#include <thread>\n", None),
        ("server/math/up.h", '#include "dynamics/body.h"\n', "server/math must not include server/dynamics"),
        ("server/net/bus.h", '#include "scene/sdf.h"\n', "server/net must not include server/scene"),
        ("protocol/codec.h", '#include "world/world.h"\n', "protocol must not include server/world"),
        ("clients/cpp/main.cpp", '#include "math/types.h"\n', "clients/cpp must not include server/math"),
        ("server/world/world.h", '#include "math/nothing.h"\n', "no file of the server"),
        ("server/collision/hull.cpp", "#include <ccd/ccd.h>\n", "libccd belongs behind"),
        ("server/math/a.cpp", "double x = std::sin(1.0);\n", "std::sin"),
        ("server/math/a.cpp", "/* one\ntwo */ auto f = atan2(y, x);\n", "a.cpp:2: atan2("),
        ("server/dynamics/a.cpp", "Eigen::AngleAxisd r(a, n);\n", "AngleAxis"),
        ("server/dynamics/a.cpp", "q = q.slerp(t, r);\n", "slerp"),
        ("server/world/a.cpp", "int i = rand();\n", "rand("),
        ("server/world/a.cpp", "#include <random>\n", "<random>"),
        ("server/scene/a.cpp", "#include <chrono>\n", "<chrono>"),
        ("server/net/a.cpp", "#ifdef FAST\n#endif\n", "#ifdef"),
        ("server/math/a.cpp", "namespace {\n\nclass Jacobian {\n};\nconstexpr int kFew = 1;\n\n}  // namespace\n", None),
        ("server/world/a.cpp", "namespace {\n\nclass Body {};\n\n}  // namespace\n", "a.cpp:3: Body is also in"),
        ("server/world/a.cpp", "namespace {\n\nconstexpr int kSteps = 1;\n\n}  // namespace\n", "kSteps is also in"),
        ("clients/python/tumble/long.py", "\n" * (MAX_LINES + 1), "the limit is"),
    ]
    for name, text, expected in cases:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            files = {"server/math/types.h": "", "server/dynamics/body.h": "struct Body {\n};\n", "server/scene/sdf.h": "",
                     "server/dynamics/rk4.cpp": "namespace {\nconstexpr int kSteps = 4;\n}  // namespace\n",
                     "server/world/world.h": "", name: text}
            for file, content in files.items():
                (root / file).parent.mkdir(parents=True, exist_ok=True)
                (root / file).write_text(content, encoding="utf-8")
            problems = check(root)
        wanted = 0 if expected is None else 1
        assert len(problems) == wanted and all(expected in p for p in problems), (name, text, expected, problems)
    print(f"{len(cases)} cases passed")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent
    problems = check(root)
    print("\n".join(problems) or "layers: no problem")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
