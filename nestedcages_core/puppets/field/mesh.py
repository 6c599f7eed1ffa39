"""The field of a part that bends: its own cage, triangulated around its joints, with weights of its bones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...geometry.triangulation import Sampling, Triangulation
from ...geometry.triangulation.constrained import constrained_delaunay
from ...geometry.triangulation.solid import sample
from ...levels import nested_cages
from ...libraries import load_shapely
from ..part import NEEDED_FOR
from ..skeleton.bone_tree import BoneTree
from ..skeleton.midline import largest_component
from .skinning import Skin
from .weights import Bend, Limb, shares_of

CLEARANCE = 0.01
"""Of a part's cage, in diagonals of the part."""

CAGE_VERTICES, VERTICES_PER_JOINT = 24, 4
"""Vertices of a part's cage, and how many more for each joint in it."""

DENSITIES = 5.0, 8.0
"""Triangles from a joint to the outline, at first, and where a joint then turns too little."""

LEAST_RING = 6
"""Points on the innermost circle around a joint."""

SPREAD = 1.75
"""How much farther apart points are from ring to ring, beyond the limb's width around a joint, over the density."""

CLEAR_OF_RIM, CLEAR_OF_RING = 0.4, 0.6
"""Least distance of points inside from the outline, where thin triangles would be the first to flip, and of other
points from those around joints; in spacings."""

SIMPLIFIED = 1e-4
"""Tolerance of the outline that a cage encloses, in square roots of its area, a hundredth of the clearance."""

FINEST_WEIGHT = 2.0**-20
"""Weights are multiples of this, so that float32 has both weights of a vertex exactly."""


@dataclass(frozen=True, eq=False)
class BendField:
    """Triangles that carry the motion of a part that bends, and of all that lies in them."""

    cage: Mesh
    """Encloses the part and what rides on it."""
    grid: Triangulation
    """Vertices (N, 2), first those on the cage; float32 has them exactly. Triangles (T, 3), counter-clockwise."""
    first_bone: int
    """Number of the part's first bone; the others follow it."""
    parents: tuple[int, ...]
    """Of each bone in the part, -1 for the first one."""
    bends: tuple[Bend, ...]
    """The joints within the part."""
    shares: FloatArray
    """(N, K) how much each vertex follows the bone after each of the K joints: 1 beyond it, 0 before it. In a row at
    most one is neither 0 nor 1."""

    @classmethod
    def of(
        cls, cage: Mesh, grid: Triangulation, first_bone: int, limb: Limb, skin: Skin, finest: float = FINEST_WEIGHT
    ) -> BendField:
        """The field on a grid in a cage, with circular weights of a limb, in multiples of the finest."""
        shares = shares_of(grid.vertices, limb)
        shares = np.where((shares > 0.0) & (shares < 1.0), skin.weight(shares), shares)
        shares = np.round(shares / finest) * finest
        return cls(cage, grid, first_bone, limb.bones.parents, limb.bends, shares)

    def with_weights(self, weights: FloatArray) -> BendField:
        """The field with other weights (N, K + 1), rows of sum 1."""
        shares = BoneTree.of(self.parents).shares(weights)
        return replace(self, shares=np.round(shares / FINEST_WEIGHT) * FINEST_WEIGHT)

    @property
    def weights(self) -> FloatArray:
        """(N, K + 1) weights of the part's bones, rows of sum 1; as made by `of`, at most two in a row are not 0."""
        return BoneTree.of(self.parents).weights(self.shares)

    @property
    def is_even(self) -> bool:
        """Whether each vertex follows one bone, or one and its parent."""
        on = self.weights > 0.0
        count = on.sum(axis=1)
        together = np.any([on[:, bone] & on[:, self.parents[bone]] for bone in range(1, len(self.parents))], axis=0)
        return bool(((count == 1) | ((count == 2) & together)).all())

    @cached_property
    def rim(self) -> IntArray:
        """(B, 2) edges of the field's outline, the field on their left."""
        corners = self.grid.triangles
        sides = np.stack((corners, np.roll(corners, -1, axis=1)), axis=2).reshape(-1, 2)
        return np.asarray(sides[self.grid.neighbours[:, [2, 0, 1]].ravel() < 0])

    def weights_at(self, points: FloatArray) -> FloatArray:
        """(P, K + 1) weights of the part's bones at points (P, 2), linear on triangles; outside, as at the rim."""
        return np.asarray(self.grid.interpolation(points) @ self.weights)


