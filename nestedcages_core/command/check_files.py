"""`nested-cages check DRAWING RESULT`: the cages written in a file, judged by the independent checker."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence

import numpy as np

from ..checker import TOLERANCE, check, faults_of_motion, faults_of_rings
from ..errors import NestedCagesError, invalid_file
from ..formats import DRAWING_LIMITS, read_whole
from ..formats.decimals import turned_over
from ..formats.pictures import HALF, alpha_channel, boundaries_of_picture
from ..geometry.mesh import Mesh
from ..levels import Share, Within
from .printing import sentence_of, tell
from .results import Levels, Results, look_of, read_picture, read_results
from .sources import DOWN, Shape, Source, limits_of, read

MOST_SAID = 20
"""Maximum number of problems that are printed."""

PER_POINT, PER_LOOP_AND_POINT, PER_PAIR = 3e-5, 5e-8, 3e-7
"""Seconds that checking takes (measured): for each point, loop times points, and with distances two points."""


def files_fail(given: argparse.Namespace) -> bool:
    """Check a result; whether something does not hold, or cannot be read."""
    *given.drawing, given.result = given.drawing
    kind, lost, summary, path = "error", list[str](), "", given.result
    try:
        results = read_results(given.result, limits_of(given))
        given.inside |= all(level <= 0 for levels in results.shapes for level in levels)
        path = ", ".join(given.drawing)
        drawings = _drawings(given)
        path = given.result
        if results.picture:
            read_picture(results.picture, drawings)
            results = results._replace(crs=drawings.crs, pixels=drawings.pixels)
        _allow(given, drawings, results)
        kind, summary = "wrong", _summary(results)
        problems = list(_problems(given, drawings, results, lost))
    except (OSError, NestedCagesError) as error:
        kind, said = "error", sentence_of(error, path)
        problems = [said if said.startswith(path) else f"{path}: {said}"]
    for problem in problems[:MOST_SAID]:
        tell(f"{kind}: {problem}", sys.stderr)
    if len(problems) > MOST_SAID:
        tell(f"and {len(problems) - MOST_SAID} more", sys.stderr)
    if not problems:
        tell("\n".join([summary, *lost]), sys.stdout)
    return bool(problems)


def _drawings(given: argparse.Namespace) -> Source:
    """The drawings of a file; several files are the frames of a motion, one each. Raises NestedCagesError."""
    files = [_drawing(path, given) for path in given.drawing]
    if len(files) == 1:
        return files[0]
    for each in files:
        if len(each.shapes) != 1:
            raise invalid_file(f"{each.path} has {len(each.shapes)} shapes; a frame of a motion is one.")
    frames = [each.shapes[0]._replace(properties={"time": time}) for time, each in enumerate(files)]
    same = all(each.pixels == files[0].pixels for each in files)
    return files[0]._replace(shapes=frames, pixels=files[0].pixels if same else DOWN)


def _drawing(path: str, given: argparse.Namespace) -> Source:
    """The drawings of one file; of a picture of this program those that it shows."""
    if path.lower().endswith(".svg") and b'class="level-1"' in (content := read_whole(path, DRAWING_LIMITS)):
        shapes, frame, y_up = read_picture(content)
        shown = [Shape("drawing", levels[0]) for levels in shapes]
        return Source(path, "drawing", shown, frame=frame, pixels=None if y_up else DOWN)
    source = read(path, given)
    if source.failures:
        raise invalid_file(" ".join(source.failures))
    return source


def _allow(given: argparse.Namespace, drawings: Source, results: Results) -> None:
    """Raise NestedCagesError if checking takes longer than the limit for seconds."""
    fines = [shape.content for shape in drawings.shapes if isinstance(shape.content, Mesh)]
    meshes = [*fines, *(mesh for levels in results.shapes for mesh in levels.values())]
    points, loops = np.array([(len(mesh.vertices), len(mesh.loops)) for mesh in meshes] or [(0, 0)], float).T
    far = given.distance is not None or any(isinstance(level, Within) for level in given.levels)
    each = PER_POINT * points + PER_LOOP_AND_POINT * loops * points + far * PER_PAIR * points**2
    seconds, allowed = int(each.sum()), limits_of(given).seconds
    if seconds > allowed:
        raise NestedCagesError(
            f"Checking {loops.sum():,.0f} loops with {points.sum():,.0f} points takes about {seconds:,} s, more than "
            f"the {allowed:,} s allowed; raise the limit by --limit seconds={seconds + 1}.",
            code="limit.exceeded",
            what="seconds",
        )


def _problems(given: argparse.Namespace, drawings: Source, results: Results, lost: list[str]) -> Iterator[str]:
    """What is wrong; lost: gets what is said of loops that have none of their own."""
    drawn, count = ", ".join(given.drawing), len(drawings.shapes)
    if count != len(results.shapes):
        yield f"{drawn} has {count} shape{'s' * (count != 1)}, {given.result} cages of {len(results.shapes)}"
        return
    placed = _placed(drawings, results)
    if placed is None:
        yield f"{given.result} has another coordinate reference system than {drawn}, or lies on another picture"
        return
    clearance = None if any(shape.drawn for shape in drawings.shapes) else given.clearance
    fines = list[Mesh]()
    for number, (shape, levels) in enumerate(zip(drawings.shapes, placed, strict=True)):
        of_shape, outlines = f"shape {number + 1}: " if count > 1 else "", _outlines(shape, given)
        fine = shape.content if isinstance(shape.content, Mesh) else outlines[0]
        shown = [mesh for mesh in outlines if 0 not in levels or _ends(mesh) == _ends(levels[0])]
        if not shown or (results.looks and results.looks[number] != look_of(shape.properties)):
            yield f"{of_shape}{given.result} shows another drawing, time or style than {drawn} has"
            continue
        fines.append(fine)
        for side in (1, -1):
            cages = [levels[level] for level in sorted(levels, key=abs) if side * level > 0]
            if not cages and (side < 0 or any(levels)):
                continue
            inside = side < 0 or given.inside
            may_differ = given.any_loops or fine is not shape.content  # holes of pictures are closed
            more = map(_has_more, (fine, *cages), cages)
            verdict = check(
                fine,
                cages,
                clearance,
                same_loops=[given.same_loops or (each and not may_differ) for each in more],
                inside=inside,
                **{name: getattr(given, name) for name in ("grid", "symmetry", "distance")},
            )
            lost += [f"{of_shape}{sentence}" for sentence in verdict.lost]
            faults = [[*_faults_of_levels(given, outline, cages, inside)] for outline in shown]
            rings = faults_of_rings(cages[0], shape.given, inside=inside) if cages and len(shape.given) else []
            yield from (f"{of_shape}{problem}" for problem in (*verdict.problems, *min(faults, key=len), *rings))
    times = [shape.properties.get("time") for shape in drawings.shapes]
    numbers = [time for time in times if isinstance(time, int | float)]
    if len(given.drawing) == 1 < count == len(fines) and sorted({*numbers}) == times and _correspond(fines):
        yield from _faults_between([levels[1] for levels in results.shapes if 1 in levels], fines)


def _placed(drawings: Source, results: Results) -> list[Levels] | None:
    """The levels of results with y as in the drawings; None if they lie on another picture, or in another system."""
    systems = [None if "CRS84" in json.dumps(each.crs) else each.crs for each in (drawings, results)]  # the default
    if systems[0] != systems[1] or (drawings.pixels is None) != (results.pixels is None):
        return None
    if drawings.pixels is None or results.pixels is None:
        return results.shapes
    if {**drawings.pixels, "y": 0} != {**results.pixels, "y": 0} or results.pixels.get("y") not in ("up", "down"):
        return None
    if drawings.y_up == (results.pixels["y"] == "up"):
        return results.shapes
    height = float(drawings.pixels.get("height") or 0.0)
    return [{level: turned_over(mesh, height) for level, mesh in each.items()} for each in results.shapes]


def _outlines(shape: Shape, given: argparse.Namespace) -> list[Mesh]:
    """What may be shown of a shape: of pixels also the outline with holes closed, or with narrow gaps filled."""
    if isinstance(shape.content, Mesh):
        return [shape.drawn or shape.content]
    threshold = HALF if given.threshold is None else given.threshold
    return boundaries_of_picture(alpha_channel(shape.content) > threshold, given.clearance or 0.0)


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


def _summary(results: Results) -> str:
    """What was checked: the levels with their vertices and loops, of all shapes together."""
    levels = sorted({level for each in results.shapes for level in each if level}, key=lambda k: (k < 0, abs(k)))
    by_level = {level: [each[level] for each in results.shapes if level in each] for level in levels}
    lines = [f"{sum(map(len, by_level.values()))} cages: everything holds."]
    for level, cages in by_level.items():
        sizes = f"{sum(len(cage.vertices) for cage in cages)} vertices, {sum(len(cage.loops) for cage in cages)} loops"
        lines.append(f"{'inner ' * (level < 0)}level {abs(level)}: {len(cages)} shapes, {sizes}")
    return "\n".join(lines)


def _correspond(frames: Sequence[Mesh]) -> bool:
    """Whether the vertices of each frame are those of the others, moved."""
    return all(np.array_equal(frame.edges, frames[0].edges) for frame in frames)


def _faults_between(cages: Sequence[Mesh], drawings: Sequence[Mesh]) -> list[str]:
    """Contacts on the straight lines from each frame to the next."""
    if len(cages) < len(drawings) or not _correspond(cages):
        return ["cages differ in their numbers of vertices, so the motion between them is not known"]
    steps = [np.stack([frame.vertices for frame in frames]) for frames in (cages, drawings)]
    return faults_of_motion(cages[0].edges, drawings[0].edges, steps[0], steps[1], range(len(cages) - 1))
