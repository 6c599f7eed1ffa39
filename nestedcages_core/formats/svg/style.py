"""Styles of elements: attributes, style sheets and inheritance (SVG 1.1, section 6; CSS cascade)."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from xml.etree import ElementTree as ET

from ...errors import NestedCagesError
from ..libraries import load_css
from .document import Document
from .elements import name_of
from .selectors import matched

MARKERS = ("marker", "marker-start", "marker-mid", "marker-end")

INHERITED = frozenset(
    (
        *("fill", "fill-rule", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-linecap"),
        *("stroke-linejoin", "stroke-miterlimit", "stroke-dasharray", "stroke-dashoffset", "visibility", "color"),
        *("font-size", "clip-rule", *MARKERS),
    )
)
"""Inherited properties."""

OWN = frozenset(
    (
        *("display", "opacity", "clip-path", "mask", "mask-type", "overflow", "stop-color", "stop-opacity"),
        *("vector-effect", "filter", "transform", "transform-origin", "transform-box"),
    )
)
"""Properties that are not inherited."""

GEOMETRY = frozenset(("x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "d"))
"""Attributes of shapes that styles replace."""

KNOWN = INHERITED | OWN | GEOMETRY

UNSET = ("unset", "revert", "revert-layer")
"""Values that leave a property as if nothing were said."""

VARIABLE = re.compile(r"var\(\s*(--[\w-]+)\s*(?:,([^()]*))?\)")
"""A reference to a variable, and what is taken without it."""

MAX_REFERENCES = 8
"""Longest chain of variables that refer to each other."""

MAX_VALUE = 100_000
"""Maximum number of characters that variables add to all values of an element at once."""

PATH_DATA = re.compile(r"path\(\s*['\"](.*)['\"]\s*\)", re.DOTALL)


Style = Mapping[str, str]

Declaration = tuple[str, str, bool]
"""A property, its value, and whether it is important."""


class Styles:
    """The properties of every element of a document."""

    def __init__(self, document: Document) -> None:
        self.sheets: dict[ET.Element, Sequence[Declaration]] = {}
        self.known: dict[ET.Element, dict[str, str]] = {}
        texts = [
            "".join(item.itertext())
            for item in document.root.iter()
            if name_of(item) == "style" and item.get("type", "text/css") in ("", "text/css")
        ]
        if any(text.strip() for text in texts):
            self.sheets = matched(document.root, texts, declarations)
        self.variables = {key: value for key, value in self.own(document.root).items() if key.startswith("--")}

    def own(self, item: ET.Element) -> dict[str, str]:
        """The element's own properties, variables of the root as their values."""
        if item not in self.known:
            self.known[item] = self._own(item)
        return _replaced(self.known[item], getattr(self, "variables", {}))

    def _own(self, item: ET.Element) -> dict[str, str]:
        """In the order of CSS: attributes, sheets, style; important last."""
        found = {key: value.strip() for key, value in item.attrib.items() if key in INHERITED | OWN}
        given = [*self.sheets.get(item, ()), *(declarations(item.attrib["style"]) if "style" in item.attrib else ())]
        for important in (False, True):
            for key, value, is_important in given:
                if is_important == important:
                    found[key] = value
        return found

    def computed(self, item: ET.Element, around: Style) -> dict[str, str]:
        """All properties, given those of the element around it."""
        style = {key: value for key, value in around.items() if key in INHERITED or key.startswith("--")}
        self.own(item)
        for key, value in _replaced(self.known[item], {**self.variables, **style}).items():
            if value == "inherit":
                if key in around:
                    style[key] = around[key]
            elif value == "initial" or (value in UNSET and key not in INHERITED):
                style.pop(key, None)
            elif value and value not in UNSET:
                style[key] = value
        if style.get("color", "").lower() == "currentcolor":
            style["color"] = around.get("color", "black")
        return style

    def placed(self, item: ET.Element) -> ET.Element:
        """An element with the geometry that its styles give it."""
        given = {key: value for key, value in self.own(item).items() if key in GEOMETRY}
        if "d" in given:
            data = PATH_DATA.fullmatch(given["d"])
            given["d"] = data[1] if data else ""
        return ET.Element(item.tag, {**item.attrib, **given}) if given else item


def _replaced(found: dict[str, str], variables: Style) -> dict[str, str]:
    """Properties with variables as their values."""
    if not any("var(" in value for value in found.values()):
        return found
    known = {**variables, **{key: value for key, value in found.items() if key.startswith("--")}}
    longest = max((len(value) for key, value in known.items() if key.startswith("--")), default=0)
    for _ in range(MAX_REFERENCES):
        if longest * sum(value.count("var(") for value in found.values()) > MAX_VALUE:
            raise NestedCagesError(
                f"The variables of the styles make values of more than {MAX_VALUE:,} characters; simplify them.",
                code="limit.exceeded",
            )
        found = {
            key: VARIABLE.sub(lambda name: known.get(name[1], name[2] or ""), value).strip()
            for key, value in found.items()
        }
    return found


@lru_cache(maxsize=4096)
def declarations(text: str) -> tuple[Declaration, ...]:
    """Known declarations of a style attribute or of a rule."""
    return tuple(each for each in _declared(text) if each[0] in KNOWN or each[0].startswith("--"))


def unread(text: str) -> list[str]:
    """Properties of a style attribute that are not followed here."""
    return [key for key, _, _ in _declared(text) if key not in KNOWN and not key.startswith("--")]


def _declared(text: str) -> list[Declaration]:
    """All declarations of a style attribute or of a rule."""
    if not text.strip():
        return []
    tinycss2, _ = load_css()
    return [
        (
            node.name if node.name.startswith("--") else node.lower_name,
            tinycss2.serialize(node.value).strip(),
            node.important,
        )
        for node in tinycss2.parse_blocks_contents(text, True, True)
        if node.type == "declaration"
    ]
