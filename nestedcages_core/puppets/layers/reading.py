"""Paintings from files: the parts of whatever holds layers."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

from ...errors import NestedCagesError, invalid_file
from ...formats import Limits, read_whole
from ...formats.limits import Quota
from .archive import Archive
from .drawing import LONGER_SIDE, parts_of_svg
from .folder import read_folder
from .grouping import as_things, without_aids
from .krita import DOCUMENT, read_krita
from .layer import LAYERED_LIMITS, LayeredPicture, Notes
from .openraster import STACK, read_openraster
from .painting import PicturePart, parts_of
from .psd import SIGNATURE, read_psd

PAINTINGS = (".psd", ".psb", ".ora", ".kra", ".svg")
"""Names of files end like this; folders hold .png."""


class Painting(NamedTuple):
    """A painting in parts."""

    parts: tuple[PicturePart, ...]
    """The lowest first."""
    size: tuple[int, int]
    """Width and height of the canvas."""
    notes: tuple[str, ...]
    """Sentences about what was left out or merged."""


def read_painting(
    path: str | os.PathLike[str],
    names: Collection[str] | None = None,
    *,
    hidden: bool = False,
    pixels: int = LONGER_SIDE,
) -> Painting:
    """The parts of a layered file, an SVG, or a folder of PNG pictures by the order of their names.

    names: of the pictures of a folder that are read, all if None; hidden: whether hidden layers become hidden parts;
    pixels: of the longer side of an SVG. Raises NestedCagesError, OSError.
    """
    place = Path(path)
    if place.suffix.lower() == ".svg":
        return Painting(*parts_of_svg(read_whole(path, Limits()), pixels, background=False))
    if place.is_dir():
        picture = read_folder(place, LAYERED_LIMITS, names)
    else:
        picture = _layers_of(read_whole(place, LAYERED_LIMITS), LAYERED_LIMITS)
    parts, notes = parts_of(picture, hidden=hidden)
    said = Notes()
    things = as_things(without_aids(parts, said), said)
    return Painting(tuple(things), (picture.width, picture.height), (*notes, *said.sentences))


def _layers_of(data: bytes, limits: Limits) -> LayeredPicture:
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
