"""Styles of elements: attributes, style sheets, found within a budget of work, and inheritance (CSS cascade)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any
from xml.etree import ElementTree as ET

from ...errors import NestedCagesError
from ...libraries import needed
from .colours import parsed_colour
from .document import Document
from .elements import name_of, quoted, title_of
from .lengths import Viewport
from .transforms import read_transform

with needed("tinycss2", "Reading SVG"):
    import tinycss2
with needed("cssselect2", "Reading SVG"):
    import cssselect2

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

WIDE = frozenset(("inherit", "initial", *UNSET))
"""Values that every property has."""

WORDS = {
    "visibility": "visible hidden collapse",
    "fill-rule": "nonzero evenodd",
    "clip-rule": "nonzero evenodd",
    "stroke-linecap": "butt round square",
    "stroke-linejoin": "miter round bevel",
    "overflow": "visible hidden scroll auto clip",
    "mask-type": "luminance alpha",
    "vector-effect": "none non-scaling-stroke non-scaling-size non-rotation fixed-position",
    "display": "none inline block contents flex grid inline-block inline-flex inline-grid flow-root list-item table "
    "inline-table table-row table-cell table-caption table-column table-row-group run-in ruby",
}
"""Keywords of properties; others have one of the kinds below."""

COLOURS = frozenset(("color", "stop-color"))
PAINTS = frozenset(("fill", "stroke"))
SHARES = frozenset(("opacity", "fill-opacity", "stroke-opacity", "stop-opacity"))
SHARE = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?%?|calc\(.*\)", re.IGNORECASE)
LENGTHS = {"stroke-width": 0.0, "stroke-dashoffset": -float("inf"), "stroke-miterlimit": 0.0}
"""Least values of those that are lengths or numbers."""

ANY_SIZE = Viewport(1.0, 1.0)

VARIABLE = re.compile(r"var\(\s*(--[\w-]+)\s*(?:,([^()]*))?\)")
"""A reference to a variable, and what is taken without it."""

MAX_REFERENCES = 8
"""Longest chain of variables that refer to each other."""

MAX_VALUE = 100_000
"""Maximum number of characters that variables add to all values of an element at once."""

PATH_DATA = re.compile(r"path\(\s*['\"](.*)['\"]\s*\)", re.DOTALL)

CONDITIONS = ("media", "supports", "layer")
"""Rules around others; what is asked of the program is taken to be supported."""

MEDIA = ("", "all", "screen")
"""Conditions of @media that are true."""

MAX_WORK = 40_000_000
"""Characters of selectors times elements, those that look along siblings by the most children of one: a few seconds."""

LEAST = 20
"""Characters and elements that every rule counts in addition."""

TOO_DEEP = (RecursionError, SyntaxError, MemoryError)
"""What Python raises for the expressions that the library makes of selectors nested too deeply."""

Style = Mapping[str, str]

Declaration = tuple[str, str, bool]
"""A property, its value, and whether it is important."""


class Styles:
    """The properties of every element of a document."""

    def __init__(self, document: Document) -> None:
        """Raises NestedCagesError for style sheets that nest too deeply or take too much work."""
        self.document = document
        texts = [
            "".join(item.itertext())
            for item in document.root.iter()
            if name_of(item) == "style"
            and item.get("type", "text/css").strip().lower() in ("", "text/css")
            and _is_of_screens(item.get("media", ""))
        ]
        self.sheets: Mapping[ET.Element, Sequence[Declaration]] = {}
        if any(text.strip() for text in texts):
            try:
                self.sheets = _matched(document.root, texts)
            except TOO_DEEP as error:
                problem = "The style sheets nest blocks or selectors too deeply; simplify them."
                raise NestedCagesError(problem, code="limit.exceeded") from error
        self.known: dict[ET.Element, dict[str, str]] = {}
        self.variables: dict[str, str] = {}
        self.variables = {key: value for key, value in self.own(document.root).items() if key.startswith("--")}

    def own(self, item: ET.Element) -> dict[str, str]:
        """The element's own properties, variables of the root as their values."""
        if item not in self.known:
            self.known[item] = self._own(item)
        return _replaced(self.known[item], self.variables)

    def _own(self, item: ET.Element) -> dict[str, str]:
        """In the order of CSS: attributes, sheets, style; important last."""
        attributes = [(key, value, False) for key, value in item.attrib.items() if key in INHERITED | OWN]
        given = [*self.sheets.get(item, ()), *(declarations(item.attrib["style"]) if "style" in item.attrib else ())]
        found: dict[str, str] = {}
        for important in (False, True):
            for key, value, is_important in [*attributes, *given]:
                if is_important != important:
                    continue
                valid = understood(key, value)
                if valid is not None:
                    found[key] = valid
                elif value.strip():
                    what = f"The {key} of the {title_of(item)} is {quoted(value)}, which is not valid: it is ignored"
                    self.document.faults.add(what)
        return found

    def computed(self, item: ET.Element, around: Style) -> dict[str, str]:
        """All properties, given those of the element around it."""
        style = {key: value for key, value in around.items() if key in INHERITED or key.startswith("--")}
        self.own(item)
        for key, value in _replaced(self.known[item], {**self.variables, **style}).items():
            if "var(" in self.known[item][key]:
                value = understood(key, value) or "unset"
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


