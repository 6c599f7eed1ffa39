"""Files in a zip archive, within limits."""

from __future__ import annotations

import io
import zipfile
import zlib
from xml.etree import ElementTree as ET

from ..errors import invalid_file
from ..formats.limits import Quota

MOST = 1e7
"""Maximum of places and sizes in pixels."""


class Archive:
    """The files in an archive. Raises NestedCagesError for one that is damaged or unpacks to more than the limit."""

    def __init__(self, data: bytes, quota: Quota) -> None:
        self.quota = quota
        try:
            self.files = zipfile.ZipFile(io.BytesIO(data))
        except (zipfile.BadZipFile, ValueError, NotImplementedError, UnicodeDecodeError) as error:
            raise invalid_file(f"The file is damaged ({error}). Save it again.") from error
        self.names = self.files.namelist()

    def read(self, name: str) -> bytes:
        """The contents of a file."""
        try:
            self.quota.spend("bytes", self.files.getinfo(name).file_size)
            return self.files.read(name)
        except KeyError as error:
            raise invalid_file(f"The file is damaged: '{name}' is missing in it. Save it again.") from error
        except (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, RuntimeError) as error:
            raise invalid_file(
                f"The file is damaged: '{name}' in it can't be read ({error}). Save it again."
            ) from error

    def document(self, name: str) -> ET.Element:
        """The root of an XML file."""
        try:
            return ET.fromstring(self.read(name))
        except ET.ParseError as error:
            raise invalid_file(f"The file is damaged: '{name}' in it is no XML ({error}). Save it again.") from error


def whole(node: ET.Element, attribute: str, missing: int = 0) -> int:
    """A whole number in an attribute. Raises NestedCagesError."""
    return int(number(node, attribute, missing))


def number(node: ET.Element, attribute: str, missing: float) -> float:
    """A number in an attribute of a size that can be meant. Raises NestedCagesError."""
    text = node.get(attribute)
    try:
        value = missing if text is None else float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) <= MOST:
        raise invalid_file(f"A layer has {attribute}={text!r:.40}, which is not a number that can be used.")
    return value
