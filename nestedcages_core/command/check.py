"""`nested-cages check`: a result of drawings, or the animation in a file of Blender."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from .options import length, shared
from .printing import tell

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


def run(options: argparse.ArgumentParser, given: argparse.Namespace) -> bool:
    """Run the command; whether something does not hold, or cannot be read."""
    if len(given.drawing) > 1:
        from .check_files import files_fail  # needs shapely, which an animation does not

        return files_fail(given)
    path, program = Path(given.drawing[0]), Path(__file__).resolve().parents[2] / "addon" / "__main__.py"
    if path.suffix.lower() != ".blend":
        options.error("the drawing and the result are needed")
    for needed in (path, program):
        if not needed.is_file():
            tell(f"error: {needed}: No such file", sys.stderr)
            return True
    return subprocess.run([sys.executable, program, path], check=False).returncode != 0
