"""`nested-cages check DRAWING RESULT`: the cages written in a file, judged by the independent checker."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..checker import TOLERANCE, check, faults_of_motion, faults_of_rings
from ..errors import NestedCagesError
from ..formats import Frame
from ..formats.decimals import turned_over
from ..formats.lonlat import may_be_degrees
from ..geometry.mesh import Mesh
from ..levels import Share, Within
from .options import Metres
from .progress import tell
from .sources import DOWN, is_up
from .written import Drawing, Levels, Page, Written, read_cages, read_drawings

HOLDS, WRONG = 0, 1
"""Exit statuses; wrong use ends with 2, by argparse."""

MOST_SAID = 20
"""Maximum number of problems that are printed."""

SAME_PAGE = 1e-6
"""Difference of two pages, over the largest number, that is the rounding of their decimals."""


def check_files(given: argparse.Namespace) -> int:
    """Run the command; the exit status."""
    kind, lost, summary = "error", list[str](), ""
    try:
        results = read_cages(given.result)
        given.inside |= all(level <= 0 for levels in results.shapes for level in levels)
        drawings, page = read_drawings(given)
        kind, summary = "wrong", _summary(results)
        problems = list(_problems(given, drawings, page, results, lost))
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


def _problems(
    given: argparse.Namespace, drawings: Sequence[Drawing], page: Page, results: Written, lost: list[str]
) -> Iterator[str]:
    """What is wrong; lost: gets what is said of loops that have none of their own."""
    drawn, count = ", ".join(given.drawing), len(drawings)
    if count != len(results.shapes):
        yield f"{drawn} has {count} shape{'s' * (count != 1)}, {given.result} cages of {len(results.shapes)}"
        return
    if problem := _other_place(drawings, page, results):
        yield f"{given.result} {problem} than {drawn}"
        return
    may_differ = given.any_loops or Path(given.drawing[0]).suffix.lower() == ".png"  # its holes are closed
    clearance = None if isinstance(given.clearance, Metres) and may_be_degrees(page.crs) else given.clearance
    options: dict[str, Any] = {"grid": given.grid, "symmetry": given.symmetry, "distance": given.distance}
    for number, (drawing, levels) in enumerate(zip(drawings, _in_place(page, results), strict=True)):
        of_shape = f"shape {number + 1}: " if count > 1 else ""
        outlines = [mesh for mesh in drawing.shown if 0 not in levels or _ends(mesh) == _ends(levels[0])]
        if not outlines or (results.styles and results.styles[number] != drawing.style):
            yield f"{of_shape}{given.result} shows another drawing, or another style, than {drawn} has"
            continue
        for inside, cages in _sides(levels, given.inside):
            as_many = map(_has_more, (drawing.mesh, *cages), cages)
            options["same_loops"] = [given.same_loops or (more and not may_differ) for more in as_many]
            verdict = check(drawing.mesh, cages, clearance, inside=inside, **options)
            faults = [[*_faults_of_levels(given, outline, cages, inside)] for outline in outlines]
            problems = [*verdict.problems, *min(faults, key=len)]
            if cages and len(drawing.given):
                problems += faults_of_rings(cages[0], drawing.given, inside=inside)
            yield from (f"{of_shape}{problem}" for problem in problems)
            lost += [f"{of_shape}{sentence}" for sentence in verdict.lost]
    fines = [drawing.mesh for drawing in drawings]
    if page.times and len(given.drawing) == 1 and _correspond(fines):
        yield from _faults_between([levels[1] for levels in results.shapes], fines)


def _other_place(drawings: Sequence[Drawing], page: Page, results: Written) -> str:
    """Why the coordinates of results are not those of drawings; empty if they are."""
    own = results.page
    if own.frame is not None:
        if is_up(page.pixels) != results.y_up:
            return "shows cages turned over, otherwise"
        return "" if _shows(drawings, page, own.frame) else "has another page, or view box, and may not show all,"
    if (page.pixels is None) != (own.pixels is None):
        return f"has coordinates {'of a map' if own.pixels is None else 'in pixels'}, other ones"
    sizes = [[(each.pixels or {}).get(key) for key in ("width", "height")] for each in (page, own)]
    if sizes[0] != sizes[1] or (own.pixels or DOWN).get("y") not in ("up", "down"):
        return "has pixels of another picture"
    if _system(page.crs) != _system(own.crs):
        return f"has another coordinate reference system, {own.crs!s:.80},"
    return "has other times" if [*own.times] != [*page.times] else ""


def _shows(drawings: Sequence[Drawing], page: Page, frame: Frame) -> bool:
    """Whether a frame is that of the drawings, or if they have none, shows all of them in their proportions."""
    own, shown = page.frame, frame.page
    if own is not None and own.page is not None:
        words = [(each.width, each.height, each.preserve_aspect_ratio) for each in (own, frame)]
        boxes = np.array([each.view_box or each.page for each in (own, frame)], float)
        return words[0] == words[1] and bool(np.allclose(boxes[0], boxes[1], 0.0, SAME_PAGE * np.abs(boxes).max()))
    if (
        shown is None
        or shown != frame.view_box
        or frame.preserve_aspect_ratio
        or bool(frame.width) != bool(frame.height)
    ):
        return False
    points = np.concatenate([drawing.mesh.vertices for drawing in drawings])
    points = points * (1.0, -1.0 if is_up(page.pixels) else 1.0)
    return bool(((points >= shown[:2]) & (points <= np.add(shown[:2], shown[2:]))).all())


def _system(crs: Any) -> Any:
    """A coordinate reference system; that of GeoJSON, which needs no name, is None."""
    return None if "CRS84" in json.dumps(crs) else crs


def _in_place(page: Page, results: Written) -> list[Levels]:
    """The levels of results with y as in the drawings."""
    pixels = results.page.pixels
    if pixels is None or is_up(pixels) == is_up(page.pixels):
        return results.shapes
    height = float(pixels.get("height") or 0.0)
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
            sizes, keeps = list(map(len, fine.loops)), given.same_loops or inside
            most = level.of(sizes, keeps=keeps) if isinstance(level, Share) else level
            if len(cage.vertices) > most and not (keeps and isinstance(level, Share)):  # shares rise to keep loops
                yield f"level {number} has {len(cage.vertices)} vertices, not {most}"


def _summary(results: Written) -> str:
    """What was checked: the levels with their vertices and loops, of all shapes together."""
    levels = sorted({level for levels in results.shapes for level in levels if level}, key=lambda k: (k < 0, abs(k)))
    lines, total = [], 0
    for level in levels:
        cages = [levels[level] for levels in results.shapes if level in levels]
        total += len(cages)
        counts = [(sum(len(cage.vertices) for cage in cages), "vertices"), (sum(len(c.loops) for c in cages), "loops")]
        several = [(len(cages), "frames" if results.page.times else "shapes")] if len(results.shapes) > 1 else []
        said = (f"{count} {name if count != 1 else name[:-1]}" for count, name in (*several, *counts))
        lines.append(f"{'inner ' if level < 0 else ''}level {abs(level)}: {', '.join(said)}")
    return "\n".join([f"{total} cage{'s' * (total != 1)}: everything holds.", *lines])


def _correspond(frames: Sequence[Mesh]) -> bool:
    """Whether the vertices of each frame are those of the others, moved."""
    return all(np.array_equal(frame.edges, frames[0].edges) for frame in frames)


def _faults_between(cages: Sequence[Mesh], drawings: Sequence[Mesh]) -> list[str]:
    """Contacts on the straight lines from each frame to the next."""
    if not _correspond(cages):
        return ["cages differ in their numbers of vertices, so the motion between them is not known"]
    steps = [np.stack([frame.vertices for frame in frames]) for frames in (cages, drawings)]
    return faults_of_motion(cages[0].edges, drawings[0].edges, steps[0], steps[1], range(len(cages) - 1))
