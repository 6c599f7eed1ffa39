"""Renews the numbers of docs/performance.md: runs the benchmarks one after the other; all they print is kept too.

    python benchmarks/performance.py                  # all of it: some twenty minutes on a machine without other work
    python benchmarks/performance.py table1 growth    # only these
    python benchmarks/performance.py table1 --program-times TIMES.csv

The paper's C++ program is not ours to ship: its times in data/table1.csv come from another machine. With a checkout of
it, paper_program.py builds and times it and writes TIMES.csv; the speed of this machine is printed in any case. Exit
status 1 if a benchmark fails; its place in the page then stays as it was.
"""

from __future__ import annotations

import argparse
import platform
import re
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

from clone import ROOT
from page import measured

PAGE = ROOT / "docs" / "performance.md"

RUNS: dict[str, tuple[str, str]] = {
    "table1": ("table1.py", r"fine| +(32|512) |ratio"),
    "shapes": ("shapes.py", r"ratio|start, to"),
    "speed": ("speed.py --against bb3b310 --cases 48 --repeats 1", r"time |excess "),
    "corners": (
        "corners.py --against bb3b310 837f1d56",
        r"\| (\| bb3b310|within|grid|loops|1,000 at 1[23]|100,000|following|SVG of 100|strokes|bind|growth|vertices)|$",
    ),
    "start": ("start.py", r".*"),
    "slider": ("slider.py", r"500 |\| (slider|vertices|clearance)|The cages|$"),
    "ipc_iteration": ("ipc_iteration.py", r".*"),
    "iterations": ("iterations.py --plot docs/iterations.png", r"$"),
    "growth": ("growth.py --plot docs/growth.png", r".*: time"),
    "million": ("growth.py --sizes 1000000 --cage 1000 --kinds smooth", r"kind|smooth +1"),
    "many": ("many_shapes.py --dask", r"\d.*times as fast"),
    "motions": ("motions.py --plot docs/motions.png", r"\d+ of \d+ keys"),
}
"""Place in the page: program with its arguments, and which of the lines that it prints the page shows."""

PAGES = {"motions": "motion.md"}
"""Pages of runs that are not in docs/performance.md."""

FRONT = {"table1": "On the "}
"""Runs of which the README has a line, and how that begins."""

LOOPS, MATRIX, PRODUCTS = 2_000_000, 300, 20
"""Of the speed of the machine: rounds of a loop in Python; size and number of products of matrices."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="*", metavar="RUN", help=f"only these: {', '.join(RUNS)}")
    parser.add_argument("--program-times", type=Path, help="CSV file like data/table1.csv, with times of this machine")
    parser.add_argument("--page", type=Path, default=PAGE, help="the page (default: docs/performance.md)")
    options = parser.parse_args()
    unknown = [name for name in options.runs if name not in RUNS]
    if unknown:
        parser.error(f"there is no run {unknown[0]!r}; there are {', '.join(RUNS)}")
    about = machine()
    measured(options.page, "machine", "python benchmarks/performance.py", about, about)
    failed = []
    for name in options.runs or RUNS:
        command, shown = RUNS[name]
        if name == "table1" and options.program_times is not None:
            command += f" --data {options.program_times}"
        began = time.perf_counter()
        printed = run(command)
        print(f"{name}: {time.perf_counter() - began:.0f} s{'' if printed else ', failed'}", flush=True)
        if printed:
            command = f"python benchmarks/{command}"
            page = options.page.with_name(PAGES.get(name, options.page.name))
            measured(page, name, command, printed, as_markdown(printed, shown))
            if name in FRONT and options.page == PAGE:
                line = next(line for line in printed.splitlines() if line.startswith(FRONT[name]))
                measured(ROOT / "README.md", name, command, printed, line)
        else:
            failed.append(name)
    return 1 if failed else 0


def run(command: str) -> str:
    """What a benchmark prints; empty if it fails."""
    program, *arguments = command.split()
    words = [sys.executable, str(ROOT / "benchmarks" / program), *arguments]
    done = subprocess.run(words, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    printed = done.stdout.replace(str(ROOT) + "/", "").strip("\n")
    if done.returncode or not printed:
        print(printed, file=sys.stderr)
        return ""
    return printed


def as_markdown(printed: str, shown: str) -> str:
    """The lines that begin with a pattern, as they are if they have a table in Markdown, else as a block."""
    if "\n|---" in printed:
        lines = ["", *printed.splitlines()]
        return "\n".join(
            line for before, line in pairwise(lines) if re.match(shown, before if line.startswith("|---") else line)
        )
    lines = [line for line in printed.splitlines() if re.match(shown, line)]
    return "\n".join(["```text", *lines, "```"]) if any(lines) else ""


def machine() -> str:
    """What the numbers were measured on: processor, versions, and its speed."""
    began = time.process_time()
    total = 0
    for k in range(LOOPS):
        total += k * k % 7
    loop = LOOPS / (time.process_time() - began) / 1e6
    matrix = np.random.default_rng(0).normal(size=(MATRIX, MATRIX))
    began = time.process_time()
    for _ in range(PRODUCTS):
        matrix @ matrix
    rate = 2.0 * PRODUCTS * MATRIX**3 / (time.process_time() - began) / 1e9
    return (
        f"Measured on {processor()} with Python {platform.python_version()} and numpy {np.__version__}. One thread "
        f"does {loop:.0f} million rounds of a Python loop and {rate:.0f} billion operations of a matrix product "
        "a second."
    )


def processor() -> str:
    """The name of the processor, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


if __name__ == "__main__":
    sys.exit(main())
