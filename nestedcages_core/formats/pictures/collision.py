"""Collision outlines of sprites: few vertices, around all opaque pixels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import scipy

from ...errors import NestedCagesError, invalid_file, no_outline
from ...geometry.arrays import AnyArray, BoolArray, FloatArray
from ...geometry.loops import trace_loops
from ...geometry.mesh import Mesh
from ...levels import Hierarchy, Progress, Settings, Within, nested_cages
from ..limits import Limits

Levels = Sequence[int | Mesh | Within] | Callable[[Mesh], Sequence[int | Mesh | Within]]

MAX_BORDER = 1e8
"""Pixels around a picture up to which they are counted; no limit allows as many."""

HALF = 0.5
"""Opacity above which a pixel counts as opaque, as in game engines."""

CUT = 0.25
"""Cut at the corner of a transparent pixel between two opaque ones that only share a point, in pixels."""

EAST, SOUTH, WEST, NORTH = range(4)
STEPS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
"""One pixel edge in each direction; x counts columns, y counts rows downwards."""


def alpha_channel(picture: AnyArray) -> FloatArray:
    """(H, W) opacity in [0, 1] of a picture (H, W), (H, W, 2) or (H, W, 4), alpha last; integers span their type."""
    given = np.asarray(picture)
    if given.ndim == 3 and given.shape[2] in (2, 4):
        given = given[:, :, -1]
    if given.ndim != 2 or given.dtype.kind not in "buif":
        raise invalid_file(
            f"A picture of shape {given.shape} and type {given.dtype} has no alpha channel; give (H, W, 4), or (H, W) "
            "opacities."
        )
    if given.dtype.kind in "ui":
        return given.astype(np.float64) / float(np.iinfo(given.dtype).max)
    return given.astype(np.float64)


def collision_outline(picture: AnyArray, vertices: int, *, settings: Settings | None = None, **options: Any) -> Mesh:
    """An outline with the given number of vertices around all opaque pixels; for the options see `picture_cages`."""
    still = replace(settings or Settings(), steps=False)
    return picture_cages(picture, [vertices], settings=still, **options).cages[0]


def picture_cages(
    picture: AnyArray,
    levels: Levels,
    *,
    padding: float = 0.0,
    threshold: float = HALF,
    holes: bool = False,
    settings: Settings | None = None,
    limits: Limits | None = None,
    progress: Callable[[Progress], None] | bool | None = None,
) -> Hierarchy:
    """Cages around all opaque pixels, with the given numbers of vertices, or fewer if the pixels have fewer corners.

    picture: as `alpha_channel` reads it; levels: vertex counts, or a function of the boundary of the pixels that gives
    them; unit: pixels, x to the right and y downwards, pixel (row, column) the square from (column, row) on; padding:
    distance in pixels that the cages keep from them and from each other; threshold: opacity above which a pixel counts
    as opaque, one half as in game engines by default; holes: whether holes are kept open, in cages too; settings;
    limits: on pixels, and on their edges as points. Parts and holes with no room for the padding are joined and closed.

    Raises NestedCagesError if nothing is opaque or the vertices are too few.
    """
    if not padding >= 0.0 or not np.isfinite(padding):
        raise invalid_file(f"The padding must be a length of at least 0 pixels, not {padding!r}.")
    opaque = alpha_channel(picture) > threshold
    chosen = settings if settings is not None else Settings()
    if holes and chosen.loops == "auto":
        chosen = replace(chosen, loops="keep")

    def around(fine: Mesh, with_settings: Settings) -> Hierarchy:
        wanted = levels(fine) if callable(levels) else levels
        fitting = [min(k, len(fine.vertices)) if isinstance(k, int | np.integer) else k for k in wanted]
        return nested_cages(fine, fitting, with_settings, progress=progress)

    fine = boundary_of_pixels(_without_holes(opaque, holes), limits=limits)
    if padding == 0.0:
        return around(fine, chosen)
    try:
        return around(fine, replace(chosen, clearance=padding))
    except NestedCagesError:
        grown = _grown(opaque, padding, holes, limits)
        if len(grown.loops) == len(fine.loops):
            raise
        return around(grown, chosen)


def boundaries_of_picture(opaque: BoolArray, padding: float) -> list[Mesh]:
    """The boundary of pixels (H, W), and what cages are made around instead: holes closed, narrow gaps filled."""
    found = [boundary_of_pixels(_without_holes(opaque, holes)) for holes in (True, False)]
    return found + [_grown(opaque, padding, holes, None) for holes in (True, False) if padding > 0.0]


def _without_holes(opaque: BoolArray, holes: bool) -> BoolArray:
    """The pixels, enclosed transparent ones included unless holes are kept."""
    if holes:
        return opaque
    return np.asarray(scipy.ndimage.binary_fill_holes(opaque))


def _grown(opaque: BoolArray, padding: float, holes: bool, limits: Limits | None) -> Mesh:
    """The boundary of all pixels closer than the padding to an opaque one, square to square."""
    border = int(min(np.ceil(padding), MAX_BORDER)) + 1
    height, width = opaque.shape
    (limits or Limits()).check("pixels", (height + 2 * border) * (width + 2 * border))
    # squares are as far apart as the centre of one from the centres of the other and its neighbours
    near = scipy.ndimage.binary_dilation(np.pad(opaque, border), np.ones((3, 3)))
    wide = np.asarray(scipy.ndimage.distance_transform_edt(~near) < padding)
    mesh = boundary_of_pixels(_without_holes(wide, holes), limits=limits)
    return Mesh(mesh.vertices - border, mesh.edges)


def boundary_of_pixels(opaque: BoolArray, *, limits: Limits | None = None) -> Mesh:
    """The outline of the pixels that are True in (H, W); pixel (row, column) is the square from (column, row) on.

    Opaque pixels that share only a corner belong together. The boundary would touch itself there; it passes through
    the two transparent pixels instead, cutting off their corners, so that every opaque pixel stays inside. Nowhere
    else does it leave the pixels' edges. Raises InvalidMeshError if nothing is opaque, NestedCagesError if more edges
    of pixels bound it than the limits allow points.
    """
    solid = np.pad(np.asarray(opaque, dtype=bool), 1)
    if solid.ndim != 2 or not solid.any():
        raise no_outline("The picture has no opaque pixel; choose another picture or a lower threshold.")
    # unit edges with the opaque pixel to the right when walking with y downwards, by direction and starting corner
    above, below = solid[:-1, 1:-1], solid[1:, 1:-1]
    left, right = solid[1:-1, :-1], solid[1:-1, 1:]
    leaves = np.zeros((4, solid.shape[0] - 1, solid.shape[1] - 1), dtype=bool)  # whether an edge leaves a corner
    leaves[EAST, :, :-1] = below & ~above
    leaves[WEST, :, 1:] = above & ~below
    leaves[SOUTH, :-1, :] = left & ~right
    leaves[NORTH, 1:, :] = right & ~left
    (limits or Limits()).check("points", int(np.count_nonzero(leaves)))
    return Mesh.from_loops(_walked(leaves))


def _walked(leaves: BoolArray) -> list[FloatArray]:
    """The loops of unit edges, corners only.

    leaves: (4, rows, columns) whether an edge leaves a corner in a direction. Where two do, the walk turns left, away
    from its opaque pixel and around the transparent one between two opaque pixels, which joins these.
    """
    rows, columns = leaves.shape[1:]
    corners = rows * columns
    ahead = np.array([1, columns, -1, -columns])
    flat = leaves.reshape(4, corners)
    direction, corner = np.nonzero(flat)
    target = corner + ahead[direction]
    onward = np.full(len(direction), -1)
    for turn in (1, 0, -1):  # right, straight on, left: the last that is possible is kept
        candidate = (direction + turn) % 4
        possible = flat[candidate, target]
        onward[possible] = candidate[possible]
    crowded = flat.sum(axis=0, dtype=np.int8) == 2
    following = np.searchsorted(direction * corners + corner, onward * corners + target)  # edges are in this order
    points = np.stack((target % columns, target // columns), axis=1).astype(np.float64)
    # the corner at the end of each edge: one point, or two where it is cut off
    cut = crowded[target]
    before = points - CUT * STEPS[direction]
    after = points + CUT * STEPS[onward]
    before[~cut] = points[~cut]
    order = trace_loops(np.stack((np.arange(len(following)), following), axis=1), points)
    turning = (onward != direction)[order.numbers]
    edges, loop = order.numbers[turning], order.loop[turning]
    repeats = 1 + cut[edges]
    twice = np.repeat(edges, repeats)
    second = np.append(False, twice[1:] == twice[:-1])
    ends = np.cumsum(np.bincount(loop, repeats).astype(np.int64))
    return np.split(np.where(second[:, None], after[twice], before[twice]), ends[:-1])


def corresponding(outlines: Sequence[Mesh]) -> list[Mesh]:
    """The outlines with loops and corners in the order of the previous frame, if their numbers agree.

    Loops are matched by their centres, outer ones with outer ones; corners by the cyclic order with the least squared
    distances. An outline with other numbers begins a new sequence.
    """
    ordered: list[Mesh] = []
    for outline in outlines:
        ordered.append(_in_the_order_of(ordered[-1], outline) if ordered else outline)
    return ordered


def _in_the_order_of(before: Mesh, outline: Mesh) -> Mesh:
    old, new = ([mesh.vertices[loop] for loop in mesh.loops] for mesh in (before, outline))
    if sorted(before.loop_signs) != sorted(outline.loop_signs):
        return outline
    cost = np.array([[float(np.sum((a.mean(axis=0) - b.mean(axis=0)) ** 2)) for b in new] for a in old])
    cost[before.loop_signs[:, None] != outline.loop_signs] += len(cost) * (1.0 + cost.max())
    _, partner = scipy.optimize.linear_sum_assignment(cost)
    if any(len(a) != len(new[k]) for a, k in zip(old, partner, strict=True)):
        return outline
    return Mesh.from_loops([_turned_to(a, new[k]) for a, k in zip(old, partner, strict=True)])


def _turned_to(target: FloatArray, loop: FloatArray) -> FloatArray:
    """A loop (k, 2) from the vertex on that brings its corners closest to those of another, centres aside."""
    target, own = target - target.mean(axis=0), loop - loop.mean(axis=0)
    distances = [float(np.sum((target - np.roll(own, -shift, axis=0)) ** 2)) for shift in range(len(loop))]
    turned: FloatArray = np.roll(loop, -int(np.argmin(distances)), axis=0)
    return turned
