"""SVG in: the painted area becomes a mesh."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from ...errors import InvalidMeshError, NestedCagesError, invalid_file, no_outline
from ...geometry.mesh import Mesh
from ..files import read_whole
from ..limits import Quota
from ..solids import ROOM, Area, bounds_of, shapely, solid, union_of
from .areas import Areas, polygonal
from .document import Box, Document, Frame, SvgOptions
from .paints import Paint
from .scene import Scene
from .shapes import Shape
from .transforms import moved

DEFAULT_TOLERANCE = 5e-4
"""Default for the largest distance of chords from curves, as a fraction of the drawing's diagonal."""

Made = TypeVar("Made")

PAGE_COVERED = 0.95
"""Smallest fraction of the page that a background covers; rounded corners count as covered."""


@dataclass(frozen=True)
class SvgDrawing:
    """A document that was read."""

    shapes: tuple[tuple[str, Mesh], ...]
    """Names and meshes, in user units, y pointing down; names are ids, which may repeat, and empty for all as one."""
    frame: Frame
    """Frame for `to_svg`, to write output that coincides with this drawing."""
    written: bool
    """Whether this package has written the document."""
    notes: tuple[str, ...]
    """Sentences about omissions, and about what may be unintended."""

    @property
    def mesh(self) -> Mesh:
        """The first shape, which is everything unless each was asked for."""
        return self.shapes[0][1]


def read_svg(path: str | os.PathLike[str], **options: Any) -> Mesh:
    """The painted area of an SVG file; see `from_svg`."""
    return read_svg_drawing(path, **options).mesh


def from_svg(text: str | bytes, **options: Any) -> Mesh:
    """The painted area of an SVG document as a mesh, in the document's user units, y pointing down as there.

    Shapes that overlap are united; fills, strokes, clip paths, masks, references and style sheets are followed. What
    crosses nothing keeps its coordinates exactly. options: fields of `SvgOptions`.

    Raises NestedCagesError for input that is not SVG, InvalidMeshError if nothing is painted.
    """
    return svg_drawing(text, **options).mesh


def read_svg_drawing(path: str | os.PathLike[str], **options: Any) -> SvgDrawing:
    """The painted area of an SVG file with its frame and notes on omissions; see `svg_drawing`."""
    return svg_drawing(read_whole(path, SvgOptions(**options).limits), **options)


def svg_drawing(text: str | bytes, *, each: bool | None = False, **options: Any) -> SvgDrawing:
    """`from_svg`, with the document's frame and notes on omissions.

    each: True for each painted area by itself, in the order in which they are drawn; None for these in documents that
    this package has written, else for all as one.
    """
    reading = Reading(text, options)
    written = not reading.document.strokes_count
    named = reading.made(reading.each) if each or (each is None and written) else [("", reading.made(reading.whole))]
    return SvgDrawing(tuple(named), reading.document.frame, written, reading.said())


def is_written_svg(text: str | bytes) -> bool:
    """Whether this package has written an SVG document. Raises NestedCagesError for input that is not SVG."""
    return not Document(text, SvgOptions().limits).strokes_count


class Reading:
    """A document, its tree of what counts, its areas, and the notes."""

    def __init__(self, text: str | bytes, options: Mapping[str, Any]) -> None:
        chosen = SvgOptions(**options)
        self.document = Document(text, chosen.limits)
        self.options = chosen if self.document.strokes_count else replace(chosen, strokes=False)
        self.notes: list[str] = []

    def said(self) -> tuple[str, ...]:
        return (*self.document.faults.notes(), *self.notes)

    @np.errstate(all="ignore")  # extreme numbers become infinite or nan, which is a fault
    def made(self, work: Callable[[Sequence[Shape], Areas], Made]) -> Made:
        """What is made of the shapes that count and their areas. Raises NestedCagesError with the notes."""
        shapes = _what_counts(Scene(self.document, self.options), self.notes)
        tolerance = self.options.tolerance or DEFAULT_TOLERANCE * _visible_size(shapes, self.page)
        if not tolerance > 0.0:
            raise invalid_file("All points of the drawing coincide; draw closed paths with an inside.")
        try:
            return work(shapes, Areas(shapes, self.options, tolerance, self.document.frame.pixel))
        except InvalidMeshError as error:
            raise InvalidMeshError(error.fault.said(" ".join((str(error), *self.said())))) from error
        except Exception as error:
            if type(error).__module__.partition(".")[0] != "shapely":
                raise
            problem = "The drawing's coordinates are too large or too close together to unite its shapes"
            raise invalid_file(f"{problem} ({error}); scale the drawing, or simplify it.") from error

    @property
    def page(self) -> Box | None:
        """What is seen of the document; None if all is."""
        seen = self.options.crop and self.document.root.get("overflow") != "visible"
        return self.document.frame.page if seen else None

    def whole(self, shapes: Sequence[Shape], areas: Areas) -> Mesh:
        """Everything as one."""
        return self.solid(areas.of(shapes), areas)

    def each(self, shapes: Sequence[Shape], areas: Areas) -> list[tuple[str, Mesh]]:
        """Every shape that has an inside on the page, by its id or its number. Raises InvalidMeshError for none."""
        found: list[tuple[str, Mesh]] = []
        failed = InvalidMeshError("The shapes have no inside.", code="mesh.empty")
        painted = [(shape, own) for shape in shapes if (own := areas.of([shape]))]
        for number, (shape, own) in enumerate(painted, 1):
            try:
                found.append((shape.id or f"{shape.name.partition(' ')[0]} {number}", self.solid(own, areas)))
            except InvalidMeshError as error:
                failed = error
        if not found:
            raise failed
        return found

    def solid(self, areas: list[Area], reading: Areas) -> Mesh:
        """Areas on the page as a mesh. Raises InvalidMeshError where nothing is inside."""
        cut_off: list[str] = []
        narrow: list[str] = []
        if self.page is not None:
            areas = _on_page(areas, self.page, reading.tolerance, cut_off, reading.quota)
        size = float(np.hypot(*np.subtract(*bounds_of(areas))))
        mesh = solid(
            areas,
            width=ROOM * size if self.document.strokes_count else 0.0,  # ours are read as written
            specks=self.options.specks,
            inside=self.options.inside,
            quota=reading.quota,
            notes=narrow,
        )
        new = [*cut_off, *(f"{note.capitalize()}." for note in narrow)]
        self.notes += [note for note in new if note not in self.notes]
        return mesh


