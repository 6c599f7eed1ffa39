"""Shapes that several tests draw, and shapely's view of them. All drawn here."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from nestedcages_core import Mesh


def ring(count: int, radius: float = 1.0, angle: float = 0.0, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """(count, 2) regular polygon with its first vertex at ``angle``."""
    turn = angle + 2.0 * np.pi * np.arange(count) / count
    return radius * np.stack([np.cos(turn), np.sin(turn)], axis=1) + np.array(centre)


def mesh(*loops: Any) -> Mesh:
    return Mesh.from_loops([np.array(loop, float) for loop in loops])


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def annulus(count: int, inner: float = 0.5, angle: float = 0.0) -> Mesh:
    """Two regular polygons with ``count`` vertices each, of radius 1 and ``inner``."""
    return Mesh.from_loops([ring(count, 1.0, angle), ring(count, inner, angle)])


def square_with_hole(inner: float = 0.5) -> Mesh:
    return annulus(4, inner, np.pi / 4)


def octagon_with_hole(inner: float = 0.5) -> Mesh:
    return annulus(8, inner, np.pi / 8)


def letter_a_coarse() -> Mesh:
    """A letter A that stands on two legs and holds out two arms, with a triangular hole: 21 vertices."""
    outline = [(-1.6, 0.0), (-0.9, 0.0), (-0.55, 1.2), (0.55, 1.2), (0.9, 0.0), (1.6, 0.0), (1.6, 0.35), (1.25, 0.4)]
    outline += [(0.95, 1.9), (2.0, 2.3), (1.9, 2.7), (0.75, 2.5), (0.3, 4.0), (-0.3, 4.0), (-0.75, 2.5), (-1.9, 2.7)]
    outline += [(-2.0, 2.3), (-0.95, 1.9), (-1.25, 0.4), (-1.6, 0.35)]
    hole = [(-0.3, 1.8), (0.3, 1.8), (0.0, 2.8)]
    return Mesh.from_loops([np.array(outline), np.array(hole)])


def letter_a(per_edge: int = 3) -> Mesh:
    """The coarse letter A with rounded corners (two rounds of corner cutting) and every edge divided: a fine mesh."""
    loops = []
    for loop in (letter_a_coarse().vertices[k] for k in letter_a_coarse().loops):
        points = loop
        for _ in range(2):
            following = np.roll(points, -1, axis=0)
            points = np.stack([0.8 * points + 0.2 * following, 0.2 * points + 0.8 * following], axis=1).reshape(-1, 2)
        following = np.roll(points, -1, axis=0)
        part = np.linspace(0.0, 1.0, per_edge, endpoint=False)[None, :, None]
        loops.append((points[:, None] * (1 - part) + following[:, None] * part).reshape(-1, 2))
    return Mesh.from_loops(loops)


def star(points: int = 9, count: int = 180) -> Mesh:
    turn = 2.0 * np.pi * np.arange(count) / count
    radius = 1.0 + 0.35 * np.cos(points * turn)
    return Mesh.from_loops([radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)])


def jagged(random: np.random.Generator, count: int) -> np.ndarray:
    """A simple loop with random radii up to 1, (count, 2)."""
    angle = (np.arange(count) + random.uniform(0.0, 0.9, count)) / count * 2 * np.pi
    return np.stack((np.cos(angle), np.sin(angle)), axis=1) * random.uniform(0.4, 1.0, (count, 1))


def islands() -> Mesh:
    """An annulus with an island in its hole, and another component beside it: five loops, three components."""
    beside = np.array([1.9, 0.2])
    return Mesh.from_loops(
        [ring(40, 1.0), ring(32, 0.7), ring(16, 0.3), ring(24, 0.6) + beside, ring(12, 0.25) + beside]
    )


def disc(count: int, radius: float, x: float, y: float) -> np.ndarray:
    """Regular polygon around (x, y)."""
    return ring(count, radius) + np.array([x, y])


def comb(slits: int, width: float, depth: float = 0.5, per_unit: int = 40) -> Mesh:
    """A block with slits from above."""
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.6)]
    for x in np.linspace(1.0, 0.0, slits + 2)[1:-1]:
        corners += [
            (x + width / 2, 0.6),
            (x + width / 2, 0.6 - depth),
            (x - width / 2, 0.6 - depth),
            (x - width / 2, 0.6),
        ]
    corners.append((0.0, 0.6))
    points = []
    for a, b in zip(np.array(corners), np.roll(np.array(corners), -1, axis=0), strict=True):
        count = max(1, int(np.ceil(np.hypot(*(b - a)) * per_unit)))
        points += [a + (b - a) * k / count for k in range(count)]
    return Mesh.from_loops([np.array(points)])


def resampled(mesh: Mesh, count: int, shift: float = 0.0) -> Mesh:
    """Even points along the loops, ``count`` in all; shift in spacings."""
    lengths = [mesh.edge_lengths[loop].sum() for loop in mesh.loops]
    loops = []
    for loop, length in zip(mesh.loops, lengths, strict=True):
        share = max(3, round(count * length / sum(lengths)))
        line = shapely.LinearRing(mesh.vertices[loop])
        at = (np.arange(share) + shift) % share * (line.length / share)
        loops.append(shapely.get_coordinates(shapely.line_interpolate_point(line, at)))
    return Mesh.from_loops(loops)


def segments_of(kind: str, count: int, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Segments (count, 2) -> (count, 2) of a kind that trees find easy or hard."""
    if kind == "soup":
        starts = random.uniform(size=(count, 2))
        return starts, starts + random.normal(scale=0.05 * min(1.0, 300.0 / max(count, 1)), size=(count, 2))
    if kind == "loop":
        angle = np.arange(count) / max(count, 1) * 2 * np.pi
        radius = 1 + 0.3 * np.sin(5 * angle)
        points = np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=1)
    elif kind == "star":
        angle, radius = np.sort(random.uniform(0, 2 * np.pi, count)), random.uniform(0.5, 1.5, count)
        points = np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=1)
    elif kind == "comb":
        x = np.arange(count) / max(count, 1)
        points = np.stack((x, np.arange(count) % 2), axis=1) @ np.array([[0.8, 0.6], [-0.6, 0.8]])
    else:
        points = random.integers(0, 6, size=(count, 2)).astype(float)
    return points, np.roll(points, -1, axis=0)


