"""Files in a zip archive, and numbers in its XML, within limits."""

from __future__ import annotations

import io
import zipfile
from xml.etree import ElementTree as ET

from ...errors import invalid_file
from ...formats.limits import Quota

MOST = 1e7
"""Maximum of places and sizes in pixels."""


class Archive:
    """The files in an archive; what they unpack to counts as bytes of the quota."""

    def __init__(self, data: bytes, quota: Quota) -> None:
        self.quota = quota
        self.files = zipfile.ZipFile(io.BytesIO(data))
        self.names = self.files.namelist()

    def read(self, name: str) -> bytes:
        """The contents of a file."""
        self.quota.spend("bytes", self.files.getinfo(name).file_size)
        return self.files.read(name)

    def document(self, name: str) -> ET.Element:
        """The root of an XML file."""
        return ET.fromstring(self.read(name))


def whole(node: ET.Element, attribute: str, missing: int = 0) -> int:
    """A whole number in an attribute. Raises NestedCagesError."""
    return int(number(node, attribute, missing))


def number(node: ET.Element, attribute: str, missing: float) -> float:
    """A number in an attribute of a size that can be meant. Raises NestedCagesError."""
    value = float(node.get(attribute, missing))
    if not abs(value) <= MOST:
        raise invalid_file(f"A layer has {attribute}={value!r}, which is not a number that can be used.")
    return value
