"""The options of the command and what they accept."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ..errors import NestedCagesError
from ..exchange import DRAWING_LIMITS, Limits
from ..exchange.decimals import MAX_DECIMALS
from ..hierarchy import Found, Mirror, Rotation, level_words, parse_level
from .outputs import WRITTEN

DESCRIPTION = """\
Wraps drawings, maps and sprites in nested cages: coarse outlines that strictly enclose them, never cross themselves,
and are as tight as their vertex counts allow. Exact predicates certify every cage before it is written; to check files
that were written by code that shares nothing with this, use: nested-cages check DRAWING RESULT"""

EPILOG = """\
input files, several of them or patterns such as "icons/*.svg"; - reads the standard input:
  .svg            what is painted; curves become chords within --tolerance, overlapping shapes are united
  .geojson .json  polygons; every feature gets its own cages. Faults are repaired as map programs do, and each repair
                  is named. A collision outline written by this command too
  .png            opaque pixels, in pixels with y downwards

output files (by extension, all lengths and places in the units of the input):
  .svg            the drawing and its cages, as paths with the ids "drawing", "cage-1", "cage-2", ...; a picture's lie
                  on its pixels, a map has the north up
  .geojson        one feature per cage, with its level, vertices, excess and clearance
  .json           a collision outline for game engines: the coarsest cage as outer loops and holes
  Files are written whole or not at all. For several input files name outputs with {stem}, such as cages/{stem}.svg;
  a .json without it takes the outlines of several pictures as the frames of one animation

exit status:
  0  all cages were made, certified and written
  1  a cage could not be made or a file not be read; the message says why. What worked is written
  2  wrong use of the options
  130  interrupted

examples:
  nested-cages logo.svg --levels 64 24 -o cages.svg
  nested-cages "icons/*.svg" --levels 20% 8% -o "cages/{stem}.svg" --report report.json
  nested-cages sprite.png --levels 16 --padding 2 -o outline.json --flip-y
  nested-cages regions.geojson --levels 200 50 --jobs 4 -o simple.geojson
  curl ... | nested-cages - --levels 50% -o - > simple.geojson
