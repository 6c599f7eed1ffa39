"""Weights of bones, harmonic inside a cage: smooth, between 0 and 1, and local to the limbs that the bones lie in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...geometry.predicates import winding_number
from ...geometry.triangulation import Sampling, Triangulation
from ...geometry.triangulation.constrained import constrained_delaunay
from ...geometry.triangulation.solid import sample
from ..skeleton.bone import Bone, ends_of, radii_of
from .skinning import Motions, PreserveVolume, Skin

SPACING, AT_CORNERS = 1.0 / 64.0, 0.5
"""Spacing of the triangles, in diagonals of the cage, and at its corners as a fraction of that."""

SHORTENED, MOST_SHORTENED = 3.0, 0.49
"""How much shorter bones act at each end: in radii of the limb there, and at most as a fraction of the bone. Of 28 ways
to weigh bones, on six figures with each bone turned by ±70° and 20 random poses, this one folds least: 0.09 % of the
area."""

SAME = 0.3
"""Distance below which points of two bones are one, in spacings."""

CLEAR = 0.5
"""Distance of other points from those of bones, in spacings."""


def bone_weights(cage: Mesh, bones: Sequence[Bone]) -> FloatArray:
    """W (m, B): how much each bone moves each of the m vertices of a cage; rows sum to 1, no entry is negative.

    Solves Δw = 0 inside the cage with w = 1 on a bone and 0 on the others, by linear finite elements (Baran & Popović
    2007 use heat on the surface; here it spreads inside, so a leg does not pull the other one). A part of the cage
    without a bone follows the nearest one. Raises NestedCagesError if there are no bones or one has no length.
    """
    grid, on_bone = _grid_with_bones(cage, _shortened(cage, ends_of(bones)))
    known = on_bone.any(axis=1)
    weights = np.zeros(on_bone.shape)
    weights[known] = on_bone[known] / on_bone[known].sum(axis=1, keepdims=True)
    part = _components(grid)
    held = np.isin(part, part[known])
    free = np.flatnonzero(held & ~known)
    stiffness = grid.stiffness().tocsr()
    if len(free):
        rows = stiffness[free]
        load = -(rows[:, np.flatnonzero(known)] @ weights[known])
        weights[free] = scipy.sparse.linalg.splu(rows[:, free].tocsc()).solve(load)
    for alone in np.unique(part[~held]):
        members = np.flatnonzero(part == alone)
        weights[members, _nearest_bone(grid.vertices[members].mean(axis=0), ends_of(bones))] = 1.0
    weights = np.clip(weights[: len(cage.vertices)], 0.0, 1.0)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def _shortened(cage: Mesh, ends: FloatArray) -> FloatArray:
    """(B, 2, 2) bones without the parts near their ends, where the weights of neighbours blend."""
    along = ends[:, 1] - ends[:, 0]
    lengths = np.hypot(along[:, 0], along[:, 1])
    cut = SHORTENED * radii_of(cage, ends.reshape(-1, 2)).reshape(-1, 2)
    part = np.minimum(cut / lengths[:, None], MOST_SHORTENED)
    return np.stack((ends[:, 0] + part[:, :1] * along, ends[:, 1] - part[:, 1:] * along), axis=1)


def _grid_with_bones(cage: Mesh, ends: FloatArray) -> tuple[Triangulation, BoolArray]:
    """A triangulation of the cage's inside with points along the bones, and which point lies on which bone, (N, B)."""
    spacing = SPACING * cage.diagonal
    rim = sample(cage, Sampling(spacing, AT_CORNERS))
    points, owners = [np.zeros((0, 2))], [np.zeros(0, dtype=np.int64)]
    for number, (head, tail) in enumerate(ends):
        count = max(int(np.hypot(*(tail - head)) / spacing), 1) + 1
        on = head + np.linspace(0.0, 1.0, count)[:, None] * (tail - head)
        points.append(on)
        owners.append(np.full(count, number))
    candidates, owner = np.concatenate(points), np.concatenate(owners)
    inside = winding_number(candidates, cage.vertices, cage.edge_ends) == 1
    candidates, owner = candidates[inside], owner[inside]
    on_rim = len(rim.edge)
    clear = scipy.spatial.cKDTree(rim.points[:on_rim]).query(candidates)[0] > 0.0
    candidates, owner = candidates[clear], owner[clear]
    first = _first_of_near(candidates, SAME * spacing)
    kept, index = np.unique(first, return_inverse=True)
    inner = rim.points[on_rim:]
    if len(kept) and len(inner):
        inner = inner[scipy.spatial.cKDTree(candidates[kept]).query(inner)[0] > CLEAR * spacing]
    vertices = np.concatenate((rim.points[:on_rim], inner, candidates[kept]))
    on_bone = np.zeros((len(vertices), len(ends)), dtype=np.bool_)
    on_bone[on_rim + len(inner) + index, owner] = True
    triangles = constrained_delaunay(vertices, rim.segments)
    return Triangulation(vertices, triangles, rim.edge, cage.successor[rim.edge], rim.parameter), on_bone


