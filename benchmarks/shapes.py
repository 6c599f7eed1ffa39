"""The shapes that are not random: drawn by formulas, held out, and of any size. Random ones are in `random_shapes`."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

from nestedcages_core import InvalidMeshError, Mesh

DATA = Path(__file__).resolve().parent / "data"
Points = np.ndarray
"""(k, 2)."""


def ring(count: int, radius: float = 1.0) -> Points:
    """Regular polygon about the origin, counter-clockwise, first vertex on the x axis."""
    angles = 2 * np.pi * np.arange(count) / count
    return radius * np.column_stack((np.cos(angles), np.sin(angles)))


def annulus(ring_vertices: int, outer_radius: float = 1.0, inner_radius: float = 0.5) -> Mesh:
    """Two regular polygons with `ring_vertices` each: the discs of the paper's Table 1."""
    return Mesh.from_loops([ring(ring_vertices, outer_radius), ring(ring_vertices, inner_radius)])


def blob(count: int, waves: int = 59) -> Mesh:
    """A bay-rich outline, star-shaped about the origin: waves with random phases and falling amplitudes."""
    random = np.random.default_rng(0)
    angles = 2 * np.pi * np.arange(count) / count
    radius = np.ones(count)
    for k in range(2, waves + 1):
        height = 0.35 * random.standard_normal() / k**1.1
        radius += height * np.cos(k * angles + 2 * np.pi * random.random())
    return Mesh.from_loops([radius[:, None] * ring(count)])


def comb(slits: int = 11, width: float = 0.02, spacing: float = 0.05) -> Mesh:
    """A block of 2 by 1.2 with slits from the top to half its height, vertices at most `spacing` apart."""
    corners = [(-1.0, -0.6), (1.0, -0.6), (1.0, 0.6)]
    for x in np.linspace(1.0, -1.0, slits + 2)[1:-1]:
        corners += [(x + width / 2, 0.6), (x + width / 2, 0.0), (x - width / 2, 0.0), (x - width / 2, 0.6)]
    loop = np.array([*corners, (-1.0, 0.6)])
    lengths = np.hypot(*(np.roll(loop, -1, axis=0) - loop).T)
    return Mesh.from_loops([divided(loop, np.ceil(lengths / spacing - 1e-9).astype(int))])


def star(points: int = 5, inner_radius: float = 0.45, per_edge: int = 20) -> Mesh:
    """A star with straight edges, first tip up."""
    x, y = (np.tile([1.0, inner_radius], points)[:, None] * ring(2 * points)).T
    return Mesh.from_loops([divided(np.column_stack((-y, x)), [per_edge] * (2 * points))])


def koch(depth: int = 4) -> Mesh:
    """The Koch snowflake, its triangle in the unit circle."""
    x, y = ring(3).T
    loop = np.roll(np.column_stack((-y, x)), -1, axis=0)
    for _ in range(depth):
        edge = (np.roll(loop, -1, axis=0) - loop) / 3
        tip = 1.5 * edge + np.sqrt(3) / 2 * np.column_stack((edge[:, 1], -edge[:, 0]))
        loop = np.stack([loop, loop + edge, loop + tip, loop + 2 * edge], axis=1).reshape(-1, 2)
    return Mesh.from_loops([loop])


def glyph(character: str, per_curve: int = 12, family: str = "DejaVu Sans", style: str = "normal") -> Mesh:
    """A letter of a font that comes with matplotlib; style: "normal", "bold" or "oblique"."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.path import Path as Outline
    from matplotlib.textpath import TextPath

    t = np.arange(1, per_curve + 1)[:, None] / per_curve
    loops: list[list[Points]] = []
    font = FontProperties(family, weight="bold") if style == "bold" else FontProperties(family, style)
    drawn = TextPath((0, 0), character, size=2.0, prop=font)
    for values, code in drawn.iter_segments(curves=True, simplify=False):
        points = values.reshape(-1, 2)
        if code == Outline.MOVETO:
            loops.append([points])
        elif code == Outline.LINETO:
            loops[-1].append(points)
        elif code == Outline.CURVE3:
            start, (control, end) = loops[-1][-1][-1], points
            loops[-1].append((1 - t) ** 2 * start + 2 * (1 - t) * t * control + t**2 * end)
        elif code == Outline.CURVE4:
            raise InvalidMeshError(f"{family} has cubic curves", code="mesh.crossing")
    joined = [np.concatenate(parts) for parts in loops]
    return Mesh.from_loops([loop[np.any(loop != np.roll(loop, 1, axis=0), axis=1)] for loop in joined])


def divided(loop: Points, pieces: Iterable[int]) -> Points:
    """A polygon with each edge in so many equal pieces."""
    ends = np.roll(loop, -1, axis=0)
    return np.concatenate([a + (b - a) * np.arange(k)[:, None] / k for a, b, k in zip(loop, ends, pieces, strict=True)])


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
QUICK = ("comb", "glyph_g")


def drawn(quick: bool = False) -> dict[str, Mesh]:
    """The shapes by name."""
    return {name: make() for name, make in DRAWN.items() if not quick or name in QUICK}


def held_out() -> Iterator[tuple[str, Mesh]]:
    """Letters, icons and maps that no method was tuned on, sources in turns; the file names source and licence."""
    lines = json.loads((DATA / "held_out.json").read_text(encoding="utf-8"))
    np.random.default_rng(0).shuffle(lines)
    for line in lines:
        yield f"{line['family']}: {line['name']}", Mesh.from_loops([np.array(loop) for loop in line["loops"]])


# of any size


def smooth(count: int) -> Mesh:
    """Twelve waves."""
    return _waves(count, np.arange(2, 14), 0.3)


def rough(count: int) -> Mesh:
    """Waves down to a few vertices long, each as steep as the others."""
    return _waves(count, np.unique(np.geomspace(2, count / 8, 60).astype(int)), 0.25)


def _waves(count: int, frequencies: np.ndarray, steepness: float) -> Mesh:
    random = np.random.default_rng(1)
    angle = 2.0 * np.pi * np.arange(count) / count
    radius = np.ones(count)
    for frequency in frequencies:
        radius += steepness * random.normal() / frequency * np.cos(frequency * angle + random.uniform(0.0, 7.0))
    return Mesh.from_loops([np.maximum(radius, 0.2)[:, None] * ring(count)])


def fractal(count: int) -> Mesh:
    """A hexagon whose edges are broken at displaced midpoints until there are enough, then thinned evenly."""
    random, outline = np.random.default_rng(2), ring(6)
    while len(outline) < count:
        following = np.roll(outline, -1, axis=0)
        edge = following - outline
        normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
        middle = 0.5 * (outline + following) + 0.14 * random.uniform(-1.0, 1.0, (len(outline), 1)) * normal
        outline = np.stack([outline, middle], axis=1).reshape(-1, 2)
    return Mesh.from_loops([outline[np.unique(np.linspace(0, len(outline), count, endpoint=False).astype(int))]])


def islands(count: int) -> Mesh:
    """So many blobs of 24 vertices in rows."""
    side = int(np.ceil(count**0.5))
    loop = blob(24, waves=5).vertices
    return Mesh.from_loops([loop + 4.0 * np.array(divmod(k, side)) for k in range(count)])


GROWING: dict[str, Callable[[int], Mesh]] = {"fractal": fractal, "smooth": smooth, "rough": rough, "islands": islands}
