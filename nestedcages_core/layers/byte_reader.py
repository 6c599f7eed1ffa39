"""Bytes read in order, within their bounds."""

from __future__ import annotations

import struct
from typing import Any

from ..errors import invalid_file


class ByteReader:
    """A reader of big-endian numbers and blocks. Raises NestedCagesError where the bytes end early."""

    def __init__(self, data: bytes | memoryview) -> None:
        self.data, self.at = memoryview(data), 0

    @property
    def left(self) -> int:
        """Number of bytes not read yet."""
        return len(self.data) - self.at

    def take(self, count: int) -> memoryview:
        """The next bytes."""
        if not 0 <= count <= self.left:
            raise invalid_file("The file is cut off or damaged: a block ends beyond its end. Save it again.")
        self.at += count
        return self.data[self.at - count : self.at]

    def numbers(self, form: str) -> tuple[Any, ...]:
        """Numbers by their codes of `struct`."""
        return struct.unpack(">" + form, self.take(struct.calcsize(">" + form)))

    def number(self, form: str) -> Any:
        """One number."""
        return self.numbers(form)[0]

    def block(self, form: str = "I") -> ByteReader:
        """A block that begins with its length."""
        return ByteReader(self.take(self.number(form)))