@lru_cache(maxsize=4096)
def understood(key: str, value: str) -> str | None:
    """A value of a property as browsers have it, keywords in lower case; None for one that they ignore."""
    value = value.strip()
    lower = value.lower()
    if lower in WIDE:
        return lower
    if "var(" in lower or key.startswith("--"):
        return value
    if key in WORDS:
        return lower if lower in WORDS[key].split() else None
    if key in PAINTS and (lower in ("none", "context-fill", "context-stroke") or lower.startswith("url(")):
        return lower if lower == "none" else value
    if key in PAINTS or key in COLOURS:
        return value if parsed_colour(value) is not None else None
    if key in SHARES:
        return value if SHARE.fullmatch(value) else None
    if key in LENGTHS:
        length = ANY_SIZE.length(lower, "r")
        return value if length is not None and length >= LENGTHS[key] else None
    if key == "stroke-dasharray":
        lengths = [ANY_SIZE.length(part, "r") for part in lower.replace(",", " ").split()]
        fine = lower == "none" or (lengths and all(length is not None and length >= 0.0 for length in lengths))
        return lower if fine else None
    if key == "transform":
        try:
            read_transform(value)
        except NestedCagesError:
            return None
    return lower if lower == "none" else value or None


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
    """Declarations of a style attribute or of a rule, of the properties that are followed here."""
    found = []
    for node in tinycss2.parse_blocks_contents(text, True, True) if text.strip() else ():
        if node.type == "declaration":
            name = node.name if node.name.startswith("--") else node.lower_name
            if name in KNOWN or name.startswith("--"):
                found.append((name, tinycss2.serialize(node.value).strip(), node.important))
    return tuple(found)


def _matched(root: ET.Element, texts: Iterable[str]) -> dict[ET.Element, Sequence[Declaration]]:
    """Declarations of style sheets for each matching element, the most specific last."""
    elements = [item for item in root.iter() if isinstance(item.tag, str)]
    siblings = max(len(item) for item in elements)
    matcher, work = cssselect2.Matcher(), 0
    for prelude, content in _rules(node for text in texts for node in tinycss2.parse_stylesheet(text, True, True)):
        text = tinycss2.serialize(prelude)
        along = siblings if any(sign in text for sign in "~+:") else 1
        work += (len(text) + LEAST) * (len(elements) + LEAST) * along
        if work > MAX_WORK:
            raise NestedCagesError("The style sheets take too long to match; simplify them.", code="limit.exceeded")
        payload = declarations(tinycss2.serialize(content))
        try:
            selectors = cssselect2.compile_selector_list(prelude) if payload else ()
        except (cssselect2.SelectorError, NotImplementedError):
            continue  # as browsers do
        for selector in selectors:
            if selector.pseudo_element is None:
                matcher.add_selector(selector, payload)
    wrappers = cssselect2.ElementWrapper.from_xml_root(root).iter_subtree()
    return {
        wrapper.etree_element: [each for match in matches for each in match[3]]
        for wrapper in wrappers
        if (matches := matcher.match(wrapper))
    }


def _is_of_screens(condition: str) -> bool:
    """Whether a media query holds for a program that draws on screens; queries of sizes do not."""
    return any(part.strip().lower() in MEDIA for part in condition.split(","))


def _rules(nodes: Iterable[Any]) -> Iterator[tuple[Any, Any]]:
    """Selectors and declarations of rules, including those for screens, as tokens."""
    for node in nodes:
        if node.type == "qualified-rule":
            yield node.prelude, node.content
        elif (
            node.type == "at-rule"
            and node.lower_at_keyword in CONDITIONS
            and node.content is not None
            and (node.lower_at_keyword != "media" or _is_of_screens(tinycss2.serialize(node.prelude)))
        ):
            yield from _rules(tinycss2.parse_rule_list(node.content, True, True))
