"""Cages around every drawing of a scene, and one file per drawing, in Blender without a window.

Run as ``python examples/one_file_each.py``; needs Blender as a Python module. Writes one SVG per letter, the letter and
its cages, to build/stories/letters, or to the folder given with ``--output``.
"""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

import bpy

from extension import PACKAGE, registered

BUILD = Path(__file__).resolve().parent.parent / "build" / "stories" / "letters"
LETTERS = "AQR&€π"
LEVELS = (0.4, 12)  # two fifths of the drawing's vertices, and then twelve


def draw(letters: str) -> list[bpy.types.Object]:
    """An empty scene with a text for each letter."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    made = []
    for place, letter in enumerate(letters):
        data = bpy.data.curves.new(letter, "FONT")
        data.body = letter
        obj = bpy.data.objects.new(letter, data)
        obj.location.x = float(place)
        bpy.context.scene.collection.objects.link(obj)
        made.append(obj)
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=BUILD)
    folder: Path = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    with registered():
        nested_cages = import_module(PACKAGE)  # in Blender: from bl_ext.user_default import nested_cages
        drawings = draw(LETTERS)
        for drawing, made in zip(drawings, nested_cages.cages(drawings, LEVELS, clearance=0.005), strict=True):
            path = folder / f"{ord(drawing.name):04x}.svg"
            with bpy.context.temp_override(selected_objects=[drawing, *made]):
                bpy.ops.object.nested_cages_export(filepath=str(path), kind="SVG")
            excess = 100.0 * made.certificates[-1].excess
            print(f"{drawing.name}: {len(made)} cages, the last with an excess of {excess:.1f} %, in {path.name}")


if __name__ == "__main__":
    main()
