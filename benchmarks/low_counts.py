"""Low counts around icons: whether a count is a promise, and whether the loops chosen are the best ones.

    python benchmarks/low_counts.py icons/bootstrap-icons icons/ionicons … [--files 6] [--counts 8% 24 12]
                                    [--brute] [--pictures FOLDER] [--seed 0]

Each folder is a set of drawings, such as an unpacked package of icons; files with one loop are passed over. Told for
each set are the cages with more vertices than asked for, those that the independent checker does not accept, errors,
the median and the largest excess, and the CPU time. With `--brute` a whole cage is made around every shape of a
sequence in which each has one loop less, the hole filled or the parts joined that add the least area for each loop
saved, and the tightest one is compared: the share of requests in which the area is at most 1.05 times that one, the
largest ratio, and the CPU time of both.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import clone  # noqa: F401
from nestedcages_core import Mesh, NestedCagesError, check, nested_cages, read_svg
from nestedcages_core.decimation.base import NOTHING_KEPT
from nestedcages_core.decimation.loops.choosing import LoopChoice
from nestedcages_core.decimation.loops.parts import outlines
from nestedcages_core.geometry.picture import svg_picture

CLOSE = 1.05
"""Ratio of areas up to which a choice of loops is as good as the best one."""

MOST_SHAPES = 10
"""Shapes of a sequence around which cages are made, evenly spread over those that the count allows."""

MOST_VERTICES = 2500
"""Vertices of the largest drawings: brute force takes long."""


@dataclass(frozen=True)
class Outcome:
    """One drawing at one count."""

    name: str
    asked: int
    given: int = 0
    excess: float = np.nan
    seconds: float = 0.0
    fault: str = ""
    best: float = np.nan
    """Excess of the best cage by brute force."""
    brute_seconds: float = 0.0

    @property
    def ratio(self) -> float:
        """Area by that of the best one."""
        return (1.0 + self.excess) / (1.0 + self.best)


def main(words: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--files", type=int, default=6, help="of each folder")
    parser.add_argument("--counts", nargs="+", default=["8%", "24", "12"])
    parser.add_argument("--brute", action="store_true", help="compare with the best shape of a sequence")
    parser.add_argument("--pictures", type=Path, help="folder for pictures of the loosest cages")
    parser.add_argument("--seed", type=int, default=0, help="which files")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    given = parser.parse_args(words)
    every: list[Outcome] = []
    print("| set | requests | over the count | wrong | excess, median | worst | best loops | worst ratio | CPU |")
    print("|---|---|---|---|---|---|---|---|---|")
    with ProcessPoolExecutor(given.jobs) as pool:
        for folder in given.folders:
            tasks = [(path, given.counts, given.brute, given.pictures) for path in chosen(folder, given)]
            found = [outcome for several in pool.map(judged, tasks) for outcome in several]
            every += found
            print(row(folder.name, found), flush=True)
            for outcome in found:
                if outcome.fault or outcome.given > outcome.asked or outcome.ratio > CLOSE:
                    print(outcome, file=sys.stderr, flush=True)
    print(row("all", every))
    return int(any(outcome.fault or outcome.given > outcome.asked for outcome in every))


def chosen(folder: Path, given: argparse.Namespace) -> list[Path]:
    """Drawings of a folder with several loops, by chance."""
    files = sorted(path for path in folder.rglob("*.svg") if path.is_file())
    random.Random(given.seed).shuffle(files)
    found: list[Path] = []
    for path in files[: 12 * given.files]:
        if len(found) < given.files and (mesh := read(path)) is not None and len(mesh.loops) > 1:
            found.append(path)
    return found


def read(path: Path) -> Mesh | None:
    """The drawing; None if it cannot be read, or is too large."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            mesh = read_svg(path)
        except NestedCagesError:
            return None
    return mesh if len(mesh.vertices) <= MOST_VERTICES else None


def judged(task: tuple[Path, list[str], bool, Path | None]) -> list[Outcome]:
    """The outcomes of one drawing at all counts."""
    path, counts, brute, pictures = task
    mesh = read(path)
    assert mesh is not None
    found = []
    for word in counts:
        share = float(word.removesuffix("%")) / 100.0 if word.endswith("%") else None
        asked = int(word) if share is None else max(3, round(share * len(mesh.vertices)))
        outcome = around(mesh, f"{path.parent.name}/{path.stem}", min(asked, len(mesh.vertices)), word, pictures)
        if brute:
            began = time.process_time()
            best = best_by_force(mesh, outcome.asked)
            outcome = Outcome(**{**vars(outcome), "best": best, "brute_seconds": time.process_time() - began})
        found.append(outcome)
    return found


def around(mesh: Mesh, name: str, asked: int, word: str, pictures: Path | None) -> Outcome:
    """One cage, judged."""
    began = time.process_time()
    try:
        level = nested_cages(mesh, word if word.endswith("%") else asked)[0]
    except NestedCagesError as error:
        return Outcome(f"{name} {word}", asked, fault=str(error))
    seconds = time.process_time() - began
    fault = "; ".join(check(mesh, level).problems)
    if pictures is not None:
        pictures.mkdir(parents=True, exist_ok=True)
        file = pictures / f"{100.0 * level.excess:07.1f}_{name.replace('/', '_')}_{word.removesuffix('%')}.svg"
        file.write_text(svg_picture(((mesh, level.cage),)), encoding="utf-8")
    return Outcome(f"{name} {word}", asked, len(level.cage.vertices), float(level.excess), seconds, fault)


def best_by_force(mesh: Mesh, count: int) -> float:
    """The least excess of whole cages around the shapes of a sequence, each of which has one loop less."""
    choice = LoopChoice(mesh, count, NOTHING_KEPT, 0.0)
    shapes = [[each.ring for each in outlines(choice.parts)]]
    while move := min(choice._moves(), key=lambda move: move.added / move.saved, default=None):
        move.apply()
        shapes.append([each.ring for each in outlines(choice.parts)])
    allowed = [rings for rings in shapes if 3 * len(rings) <= count]
    places = sorted({round(k) for k in np.linspace(0, len(allowed) - 1, MOST_SHAPES)}) if allowed else []
    best = np.inf
    for place in places:
        try:
            shape = Mesh.from_loops(allowed[place])
            cage = nested_cages(shape, min(count, len(shape.vertices)), loops="keep")[0].cage
        except NestedCagesError:
            continue
        best = min(best, cage.area / mesh.area - 1.0)
    return best


def row(name: str, found: list[Outcome]) -> str:
    """A line of the table."""
    made = [outcome for outcome in found if outcome.given]
    compared = [outcome.ratio for outcome in made if np.isfinite(outcome.best)]
    close = f"{100.0 * np.mean([ratio <= CLOSE for ratio in compared]):.1f} %" if compared else "-"
    excess = [outcome.excess for outcome in made] or [np.nan]
    seconds, brute = (sum(getattr(outcome, key) for outcome in found) for key in ("seconds", "brute_seconds"))
    cells = (
        name,
        len(found),
        sum(outcome.given > outcome.asked for outcome in found),
        sum(bool(outcome.fault) for outcome in found),
        f"{100.0 * float(np.median(excess)):.1f} %",
        f"{100.0 * float(np.max(excess)):.0f} %",
        close,
        f"{max(compared):.3f}" if compared else "-",
        f"{seconds:.1f} s" + (f" of {brute:.1f} s" if brute else ""),
    )
    return f"| {' | '.join(map(str, cells))} |"


if __name__ == "__main__":
    sys.exit(main())
