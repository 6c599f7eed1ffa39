"""`nested-cages check DRAWING RESULT`: the cages written in a file, judged by the independent checker."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..checker import TOLERANCE, check, faults_of_motion, faults_of_rings
from ..errors import NestedCagesError
from ..formats import Frame
from ..formats.decimals import turned_over
from ..formats.pictures import HALF
from ..geometry.mesh import Mesh
from ..levels import Share, Within, in_order, level_words, parse_level
from .options import OPTIONS, length, of_drawings, symmetry
from .progress import tell
from .sources import DOWN, is_up
from .written import Levels, Written, read_cages, read_drawings

HOLDS, WRONG = 0, 1
"""Exit statuses; wrong use ends with 2, by argparse."""

MOST_SAID = 20
"""Maximum number of problems that are printed."""

SAME_PAGE = 1e-6
"""Difference of two pages, over the largest number, that is the rounding of their decimals."""

DESCRIPTION = """\
Checks cages in a file: without rounding, on the coordinates in the files, by code that shares nothing with the method.
RESULT is an .svg that this program has written, word by word, or a GeoJSON of polygons alone, of any program; anything
else is rejected. DRAWING is what the cages were made from, read with the same options; several pictures are the frames
of a motion. GeoJSON with the frames of a motion on both sides is checked on the straight lines in between too. A
single FILE.blend is checked as Blender plays it, with the add-on's folder next to this package and Blender as a Python
module."""

EPILOG = "exit status: 0 everything holds, 1 something does not or a file cannot be read, 2 wrong use of the options"


def check_files(arguments: Sequence[str]) -> int:
    """Run the command; the exit status."""
    if len(arguments) == 1 and arguments[0].lower().endswith(".blend"):
        return _check_animation(Path(arguments[0]))
    options = _parser()
    given = options.parse_args(arguments)
    try:
        given.levels = in_order([parse_level(word) for word in level_words(" ".join(given.levels or ()))])
    except NestedCagesError as error:
        options.error(f"argument --levels: {error}")
    kind, lost, summary = "error", list[str](), ""
    try:
        drawings = read_drawings(given.drawing, of_drawings(given), given.threshold, given.clearance or 0.0)
        results = read_cages(given.result)
        kind, summary = "wrong", _summary(results)
        problems = list(_problems(given, drawings, results, lost))
    except OSError as error:
        problems = [f"{error.filename}: {error.strerror}"]
    except (NestedCagesError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        problems = [f"the files cannot be read as outlines: {error}"]
    for problem in _first(problems):
        tell(f"{kind}: {problem}", sys.stderr)
    if not problems:
        tell("\n".join([summary, *_first(lost)]), sys.stdout)
    return WRONG if problems else HOLDS


def _first(sentences: Sequence[str]) -> list[str]:
    """So many that they can be read, and how many more there are."""
    more = len(sentences) - MOST_SAID
    return [*sentences[:MOST_SAID], *([f"and {more} more"] if more > 0 else [])]


def _check_animation(path: Path) -> int:
    """Check what Blender plays of a file, by the add-on's own program."""
    for needed in (path, program := Path(__file__).resolve().parents[2] / "addon" / "__main__.py"):
        if not needed.is_file():
            tell(f"error: {needed}: No such file", sys.stderr)
            return WRONG
    return subprocess.run([sys.executable, program, path], check=False).returncode


