"""`nested-cages check DRAWING RESULT`: the cages written in a file, judged by the independent checker."""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..checker import check, faults_of_motion
from ..errors import NestedCagesError
from ..exchange import Limits, read_svg, read_whole
from ..exchange.pictures import boundary_of_pixels, read_png
from .options import decimals, length, symmetry
from .progress import tell

HOLDS, WRONG = 0, 1
"""Exit statuses; wrong use ends with 2, by argparse."""

MOST_SAID = 20
"""Maximum number of problems that are printed."""

WRITTEN_PATH = re.compile(r'<path id="([^"]*)" class="(level|inner)-(\d+)"[^>]*?\sd="([^"]*)"')
"""A path as this program writes it: its id, the side, the level and the loops."""

LAST_WORDS = re.compile(r"-?(drawing|shape|cage-\d+)$| (Inner )?(Fine|Cage \d+)(\.\d+)?$")
"""What the command and Blender add to the number or name of a shape in an id."""

NUMBER = re.compile(r"[-+.\deE]+")

DESCRIPTION = """\
Checks cages that this program has written: without rounding, on the coordinates in the files, by code that shares
nothing with the method. RESULT is the .svg, .geojson or .json that was written, DRAWING what it was made from. A map,
an outline and an .svg of this program are read as they stand, other .svg and .png by the program's own readers.
Two .json with frames are checked at each frame, and on the straight lines in between."""

EPILOG = "exit status: 0 everything holds, 1 something does not or a file cannot be read, 2 wrong use of the options"


def check_files(arguments: Sequence[str]) -> int:
    """Run the command; the exit status."""
    given = _parser().parse_args(arguments)
    try:
        problems, count = _problems(given)
    except OSError as error:
        problems, count = [f"{error.filename}: {error.strerror}"], None
    except (NestedCagesError, ValueError, LookupError, TypeError, AttributeError) as error:
        problems, count = [f"the files cannot be read as outlines: {error}"], None
    more = len(problems) - MOST_SAID
    for problem in [*problems[:MOST_SAID], *([f"and {more} more"] if more > 0 else [])]:
        tell(f"{'error' if count is None else 'wrong'}: {problem}", sys.stderr)
    if not problems:
        tell(f"{count} cage{'s' * (count != 1)}: everything holds.", sys.stdout)
    return WRONG if problems else HOLDS


def _problems(given: argparse.Namespace) -> tuple[list[str], int | None]:
    """What is wrong, and the number of cages. Raises an error for what can't be read."""
    drawings, moves = _drawings(given.drawing, given.tolerance)
    read, also_moves = _read(given.result)
    results = [
        ([levels[k] for k in sorted(levels) if k > 0], [levels[k] for k in sorted(levels, reverse=True) if k < 0])
        for levels in read
    ]
    if len(drawings) != len(results) or not results:
        return [f"{given.drawing} has {len(drawings)} shapes, {given.result} cages of {len(results)}"], 0
    is_picture = Path(given.drawing).suffix.lower() == ".png"  # whose holes are closed and whose parts may be joined
    options = {
        "same_loops": False if given.any_loops or is_picture else None,
        "grid": given.grid if given.decimals is None else float(f"1e-{given.decimals}"),
        "symmetry": given.symmetry,
        "distance": given.distance,
    }
    found = []
    for k, (drawing, sides) in enumerate(zip(drawings, results, strict=True), 1):
        for side, cages in [(side, cages) for side, cages in enumerate(sides) if cages] or [(0, [])]:
            verdict = check(drawing, cages, given.clearance, inside=given.inside or side == 1, **options)
            found += [f"shape {k}: {problem}" if len(results) > 1 else problem for problem in verdict.problems]
    if moves and also_moves:
        found += _faults_between([outer[0] for outer, _ in results], drawings)
    return found, sum(len(cages) for sides in results for cages in sides)


def _faults_between(cages: Sequence[Any], drawings: Sequence[Any]) -> list[str]:
    """Contacts on the straight lines from each frame to the next, for frames with corresponding vertices."""
    lengths = [[[len(ring) for ring in rings] for rings in frames] for frames in (cages, drawings)]
    if any(frame != frames[0] for frames in lengths for frame in frames):
        return ["frames differ in their numbers of vertices, so the motion between them is not known"]
    edges, steps = [], []
    for frames in (cages, drawings):
        loops = np.split(np.arange(sum(map(len, frames[0]))), np.cumsum([len(ring) for ring in frames[0]])[:-1])
        edges.append(np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop in loops]))
        steps.append(np.stack([np.concatenate(rings) for rings in frames]))
    return faults_of_motion(edges[0], edges[1], steps[0], steps[1], range(len(cages) - 1))


