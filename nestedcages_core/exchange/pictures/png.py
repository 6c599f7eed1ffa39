"""PNG files as arrays (ISO/IEC 15948): every colour type and depth, interlaced or not."""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import NestedCagesError
from ..files import read_whole
from ..limits import Limits
from .filters import unfiltered

SIGNATURE = b"\x89PNG\r\n\x1a\n"

CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
"""Samples per pixel of each colour type: grey, RGB, palette, grey with alpha, RGB with alpha."""

DEPTHS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
"""Bits per sample that each colour type allows."""

PALETTE = 3
"""The colour type whose samples are numbers of colours in a table."""

ADAM7 = ((0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4), (2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1))
WHOLE = ((0, 0, 1, 1),)
"""First row and column, and steps between rows and columns, of the passes of an interlaced and of another picture."""

Pixels = NDArray[np.uint8] | NDArray[np.uint16]


class Header(NamedTuple):
    """The IHDR chunk."""

    width: int
    height: int
    depth: int
    colour: int
    compression: int
    filtering: int
    interlaced: int


def read_png(path: str | os.PathLike[str], *, limits: Limits | None = None) -> Pixels:
    """(H, W, 4) red, green, blue and alpha of a PNG file; uint16 if it has 16 bits per sample, else uint8."""
    limits = limits or Limits()
    return decode_png(read_whole(path, limits), limits=limits)


def decode_png(data: bytes, *, limits: Limits | None = None) -> Pixels:
    """(H, W, 4) red, green, blue and alpha of a PNG, rows from the top.

    Raises NestedCagesError for what is not one, or has more pixels than the limits allow.
    """
    if not isinstance(data, bytes | bytearray | memoryview):
        raise NestedCagesError(
            f"A PNG is read from bytes, not from a {type(data).__name__}; see read_png for files.", code="file.invalid"
        )
    limits = limits or Limits()
    limits.check("bytes", len(data))
    chunks = _chunks(bytes(data))
    header = _header(chunks)
    limits.check("pixels", header.width * header.height)
    try:  # never decompress more data than the picture has
        raw = zlib.decompressobj().decompress(chunks.get(b"IDAT", b""), _size(header))
    except zlib.error as error:
        raise NestedCagesError(
            f"The picture's data cannot be unpacked ({error}); save the PNG again.", code="file.invalid"
        ) from error
    samples = _samples(np.frombuffer(raw, dtype=np.uint8), header)
    if header.colour == PALETTE:
        return _looked_up(samples[:, :, 0], chunks)
    return _as_rgba(samples, header, chunks.get(b"tRNS"))


def _chunks(data: bytes) -> dict[bytes, bytes]:
    """The contents of the chunks; those of the same kind joined."""
    if not data.startswith(SIGNATURE):
        raise NestedCagesError("This is not a PNG picture; save it as PNG.", code="file.invalid")
    chunks: dict[bytes, bytes] = {}
    parts: list[bytes] = []
    place = len(SIGNATURE)
    while b"IEND" not in chunks:
        if place + 12 > len(data):
            raise NestedCagesError("The PNG ends too early; save it again.", code="file.invalid")
        length, kind = struct.unpack_from(">I4s", data, place)
        content = data[place + 8 : place + 8 + length]
        stored = data[place + 8 + length : place + 12 + length]
        if len(stored) < 4:
            raise NestedCagesError("The PNG ends too early; save it again.", code="file.invalid")
        if zlib.crc32(kind + content) != int.from_bytes(stored, "big"):
            name = kind.decode("ascii") if kind.isalpha() else "unnamed"
            raise NestedCagesError(f"The {name} part of the PNG is damaged; save it again.", code="file.invalid")
        if kind == b"IDAT":
            parts.append(content)
        else:
            chunks.setdefault(kind, content)
        place += 12 + length
    return {**chunks, b"IDAT": b"".join(parts)}


def _header(chunks: dict[bytes, bytes]) -> Header:
    content = chunks.get(b"IHDR", b"")
    if len(content) != 13:
        raise NestedCagesError("The PNG has no header; save it again.", code="file.invalid")
    header = Header(*struct.unpack(">IIBBBBB", content))
    right = header.depth in DEPTHS.get(header.colour, ()) and header.interlaced < 2
    if not right or header.compression or header.filtering or not header.width or not header.height:
        raise NestedCagesError(
            "The header of the PNG has values that the standard does not know; save it again.", code="file.invalid"
        )
    return header


