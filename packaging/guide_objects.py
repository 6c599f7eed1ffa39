"""Pictures of the guide: what the Object menu offers, Live, and a message of the panel. Run by guide_pictures.py."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from guide_window import (
    Picture,
    Steps,
    clear,
    generate,
    letter,
    look,
    only,
    outline,
    override,
    put,
    region_box,
    shoot,
    sidebar,
    spline,
    view,
)
from mathutils import Vector


def live() -> Steps:
    yield from clear()
    angles = np.arange(12) / 6.0 * np.pi
    radius = np.where(np.arange(12) % 2, 0.62, 1.0)[:, None]
    leaf = spline("Leaf", radius * np.column_stack((np.cos(angles), np.sin(angles))), bezier=True)
    look(3.4)
    yield from sidebar()
    generate(levels="32")
    only(leaf)
    with override():
        bpy.ops.object.nested_cages_live("EXEC_DEFAULT")
    leaf.data.splines[0].bezier_points[0].handle_right_type = "FREE"
    leaf.data.splines[0].bezier_points[0].select_right_handle = True
    with override():
        bpy.ops.object.mode_set(mode="EDIT")
    for _ in range(8):  # as a handle is dragged
        leaf.data.splines[0].bezier_points[0].handle_right += Vector((0.03, 0.06, 0.0))
        leaf.data.update_tag()
        yield 0.2
    yield 2.0
    yield from shoot("live", (56, 85, 1035, 720))


def cutout() -> Steps:
    yield from clear()
    with tempfile.TemporaryDirectory() as folder:
        image = fish()
        image.filepath_raw, image.file_format = str(Path(folder) / "fish.png"), "PNG"
        image.save()
        with override():
            bpy.ops.object.nested_cages_cutout("EXEC_DEFAULT", filepath=image.filepath_raw, levels="16")
            bpy.ops.object.mode_set(mode="POSE")
    bones = bpy.context.object.pose.bones
    size = max(np.ptp([tuple(bone.bone.head_local) for bone in bones], axis=0))
    for bone in bones:
        if bone.bone.head_local.x > 0.62 * max(each.bone.head_local.x for each in bones):
            bone.matrix.translation.y += 0.2 * size
    shading = view()[1].spaces.active.shading
    shading.color_type, shading.light = "TEXTURE", "FLAT"
    look(1.5 * size)
    yield 1.0
    yield from shoot("cutout", (56, 85, 775, 720))


def fish(size: int = 512) -> Any:
    """An image with a transparent background."""
    y, x = np.mgrid[-1.0 : 1.0 : size * 1j, -1.0 : 1.0 : size * 1j]
    pixels = np.zeros((size, size, 4), np.float32)
    body = np.hypot((x + 0.2) / 0.65, y / 0.36) < 1.0
    tail = (x > 0.3) & (x < 0.85) & (np.abs(y) < 0.08 + 0.55 * (x - 0.35))
    fins = (np.abs(x + 0.1 + 0.35 * np.abs(y)) < 0.5 * (0.6 - np.abs(y))) & (np.abs(y) < 0.6)
    pixels[tail | fins] = (0.85, 0.32, 0.1, 1.0)
    pixels[body] = (0.97, 0.55, 0.2, 1.0)
    pixels[body & (np.abs((x + 0.32) % 0.3 - 0.15) < 0.05) & (x > -0.35)] = (1.0, 0.9, 0.8, 1.0)
    for radius, colour in ((0.09, (1.0, 1.0, 1.0, 1.0)), (0.045, (0.05, 0.05, 0.1, 1.0))):
        pixels[np.hypot(x + 0.6, y - 0.08) < radius] = colour
    image = bpy.data.images.new("fish", size, size, alpha=True)
    image.pixels.foreach_set(pixels.ravel())
    return image


def silhouette() -> Steps:
    yield from clear()
    angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    circle = np.column_stack((np.cos(angles), np.sin(angles)))
    parts = [
        outline(name, circle * size + place)
        for name, size, place in (
            ("Arm L", (0.5, 0.15), (-0.65, 0.2)),
            ("Arm R", (0.5, 0.15), (0.65, 0.2)),
            ("Head", (0.45, 0.45), (0.0, 1.15)),
            ("Body", (0.6, 0.85), (0.0, 0.0)),
        )
    ]
    colours = ((0.65, 0.4, 0.35), (0.65, 0.4, 0.35), (0.7, 0.65, 0.55), (0.35, 0.5, 0.65))
    for k, (obj, colour) in enumerate(zip(parts, colours, strict=True)):
        obj.color, obj.location.z = (*colour, 1.0), 0.01 * k
    parts.insert(0, hat())
    only(*parts)
    with override():
        bpy.ops.object.nested_cages_silhouette("EXEC_DEFAULT", plane="TOP")
    made = bpy.context.object
    made.location.x = 2.6
    made.color = (0.35, 0.5, 0.65, 1.0)
    generate(levels="32", clearance=0.04)
    look(6.4, (1.5, 0.6))
    yield from sidebar()
    yield from shoot("silhouette", (56, 85, 775, 720))


def hat() -> Any:
    """A stroke of Grease Pencil."""
    data = bpy.data.grease_pencils_v3.new("Hat")
    drawing = data.layers.new("Layer").frames.new(1).drawing
    drawing.add_strokes([5])
    places = ((-0.55, 1.55), (-0.25, 1.7), (0.0, 2.1), (0.25, 1.7), (0.55, 1.55))
    for point, (x, y) in zip(drawing.strokes[0].points, places, strict=True):
        point.position, point.radius = (x, y, 0.05), 0.07
    material = bpy.data.materials.new("Ink")
    bpy.data.materials.create_gpencil_data(material)
    material.grease_pencil.color = (0.3, 0.08, 0.4, 1.0)
    data.materials.append(material)
    return put(bpy.data.objects.new("Hat", data))


def message() -> Steps:
    yield from clear()
    spline("Line", np.array([(-1.0, -0.6), (-0.4, 0.7), (0.4, -0.3), (1.0, 0.6)]), closed=False)
    look(3.0)
    yield from sidebar()
    yield 1.0
    # an error opens its window only for a button that a mouse has pressed
    subprocess.run(["xdotool", "mousemove", "900", "228", "sleep", "0.5", "click", "1"], check=True)
    yield 2.0
    yield from shoot("message", (450, 160, 1035, 345))


def image_dialog() -> Steps:
    yield from clear()
    fish(128)
    yield from sidebar()
    yield 0.5
    with override():
        bpy.ops.object.nested_cages_from_image("INVOKE_DEFAULT", image="fish")
    yield from shoot("image_dialog", (340, 340, 690, 585))


def export() -> Steps:
    yield from clear()
    letter()
    generate(levels="20%, 8%")
    yield 0.5
    with override():
        bpy.ops.object.nested_cages_export("INVOKE_DEFAULT", filepath="//letter.json", kind="ENGINE")
    yield 2.0
    yield from shoot("export", region_box(230, "FILE_BROWSER", "TOOL_PROPS"))


OBJECTS: tuple[Picture, ...] = (live, cutout, silhouette, message, image_dialog, export)
