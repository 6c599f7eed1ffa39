"""Pixels of a PSD: planes raw, by run lengths or by zip, of 8, 16 and 32 bits, in grey, RGB or CMYK."""

from __future__ import annotations

import zlib
from collections.abc import Mapping

import numpy as np

from ..errors import invalid_file
from ..formats.pictures.png import Pixels
from ..geometry.arrays import AnyArray
from .byte_reader import ByteReader
from .layer import Opacities

GREY, RGB, CMYK, DUOTONE = 1, 3, 4, 8
MODES = {GREY: 1, RGB: 3, CMYK: 4, DUOTONE: 1}
"""Colour modes that are read, with their numbers of planes; duotones are kept as grey."""

RAW, RUNS, ZIP, ZIP_OF_DIFFERENCES = range(4)
"""Compressions of a plane."""

RUN = 128
"""Control bytes below this precede as many bytes and one more; above it, one byte that is repeated."""

SRGB_LINEAR, SRGB_SLOPE, SRGB_POWER, SRGB_OFFSET = 0.0031308, 12.92, 2.4, 0.055
"""The curve of sRGB (IEC 61966-2-1); colours of 32 bits are linear."""


def plane(block: memoryview, size: tuple[int, int], depth: int, *, big: bool, is_colour: bool) -> Opacities:
    """(height, width) values of a channel with 8 bits. depth: its bits in the file; big: whether that is a PSB."""
    height, width = size
    row = width * depth // 8
    body = ByteReader(block)
    way = body.number("H")
    if way == RAW:
        raw = bytes(body.take(row * height))
    elif way == RUNS:
        lengths = body.numbers(f"{height}{'I' if big else 'H'}")
        raw = b"".join(_unpacked(bytes(body.take(length)), row) for length in lengths)
    elif way in (ZIP, ZIP_OF_DIFFERENCES):
        raw = inflated(bytes(body.take(body.left)), row * height)
    else:
        raise invalid_file(f"A layer is compressed in way {way}, which is not known. Save the file again.")
    if depth == 32:
        return _of_light(raw, height, width, differences=way == ZIP_OF_DIFFERENCES, is_colour=is_colour)
    values = np.frombuffer(raw, np.uint8 if depth == 8 else ">u2").reshape(height, width)
    if way == ZIP_OF_DIFFERENCES:
        values = np.cumsum(values, axis=1, dtype=np.uint8 if depth == 8 else np.uint16)
    return values if depth == 8 else narrowed(values)


def inflated(data: bytes, size: int) -> bytes:
    """Bytes of a known number that were deflated. Raises NestedCagesError if they are not."""
    try:
        raw = zlib.decompressobj().decompress(data, size)
    except zlib.error as error:
        raise invalid_file(f"A layer is damaged ({error}). Save the file again.") from error
    if len(raw) != size:
        raise invalid_file(f"A layer is damaged: it has {len(raw)} bytes instead of {size}. Save the file again.")
    return raw


def _unpacked(packed: bytes, size: int) -> bytes:
    """A row that was packed by run lengths (PackBits)."""
    out, at = bytearray(), 0
    while at < len(packed) and len(out) < size:
        count = packed[at]
        if count < RUN:
            out += packed[at + 1 : at + count + 2]
            at += count + 2
        else:
            if count > RUN:
                out += packed[at + 1 : at + 2] * (2 * RUN + 1 - count)
            at += 1 + (count > RUN)
    if len(out) < size:
        raise invalid_file("A layer is damaged: a row of pixels ends early. Save the file again.")
    return bytes(out[:size])


def _of_light(raw: bytes, height: int, width: int, *, differences: bool, is_colour: bool) -> Opacities:
    """Values of 32 bits."""
    if differences:  # the bytes of a row are sorted by their rank
        ranked = np.cumsum(np.frombuffer(raw, np.uint8).reshape(height, 4 * width), axis=1, dtype=np.uint8)
        raw = ranked.reshape(height, 4, width).transpose(0, 2, 1).tobytes()
    light = np.clip(np.nan_to_num(np.frombuffer(raw, ">f4").reshape(height, width)), 0.0, 1.0)
    if is_colour:
        curved = (1.0 + SRGB_OFFSET) * light ** (1.0 / SRGB_POWER) - SRGB_OFFSET
        light = np.where(light <= SRGB_LINEAR, SRGB_SLOPE * light, curved)
    return (255.0 * light + 0.5).astype(np.uint8)


def narrowed(values: AnyArray) -> Opacities:
    """16 bits as the nearest of 8 bits."""
    return ((values.astype(np.uint32) * 255 + 32767) // 65535).astype(np.uint8)


def coloured(planes: Mapping[int, Opacities], height: int, width: int, mode: int) -> Pixels:
    """(height, width, 4) pixels from planes by their numbers: colours from 0, alpha -1, opaque if missing."""
    out = np.full((height, width, 4), 255, np.uint8)
    missing = [number for number in range(MODES[mode]) if number not in planes]
    if missing:
        raise invalid_file(f"A layer is damaged: its channel {missing[0]} is missing. Save the file again.")
    if mode == CMYK:  # stored inverted: 255 is no ink
        black = planes[3].astype(np.uint16)
        for number in range(3):
            out[..., number] = planes[number] * black // 255
    else:
        for number in range(3):
            out[..., number] = planes[number if mode == RGB else 0]
    if -1 in planes:
        out[..., 3] = planes[-1]
    return out
