"""The document: parsed within limits, with its elements by id and its frame; and what to read of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import NestedCagesError, invalid_file
from ...geometry.arrays import FloatArray
from ...parameters import check_positive
from ..limits import Limits
from .elements import Faults, name_of, quoted
from .lengths import Viewport
from .outlines import OUTLINED
from .transforms import fitted, read_transform, view_box_of

OUTLINES, DECORATION = "data-outlines", "decoration"
"""Attribute of the root of our own documents, whose strokes only mark the edges of filled shapes."""

Box = tuple[float, float, float, float]
"""x, y, width and height."""

SAME_PAGE = 1e-6
"""Difference between page and view box, over the longer side, that is the rounding of their decimals."""

FAINTEST = 0.5 / 255.0
"""Opacity that rounds to 0 with 8 bits per channel."""

DRAWING_LIMITS = Limits(elements=100_000, points=1_000_000)
"""What is read of a drawing at most by default: elements that are drawn, each copy by `use` counted, and points of
their outlines, before and after curves become chords."""


@dataclass(frozen=True)
class Frame:
    """The view of a document; with the same frame, new shapes coincide with old ones."""

    view_box: Box | None = None
    """x, y, width and height in user units."""
    width: str = ""
    """Width of the page with its unit, as written in the document."""
    height: str = ""
    preserve_aspect_ratio: str = ""

    @cached_property
    def size(self) -> FloatArray:
        """(2,) width and height of the page in user units, 0 where the document does not specify them."""
        return np.array([Viewport().length(text, "") or 0.0 for text in (self.width, self.height)])

    @cached_property
    def page(self) -> Box | None:
        """x, y, width and height of what viewers show, in user units; None if the document does not specify it.

        More than the view box where it is fitted into a page of another shape, less where it is sliced.
        """
        if not (self.size > 0.0).all():
            return self.view_box
        width, height = self.size.tolist()
        if self.view_box is None:
            return 0.0, 0.0, width, height
        matrix = fitted(self.view_box, 0.0, 0.0, width, height, self.preserve_aspect_ratio)
        x, y, width, height = (np.concatenate((-matrix[:2, 2], self.size)) / np.tile(np.diag(matrix)[:2], 2)).tolist()
        same = np.allclose((x, y, width, height), self.view_box, 0.0, SAME_PAGE * max(width, height))
        return self.view_box if same else (x, y, width, height)

    @property
    def pixel(self) -> float:
        """User units per pixel of the page, for non-scaling strokes."""
        scales = self.size / self.view_box[2:] if self.view_box is not None else np.zeros(2)
        return 1.0 / float(scales[scales > 0.0].min()) if (scales > 0.0).any() else 1.0


class Document:
    """A parsed document."""

    def __init__(self, text: str | bytes, limits: Limits) -> None:
        if not isinstance(text, str | bytes | bytearray):
            raise invalid_file(f"An SVG document is read from text or bytes, not from {type(text).__name__}.")
        limits.check("bytes", len(text))
        try:
            self.root = ET.fromstring(text)
        except (ET.ParseError, ValueError, LookupError) as error:
            raise invalid_file(f"This is not an SVG document: {error}.") from error
        if name_of(self.root) != "svg":
            raise invalid_file(
                f"This is not an SVG document: its root element is '{name_of(self.root)[:60]}', not 'svg'."
            )
        self.strokes_count = self.root.get(OUTLINES) != DECORATION
        self.by_id: dict[str, ET.Element] = {}
        namespace = str(self.root.tag).rpartition("}")[0]
        for item in self.root.iter():
            if isinstance(item.tag, str) and item.tag.rpartition("}")[0] != namespace:
                item.tag = ""  # of another namespace: nobody draws it
            self.by_id.setdefault(item.get("id", ""), item)
        limits.check("elements", sum(name_of(item) in OUTLINED for item in self.root.iter()))
        size = (self.root.get(key, "") for key in ("width", "height", "preserveAspectRatio"))
        self.frame = Frame(view_box_of(self.root), *size)
        units = self.frame.view_box or self.frame.page
        self.faults = Faults()
        self.viewport = Viewport(faults=self.faults).sized(*(units[2:] if units else (None, None)))

    def transform(self, text: str, what: str) -> FloatArray:
        """The matrix of a list of transforms; of one that cannot be read the identity, which the faults say."""
        try:
            return read_transform(text)
        except NestedCagesError:
            self.faults.add(f"The transform of the {what} is {quoted(text)}, which cannot be read: it is left out")
            return np.eye(3)

    def linked(self, link: str) -> ET.Element | None:
        """The element that `#id` names."""
        return self.by_id.get(link[1:]) if len(link) > 1 and link.startswith("#") else None


@dataclass(frozen=True)
class SvgOptions:
    """Options for reading a drawing."""

    tolerance: float | None = None
    """Largest distance between a curve and the edges in its place; 1/2000 of the drawing's diagonal if None."""
    inside: bool = False
    """Whether these edges are inside of what is painted, for cages inside; by default they are outside."""
    element: str | None = None
    """The id of one element to read alone."""
    layers: tuple[str, ...] = ()
    """Layers to read, by label or id; all if empty. Groups directly below the root count as layers."""
    strokes: bool = True
    """Whether strokes count as painted. Without strokes, closed outlines count as filled if nothing is."""
    background: bool = True
    """Whether a shape that covers the whole page below all others counts."""
    crop: bool = True
    """Whether to cut off everything outside the page, which viewers do not show."""
    opacity: float = 0.0
    """Opacity from 0 to 1 above which paint counts."""
    specks: float = 0.0
    """Width in user units below which parts and spikes are left out, holes and gaps closed; by default none are."""
    limits: Limits = DRAWING_LIMITS

    def __post_init__(self) -> None:
        if self.tolerance is not None:
            check_positive(self, "tolerance")
        if not 0.0 <= self.opacity <= 1.0:
            raise invalid_file(f"The opacity must be from 0 to 1, not {self.opacity!r}.")

    @property
    def faintest(self) -> float:
        """The opacity above which paint counts."""
        return max(self.opacity, FAINTEST)