def _passes(header: Header) -> Iterator[tuple[slice, slice, int, int]]:
    """Rows and columns of each pass over the picture, its height, and its bytes per row without the filter."""
    for row, column, down, across in ADAM7 if header.interlaced else WHOLE:
        height, width = -(-(header.height - row) // down), -(-(header.width - column) // across)
        if height > 0 and width > 0:
            stride = (width * CHANNELS[header.colour] * header.depth + 7) // 8
            yield slice(row, None, down), slice(column, None, across), height, stride


def _size(header: Header) -> int:
    """Bytes of the filtered rows of a picture."""
    return sum(height * (stride + 1) for _, _, height, stride in _passes(header))


def _samples(raw: NDArray[np.uint8], header: Header) -> Pixels:
    """(H, W, channels) samples as stored."""
    channels = CHANNELS[header.colour]
    shape = (header.height, header.width, channels)
    samples: Pixels = np.empty(shape, dtype=np.uint16) if header.depth == 16 else np.empty(shape, dtype=np.uint8)
    place = 0
    for rows, columns, height, stride in _passes(header):
        target = samples[rows, columns]
        if place + height * (stride + 1) > len(raw):
            raise NestedCagesError(
                "The picture's data are shorter than its size; save the PNG again.", code="file.invalid"
            )
        lines = raw[place : place + height * (stride + 1)].reshape(height, stride + 1)
        place += lines.size
        if lines[:, 0].max() > 4:
            raise NestedCagesError(
                "The picture's data use a filter that the standard does not know; save it again.", code="file.invalid"
            )
        content = unfiltered(lines, max(channels * header.depth // 8, 1))
        target[...] = _unpacked(content, header.depth, target.shape[1] * channels).reshape(target.shape)
    return samples


def _unpacked(rows: NDArray[np.uint8], depth: int, count: int) -> Pixels:
    """(H, count) samples of rows of bytes."""
    if depth == 8:
        return rows
    if depth == 16:
        return np.asarray(rows.view(">u2"), dtype=np.uint16)
    bits = np.unpackbits(rows, axis=1)[:, : count * depth].reshape(len(rows), count, depth)
    weights = (1 << np.arange(depth)[::-1]).astype(np.uint8)
    return np.asarray((bits * weights).sum(axis=2, dtype=np.uint8))


def _looked_up(index: Pixels, chunks: dict[bytes, bytes]) -> NDArray[np.uint8]:
    """(H, W, 4) colours of a palette; entries without a stated alpha are opaque."""
    colours = chunks.get(b"PLTE", b"")
    table = np.zeros((256, 4), dtype=np.uint8)
    table[:, 3] = 255
    count = min(len(colours) // 3, 256)
    table[:count, :3] = np.frombuffer(colours[: 3 * count], dtype=np.uint8).reshape(-1, 3)
    alpha = chunks.get(b"tRNS", b"")[:256]
    table[: len(alpha), 3] = np.frombuffer(alpha, dtype=np.uint8)
    if int(index.max()) >= count:
        raise NestedCagesError(
            "The picture uses a colour that its palette does not have; save the PNG again.", code="file.invalid"
        )
    return np.asarray(table[index])


def _as_rgba(samples: Pixels, header: Header, clear: bytes | None) -> Pixels:
    """(H, W, 4): grey spread over the colours, alpha added, low depths scaled to 8 bits."""
    most = 2**header.depth - 1
    channels = samples.shape[2]
    shape = (*samples.shape[:2], 4)
    wide = header.depth == 16
    full = 65535 if wide else 255
    rgba: Pixels = np.empty(shape, dtype=np.uint16) if wide else np.empty(shape, dtype=np.uint8)
    rgba[:, :, :3] = samples[:, :, : 3 if channels > 2 else 1] * (full // most)
    if channels in (2, 4):
        rgba[:, :, 3] = samples[:, :, -1]
    else:
        rgba[:, :, 3] = full
        if clear is not None and len(clear) >= 2 * channels:
            key = np.frombuffer(clear[: 2 * channels], dtype=">u2")
            rgba[(samples == key).all(axis=2), 3] = 0
    return rgba
