"""The letter A rigged and waving: an armature moves the few vertices of a cage, and the drawing follows.

Run as ``python examples/waving.py``; needs Blender as a Python module. Writes the file with the rig, which moves in any
Blender without the add-on, a picture, and a GIF (for which it needs Pillow).
"""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np

from check_animation import played
from clip import join
from demo import BODY, CAGES, COARSE, DOT, INK, LINE, import_drawing
from extension import PACKAGE, registered
from picture import Colour, Fill, Outline, Panel, colour, extent, render

BUILD = Path(__file__).resolve().parent.parent / "build" / "stories"
LEVELS = "60, 24"
# Bones by name: parent, head and tail in metres. The letter's arms are thin: two bones each, and one for the rest.
BONES = {
    "body": (None, (0.62, 0.62), (0.62, 1.02)),
    "upper arm": ("body", (0.45, 0.87), (0.28, 0.98)),
    "forearm": ("upper arm", (0.28, 0.98), (0.16, 1.20)),
    "other upper arm": ("body", (0.80, 1.00), (1.02, 0.80)),
    "other forearm": ("other upper arm", (1.02, 0.80), (1.16, 0.95)),
    "leg": ("body", (0.46, 0.56), (0.25, 0.30)),
    "foot": ("leg", (0.25, 0.30), (0.32, 0.16)),
    "other leg": ("body", (0.88, 0.58), (0.98, 0.18)),
}
PERIOD = 24  # frames of one wave
# Radians about the axis that points out of the drawing: rest, swing, and how many swings there are in a period.
WAVES = {
    "body": (0.0, 0.05, 1),
    "upper arm": (-0.25, 0.12, 1),
    "forearm": (-0.15, 0.55, 2),
    "other upper arm": (0.0, 0.18, 1),
    "other forearm": (0.0, 0.25, 1),
    "leg": (0.0, -0.05, 1),
    "foot": (0.0, 0.10, 1),
    "other leg": (0.0, -0.05, 1),
}
SHARPNESS = 4  # power of the distance to a bone by which its weight falls
SHOWN = (3 / 8, 1 / 8)  # moments of a period in the picture
PIXELS, SAMPLES, MOMENT = 400, 6, 60  # of the GIF: width, samples per pixel, milliseconds of a picture
BONE: Colour = colour("#ffffff")


def loops_of(item: bpy.types.Object) -> list[np.ndarray]:
    """Vertex indices (k,) along each loop of a mesh of edges."""
    onward = dict(edge.vertices for edge in item.data.edges)
    loops = []
    while onward:
        start, vertex = onward.popitem()
        loop = [start]
        while vertex != start:
            loop.append(vertex)
            vertex = onward.pop(vertex)
        loops.append(np.array(loop))
    return loops


def points_at(item: bpy.types.Object, frame: float) -> np.ndarray:
    """(n, 2) vertices of a mesh object as Blender shows it on a frame."""
    bpy.context.scene.frame_set(int(frame), subframe=frame % 1)
    mesh = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return np.array([item.matrix_world @ vertex.co for vertex in mesh.vertices])[:, :2]


def rig() -> bpy.types.Object:
    """An armature with the bones, in the plane of the drawing."""
    made = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(made)
    bpy.context.view_layer.objects.active = made
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (parent, head, tail) in BONES.items():
        bone = made.data.edit_bones.new(name)
        bone.head, bone.tail = (*head, 0.0), (*tail, 0.0)
        bone.align_roll((0.0, 0.0, 1.0))  # so that turning about a bone's z stays in the plane
        bone.parent = made.data.edit_bones[parent] if parent else None
    bpy.ops.object.mode_set(mode="OBJECT")
    return made


def bind_to_bones(cage: bpy.types.Object, made: bpy.types.Object) -> None:
    """Weighs every vertex of the cage by its distance from each bone, and adds the Armature modifier."""
    points = points_at(cage, bpy.context.scene.frame_current)
    shares = np.stack([distance(points, np.array(head), np.array(tail)) for _, head, tail in BONES.values()], axis=1)
    shares = np.maximum(shares, 1e-3) ** -SHARPNESS
    shares /= shares.sum(axis=1, keepdims=True)
    for name, column in zip(BONES, shares.T, strict=True):
        group = cage.vertex_groups.new(name=name)
        for vertex, share in enumerate(column.tolist()):
            group.add([vertex], share, "REPLACE")
    cage.modifiers.new("Rig", "ARMATURE").object = made


def distance(points: np.ndarray, head: np.ndarray, tail: np.ndarray) -> np.ndarray:
    """(n,) from points (n, 2) to the segment of a bone."""
    along = tail - head
    t = ((points - head) @ along / (along @ along)).clip(0.0, 1.0)
    return np.linalg.norm(points - head - t[:, None] * along, axis=1)


