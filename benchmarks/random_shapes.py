"""Random valid shapes of ten kinds, all from a seed: what the stress program and the property tests feed to the cages.

Every kind is a function from a random generator to a polygon; sizes, gaps and vertex counts are drawn so that easy,
crowded and nearly degenerate shapes all occur. Needs shapely.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
import shapely.affinity
from shapely.geometry.base import BaseGeometry

from nestedcages_core import InvalidMeshError, Mesh

Generator = np.random.Generator

VERTEX_COUNTS = (8, 20, 60, 200, 500)  # typical numbers of vertices of the kinds that can have any
SMALLEST_GAP = -6.0  # power of ten of the narrowest gaps, as a fraction of the shape's size
FARTHEST_SCALE = 6.0  # shapes are scaled by powers of ten from minus to plus this


def star(random: Generator) -> BaseGeometry:
    """Radii drawn independently: deep, sharp notches."""
    angles = np.sort(random.uniform(0.0, 2.0 * np.pi, vertex_count(random)))
    return polar(angles, random.uniform(0.2, 1.0, len(angles)))


def blob(random: Generator) -> BaseGeometry:
    """A smooth outline of a dozen waves, with round holes."""
    angles = evenly(vertex_count(random))
    waves = np.arange(2, 14)
    radius = 1.0 + 0.4 * (random.normal(size=12) / waves) @ np.cos(
        waves[:, None] * angles + random.uniform(0.0, 7.0, (12, 1))
    )
    shape = polar(angles, np.maximum(radius, 0.2))
    for _ in range(random.integers(0, 4)):
        hole = shapely.Point(random.uniform(-0.7, 0.7, 2))
        shape = shape.difference(hole.buffer(random.uniform(0.02, 0.3), quad_segs=int(random.integers(1, 8))))
    return shape


def comb(random: Generator) -> BaseGeometry:
    """Teeth with gaps that can be very narrow."""
    teeth = int(random.integers(2, 12))
    gap = 10.0 ** random.uniform(SMALLEST_GAP, -1.0)
    back = shapely.box(0.0, 0.0, float(teeth), random.uniform(0.1, 1.0))
    boxes = [shapely.box(k + gap / 2, -random.uniform(0.2, 4.0), k + 1 - gap / 2, 0.05) for k in range(teeth)]
    return shapely.union_all([back, *boxes])


def spiral(random: Generator) -> BaseGeometry:
    """A band wound up, whose turns may nearly touch."""
    turn = np.linspace(0.6, random.uniform(4.0, 16.0), 20 + vertex_count(random) // 2)
    line = shapely.LineString(turn[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1))
    return line.buffer(random.uniform(0.2, 2.6), quad_segs=int(random.integers(1, 5)))


def coast(random: Generator) -> BaseGeometry:
    """A fractal coast: a polygon whose edges are broken at displaced midpoints again and again."""
    points = polar(evenly(5), random.uniform(0.7, 1.0, 5)).exterior.coords[:-1]
    outline = np.array(points)
    roughness = random.uniform(0.1, 0.3)
    for _ in range(random.integers(3, 8)):
        following = np.roll(outline, -1, axis=0)
        edge = following - outline
        normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
        middle = 0.5 * (outline + following) + roughness * random.uniform(-1.0, 1.0, (len(outline), 1)) * normal
        outline = np.stack([outline, middle], axis=1).reshape(-1, 2)
    return shapely.Polygon(outline)


def glyph(random: Generator) -> BaseGeometry:
    """Strokes with round or square ends, merged: limbs, holes and islands as letters have them."""
    strokes = []
    for _ in range(random.integers(1, 6)):
        way = np.cumsum(random.normal(scale=0.5, size=(random.integers(2, 7), 2)), axis=0)
        style = random.choice(["round", "flat", "square"])
        line = shapely.LineString(way - way[0])
        strokes.append(line.buffer(random.uniform(0.01, 0.15), quad_segs=int(random.integers(1, 6)), cap_style=style))
    return shapely.union_all(strokes)


def discs(random: Generator) -> BaseGeometry:
    """Overlapping and separate discs: several components, some with holes between them."""
    centres = random.uniform(-1.0, 1.0, (random.integers(2, 12), 2))
    radii = random.uniform(0.05, 0.5, len(centres))
    return shapely.union_all(
        [
            shapely.Point(centre).buffer(radius, quad_segs=int(random.integers(1, 12)))
            for centre, radius in zip(centres, radii, strict=True)
        ]
    )


def islands(random: Generator) -> BaseGeometry:
    """Rings within rings, down to an island, and perhaps the same again beside it; gaps can be very narrow."""
    radius, shape = 1.0, shapely.Polygon()
    for _ in range(random.integers(1, 4)):
        thickness, gap = random.uniform(0.05, 0.4) * radius, 10.0 ** random.uniform(SMALLEST_GAP, -0.7) * radius
        corners = int(random.integers(2, 10))
        ring = shapely.Point(0.0, 0.0).buffer(radius, quad_segs=corners)
        shape = shape.union(ring.difference(shapely.affinity.scale(ring, 1 - thickness, 1 - thickness)))
        radius *= (1 - thickness) * (1 - gap) * np.cos(np.pi / (4 * corners)) ** 2
    shape = shape.union(shapely.Point(0.0, 0.0).buffer(0.5 * radius, quad_segs=3))
    if random.random() < 0.4:
        shape = shape.union(shapely.affinity.translate(shape, 2.0 + 10.0 ** random.uniform(SMALLEST_GAP, 0.0), 0.0))
    return shape


def needles(random: Generator) -> BaseGeometry:
    """Long thin spikes around a small core."""
    count = vertex_count(random)
    radius = np.where(np.arange(count) % max(2, count // 7) == 0, 1.0, random.choice([0.3, 0.01, 1e-3]))
    return polar(evenly(count), radius)


def slit(random: Generator) -> BaseGeometry:
    """A plate with one very narrow slit that bends."""
    gap, bend = 10.0 ** random.uniform(SMALLEST_GAP, -2.0), random.uniform(0.1, 0.8)
    corners = [(0, 0), (1, 0), (1, 0.4), (bend, 0.4), (bend, 0.6), (bend + gap, 0.6), (bend + gap, 0.4 + gap)]
    return shapely.Polygon([*corners, (1, 0.4 + gap), (1, 1), (0, 1)])


KINDS: tuple[Callable[[Generator], BaseGeometry], ...] = (
    star, blob, comb, spiral, coast, glyph, discs, islands, needles, slit,
)  # fmt: skip


def random_shape(seed: int) -> tuple[str, Mesh] | None:
    """(kind, mesh) for a seed, turned, scaled and moved at random; None where the drawing is not a valid mesh."""
    random = np.random.default_rng(seed)
    kind = KINDS[random.integers(len(KINDS))]
    shape = kind(random)
    if not shape.is_valid:
        shape = shape.buffer(0.0)
    if shape.is_empty or shape.geom_type not in ("Polygon", "MultiPolygon"):
        return None
    angle = random.choice([0.0, 90.0, random.uniform(0.0, 360.0)])
    scale = 10.0 ** random.uniform(-FARTHEST_SCALE, FARTHEST_SCALE)
    shift = random.choice([0.0, 1.0, 30.0]) * random.normal(size=2)
    shape = shapely.affinity.rotate(shape, angle, origin=(0.0, 0.0))
    parts = shape.geoms if hasattr(shape, "geoms") else [shape]
    loops = [np.array(ring.coords)[:-1] for part in parts for ring in (part.exterior, *part.interiors)]
    try:
        return kind.__name__, Mesh.from_loops([without_doubles((loop + shift) * scale) for loop in loops])
    except InvalidMeshError:
        return None


def vertex_count(random: Generator) -> int:
    return int(random.choice(VERTEX_COUNTS))


def evenly(count: int) -> np.ndarray:
    """(count,) angles around the circle."""
    return 2.0 * np.pi * np.arange(count) / count


def polar(angles: np.ndarray, radius: np.ndarray) -> shapely.Polygon:
    return shapely.Polygon(radius[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1))


def without_doubles(loop: np.ndarray) -> np.ndarray:
    """The loop without vertices equal to the one before."""
    return loop[np.any(loop != np.roll(loop, 1, axis=0), axis=1)]
