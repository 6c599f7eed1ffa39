"""The islands of a painted part, each with a certified hull."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy

from ..errors import NestedCagesError, invalid_setting
from ..exchange.pictures import boundary_of_pixels, picture_cages
from ..exchange.pictures.png import Pixels
from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.mesh import Mesh
from ..hierarchy import Settings
from ..verification import verify

MARGIN = 1.0
"""Least distance of a hull from opaque pixels, in pixels: what filtered textures blend in."""

FINEST = 2.0**-6
"""Vertices are multiples of this, in pixels, so that files and float32 have them exactly."""

JOINED = 2
"""Islands at most this many pixels apart are one: their margins meet."""

LEAST_VERTICES, MOST_VERTICES = 4, 64
"""Of the hull of a small island, and of one that needs more than was wanted."""

PER_SHARE = 0.5
"""Power of an island's share of the largest one's perimeter by which it gets fewer vertices than that."""


@dataclass(frozen=True, eq=False)
class Island:
    """Pixels that hang together, and a hull around them."""

    left: int
    top: int
    pixels: Pixels = field(repr=False)
    """(h, w, 4) of this island alone."""
    loop: FloatArray
    """(n, 2) the hull, around all opaque pixels, in pixels of the canvas, y pointing down."""


def certify(loop: FloatArray, pixels: Pixels, left: int, top: int) -> None:
    """Raise NestedCagesError unless a simple loop (n, 2) strictly encloses all opaque pixels: exact predicates."""
    outline = boundary_of_pixels(scipy.ndimage.binary_fill_holes(pixels[..., 3] > 0))
    placed = Mesh(outline.vertices + np.array([left, top]), outline.edges)
    certificate = verify(Mesh.from_loops([loop]), placed, same_loops=False)
    if not certificate:
        problem = f"A hull does not enclose its pixels: {certificate.problems[0]}"
        raise NestedCagesError(problem, code="certificate.failed", problems=certificate.problems)


def islands_of(pixels: Pixels, left: int, top: int, vertices: int) -> list[Island]:
    """The islands of a picture at a place on the canvas, the largest first.

    vertices: of the largest one's hull; smaller ones have fewer. Raises NestedCagesError.
    """
    if vertices < LEAST_VERTICES:
        raise invalid_setting(f"A hull has at least {LEAST_VERTICES} vertices, not {vertices}.")
    opaque = pixels[..., 3] > 0
    solid = scipy.ndimage.binary_fill_holes(_bridged(opaque))
    labels, count = scipy.ndimage.label(solid, np.ones((3, 3)))
    boxes = scipy.ndimage.find_objects(labels)
    order = sorted(range(count), key=lambda k: -_extent(boxes[k]))
    found = []
    for k in order:
        rows, columns = boxes[k]
        own = opaque & (labels == k + 1)
        rows = slice(*(np.flatnonzero(own.any(axis=1))[[0, -1]] + (0, 1)))
        columns = slice(*(np.flatnonzero(own.any(axis=0))[[0, -1]] + (0, 1)))
        share = (_extent(boxes[k]) / _extent(boxes[order[0]])) ** PER_SHARE
        cut = np.where(own[rows, columns, None], pixels[rows, columns], 0)
        wanted = max(LEAST_VERTICES, round(share * vertices))
        x, y = left + int(columns.start), top + int(rows.start)
        found.append(Island(x, y, cut, stored(_hull_of(own[rows, columns], wanted)) + np.array([x, y])))
    return found


def stored(points: FloatArray) -> FloatArray:
    """Points rounded to what files and engines store exactly."""
    return np.asarray(np.round(points / FINEST) * FINEST)


def _hull_of(opaque: BoolArray, vertices: int) -> FloatArray:
    """(n, 2) a loop around the pixels that are True in (h, w), holes closed.

    It has more vertices than wanted where these are too few. Raises NestedCagesError.
    """
    merged = None
    while True:
        try:
            (cage,) = picture_cages(opaque, [vertices], padding=MARGIN, settings=merged).cages
        except NestedCagesError:
            if vertices >= MOST_VERTICES:
                raise
            vertices *= 2
            continue
        if len(cage.loops) == 1 or merged is not None:
            return np.asarray(cage.vertices[cage.loops[0]])
        merged = Settings(merge=float(2 * JOINED))


def _bridged(opaque: BoolArray) -> BoolArray:
    """The pixels, with those between islands that are near each other."""
    return np.asarray(scipy.ndimage.binary_dilation(opaque, np.ones((JOINED + 1,) * 2)))


def _extent(box: tuple[slice, slice]) -> float:
    return float(sum(side.stop - side.start for side in box))