def wave(made: bpy.types.Object) -> None:
    """Keys on every other frame of a period; it plays again and again."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, PERIOD
    for name, (rest, swing, times) in WAVES.items():
        bone = made.pose.bones[name]
        bone.rotation_mode = "XYZ"
        for frame in range(0, PERIOD + 1, 2):
            bone.rotation_euler.z = rest + swing * np.sin(2.0 * np.pi * times * frame / PERIOD)
            bone.keyframe_insert("rotation_euler", frame=1 + frame)


def bones_at(made: bpy.types.Object, frame: float) -> list[np.ndarray]:
    """Thin rhombs (4, 2) along the bones, as Blender draws them."""
    bpy.context.scene.frame_set(int(frame), subframe=frame % 1)
    rhombs = []
    for bone in made.pose.bones:
        head, tail = (np.array(made.matrix_world @ place)[:2] for place in (bone.head, bone.tail))
        side = 0.08 * np.array([head[1] - tail[1], tail[0] - head[0]])
        wide = head + 0.15 * (tail - head)
        rhombs.append(np.stack([head, wide - side, tail, wide + side]))
    return rhombs


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--output", type=Path, default=BUILD, help="folder for the files (default: build/stories)")
    options.add_argument("--small", action="store_true", help="a small form that takes a few seconds")
    given = options.parse_args()
    given.output.mkdir(parents=True, exist_ok=True)

    import_drawing()
    with registered():
        bpy.ops.object.nested_cages_generate(levels=LEVELS)
        (made_of_it,) = played()
        levels = [made_of_it.fine, *made_of_it.cages]
        loops = [loops_of(item) for item in levels]
        bpy.ops.object.nested_cages_bind()
    fine, cage = levels[0], levels[-1]
    made = rig()
    bind_to_bones(cage, made)
    wave(made)
    bpy.ops.wm.save_as_mainfile(filepath=str(given.output.resolve() / "waving.blend"), compress=True)

    def shapes(frame: float, *, with_rig: bool) -> list[Fill | Outline]:
        body, around = (points_at(item, frame) for item in (fine, cage))
        drawn: list[Fill | Outline] = [
            Fill([body[k] for k in loops[0]], BODY),
            Outline([body[k] for k in loops[0]], INK, LINE),
        ]
        if with_rig:
            drawn.append(Outline([around[k] for k in loops[-1]], COARSE, 0.7 * LINE, DOT))
            for rhomb in bones_at(made, frame):
                drawn += [Fill([rhomb], BONE), Outline([rhomb], CAGES[0], 0.5 * LINE)]
        return drawn

    poses = np.arange(1.0, PERIOD + 1, 6.0 if given.small else 0.5)
    outside = [left_outside(points_at(fine, t), [points_at(cage, t)[k] for k in loops[-1]]) for t in poses]
    print(f"{len(cage.data.vertices)} vertices move {len(fine.data.vertices)}: in {len(poses)} poses", end=" ")
    print(f"at most {max(outside)} of them leave the cage")
    first, second = (1.0 + share * PERIOD for share in SHOWN)
    count = len(cage.data.vertices)
    panels = [Panel(f"an armature moves {count} vertices", shapes(first, with_rig=True))]
    panels += [Panel("and the drawing follows", shapes(first, with_rig=False))]
    panels += [Panel("through its wave", shapes(second, with_rig=True))]
    pixels, samples = (220, 1) if given.small else (PIXELS, 24)
    render(given.output / "waving.png", panels, pixels=pixels, samples=samples)
    print(f"Wrote {given.output / 'waving.png'}")
    if not given.small:
        clip(given.output, [Panel("", shapes(1.0 + k, with_rig=True)) for k in range(PERIOD)])


def left_outside(points: np.ndarray, loops: list[np.ndarray]) -> int:
    """How many points (n, 2) are not inside loops (k, 2)."""
    winding_number = import_module(f"{PACKAGE}.nestedcages_core.geometry.predicates").winding_number
    following = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    return int((winding_number(points, np.concatenate(loops), following) == 0).sum())


def clip(folder: Path, panels: list[Panel]) -> None:
    """The pictures of one period as a GIF that repeats."""
    stills = folder / "waving"
    stills.mkdir(exist_ok=True)
    corners = extent(panels)
    paths = [stills / f"{number:02}.png" for number in range(len(panels))]
    for path, panel in zip(paths, panels, strict=True):
        render(path, [panel], corners=corners, pixels=PIXELS, samples=SAMPLES)
    join(paths, [MOMENT] * len(paths), folder / "waving.gif")
    print(f"Wrote {folder / 'waving.gif'}")


if __name__ == "__main__":
    main()
