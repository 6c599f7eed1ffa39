"""The options of `nested-cages check`, and its help."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from .options import OPTIONS, clearance, length, symmetry

DESCRIPTION = """\
Checks cages in a file: without rounding, on the coordinates in the files, by code that shares nothing with the method.
RESULT is an .svg that this program has written, word by word, or a GeoJSON of polygons alone, of any program; anything
else is rejected. DRAWING is what the cages were made from, read with the same options; several pictures are the frames
of a motion. GeoJSON with the frames of a motion on both sides is checked on the straight lines in between too. A
single FILE.blend is checked as Blender plays it, with the add-on's folder next to this package and Blender as a Python
module."""

EPILOG = "exit status: 0 everything holds, 1 something does not or a file cannot be read, 2 wrong use of the options"


def parsed(words: Sequence[str]) -> argparse.Namespace:
    """The options of the command, with the drawings and the result; of a single .blend no result."""
    options = argparse.ArgumentParser(
        prog="nested-cages check",
        usage="nested-cages check DRAWING [DRAWING ...] RESULT [options]",
        description=DESCRIPTION,
        epilog=EPILOG,
    )
    options.add_argument("drawing", metavar="FILE", nargs="+", help=argparse.SUPPRESS)
    options.add_argument("--levels", nargs="+", metavar="N", help="what each cage must have, as when they were made")
    options.add_argument("--clearance", type=clearance, metavar="LENGTH", help="smallest distance (default: above 0)")
    options.add_argument("--inside", action="store_true", help="the cages lie inside the drawing")
    loops = options.add_mutually_exclusive_group()
    loops.add_argument(
        "--same-loops",
        action="store_true",
        help="each loop has one of its own: no hole is filled, no parts share one (default: they are named)",
    )
    loops.add_argument("--any-loops", action="store_true", help="cages may have other loops, and more")
    options.add_argument("--grid", type=length, metavar="LENGTH", help="coordinates are multiples of this length")
    options.add_argument("--symmetry", type=symmetry, metavar="WHAT", help="x, y or an order of rotations")
    options.add_argument("--distance", type=length, metavar="LENGTH", help="no cage reaches farther than this")
    for names, how in (*OPTIONS["drawings"], *OPTIONS["pictures"]):
        options.add_argument(*names, **how)
    options.set_defaults(levels=[], limits={}, result=None)
    given = options.parse_args(words)
    if len(given.drawing) > 1:
        *given.drawing, given.result = given.drawing
    elif not given.drawing[0].lower().endswith(".blend"):
        options.error("the drawing and the result are needed")
    if given.levels:
        from ..errors import NestedCagesError
        from ..levels import in_order, level_words, parse_level

        try:
            given.levels = in_order([parse_level(word) for word in level_words(" ".join(given.levels))])
        except NestedCagesError as error:
            options.error(f"argument --levels: {error}")
    return given
