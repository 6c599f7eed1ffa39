"""Random shapes of several kinds from a seed, and the smallest polygons around convex ones by brute force."""

from collections.abc import Callable
from itertools import combinations

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry.base import BaseGeometry

from nestedcages_core import InvalidMeshError, Mesh
from support.shapes import ring

Draw = np.random.Generator


def simple(random: Draw, low: int = 6, high: int = 60) -> Mesh:
    """One loop around the origin with radii up to 1, some of them deep notches."""
    count = int(random.integers(low, high))
    turn = (np.arange(count) + random.uniform(0.0, 0.9, count)) / count * 2.0 * np.pi
    radius = random.uniform(random.uniform(0.3, 0.9), 1.0, count)
    return Mesh.from_loops([radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)])


def blob(random: Draw, count: int = 120) -> Mesh:
    """A smooth outline of a dozen waves."""
    turn, waves = 2.0 * np.pi * np.arange(count) / count, np.arange(2, 14)
    phases = random.uniform(0.0, 7.0, (12, 1))
    radius = 1.0 + 0.4 * (random.normal(size=12) / waves) @ np.cos(waves[:, None] * turn + phases)
    return Mesh.from_loops([np.maximum(radius, 0.2)[:, None] * ring(count)])


def _star(random: Draw) -> BaseGeometry:
    return shapely.Polygon(simple(random, 8, 120).vertices)


def _blob(random: Draw) -> BaseGeometry:
    shape = shapely.Polygon(blob(random, int(random.integers(20, 200))).vertices)
    for _ in range(random.integers(0, 4)):
        shape -= shapely.Point(random.uniform(-0.7, 0.7, 2)).buffer(random.uniform(0.02, 0.3), quad_segs=4)
    return shape


def _comb(random: Draw) -> BaseGeometry:
    teeth, gap = int(random.integers(2, 9)), 10.0 ** random.uniform(-6.0, -1.0)
    boxes = [shapely.box(k + gap / 2, -random.uniform(0.2, 4.0), k + 1 - gap / 2, 0.05) for k in range(teeth)]
    return shapely.union_all([shapely.box(0.0, 0.0, teeth, random.uniform(0.1, 1.0)), *boxes])


def spiral(random: Draw) -> BaseGeometry:
    turn = np.linspace(0.6, random.uniform(4.0, 14.0), int(random.integers(20, 60)))
    line = shapely.LineString(turn[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1))
    return line.buffer(random.uniform(0.2, 2.6), quad_segs=3)


def _glyph(random: Draw) -> BaseGeometry:
    strokes = []
    for _ in range(random.integers(1, 6)):
        way = np.cumsum(random.normal(scale=0.5, size=(random.integers(2, 7), 2)), axis=0)
        strokes.append(shapely.LineString(way - way[0]).buffer(random.uniform(0.02, 0.15), quad_segs=3))
    return shapely.union_all(strokes)


def _discs(random: Draw) -> BaseGeometry:
    centres = random.uniform(-1.0, 1.0, (random.integers(2, 10), 2))
    return shapely.union_all([shapely.Point(at).buffer(random.uniform(0.05, 0.5), quad_segs=4) for at in centres])


