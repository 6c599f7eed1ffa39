"""Names that artists gave to what they drew, and those that drawing programs made up."""

from __future__ import annotations

import re
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
