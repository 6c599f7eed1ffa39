"""Compares the methods and writes docs/comparison.md and the pages below docs/comparison, the only way they are made.

    python benchmarks/compare.py                     # about ten minutes on two cores
    python benchmarks/compare.py --check             # are the pages of this code? exit status 1 if not
    python benchmarks/compare.py --confirm 700000    # three conclusions on other random shapes
    python benchmarks/compare.py --only sweeps --out build/comparison    # a part of it, elsewhere

An interrupted run goes on where it was. The exit status is 3 where the runs contradict a conclusion of the page.
``--paper FOLDER`` adds the meshes of the paper's figures, elsewhere: the folder ``data`` of its program, with
``A_guy_fine_V.csv`` and others. Needs matplotlib and shapely (``pip install nested-cages[comparison]``).
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

for library in ("OMP", "OPENBLAS", "MKL", "VECLIB"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")  # before numpy loads them

from clone import ROOT  # noqa: E402
from comparison import digest  # noqa: E402

PAGES = ROOT / "docs"
STORE = ROOT / "build" / "comparison"
PAPERS = STORE / "paper"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only say whether the pages are of this code")
    parser.add_argument(
        "--confirm", type=int, nargs="?", const=-1, metavar="SEED",
        help="only try conclusions on random shapes, from a seed that the pages do not use",
    )  # fmt: skip
    parser.add_argument("--paper", type=Path, help="folder of the paper's own meshes; their page goes to build/")
    parser.add_argument("--out", type=Path, default=PAGES, help="where the pages go (%(default)s)")
    parser.add_argument("--only", nargs="+", help="run these experiments alone")
    parser.add_argument("--shapes", nargs="+", help="use these shapes alone")
    parser.add_argument("--jobs", type=int, default=2, help="processes (%(default)s)")
    parser.add_argument("--larger", type=int, default=1, metavar="K", help="so many times as many random shapes")
    parser.add_argument(
        "--smaller", type=int, default=1, metavar="K", help="a part of the random shapes, to try it out"
    )
    options = parser.parse_args()
    if options.check:
        return digest.check(options.out / "comparison")

    from comparison import making  # needs matplotlib

    return making.run(options, STORE, PAPERS)


if __name__ == "__main__":
    sys.exit(main())
