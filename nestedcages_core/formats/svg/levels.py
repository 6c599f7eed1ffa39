"""The drawings and cages of a picture of this program, where and as a viewer shows them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import invalid_file
from ...geometry.arrays import FloatArray
from .document import Document, Frame
from .faults import quoted
from .nodes import Group, Shape
from .options import SvgOptions
from .reading import visible_part
from .scene import Scene
from .style import unread
from .transforms import moved

LEVEL = re.compile(r"(level|inner)-(\d{1,6})")
"""The class of a path: its side, and its level."""

UNJUDGED = frozenset(
    (
        *("script", "handler", "listener", "style", "link", "iframe", "object", "embed"),
        *("animate", "animateColor", "animateMotion", "animateTransform", "set", "discard"),
    )
)
"""Elements that change how others look, wherever they stand: what they make is not judged."""


@dataclass(frozen=True)
class PicturedLevel:
    """A drawing or a cage of a picture."""

    name: str
    """The id of its path."""
    level: int
    """0 for a drawing, 1 for its innermost cage, -1 for the first one inside."""
    rings: list[FloatArray]
    """Its loops (k, 2) in user units of the document."""


@dataclass(frozen=True)
class Pictured:
    """A picture of drawings and cages."""

    levels: list[PicturedLevel]
    frame: Frame


def levels_in_svg(text: str | bytes) -> Pictured:
    """The visible levels of a picture, the lowest first, with transforms, references and styles followed.

    Raises NestedCagesError for what is no picture of levels alone, or cannot be judged: scripts, animations, style
    sheets, clips, masks, text, images, curves, and shapes of no level.
    """
    options = SvgOptions()
    document = Document(text, options.limits)
    _check_elements(text)
    scene = Scene(document, options)
    shown = visible_part(scene.root, options)
    others = [*document.faults.notes(), *(f"It has {count} {kind}." for kind, count in scene.left_out.items())]
    others += ["It has clip paths, masks or frames in the frame."] if _is_clipped(shown) else []
    if others:
        raise invalid_file(f"The picture has more than paths of levels. {' '.join(others)}")
    return Pictured([_level(shape) for shape in shown.shapes()], document.frame)


def _level(shape: Shape) -> PicturedLevel:
    """A shape as a level. Raises NestedCagesError."""
    found = [LEVEL.fullmatch(word) for word in shape.classes.split()]
    if len(found) != 1 or found[0] is None:
        raise invalid_file(f"The {shape.name} is shown, but its class is no level: {quoted(shape.classes)}.")
    side, number = found[0].groups()
    if any(path.is_curved for path in shape.subpaths):
        raise invalid_file(f"The {shape.name} has curves; loops of levels are made of straight edges.")
    if len(shape.subpaths) > 1 and not shape.evenodd:
        raise invalid_file(
            f"The {shape.name} has several loops, but not the fill rule evenodd, which leaves holes out."
        )
    rings = []
    for path in shape.subpaths:
        points = moved(path.points, shape.matrix)
        rings.append(points[:-1] if len(points) > 1 and np.array_equal(points[0], points[-1]) else points)
    return PicturedLevel(shape.id, int(number) if side == "level" else -int(number), rings)


def _is_clipped(group: Group) -> bool:
    return bool(group.clips) or any(isinstance(child, Group) and _is_clipped(child) for child in group.children)


def _check_elements(text: str | bytes) -> None:
    """Raise NestedCagesError for elements, attributes and instructions that may change what is shown."""
    parser: Any = ET.XMLPullParser(("start", "pi"))
    parser.feed(text)
    for event, item in parser.read_events():
        if event == "pi":
            raise invalid_file(f"The picture has an instruction to programs that show it: {quoted(item.text or '')}.")
        name = item.tag.rpartition("}")[2]
        acts = [key for key in item.attrib if key.lower().startswith("on")]
        styled = [key for key in unread(item.get("style", "")) if not key.startswith("-inkscape-")]
        if name in UNJUDGED or acts or styled:
            what = ", ".join([f"the element '{name}'", *acts, *styled])
            raise invalid_file(f"The picture has what may change its look and is not judged: {what}.")
