"""The mesh of a painted part: its hull, points inside where it bends, triangles and weights of bones."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..character import Linear
from ..exchange.layers import PicturePart
from ..exchange.pictures.png import Pixels
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.triangulation import Triangulation, constrained_delaunay
from ..libraries import load_shapely
from ..puppet import BendField
from ..puppet.circular import Bend, shares_of
from .islands import certify, islands_of, stored

SKIN = Linear()
"""How game engines blend bones."""

AROUND_JOINT, RING = 6, 0.5
"""Points around a joint, and their distance from it in widths of the limb. Of 6 to 14 points in one or two rings, these
flip last: at 104° or more on straight, tapering, curved and bent limbs."""

BESIDE_JOINT, MOST_OF_BONE = 1.0, 0.5
"""Distance of the hull's vertices before and after a joint from it: in widths, and at most as a share of the bone."""

CLEAR, CLEAR_OF_HULL = 0.25, 0.2
"""Least distance of points inside from each other and from the hull, in widths."""

LEAST_GAP = 2.0
"""Least distance of the hull's vertices at joints from others, in pixels."""

MOST_BONES = 4
"""Bones of a point that engines take."""

FINEST_WEIGHT = 2.0**-16
"""Weights are multiples of this, so that they sum to 1 exactly in float32."""


@dataclass(frozen=True)
class Placement:
    """Where the canvas lies in the puppet's coordinates: pixels, y pointing up, 0 below the middle of the canvas."""

    width: int
    height: int

    def up(self, canvas: FloatArray) -> FloatArray:
        """Points (n, 2) of the canvas, whose y points down, in the puppet."""
        return np.asarray((canvas - (0.5 * self.width, self.height)) * (1.0, -1.0))

    def down(self, points: FloatArray) -> FloatArray:
        """Points (n, 2) of the puppet on the canvas."""
        return np.asarray(points * (1.0, -1.0) + (0.5 * self.width, self.height))


@dataclass(frozen=True, eq=False)
class PartMesh:
    """A textured mesh that bones move."""

    name: str
    part: str
    """Path of the layer: its groups and name, with slashes between."""
    identity: str
    """Id of the layer in its file, empty if it has none."""
    points: FloatArray
    """(n, 2) pixels, y pointing up; the hull first, in order."""
    hull: int
    """Number of points on the hull."""
    triangles: IntArray
    """(T, 3), counter-clockwise."""
    weights: FloatArray = field(repr=False)
    """(n, B) of all bones, rows of sum 1, at most four not 0."""
    left: int
    top: int
    pixels: Pixels = field(repr=False)
    """(h, w, 4) at this place on the canvas; opacity is in them."""
    blend: str = "normal"
    is_visible: bool = True

    @property
    def strongest(self) -> int:
        """The bone that moves the mesh most."""
        return int(self.weights.sum(axis=0).argmax())


@dataclass(frozen=True, eq=False)
class Bending:
    """What bends a part: the field that carries it, and the chain of its bones."""

    field: BendField
    chain: FloatArray
    """(K + 2, 2) heads of the bones, and the tip of the last."""


def part_meshes(
    part: PicturePart, name: str, place: Placement, vertices: int, bones: int, bone: int, bending: Bending | None
) -> list[PartMesh]:
    """A mesh for each island of a part.

    vertices: of the largest hull; bones: their number; bone: that which moves a part that does not bend; an island
    next to a part that bends follows its nearest bone. Raises NestedCagesError.
    """
    pixels = part.pixels
    if part.opacity < 1.0:
        pixels = pixels.copy()
        pixels[..., 3] = np.round(pixels[..., 3] * part.opacity)
    meshes: list[PartMesh] = []
    for number, island in enumerate(islands_of(pixels, part.left, part.top, vertices), 1):
        loop = place.up(island.loop)
        weights = np.zeros((1, bones))
        weights[0, bone] = 1.0
        if bending is not None and number == 1:
            points, hull, own = _bent(loop, bending)
            weights = np.zeros((len(points), bones))
            first = own.first_bone
            weights[:, first : first + len(own.bends) + 1] = own.weights
            triangles = own.grid.triangles
        else:
            points, hull = _counter_clockwise(loop), len(loop)
            triangles = constrained_delaunay(points, _loop_edges(hull))
            if bending is not None:
                weights = _of_nearest(points, bending, bones)
        certify(place.down(points[:hull]), island.pixels, island.left, island.top)
        mesh = PartMesh(
            name if number == 1 else f"{name}.island{number}",
            part.path,
            part.identity,
            points,
            hull,
            triangles,
            np.broadcast_to(weights, (len(points), bones)),
            island.left,
            island.top,
            island.pixels,
            part.blend,
            part.is_visible,
        )
        meshes.append(mesh)
    return meshes


