"""Families of shapes that no method was tuned on: conclusions are confirmed on them. Needs shapely."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely

from nestedcages_core import InvalidMeshError, Mesh
from random_shapes import evenly, polar, without_doubles

Generator = np.random.Generator


def gear(random: Generator) -> shapely.Polygon:
    """Teeth around a wheel with a hub and bolt holes."""
    teeth = int(random.integers(7, 18))
    radius = np.tile([1.0, 1.0, random.uniform(0.75, 0.9), random.uniform(0.75, 0.9)], teeth)
    wheel = polar(evenly(4 * teeth), radius).difference(shapely.Point(0.0, 0.0).buffer(0.2, quad_segs=6))
    for turn in evenly(int(random.integers(3, 7))):
        hole = shapely.Point(0.48 * np.cos(turn), 0.48 * np.sin(turn))
        wheel = wheel.difference(hole.buffer(random.uniform(0.05, 0.12), quad_segs=3))
    return wheel


def rosette(random: Generator) -> shapely.Polygon:
    """Petals of a superformula: round bulges with narrow waists."""
    angles = evenly(int(random.integers(60, 200)))
    petals, power = int(random.integers(3, 8)), random.uniform(0.6, 3.0)
    return polar(angles, 0.25 + np.abs(np.cos(0.5 * petals * angles)) ** power)


def ribbon(random: Generator) -> shapely.Polygon:
    """A band along a space-filling curve."""
    order = int(random.integers(2, 4))
    turns = "A"
    for _ in range(order):
        turns = "".join({"A": "+BF-AFA-FB+", "B": "-AF+BFB+FA-"}.get(c, c) for c in turns)
    place, heading, way = np.zeros(2), np.array([1.0, 0.0]), [np.zeros(2)]
    for c in turns:
        if c == "F":
            place = place + heading
            way.append(place)
        elif c in "+-":
            heading = np.array([-heading[1], heading[0]]) * (1.0 if c == "+" else -1.0)
    return shapely.LineString(np.array(way)).buffer(random.uniform(0.12, 0.4), quad_segs=2)


def plate(random: Generator) -> shapely.Polygon:
    """A plate with rows of holes of several shapes."""
    columns, rows = (int(random.integers(2, 4)) for _ in range(2))
    shape = shapely.box(0.0, 0.0, columns, rows)
    for i, j in np.ndindex(columns, rows):
        hole = shapely.Point(i + 0.5, j + 0.5).buffer(random.uniform(0.1, 0.42), quad_segs=int(random.integers(1, 5)))
        shape = shape.difference(hole)
    return shape


def puzzle(random: Generator) -> shapely.Polygon:
    """A square with knobs and sockets on thin necks."""
    shape = shapely.box(0.0, 0.0, 1.0, 1.0)
    for x, y, out in ((0.5, 0.0, (0, -1)), (1.0, 0.5, (1, 0)), (0.5, 1.0, (0, 1)), (0.0, 0.5, (-1, 0))):
        side, reach, size = random.choice([-1.0, 1.0]), random.uniform(0.12, 0.2), random.uniform(0.08, 0.15)
        centre = np.array([x, y]) + side * reach * np.array(out)
        knob = shapely.Point(centre).buffer(size, quad_segs=6)
        knob = knob.union(shapely.LineString([(x, y), centre]).buffer(0.4 * size, quad_segs=2))
        shape = shape.union(knob) if side > 0 else shape.difference(knob)
    return shape


def crystal(random: Generator) -> shapely.Polygon:
    """Bars with pointed ends across each other."""
    bars = []
    for _ in range(int(random.integers(3, 7))):
        angle, long, wide = random.uniform(0.0, np.pi), random.uniform(0.6, 1.0), random.uniform(0.03, 0.15)
        along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        corners = [-long * along, -0.8 * long * along - wide * across, 0.8 * long * along - wide * across,
                   long * along, 0.8 * long * along + wide * across, -0.8 * long * along + wide * across]  # fmt: skip
        bars.append(shapely.Polygon(corners))
    return shapely.union_all(bars)


KINDS: tuple[Callable[[Generator], shapely.Polygon], ...] = (gear, rosette, ribbon, plate, puzzle, crystal)


def held_out(number: int) -> tuple[str, Mesh] | None:
    """(kind, mesh) of a number, turned at random; None where the drawing is not a valid mesh. Kinds take turns."""
    random = np.random.default_rng((2026, number))
    kind = KINDS[number % len(KINDS)]
    drawn = shapely.affinity.rotate(kind(random), random.uniform(0.0, 360.0), origin=(0.0, 0.0))
    if not drawn.is_valid or drawn.geom_type != "Polygon":
        return None
    try:
        loops = [without_doubles(np.array(line.coords)[:-1]) for line in (drawn.exterior, *drawn.interiors)]
        return kind.__name__, Mesh.from_loops(loops)
    except InvalidMeshError:
        return None
