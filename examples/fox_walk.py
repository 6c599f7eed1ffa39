"""A layered drawing walks as a puppet: the fox of examples/fox.svg, imported with bones, and *Walk*.

Run as ``python examples/fox_walk.py``; needs Blender as a Python module. Writes the file, which moves in any Blender
without the add-on, a picture with the bones, and the frames of a clip without them.
"""

from __future__ import annotations

import argparse
from math import pi
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from demo import CAGES
from extension import ROOT, registered
from picture import colour, glowing, use_cycles

PERIOD = 24  # frames of two steps
SKY, SHOWN, PIXELS = "#dfeaf0", 7, 420  # background, frame of the picture, width of the clip
MARGIN, SHAPE = 1.34, 0.66  # width of the picture in those of the fox, and height over width
BONE_WIDTH = 0.07  # of its length


def corners() -> np.ndarray:
    """Corners (n, 3) of the boxes around all that is rendered."""
    seen = [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and not obj.hide_render]
    return np.array([obj.matrix_world @ Vector(corner) for obj in seen for corner in obj.bound_box])


def render(path: Path, pixels: int, samples: int) -> None:
    """Render the current frame."""
    use_cycles(bpy.context.scene, (pixels, round(SHAPE * pixels)), samples)
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def add_camera() -> None:
    """A camera in front of the fox, and the sky."""
    scene = bpy.context.scene
    low, high = corners().min(axis=0), corners().max(axis=0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera, camera.data.type, camera.data.ortho_scale = camera, "ORTHO", MARGIN * (high - low)[0]
    camera.location = ((low + high)[0] / 2.0, low[1] - 10.0 * (high - low)[0], (low + high)[2] / 2.0)
    camera.rotation_euler = (0.5 * pi, 0.0, 0.0)
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (*colour(SKY), 1.0)


def add_bones(armature: bpy.types.Object) -> bpy.types.Object:
    """The bones of a frame as rhombs in front of the drawing."""
    front = corners()[:, 1].min() - 0.01
    points: list[tuple[float, float, float]] = []
    for bone in (each for each in armature.pose.bones if each.bone["nested_cages_part"]):
        head, tail = (armature.matrix_world @ end for end in (bone.head, bone.tail))
        along = tail - head
        side = BONE_WIDTH * Vector((-along.z, 0.0, along.x))
        rhomb = (head, head + 0.2 * along + side, tail, head + 0.2 * along - side)
        points += [(point.x, front, point.z) for point in rhomb]
    data = bpy.data.meshes.new("Bones")
    data.from_pydata(points, [], np.arange(len(points)).reshape(-1, 4).tolist())
    data.materials.append(glowing(CAGES[0]))
    shown = bpy.data.objects.new("Bones", data)
    bpy.context.scene.collection.objects.link(shown)
    return shown


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--output", type=Path, default=ROOT / "build" / "stories", help="folder for the files")
    options.add_argument("--small", action="store_true", help="a small form that takes a few seconds")
    given = options.parse_args()
    folder = given.output.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_homefile(use_empty=True)
    with registered():
        bpy.ops.object.nested_cages_import(filepath=str(ROOT / "examples" / "fox.svg"), outlines="PUPPET")
        armature = bpy.context.object
        bpy.ops.object.nested_cages_walk()
        bpy.context.scene.frame_end = PERIOD
        bpy.ops.object.nested_cages_verify(whole=True)
        bpy.ops.object.mode_set(mode="OBJECT")
    proved = [bone["nested_cages_proved"] for bone in armature.data.bones if bone["nested_cages_part"]]
    least = min(min(-low, high) for low, high, *_ in proved)
    print(f"{len(proved)} bones; nothing folds within {least:.0f} degrees of a joint that bends")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "fox_walk.blend"), compress=True)
    add_camera()
    bpy.context.scene.frame_set(SHOWN)
    shown = add_bones(armature)
    render(folder / "fox_walk.png", 340 if given.small else 2 * PIXELS, 2 if given.small else 24)
    bpy.data.objects.remove(shown)
    print(f"Wrote {given.output / 'fox_walk.png'}")
    for frame in () if given.small else range(1, PERIOD + 1):
        bpy.context.scene.frame_set(frame)
        render(folder / "fox_walk" / f"{frame:02}.png", PIXELS, 8)


if __name__ == "__main__":
    main()
