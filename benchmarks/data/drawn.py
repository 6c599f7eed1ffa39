"""Shapes drawn by formulas, the same on every machine; the glyphs are DejaVu Sans, which matplotlib brings along."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from nestedcages_core import Mesh

Points = np.ndarray
"""(k, 2)."""


def ring(count: int, radius: float) -> Points:
    """Regular polygon about the origin, counter-clockwise, first vertex on the x axis."""
    angles = 2 * np.pi * np.arange(count) / count
    return radius * np.column_stack((np.cos(angles), np.sin(angles)))


def annulus(ring_vertices: int, outer_radius: float = 1.0, inner_radius: float = 0.5) -> Mesh:
    """Two regular polygons with `ring_vertices` each."""
    return Mesh.from_loops([ring(ring_vertices, outer_radius), ring(ring_vertices, inner_radius)])


def blob(count: int, waves: int = 59, amplitude: float = 0.35, decay: float = 1.1) -> Mesh:
    """A bay-rich outline, star-shaped about the origin: waves with random phases and falling amplitudes."""
    random = np.random.default_rng(0)
    angles = 2 * np.pi * np.arange(count) / count
    radius = np.ones(count)
    for k in range(2, waves + 1):
        height = amplitude * random.standard_normal() / k**decay
        radius += height * np.cos(k * angles + 2 * np.pi * random.random())
    return Mesh.from_loops([radius[:, None] * ring(count, 1.0)])


def comb(slits: int = 11, slit_width: float = 0.02, spacing: float = 0.05) -> Mesh:
    """A block of 2 by 1.2 with slits from the top to half its height, vertices at most `spacing` apart."""
    corners = [(-1.0, -0.6), (1.0, -0.6), (1.0, 0.6)]
    for x in np.linspace(1.0, -1.0, slits + 2)[1:-1]:
        right, left = x + slit_width / 2, x - slit_width / 2
        corners += [(right, 0.6), (right, 0.0), (left, 0.0), (left, 0.6)]
    corners.append((-1.0, 0.6))
    loop = np.array(corners)
    lengths = np.hypot(*(np.roll(loop, -1, axis=0) - loop).T)
    return Mesh.from_loops([divided(loop, np.ceil(lengths / spacing - 1e-9).astype(int))])


def star(points: int = 5, inner_radius: float = 0.45, per_edge: int = 20) -> Mesh:
    """A star with straight edges, first tip up."""
    radius = np.tile([1.0, inner_radius], points)[:, None]
    x, y = (radius * ring(2 * points, 1.0)).T
    return Mesh.from_loops([divided(np.column_stack((-y, x)), [per_edge] * (2 * points))])


def koch(depth: int = 4) -> Mesh:
    """The Koch snowflake, its triangle in the unit circle."""
    x, y = ring(3, 1.0).T
    loop = np.roll(np.column_stack((-y, x)), -1, axis=0)
    for _ in range(depth):
        edge = (np.roll(loop, -1, axis=0) - loop) / 3
        outwards = np.column_stack((edge[:, 1], -edge[:, 0]))
        tip = 1.5 * edge + np.sqrt(3) / 2 * outwards
        loop = np.stack([loop, loop + edge, loop + tip, loop + 2 * edge], axis=1).reshape(-1, 2)
    return Mesh.from_loops([loop])


def glyph(character: str, em: float = 2.0, per_curve: int = 12, family: str = "DejaVu Sans") -> Mesh:
    """A letter of a font that comes with matplotlib. Raises ModuleNotFoundError without matplotlib."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.path import Path
    from matplotlib.textpath import TextPath

    drawn = TextPath((0, 0), character, size=em, prop=FontProperties(family=family))
    parameters = np.arange(1, per_curve + 1)[:, None] / per_curve
    loops: list[list[Points]] = []
    for values, code in drawn.iter_segments(curves=True, simplify=False):
        points = values.reshape(-1, 2)
        if code == Path.MOVETO:
            loops.append([points])
        elif code == Path.LINETO:
            loops[-1].append(points)
        elif code == Path.CURVE3:
            start, (control, end) = loops[-1][-1][-1], points
            s, t = 1 - parameters, parameters
            loops[-1].append(s * s * start + 2 * s * t * control + t * t * end)
        elif code == Path.CURVE4:
            start, (first, second, end) = loops[-1][-1][-1], points
            s, t = 1 - parameters, parameters
            loops[-1].append(s**3 * start + 3 * s * s * t * first + 3 * s * t * t * second + t**3 * end)
    return Mesh.from_loops([without_repeats(np.concatenate(parts)) for parts in loops])


def divided(loop: Points, pieces: Iterable[int]) -> Points:
    """A polygon with each edge in so many equal pieces."""
    ends = np.roll(loop, -1, axis=0)
    return np.concatenate([a + (b - a) * np.arange(k)[:, None] / k for a, b, k in zip(loop, ends, pieces, strict=True)])


def without_repeats(loop: Points) -> Points:
    """A polygon without vertices that repeat the one before."""
    return loop[np.any(loop != np.roll(loop, 1, axis=0), axis=1)]


DRAWN: dict[str, Callable[[], Mesh]] = {
    "blob_500": lambda: blob(500),
    "blob_2000": lambda: blob(2000, waves=199),
    "comb": comb,
    "disc_64": lambda: annulus(64),
    "glyph_B": lambda: glyph("B"),
    "glyph_g": lambda: glyph("g"),
    "koch_4": koch,
    "star200": star,
}
