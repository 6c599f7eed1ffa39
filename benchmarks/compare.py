"""Compares the methods and writes docs/comparison.md with its plots and runs; the only way that page is made.

    python benchmarks/compare.py
    python benchmarks/compare.py --only energies "step filters" --out build    # a part of it, elsewhere

``--paper FOLDER`` adds the meshes of the paper's figures: the folder ``data`` of its program, with
``A_guy_fine_V.csv`` and others. Needs matplotlib and shapely (``pip install nested-cages[comparison]``).
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from itertools import repeat
from pathlib import Path

for library in ("OMP", "OPENBLAS", "MKL", "VECLIB"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")  # before numpy loads them

from clone import ROOT  # noqa: E402
from comparison import report, tables  # noqa: E402
from comparison.cases import Inputs, read_inputs  # noqa: E402
from comparison.experiments import EXPERIMENTS  # noqa: E402
from comparison.measure import Results  # noqa: E402


def run(name: str, inputs: Inputs) -> Results:
    """An experiment's measurements."""
    return EXPERIMENTS[name].run(inputs)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--paper", type=Path, help="folder of the paper's own meshes")
    parser.add_argument("--out", type=Path, default=ROOT / "docs", help="where the page goes (%(default)s)")
    parser.add_argument("--only", nargs="+", choices=list(EXPERIMENTS), help="run these experiments alone")
    parser.add_argument("--shapes", nargs="+", help="use these shapes alone")
    parser.add_argument("--jobs", type=int, default=1, help="experiments at once, each on a core (%(default)s)")
    options = parser.parse_args()
    inputs = read_inputs(options.paper, options.shapes)
    pictures = options.out / "comparison"
    pictures.mkdir(parents=True, exist_ok=True)

    began = time.perf_counter()
    chosen = {name: experiment for name, experiment in EXPERIMENTS.items() if name in (options.only or EXPERIMENTS)}
    with ProcessPoolExecutor(options.jobs) as pool:
        found: dict[str, Results] = dict(zip(chosen, pool.map(run, chosen, repeat(inputs)), strict=True))
    sections = [experiment.section(found[name], inputs, pictures) for name, experiment in chosen.items()]
    findings = [experiment.finding(found[name], inputs) for name, experiment in chosen.items()]
    runs = tables.write_runs(found, pictures / "runs.csv")
    seconds = time.perf_counter() - began
    page = options.out / "comparison.md"
    page.write_text(report.document(found, findings, sections, runs, seconds, options.jobs), encoding="utf-8")
    print(f"{page} written after {seconds:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
