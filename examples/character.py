"""A layered SVG waves and walks: twelve parts, imported with their colours, in one cage that suggested bones move.

Run as ``python examples/character.py``; needs Blender as a Python module. Writes the SVG that it draws, the file with
the rig, which moves in any Blender without the add-on, a picture, and a GIF (for which it needs Pillow). *Verify*
certifies both actions: that every part stays in its cage on every frame, and that no limb folds over itself.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

from clip import join
from demo import CAGES
from extension import PACKAGE, registered
from picture import aim, discs, line, remove, set_up
from waving import points_at

BUILD = Path(__file__).resolve().parent.parent / "build" / "stories"
SKIN, SHIRT, TROUSERS, DARK, HAIR = "#f2c098", "#d55e5e", "#3a5fa8", "#2b2b33", "#6b3f2a"
# Limbs from the lowest to the highest: layer, name, fill, start, end and radius, in hundredths of a metre.
LIMBS = (
    ("legs", "Leg.L", TROUSERS, (22, 0), (30, -118), 17),
    ("legs", "Leg.R", TROUSERS, (-22, 0), (-30, -118), 17),
    ("legs", "Shoe.L", DARK, (31, -136), (52, -136), 13),
    ("legs", "Shoe.R", DARK, (-31, -136), (-52, -136), 13),
    ("arms", "Arm.L", SHIRT, (30, 96), (98, 92), 14),
    ("arms", "Arm.R", SHIRT, (-30, 96), (-98, 92), 14),
    ("arms", "Hand.L", SKIN, (108, 92), (158, 90), 13),
    ("arms", "Hand.R", SKIN, (-108, 92), (-158, 90), 13),
    ("body", "Shirt", SHIRT, (0, 18), (0, 82), 40),
    ("head", "Head", SKIN, (0, 152), (0, 160), 42),
)
HAIR_PATH = "M-45,-160 C-52,-225 52,-225 45,-160 C25,-186 -10,-192 -45,-160 Z"
EYE = "a6,7 0 1 0 12,0 a6,7 0 1 0 -12,0 Z"
FACE_PATH = f"M-22,-158 {EYE} M10,-158 {EYE} M-14,-138 Q0,-118 14,-138 Z"
PERIOD = 24  # frames of one wave, and of two steps
# What turns: a place near the middle of a bone, in metres, and degrees at rest, of its swing, and swings in a period.
WAVE = (
    ((0.0, 1.4), 0.0, 4.0, 1),
    ((0.6, 0.94), 22.0, 5.0, 1),
    ((1.35, 0.91), 28.0, 26.0, 2),
    ((-0.6, 0.94), 30.0, 4.0, 1),
    ((-1.35, 0.91), 12.0, 8.0, 1),
    ((0.26, -0.7), 0.0, 3.0, 1),
    ((-0.26, -0.7), 0.0, 3.0, 1),
)
WALK = (
    ((0.0, 0.5), 0.0, 3.0, 1),
    ((0.0, 1.4), 0.0, -5.0, 1),
    ((0.6, 0.94), -26.0, 9.0, 1),
    ((1.35, 0.91), -22.0, 9.0, 1),
    ((-0.6, 0.94), 26.0, 9.0, 1),
    ((-1.35, 0.91), 22.0, 9.0, 1),
    ((0.24, -0.3), 5.0, 9.0, 1),
    ((0.29, -0.9), 0.0, -9.0, 1),
    ((-0.24, -0.3), -5.0, 9.0, 1),
    ((-0.29, -0.9), 0.0, -9.0, 1),
)
RISE = 0.06  # of the body in each step, in metres
SHOWN = 4  # frame of the picture
PIXELS, SAMPLES, MOMENT = 300, 8, 70  # of the GIF: width, samples per pixel, milliseconds of a picture
LOW, SIZE = np.array([-2.0, -1.65]), np.array([4.0, 3.9])  # corner and size of the picture, in metres
LINES = 0.1  # height of the cage above all parts


@dataclass(frozen=True)
class Figure:
    """Parts, the armature that moves them, and the cage around them."""

    parts: list[bpy.types.Object]
    armature: bpy.types.Object
    cage: bpy.types.Object


def drawn() -> str:
    """The character as a layered SVG, with its strokes in a style sheet."""
    layers: dict[str, list[str]] = {}
    for layer, name, fill, start, end, radius in LIMBS:
        a, b = np.array(start, float), np.array(end, float)
        along = (b - a) / np.hypot(*(b - a)) * radius
        side = np.array([-along[1], along[0]])
        p, q, r, s = (f"{x:.2f},{-y:.2f}" for x, y in (a + side, b + side, b - side, a - side))
        arc = f"A{radius},{radius} 0 0 1"
        shape = f'<path id="{name}" fill="{fill}" d="M{p} L{q} {arc} {r} L{s} {arc} {p} Z"/>'
        layers.setdefault(layer, []).append(shape)
    layers["head"] += [f'<path id="Hair" fill="{HAIR}" d="{HAIR_PATH}"/>']
    layers["head"] += [f'<path id="Face" fill="{DARK}" stroke="none" d="{FACE_PATH}"/>']
    groups = "".join(f'<g id="{layer}" class="ink">{"".join(shapes)}</g>' for layer, shapes in layers.items())
    style = f".ink {{ stroke: {DARK}; stroke-width: 4; stroke-linejoin: round }}"
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-200 -225 400 390"><style>{style}</style>{groups}</svg>'


def made(path: Path) -> Figure:
    """The parts of an SVG, the armature that moves them, and their cage: three actions."""
    bpy.ops.object.nested_cages_import(filepath=str(path), outlines="PARTS", plane="XY", centre=False)
    parts = list(bpy.context.selected_objects)
    bpy.ops.object.nested_cages_suggest_bones()
    armature = bpy.context.object
    bpy.ops.object.nested_cages_rig()
    bpy.ops.object.mode_set(mode="OBJECT")
    (cage,) = import_module(PACKAGE).CageSet.of(parts[0]).cages
    return Figure(parts, armature, cage)


def play(armature: bpy.types.Object, name: str, turns: tuple, rise: float = 0.0) -> None:
    """A new action of the armature with keys on every other frame of a period; it plays again and again."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, PERIOD
    armature.animation_data_clear()
    for bone in armature.pose.bones:
        bone.matrix_basis = Matrix()
    bpy.context.view_layer.update()
    middles = {bone: np.array(armature.matrix_world @ bone.center)[:2] for bone in armature.pose.bones}
    turning = [(min(middles, key=lambda bone: np.hypot(*(middles[bone] - place))), *turn) for place, *turn in turns]
    root = armature.pose.bones[0]
    for frame in range(0, PERIOD + 1, 2):
        for bone, rest, swing, times in turning:
            angle = np.deg2rad(rest + swing * np.sin(2.0 * np.pi * times * frame / PERIOD))
            local = bone.bone.matrix_local.to_3x3()
            turned = local.inverted() @ Matrix.Rotation(angle, 3, "Z") @ local
            bone.rotation_quaternion = turned.to_quaternion()
            bone.keyframe_insert("rotation_quaternion", frame=1 + frame)
        up = rise * abs(np.sin(2.0 * np.pi * frame / PERIOD))
        root.location = root.bone.matrix_local.to_3x3().inverted() @ Vector((0.0, up, 0.0))
        root.keyframe_insert("location", frame=1 + frame)
    armature.animation_data.action.name = name
    armature.animation_data.action.use_fake_user = True