def _bent(loop: FloatArray, bending: Bending) -> tuple[FloatArray, int, BendField]:
    """Points of a mesh that bends, how many of them are its hull, and its field."""
    bends = bending.field.bends
    hull = _counter_clockwise(_with_vertices_at_joints(loop, bending))
    points = np.concatenate((hull, _inner_points(hull, bending)))
    count = len(hull)
    ring = _loop_edges(count)
    triangles = constrained_delaunay(points, ring)
    grid = Triangulation(points, triangles, ring[:, 0], ring[:, 1], np.zeros(count))
    shares = shares_of(grid, bending.chain, bends, bending.field.cage)
    blended = (shares > 0.0) & (shares < 1.0)
    shares = np.where(blended, SKIN.weight(shares), shares)
    shares = np.round(shares / FINEST_WEIGHT) * FINEST_WEIGHT
    return points, count, replace(bending.field, grid=grid, shares=shares)


def _with_vertices_at_joints(loop: FloatArray, bending: Bending) -> FloatArray:
    """A loop with vertices where limbs bend: on both sides at, before and after each joint."""
    shapely = load_shapely("Meshes of parts that bend")
    solid, ring = shapely.Polygon(loop), shapely.LinearRing(loop)
    reach = float(np.hypot(*np.ptp(loop, axis=0)))
    kept = [tuple(point) for point in loop.tolist()]
    for k, bend in enumerate(bending.field.bends):
        for place, along in _crossings(bend, bending.chain[k : k + 3]):
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


def _crossings(bend: Bend, chain: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
    """Places on the bones around a joint where the hull gets vertices on both sides, and the directions there.

    chain: (3, 2) head before the joint, the joint, and the tail after it.
    """
    across = bend.chord[1] - bend.chord[0]
    found = [(bend.joint, np.array([across[1], -across[0]]) / np.hypot(*across))]
    for end in (chain[0], chain[2]):
        length = float(np.hypot(*(end - bend.joint)))
        along = (end - bend.joint) / length
        found.append((bend.joint + min(BESIDE_JOINT * bend.width, MOST_OF_BONE * length) * along, along))
    return found


def _inner_points(hull: FloatArray, bending: Bending) -> FloatArray:
    """(P, 2) joints, points around them, and the middles of bones, clear of the hull and of each other."""
    shapely = load_shapely("Meshes of parts that bend")
    solid, border = shapely.Polygon(hull), shapely.LinearRing(hull)
    bends = bending.field.bends
    wanted = [(bend.joint, bend.width) for bend in bends]
    for bend in bends:
        across = bend.chord[1] - bend.chord[0]
        first = float(np.arctan2(across[1], across[0]))
        for angle in first + 2.0 * np.pi * np.arange(AROUND_JOINT) / AROUND_JOINT:
            ring = bend.joint + RING * bend.width * np.array([np.cos(angle), np.sin(angle)])
            wanted.append((ring, bend.width))
    narrowest = min(bend.width for bend in bends)
    wanted += [(0.5 * (head + tail), narrowest) for head, tail in zip(bending.chain, bending.chain[1:], strict=False)]
    kept: list[FloatArray] = []
    for place, width in wanted:
        point = stored(place)
        spot = shapely.Point(point)
        is_clear = not kept or np.hypot(*(np.array(kept) - point).T).min() > CLEAR * width
        if is_clear and solid.contains(spot) and float(shapely.distance(border, spot)) > CLEAR_OF_HULL * width:
            kept.append(point)
    return np.array(kept).reshape(-1, 2)


def _of_nearest(points: FloatArray, bending: Bending, bones: int) -> FloatArray:
    """(1, B) weights of an island next to the part: it follows the nearest bone."""
    middles = 0.5 * (bending.chain[1:] + bending.chain[:-1])
    nearest = int(np.hypot(*(middles - points.mean(axis=0)).T).argmin())
    weights = np.zeros((1, bones))
    weights[0, bending.field.first_bone + nearest] = 1.0
    return weights


def _loop_edges(count: int) -> IntArray:
    """(count, 2) the edges of a loop."""
    return np.stack((np.arange(count), (np.arange(count) + 1) % count), axis=1)


def _counter_clockwise(loop: FloatArray) -> FloatArray:
    x, y = loop.T
    return loop if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0.0 else loop[::-1]


def engine_weights(weights: FloatArray) -> FloatArray:
    """Weights (n, B) as engines take them: not negative, at most four in a row, rows of sum 1 in float32 too."""
    kept = np.maximum(weights, 0.0)
    order = np.argsort(-kept, axis=1, kind="stable")
    np.put_along_axis(kept, order[:, MOST_BONES:], 0.0, axis=1)
    kept = np.round(kept / kept.sum(axis=1, keepdims=True) / FINEST_WEIGHT) * FINEST_WEIGHT
    rows = np.arange(len(kept))
    kept[rows, order[:, 0]] += 1.0 - kept.sum(axis=1)
    return np.asarray(kept)