def _first_of_near(points: FloatArray, distance: float) -> IntArray:
    """(P,) the number of the point that stands for each, so that these are at least a distance apart."""
    first = np.arange(len(points))
    for low, high in sorted(scipy.spatial.cKDTree(points).query_pairs(distance)) if len(points) else []:
        if first[low] == low and first[high] == high:
            first[high] = low
    return first


def _components(grid: Triangulation) -> IntArray:
    """(N,) the connected part of each vertex."""
    count, corners = len(grid.vertices), grid.triangles
    links = scipy.sparse.coo_array(
        (np.ones(corners.size), (corners.ravel(), corners[:, [1, 2, 0]].ravel())), shape=(count, count)
    )
    return np.asarray(scipy.sparse.csgraph.connected_components(links, directed=False)[1])


def _nearest_bone(point: FloatArray, ends: FloatArray) -> int:
    """The bone (of heads and tails (B, 2, 2)) nearest to a point."""
    along = ends[:, 1] - ends[:, 0]
    place = np.clip(((point - ends[:, 0]) * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
    away = point - (ends[:, 0] + place[:, None] * along)
    return int(np.argmin(np.hypot(away[:, 0], away[:, 1])))


def skinned(
    points: FloatArray,
    weights: FloatArray,
    bones: Sequence[Bone],
    turned: Mapping[int, float],
    skin: Skin | None = None,
) -> FloatArray:
    """(P, 2) points moved by bones that are turned around their heads.

    points: (P, 2) at rest; weights: (P, B), rows of sum 1; turned: degrees, counter-clockwise, by number of the bone,
    relative to its parent. By default as Blender's Armature modifier with *Preserve Volume*.
    """
    return (skin or PreserveVolume()).moved(points, weights, motions_of(bones, turned))


def motions_of(bones: Sequence[Bone], turned: Mapping[int, float]) -> Motions:
    """Where bones are that are turned around their heads by degrees relative to their parents."""
    ends_of(bones)
    turns, shifts = np.ones(len(bones), dtype=np.complex128), np.zeros(len(bones), dtype=np.complex128)
    halves = np.zeros(len(bones))
    for number, bone in enumerate(bones):  # z -> turn z + shift, in the complex plane
        angle = np.deg2rad(turned.get(number, 0.0))
        own, head = np.exp(1j * angle), complex(*bone.head)
        turn, shift, half = own, head - own * head, 0.5 * angle
        if bone.parent is not None:
            above = turns[bone.parent]
            turn, shift, half = above * own, above * shift + shifts[bone.parent], half + halves[bone.parent]
        turns[number], shifts[number], halves[number] = turn, shift, half
    return Motions(turns, shifts, halves)
