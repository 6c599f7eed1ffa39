"""Names of elements, and what they refer to."""

from __future__ import annotations

from xml.etree import ElementTree as ET

from .faults import quoted


def name_of(item: ET.Element) -> str:
    """The tag without its namespace; comments have none."""
    return item.tag.rpartition("}")[2] if isinstance(item.tag, str) else ""


def title_of(item: ET.Element) -> str:
    """An element in messages: its tag and its id."""
    return f"{name_of(item)} {quoted(item.get('id', ''))}" if item.get("id") else f"{name_of(item)} without an id"


def link_of(item: ET.Element) -> str:
    """The target of a reference, with its `#`."""
    return (item.get("href") or item.get("{http://www.w3.org/1999/xlink}href") or "").strip()