def _what_counts(scene: Scene, notes: list[str]) -> list[Shape]:
    """The shapes of the scene that are visible; if none is, closed outlines count as filled.

    Raises NestedCagesError if nothing is left.
    """
    options = scene.options
    if scene.left_out:
        counted = (f"{number} {kind}{'s' if number > 1 else ''}" for kind, number in scene.left_out.items())
        notes.append(f"Left out: {', '.join(counted)}.")
    strokes = sum(_is_seen(shape.stroke_paint, options) for shape in scene.shapes)
    if strokes and not options.strokes and scene.document.strokes_count:
        notes.append(f"Left out: {strokes} stroke{'s' if strokes > 1 else ''}, since strokes are turned off.")
    found = [
        replace(
            shape,
            fill=shape.fill if _is_seen(shape.fill, options) else None,
            stroke_paint=shape.stroke_paint if options.strokes and _is_seen(shape.stroke_paint, options) else None,
        )
        for shape in scene.shapes
    ]
    found = [shape for shape in found if shape.fill or shape.stroke_paint] or [
        replace(shape, subpaths=closed, fill=Paint(1.0), stroke_paint=None)
        for shape in scene.shapes
        if (closed := [path for path in shape.subpaths if path.closed])
    ]
    if not found:
        problem = "The drawing has no filled or closed shapes; close its paths, or convert strokes and text to paths."
        raise NestedCagesError(" ".join((problem, *scene.document.faults.notes(), *notes)))
    page = scene.document.frame.view_box or scene.document.frame.page
    if page is not None and len(found) > 1 and _covers(found[0], page):
        if options.background:
            notes.append(f"The {found[0].name} covers the whole page; background=False leaves it out.")
        else:
            notes.append(f"Left out: the {found[0].name}, which covers the whole page.")
            del found[0]
    return found


def _is_seen(paint: Paint | None, options: SvgOptions) -> bool:
    return paint is not None and bool((paint.alphas > options.faintest).any())


def _visible_size(shapes: Sequence[Shape], page: Box | None) -> float:
    """Diagonal of the visible parts of all shapes."""
    points = np.concatenate([points for shape in shapes for points in shape.placed])
    low, high = points.min(axis=0), points.max(axis=0)
    if (low == high).all() or page is None:
        return float(np.hypot(*(high - low)))
    x, y, width, height = page
    clipped = np.clip((low, high), (x, y), (x + width, y + height))
    return float(np.hypot(*np.ptp(clipped, axis=0))) or float(np.hypot(*(high - low)))


def _covers(shape: Shape, page: Box) -> bool:
    """Whether a shape is roughly a rectangle of the size of the page."""
    if shape.fill is None or len(shape.subpaths) != 1:
        return False
    path = shape.subpaths[0]
    points = moved(path.ends, shape.matrix)
    x, y, width, height = page
    inside = np.clip(points, (x, y), (x + width, y + height))
    ahead = np.roll(inside, -1, axis=0)
    area = 0.5 * abs(float((inside[:, 0] * ahead[:, 1] - inside[:, 1] * ahead[:, 0]).sum()))
    return area >= PAGE_COVERED * width * height


def _on_page(areas: list[Area], page: Box, tolerance: float, notes: list[str], quota: Quota) -> list[Area]:
    """Areas cut off at the edge of the page; those that reach beyond it by the tolerance at most stay unchanged."""
    if not areas:
        return areas
    x, y, width, height = page
    lower, upper = np.array((x, y)), np.array((x + width, y + height))
    inside: list[Area] = []
    outside: list[Area] = []
    for area in areas:
        low, high = bounds_of([area])
        (inside if ((low >= lower - tolerance) & (high <= upper + tolerance)).all() else outside).append(area)
    if not outside:
        return areas
    cut = polygonal(shapely.intersection(union_of(outside, quota), shapely.box(*lower, *upper)))
    if cut.area == 0.0 and not inside:
        raise no_outline("Everything is outside of the page, where viewers show nothing; crop=False reads it.")
    notes.append("Cut off: what lies outside the page; crop=False keeps it.")
    return [*inside, cut]
