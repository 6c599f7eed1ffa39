"""`nested-cages puppet PAINTING -o SCENE`: a layered painting as a puppet for a game engine."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ..errors import NestedCagesError
from ..formats import read_whole, write_whole
from ..game import (
    ENGINES,
    HULL_VERTICES,
    GamePuppet,
    engine_for,
    from_puppet_json,
    game_puppet,
    read_painting,
    repainted,
    to_puppet_json,
    undrawn,
    write_puppet,
)
from ..game.kept import KEPT_LIMITS
from ..game.vector import LONGER_SIDE
from ..puppet import PartChoice
from .options import at_least
from .progress import tell

DESCRIPTION = """\
Makes a puppet of a layered painting: .psd, .psb, .ora, .kra, .svg, or a folder of .png by the order of their names.
Each layer becomes a textured mesh whose hull is certified around every opaque pixel, with bones where parts overlap,
weights, and for each joint the angles within which nothing folds, proved."""

EPILOG = """\
output files, by their names, several at once:
  NAME.tscn       a scene of Godot 4, with NAME.png
  NAME.json       Spine 4.2, with NAME.atlas and NAME.png
  NAME_ske.json   DragonBones 5.5, with NAME_tex.json and NAME.png

examples:
  nested-cages puppet cat.psd -o cat.tscn
  nested-cages puppet cat.psd -o cat.tscn --keep cat.puppet.json
  nested-cages puppet cat.kra -o cat.tscn --vertices 24 --parent hat=head --bones tail=4
"""


def make_puppet(arguments: Sequence[str]) -> bool:
    """Run the command; whether it failed."""
    given = _puppet_options().parse_args(arguments)
    try:
        engines = [given.engine or engine_for(path) for path in given.output]
        puppet, notes = _puppet(given)
        for note in (*notes, *puppet.notes):
            tell(f"note: {note}", sys.stderr)
        _tell_bones(puppet)
        if given.keep is not None:
            write_whole(given.keep, to_puppet_json(puppet))
        for path, engine in zip(given.output, engines, strict=True):
            for note in undrawn(puppet, engine):
                tell(f"note: {note}", sys.stderr)
            for file in write_puppet(path, puppet, engine):
                tell(f"Wrote {file}", sys.stdout)
    except OSError as error:
        tell(f"error: {error.filename or given.painting}: {error.strerror or error}", sys.stderr)
        return True
    except NestedCagesError as error:
        tell(f"error: {error}", sys.stderr)
        return True
    return False


def _puppet(given: argparse.Namespace) -> tuple[GamePuppet, tuple[str, ...]]:
    """The puppet of a painting, and what its reader says."""
    parts, size, notes = read_painting(given.painting, hidden=given.hidden, pixels=given.pixels)
    stem = Path(given.painting).resolve().stem
    if given.keep is None or not Path(given.keep).exists():
        return game_puppet(parts, size, name=stem, vertices=given.vertices, choices=_choices(given)), notes
    before = from_puppet_json(read_whole(given.keep, KEPT_LIMITS))
    puppet, changes = repainted(before, parts, size, vertices=given.vertices)
    return puppet, (*notes, *changes.sentences)


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


def _setting_of_part(text: str) -> tuple[str, str]:
    name, equals, value = text.rpartition("=")
    if not equals or not name:
        raise argparse.ArgumentTypeError(f"PART=VALUE is needed, not {text!r}")
    return name, value


def _puppet_options() -> argparse.ArgumentParser:
    options = argparse.ArgumentParser(
        prog="nested-cages puppet",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    options.add_argument("painting", metavar="PAINTING")
    options.add_argument("-o", "--output", nargs="+", required=True, metavar="FILE", help="files to write")
    options.add_argument("--engine", choices=tuple(ENGINES), help="the engine (default: by the names of the files)")
    options.add_argument(
        "--vertices",
        type=at_least(4),
        default=HULL_VERTICES,
        metavar="N",
        help=f"of the hull of a part; joints and small islands aside (default: {HULL_VERTICES})",
    )
    options.add_argument(
        "--keep",
        metavar="FILE.json",
        help="keep the bones, names, order and keys of this puppet when its painting changed; written each time",
    )
    options.add_argument("--hidden", action="store_true", help="include hidden layers, as hidden parts")
    options.add_argument(
        "--parent", type=_setting_of_part, action="append", metavar="PART=PARENT", help="what a part hangs on"
    )
    options.add_argument(
        "--bones", type=_setting_of_part, action="append", metavar="PART=N", help="how many bones bend a part"
    )
    options.add_argument(
        "--pixels",
        type=at_least(1),
        default=LONGER_SIDE,
        metavar="N",
        help=f"of an .svg: pixels of its longer side (default: {LONGER_SIDE})",
    )
    return options
