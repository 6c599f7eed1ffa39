"""PNG files as arrays, by Pillow, and arrays as PNG."""

from __future__ import annotations

import io
import os
import struct
import warnings
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import invalid_file
from ...libraries import needed
from ..files import read_whole
from ..limits import Limits

SIGNATURE = b"\x89PNG\r\n\x1a\n"

SIZE = slice(16, 24)
"""Bytes of width and height."""

RGBA = 6
"""Colour type of a PNG with red, green, blue and alpha."""

GREY = ("1", "L", "I", "I;16")
"""Modes of Pillow for pictures without colour and alpha."""

Pixels = NDArray[np.uint8]


def read_png(path: str | os.PathLike[str], *, limits: Limits | None = None) -> Pixels:
    """(H, W, 4) red, green, blue and alpha of a PNG file, from 0 to 255; of 16 bits per sample the upper 8."""
    limits = limits or Limits()
    return decode_png(read_whole(path, limits), limits=limits)


def decode_png(data: bytes, *, limits: Limits | None = None) -> Pixels:
    """(H, W, 4) red, green, blue and alpha of a PNG, rows from the top.

    Raises NestedCagesError for what is not one, or has more pixels than the limits allow, and where Pillow is missing.
    """
    if not isinstance(data, bytes | bytearray | memoryview):
        raise invalid_file(f"A PNG is read from bytes, not from a {type(data).__name__}; see read_png for files.")
    limits = limits or Limits()
    data = bytes(data)
    limits.check("bytes", len(data))
    if not data.startswith(SIGNATURE):
        raise invalid_file("This is not a PNG picture; save it as PNG.")
    if len(data) >= SIZE.stop:  # before Pillow allocates memory
        width, height = struct.unpack(">II", data[SIZE])
        limits.check("pixels", width * height)
    with needed("Pillow", "Reading PNG"):
        from PIL import Image, UnidentifiedImageError
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            Image.open(io.BytesIO(data), formats=["PNG"]).verify()
            with Image.open(io.BytesIO(data), formats=["PNG"]) as image:
                return _rgba(image)
    except UnidentifiedImageError as error:
        raise invalid_file("The PNG is damaged (it has no size); save it again.") from error
    except Exception as error:  # Pillow raises what it meets: OSError, SyntaxError, ValueError, zlib.error …
        raise invalid_file(f"The PNG is damaged ({error}); save it again.") from error


def _rgba(image: Any) -> Pixels:
    """(H, W, 4) colours and alpha."""
    if image.mode not in GREY:
        return np.asarray(image.convert("RGBA"), dtype=np.uint8)
    stored = image.tile[0][3] if image.tile else image.mode
    grey = np.asarray(image).astype(np.int64)
    if image.mode == "1":
        most, grey = 1, grey * 255
    else:
        _, _, depth = str(stored).partition(";")
        most = 65535 if image.mode.startswith("I") else 2 ** int(depth) - 1 if depth.isdecimal() else 255
    clear = image.info.get("transparency")
    key = clear * (65535 if most == 65535 else 255) // most if isinstance(clear, int) else -1
    alpha = np.where(grey == key, 0, 255)
    return np.dstack([*[grey >> 8 if most == 65535 else grey] * 3, alpha]).astype(np.uint8)


def encode_png(pixels: Pixels) -> bytes:
    """A PNG of (H, W, 4) red, green, blue and alpha."""
    height, width = pixels.shape[:2]
    rows = np.zeros((height, 1 + 4 * width), np.uint8)  # each row begins with its filter, which is none
    rows[:, 1:] = pixels.reshape(height, 4 * width)
    head = struct.pack(">IIBBBBB", width, height, 8, RGBA, 0, 0, 0)
    return SIGNATURE + _chunk(b"IHDR", head) + _chunk(b"IDAT", zlib.compress(rows.tobytes())) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