def _problems(given: argparse.Namespace, drawings: Written, results: Written, lost: list[str]) -> Iterator[str]:
    """What is wrong; lost: gets what is said of loops that have none of their own."""
    drawn, count = ", ".join(given.drawing), len(drawings.shapes)
    if count != len(results.shapes):
        yield f"{drawn} has {count} shape{'s' * (count != 1)}, {given.result} cages of {len(results.shapes)}"
        return
    if problem := _other_place(drawings, results):
        yield f"{given.result} {problem} than {drawn}"
        return
    is_picture = Path(given.drawing[0]).suffix.lower() == ".png"  # whose holes are closed and whose parts may be joined
    options: dict[str, Any] = {"grid": given.grid, "symmetry": given.symmetry, "distance": given.distance}
    for number, (drawing, levels) in enumerate(zip(drawings.shapes, _in_place(drawings, results), strict=True)):
        of_shape = f"shape {number + 1}: " if count > 1 else ""
        outlines = [drawing[0], *drawings.also]
        if 0 in levels:
            outlines = [mesh for mesh in outlines if _ends(mesh) == _ends(levels[0])]
            if not outlines:
                yield f"{of_shape}{given.result} shows another drawing than that of {drawn}"
                continue
        for inside, cages in _sides(levels, given.inside):
            as_many = map(_has_more, (drawing[0], *cages), cages)
            options["same_loops"] = [given.same_loops or (m and not (given.any_loops or is_picture)) for m in as_many]
            verdict = check(drawing[0], cages, given.clearance, inside=inside, **options)
            faults = [[*_faults_of_levels(given, outline, cages, inside)] for outline in outlines]
            problems = [*verdict.problems, *min(faults, key=len)]
            if cages and any(drawings.given[number : number + 1]):
                problems += faults_of_rings(cages[0], drawings.given[number], inside=inside)
            yield from (f"{of_shape}{problem}" for problem in problems)
            lost += [f"{of_shape}{sentence}" for sentence in verdict.lost]
    if drawings.times and len(given.drawing) == 1:
        yield from _faults_between([levels[1] for levels in results.shapes], [each[0] for each in drawings.shapes])


def _other_place(drawings: Written, results: Written) -> str:
    """Why the coordinates of results are not those of drawings; empty if they are."""
    if results.frame is None:
        if (drawings.pixels is None) != (results.pixels is None):
            return f"has coordinates {'of a map' if results.pixels is None else 'in pixels'}, other ones"
        sizes = [[(each.pixels or {}).get(key) for key in ("width", "height")] for each in (drawings, results)]
        if sizes[0] != sizes[1] or (results.pixels or DOWN).get("y") not in ("up", "down"):
            return "has pixels of another picture"
        if _system(drawings.crs) != _system(results.crs):
            return f"has another coordinate reference system, {results.crs!s:.80},"
        return "has other times" if results.times != drawings.times else ""
    if is_up(drawings.pixels) != results.y_up:
        return "shows cages turned over, otherwise"
    return "" if _shows(drawings, results.frame) else "has another page, or view box, and may not show all,"


def _shows(drawings: Written, frame: Frame) -> bool:
    """Whether a page is that of the drawings, or if they have none, shows all of them in their proportions."""
    own, page = drawings.frame, frame.page
    if own is not None and own.page is not None:
        words = [(each.width, each.height, each.preserve_aspect_ratio) for each in (own, frame)]
        boxes = np.array([each.view_box or each.page for each in (own, frame)], float)
        return words[0] == words[1] and bool(np.allclose(boxes[0], boxes[1], 0.0, SAME_PAGE * np.abs(boxes).max()))
    if page is None or page != frame.view_box or frame.preserve_aspect_ratio or bool(frame.width) != bool(frame.height):
        return False
    points = np.concatenate([levels[0].vertices for levels in drawings.shapes])
    points = points * (1.0, -1.0 if is_up(drawings.pixels) else 1.0)
    return bool(((points >= page[:2]) & (points <= np.add(page[:2], page[2:]))).all())


def _system(crs: Any) -> Any:
    """A coordinate reference system; that of GeoJSON, which needs no name, is None."""
    return None if "CRS84" in json.dumps(crs) else crs


def _in_place(drawings: Written, results: Written) -> list[Levels]:
    """The levels of results with y as in the drawings."""
    if results.pixels is None or drawings.pixels is None or results.pixels["y"] == drawings.pixels.get("y"):
        return results.shapes
    height = float(results.pixels.get("height") or 0.0)
    return [{level: turned_over(mesh, height) for level, mesh in each.items()} for each in results.shapes]


def _sides(levels: Levels, inside: bool) -> Iterator[tuple[bool, list[Mesh]]]:
    """The cages of a shape from the finest on, those outside and those inside; without any, none outside."""
    for side in (1, -1):
        cages = [levels[level] for level in sorted(levels, key=abs) if side * level > 0]
        if cages or (side > 0 and not any(levels)):
            yield inside or side < 0, cages