def certified(cage: bpy.types.Object) -> tuple[bool, str]:
    """Whether everything stays in the cage on all frames without a fold, and what Verify says."""
    bpy.context.view_layer.objects.active = cage
    cage.select_set(True)
    bpy.ops.object.nested_cages_verify(whole=True)
    (certificate,) = import_module(PACKAGE).CageSet.of(cage).certificates
    return certificate.verdict.startswith("Holds"), certificate.finding


def border(cage: bpy.types.Object) -> np.ndarray:
    """(m, 2) edges of a filled mesh at which its area ends."""
    edges = [tuple(sorted(key)) for face in cage.data.polygons for key in face.edge_keys]
    found, counts = np.unique(edges, axis=0, return_counts=True)
    return found[counts == 1]


def still(path: Path, frame: int, figure: Figure, pixels: int, samples: int) -> None:
    """Renders a frame: the parts as they were imported, and the cage around them."""
    around = points_at(figure.cage, frame)
    scene = bpy.data.scenes.new("Picture")
    try:
        line(scene, list(around[border(figure.cage)] - LOW), CAGES[0], LINES, 0.022)
        discs(scene, around - LOW, CAGES[0], LINES, 0.04)
        aim(scene, SIZE[0], 0.0, SIZE[1])
        set_up(scene, path, (pixels, round(pixels * SIZE[1] / SIZE[0])), samples)
        scene.camera.location.x, scene.camera.location.y = LOW + 0.5 * SIZE
        for item in scene.objects:
            if item != scene.camera:
                item.location.x, item.location.y = LOW
        for part in figure.parts:
            scene.collection.objects.link(part)
        scene.frame_set(frame)
        bpy.ops.render.render(write_still=True, scene=scene.name)
    finally:
        for part in figure.parts:
            if part.name in scene.collection.objects:
                scene.collection.objects.unlink(part)
        remove(scene)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--output", type=Path, default=BUILD, help="folder for the files (default: build/stories)")
    options.add_argument("--small", action="store_true", help="a small form that takes a few seconds")
    given = options.parse_args()
    folder = given.output.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_homefile(use_empty=True)
    (folder / "character.svg").write_text(drawn(), encoding="utf-8")
    with registered():
        figure = made(folder / "character.svg")
        verdicts = {}
        for name, turns, rise in (("walk", WALK, RISE), ("wave", WAVE, 0.0)):
            play(figure.armature, name, turns, rise)
            verdicts[name] = certified(figure.cage)
            if name == "walk":
                clip(folder, "character_walk", figure, small=given.small)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "character.blend"), compress=True)
    print(f"{len(figure.parts)} parts, {len(figure.cage.data.vertices)} vertices, {PERIOD} frames")
    for name, (holds, sentence) in verdicts.items():
        print(f"{name}: {sentence}")
        if not holds:
            sys.exit(1)
    still(folder / "character.png", SHOWN, figure, 260 if given.small else 2 * PIXELS, 2 if given.small else 24)
    print(f"Wrote {given.output / 'character.png'}")
    clip(folder, "character", figure, small=given.small)


def clip(folder: Path, name: str, figure: Figure, *, small: bool) -> None:
    """The action as a GIF, unless only a small form is wanted."""
    if small:
        return
    stills = folder / name
    stills.mkdir(exist_ok=True)
    paths = [stills / f"{frame:02}.png" for frame in range(1, PERIOD + 1)]
    for frame, path in enumerate(paths, 1):
        still(path, frame, figure, PIXELS, SAMPLES)
    join(paths, [MOMENT] * PERIOD, folder / f"{name}.gif")
    print(f"Wrote {folder / name}.gif")


if __name__ == "__main__":
    main()
