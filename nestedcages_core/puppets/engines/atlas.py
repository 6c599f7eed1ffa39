"""An atlas: the pictures of all meshes on one page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy

from ...errors import invalid_setting
from ...formats.pictures.png import Pixels
from ...geometry.arrays import FloatArray
from .textured_mesh import PartMesh, Placement

PADDING = 2
"""Pixels between regions, so that filtered textures don't blend neighbours."""

WIDTHS = np.geomspace(0.7, 3.0, 12)
"""Widths of pages that are tried, in sides of a square of the rectangles' area; 60 random atlases are 82 % full."""

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
    """The textures of meshes. Raises NestedCagesError."""
    textures = [texture_of(mesh, place) for mesh in meshes]
    sizes = [(texture.shape[1], texture.shape[0]) for texture, _, _ in textures]
    places, (width, height) = _packed(sizes)
    if max(width, height) > MOST_PIXELS:
        raise invalid_setting(
            f"The textures need a page of {width} by {height} pixels, more than the {MOST_PIXELS} that engines take; "
            "make the picture smaller."
        )
    page = np.zeros((height, width, 4), np.uint8)
    regions = []
    for (texture, left, top), (x, y), (w, h) in zip(textures, places, sizes, strict=True):
        page[y : y + h, x : x + w] = texture
        regions.append(Region(x, y, w, h, left, top))
    return Atlas(page, tuple(regions))


def texture_of(mesh: PartMesh, place: Placement) -> tuple[Pixels, int, int]:
    """The picture of a mesh on a rectangle that holds the whole mesh, and its left and top on the canvas.

    Transparent pixels have the colours of the nearest painted ones, so that no dark fringe appears where textures are
    filtered.
    """
    points = place.down(mesh.points)
    left, top = np.floor(points.min(axis=0)).astype(int).tolist()
    right, bottom = np.ceil(points.max(axis=0)).astype(int).tolist()
    texture = np.zeros((bottom - top, right - left, 4), np.uint8)
    height, width = mesh.pixels.shape[:2]
    row, column = mesh.top - top, mesh.left - left
    texture[row : row + height, column : column + width] = mesh.pixels
    return _bled(texture), left, top


def region_points(points: FloatArray, region: Region, place: Placement) -> FloatArray:
    """(n, 2) pixels of a region, y pointing down, at points (n, 2) of the puppet."""
    return place.down(points) - (region.left, region.top)


def page_points(points: FloatArray, region: Region, place: Placement) -> FloatArray:
    """(n, 2) pixels of the page at points (n, 2) of the puppet."""
    return np.asarray(region_points(points, region, place) + np.array([region.x, region.y]))


def _packed(sizes: Sequence[tuple[int, int]]) -> tuple[list[tuple[int, int]], tuple[int, int]]:
    """Upper left corners of rectangles on a page, and its size: the smallest page of several widths."""
    padded = [(width + PADDING, height + PADDING) for width, height in sizes]
    side, widest = np.sqrt(sum(width * height for width, height in padded)), max(width for width, _ in padded)
    best: tuple[list[tuple[int, int]], tuple[int, int]] | None = None
    for shape in WIDTHS:
        places = _on_skyline(padded, max(widest, round(shape * side)))
        ends = np.array(places) + padded
        width, height = (int(end) + PADDING for end in ends.max(axis=0))
        if best is None or width * height < best[1][0] * best[1][1]:
            best = [(x + PADDING, y + PADDING) for x, y in places], (width, height)
    assert best is not None
    return best


def _on_skyline(sizes: Sequence[tuple[int, int]], page: int) -> list[tuple[int, int]]:
    """Upper left corners of rectangles on a page of a width, the tallest first, each as high up as it goes."""
    filled = np.zeros(page, dtype=np.int64)
    places = [(0, 0)] * len(sizes)
    for number in sorted(range(len(sizes)), key=lambda k: (-sizes[k][1], -sizes[k][0], k)):
        width, height = sizes[number]
        below = np.lib.stride_tricks.sliding_window_view(filled, width).max(axis=1)
        x = int(below.argmin())
        y = int(below[x])
        places[number] = (x, y)
        filled[x : x + width] = y + height
    return places


def _bled(region: Pixels) -> Pixels:
    """Pixels whose transparent ones have the colours of the nearest others."""
    clear = region[..., 3] == 0
    nearest = scipy.ndimage.distance_transform_edt(clear, return_distances=False, return_indices=True)
    out = region.copy()
    out[..., :3] = region[nearest[0], nearest[1], :3]
    return out
