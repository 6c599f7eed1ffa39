"""The options of the command: what they accept, which of them go together, and the help."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Sequence
from math import inf
from pathlib import Path
from sys import modules
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # what values of options are read by is imported when there are some: the help is quick without
    from ..constraints.axis_aligned import AxisAligned
    from ..constraints.box import Box
    from ..geometry.symmetry import DetectSymmetry, Mirror, Rotation

STREAM = "-"
"""Stands for the standard input or output."""

STEM = "{stem}"
"""Placeholder in an output's name: the input's name without its extension."""

KINDS = {".svg": "drawing", ".png": "picture",
         **dict.fromkeys((".geojson", ".json", ".shp", ".gpkg", ".topojson"), "map")}  # fmt: skip
"""The content of an input file by its extension."""

WRITTEN = {".svg": "svg", ".geojson": "geojson", ".json": "geojson"}
"""Output formats by extension."""

METRES = {"m": 1.0, "km": 1000.0, "mi": 1609.344}
"""Units of lengths on the ground."""

FOR = {
    "inside": ("drawing", "map"),
    "jobs": ("map",),
    "tolerance": ("drawing",),
    "element": ("drawing",),
    "layers": ("drawing", "map"),
    "no_strokes": ("drawing",),
    "no_crop": ("drawing",),
    "threshold": ("picture",),
}
"""The kinds of files that some options are for."""

DESCRIPTION = """\
Wraps drawings (.svg), maps (.geojson .json .shp .gpkg .topojson) and pictures
(.png) in nested cages: coarse outlines that strictly enclose them, never cross
themselves, and have an area at a local minimum. Each one is certified by exact
predicates before it is written. FILE may be a pattern, or - for the standard
input."""

EPILOG = """\
exit status: 0 all cages were made and written, 1 a cage could not be made, or
a file not be read or written, 2 wrong use of the options, 130 interrupted

examples:
  nested-cages logo.svg --levels 64 24 -o cages.svg
  nested-cages "icons/*.svg" --levels 20% 8% -o "cages/{stem}.svg"
  nested-cages sprite.png --levels 16 --clearance 2 -o outline.geojson
  nested-cages regions.geojson --levels 200 --clearance 5km -o simple.geojson
  nested-cages check logo.svg cages.svg
  nested-cages puppet cat.psd -o cat.tscn
