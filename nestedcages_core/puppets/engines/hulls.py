"""The islands of a painted part, each with a certified hull."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy

from ...errors import NestedCagesError, invalid_setting
from ...formats.pictures import boundary_of_pixels, collision_outline
from ...formats.pictures.png import Pixels
from ...geometry.arrays import BoolArray, FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...verification import verify

FINEST = 2.0**-6
"""Vertices are multiples of this, in pixels, so that files and float32 have them exactly."""

MARGIN, MOST_ISLANDS = 1, 64
"""Least distance of a hull from opaque pixels, in pixels: what filtered textures blend in. Islands whose margins meet
are one, and those farther apart where there are more than this many."""

LEAST_PAINT = 0.99
"""Paint of an island, in opaque pixels: less is a speck."""

SQUARE = np.ones((3, 3))
"""A pixel and all of its neighbours."""

LEAST_VERTICES = 4
"""Of the hull of a small island."""

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
    pixels = np.pad(pixels, ((MARGIN, MARGIN), (MARGIN, MARGIN), (0, 0)))
    opaque = _without_specks(pixels)
    labels, solid = _labelled(opaque)
    boxes = sorted(enumerate(scipy.ndimage.find_objects(labels), 1), key=lambda each: -_extent(each[1]))
    found = []
    for number, box in boxes:
        own = labels[box] == number
        seen, within = opaque[box] & own, solid[box] & own
        share = (_extent(box) / _extent(boxes[0][1])) ** PER_SHARE
        wanted = max(LEAST_VERTICES, round(share * vertices))
        if scipy.ndimage.label(seen, SQUARE)[1] == 1:
            hull = collision_outline(seen, wanted, padding=MARGIN)
        else:
            hull = collision_outline(within if scipy.ndimage.label(within, SQUARE)[1] == 1 else own, wanted)
        at = np.array([left, top]) - MARGIN + [box[1].start, box[0].start]
        rows, columns = (np.flatnonzero(seen.any(axis=axis)) for axis in (1, 0))
        cut = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
        x, y = int(at[0] + columns[0]), int(at[1] + rows[0])
        island = np.where(seen[cut][..., None], pixels[box][cut], 0)
        found.append(Island(x, y, island, stored(hull.vertices[hull.loops[0]]) + at))
    return found


def _without_specks(pixels: Pixels) -> BoolArray:
    """(h, w) what is painted, without dots that nobody sees next to the rest."""
    opaque = pixels[..., 3] > 0
    labels, count = scipy.ndimage.label(opaque, SQUARE)
    paint = scipy.ndimage.sum_labels(pixels[..., 3] / 255.0, labels, np.arange(count + 1))
    seen = paint >= min(LEAST_PAINT, float(paint.max()))
    seen[0] = False
    return np.asarray(seen[labels])


def _labelled(opaque: BoolArray) -> tuple[IntArray, BoolArray]:
    """The number of the island of each pixel, 0 outside of all, and the pixels that hulls are made around.

    These are the opaque ones with their margins, and what lies between those of one island.
    """
    distance, reach = scipy.ndimage.distance_transform_cdt(~opaque), MARGIN
    while True:
        near = distance <= reach
        labels, count = scipy.ndimage.label(scipy.ndimage.binary_fill_holes(near), SQUARE)
        if count <= MOST_ISLANDS:
            return labels, scipy.ndimage.distance_transform_cdt(near) > reach - MARGIN
        reach *= 2


def stored(points: FloatArray) -> FloatArray:
    """Points rounded to what files and engines store exactly."""
    return np.asarray(np.round(points / FINEST) * FINEST)


def _extent(box: tuple[slice, slice]) -> float:
    return float(sum(side.stop - side.start for side in box))