def bend_field(solids: Sequence[Any], bones: BoneTree, first_bone: int, kept: float, skin: Skin) -> Iterator[BendField]:
    """Fields of a part and what rides on it, denser and denser ones.

    solids: polygons of shapely, of the part first; kept: radius around the part's own joint that no bend reaches, so
    that no paint opens there. Raises NestedCagesError as `nested_cages`.
    """
    shape = _united(solids)
    wanted = CAGE_VERTICES + VERTICES_PER_JOINT * (len(bones) - 1)
    (level,) = nested_cages(shape, wanted, clearance=CLEARANCE * shape.diagonal, loops="one")
    limb = Limb.of(level.cage, bones, kept)
    for density in DENSITIES:
        yield BendField.of(level.cage, _grid(level.cage, limb.bends, density), first_bone, limb, skin)


def _united(solids: Sequence[Any]) -> Mesh:
    """The component of the union of some areas that has the largest one of the first, as a mesh."""
    shapely = load_shapely(NEEDED_FOR)
    own = max(shapely.get_parts(solids[0]), key=lambda area: float(area.area))
    whole = shapely.union_all(solids)
    biggest = max(shapely.get_parts(whole), key=lambda area: float(area.intersection(own).area))
    biggest = shapely.simplify(biggest, SIMPLIFIED * np.sqrt(biggest.area))
    return largest_component(Mesh.of(biggest))


def _grid(cage: Mesh, bends: Sequence[Bend], density: float) -> Triangulation:
    """The inside of a cage: joints, rings around them, and graded points elsewhere; rounded to float32."""
    shapely = load_shapely(NEEDED_FOR)
    cage = cage.moved(_stored(cage.vertices)).validated()
    spacing = float(np.mean([bend.width for bend in bends])) / density
    rim = sample(cage, Sampling(spacing, 1.0))
    on_rim, inner = rim.points[: len(rim.edge)], rim.points[len(rim.edge) :]
    inside = shapely.geometry.shape(cage.__geo_interface__)
    border = shapely.boundary(inside)
    shapely.prepare(inside)

    def clear(points: FloatArray) -> FloatArray:
        within = shapely.contains_xy(inside, points[:, 0], points[:, 1])
        return np.asarray(points[within & (shapely.distance(shapely.points(points), border) > CLEAR_OF_RIM * spacing)])

    rings = np.array([bend.joint for bend in bends])
    for bend in bends:
        rings = np.concatenate((rings, _off(clear(_joint_rings(bend, density)), rings, spacing)))
    vertices = _stored(np.concatenate((on_rim, rings, _off(clear(inner), rings, spacing))))
    triangles = constrained_delaunay(vertices, rim.segments)
    return Triangulation(vertices, triangles, rim.edge, cage.successor[rim.edge], rim.parameter)


def _joint_rings(bend: Bend, density: float) -> FloatArray:
    """(P, 2) points on circles around a joint: evenly apart within the limb's width, then wider and wider."""
    found: list[FloatArray] = []
    radius = step = bend.width / density
    while radius < bend.reach:
        count = max(LEAST_RING, round(2.0 * np.pi * radius / step))
        angles = (np.arange(count) + 0.5 * (len(found) % 2)) * 2.0 * np.pi / count
        found.append(bend.joint + radius * np.stack((np.cos(angles), np.sin(angles)), axis=1))
        step *= 1.0 if radius < bend.width else 1.0 + SPREAD / density
        radius += step
    return np.concatenate(found)


def _off(points: FloatArray, others: FloatArray, spacing: float) -> FloatArray:
    """The points (P, 2) that are clear of others."""
    return points[scipy.spatial.cKDTree(others).query(points)[0] > CLEAR_OF_RING * spacing] if len(points) else points


def _stored(points: FloatArray) -> FloatArray:
    """Points rounded to float32."""
    return points.astype(np.float32).astype(np.float64)
