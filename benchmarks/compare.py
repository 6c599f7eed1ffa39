"""Compares the methods and writes docs/comparison.md and the pages below docs/comparison, the only way they are made.

    python benchmarks/compare.py                     # about ten minutes on two cores
    python benchmarks/compare.py --check             # do the pages hold for this code? exit status 1 if not
    python benchmarks/compare.py --smaller 10 --out build/comparison    # a tenth of the shapes, elsewhere
    python benchmarks/compare.py --pages             # the pages again, from the runs that are there

An interrupted run goes on where it was. The exit status is 3 where the runs do not show a conclusion of the page.
Needs matplotlib and shapely (``pip install nested-cages[comparison]``).
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
from datetime import date
from pathlib import Path

for library in ("OMP", "OPENBLAS", "MKL", "VECLIB"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")  # before numpy loads them

import numpy as np  # noqa: E402
import scipy  # noqa: E402

from clone import ROOT  # noqa: E402
from comparison import conclusions, experiments, pages, runs  # noqa: E402
from comparison.bench import Bench  # noqa: E402
from comparison.check import check  # noqa: E402
from comparison.shapes import Sizes  # noqa: E402
from nestedcages_core import __version__  # noqa: E402

NOT_SHOWN = 3
"""Exit status where the runs do not show a conclusion."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only say whether the pages hold for this code")
    parser.add_argument("--pages", action="store_true", help="only write the pages, from the runs that are there")
    parser.add_argument("--out", type=Path, default=ROOT / "docs", help="where the pages go (%(default)s)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (%(default)s)")
    parser.add_argument("--smaller", type=int, default=1, metavar="K", help="a part of the shapes, to try it out")
    options = parser.parse_args()
    if options.check:
        return check(options.out)
    folder = options.out / "comparison"
    if options.pages:
        found, record = runs.read(folder / pages.RUNS), pages.read_record(folder)
    else:
        found, record = made(options, folder)
    draw(found, folder)
    pages.write(found, record, options.out)
    return told(found)


def made(options: argparse.Namespace, folder: Path) -> tuple[list[runs.Run], dict[str, object]]:
    """All runs, and what there is to say of them; both written into a folder."""
    commit = _commit()
    sizes = Sizes().smaller(options.smaller) if options.smaller > 1 else Sizes()
    bench = Bench(options.jobs, ROOT / "build" / "comparison" / f"{commit.replace(' ', '-')}-{options.smaller}")
    try:
        found = experiments.run(sizes, bench)
    finally:
        bench.close()
    machine = (
        f"Nested Cages {__version__}, Python {platform.python_version()}, numpy {np.__version__}, scipy "
        f"{scipy.__version__}, {sys.platform}, {options.jobs} of {os.cpu_count()} cores, one thread each"
    )
    minutes = round(bench.seconds / 60.0, 1)
    record = {"commit": commit, "date": str(date.today()), "machine": machine, "minutes": minutes}
    folder.mkdir(parents=True, exist_ok=True)
    (folder / pages.RECORD).write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    runs.write(found, folder / pages.RUNS)
    return runs.read(folder / pages.RUNS), record


def draw(found: list[runs.Run], folder: Path) -> None:
    """The pictures of the conclusions, and the figures by the methods that are compared on them."""
    from comparison import figures, pictures  # needs matplotlib

    for conclusion in conclusions.CONCLUSIONS:
        pictures.save(getattr(pictures, conclusion.name)(found), folder / conclusion.picture)
    pictures.save(pictures.panes(figures.results()), folder / "figures.png")


def told(found: list[runs.Run]) -> int:
    """Say which conclusions do not hold; the exit status."""
    status = 0
    for conclusion, verdicts in conclusions.verdicts(found).items():
        for where, verdict in zip(("known shapes", "held-out shapes"), verdicts, strict=True):
            print(f"{'holds' if verdict.holds else 'NOT SHOWN'}, {where}: {conclusion.claim}")
            status = status if verdict.holds else NOT_SHOWN
    return status


def _commit() -> str:
    """The commit, and whether files differ from it."""

    def git(*words: str) -> str:
        return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True, check=False).stdout.strip()

    changed = git("status", "--porcelain", "--untracked-files=no")
    return (git("rev-parse", "--short=12", "HEAD") or "unknown") + (" with changes" if changed else "")


if __name__ == "__main__":
    sys.exit(main())
