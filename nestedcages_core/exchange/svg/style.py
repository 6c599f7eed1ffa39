"""Styles of elements: attributes, style sheets and inheritance (SVG 1.1, section 6; CSS cascade)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from types import ModuleType
from typing import Any
from xml.etree import ElementTree as ET

from ...errors import NestedCagesError
from ..libraries import load_css
from .document import Document
from .lengths import name_of

INHERITED = frozenset(
    (
        *("fill", "fill-rule", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-linecap"),
        *("stroke-linejoin", "stroke-miterlimit", "stroke-dasharray", "stroke-dashoffset", "visibility", "color"),
        *("font-size", "clip-rule", "marker-start", "marker-mid", "marker-end"),
    )
)
"""Inherited properties."""

OWN = frozenset(
    (
        *("display", "opacity", "clip-path", "mask", "mask-type", "overflow", "stop-color", "stop-opacity"),
        *("vector-effect", "filter", "transform"),
    )
)
"""Properties that are not inherited."""

KNOWN = INHERITED | OWN | {"marker"}

FALLBACK = re.compile(r"var\(\s*--[\w-]+\s*(?:,([^()]*))?\)")

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
        self.sheets: dict[ET.Element, list[Declaration]] = {}
        self.known: dict[ET.Element, dict[str, str]] = {}
        texts = ["".join(item.itertext()) for item in document.root.iter() if name_of(item) == "style"]
        if any(text.strip() for text in texts):
            try:
                self.sheets = _matched(document.root, "\n".join(texts))
            except RecursionError as error:
                raise NestedCagesError(
                    "The style sheets nest blocks too deeply; simplify them.", code="limit.exceeded"
                ) from error

    def own(self, item: ET.Element) -> dict[str, str]:
        """The element's own properties."""
        if item not in self.known:
            self.known[item] = self._own(item)
        return self.known[item]

    def _own(self, item: ET.Element) -> dict[str, str]:
        """In the order of CSS: attributes, sheets, style; important last."""
        found = {key: value.strip() for key, value in item.attrib.items() if key in KNOWN}
        given = [*self.sheets.get(item, ()), *declarations(item.get("style", ""))]
        for important in (False, True):
            for key, value, is_important in given:
                if is_important == important:
                    found[key] = value
        if "marker" in found:
            marker = found.pop("marker")
            found = {**dict.fromkeys(("marker-start", "marker-mid", "marker-end"), marker), **found}
        return {key: FALLBACK.sub(lambda match: match[1] or "", value) for key, value in found.items()}

    def computed(self, item: ET.Element, around: Style) -> dict[str, str]:
        """All properties, given those of the element around it."""
        style = {key: value for key, value in around.items() if key in INHERITED}
        for key, value in self.own(item).items():
            if value == "inherit":
                if key in around:
                    style[key] = around[key]
            elif value:
                style[key] = value
        if style.get("color", "").lower() == "currentcolor":
            style["color"] = around.get("color", "black")
        return style


def declarations(text: str) -> list[Declaration]:
    """Known declarations of a style attribute."""
    found = []
    for part in _without_comments(text).split(";"):
        key, _, value = part.partition(":")
        value, mark, word = value.rpartition("!") if "!" in value else (value, "", "")
        important = bool(mark) and word.strip().lower() == "important"
        if key.strip().lower() in KNOWN:
            found.append((key.strip().lower(), value.strip(), important))
    return found


def _without_comments(text: str) -> str:
    first, *others = text.split("/*")
    return first + "".join(part.partition("*/")[2] for part in others)


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


def _matched(root: ET.Element, text: str) -> dict[ET.Element, list[Declaration]]:
    """Declarations of style sheets for each matching element, the most specific last."""
    tinycss2, cssselect2 = load_css()
    matcher = cssselect2.Matcher()
    for prelude, content in _rules(tinycss2, tinycss2.parse_stylesheet(text, True, True)):
        payload = [
            (node.lower_name, tinycss2.serialize(node.value).strip(), node.important)
            for node in tinycss2.parse_blocks_contents(content, True, True)
            if node.type == "declaration" and node.lower_name in KNOWN
        ]
        try:
            selectors = cssselect2.compile_selector_list(prelude) if payload else ()
        except cssselect2.SelectorError:
            continue  # as browsers do
        for selector in selectors:
            if selector.pseudo_element is None:
                matcher.add_selector(selector, payload)
    found = {}
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
            and node.lower_at_keyword == "media"
            and node.content is not None
            and tinycss2.serialize(node.prelude).strip().lower() in MEDIA
        ):
            yield from _rules(tinycss2, tinycss2.parse_rule_list(node.content, True, True))
