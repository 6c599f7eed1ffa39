"""Layered pictures by what their files hold."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection
from pathlib import Path

from ..errors import invalid_file
from ..formats.files import read_whole
from ..formats.limits import Limits, Quota
from ..formats.pictures.png import Pixels, decode_png
from .archive import Archive
from .folder import read_folder
from .krita import DOCUMENT, read_krita
from .layer import LAYERED_LIMITS, LayeredPicture
from .openraster import STACK, read_openraster
from .psd import SIGNATURE, read_psd

ENDINGS = (".psd", ".psb", ".ora", ".kra")
"""Names of files end like this."""


def read_layers(
    path: str | os.PathLike[str],
    names: Collection[str] | None = None,
    *,
    limits: Limits = LAYERED_LIMITS,
    decode: Callable[[bytes], Pixels] | None = None,
) -> LayeredPicture:
    """The layers of a PSD, PSB, OpenRaster or Krita file, or of a folder of PNG pictures by the order of their names.

    names: of the pictures of a folder that are read, all if None; decode: (h, w, 4) pixels of a PNG; Pillow by default.
    Raises NestedCagesError for what can't be read, OSError.
    """
    place = Path(path)
    decoding = decode or (lambda data: decode_png(data, limits=limits))
    if place.is_dir():
        return read_folder(place, limits, decoding, names)
    return layers_of(read_whole(place, limits), limits, decoding)


def layers_of(data: bytes, limits: Limits, decode: Callable[[bytes], Pixels]) -> LayeredPicture:
    """The layers in the contents of a file."""
    if data.startswith(SIGNATURE):
        return read_psd(data, limits)
    if data.startswith(b"PK"):
        quota = Quota(limits)
        archive = Archive(data, quota)
        if DOCUMENT in archive.names:
            return read_krita(archive, quota)
        if STACK in archive.names:
            return read_openraster(archive, quota, decode)
    raise invalid_file("This is no layered picture; save it as .psd, .psb, .ora or .kra.")
