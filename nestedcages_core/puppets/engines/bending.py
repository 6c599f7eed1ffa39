"""The mesh of a part that bends: its hull with vertices at joints, points on both sides of these, and weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from ...geometry.triangulation import Triangulation, constrained_delaunay
from ...libraries import load_shapely
from ..field.mesh import BendField
from ..field.ranges import FREE, JointRange, first_that_turns
from ..field.skinning import Linear
from ..field.weights import Bend, Limb
from ..puppet import LEAST_TURN
from ..skeleton.bone_tree import BoneTree
from .hulls import stored

NEEDED_FOR = "Meshes of parts that bend"

SKIN = Linear()
"""How game engines blend bones."""

AROUND_JOINT, RINGS = (6, 8, 10, 12), (0.5, 0.4, 0.6)
"""Points around a joint, and their distance from it in widths of the limb: the first that turn far enough are taken. Of
6 to 14 points in one or two rings, 6 at half a width flip last on plain limbs: at 104° or more."""

BESIDE_JOINT, MOST_OF_BONE = 1.0, 0.5
"""Distance of the hull's vertices before and after a joint from it: in widths, and at most as a share of the bone."""

CLEAR, CLEAR_OF_HULL = 0.25, 0.2
"""Least distance of points inside from each other and from the hull, in widths."""

ON_LIMB = 0.5
"""What has at least this part of its hull on a limb's bends with it."""

LEAST_GAP = 2.0
"""Least distance of the hull's vertices at joints from others, in pixels."""

FINEST_WEIGHT = 2.0**-16
"""Weights are multiples of this, so that they sum to 1 exactly in float32."""


@dataclass(frozen=True)
class Spread:
    """Points around each joint."""

    around: int
    ring: float
    """Distance from the joint in widths of the limb."""
    phase: float
    """Of the first point, in parts of the angle between two."""


SPREADS = tuple(Spread(around, ring, phase) for around, ring, phase in product(AROUND_JOINT, RINGS, (0.0, 0.5)))
"""What is tried."""


def limb_in(hulls: Sequence[FloatArray], bones: BoneTree, kept: float) -> Limb | None:
    """The limb in the first of some hulls that has all joints; None if none has, and nothing bends. kept: of `Limb`."""
    shapely = load_shapely(NEEDED_FOR)
    for hull in hulls:
        if shapely.contains_xy(shapely.Polygon(hull), bones.heads[1:]).all():
            return Limb.of(Mesh.from_loops([hull]), bones, kept)
    return None


def best_field(
    loop: FloatArray, limb: Limb | None, bones: BoneTree, first_bone: int
) -> tuple[BendField, list[JointRange]]:
    """The mesh in a hull, and the ranges of the limb's joints, by the first spread of points whose joints turn far
    enough. What lies next to the limb follows its nearest bone."""
    if limb is None or not _is_on(loop, limb.area):
        beyond = bones.beyond[bones.nearest(loop.mean(axis=0)), 1:].astype(np.float64)
        bends = tuple(Bend(joint, 0.0, 0.0, np.stack((joint, joint))) for joint in bones.heads[1:])
        grid, shares = meshed_loop(counter_clockwise(loop)), np.tile(beyond, (len(loop), 1))
        still = BendField(Mesh.from_loops([loop]), grid, first_bone, bones.parents, bends, shares)
        return still, [FREE] * len(bends)
    hull = counter_clockwise(_with_vertices_at_joints(loop, limb))
    grids = (meshed_loop(hull, _inner_points(hull, limb, spread)) for spread in SPREADS)
    cage = Mesh.from_loops([hull])
    fields = (BendField.of(cage, grid, first_bone, limb, SKIN, FINEST_WEIGHT) for grid in grids)
    return first_that_turns(fields, SKIN, LEAST_TURN)


def _is_on(loop: FloatArray, area: Mesh) -> bool:
    shapely = load_shapely(NEEDED_FOR)
    solid = shapely.Polygon(loop)
    shared = shapely.intersection(solid, shapely.geometry.shape(area.__geo_interface__))
    return bool(shared.area >= ON_LIMB * solid.area)


