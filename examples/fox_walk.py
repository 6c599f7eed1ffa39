"""A layered drawing walks as a puppet: the fox of examples/fox.svg, imported with bones, and *Walk*.

Run as ``python examples/fox_walk.py``; needs Blender as a Python module, and Pillow for the GIF. Writes the file, which
moves in any Blender without the add-on, a picture with the bones, and a GIF without them.
"""

from __future__ import annotations

import argparse
from math import pi
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from clip import join
from demo import CAGES
from extension import registered
from fox import FILE
from picture import colour

BUILD = Path(__file__).resolve().parent.parent / "build" / "stories"
PERIOD = 24  # frames of two steps
SKY, SHOWN, PIXELS, SAMPLES, MOMENT = "#dfeaf0", 7, 420, 8, 60  # background, frame, width, samples, milliseconds
MARGIN, SHAPE = 1.34, 0.66  # width of the picture in those of the fox, and height over width
BONE_WIDTH = 0.07  # of its length


def stage(path: Path, pixels: int, samples: int) -> None:
    """A camera in front of what is drawn, and what renders."""
    scene = bpy.context.scene
    seen = [obj for obj in scene.objects if obj.type == "MESH" and not obj.hide_render]
    corners = np.array([obj.matrix_world @ Vector(corner) for obj in seen for corner in obj.bound_box])
    low, high = corners.min(axis=0), corners.max(axis=0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera, camera.data.type, camera.data.ortho_scale = camera, "ORTHO", MARGIN * (high - low)[0]
    camera.location = (*(0.5 * (low + high))[:1], low[1] - 10.0 * (high - low)[0], 0.5 * (low + high)[2])
    camera.rotation_euler = (0.5 * pi, 0.0, 0.0)
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (*colour(SKY), 1.0)
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", samples, False
    scene.render.resolution_x, scene.render.resolution_y = pixels, round(SHAPE * pixels)
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = str(path)


def drawn_bones(armature: bpy.types.Object) -> bpy.types.Object:
    """The bones of a frame as rhombs in front of the drawing."""
    front = min(
        (obj.matrix_world @ Vector(corner)).y for obj in bpy.context.scene.objects if obj.type == "MESH"
        for corner in obj.bound_box
    )  # fmt: skip
    points, faces = [], []
    for bone in (each for each in armature.pose.bones if each.bone["nested_cages_part"]):
        head, tail = (armature.matrix_world @ end for end in (bone.head, bone.tail))
        along = tail - head
        side = BONE_WIDTH * Vector((-along.z, 0.0, along.x))
        rhomb = (head, head + 0.2 * along + side, tail, head + 0.2 * along - side)
        faces.append(range(len(points), len(points) + 4))
        points += [(point.x, front - 0.01, point.z) for point in rhomb]
    data = bpy.data.meshes.new("Bones")
    data.from_pydata(points, [], [list(face) for face in faces])
    material = bpy.data.materials.new("Bones")
    nodes = material.node_tree.nodes if material.node_tree else None
    if nodes is None:
        material.use_nodes = True
        nodes = material.node_tree.nodes
    nodes.clear()
    glow, end = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    glow.inputs[0].default_value = (*CAGES[0], 1.0)
    material.node_tree.links.new(glow.outputs[0], end.inputs[0])
    data.materials.append(material)
    shown = bpy.data.objects.new("Bones", data)
    bpy.context.scene.collection.objects.link(shown)
    return shown


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--output", type=Path, default=BUILD, help="folder for the files (default: build/stories)")
    options.add_argument("--small", action="store_true", help="a small form that takes a few seconds")
    given = options.parse_args()
    folder = given.output.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_homefile(use_empty=True)
    with registered():
        bpy.ops.object.nested_cages_import(filepath=str(FILE), outlines="PUPPET")
        armature = bpy.context.object
        bpy.ops.object.nested_cages_clip(kind="WALK")
        bpy.context.scene.frame_end = PERIOD
        bpy.ops.object.nested_cages_verify(whole=True)
        bpy.ops.object.mode_set(mode="OBJECT")
    bones = [bone for bone in armature.data.bones if bone["nested_cages_part"]]
    least = min(min(-bone["nested_cages_proved"][0], bone["nested_cages_proved"][1]) for bone in bones)
    print(f"{len(bones)} bones; nothing folds within {least:.0f} degrees of a joint that bends")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "fox_walk.blend"), compress=True)
    stage(folder / "fox_walk.png", 340 if given.small else 2 * PIXELS, 2 if given.small else 24)
    bpy.context.scene.frame_set(SHOWN)
    shown = drawn_bones(armature)
    bpy.ops.render.render(write_still=True)
    bpy.data.objects.remove(shown)
    print(f"Wrote {given.output / 'fox_walk.png'}")
    if not given.small:
        stills = folder / "fox_walk"
        stills.mkdir(exist_ok=True)
        scene = bpy.context.scene
        scene.render.resolution_x, scene.render.resolution_y = PIXELS, round(SHAPE * PIXELS)
        scene.cycles.samples = SAMPLES
        paths = [stills / f"{frame:02}.png" for frame in range(1, PERIOD + 1)]
        for frame, path in enumerate(paths, 1):
            scene.frame_set(frame)
            scene.render.filepath = str(path)
            bpy.ops.render.render(write_still=True)
        join(paths, [MOMENT] * PERIOD, folder / "fox_walk.gif")
        print(f"Wrote {given.output / 'fox_walk.gif'}")


if __name__ == "__main__":
    main()
