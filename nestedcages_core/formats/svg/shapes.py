"""The shapes of a document with their clips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...geometry.arrays import FloatArray
from ..limits import Quota
from .curves import Subpath, box_around
from .gradients import Gradient
from .outlines import PathReader, rectangle
from .paints import Paint
from .strokes import Stroke
from .transforms import moved, scaling, translation


@dataclass(frozen=True, eq=False)
class Shape:
    """One element with an outline."""

    name: str
    """Name in messages."""
    subpaths: list[Subpath]
    """In its own units."""
    matrix: FloatArray
    """From its units to those of the document."""
    evenodd: bool = False
    fill: Paint | None = None
    stroke: Stroke | None = None
    stroke_paint: Paint | None = None
    scales: bool = True
    """Whether the width of its stroke follows its transforms."""
    id: str = ""
    groups: tuple[str, ...] = ()
    """Names of the groups around it, the outermost first."""
    clips: tuple[Clip, ...] = ()
    """Of itself and of the groups around it, the innermost first."""

    @cached_property
    def placed(self) -> list[FloatArray]:
        """Control points of its subpaths in the document."""
        return [moved(path.points, self.matrix) for path in self.subpaths]

    def units_of(self, gradient: Gradient) -> FloatArray:
        """The matrix (3, 3) to the document from the units of its gradient, before the gradient's own matrix."""
        return unit_box([self], self.matrix) if gradient.of_box else self.matrix


@dataclass(frozen=True, eq=False)
class Clip:
    """What is kept of shapes: the inside of others, or what these show as a mask."""

    shapes: list[Shape]
    is_mask: bool = False


def rectangular_clip(x: float, y: float, width: float, height: float, matrix: FloatArray, quota: Quota) -> Clip:
    subpaths = PathReader(rectangle(x, y, width, height), quota).read()
    return Clip([Shape("rect", subpaths, matrix, fill=Paint(1.0))] if subpaths else [])


def unit_box(shapes: Sequence[Shape], matrix: FloatArray) -> FloatArray:
    """The matrix to the document from the unit square that is the box around shapes in units that `matrix` places.

    Not invertible where these units are none.
    """
    if not abs(np.linalg.det(matrix[:2, :2])) > 0.0:
        return matrix
    back = np.asarray(np.linalg.inv(matrix), np.float64)
    low, high = box_around(
        [path for shape in shapes for path in shape.subpaths],
        [moved(points, back) for shape in shapes for points in shape.placed],
    )
    return matrix @ translation(*low) @ scaling(*(high - low))
