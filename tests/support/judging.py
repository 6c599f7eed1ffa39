"""Exact and independent judges of cages: numbers as fractions, areas and distances by shapely."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import Mesh, NestedCagesError, check, verify, verify_motion
from support.shapes import polygon


def assert_right(level: Any) -> None:
    """A level is what its report says, by the public judges and comparisons; its drawing is back to the last bit."""
    path, report = level.reinflation, level.report
    pair = (level.fine, level.cage) if level.inside else (level.cage, level.fine)
    certificate = verify(*pair, report.wanted_clearance, same_loops=False)
    assert certificate
    assert (report.clearance, report.excess) == (certificate.clearance, level.cage.area / level.fine.area - 1.0)
    assert np.array_equal(level.cage.edges, level.coarse.edges)
    assert np.array_equal(level.flow.steps[0], level.fine.vertices)
    assert np.array_equal(path.fine_steps[0], level.flow.steps[-1])
    assert (path.fine_steps[path.tightening_start :] == level.fine.vertices).all()
    assert np.array_equal(path.cage_steps[0], level.coarse.vertices)
    assert np.array_equal(path.cage_steps[-1], level.cage.vertices)
    assert verify_motion(level.cage, level.fine, path.cage_steps, path.fine_steps)
    assert check(level.fine, level)


@contextmanager
def rejected(code: str, kind: type[NestedCagesError] = NestedCagesError, **data: Any) -> Iterator[Any]:
    """What is done in the block is an error of a kind, with a code and such data."""
    with pytest.raises(kind) as caught:
        yield caught
    assert caught.value.code == code
    assert {name: caught.value.data.get(name) for name in data} == data


def codes(level: Any) -> list[str]:
    """The codes of a level's notes."""
    return [note.code for note in level.report.notes]


def note(level: Any, code: str) -> Any:
    """The one note with a code."""
    (found,) = (each for each in level.report.notes if each.code == code)
    return found


def gap(cage: Any, fine: Any) -> float:
    """The distance between two outlines."""
    return float(polygon(cage).boundary.distance(polygon(fine).boundary))


def edges_of(cage: Mesh) -> np.ndarray:
    """(m, 2) vectors along the edges."""
    return np.asarray(cage.vertices[cage.edges[:, 1]] - cage.vertices[cage.edges[:, 0]])


def lengths_of(cage: Mesh) -> np.ndarray:
    return np.asarray(np.hypot(*edges_of(cage).T))


def sharpest(cage: Mesh) -> float:
    """The sharpest angle between two edges that meet, in degrees."""
    least = 180.0
    for ring in cage.rings:
        before, after = np.roll(ring, 1, axis=0) - ring, np.roll(ring, -1, axis=0) - ring
        cross, dot = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1)
        least = min(least, float(np.degrees(np.arctan2(np.abs(cross), dot)).min()))
    return least


def directions(cage: Mesh) -> np.ndarray:
    """(m,) degrees of the edges, from 0 to 180."""
    edge = edges_of(cage)
    return np.asarray(np.degrees(np.arctan2(edge[:, 1], edge[:, 0])) % 180.0)


def is_along_the_axes(cage: Mesh) -> bool:
    """Whether the ends of each edge have one coordinate in common, to the last bit."""
    return bool((edges_of(cage) == 0.0).any(axis=1).all())


def is_convex(cage: Mesh) -> bool:
    """Whether each loop turns left everywhere, by fractions."""
    for ring in cage.rings:
        points = [(Fraction(x), Fraction(y)) for x, y in ring.tolist()]
        for k, (x, y) in enumerate(points):
            (px, py), (nx, ny) = points[k - 1], points[(k + 1) % len(points)]
            if (x - px) * (ny - y) - (y - py) * (nx - x) < 0:
                return False
    return True


def is_on_grid(cage: Mesh, grid: float) -> bool:
    """Whether the numbers are the doubles that multiples of the grid's decimals read as."""
    step = Decimal(repr(grid))
    return all(x == float(round(Decimal(repr(x)) / step) * step) for x in cage.vertices.ravel().tolist())


def is_mirrored(vertices: np.ndarray, axis: int, place: float) -> bool:
    """Whether vertices are mirrored at the line where a coordinate is a place, by fractions of their exact numbers.

    Both halves have distances from the line that are equal up to one rounding of their sums.
    """
    there = {tuple(row) for row in np.asarray(vertices).tolist()}
    image = np.array(vertices, dtype=float)
    image[:, axis] = 2.0 * place - image[:, axis]
    return all(tuple(row) in there for row in image.tolist())


def is_symmetric(vertices: np.ndarray, symmetry: Any) -> bool:
    """Whether of each vertex and its images one has images that are vertices to the last bit."""
    points = np.asarray(vertices)
    size = float(np.abs(points).max()) + float(np.ptp(points, axis=0).max())
    exact = {tuple(row) for row in points.tolist()}
    images = [np.asarray(symmetry.image(points, k)) for k in range(1, symmetry.order)]
    founds = np.array([all(tuple(each[k].tolist()) in exact for each in images) for k in range(len(points))])
    for k in range(len(points)):
        orbit = [k]
        for image in images:
            off = np.abs(points - image[k]).max(axis=1)
            if off.min() > 1e-13 * size:
                return False
            orbit.append(int(off.argmin()))
        if len(set(orbit)) > 1 and not founds[orbit].any():
            return False
    return True


def lies_within(cage: Any, fine: Any, distance: float) -> bool:
    """Whether no point of a cage is farther from a shape than a distance, by shapely's buffer of many chords."""
    return bool(polygon(fine).buffer(distance * (1.0 + 1e-4), quad_segs=256).contains(polygon(cage)))


def excess_in(cage: Any, fine: Any, region: shapely.Geometry) -> float:
    """The area between two outlines in a region."""
    return float(polygon(cage).symmetric_difference(polygon(fine)).intersection(region).area)


def never_rises(values: Sequence[float], by: float) -> bool:
    """Whether each value is at most the smallest before it, and a share more."""
    return all(after <= (1.0 + by) * min(values[:k]) for k, after in enumerate(values) if k)
