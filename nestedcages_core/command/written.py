"""Drawings and the cages that were written for them, read to be judged: what cannot be judged is rejected."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..checker import rings_of
from ..errors import invalid_file
from ..formats import DRAWING_LIMITS, Frame, Limits, levels_in_svg, outlines_from_engine_json, read_map, read_whole
from ..formats.engine_json import flipped
from ..formats.fill import united
from ..formats.pictures import HALF, alpha_channel, boundary_of_pixels
from ..geometry.arrays import IntArray
from ..geometry.mesh import Mesh
from ..libraries import load_shapely
from .sources import read

LAST_WORDS = re.compile(r"-?(drawing|shape|cage-\d+)$| (Inner )?(Fine|Cage \d+)(\.\d+)?$")
"""What the command and Blender add to the number or name of a shape in an id."""

OUTLINE = re.compile(rb'"format"\s*:\s*"nested-cages ')
"""What tells a collision outline, or frames, from a map."""

SAME_PAGE = 1e-6
"""Difference of two pages, over the largest number, that is the rounding of their decimals."""


@dataclass(frozen=True, eq=False)
class Loops:
    """The loops (k, 2) of a drawing or a cage in a file."""

    rings: list[Any]

    @property
    def count(self) -> int:
        """Number of vertices."""
        return sum(map(len, self.rings))

    @property
    def edges(self) -> IntArray:
        """(n, 2) of the loops one after the other, as they are written."""
        loops = np.split(np.arange(self.count), np.cumsum([len(ring) for ring in self.rings])[:-1])
        return np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop in loops])

    def flipped(self, height: float) -> Loops:
        """Turned over at half a height, as outlines are written."""
        return Loops([flipped(ring, height) for ring in self.rings])

    @property
    def area(self) -> float:
        """That of the solid between the loops."""
        return sum(self.areas)

    @property
    def areas(self) -> list[float]:
        """Those inside the loops, of holes negative."""
        ends = [(ring - ring[0], np.roll(ring - ring[0], -1, axis=0)) for ring in rings_of(self.rings)]
        return [0.5 * float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()) for a, b in ends]


Levels = dict[int, Loops]
"""The drawing, which is level 0, its cages from 1 and its inner cages from -1, those that a file has."""


class Shapes(NamedTuple):
    """What a file has."""

    shapes: list[Levels]
    frame: Frame | None = None
    """Of a picture."""
    moves: bool = False
    """Whether the shapes are frames of a motion."""
    y_up: bool = False
    """Whether y points up, as in maps; in pictures it points down."""
    height: float = 0.0
    """Of a picture in pixels."""


def read_frames(paths: Sequence[str], *options: Any, **more: Any) -> Shapes:
    """The drawings of a file, see `read_drawings`; those of several files are the frames of a motion, one each."""
    files = [read_drawings(path, *options, **more) for path in paths]
    if len(files) == 1:
        return files[0]
    for path, each in zip(paths, files, strict=True):
        if len(each.shapes) != 1:
            raise invalid_file(f"{path} has {len(each.shapes)} shapes; a frame of a motion is one.")
    return files[0]._replace(shapes=[each.shapes[0] for each in files], moves=True)


def read_drawings(path: str, tolerance: float | None, *, together: bool = False, threshold: float = HALF) -> Shapes:
    """The drawings of a file, as cages are made from them; of a picture of this program those that it shows.

    together: whether the features of a map are one drawing. threshold: opacity above which pixels count.
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".svg":
        content = read_whole(path, DRAWING_LIMITS)
        if b"data-outlines" in content:
            shown = _of_picture(content)
            if any(0 in levels for levels in shown.shapes):
                return shown._replace(shapes=[{0: levels[0]} for levels in shown.shapes if 0 in levels])
    if suffix == ".json" and OUTLINE.search(content := read_whole(path, Limits())):
        return _of_outlines(content, 0)
    source = read(path, Limits(), {"tolerance": tolerance})
    if source.failures:
        raise invalid_file(" ".join(source.failures))
    contents = [shape.content for shape in source.shapes]
    meshes = [
        content if isinstance(content, Mesh) else boundary_of_pixels(alpha_channel(content) > threshold)
        for content in contents
    ]
    if together:
        meshes = [_together(meshes)]
    shapes = [{0: _loops(mesh)} for mesh in meshes]
    return Shapes(shapes, source.frame, y_up=source.kind == "map", height=source.height)


