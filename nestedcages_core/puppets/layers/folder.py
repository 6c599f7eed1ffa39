"""A folder of PNG pictures as layers, by the order of their names."""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Collection
from pathlib import Path

from ...errors import invalid_file
from ...formats.files import read_whole
from ...formats.limits import Limits, Quota
from ...formats.pictures.png import SIGNATURE, decode_png
from .layer import Layer, LayeredPicture

ORDER = re.compile(r"^\d+[\s._-]*(?=\D)")
"""Number at the beginning of a name that only tells the order."""

MOST_FOLDERS = 8
"""Maximum depth of folders in folders."""


def read_folder(path: Path, limits: Limits, names: Collection[str] | None = None) -> LayeredPicture:
    """A layer for each PNG of a folder, the first by name lowest, folders in it as groups. Raises NestedCagesError.

    Pictures lie where their oFFs chunk says, as GIMP writes it, else at the upper left corner of the canvas. The canvas
    is as large as they reach. names: of the files and folders in it that are read; all if None.
    """
    layers = _layers_in(path, Quota(limits), names)
    found = [layer for each in layers for layer in each.walk() if layer.pixels is not None]
    if not found:
        raise invalid_file(f"{path.name}: the folder has no PNG pictures.")
    width = max(layer.left + layer.pixels.shape[1] for layer in found if layer.pixels is not None)
    height = max(layer.top + layer.pixels.shape[0] for layer in found if layer.pixels is not None)
    return LayeredPicture(width, height, layers)


def _layers_in(
    path: Path,
    quota: Quota,
    wanted: Collection[str] | None = None,
    depth: int = 0,
) -> tuple[Layer, ...]:
    layers = []
    with os.scandir(path) as entries:
        found = [entry.name for entry in entries if not entry.name.startswith(".")]
    names = sorted((name for name in found if wanted is None or name in wanted), key=_by_numbers)
    for name in names:
        file = path / name
        if file.is_dir() and depth < MOST_FOLDERS:
            inside = _layers_in(file, quota, depth=depth + 1)
            layers += [Layer(ORDER.sub("", name), children=inside)] if inside else []
        elif file.suffix.lower() == ".png" and file.is_file():
            quota.spend("elements", 1)
            data = read_whole(file, quota.limits)
            quota.spend("bytes", len(data))
            pixels = decode_png(data, limits=quota.limits)
            quota.spend("pixels", pixels.shape[0] * pixels.shape[1])
            left, top = _place_of_png(data)
            layers.append(Layer(ORDER.sub("", file.stem), left=left, top=top, pixels=pixels))
    return tuple(layers)


def _by_numbers(name: str) -> list[tuple[bool, int, str]]:
    """The key of an order in which 2 comes before 10."""
    return [(not word.isdecimal(), int(word) if word.isdecimal() else 0, word) for word in re.split(r"(\d+)", name)]


def _place_of_png(png: bytes) -> tuple[int, int]:
    """Left and top of a PNG on its canvas, from its oFFs chunk in pixels; 0 without one."""
    at = len(SIGNATURE)
    while at + 8 <= len(png):
        length, kind = struct.unpack(">I4s", png[at : at + 8])
        if kind == b"oFFs" and length == 9 and at + 17 <= len(png):
            left, top, unit = struct.unpack(">iiB", png[at + 8 : at + 17])
            return (left, top) if unit == 0 else (0, 0)
        if kind == b"IDAT":
            break
        at += 12 + length
    return 0, 0
