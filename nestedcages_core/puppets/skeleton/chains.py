"""Which parts bend, and the places of their joints along the middle."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy

from ...errors import NestedCagesError
from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from ...geometry.vectors import norm, rotated_left
from ...libraries import load_shapely
from ..part import NEEDED_FOR, PuppetPart
from .skeleton import MedialAxis, along_path, medial_axis, pruned, trimmed

LEAF_BENDS, CARRIER_BENDS = 4.4, 9.0
"""A part bends if it is at least this long, in radii, from its joint to its tip; one that carries limbs is stiffer."""

END_BONE, THICK, THINNEST = 0.75, 0.5, 0.4
"""The first and the last bone are this much shorter than those between, which share their length among two blends;
where a part is thicker, bones are longer by this power of the radius, which counts from this part of the median on. Of
95 parts with three bones and more, half then turn 130° at least, not 109° as with equal bones, and 2 less than 90°,
not 15 (`benchmarks/cast`)."""

BONE_LENGTH, MOST_BONES = 4.0, 6
"""Length of a bone in a part that bends, in radii: room for the blends around both of its joints; and the most bones
that a draft gives a part."""

PROTRUDES = 0.9
"""Branches of the middle that reach less than this beyond their fork, in radii, are none."""

TIP_REACH, TIP_POINTS = 0.8, 4
"""How far the last bone goes on towards the tip, in radii there, and the points that tell its direction."""

KNEE, KNEE_PLACE = 0.35, (0.4, 0.6)
"""Two bones meet where the middle is farthest from straight, if that is this far, in radii, and within these parts of
the length."""


FRAME = 0.6
"""A frame, such as a window, is less than this much of its filled outline."""

BAR, BAR_ROOT, BAR_FILL = 6.0, 4.0, 0.75
"""A bar: at least this slender, as a root that, and this much of its box."""


class Midline(NamedTuple):
    """The path along the middle of a part."""

    points: FloatArray
    """(P, 2)."""
    radii: FloatArray
    """(P,) of the largest discs in the part there."""
    median: float
    """Of the radii."""


def chain_of(
    part: PuppetPart, joint: tuple[float, float] | None, *, carries: bool, bones: int | None, most: int
) -> FloatArray:
    """(K + 1, 2) the heads of K bones along a part, and the tip of the last one.

    joint: where the part turns; None for a root, whose chain runs from tip to tip. carries: whether limbs hang on it.
    bones: number of bones, if a user chose it; most: the maximum otherwise.
    """
    middle = _middle(part, joint)
    if middle is None:
        return _straight(part, joint)
    points, radius = middle.points, middle.median
    along = along_path(points)
    if bones is None:
        bends = along[-1] >= (CARRIER_BENDS if carries else LEAF_BENDS) * radius
        bones = int(np.clip(along[-1] / (BONE_LENGTH * radius), 2, MOST_BONES)) if bends else 1
        bones = min(bones, most)
    shapely = load_shapely(NEEDED_FOR)
    solid = shapely.geometry.shape(largest_component(part.outline).__geo_interface__)
    for count in range(bones, 1, -1):
        places = _places(middle, along, count)
        if count == 2:
            places[1] = _knee(points, along, radius, places[1])
        chain = np.stack([np.interp(places, along, points[:, axis]) for axis in (0, 1)], axis=1)
        if shapely.contains_xy(solid, chain[1:-1]).all():  # not where the way to another component lies
            return chain
    return _straight(part, joint) if joint is None else points[[0, -1]]


def stiff(part: PuppetPart) -> bool:
    """Whether a part is round or a frame."""
    return part.is_round or bool(part.solid.area < FRAME * part.filled.area)


def bar_like(part: PuppetPart, *, is_root: bool) -> bool:
    """Whether a part is long, straight and of even width."""
    box = float(norm(part.box[1] - part.box[0]) * norm(part.box[3] - part.box[0]))
    return part.slenderness > (BAR_ROOT if is_root else BAR) and part.solid.area > BAR_FILL * box


def _places(middle: Midline, along: FloatArray, count: int) -> FloatArray:
    """(count + 1,) where bones begin and end, along the middle of a part."""
    length = np.maximum(middle.radii, THINNEST * middle.median) ** -THICK
    bones = np.concatenate(([0.0], np.cumsum(0.5 * (length[1:] + length[:-1]) * np.diff(along))))
    each = np.ones(count)
    each[[0, -1]] = END_BONE
    ends = np.concatenate(([0.0], np.cumsum(each))) / each.sum()
    return np.interp(ends * bones[-1], bones, along)


def _knee(points: FloatArray, along: FloatArray, radius: float, otherwise: float) -> float:
    """Where along a path of two bones their joint is: where it is bent, or at another place."""
    across = rotated_left(points[-1] - points[0]) / norm(points[-1] - points[0])
    off = np.abs((points - points[0]) @ across)
    low, high = (part * along[-1] for part in KNEE_PLACE)
    off = np.where((along >= low) & (along <= high), off, 0.0)
    farthest = int(off.argmax())
    return float(along[farthest] if off[farthest] > KNEE * radius else otherwise)


def _straight(part: PuppetPart, joint: tuple[float, float] | None) -> FloatArray:
    """One bone: from the joint to the farthest point, or along a root, upwards or to the right."""
    if joint is not None:
        start = np.array(joint)
        away = part.outline.vertices - start
        return np.stack((start, start + away[int(norm(away).argmax())]))
    ends = part.ends
    along = ends[1] - ends[0]
    if along[int(np.abs(along).argmax())] < 0.0:
        ends = ends[::-1]
    inset = min(0.5 * part.slenderness**-1.0, 0.4) * (ends[1] - ends[0])
    return np.stack((ends[0] + inset, ends[1] - inset))


def _middle(part: PuppetPart, joint: tuple[float, float] | None) -> Midline | None:
    """The path along the middle of the part's largest component, from the joint to the farthest tip; None where the
    part is too round to have one."""
    try:
        axis = pruned(medial_axis(largest_component(part.outline)), PROTRUDES)
    except (NestedCagesError, scipy.spatial.QhullError):
        return None
    if len(axis.links) < 2:
        return None
    nodes = np.array(list(axis.links))
    if joint is None:
        ends = _farthest(axis, nodes, _farthest(axis, nodes, int(nodes[0]))[-1])
        ends = trimmed(axis, trimmed(axis, ends)[::-1])
    else:
        start = int(nodes[scipy.spatial.cKDTree(axis.points[nodes]).query(joint)[1]])
        ends = trimmed(axis, _farthest(axis, nodes, start))
    if len(ends) < TIP_POINTS:
        return None
    points, radii = axis.points[ends], axis.radii[ends]
    median = float(np.median(radii))
    points, radii = np.concatenate((points, [_tip(points, radii)])), np.append(radii, radii[-1])
    first = 0
    if joint is not None:
        ahead = norm(points - joint) > radii.min()
        first = int(ahead.argmax()) if ahead.any() else 0
    begin = np.array(joint) if joint is not None else _tip(points[-2::-1], radii[-2::-1])
    return Midline(np.concatenate(([begin], points[first:])), np.append(radii[first], radii[first:]), median)


def _tip(points: FloatArray, radii: FloatArray) -> FloatArray:
    """(2,) the end of the last bone: a little beyond the middle's last point."""
    ahead = points[len(radii) - 1] - points[len(radii) - TIP_POINTS]
    return np.asarray(points[len(radii) - 1] + TIP_REACH * radii[-1] * ahead / (float(norm(ahead)) or 1.0))


