"""The options of the command and what they accept."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

MAPS = (".geojson", ".json")
INPUTS = (".svg", *MAPS, ".png")
OUTPUTS = (".svg", ".geojson", ".json")

DESCRIPTION = """\
Wraps a drawing, a map or a sprite in nested cages: coarse outlines that strictly enclose it, never cross themselves,
and hug it as tightly as their vertices allow. Every cage is certified by exact predicates before it is written."""

EPILOG = """\
input files:
  .svg            filled areas; curves become chords within --tolerance, overlapping shapes are united
  .geojson .json  polygons; every feature gets its own cages. A collision outline written by this command too
  .png            opaque pixels, in pixels with y downwards

output files (by extension, all lengths and places in the units of the input):
  .svg            the drawing and its cages, as paths with the ids "drawing", "cage-1", "cage-2", ...
  .geojson        one feature per cage, with its level, vertices, excess and clearance
  .json           a collision outline for game engines: the coarsest cage as outer loops and holes

exit status:
  0  all cages were made, certified and written
  1  a cage could not be made or a file not be read; the message says why. Of several features those that worked are
     written
  2  wrong use of the options
  130  interrupted

examples:
  python -m nestedcages_core logo.svg --levels 64 24 -o cages.svg
  python -m nestedcages_core sprite.png --levels 16 --padding 2 -o outline.json --flip-y
  python -m nestedcages_core regions.geojson --levels 200 50 --jobs 4 -o simple.geojson
"""


def parser() -> argparse.ArgumentParser:
    """The options, with a complete --help."""
    options = argparse.ArgumentParser(
        prog="python -m nestedcages_core",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    options.add_argument("input", type=Path, help="the file to read: .svg, .geojson or .png")
    options.add_argument(
        "--levels",
        type=_count,
        nargs="+",
        required=True,
        metavar="N",
        help="vertices of each cage, from the finest to the coarsest",
    )
    options.add_argument(
        "-o",
        "--output",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help="file to write: .svg, .geojson or .json; may be given several times; without it the cages are only made "
        "and certified",
    )
    options.add_argument(
        "--clearance",
        type=_length,
        metavar="LENGTH",
        help="smallest distance between a cage and what it encloses (default: 1e-5 of the drawing's diagonal)",
    )
    options.add_argument("--quiet", action="store_true", help="no progress")
    drawings = options.add_argument_group("drawings (.svg)")
    drawings.add_argument(
        "--tolerance",
        type=_length,
        metavar="LENGTH",
        help="greatest distance between a curve and its chords (default: 1/2000 of the drawing's diagonal); a "
        "clearance of at least as much encloses the curves themselves",
    )
    drawings.add_argument("--element", metavar="ID", help="read only the element with this id")
    maps = options.add_argument_group("maps (.geojson)")
    maps.add_argument("--jobs", type=_count, default=1, metavar="N", help="processes for the features (default: 1)")
    sprites = options.add_argument_group("pictures (.png)")
    sprites.add_argument("--padding", type=_length, metavar="PIXELS", help="the clearance; parts closer are joined")
    sprites.add_argument(
        "--threshold",
        type=_share,
        default=0.0,
        metavar="ALPHA",
        help="opacity from 0 to 1 above which a pixel counts as opaque (default: 0)",
    )
    sprites.add_argument("--holes", action="store_true", help="keep holes open (default: closed)")
    engines = options.add_argument_group("collision outlines (.json)")
    engines.add_argument(
        "--flip-y", action="store_true", help="turn y over; that of a picture then counts upwards from its lower edge"
    )
    engines.add_argument("--triangles", action="store_true", help="add the triangles of the outline")
    return options


def _number(text: str, what: str, holds: Callable[[float], bool]) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not holds(value):
        raise argparse.ArgumentTypeError(f"{what}, not {text!r}")
    return value


def _count(text: str) -> int:
    return int(_number(text, "a whole number of at least 1 is needed", lambda value: value >= 1 and value % 1 == 0))


def _length(text: str) -> float:
    return _number(text, "a length above 0 is needed", lambda value: 0.0 < value < float("inf"))


def _share(text: str) -> float:
    return _number(text, "a number from 0 to 1 is needed", lambda value: 0.0 <= value <= 1.0)
