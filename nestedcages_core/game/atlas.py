"""An atlas: the pictures of all meshes on one page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy

from ..errors import invalid_setting
from ..exchange.pictures.png import Pixels
from ..geometry.arrays import FloatArray, IntArray
from ..libraries import load_packer
from .mesh import PartMesh, Placement

PADDING = 2
"""Pixels between regions, so that filtered textures don't blend neighbours."""

WIDTHS = 4
"""Number of widths that are tried, each twice the one before."""

MOST_PIXELS = 16384
"""Side of the largest page; common graphics processors have no larger textures."""


@dataclass(frozen=True)
class Region:
    """Where a mesh's picture lies on the page, and where on the canvas."""

    x: int
    y: int
    width: int
    height: int
    left: int
    top: int


@dataclass(frozen=True, eq=False)
class Atlas:
    """A page with the pictures of meshes."""

    page: Pixels = field(repr=False)
    """(H, W, 4)."""
    regions: tuple[Region, ...]
    """Of each mesh."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the page."""
        return self.page.shape[1], self.page.shape[0]


def atlas_of(meshes: Sequence[PartMesh], place: Placement) -> Atlas:
    """The pictures of meshes, each on a rectangle that holds its whole mesh. Raises NestedCagesError.

    Transparent pixels have the colours of the nearest painted ones, so that no dark fringe appears where textures are
    filtered.
    """
    corners = [np.stack((points.min(axis=0), points.max(axis=0))) for points in (place.down(m.points) for m in meshes)]
    boxes = [(*np.floor(low).astype(int).tolist(), *np.ceil(high).astype(int).tolist()) for low, high in corners]
    sizes = [(right - left, bottom - top) for left, top, right, bottom in boxes]
    places, (width, height) = _packed(sizes)
    if max(width, height) > MOST_PIXELS:
        raise invalid_setting(
            f"The textures need a page of {width} by {height} pixels, more than the {MOST_PIXELS} that engines take; "
            "make the picture smaller."
        )
    page = np.zeros((height, width, 4), np.uint8)
    regions = []
    for mesh, (x, y), (left, top, *_), (w, h) in zip(meshes, places, boxes, sizes, strict=True):
        row, column = mesh.top - top, mesh.left - left
        region = np.zeros((h, w, 4), np.uint8)
        region[row : row + mesh.pixels.shape[0], column : column + mesh.pixels.shape[1]] = mesh.pixels
        page[y : y + h, x : x + w] = _bled(region)
        regions.append(Region(x, y, w, h, left, top))
    return Atlas(page, tuple(regions))


def region_points(points: FloatArray, region: Region, place: Placement) -> FloatArray:
    """(n, 2) pixels of a region, y pointing down, at points (n, 2) of the puppet."""
    return place.down(points) - (region.left, region.top)


def _packed(sizes: Sequence[tuple[int, int]]) -> tuple[list[tuple[int, int]], tuple[int, int]]:
    """Upper left corners of rectangles on a page, and its size."""
    packer = load_packer()
    width = 1 << int(np.ceil(np.log2(max(w for w, _ in sizes) + 2 * PADDING)))
    best: tuple[list[tuple[int, int]], tuple[int, int]] | None = None
    for _ in range(WIDTHS):
        work = packer.newPacker(rotation=False)
        for number, (w, h) in enumerate(sizes):
            work.add_rect(w + PADDING, h + PADDING, number)
        work.add_bin(width - PADDING, sum(h + PADDING for _, h in sizes))
        work.pack()
        found: IntArray = np.array([(n, x, y, w, h) for _, x, y, w, h, n in work.rect_list()])
        found = found[found[:, 0].argsort()]
        page = (int((found[:, 1] + found[:, 3]).max()) + PADDING, int((found[:, 2] + found[:, 4]).max()) + PADDING)
        if best is None or page[0] * page[1] < best[1][0] * best[1][1]:
            best = [(x + PADDING, y + PADDING) for x, y in found[:, 1:3].tolist()], page
        width *= 2
    assert best is not None
    return best


def _bled(region: Pixels) -> Pixels:
    """Pixels whose transparent ones have the colours of the nearest others."""
    clear = region[..., 3] == 0
    nearest = scipy.ndimage.distance_transform_edt(clear, return_distances=False, return_indices=True)
    out = region.copy()
    out[..., :3] = region[nearest[0], nearest[1], :3]
    return out
