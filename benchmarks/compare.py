"""Compares the methods and writes docs/comparison.md with its plots; the only way that document is made.

    python benchmarks/compare.py --data ../shared/data

The folder holds ``paper/table1.csv`` and ``shapes/name_V.csv, name_E.csv``; what is not there is left out. Needs
matplotlib (``pip install nested-cages[comparison]``).
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
for library in ("OMP", "OPENBLAS", "MKL", "VECLIB"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")  # before numpy loads them
sys.path.insert(0, str(ROOT))

from comparison import experiments, plots, report  # noqa: E402
from comparison.findings import Findings  # noqa: E402


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data", help="folder (%(default)s)")
    parser.add_argument("--out", type=Path, default=ROOT / "docs", help="where the document goes (%(default)s)")
    options = parser.parse_args()
    inputs = experiments.read_inputs(options.data)
    pictures = options.out / "comparison"
    pictures.mkdir(parents=True, exist_ok=True)

    began = time.perf_counter()
    table1 = experiments.table1(inputs.table1)
    ladder = experiments.ladder()
    figures = experiments.figures(inputs.paper)
    starts = experiments.starts(inputs.shapes)
    alone = experiments.contacts_alone(inputs.shapes)
    filters = experiments.filters(inputs.shapes)
    energies = experiments.energies()
    reuse = experiments.reuse(inputs.shapes)

    plots.table1(table1, inputs.table1, pictures / "table1.png")
    plots.ladder(ladder, pictures / "ladder.png")
    plots.gallery(figures, list(next(iter(figures.values()))), pictures / "figures.png")
    if starts:
        plots.starts(starts, pictures / "starts.png")
    plots.strip(energies["letter A"], pictures / "energies.png")
    seconds = time.perf_counter() - began
    found = Findings(table1, ladder, figures, starts, alone, filters, energies, reuse, seconds)
    (options.out / "comparison.md").write_text(report.document(found, inputs.table1), encoding="utf-8")
    print(f"{options.out / 'comparison.md'} written after {seconds:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
