"""The options of `nested-cages check`."""

from __future__ import annotations

import argparse

from .options import length, shared

DESCRIPTION = """\
Checks cages in a file: without rounding, on the coordinates in the files, by code that shares nothing with the method.
RESULT is an .svg that this program has written around the DRAWING, word by word, or a GeoJSON of polygons alone, of any
program; anything else is rejected. DRAWING is read with the options that the cages were made with; several pictures are
the frames of a motion. The motion between frames in GeoJSON is checked on straight lines. A single FILE.blend is
checked as Blender plays it, with the add-on's folder next to this package and Blender as a Python module."""

EPILOG = "exit status: 0 everything holds, 1 something does not or a file cannot be read, 2 wrong use of the options"


def parser() -> argparse.ArgumentParser:
    options = argparse.ArgumentParser(
        prog="nested-cages check",
        usage="nested-cages check DRAWING [DRAWING ...] RESULT [options]",
        description=DESCRIPTION,
        epilog=EPILOG,
        parents=[shared()],
    )
    options.add_argument("drawing", metavar="FILE", nargs="+", help=argparse.SUPPRESS)
    options.add_argument("--distance", type=length, metavar="LENGTH", help="no cage reaches farther than this")
    add = options.add_mutually_exclusive_group().add_argument
    add("--same-loops", action="store_true", help="each loop has one of its own: no hole is filled, no parts share one "
        "(default: they are named)")  # fmt: skip
    add("--any-loops", action="store_true", help="cages may have other loops, and more")
    return options