def _needles(random: Draw) -> BaseGeometry:
    count = int(random.integers(12, 90))
    radius = np.where(np.arange(count) % max(2, count // 7) == 0, 1.0, random.choice([0.3, 0.05]))
    return shapely.Polygon(radius[:, None] * ring(count))


KINDS: tuple[Callable[[Draw], BaseGeometry], ...] = (_star, _blob, _comb, spiral, _glyph, _discs, _needles)


def drawing(seed: int) -> Mesh:
    """A shape of a random kind, turned, scaled and moved at random."""
    random = np.random.default_rng(seed)
    while True:
        shape = KINDS[random.integers(len(KINDS))](random)
        shape = affinity.rotate(shape, random.choice([0.0, 90.0, random.uniform(0.0, 360.0)]), origin=(0.0, 0.0))
        scale, shift = 10.0 ** random.uniform(-6.0, 6.0), random.choice([0.0, 1.0, 30.0]) * random.normal(size=2)
        parts = getattr(shape.buffer(0.0), "geoms", [shape.buffer(0.0)])
        loops = [np.array(one.coords)[:-1] for part in parts for one in (part.exterior, *part.interiors)]
        try:
            return Mesh.from_loops([(loop + shift) * scale for loop in loops])
        except InvalidMeshError:
            continue


def courtyard(random: Draw) -> Mesh:
    """A block with one to three rectangular yards side by side."""
    yards, width, height = int(random.integers(1, 4)), *random.uniform(3.0, 12.0, 2)
    boxes, cell = [shapely.box(0.0, 0.0, width, height)], width / yards
    for k in range(yards):
        across, up = random.uniform(0.15, 0.8, 2)
        x, y = (k + random.uniform(0.05, 0.95 - across)) * cell, random.uniform(0.05, 0.95 - up) * height
        boxes.append(shapely.box(x, y, x + across * cell, y + up * height))
    return Mesh.from_loops([np.array(box.exterior.coords)[:-1] for box in boxes])


def plate(random: Draw) -> Mesh:
    """A plate with a step, and bolt holes next to its corners."""
    (w, h), s = random.uniform(8.0, 20.0, 2), random.uniform(0.1, 0.4)
    step = [((1 - s) * w, h), ((1 - s) * w, h + 2), (s * w, h + 2), (s * w, h)]
    radius = random.uniform(0.1, 0.8)
    places = [(1.0, 1.0), (w - 1, 1.0), (1.0, h - 1), (w - 1, h - 1)][: random.integers(1, 5)]
    holes = [ring(int(random.integers(6, 25)), radius, 0.0, place) for place in places]
    return Mesh.from_loops([np.array([(0, 0), (w, 0), (w, h), *step, (0, h)]), *holes])


def row(random: Draw) -> Mesh:
    """Squares and discs in a row, with gaps of all sizes."""
    loops, x = [], 0.0
    for _ in range(random.integers(2, 6)):
        radius = random.uniform(0.3, 1.0)
        x += radius
        loops.append(ring(int(random.choice([4, 16, 40])), radius, np.pi / 4, (x, random.uniform(-1.0, 1.0) * radius)))
        x += radius + 10.0 ** random.uniform(-4.0, 0.3)
    return Mesh.from_loops(loops)


def scattered(random: Draw) -> Mesh:
    """Discs on a grid, some with holes."""
    loops, side = [], int(random.integers(2, 4))
    for i, j in np.ndindex(side, side):
        x, y = random.uniform(-0.2, 0.2, 2)
        centre, radius = (2.5 * i + x, 2.5 * j + y), random.uniform(0.4, 1.0)
        loops.append(ring(12, radius, 0.0, centre))
        if random.random() < 0.4:
            loops.append(ring(8, random.uniform(0.1, 0.8) * radius, 0.0, centre))
    return Mesh.from_loops(loops)


def rings(random: Draw) -> Mesh:
    """Rings within rings, around the origin."""
    radii = np.cumprod([1.0, *random.uniform(0.2, 0.65, random.integers(1, 4))])
    return Mesh.from_loops([ring(int(random.integers(4, 40)), radius, random.uniform(0.0, 1.0)) for radius in radii])


OF_SEVERAL_LOOPS: tuple[Callable[[Draw], Mesh], ...] = (courtyard, plate, row, scattered, rings)


def smallest_around(corners: np.ndarray, count: int, directions: int = 720) -> float:
    """The least area of polygons with ``count`` edges around a convex polygon (h, 2): all but one lie along its edges.

    That one has one of so many directions, so the result is a little too large.
    """
    along = np.roll(corners, -1, axis=0) - corners
    flush = np.sort(np.arctan2(-along[:, 0], along[:, 1]))
    angles = np.concatenate([flush, np.linspace(-np.pi, np.pi, directions, endpoint=False)])
    support = (np.stack([np.cos(angles), np.sin(angles)], axis=1) @ corners.T).max(axis=1)
    free = len(flush) + np.arange(directions)[:, None]
    choices = [np.array(list(combinations(range(len(flush)), count)), dtype=int).reshape(-1, count)]
    choices += [
        np.hstack([np.tile(rest, (directions, 1)), free]) for rest in combinations(range(len(flush)), count - 1)
    ]
    return float(np.concatenate([_areas(angles[each], support[each]) for each in choices]).min())


def _areas(angles: np.ndarray, support: np.ndarray) -> np.ndarray:
    """(K,) areas of the polygons with edges n · x = support, (K, k) each; infinite where they are not bounded."""
    order = np.argsort(angles, axis=1)
    angles, support = np.take_along_axis(angles, order, axis=1), np.take_along_axis(support, order, axis=1)
    after, other = np.roll(angles, -1, axis=1), np.roll(support, -1, axis=1)
    turn = np.mod(after - angles, 2.0 * np.pi)
    bounded = ((turn > 1e-9) & (turn < np.pi - 1e-9)).all(axis=1)
    sine = np.where(bounded[:, None], np.sin(turn), 1.0)
    x = (support * np.sin(after) - other * np.sin(angles)) / sine
    y = (other * np.cos(angles) - support * np.cos(after)) / sine
    areas = 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    return np.where(bounded, areas, np.inf)
