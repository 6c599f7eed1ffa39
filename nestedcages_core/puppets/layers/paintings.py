"""Paintings from files: what every reader of layers makes of them, and layered SVG."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

from ...formats import Limits, read_whole
from .drawing import LONGER_SIDE, parts_of_svg
from .grouping import as_things, without_aids
from .layer import Notes
from .painting import PicturePart, parts_of
from .reading import ENDINGS, read_layers

PAINTINGS = (*ENDINGS, ".svg")
"""Names of files end like this; folders hold .png."""


class Painting(NamedTuple):
    """A painting in parts."""

    parts: tuple[PicturePart, ...]
    """The lowest first."""
    size: tuple[int, int]
    """Width and height of the canvas."""
    notes: tuple[str, ...]
    """Sentences about what was left out."""


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
    if Path(path).suffix.lower() == ".svg":
        return Painting(*parts_of_svg(read_whole(path, Limits()), pixels, background=False))
    picture = read_layers(path, names)
    parts, notes = parts_of(picture, hidden=hidden)
    said = Notes()
    things = as_things(without_aids(parts, said), said)
    return Painting(tuple(things), (picture.width, picture.height), (*notes, *said.sentences))
