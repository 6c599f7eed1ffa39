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


def _spiral(random: Draw) -> BaseGeometry:
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


KINDS: tuple[Callable[[Draw], BaseGeometry], ...] = (_star, _blob, _comb, _spiral, _glyph, _discs, _needles)


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
