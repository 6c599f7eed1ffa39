"""Game engines: which files each one reads, and writing them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from ...errors import invalid_setting
from ...formats import write_files
from ...formats.pictures import encode_png
from .atlas import Atlas, atlas_of
from .godot import to_godot
from .puppet import GamePuppet
from .script import to_script
from .spine import to_spine, to_spine_atlas

PICTURE = "{stem}.png"
"""Name of the atlas, next to the other files."""

Writer = Callable[[GamePuppet, Atlas, str], str]
"""The text of a file for a puppet, its atlas, and the name of the atlas's picture."""


@dataclass(frozen=True)
class Engine:
    """A program that plays puppets."""

    title: str
    files: Mapping[str, Writer]
    """What writes each file, by its name with {stem}; the first is the one that a user names."""
    blends: tuple[str, ...]
    """Blend modes that it draws, other than normal."""

    @property
    def ending(self) -> str:
        """How the name of the file ends that a user names."""
        return next(iter(self.files)).removeprefix("{stem}")


ENGINES: Mapping[str, Engine] = {
    "godot": Engine("Godot 4", {"{stem}.tscn": to_godot}, ("add", "multiply")),
    "spine": Engine(
        "Spine 4.2",
        {"{stem}.json": lambda puppet, atlas, picture: to_spine(puppet, atlas), "{stem}.atlas": to_spine_atlas},
        ("add", "multiply", "screen"),
    ),
    "script": Engine(
        "own scripts",
        {"{stem}.puppet.json": to_script},
        ("add", "multiply", "screen"),
    ),
}
"""By the name that the command and Blender use."""


def engine_for(path: str | os.PathLike[str]) -> str:
    """The engine whose files are named like this. Raises NestedCagesError if there is none."""
    name = Path(path).name.lower()
    for key in sorted(ENGINES, key=lambda key: -len(ENGINES[key].ending)):
        if name.endswith(ENGINES[key].ending):
            return key
    endings = ", ".join(f"{engine.ending} for {engine.title}" for engine in ENGINES.values())
    raise invalid_setting(f"'{Path(path).name}' is no file of an engine: name it {endings}.")


def puppet_files(path: str | os.PathLike[str], puppet: GamePuppet, engine: str) -> dict[Path, str | bytes]:
    """The contents of a puppet's files, next to each other, by their paths; each after those that it refers to.

    engine: a key of `ENGINES`. Raises NestedCagesError.
    """
    kind, place = ENGINES[engine], Path(path)
    is_named = place.name.lower().endswith(kind.ending)
    stem = place.name[: -len(kind.ending)] if is_named else place.stem
    for animation in puppet.animations:
        animation.check(puppet.bones)
    atlas = atlas_of(puppet.meshes, puppet.place)
    picture = PICTURE.format(stem=stem)
    contents: dict[str, str | bytes] = {picture: encode_png(atlas.page)}
    for name, writer in reversed([*kind.files.items()]):
        contents[name.format(stem=stem)] = writer(puppet, atlas, picture)
    return {place.with_name(name): content for name, content in contents.items()}


def write_puppet(path: str | os.PathLike[str], puppet: GamePuppet, engine: str) -> list[Path]:
    """Write the files of a puppet as one unit; returns them, the named one first. Raises NestedCagesError, OSError."""
    contents = puppet_files(path, puppet, engine)
    write_files(contents)
    return [*reversed(contents)]


def undrawn(puppet: GamePuppet, engine: str) -> tuple[str, ...]:
    """Sentences about what an engine draws otherwise."""
    lost = [mesh for mesh in puppet.meshes if mesh.blend != "normal" and mesh.blend not in ENGINES[engine].blends]
    return tuple(f"{ENGINES[engine].title} draws {mesh.name} as normal, not as {mesh.blend}." for mesh in lost)
