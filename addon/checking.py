"""Cages as they are now, perhaps edited: whether they still hold, and which vertices are at fault."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType

import bpy
import numpy as np
from numpy.typing import NDArray

from .convert import Drawing, Outline, drawing_in, fine_drawing, read
from .refusal import Refusal, say


@dataclass(frozen=True)
class Finding:
    """What was found of one cage and the mesh in it: a sentence, and the points at fault, (k, 3) in each object's
    space.
    """

    cage: str
    fine: str
    holds: bool
    sentence: str
    cage_faults: NDArray[np.float32]
    fine_faults: NDArray[np.float32]


def check(context: bpy.types.Context, objects: Sequence[bpy.types.Object], core: ModuleType) -> list[Finding]:
    """Checks each object against the one before it, as evaluated on the current frame. Raises: Refusal."""
    outlines = [read(context, obj) for obj in objects]
    frame = fine_drawing(outlines[0]).frame
    drawings = [drawing_in(frame, outline) for outline in outlines]
    pairs = zip(outlines[:-1], drawings[:-1], outlines[1:], drawings[1:], strict=True)
    return [_finding(*pair, core) for pair in pairs]


def _finding(inner: Outline, fine: Drawing, outer: Outline, cage: Drawing, core: ModuleType) -> Finding:
    try:
        outside, inside = cage.mesh(core), fine.mesh(core)
        certificate = core.verify(outside, inside, same_loops=outside.has_loops_like(inside))
    except Refusal as refusal:
        holds, sentence = False, str(refusal)
    else:
        holds = bool(certificate.holds)
        words = {
            "clearance": certificate.clearance * fine.frame.scale,
            "excess": 100.0 * certificate.excess,
            "cage": outer.name,
            "fine": inner.name,
            "problems": " ".join(certificate.problems),
        }
        if holds:
            sentence = say("'{cage}' encloses '{fine}': clearance {clearance:.3g}, excess {excess:.2f} %", **words)
        else:
            sentence = say("'{cage}' does not enclose '{fine}'. {problems}", **words)
    cage_faults, fine_faults = _faults(cage, fine, core)
    return Finding(
        outer.name,
        inner.name,
        holds,
        sentence,
        outer.points[cage_faults].astype(np.float32),
        inner.points[fine_faults].astype(np.float32),
    )


def _faults(cage: Drawing, fine: Drawing, core: ModuleType) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which points of both drawings are on edges that cross, or are outside of the cage or inside of a hole of it."""
    predicates = core.predicates
    (points, ends), (fine_points, fine_ends) = (_edges(drawing) for drawing in (cage, fine))
    at_fault, fine_at_fault = np.zeros(len(points), bool), np.zeros(len(fine_points), bool)
    tree, fine_tree = predicates.BoxTree(points, points[ends]), predicates.BoxTree(fine_points, fine_points[fine_ends])
    i, j = predicates.crossing_pairs(tree, fine_tree)
    at_fault[np.concatenate([i, ends[i]])] = True
    fine_at_fault[np.concatenate([j, fine_ends[j]])] = True
    i, j = predicates.crossing_pairs(tree)
    apart = (ends[i] != j) & (ends[j] != i)
    i, j = i[apart], j[apart]
    at_fault[np.concatenate([i, ends[i], j, ends[j]])] = True
    winding = predicates.winding_number(fine_points, points, points[ends])
    # Without the sense of the loops, a point is inside where it is surrounded an odd number of times.
    return at_fault, fine_at_fault | (winding % 2 == 0) | (winding == predicates.ON_BOUNDARY)


def _edges(drawing: Drawing) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """All points (n, 2) of a drawing and for each the index (n,) of the next one along its loop."""
    sizes = [len(loop) for loop in drawing.loops]
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    onward = [start + (np.arange(size) + 1) % size for start, size in zip(starts, sizes, strict=True)]
    return np.concatenate(drawing.loops), np.concatenate(onward)


def select_points(context: bpy.types.Context, obj: bpy.types.Object, points: NDArray[np.float32]) -> int:
    """Selects the vertices of a mesh object that are at evaluated points (k, 3), and only these; returns how many."""
    evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
    shape = evaluated.to_mesh()
    try:
        places = np.empty((len(shape.vertices), 3), np.float32)
        shape.vertices.foreach_get("co", places.ravel())
    finally:
        evaluated.to_mesh_clear()
    mesh = obj.data
    wanted = {point.tobytes() for point in np.ascontiguousarray(points)}
    chosen = np.array([place.tobytes() in wanted for place in places], dtype=bool)
    if len(chosen) != len(mesh.vertices):
        return 0
    mesh.vertices.foreach_set("select", chosen)
    mesh.edges.foreach_set("select", np.zeros(len(mesh.edges), bool))
    mesh.polygons.foreach_set("select", np.zeros(len(mesh.polygons), bool))
    mesh.update()
    return int(chosen.sum())
