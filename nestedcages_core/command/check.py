"""`nested-cages check DRAWING RESULT`: the cages written in a file, judged by the independent checker."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ..checker import TOLERANCE, check, faults_of_motion
from ..errors import NestedCagesError
from ..formats.pictures import HALF
from ..levels import Share, Within, level_words, parse_level
from .options import length, symmetry
from .progress import tell
from .written import Levels, Loops, Shapes, pages_differ, read_cages, read_frames

HOLDS, WRONG = 0, 1
"""Exit statuses; wrong use ends with 2, by argparse."""

MOST_SAID = 20
"""Maximum number of problems that are printed."""

DESCRIPTION = """\
Checks cages that this program has written: without rounding, on the coordinates in the files, by code that shares
nothing with the method. RESULT is the .svg, .geojson or .json that was written, DRAWING what it was made from. Both are
read as viewers show them: what is hidden does not count, and what cannot be judged is rejected.
Two .json with frames are checked at each frame, and on the straight lines in between; frames made from several
pictures are checked around each of these. A single FILE.blend is checked as Blender plays it, with the add-on's folder
next to this package and Blender as a Python module."""

EPILOG = "exit status: 0 everything holds, 1 something does not or a file cannot be read, 2 wrong use of the options"


def check_files(arguments: Sequence[str]) -> int:
    """Run the command; the exit status."""
    if len(arguments) == 1 and arguments[0].lower().endswith(".blend"):
        return _check_animation(Path(arguments[0]))
    options = _parser()
    given = options.parse_args(arguments)
    try:
        given.levels = [parse_level(word) for word in level_words(" ".join(given.levels or ()))]
    except NestedCagesError as error:
        options.error(f"argument --levels: {error}")
    kind, judged, lost = "error", "", list[str]()
    try:
        drawings = read_frames(given.drawing, given.tolerance, together=given.borders, threshold=given.threshold)
        results = read_cages(given.result, together=given.borders)
        if given.flip_y:
            turned = [
                {level: loops.flipped(drawings.height) for level, loops in each.items()} for each in results.shapes
            ]
            results = results._replace(shapes=turned)
        kind, judged = "wrong", _judged(results)
        problems = list(_problems(given, drawings, results, lost))
    except OSError as error:
        problems = [f"{error.filename}: {error.strerror}"]
    except (NestedCagesError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        problems = [f"the files cannot be read as outlines: {error}"]
    more = len(problems) - MOST_SAID
    for problem in [*problems[:MOST_SAID], *([f"and {more} more"] if more > 0 else [])]:
        tell(f"{kind}: {problem}", sys.stderr)
    if not problems:
        more = len(lost) - MOST_SAID
        tell("\n".join([judged, *lost[:MOST_SAID], *([f"and {more} more"] if more > 0 else [])]), sys.stdout)
    return WRONG if problems else HOLDS


def _check_animation(path: Path) -> int:
    """Check what Blender plays of a file, by the add-on's own program."""
    for needed in (path, program := Path(__file__).resolve().parents[2] / "addon" / "__main__.py"):
        if not needed.is_file():
            tell(f"error: {needed}: No such file", sys.stderr)
            return WRONG
    return subprocess.run([sys.executable, program, path], check=False).returncode


def _problems(given: argparse.Namespace, drawings: Shapes, results: Shapes, lost: list[str]) -> Iterator[str]:
    """What is wrong; lost: gets what is said of loops that have none of their own."""
    drawn = ", ".join(given.drawing)
    if len(drawings.shapes) != len(results.shapes):
        yield f"{drawn} has {len(drawings.shapes)} shapes, {given.result} cages of {len(results.shapes)}"
        return
    if drawings.moves != results.moves:
        yield "only one of the files has the frames of a motion"
        return
    if drawings.y_up and results.frame is not None:
        drawings = drawings._replace(shapes=[{0: levels[0].flipped(0.0)} for levels in drawings.shapes])
    yield from _faults_of_page(given, drawings, results)
    is_picture = Path(given.drawing[0]).suffix.lower() == ".png"  # whose holes are closed and whose parts may be joined
    options = {
        "grid": given.grid,
        "symmetry": given.symmetry,
        "distance": given.distance,
    }
    for number, (drawing, levels) in enumerate(zip(drawings.shapes, results.shapes, strict=True), 1):
        of_shape = f"shape {number}: " if len(results.shapes) > 1 else ""
        for inside, cages in _sides(levels):
            options["inside"] = given.inside or inside
            may_differ = given.any_loops or given.borders or is_picture
            as_many = map(_has_more, (drawing[0], *cages), cages)
            options["same_loops"] = [given.same_loops or (more and not may_differ) for more in as_many]
            shown = levels.get(0, drawing[0])
            for around in (drawing[0], *([] if _equal(shown, drawing[0]) else [shown])):
                verdict = check(around.rings, [cage.rings for cage in cages], given.clearance, **options)
                yield from (f"{of_shape}{problem}" for problem in verdict.problems)
            lost += [f"{of_shape}{sentence}" for sentence in verdict.lost]
            yield from (f"{of_shape}{problem}" for problem in _faults_of_levels(given, drawing[0], cages, inside))
    if results.moves and len(given.drawing) == 1:
        yield from _faults_between([levels[1] for levels in results.shapes], [each[0] for each in drawings.shapes])


def _sides(levels: Levels) -> Iterator[tuple[bool, list[Loops]]]:
    """The cages of a shape from the finest on, those outside and those inside; without any, none outside."""
    for side in (1, -1):
        cages = [levels[level] for level in sorted(levels, key=abs) if side * level > 0]
        if cages or (side > 0 and not any(levels)):
            yield side < 0, cages