def _has_more(inner: Mesh, outer: Mesh) -> bool:
    """Whether the outer one of two cages, or of a drawing and a cage, has as many loops or more of one kind."""
    counts = [np.bincount(mesh.loop_signs < 0, minlength=2) for mesh in (inner, outer)]
    return bool((counts[1] > counts[0]).any() or (counts[1] == counts[0]).all())


def _ends(mesh: Mesh) -> set[tuple[float, ...]]:
    """The edges of a mesh, each by its coordinates."""
    return {*map(tuple, np.hstack([mesh.vertices, mesh.edge_ends]).tolist())}


def _faults_of_levels(given: argparse.Namespace, fine: Mesh, cages: Sequence[Mesh], inside: bool) -> Iterator[str]:
    """Levels that are missing, or are not as they were asked for."""
    if given.levels and len(given.levels) != len(cages):
        yield f"there are {len(cages)} levels, not {len(given.levels)}"
        return
    for number, (level, cage) in enumerate(zip(given.levels, cages, strict=False), 1):
        if isinstance(level, Within) and level.distance is not None:
            found = check(fine, cage, distance=level.limit, same_loops=False, inside=inside)
            yield from (f"level {number}: {problem}" for problem in found.problems)
        elif isinstance(level, Within):
            excess = abs(cage.area / fine.area - 1.0)
            if excess > level.limit * (1.0 + float(TOLERANCE)):
                yield f"level {number} has an excess of {100.0 * excess:.6g} %, not {100.0 * level.limit:.6g} %"
        else:
            sizes = list(map(len, fine.loops))
            most = level.of(sizes, keeps=given.same_loops or inside) if isinstance(level, Share) else level
            if len(cage.vertices) > most:
                yield f"level {number} has {len(cage.vertices)} vertices, not {most}"


def _summary(results: Written) -> str:
    """What was checked: the levels with their vertices and loops, of all shapes together."""
    levels = sorted({level for levels in results.shapes for level in levels if level}, key=lambda k: (k < 0, abs(k)))
    lines, total = [], 0
    for level in levels:
        cages = [levels[level] for levels in results.shapes if level in levels]
        total += len(cages)
        counts = [(sum(len(cage.vertices) for cage in cages), "vertices"), (sum(len(c.loops) for c in cages), "loops")]
        several = [(len(cages), "frames" if results.times else "shapes")] if len(results.shapes) > 1 else []
        said = (f"{count} {name if count != 1 else name[:-1]}" for count, name in (*several, *counts))
        lines.append(f"{'inner ' if level < 0 else ''}level {abs(level)}: {', '.join(said)}")
    return "\n".join([f"{total} cage{'s' * (total != 1)}: everything holds.", *lines])


def _faults_between(cages: Sequence[Mesh], drawings: Sequence[Mesh]) -> list[str]:
    """Contacts on the straight lines from each frame to the next, for frames with corresponding vertices."""
    for frames in (cages, drawings):
        if any(not np.array_equal(frame.edges, frames[0].edges) for frame in frames):
            return ["frames differ in their numbers of vertices, so the motion between them is not known"]
    steps = [np.stack([frame.vertices for frame in frames]) for frames in (cages, drawings)]
    return faults_of_motion(cages[0].edges, drawings[0].edges, steps[0], steps[1], range(len(cages) - 1))


def _parser() -> argparse.ArgumentParser:
    options = argparse.ArgumentParser(prog="nested-cages check", description=DESCRIPTION, epilog=EPILOG)
    options.add_argument("drawing", metavar="DRAWING", nargs="+", help="several: pictures of the frames of a motion")
    options.add_argument("result", metavar="RESULT")
    options.add_argument("--levels", nargs="+", metavar="N", help="what each cage must have, as when they were made")
    options.add_argument("--clearance", type=length, metavar="LENGTH", help="smallest distance (default: above 0)")
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
    options.add_argument("--threshold", type=float, default=HALF, metavar="ALPHA", help="of a picture, as when reading")
    for names, how in OPTIONS["drawings"]:
        options.add_argument(*names, **how)
    options.set_defaults(limits={})
    return options