def _farthest(axis: MedialAxis, nodes: FloatArray, start: int) -> list[int]:
    """The shortest path from a point of the axis to the one at the greatest distance along it."""
    number = {int(node): k for k, node in enumerate(nodes)}
    pairs = np.array([(number[i], number[j]) for i, others in axis.links.items() for j in others]).T
    lengths = norm(axis.points[nodes[pairs[0]]] - axis.points[nodes[pairs[1]]]) + np.finfo(float).tiny
    graph = scipy.sparse.csr_array((lengths, tuple(pairs)), shape=(len(nodes),) * 2)
    distance, before = scipy.sparse.csgraph.dijkstra(graph, indices=number[start], return_predecessors=True)
    path = [int(np.where(np.isfinite(distance), distance, -1.0).argmax())]
    while before[path[-1]] >= 0:
        path.append(int(before[path[-1]]))
    return [int(nodes[k]) for k in path[::-1]]


def largest_component(mesh: Mesh) -> Mesh:
    """The largest outer loop of a mesh with its holes."""
    component = mesh.component_of_loop
    areas = np.bincount(component, mesh.loop_areas)
    if len(areas) == 1:
        return mesh
    return Mesh.from_loops([ring for ring, owner in zip(mesh.rings, component, strict=True) if owner == areas.argmax()])


def nearest_bone(chain: FloatArray, place: tuple[float, float]) -> int:
    """The bone of a chain (K + 1, 2) nearest to a place."""
    gaps = []
    for head, tail in pairwise(chain):
        along = tail - head
        part = np.clip((place - head) @ along / (along @ along), 0.0, 1.0)
        gaps.append(float(norm(head + part * along - place)))
    return int(np.argmin(gaps))
