#!/usr/bin/env python3
"""Looks for fused multiply-adds in a library: check_fused.py LIBRARY. They round once where two operations round twice,
so results would depend on the compiler's choice. Exit status: 0 none, 1 some (named), 2 the library cannot be read."""
import re
import subprocess
import sys

FUSED = re.compile(r"\tvfn?m(?:add|sub)\w*|\tfn?m(?:add|sub|la|ls)\b")  # x86; ARM
FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")


def fused_functions(disassembly):
    """Names of functions with a fused operation, in order, each once."""
    found, name = {}, "?"
    for line in disassembly:
        heading = FUNCTION.match(line)
        if heading:
            name = heading.group(1)
        elif FUSED.search(line):
            found[name] = None
    return list(found)


def main(library):
    command = ["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", library]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as objdump:
        found = fused_functions(objdump.stdout)
    if objdump.returncode != 0:
        return 2
    for name in found:
        print(f"fused multiply-add in {name}")
    print(f"{library}: {len(found)} functions with a fused operation")
    return 1 if found else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
