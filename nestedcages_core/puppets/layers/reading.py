"""Layered pictures by what their files hold."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path

from ...errors import NestedCagesError, invalid_file
from ...formats.files import read_whole
from ...formats.limits import Limits, Quota
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
) -> LayeredPicture:
    """The layers of a PSD, PSB, OpenRaster or Krita file, or of a folder of PNG pictures by the order of their names.

    names: of the pictures of a folder that are read, all if None. Raises NestedCagesError, OSError.
    """
    place = Path(path)
    if place.is_dir():
        return read_folder(place, limits, names)
    return layers_of(read_whole(place, limits), limits)


def layers_of(data: bytes, limits: Limits = LAYERED_LIMITS) -> LayeredPicture:
    """The layers in the contents of a file. Raises NestedCagesError."""
    try:
        if data.startswith(SIGNATURE):
            return read_psd(data, limits)
        if data.startswith(b"PK"):
            quota = Quota(limits)
            archive = Archive(data, quota)
            if DOCUMENT in archive.names:
                return read_krita(archive, quota)
            if STACK in archive.names:
                return read_openraster(archive, quota)
    except (NestedCagesError, MemoryError):
        raise
    except Exception as error:  # damaged files raise what their bytes lead to
        raise invalid_file(f"The file is cut off or damaged ({error!r:.200}). Save it again.") from error
    raise invalid_file("This is no layered picture; save it as .psd, .psb, .ora or .kra.")
