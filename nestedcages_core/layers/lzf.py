"""Unpacking of LZF, as LibLZF packs."""

from __future__ import annotations

from ..errors import invalid_file

LITERALS = 32
"""Control bytes below this precede as many bytes and one more; others are a copy of what came before."""


def unpacked(packed: bytes, size: int) -> bytes:
    """The bytes of a known number. Raises NestedCagesError if they are not."""
    out, at = bytearray(), 0
    try:
        while at < len(packed) and len(out) <= size:
            control = packed[at]
            at += 1
            if control < LITERALS:
                out += packed[at : at + control + 1]
                at += control + 1
                continue
            length = control >> 5
            if length == 7:
                length += packed[at]
                at += 1
            start = len(out) - ((control & 31) << 8) - packed[at] - 1
            at += 1
            if start < 0:
                break
            for k in range(start, start + length + 2):  # may overlap what it writes
                out.append(out[k])
    except IndexError:
        pass
    if len(out) != size:
        raise invalid_file("The file is damaged: packed pixels can't be unpacked. Save it again.")
    return bytes(out)
