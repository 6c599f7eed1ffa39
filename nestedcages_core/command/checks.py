"""Whether the options of the command fit each other and the files."""

from __future__ import annotations

import argparse
import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from ..geometry.lattice import Grid
from .outputs import STEM, WRITTEN
from .sources import KINDS, STREAM, kind_of

BELONGING = {
    "tolerance": ("drawing", "map"),
    "element": ("drawing",),
    "layers": ("drawing",),
    "inside": ("drawing", "map"),
    "no_strokes": ("drawing",),
    "no_background": ("drawing",),
    "no_crop": ("drawing",),
    "opacity": ("drawing",),
    "jobs": ("map",),
    "borders": ("map",),
    "padding": ("picture",),
    "threshold": ("picture",),
    "holes": ("picture",),
}
"""Options that only apply to some kinds of files, with these kinds."""

OUTLINES = ("flip_y", "triangles", "pieces")
"""Options for collision outlines."""


def check_use(options: argparse.ArgumentParser, given: argparse.Namespace, paths: Sequence[str]) -> None:
    """Exit with a message if the options contradict each other or do not apply to the files; fill in defaults."""
    kinds, borders = {kind_of(path) for path in paths}, given.borders is not None
    for path in paths:
        if kind_of(path) is None:
            options.error(f"{Path(path).name}: a file is read if it ends in {', '.join(KINDS)}")
    for name, owners in BELONGING.items():
        if getattr(given, name) not in (None, False) and not kinds & {*owners, "stream"}:
            options.error(f"--{name.replace('_', '-')} is for a {owners[0]}, and there is none among the input")
    for name in ("jobs", "borders"):
        if given.inside and getattr(given, name) is not None:
            options.error(f"--{name} is for cages around the shapes; leave out --inside")
    if given.padding is not None and given.clearance is not None:
        options.error("--padding is the clearance of pictures; give only one of them")
    if given.format and STREAM not in given.output:
        options.error("--format is for the standard output (-o -); files are written by their extension")
    if [*given.output, given.report].count(STREAM) > 1:
        options.error("the standard output takes one of the outputs and the report")
    if STREAM in given.output and len(paths) > 1:
        options.error("the standard output takes the cages of one file")
    _check_files(options, given, paths)
    outlines = any(Path(path).suffix.lower() == ".json" or path == STREAM for path in given.output)
    for name in OUTLINES:
        if getattr(given, name) and not outlines:
            options.error(f"--{name.replace('_', '-')} is for collision outlines; write one with -o FILE.json")
    if given.grid is not None and given.decimals is not None:
        options.error("--decimals is a --grid; give only one of them")
    if given.decimals is not None:
        given.grid = Grid.of_decimals(given.decimals).spacing
    if given.convex and (given.inside or borders):
        options.error(f"--convex is for cages around a shape; leave out {'--inside' if given.inside else '--borders'}")
    if given.convex and (given.min_edge or given.min_angle):
        options.error("--convex takes no --min-edge and --min-angle; leave out one of them")
    apart = [name for name in ("inside", "convex", "borders", "symmetry", "min_edge", "min_angle")
             if getattr(given, name) not in (None, False)]  # fmt: skip
    if given.merge is not None and apart:
        options.error(f"--merge does not go with --{apart[0].replace('_', '-')}; leave out one of them")
    if given.symmetry and borders:
        options.error("--symmetry cannot be kept at borders; leave out one of them")
    if borders and given.grid is not None:
        options.error("--borders cuts cages where borders run, which is not on a grid; leave out one of them")
    given.jobs = given.jobs or 1
    given.limits = dict(given.limits)


def _check_files(options: argparse.ArgumentParser, given: argparse.Namespace, paths: Sequence[str]) -> None:
    """Exit with a message if the output files cannot be written."""
    for path in given.output:
        if path != STREAM and Path(path).suffix.lower() not in WRITTEN:
            options.error(f"{Path(path).name}: a file is written if it ends in {', '.join(WRITTEN)}")
        animation = Path(path).suffix.lower() == ".json" and all(kind_of(each) == "picture" for each in paths)
        if path != STREAM and len(paths) > 1 and STEM not in path and not animation:
            options.error(f"{path}: each of several input files needs its own; put {STEM} into the name")
    stems = Counter(Path(path).stem.casefold() for path in paths)  # Windows and macOS take both cases for one file
    doubled = next((Path(path).stem for path in paths if stems[Path(path).stem.casefold()] > 1), None)
    if given.output and doubled is not None:
        options.error(f"two input files are called {doubled}; run them one by one")
    _check_targets(options, [path for path in [*given.output, given.report] if path not in (None, STREAM)], paths)


def _check_targets(options: argparse.ArgumentParser, written: Sequence[str], paths: Sequence[str]) -> None:
    """Exit with a message if two files that are written are the same, or one of them is read; links are followed."""
    read = {os.path.realpath(path): path for path in paths if path != STREAM}
    taken: dict[str, str] = {}
    for path in written:
        if not Path(path).parent.is_dir():
            options.error(f"{path}: there is no folder {Path(path).parent}")
        for stem in {Path(each).stem for each in paths} if STEM in path else {""}:
            place = os.path.realpath(path.replace(STEM, stem))
            if place in read:
                options.error(f"{path} is the input {read[place]}; write to another file")
            if place in taken:
                options.error(f"{path} is written twice, as {taken[place]} too; give each its own name")
            taken[place] = path
