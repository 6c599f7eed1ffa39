"""`nested-cages puppet PAINTING -o SCENE`: a layered painting as a puppet for a game engine."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from ..errors import NestedCagesError
from ..formats import write_files
from ..puppets import GamePuppet, PartChoice, engine_for, game_puppet, puppet_files, read_painting, undrawn
from .options import at_least
from .printing import sentence_of, tell


def run(_: argparse.ArgumentParser, given: argparse.Namespace) -> bool:
    """Run the command; whether it failed."""
    try:
        engines = [given.engine or engine_for(path) for path in given.output]
        puppet, notes = _puppet(given)
        for note in (*notes, *puppet.notes):
            tell(f"note: {note}", sys.stderr)
        _tell_bones(puppet)
        contents: dict[Path, str | bytes] = {}
        for path, engine in zip(given.output, engines, strict=True):
            for note in undrawn(puppet, engine):
                tell(f"note: {note}", sys.stderr)
            contents |= puppet_files(path, puppet, engine)
        write_files(contents)
        for file in reversed(contents):
            tell(f"Wrote {file}", sys.stdout)
    except (OSError, NestedCagesError) as error:
        tell(f"error: {sentence_of(error, given.painting)}", sys.stderr)
        return True
    return False


def _puppet(given: argparse.Namespace) -> tuple[GamePuppet, tuple[str, ...]]:
    """The puppet of a painting, and what its reader says."""
    parts, size, notes = read_painting(given.painting, hidden=given.hidden, pixels=given.pixels)
    stem = Path(given.painting).resolve().stem
    return game_puppet(parts, size, name=stem, vertices=given.vertices, choices=_choices(given)), notes


def _choices(given: argparse.Namespace) -> dict[str, PartChoice]:
    """What the options say of parts."""
    choices: dict[str, PartChoice] = {}
    for part, parent in given.parent or ():
        choices[part] = replace(choices.get(part, PartChoice()), parent=parent)
    for part, count in given.bones or ():
        choices[part] = replace(choices.get(part, PartChoice()), bones=at_least(1)(count))
    return choices


def _tell_bones(puppet: GamePuppet) -> None:
    """Print the bones with their ranges, and how many vertices the meshes have."""
    count = sum(len(mesh.points) for mesh in puppet.meshes)
    tell(f"{puppet.name}: {len(puppet.meshes)} meshes with {count} vertices, {len(puppet.bones)} bones", sys.stdout)
    for bone, proved in zip(puppet.bones, puppet.ranges, strict=True):
        above = f" on {puppet.bones[bone.parent].name}" if bone.parent is not None else ""
        free = proved.low <= -180.0 and proved.high >= 180.0
        turns = "turns freely" if free else f"nothing folds from {proved.low:.1f}° to {proved.high:.1f}° (proved)"
        turns = turns if proved.low < proved.high else "nothing is proved of its weights"
        tell(f"  {bone.name}{above}: {turns}", sys.stdout)