def meshed_loop(loop: FloatArray, inner: FloatArray | None = None) -> Triangulation:
    """The triangles in a loop (n, 2) with points (P, 2) inside; the loop comes first."""
    ring = np.stack((np.arange(len(loop)), (np.arange(len(loop)) + 1) % len(loop)), axis=1)
    points = loop if inner is None else np.concatenate((loop, inner))
    return Triangulation(points, constrained_delaunay(points, ring), ring[:, 0], ring[:, 1], np.zeros(len(loop)))


def _with_vertices_at_joints(loop: FloatArray, limb: Limb) -> FloatArray:
    """A loop with vertices where limbs bend: on both sides at, before and after each joint."""
    shapely = load_shapely(NEEDED_FOR)
    solid, ring = shapely.Polygon(loop), shapely.LinearRing(loop)
    reach = float(np.hypot(*np.ptp(loop, axis=0)))
    kept = [tuple(point) for point in loop.tolist()]
    for k, bend in enumerate(limb.bends):
        for place, along in _crossings(bend, (limb.bones.before(k + 1), limb.bones.tails[k + 1])):
            spot = shapely.Point(place)
            if not solid.contains(spot):  # of what only rides on the limb
                continue
            across = reach * np.array([-along[1], along[0]])
            chords = shapely.get_parts(
                shapely.intersection(shapely.linestrings([place - across, place + across]), solid)
            )
            chord = chords[int(shapely.distance(chords, spot).argmin())]
            for end in stored(shapely.get_coordinates(chord)[[0, -1]]).tolist():
                if np.hypot(*(np.array(kept) - end).T).min() > LEAST_GAP:
                    kept.append(tuple(end))
    return np.array(sorted(kept, key=lambda point: float(ring.project(shapely.Point(point)))))


def _crossings(bend: Bend, ends: Sequence[FloatArray]) -> list[tuple[FloatArray, FloatArray]]:
    """Places on the bones around a joint where the hull gets vertices on both sides, and the directions there.

    ends: of the bones before and after the joint.
    """
    across = bend.chord[1] - bend.chord[0]
    found = [(bend.joint, np.array([across[1], -across[0]]) / np.hypot(*across))]
    for end in ends:
        length = float(np.hypot(*(end - bend.joint)))
        along = (end - bend.joint) / length
        found.append((bend.joint + min(BESIDE_JOINT * bend.width, MOST_OF_BONE * length) * along, along))
    return found


def _inner_points(hull: FloatArray, limb: Limb, spread: Spread) -> FloatArray:
    """(P, 2) joints, points around them, and the middles of bones, clear of the hull and of each other."""
    shapely = load_shapely(NEEDED_FOR)
    solid, border = shapely.Polygon(hull), shapely.LinearRing(hull)
    wanted = [(bend.joint, bend.width) for bend in limb.bends]
    for bend in limb.bends:
        across = bend.chord[1] - bend.chord[0]
        first = float(np.arctan2(across[1], across[0]))
        for angle in first + 2.0 * np.pi * (np.arange(spread.around) + spread.phase) / spread.around:
            ring = bend.joint + spread.ring * bend.width * np.array([np.cos(angle), np.sin(angle)])
            wanted.append((ring, bend.width))
    narrowest = min(bend.width for bend in limb.bends)
    wanted += [(0.5 * (head + tail), narrowest) for head, tail in zip(limb.bones.heads, limb.bones.tails, strict=True)]
    kept: list[FloatArray] = []
    for place, width in wanted:
        point = stored(place)
        spot = shapely.Point(point)
        is_clear = not kept or np.hypot(*(np.array(kept) - point).T).min() > CLEAR * width
        if is_clear and solid.contains(spot) and float(shapely.distance(border, spot)) > CLEAR_OF_HULL * width:
            kept.append(point)
    return np.array(kept).reshape(-1, 2)


def counter_clockwise(loop: FloatArray) -> FloatArray:
    """A loop (n, 2) in that direction."""
    x, y = loop.T
    return loop if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0.0 else loop[::-1]
