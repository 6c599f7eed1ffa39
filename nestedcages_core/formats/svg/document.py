"""The document: parsed within limits, with its elements by id and its frame."""

from __future__ import annotations

from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import NestedCagesError, invalid_file
from ...geometry.arrays import FloatArray
from ..limits import Limits, Quota
from .elements import link_of, name_of
from .faults import Faults, quoted
from .lengths import Viewport
from .outlines import OUTLINED
from .transforms import fitted, read_transform, view_box_of

OUTLINES, DECORATION = "data-outlines", "decoration"
"""Attribute of the root of our own documents, whose strokes only mark the edges of filled shapes."""

DRAWN = OUTLINED | {"svg", "g", "a", "use"}
"""Elements that are drawn with all their children, or with what they refer to."""

MAX_USERS = 64
"""References within references that are counted: deeper ones are rejected as they are drawn."""

Box = tuple[float, float, float, float]
"""x, y, width and height."""

SAME_PAGE = 1e-6
"""Difference between page and view box, over the longer side, that is the rounding of their decimals."""


@dataclass(frozen=True)
class Frame:
    """The view of a document; with the same frame, new shapes coincide with old ones."""

    view_box: Box | None = None
    """x, y, width and height in user units."""
    width: str = ""
    """Width of the page with its unit, as written in the document."""
    height: str = ""
    preserve_aspect_ratio: str = ""

    @property
    def page(self) -> Box | None:
        """x, y, width and height of what viewers show, in user units; None if the document does not specify it.

        More than the view box where it is fitted into a page of another shape, less where it is sliced.
        """
        lengths = (Viewport().length(text, "") for text in (self.width, self.height))
        found = [length for length in lengths if length is not None]
        if len(found) != 2 or not min(found) > 0.0:
            return self.view_box
        if self.view_box is None:
            return 0.0, 0.0, found[0], found[1]
        matrix = fitted(self.view_box, 0.0, 0.0, found[0], found[1], self.preserve_aspect_ratio)
        (x, y), size = -matrix[:2, 2] / np.diag(matrix)[:2], np.array(found) / np.diag(matrix)[:2]
        shown = float(x), float(y), float(size[0]), float(size[1])
        return self.view_box if np.allclose(shown, self.view_box, 0.0, SAME_PAGE * max(shown[2:])) else shown


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
        room = str(self.root.tag).rpartition("}")[0]
        for item in self.root.iter():
            if isinstance(item.tag, str) and item.tag.rpartition("}")[0] != room:
                item.tag = ""  # of another namespace: nobody draws it
            self.by_id.setdefault(item.get("id", ""), item)
        self._count(Quota(limits))
        size = (self.root.get(key, "") for key in ("width", "height", "preserveAspectRatio"))
        self.frame = Frame(view_box_of(self.root), *size)
        units = self.frame.view_box or self.frame.page
        self.faults = Faults()
        self.viewport = Viewport(faults=self.faults).sized(*(units[2:] if units else (None, None)))

    @property
    def pixel(self) -> float:
        """User units per pixel of the page, for non-scaling strokes."""
        box, size = self.frame.view_box, Viewport()
        if box is None:
            return 1.0
        width, height = (size.length(text, "r") or 0.0 for text in (self.frame.width, self.frame.height))
        scales = [given / whole for given, whole in ((width, box[2]), (height, box[3])) if given > 0.0]
        return 1.0 / min(scales) if scales else 1.0

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

    def _count(self, quota: Quota) -> None:
        """Spend what is drawn, each copy by `use` again: a lower bound, but for elements that style sheets hide."""
        nobody: tuple[ET.Element, ...] = ()
        waiting = [(child, nobody) for child in self.root]
        while waiting:
            item, users = waiting.pop()
            name = name_of(item)
            if name not in DRAWN or "display" in item.attrib or "display" in item.get("style", ""):
                continue
            quota.spend("elements", 1)
            if name != "use":
                waiting += [(child, users) for child in item]
            elif (target := self.linked(link_of(item))) is not None and target not in users and len(users) < MAX_USERS:
                waiting.append((target, (*users, target)))