def read_cages(path: str, *, together: bool = False) -> Shapes:
    """The cages of a file, and the drawings that it shows. Raises NestedCagesError for a file that lacks levels.

    together: whether all features of a level of a map are one cage.
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".svg":
        found = _of_picture(read_whole(path, DRAWING_LIMITS))
    else:
        content = read_whole(path, Limits())
        found = _of_outlines(content, 1) if OUTLINE.search(content) else _of_map(content, together)
    for levels in found.shapes:
        for side in (1, -1):
            numbers = sorted(side * level for level in levels if side * level > 0)
            missing = sorted({*range(1, len(numbers) + 1)} - {*numbers})
            if missing:
                raise invalid_file(f"There is a level {numbers[-1]}, but no level {missing[0]}.")
    return found


def _of_picture(content: bytes) -> Shapes:
    picture = levels_in_svg(content)
    owners = [LAST_WORDS.sub("", each.name) for each in picture.levels]
    if len(set(owners)) != sum(each.level == 0 for each in picture.levels):  # named by somebody else
        owners = [""] * len(owners)
    found: dict[str, Levels] = {}
    for owner, each in zip(owners, picture.levels, strict=True):
        _put(found.setdefault(owner, {}), each.level, Loops(each.rings), each.name)
    return Shapes(
        [found[owner] for owner in sorted(found, key=lambda owner: int(owner) if owner.isdecimal() else 0)],
        picture.frame,
    )


def _of_outlines(content: bytes, level: int) -> Shapes:
    outlines, moves = outlines_from_engine_json(content)
    return Shapes([{level: _loops(outline)} for outline in outlines], moves=moves)


def _of_map(content: bytes, together: bool) -> Shapes:
    found = read_map(content)
    faults = [*found.refused, *found.notes]
    if faults or found.without_polygons:
        raise invalid_file(" ".join(faults) or "The map has features without polygons.")
    shapes: list[Levels] = []
    of_level: dict[int, list[Mesh]] = {}
    for feature in found.features:
        level = feature.properties.get("level", 1)
        if type(level) is not int or level < 1:
            raise invalid_file(f"The level of {feature.name} is {level!r:.40}, not a whole number from 1 on.")
        of_level.setdefault(level, []).append(feature.mesh)
        if together:
            continue
        if level == 1 or not shapes:
            shapes.append({})
        _put(shapes[-1], level, _loops(feature.mesh), feature.name)
    return Shapes([{level: _loops(_together(meshes)) for level, meshes in of_level.items()}] if together else shapes)


def _together(meshes: list[Mesh]) -> Mesh:
    """The land of regions that may share borders."""
    shapely = load_shapely("Reading regions together")
    return united(shapely, [shapely.geometry.shape(mesh) for mesh in meshes])


def _loops(mesh: Mesh) -> Loops:
    """Those of a mesh, as they are written."""
    return Loops([mesh.vertices[loop] for loop in sorted(map(sorted, mesh.loops))])


def _put(levels: Levels, level: int, loops: Loops, name: str) -> None:
    """Add a level to those of a shape. Raises NestedCagesError for a second one of the same number."""
    if level in levels:
        raise invalid_file(f"{name} has the level of another path, and names do not tell which shapes they belong to.")
    levels[level] = loops


def pages_differ(one: Frame, other: Frame) -> bool:
    """Whether the same coordinates of two pictures are different places on their pages."""

    boxes = np.array([frame.page or (0.0, 0.0, 0.0, 0.0) for frame in (one, other)])
    same = np.allclose(boxes[0], boxes[1], 0.0, SAME_PAGE * np.abs(boxes).max())
    return not same or (one.width, one.height) != (other.width, other.height)
