"""Style sheets: the declarations of each element, found within a budget of work."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any
from xml.etree import ElementTree as ET

from ...errors import NestedCagesError
from ...libraries import needed

with needed("tinycss2", "Reading SVG"):
    import tinycss2

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


def matched(root: ET.Element, texts: Iterable[str], read: Callable[[str], Any]) -> dict[ET.Element, Sequence[Any]]:
    """Declarations of style sheets for each matching element, the most specific last; read: those of a rule.

    Raises NestedCagesError for sheets that nest too deeply or take too much work.
    """
    with needed("cssselect2", "Reading style sheets"):
        import cssselect2
    elements = [item for item in root.iter() if isinstance(item.tag, str)]
    siblings = max(len(item) for item in elements)
    matcher, work = cssselect2.Matcher(), 0
    try:
        for prelude, content in _rules(node for text in texts for node in tinycss2.parse_stylesheet(text, True, True)):
            text = tinycss2.serialize(prelude)
            along = siblings if any(sign in text for sign in "~+:") else 1
            work += (len(text) + LEAST) * (len(elements) + LEAST) * along
            if work > MAX_WORK:
                raise NestedCagesError("The style sheets take too long to match; simplify them.", code="limit.exceeded")
            payload = read(tinycss2.serialize(content))
            try:
                selectors = cssselect2.compile_selector_list(prelude) if payload else ()
            except (cssselect2.SelectorError, NotImplementedError):
                continue  # as browsers do
            for selector in selectors:
                if selector.pseudo_element is None:
                    matcher.add_selector(selector, payload)
        found: dict[ET.Element, Sequence[Any]] = {}
        for wrapper in cssselect2.ElementWrapper.from_xml_root(root).iter_subtree():
            if matches := matcher.match(wrapper):
                found[wrapper.etree_element] = [each for match in matches for each in match[3]]
    except TOO_DEEP as error:
        raise NestedCagesError(
            "The style sheets nest blocks or selectors too deeply; simplify them.", code="limit.exceeded"
        ) from error
    return found


def is_of_screens(condition: str) -> bool:
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
            and (node.lower_at_keyword != "media" or is_of_screens(tinycss2.serialize(node.prelude)))
        ):
            yield from _rules(tinycss2.parse_rule_list(node.content, True, True))