def _drawings(path: str, tolerance: float | None) -> tuple[list[Any], bool]:
    """The rings of each shape of a file, and whether they are frames of a motion."""
    suffix = Path(path).suffix.lower()
    if suffix == ".png":
        return [boundary_of_pixels(read_png(path)[:, :, 3] > 0).rings], False
    if suffix == ".svg":
        known = [levels[0] for levels in _paths(path) if 0 in levels]
        return known or [read_svg(path, tolerance=tolerance).rings], False
    read, moves = _read(path)
    return [rings for levels in read for rings in levels.values()], moves


def _read(path: str) -> tuple[list[dict[int, Any]], bool]:
    """The rings of each level of each shape of a file, and whether they are frames of a motion."""
    if Path(path).suffix.lower() == ".svg":
        return _paths(path), False
    document = json.loads(read_whole(path, Limits()))
    shapes: list[dict[int, Any]] = []
    for rings, level in _shapes(document):
        if level == 1 or not shapes:
            shapes.append({})
        shapes[-1][level] = rings
    return shapes, "frames" in document


def _paths(path: str) -> list[dict[int, Any]]:
    """The rings of each level of each shape, 0 the drawing and below it inner cages, as this program writes an SVG."""
    found = WRITTEN_PATH.findall(read_whole(path, Limits()).decode("utf-8", errors="replace"))
    owners = [LAST_WORDS.sub("", name) for name, *_ in found]
    if len(set(owners)) != sum(level == "0" for _, _, level, _ in found):  # named by somebody else
        owners = [""] * len(found)
    shapes: dict[str, dict[int, Any]] = {}
    for owner, (name, side, number, data) in zip(owners, found, strict=True):
        level, shape = int(number) if side == "level" else -int(number), shapes.setdefault(owner, {})
        if level in shape:
            raise ValueError(f"{name} has the level of another path, and ids do not tell which shapes they belong to")
        shape[level] = [np.array(NUMBER.findall(part), float).reshape(-1, 2) for part in data.split("M")[1:]]
    return [shapes[owner] for owner in sorted(shapes, key=lambda owner: int(owner) if owner.isdecimal() else 0)]


def _shapes(document: Any) -> Iterator[tuple[list[Any], int]]:
    """Rings and level of each feature of a map, of an outline, or of each frame of an animation."""
    if "polygons" in document:
        yield [ring for part in document["polygons"] for ring in (part["outer"], *part.get("holes", ()))], 1
    for part in document.get("frames", ()) or document.get("features", ()):
        yield from _shapes(part)
    geometry = document.get("geometry", document) or {}
    if geometry.get("type") in ("Polygon", "MultiPolygon"):
        several = geometry["coordinates"] if geometry["type"] == "MultiPolygon" else [geometry["coordinates"]]
        level = (document.get("properties") or {}).get("level", 1)
        yield [np.array(ring, float)[:-1, :2] for part in several for ring in part], level


def _parser() -> argparse.ArgumentParser:
    options = argparse.ArgumentParser(prog="nested-cages check", description=DESCRIPTION, epilog=EPILOG)
    options.add_argument("drawing", metavar="DRAWING")
    options.add_argument("result", metavar="RESULT")
    options.add_argument("--clearance", type=length, metavar="LENGTH", help="smallest distance (default: above 0)")
    options.add_argument("--inside", action="store_true", help="the cages lie inside the drawing")
    options.add_argument("--any-loops", action="store_true", help="cages may close holes and wrap several parts")
    grids = options.add_mutually_exclusive_group()
    grids.add_argument("--grid", type=length, metavar="LENGTH", help="coordinates are multiples of this length")
    grids.add_argument("--decimals", type=decimals, metavar="N", help="the same by decimals")
    options.add_argument("--symmetry", type=symmetry, metavar="WHAT", help="x, y or an order of rotations")
    options.add_argument("--distance", type=length, metavar="LENGTH", help="no cage reaches farther than this")
    options.add_argument("--tolerance", type=length, metavar="LENGTH", help="of curves of a drawing, as when reading")
    return options
