"""Style sheets: the declarations of each element, found within a budget of work."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from types import ModuleType
from typing import Any
from xml.etree import ElementTree as ET

from ...errors import NestedCagesError
from ..libraries import load_css

CONDITIONS = ("media", "supports", "layer")
"""Rules around others; what is asked of the program is taken to be supported."""

MEDIA = ("", "all", "screen")
"""Conditions of @media that are true."""

MOST_WORK = 4_000_000
"""Visits of elements by selectors, each as often as the selector is long; a second or two."""

PER_WEIGHT = 8
"""Characters of a selector that make each of its visits cost one more."""

COMPILING, NEW, PLAIN = 100, 5, 8
"""What compiling a selector and making an element cost in visits, and how many plain children cost one (measured)."""

UNREADABLE = (RecursionError, SyntaxError, MemoryError)
"""What Python raises for expressions that are nested too deeply, which the library makes of selectors."""


class Work:
    """What selectors may still visit."""

    def __init__(self) -> None:
        self.left, self.weight, self.compiled = MOST_WORK, 1, 0

    def spend(self, visits: int) -> None:
        """Count visits at the weight of the selector at work. Raises NestedCagesError when nothing is left."""
        self.left -= visits * self.weight
        if self.left < 0:
            raise NestedCagesError(
                f"The selectors of the style sheets, {self.compiled:,} so far, take too long to match; simplify them.",
                code="limit.exceeded",
            )

    def counted(self, test: Callable[[Any], Any], weight: int) -> Callable[[Any], Any]:
        """The test of a selector, which counts."""

        def run(element: Any) -> Any:
            self.weight = weight
            self.spend(1)
            return test(element)

        return run


def matched(root: ET.Element, texts: Iterable[str], read: Callable[[str], Any]) -> dict[ET.Element, Sequence[Any]]:
    """Declarations of style sheets for each matching element, the most specific last; read: those of a rule.

    Raises NestedCagesError for sheets that nest too deeply or take too much work.
    """
    work = Work()
    try:
        return _matched(root, texts, read, work)
    except UNREADABLE as error:
        raise NestedCagesError(
            "The style sheets nest blocks or selectors too deeply; simplify them.", code="limit.exceeded"
        ) from error


def _matched(
    root: ET.Element, texts: Iterable[str], read: Callable[[str], Any], work: Work
) -> dict[ET.Element, Sequence[Any]]:
    tinycss2, cssselect2 = load_css()
    matcher = cssselect2.Matcher()
    nodes = (node for text in texts for node in tinycss2.parse_stylesheet(text, True, True))
    for prelude, content in _rules(tinycss2, nodes):
        work.spend(COMPILING)
        payload = read(tinycss2.serialize(content))
        if not payload:
            continue
        try:
            selectors = cssselect2.compile_selector_list(prelude)
        except (cssselect2.SelectorError, NotImplementedError):
            continue  # as browsers do
        for selector, length in zip(selectors, _lengths(tinycss2, prelude), strict=True):
            work.spend(COMPILING)
            work.compiled += 1
            if selector.pseudo_element is None:
                selector.test = work.counted(selector.test, 1 + length // PER_WEIGHT)
                matcher.add_selector(selector, payload)
        work.weight = 1
    found: dict[ET.Element, Sequence[Any]] = {}
    for wrapper in _element_class(cssselect2, work).from_xml_root(root).iter_subtree():
        work.weight = 1
        matches = matcher.match(wrapper)
        if matches:
            found[wrapper.etree_element] = [each for match in matches for each in match[3]]
    return found


def _lengths(tinycss2: ModuleType, prelude: Sequence[Any]) -> list[int]:
    """The number of characters of each selector of a list."""
    parts: list[list[Any]] = [[]]
    for token in prelude:
        if token.type == "literal" and token.value == ",":
            parts.append([])
        else:
            parts[-1].append(token)
    return [len(tinycss2.serialize(part)) for part in parts]


def _element_class(cssselect2: ModuleType, work: Work) -> Any:
    """Elements for selectors, which count their visits."""

    class Children(list[ET.Element]):
        def __getitem__(self, which: Any) -> Any:
            work.spend(len(self) // PLAIN)
            return super().__getitem__(which)

    class Element(cssselect2.ElementWrapper):  # type: ignore[name-defined,misc]
        def __init__(self, *given: Any, **named: Any) -> None:
            super().__init__(*given, **named)
            self.etree_children = Children(each for each in self.etree_element if isinstance(each.tag, str))
            work.spend(NEW + len(self.etree_children) // PLAIN)

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
            work.spend(len(found) + 1)
            return found

    return Element


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