"""


class Metres(float):
    """A length on the ground, in metres."""


def kind_of(path: str) -> str | None:
    """The content of a file by its name; None if it cannot be read. For a stream it is guessed later."""
    return "stream" if path == STREAM else KINDS.get(Path(path).suffix.lower())


def length(text: str) -> float:
    if not 0.0 < (value := float(text)) < inf:
        raise ValueError
    return value


def clearance(text: str) -> float:
    unit = text.lstrip("0123456789.eE+-").strip()
    return Metres(length(text.removesuffix(unit)) * METRES[unit]) if unit in METRES else length(text)


def at_least(least: int) -> Callable[[str], int]:
    """Reads whole numbers that are not less."""

    def whole_number(text: str) -> int:
        if (value := int(text)) < least:
            raise argparse.ArgumentTypeError(f"a whole number of at least {least} is needed, not {text}")
        return value

    return whole_number


def symmetry(text: str) -> Mirror | Rotation | DetectSymmetry:
    from ..geometry.symmetry import DetectSymmetry, Mirror, Rotation

    if text == "found":
        return DetectSymmetry()
    return Mirror(None, (float(text == "y"), float(text == "x"))) if text in ("x", "y") else Rotation(None, int(text))


def directions(text: str) -> AxisAligned:
    from ..constraints.axis_aligned import TRANSIT, AxisAligned

    words = {"axes": AxisAligned(), "transit": AxisAligned(TRANSIT)}
    return words[text] if text in words else AxisAligned(tuple(map(float, text.split(","))))


def box(text: str) -> Box:
    from ..constraints.box import Box

    x, y, u, v = map(float, text.split(","))
    return Box((min(x, u), min(y, v)), (max(x, u), max(y, v)))


def limit(text: str) -> tuple[str, int]:
    from ..formats import Limits

    name, _, value = text.partition("=")
    return name, int(getattr(Limits(**{name: int(value)}), name))


class Levels(argparse.Action):
    """Levels from the finest to the coarsest."""

    def __call__(self, options: argparse.ArgumentParser, given: Any, words: Any, name: str | None = None) -> None:
        from ..levels import in_order, level_words, parse_level

        given.levels = in_order([parse_level(word) for word in level_words(" ".join(words))])


def shared() -> argparse.ArgumentParser:
    """The options that make cages and that check them."""
    options = argparse.ArgumentParser(add_help=False)
    add = options.add_argument
    add("--levels", nargs="+", action=Levels, default=[], metavar="N", help="what each cage has: a number of "
        "vertices, 32; a share of the shape's vertices, 8%%; or the fewest within a distance, 2px, or an excess of "
        "area, +25%%")  # fmt: skip
    add("--clearance", type=clearance, metavar="LENGTH", help="smallest distance of a cage from what it encloses, in "
        "units of the input; of a map also in m, km or mi, as in 5km")  # fmt: skip
    add("--inside", action="store_true", help="cages lie inside the shapes instead")
    add("--grid", type=length, metavar="LENGTH", help="cage vertices are multiples of this length: 1 for whole pixels, "
        "1e-6 for six decimals")  # fmt: skip
    add("--symmetry", type=symmetry, metavar="WHAT", help="x (left and right alike), y (top and bottom alike), both "
        "about the middle of the drawing, a number (rotations of that order about its centroid), or found (the "
        "drawing's own)")  # fmt: skip
    add = options.add_argument_group("how files are read").add_argument
    add("--tolerance", type=length, metavar="LENGTH", help="greatest distance between a curve and the edges in its "
        "place, which lie outside of it (default: 1/2000 of the drawing's diagonal)")  # fmt: skip
    add("--element", metavar="ID", help="only the element of a drawing with this id")
    add("--layers", nargs="+", metavar="NAME", help="only these layers: of a drawing by label or id, of a map file by "
        "name (default: the first with polygons)")  # fmt: skip
    add("--no-strokes", action="store_true", help="without the strokes of a drawing")
    add("--no-crop", action="store_true", help="with what lies outside the page of a drawing")
    add("--threshold", type=float, metavar="ALPHA", help="opacity from "
        "0 to 1 above which a pixel counts as opaque (default: 0.5)")  # fmt: skip
    add("--limit", dest="limits", type=limit, action="append", default=[], metavar="WHAT=N", help="raise or lower a "
        "limit: bytes, elements, points, seconds or pixels (SECURITY.md has the defaults)")  # fmt: skip
    return options


def parser() -> argparse.ArgumentParser:
    """The options that make cages."""
    version = modules[__name__.rpartition(".command.")[0]].__version__
    options = argparse.ArgumentParser(
        prog="nested-cages",
        usage="nested-cages FILE [FILE ...] --levels N [N ...] [-o FILE] [options]",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        parents=[shared()],
    )
    add = options.add_argument
    add("input", nargs="+", metavar="FILE", help=argparse.SUPPRESS)
    add("--version", action="version", version=f"nested-cages {version}", help="print the version")
    add("-o", "--output", action="append", default=[], metavar="FILE", help=".svg or .geojson to write, or - for the "
        "standard output; may be repeated. For several inputs it has {stem} in its name; a .geojson without it takes "
        "the cages of pictures as the frames of an animation")  # fmt: skip
    add("--loops", choices=("auto", "keep", "one"), default="auto", help="auto: holes are filled and parts share a "
        "loop where that is tighter; keep: every loop has its own; one: a silhouette")  # fmt: skip
    add("--seconds", type=float, metavar="S", help="time for each shape; the levels made by then are kept")
    add("--report", metavar="FILE", help="write all measures and messages as JSON")
    add("--quiet", action="store_true", help="no progress")
    add("--jobs", type=at_least(1), metavar="N", help="processes for the features of a map (default: 1)")
    add = options.add_argument_group("shape of cages").add_argument
    add("--convex", action="store_true", help="convex cages: this many vertices around each part, holes filled")
    add("--min-edge", type=length, metavar="LENGTH", help="no edge is shorter, where there is room")
    add("--min-angle", type=float, metavar="DEGREES", help="no angle between edges is sharper, where there is room; "
        "below 60")  # fmt: skip
    add("--directions", type=directions, metavar="WHAT", help="edges are along the axes (axes), also along both "
        "diagonals (transit), or at these angles in degrees, such as 0,60,120")  # fmt: skip
    add("--box", type=box, metavar="X,Y,X,Y", help="cages stay between two corners, as in --box=-8,0,8,9")
    add = options.add_argument_group("GeoJSON that is written").add_argument
    add("--flip-y", action="store_true", help="y turned over; that of a picture then counts up from its lower edge")
    add("--pieces", type=at_least(3), metavar="N", help="also convex pieces of at most N vertices, which tile each "
        'cage, as features with a number as "piece"; Box2D takes 8')  # fmt: skip
    return options


def check_use(options: argparse.ArgumentParser, given: argparse.Namespace, paths: Sequence[str]) -> None:
    """Exit with a message if options contradict each other or do not apply to the files, or outputs collide."""
    kinds = {kind_of(path) for path in paths}
    if not given.levels:
        options.error("--levels is needed")
    if None in kinds:
        unread = next(path for path in paths if kind_of(path) is None)
        options.error(f"{Path(unread).name}: a file is read if it ends in {', '.join(KINDS)}")
    for name, owners in FOR.items():
        if getattr(given, name) and not kinds & {*owners, "stream"}:
            word = name.replace("_", "-")
            options.error(f"--{word} is for a {' or a '.join(owners)}, and there is none among the input")
    if given.inside and given.jobs:
        options.error("--jobs is for cages around shapes; leave it out, or --inside")
    if [*given.output, given.report].count(STREAM) > 1 or (STREAM in given.output and len(paths) > 1):
        options.error("the standard output takes one of the outputs and the report, and the cages of one file")
    if (given.flip_y or given.pieces) and {*map(format_of, given.output)} <= {"svg"}:
        options.error("--flip-y and --pieces are for GeoJSON; write it with -o FILE.geojson")
    taken = {_place(path): f"is the input {path}; write to another file" for path in paths if path != STREAM}
    for path in [*given.output, given.report]:
        if path in (None, STREAM):
            continue
        if path != given.report and not format_of(path):
            options.error(f"{Path(path).name or repr(path)}: a file is written if it ends in {', '.join(WRITTEN)}")
        is_animation = format_of(path) == "geojson" and kinds == {"picture"}
        if path != given.report and len(paths) > 1 and STEM not in path and not is_animation:
            options.error(f"{path}: each of several input files needs its own; put {STEM} into the name")
        if not Path(path).parent.is_dir():
            options.error(f"{path}: there is no folder {Path(path).parent}")
        for stem in [Path(each).stem for each in paths] if STEM in path else [""]:
            place = _place(path.replace(STEM, stem))
            if place in taken:
                options.error(f"{path} {taken[place]}")
            taken[place] = f"is written twice, as {path} too; give each its own name"


def _place(path: str) -> str:
    """The place of a file, in the one way in which Windows and macOS take names."""
    return os.path.realpath(path).casefold()


def format_of(path: str, kind: str = "map") -> str | None:
    """The format of an output, of a drawing or another kind of input; None for what cannot be written."""
    by_kind = "svg" if kind == "drawing" else "geojson"
    return by_kind if path == STREAM else WRITTEN.get(Path(path).suffix.lower())
