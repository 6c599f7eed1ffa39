"""Styles of elements: attributes, style sheets and inheritance (SVG 1.1, section 6; CSS cascade)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from types import ModuleType
from typing import Any
from xml.etree import ElementTree as ET

from ...errors import NestedCagesError
from ...libraries import load_css
from .document import Document
from .elements import name_of

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

PATH_DATA = re.compile(r"path\(\s*['\"](.*)['\"]\s*\)", re.DOTALL)

CONDITIONS = ("media", "supports", "layer")
"""Rules around others; what is asked of the program is taken to be supported."""

MEDIA = ("", "all", "screen")
"""Conditions of @media that are true."""

MAX_LOOKED_THROUGH = 20_000_000
"""Maximum number of elements that selectors visit; some seconds."""

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
            try:
                self.sheets = _matched(document.root, texts)
            except RecursionError as error:
                raise NestedCagesError(
                    "The style sheets nest blocks too deeply; simplify them.", code="limit.exceeded"
                ) from error
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
    for _ in range(MAX_REFERENCES):
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


def _element_class(cssselect2: ModuleType) -> Any:
    """Elements for selectors, which count their visits."""

    class Element(cssselect2.ElementWrapper):  # type: ignore[name-defined,misc]
        looked_through = 0

        @property
        def ancestors(self) -> tuple[Any, ...]:
            return self._along("_ancestors", "parent")

        @property
        def previous_siblings(self) -> tuple[Any, ...]:
            return self._along("_previous_siblings", "previous")

        def _along(self, cache: str, step: str) -> tuple[Any, ...]:
            found: tuple[Any, ...] | None = getattr(self, cache)
            if found is None:
                chain = []
                other = getattr(self, step)
                while other is not None:
                    chain.append(other)
                    other = getattr(other, step)
                found = tuple(reversed(chain))
                setattr(self, cache, found)
            Element.looked_through += len(found) + 1
            if Element.looked_through > MAX_LOOKED_THROUGH:
                raise NestedCagesError(
                    "The selectors of the style sheets take too long to match; simplify them.", code="limit.exceeded"
                )
            return found

    return Element


def _matched(root: ET.Element, texts: Iterable[str]) -> dict[ET.Element, Sequence[Declaration]]:
    """Declarations of style sheets for each matching element, the most specific last."""
    tinycss2, cssselect2 = load_css()
    matcher = cssselect2.Matcher()
    nodes = (node for text in texts for node in tinycss2.parse_stylesheet(text, True, True))
    for prelude, content in _rules(tinycss2, nodes):
        payload = declarations(tinycss2.serialize(content))
        try:
            selectors = cssselect2.compile_selector_list(prelude) if payload else ()
        except cssselect2.SelectorError:
            continue  # as browsers do
        for selector in selectors:
            if selector.pseudo_element is None:
                matcher.add_selector(selector, payload)
    found: dict[ET.Element, Sequence[Declaration]] = {}
    for wrapper in _element_class(cssselect2).from_xml_root(root).iter_subtree():
        matches = matcher.match(wrapper)
        if matches:
            found[wrapper.etree_element] = [each for match in matches for each in match[3]]
    return found


def _rules(tinycss2: ModuleType, nodes: Iterable[Any]) -> Iterator[tuple[Any, Any]]:
    """Selectors and declarations of rules, including those for screens, as tokens."""
    for node in nodes:
        if node.type == "qualified-rule":
            yield node.prelude, node.content
        elif (
            node.type == "at-rule"
            and node.lower_at_keyword in CONDITIONS
            and node.content is not None
            and (node.lower_at_keyword != "media" or tinycss2.serialize(node.prelude).strip().lower() in MEDIA)
        ):
            yield from _rules(tinycss2, tinycss2.parse_rule_list(node.content, True, True))
