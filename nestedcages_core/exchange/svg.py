"""SVG in and out: filled areas become a mesh, meshes become paths with holes."""

from __future__ import annotations

import html
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..errors import NestedCagesError
from ..geometry.mesh import Mesh
from .curves import flattened
from .fill import Painted, solid
from .svg_elements import SvgReader

DEFAULT_TOLERANCE = 5e-4
"""Greatest distance of chords from curves when none is given, as a share of the drawing's diagonal."""

GREATEST_COORDINATE = 1e150
"""Coordinates beyond this cannot be multiplied with each other."""

MARGIN = 0.02
"""Empty space around the shapes of a written document, as a share of their diagonal."""

STROKE = 0.004
"""Width of written outlines, as a share of the diagonal."""

COLOURS = ("#27364b", "#0072b2", "#009e73", "#d55e00", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours of written shapes, in turn: dark for the drawing, then those of Okabe and Ito, also for the colour-blind."""


def from_svg(text: str | bytes, *, tolerance: float | None = None, element: str | None = None) -> Mesh:
    """The filled area of an SVG document as a mesh, in the document's user units, y pointing down as there.

    Overlapping shapes are united, fill rules and transforms respected. Where nothing is filled, closed outlines count
    as filled. tolerance: greatest distance between a curve and the chords that stand for it, 1/2000 of the drawing's
    diagonal unless given; element: the id of one element to read alone.

    Raises NestedCagesError for what is not such a document, InvalidMeshError where the area touches itself.
    """
    if tolerance is not None and not tolerance > 0.0:
        raise NestedCagesError(f"The tolerance must be a positive length, not {tolerance!r}.")
    shapes = SvgReader(text).shapes(element)
    painted = [shape for shape in shapes if shape.filled]
    outlines = painted or [shape for shape in shapes if any(path.closed for path in shape.subpaths)]
    if not outlines:
        raise NestedCagesError(
            "The drawing has no filled or closed shapes; close its paths, or convert strokes and text to paths."
        )
    controls = np.concatenate([curve for shape in outlines for path in shape.subpaths for curve in path.curves])
    if not np.abs(controls).max() < GREATEST_COORDINATE:
        raise NestedCagesError("The drawing has coordinates that are not finite, or too large; correct them.")
    fineness = tolerance if tolerance is not None else DEFAULT_TOLERANCE * float(np.hypot(*np.ptp(controls, axis=0)))
    if not fineness > 0.0:
        raise NestedCagesError("All points of the drawing coincide; draw closed paths with an inside.")
    areas = []
    for shape in outlines:
        paths = [path for path in shape.subpaths if painted or path.closed]
        areas.append(Painted([flattened(path.curves, fineness) for path in paths], shape.evenodd))
    return solid(areas)


def read_svg(path: str | os.PathLike[str], *, tolerance: float | None = None, element: str | None = None) -> Mesh:
    """The filled area of an SVG file; see `from_svg`."""
    return from_svg(Path(path).read_bytes(), tolerance=tolerance, element=element)


def to_svg(shapes: Mesh | Sequence[Mesh] | Mapping[str, Mesh], *, view_box: Sequence[float] | None = None) -> str:
    """An SVG document with one path per mesh, holes cut out, coordinates to the last bit as they are.

    shapes: one mesh, several, or by the id that each path gets; the last is drawn first, so that cages given from the
    inside out lie below what they enclose. view_box: x, y, width and height of what is seen; all shapes unless given.
    """
    named = _named(shapes)
    if not named:
        raise NestedCagesError("There is nothing to write; give at least one mesh.")
    points = np.concatenate([mesh.vertices for mesh in named.values()])
    low, high = points.min(axis=0), points.max(axis=0)
    diagonal = float(np.hypot(*(high - low)))
    if view_box is None:
        low, size = low - MARGIN * diagonal, high - low + 2.0 * MARGIN * diagonal
        view_box = (*low, *size)
    seen = " ".join(f"{float(number):.9g}" for number in view_box)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{seen}">']
    for k, (name, mesh) in reversed(list(enumerate(named.items()))):
        colour = COLOURS[k % len(COLOURS)]
        lines.append(
            f'  <path id="{html.escape(name)}" fill="{colour}" fill-opacity="{0.9 if k == 0 else 0.15}" '
            f'fill-rule="evenodd" stroke="{colour}" stroke-width="{STROKE * diagonal:.3g}" stroke-linejoin="round"\n'
            f'    d="{path_data(mesh)}"/>'
        )
    return "\n".join([*lines, "</svg>", ""])


def write_svg(
    path: str | os.PathLike[str],
    shapes: Mesh | Sequence[Mesh] | Mapping[str, Mesh],
    *,
    view_box: Sequence[float] | None = None,
) -> None:
    """Write an SVG file; see `to_svg`."""
    Path(path).write_text(to_svg(shapes, view_box=view_box), encoding="utf-8")


def path_data(mesh: Mesh) -> str:
    """The loops of a mesh as SVG path data; outer loops and holes turn opposite ways, so any fill rule is right."""
    loops = []
    for loop in mesh.loops:
        points = " L ".join(f"{x!r} {y!r}" for x, y in mesh.vertices[loop].tolist())
        loops.append(f"M {points} Z")
    return " ".join(loops)


def _named(shapes: Mesh | Sequence[Mesh] | Mapping[str, Mesh]) -> dict[str, Mesh]:
    if isinstance(shapes, Mesh):
        return {"shape": shapes}
    if isinstance(shapes, Mapping):
        return dict(shapes)
    return {"shape" if k == 0 else f"cage-{k}": mesh for k, mesh in enumerate(shapes)}
