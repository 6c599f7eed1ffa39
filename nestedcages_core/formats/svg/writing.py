"""SVG out: meshes become paths with holes."""

from __future__ import annotations

import html
import math
import os
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...errors import invalid_file
from ...geometry.drawable import Drawable
from ...geometry.mesh import Mesh, MeshLike
from ..decimals import check_decimals
from ..figures import CAGE_OPACITY, COLOURS, DRAWING_OPACITY, path_data
from ..files import write_whole
from ..meshes import meshes_of
from .document import DECORATION, OUTLINES, Frame

PAGE_MARGIN = 0.02
"""Margin around the shapes of a document, as a fraction of their diagonal."""

STROKE = 0.004
"""Width of outlines, as a fraction of the diagonal of all shapes; narrower for several drawings."""

NOT_XML = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
"""Characters that XML does not allow."""

Shapes = Drawable | MeshLike | Sequence[Mesh] | Mapping[str, Mesh]


def to_svg(
    shapes: Shapes,
    *,
    view_box: Sequence[float] | None = None,
    frame: Frame | None = None,
    levels: Sequence[int] | None = None,
    y_up: bool = False,
    decimals: int | None = None,
    size: tuple[float, str] | None = None,
) -> str:
    """An SVG document with one path per mesh, with holes and exact coordinates.

    shapes: a mesh or an array, a level, a hierarchy, several meshes, or meshes by the id that each path gets.
    view_box: x, y, width and height of the view; default: all shapes.
    frame: of a document that was read, so that the output coincides with it.
    levels: of each shape, 0 for a drawing, 1 for its innermost cage, -1 for the first one inside; default: in order.
    Levels differ in colour and in class, "level-0", "inner-1" and so on; the highest is drawn first, so that cages lie
    below their contents.
    y_up: whether y points up, as in maps.
    decimals: the most that a coordinate of a cage may have, as of `to_geojson`; a drawing is written as it is.
    size: length of a unit on paper with its CSS unit, such as (1.0, "mm"); default: as in the frame, or none.
    """
    named = _named(shapes)
    if not named:
        raise invalid_file("There is nothing to write; give at least one mesh.")
    level_of = list(range(len(named)) if levels is None else levels)
    if len(level_of) != len(named):
        raise invalid_file(f"There are {len(level_of)} levels for {len(named)} shapes; give one for each.")
    cages = [mesh for level, mesh in zip(level_of, named.values(), strict=True) if level != 0]
    check_decimals(cages or named.values(), decimals)
    points = np.concatenate([mesh.vertices for mesh in named.values()]) * (1.0, -1.0 if y_up else 1.0)
    low, high = points.min(axis=0), points.max(axis=0)
    diagonal = float(np.hypot(*(high - low)))
    if view_box is None and (frame is None or frame.page is None):
        frame = None
        view_box = (*(low - PAGE_MARGIN * diagonal), *(high - low + 2.0 * PAGE_MARGIN * diagonal))
    page = _page(view_box, frame, size)
    width = STROKE * diagonal / math.sqrt(max(Counter(level_of).values()))
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" {page} overflow="visible" {OUTLINES}="{DECORATION}">']
    if y_up:
        lines.append('<g transform="scale(1 -1)">')
    for level, (name, mesh) in sorted(zip(level_of, named.items(), strict=True), key=lambda each: -each[0]):
        colour = COLOURS[abs(level) % len(COLOURS)]
        kind = f"level-{level}" if level >= 0 else f"inner-{-level}"
        lines.append(
            f'  <path id="{html.escape(NOT_XML.sub("_", name))}" class="{kind}" fill="{colour}" '
            f'fill-opacity="{CAGE_OPACITY if level else DRAWING_OPACITY}" fill-rule="evenodd" stroke="{colour}" '
            f'stroke-width="{width:.3g}" stroke-linejoin="round"\n    d="{path_data(mesh)}"/>'
        )
    return "\n".join([*lines, *(["</g>"] if y_up else []), "</svg>", ""])


def write_svg(path: str | os.PathLike[str], shapes: Shapes, **options: Any) -> None:
    """Write an SVG file, whole or not at all; shapes and options as of `to_svg`."""
    write_whole(path, to_svg(shapes, **options))


def _page(view_box: Sequence[float] | None, frame: Frame | None, size: tuple[float, str] | None) -> str:
    """Attributes that define the view; size: of a unit."""
    seen = view_box if view_box is not None else frame.view_box if frame else None
    found = {"viewBox": " ".join(f"{float(number):.9g}" for number in seen)} if seen is not None else {}
    if size is not None and seen is not None:
        for key, length in (("width", seen[2]), ("height", seen[3])):
            found[key] = f"{float(length) * size[0]:.9g}{html.escape(size[1])}"
    elif frame is not None:
        given = {"width": frame.width, "height": frame.height, "preserveAspectRatio": frame.preserve_aspect_ratio}
        found.update({key: html.escape(value) for key, value in given.items() if value})
    return " ".join(f'{key}="{value}"' for key, value in found.items())


def _named(shapes: Shapes) -> dict[str, Mesh]:
    if isinstance(shapes, Mapping):
        return dict(shapes)
    return {"shape" if k == 0 else f"cage-{k}": mesh for k, mesh in enumerate(meshes_of(shapes))}