def derivative(function: Callable[[np.ndarray], np.ndarray | float], x: np.ndarray, step: float = 1e-6) -> np.ndarray:
    """Central differences with respect to each coordinate of x (m, 2), which become the last two axes."""
    columns = []
    for v, axis in np.ndindex(x.shape):
        way = np.zeros_like(x)
        way[v, axis] = step
        columns.append((np.asarray(function(x + way)) - np.asarray(function(x - way))) / (2 * step))
    return np.moveaxis(np.array(columns).reshape(*x.shape, *np.shape(columns[0])), (0, 1), (-2, -1))


def lines(vertices: np.ndarray, mesh: Mesh) -> shapely.MultiLineString:
    return shapely.MultiLineString([vertices[np.append(loop, loop[0])] for loop in mesh.loops])


def polygon(mesh: Mesh) -> shapely.MultiPolygon:
    """The solid, by shapely alone: outer loops minus holes, from the loops of the mesh."""
    shells = [loop for loop, sign in zip(mesh.loops, mesh.loop_signs, strict=True) if sign > 0]
    holes = [loop for loop, sign in zip(mesh.loops, mesh.loop_signs, strict=True) if sign < 0]
    solid = shapely.MultiPolygon()
    for k in sorted([*shells, *holes], key=lambda loop: -shapely.Polygon(mesh.vertices[loop]).area):
        solid = solid.symmetric_difference(shapely.Polygon(mesh.vertices[k]))
    return solid


def assert_free_of_crossings(cage: Mesh, fine: Mesh, cage_steps: Any, fine_steps: Any) -> None:
    """By shapely, at sampled instants of the linear motions between steps (K + 1, m, 2) and (K + 1, n, 2)."""
    for (x, after), (y, then) in zip(pairwise(cage_steps), pairwise(fine_steps), strict=True):
        for s in np.linspace(0.0, 1.0, 6):
            outline = lines((1.0 - s) * x + s * after, cage)
            assert outline.is_simple
            assert not outline.intersects(lines((1.0 - s) * y + s * then, fine))


def assert_nested(cage: Mesh, fine: Mesh) -> None:
    """By shapely: both are valid, the cage covers the fine mesh without touching it, and has its loops."""
    outside, inside = polygon(cage), polygon(fine)
    for mesh in (cage, fine):
        assert lines(mesh.vertices, mesh).is_simple
    assert outside.is_valid
    assert inside.is_valid
    assert outside.covers(inside)
    assert outside.boundary.distance(inside.boundary) > 0.0
    assert len(cage.loops) == len(fine.loops)
    assert sorted(cage.loop_signs.tolist()) == sorted(fine.loop_signs.tolist())


def as_set(pairs: tuple[np.ndarray, np.ndarray]) -> set[tuple[int, int]]:
    """Pairs as a set; each must come once."""
    listed = list(zip(pairs[0].tolist(), pairs[1].tolist(), strict=True))
    assert len(set(listed)) == len(listed)
    return set(listed)