"""

AXES = {"x": (0.0, 1.0), "y": (1.0, 0.0)}
"""Directions of the mirrors that turn over a coordinate."""


def parser() -> argparse.ArgumentParser:
    """The parser, with a complete --help."""
    options = argparse.ArgumentParser(
        prog="nested-cages",
        description=DESCRIPTION,
        epilog=EPILOG.replace("%", "%%"),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    options.add_argument("input", nargs="+", metavar="INPUT", help="files to read: .svg, .geojson, .json or .png; or -")
    options.add_argument(
        "--levels",
        action=_Levels,
        nargs="+",
        required=True,
        metavar="N",
        help="what each cage may have or take, from the finest to the coarsest: a number of vertices, 32; a share of "
        "the shape's own, 8%%; or the fewest vertices within a distance, 2px, or an excess, +25%%",
    )
    options.add_argument(
        "--inside",
        action="store_true",
        help="make cages inside the shapes instead, each inside the one before",
    )
    options.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FILE",
        help="file to write: .svg, .geojson or .json, or - for the standard output; may be given several times; "
        "without it the cages are only made and certified",
    )
    options.add_argument(
        "--format",
        choices=sorted(WRITTEN.values()),
        help="what to write to the standard output (default: geojson for maps, json for collision outlines, else svg)",
    )
    options.add_argument("--report", metavar="FILE", help="write all measures and messages as JSON, - for the output")
    options.add_argument(
        "--clearance",
        type=length,
        metavar="LENGTH",
        help="smallest distance between a cage and what it encloses (default: 1e-5 of the drawing's diagonal)",
    )
    options.add_argument(
        "--convex",
        action="store_true",
        help="convex cages: so many vertices around each part, holes filled",
    )
    options.add_argument(
        "--symmetry",
        type=symmetry,
        metavar="WHAT",
        help="cages are symmetric: x (left and right alike), y (top and bottom alike), both about the middle of the "
        "drawing, a number (rotations of that order about its centroid), or found (the drawing's own)",
    )
    options.add_argument(
        "--min-edge", type=length, metavar="LENGTH", help="no cage edge is shorter than this, where there is room"
    )
    options.add_argument(
        "--min-angle",
        type=_angle,
        metavar="DEGREES",
        help="no angle between cage edges is sharper than this, where there is room; below 60",
    )
    grids = options.add_mutually_exclusive_group()
    grids.add_argument(
        "--grid",
        type=length,
        metavar="LENGTH",
        help="cage vertices are multiples of this length, and certified as such",
    )
    grids.add_argument(
        "--decimals",
        type=decimals,
        metavar="N",
        help="the same by decimals: 6 or 7 for maps in degrees, 0 for whole pixels",
    )
    options.add_argument(
        "--limit",
        dest="limits",
        type=_limit,
        action="append",
        default=[],
        metavar="WHAT=N",
        help=f"read more or less at most (default: {_listed(Limits())}; of drawings {_listed(DRAWING_LIMITS)})",
    )
    options.add_argument("--quiet", action="store_true", help="no progress")
    drawings = options.add_argument_group("drawings (.svg)")
    drawings.add_argument(
        "--tolerance",
        type=length,
        metavar="LENGTH",
        help="greatest distance between a curve and its chords (default: 1/2000 of the drawing's diagonal); a "
        "clearance of at least as much encloses the curves themselves",
    )
    drawings.add_argument("--element", "--only", metavar="ID", help="read only the element with this id")
    drawings.add_argument("--layers", nargs="+", metavar="NAME", help="read only these layers, by label or id")
    drawings.add_argument("--no-strokes", action="store_true", help="leave strokes out")
    drawings.add_argument("--no-background", action="store_true", help="leave out a shape that covers the whole page")
    drawings.add_argument("--no-crop", action="store_true", help="keep what lies outside the page")
    drawings.add_argument(
        "--opacity", type=_share, metavar="ALPHA", help="opacity from 0 to 1 above which paint counts (default: 0)"
    )
    maps = options.add_argument_group("maps (.geojson)")
    maps.add_argument("--jobs", type=_count, metavar="N", help="processes for the features (default: 1)")
    maps.add_argument(
        "--borders",
        action="store_true",
        help="cut cages at the borders that features share, so that they overlap as little as cages can",
    )
    sprites = options.add_argument_group("pictures (.png)")
    sprites.add_argument("--padding", type=length, metavar="PIXELS", help="the clearance; parts closer are joined")
    sprites.add_argument(
        "--threshold",
        type=_share,
        metavar="ALPHA",
        help="opacity from 0 to 1 above which a pixel counts as opaque (default: 0)",
    )
    sprites.add_argument("--holes", action="store_true", help="keep holes open (default: closed)")
    engines = options.add_argument_group("collision outlines (.json)")
    engines.add_argument(
        "--flip-y", action="store_true", help="turn y over; that of a picture then counts upwards from its lower edge"
    )
    engines.add_argument("--triangles", action="store_true", help="add the triangles of the outline")
    engines.add_argument(
        "--pieces",
        type=_corners,
        metavar="N",
        help="add convex pieces of at most N vertices, which tile the outline; Box2D takes 8",
    )
    return options


def of_drawings(given: argparse.Namespace) -> dict[str, Any]:
    """The options of drawings as `SvgOptions`."""
    return {
        "tolerance": given.tolerance,
        "element": given.element,
        "layers": tuple(given.layers or ()),
        "strokes": not given.no_strokes,
        "background": not given.no_background,
        "crop": not given.no_crop,
        "opacity": given.opacity or 0.0,
        "limits": replace(DRAWING_LIMITS, **given.limits),
    }


class _Levels(argparse.Action):
    """Reads the levels, however the shell split them: `--levels 32 8% 2px` as well as `--levels "32, 8 %, 2 px"`."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        try:
            levels = [parse_level(word) for word in level_words(" ".join(values))]
        except NestedCagesError as error:
            raise argparse.ArgumentError(self, str(error)) from error
        if not levels:
            raise argparse.ArgumentError(self, "at least one level is needed")
        setattr(namespace, self.dest, levels)


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


def _corners(text: str) -> int:
    return int(_number(text, "a whole number of at least 3 is needed", lambda value: value >= 3 and value % 1 == 0))


def length(text: str) -> float:
    return _number(text, "a length above 0 is needed", lambda value: 0.0 < value < float("inf"))


def symmetry(text: str) -> Mirror | Rotation | Found:
    if text == "found":
        return Found()
    if text in AXES:
        return Mirror(None, AXES[text])
    order = _number(text, "x, y, found or a whole number of at least 2 is needed", lambda n: n >= 2 and n % 1 == 0)
    return Rotation(None, int(order))


def _angle(text: str) -> float:
    return _number(text, "an angle above 0 and below 60 degrees is needed", lambda value: 0.0 < value < 60.0)


def decimals(text: str) -> int:
    what = f"a whole number from 0 to {MAX_DECIMALS} is needed"
    return int(_number(text, what, lambda value: 0 <= value <= MAX_DECIMALS and value % 1 == 0))


def _listed(limits: Limits) -> str:
    """All limits in the form of the option."""
    return ", ".join(f"{name.replace('_', '-')}={value}" for name, value in vars(limits).items())


def _limit(text: str) -> tuple[str, int]:
    name, _, number = text.partition("=")
    field = name.replace("-", "_")
    if field not in vars(Limits()):
        known = ", ".join(vars(Limits())).replace("_", "-")
        raise argparse.ArgumentTypeError(f"{known} can be limited, as in pixels=1000000, not {text!r}")
    return field, _count(number)


def _share(text: str) -> float:
    return _number(text, "a number from 0 to 1 is needed", lambda value: 0.0 <= value <= 1.0)
