"""Collision outlines of sprites: few vertices, around all opaque pixels."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import scipy

from ...errors import NestedCagesError
from ...geometry.arrays import AnyArray, BoolArray, FloatArray
from ...geometry.mesh import Mesh
from ...hierarchy import Hierarchy, NestedCagesRun, Progress, Settings, Within
from ...tasks import drain
from ..limits import Limits, invalid
from .boundary import boundary_of_pixels

Levels = Sequence[int | Mesh | Within] | Callable[[Mesh], Sequence[int | Mesh | Within]]

MAX_BORDER = 1e8
"""Pixels around a picture up to which they are counted; no limit allows as many."""


def alpha_channel(picture: AnyArray) -> FloatArray:
    """(H, W) opacity in [0, 1] of a picture (H, W), (H, W, 2) or (H, W, 4), alpha last; integers span their type."""
    given = np.asarray(picture)
    if given.ndim == 3 and given.shape[2] in (2, 4):
        given = given[:, :, -1]
    if given.ndim != 2 or given.dtype.kind not in "buif":
        raise invalid(
            f"A picture of shape {given.shape} and type {given.dtype} has no alpha channel; give (H, W, 4), or (H, W) "
            "opacities."
        )
    if given.dtype.kind in "ui":
        return given.astype(np.float64) / float(np.iinfo(given.dtype).max)
    return given.astype(np.float64)


def collision_outline(picture: AnyArray, vertices: int, *, settings: Settings | None = None, **options: Any) -> Mesh:
    """An outline with the given number of vertices around all opaque pixels; for the options see `picture_cages`."""
    return picture_cages(picture, [vertices], settings=settings, **options).cages[0]


def picture_cages(
    picture: AnyArray,
    levels: Levels,
    *,
    progress: Callable[[Progress], None] | None = None,
    **options: Any,
) -> Hierarchy:
    """Cages around all opaque pixels, with the given numbers of vertices, or fewer if the pixels have fewer corners.

    picture: as `alpha_channel` reads it; levels: vertex counts, or a function of the boundary of the pixels that gives
    them; unit: pixels, x to the right and y downwards, pixel (row, column) the square from (column, row) on; padding:
    distance in pixels that the cages keep from them and from each other; threshold: opacity above which a pixel counts
    as opaque; holes: whether holes are kept open; settings; limits: on pixels, and on their edges as points. Parts and
    holes with no room for the padding are joined and closed.

    Raises NestedCagesError if nothing is opaque or the vertices are too few.
    """
    return drain(picture_cages_run(picture, levels, **options), progress)


def picture_cages_run(
    picture: AnyArray,
    levels: Levels,
    *,
    padding: float = 0.0,
    threshold: float = 0.0,
    holes: bool = False,
    settings: Settings | None = None,
    limits: Limits | None = None,
) -> Generator[Progress, None, Hierarchy]:
    """`picture_cages` as a generator of its progress that returns the cages; closing it cancels."""
    if not padding >= 0.0 or not np.isfinite(padding):
        raise invalid(f"The padding must be a length of at least 0 pixels, not {padding!r}.")
    opaque = alpha_channel(picture) > threshold
    chosen = settings if settings is not None else Settings()

    def around(fine: Mesh, with_settings: Settings) -> Generator[Progress, None, Hierarchy]:
        wanted = levels(fine) if callable(levels) else levels
        fitting = [min(k, len(fine.vertices)) if isinstance(k, int | np.integer) else k for k in wanted]
        run = NestedCagesRun(fine, fitting, with_settings)
        try:
            yield from run
        finally:
            run.close()
        return run.hierarchy

    fine = boundary_of_pixels(_without_holes(opaque, holes), limits=limits)
    if padding == 0.0:
        return (yield from around(fine, chosen))
    try:
        return (yield from around(fine, replace(chosen, clearance=padding)))
    except NestedCagesError:
        grown = _grown(opaque, padding, holes, limits)
        if len(grown.loops) == len(fine.loops):
            raise
        return (yield from around(grown, chosen))


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
