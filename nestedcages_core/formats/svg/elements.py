"""Elements of a document: their names, what they refer to, and what is wrong with them."""

from __future__ import annotations

import re
from collections import Counter
from xml.etree import ElementTree as ET

LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
"""Attribute with the name that Inkscape shows."""

LABELS = (LABEL, "{http://www.serif.com/}id", "data-name")
"""Attributes with names that programs show: Inkscape, Affinity and Illustrator."""

ESCAPED = re.compile(r"_x([0-9A-F]{2,4})_")
"""A character that Illustrator writes by its number."""

REPEATED = re.compile(r"(?<=.)_\d+_$")
"""What Illustrator adds to a name that was given twice."""

AUTOMATIC = re.compile(
    r"(XMLID|SVGID)_.*|(g|a|use|path|rect|circle|ellipse|line|polyline|polygon|layer|group|shape|vector|rectangle|oval)"
    r"([ _-]?\d+)*",
    re.IGNORECASE,
)
"""Names that Inkscape, Illustrator, Figma and Krita make up."""

MAX_NAMED, MAX_SHOWN = 6, 30
"""Maximum number of faults that notes name, and maximum length of a value in a message."""


def name_of(item: ET.Element) -> str:
    """The tag without its namespace; comments have none."""
    return item.tag.rpartition("}")[2] if isinstance(item.tag, str) else ""


def title_of(item: ET.Element) -> str:
    """An element in messages: its tag and its id."""
    return f"{name_of(item)} {quoted(item.get('id', ''))}" if item.get("id") else f"{name_of(item)} without an id"


def link_of(item: ET.Element) -> str:
    """The target of a reference, with its `#`."""
    return (item.get("href") or item.get("{http://www.w3.org/1999/xlink}href") or "").strip()


def layer_names(item: ET.Element) -> list[str]:
    """Its label in Inkscape and its id, those that it has."""
    return [name for name in (item.get(LABEL), item.get("id")) if name]


def shown_name(item: ET.Element) -> str:
    """The name that the program that wrote an element shows; empty if it has none."""
    label = next(filter(None, map(item.get, LABELS)), "")
    if label:
        return label
    plain = ESCAPED.sub(lambda found: chr(int(found[1], 16)), item.get("id", ""))
    return plain if is_automatic(plain) else REPEATED.sub("", plain)


def is_automatic(name: str) -> bool:
    """Whether a program made a name up."""
    return AUTOMATIC.fullmatch(name) is not None


class Faults:
    """Attributes that cannot be read, and what is done instead, as browsers do; each sentence once."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()

    def add(self, sentence: str) -> None:
        self.counts[sentence] += 1

    def notes(self) -> list[str]:
        """The first sentences, and how many others there are."""
        named = [f"{text} ({count} times)." if count > 1 else f"{text}." for text, count in self.counts.items()]
        more = len(named) - MAX_NAMED
        return [*named[:MAX_NAMED], *([f"{more} more attributes cannot be read."] if more > 0 else [])]


def quoted(text: str) -> str:
    """A value, shortened for messages."""
    return f"'{text}'" if len(text) <= MAX_SHOWN else f"'{text[:MAX_SHOWN]}…'"