def _has_more(inner: Loops, outer: Loops) -> bool:
    """Whether the outer one of two cages, or of a drawing and a cage, has as many loops or more of one kind."""
    counts = [np.bincount(np.less(loops.areas, 0.0), minlength=2) for loops in (inner, outer)]
    return bool((counts[1] > counts[0]).any() or (counts[1] == counts[0]).all())


def _equal(one: Loops, other: Loops) -> bool:
    return len(one.rings) == len(other.rings) and all(map(np.array_equal, one.rings, other.rings))


def _faults_of_page(given: argparse.Namespace, drawings: Shapes, results: Shapes) -> Iterator[str]:
    """Pictures whose pages show other places."""
    if results.frame is None:
        return
    if drawings.frame is not None and drawings.frame.page is not None:
        if pages_differ(drawings.frame, results.frame):
            yield f"{given.result} is drawn on another page, or in another view box, than {given.drawing[0]}"
        return
    box = results.frame.page
    points = np.concatenate([ring for levels in drawings.shapes for ring in levels[0].rings])
    if box is None or not ((points >= box[:2]) & (points <= np.add(box[:2], box[2:]))).all():
        yield f"the page of {given.result} does not show all of {given.drawing[0]}"


def _faults_of_levels(given: argparse.Namespace, drawing: Loops, cages: Sequence[Loops], inside: bool) -> Iterator[str]:
    """Levels that are missing, or are not as they were asked for."""
    if given.levels and len(given.levels) != len(cages):
        yield f"there are {len(cages)} levels, not {len(given.levels)}"
        return
    for number, (level, cage) in enumerate(zip(given.levels, cages, strict=False), 1):
        if isinstance(level, Within) and level.distance is not None:
            found = check(drawing.rings, cage.rings, distance=level.limit, same_loops=False, inside=inside)
            yield from (f"level {number}: {problem}" for problem in found.problems)
        elif isinstance(level, Within):
            excess = abs(cage.area / drawing.area - 1.0)
            if excess > level.limit * (1.0 + float(TOLERANCE)):
                yield f"level {number} has an excess of {100.0 * excess:.6g} %, not {100.0 * level.limit:.6g} %"
        else:
            sizes = [len(ring) for ring in drawing.rings]
            most = level.of(sizes, keeps=given.same_loops) if isinstance(level, Share) else level
            if cage.count > most:
                yield f"level {number} has {cage.count} vertices, not {most}"


def _judged(results: Shapes) -> str:
    """What was judged: the levels with their vertices and loops, of all shapes together."""
    levels = sorted({level for levels in results.shapes for level in levels if level}, key=lambda k: (k < 0, abs(k)))
    lines, total = [], 0
    for level in levels:
        cages = [levels[level] for levels in results.shapes if level in levels]
        total += len(cages)
        counts = (sum(cage.count for cage in cages), "vertices"), (sum(len(cage.rings) for cage in cages), "loops")
        several = [(len(cages), "frames" if results.moves else "shapes")] if len(results.shapes) > 1 else []
        said = (f"{count} {name if count != 1 else name[:-1]}" for count, name in (*several, *counts))
        lines.append(f"{'inner ' if level < 0 else ''}level {abs(level)}: {', '.join(said)}")
    return "\n".join([f"{total} cage{'s' * (total != 1)}: everything holds.", *lines])


def _faults_between(cages: Sequence[Loops], drawings: Sequence[Loops]) -> list[str]:
    """Contacts on the straight lines from each frame to the next, for frames with corresponding vertices."""
    for frames in (cages, drawings):
        if any(not np.array_equal(frame.edges, frames[0].edges) for frame in frames):
            return ["frames differ in their numbers of vertices, so the motion between them is not known"]
    steps = [np.stack([np.concatenate(frame.rings) for frame in frames]) for frames in (cages, drawings)]
    return faults_of_motion(cages[0].edges, drawings[0].edges, steps[0], steps[1], range(len(cages) - 1))


def _parser() -> argparse.ArgumentParser:
    options = argparse.ArgumentParser(prog="nested-cages check", description=DESCRIPTION, epilog=EPILOG)
    options.add_argument("drawing", metavar="DRAWING", nargs="+", help="several: pictures of the frames of a motion")
    options.add_argument("result", metavar="RESULT")
    options.add_argument("--levels", nargs="+", metavar="N", help="what each cage must have at most, none left out")
    options.add_argument("--clearance", type=length, metavar="LENGTH", help="smallest distance (default: above 0)")
    options.add_argument("--flip-y", action="store_true", help="the result was written with this option")
    options.add_argument("--inside", action="store_true", help="the cages lie inside the drawing")
    loops = options.add_mutually_exclusive_group()
    loops.add_argument(
        "--same-loops",
        action="store_true",
        help="each loop has one of its own: no hole is filled, no parts share one (default: they are named)",
    )
    loops.add_argument("--any-loops", action="store_true", help="cages may have other loops, and more")
    options.add_argument("--borders", action="store_true", help="all regions together, as --borders makes them")
    options.add_argument("--grid", type=length, metavar="LENGTH", help="coordinates are multiples of this length")
    options.add_argument("--symmetry", type=symmetry, metavar="WHAT", help="x, y or an order of rotations")
    options.add_argument("--distance", type=length, metavar="LENGTH", help="no cage reaches farther than this")
    options.add_argument("--tolerance", type=length, metavar="LENGTH", help="of curves of a drawing, as when reading")
    options.add_argument("--threshold", type=float, default=HALF, metavar="ALPHA", help="of a picture, as when reading")
    return options
