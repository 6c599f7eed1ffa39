"""Makes the pictures of docs/guide that show a Blender window; run by Blender with a window of 1280 x 800 pixels:

    blender --factory-startup -p 0 0 1280 800 --python packaging/guide_pictures.py

All of them, or those named in the variable GUIDE_PICTURES, one after the other. Needs scipy in Blender's own Python,
and an X screen as large as the window for ImageMagick's `import`. Look at each picture before it is committed.
"""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).parent))

from guide_objects import OBJECTS
from guide_window import (
    GREEN,
    Picture,
    Steps,
    clear,
    coast,
    creature,
    generate,
    letter,
    look,
    only,
    outline,
    override,
    register_extension,
    shoot,
    sidebar,
    sign,
    view,
)

PICTURES: dict[str, Picture] = {build.__name__: build for build in OBJECTS}


def picture(build: Picture) -> Picture:
    """Register a picture: a generator of the seconds to wait before it goes on."""
    PICTURES[build.__name__] = build
    return build


@picture
def panel() -> Steps:
    yield from sign()
    yield from shoot("panel")


@picture
def result() -> Steps:
    yield from sign()
    generate(levels="20%, 8%")
    yield from shoot("result")


@picture
def blender_5_2() -> Steps:
    """The same in a later Blender, which makes this picture alone."""
    yield from sign()
    generate(levels="20%, 8%")
    yield from shoot("blender_5_2")


@picture
def levels() -> Steps:
    yield from sign()
    generate(levels="2 cm, +40 %")
    yield from shoot("levels")


@picture
def inside() -> Steps:
    yield from clear()
    obj = letter()
    look(2.6, (0.75, 0.7))
    yield from sidebar()
    generate(levels="24")
    only(obj)
    generate(levels="24", inside=True)
    yield from shoot("inside")


@picture
def shape() -> Steps:
    yield from clear("rules")
    points = creature()
    obj = outline("Creature", points)
    group = obj.vertex_groups.new(name="Beak")
    near = np.exp(-((np.hypot(*(points - points[24]).T) / 0.5) ** 2))
    for k, weight in enumerate(near):
        group.add([k], float(max(weight, 0.04)), "REPLACE")
    look(3.4)
    yield from sidebar()
    generate(levels="18", weight_group="Beak")
    with override():
        bpy.ops.object.nested_cages_remove_animation()
    yield from shoot("shape")


@picture
def pieces() -> Steps:
    yield from sign()
    generate(levels="30")
    with override():
        bpy.ops.object.nested_cages_pieces(most=6)
    for obj in bpy.data.objects:
        obj.hide_set("Piece" not in obj.name)
    yield from shoot("pieces", (0, 30, 775, 720))


@picture
def own_before() -> Steps:
    yield from _own()
    yield from shoot("own_before", (56, 85, 775, 720))


@picture
def own_after() -> Steps:
    yield from _own()
    generate(use_selected_as_levels=True)
    yield from shoot("own_after", (56, 85, 1035, 720))


def _own() -> Steps:
    yield from clear()
    drawing = letter("S")
    angles = np.linspace(0.0, 2.0 * np.pi, 14, endpoint=False)
    circle = np.column_stack([0.95 * np.cos(angles) + 0.58, 0.95 * np.sin(angles) + 0.7])
    only(outline("Mine", circle, filled=False), drawing)
    look(2.6, (0.6, 0.7))
    yield from sidebar()


@picture
def verify() -> Steps:
    yield from _broken()
    with override():
        bpy.ops.object.nested_cages_verify("EXEC_DEFAULT")
    only(bpy.data.objects["Letter &"])
    yield from shoot("verify", (56, 85, 1035, 720))


@picture
def faults() -> Steps:
    yield from _broken()
    with override():
        bpy.ops.object.nested_cages_verify("EXEC_DEFAULT")
        bpy.ops.object.mode_set(mode="EDIT")
    yield from shoot("faults", (56, 85, 775, 720))


def _broken() -> Steps:
    """A cage with one vertex in the letter."""
    yield from sign()
    generate(levels="20%, 8%")
    with override():
        bpy.ops.object.nested_cages_remove_animation()
    cage = bpy.data.objects["Letter & Cage 1"]
    places = np.array([tuple(vertex.co) for vertex in cage.data.vertices])
    k = int(np.argmax(places[:, 0] - 0.2 * places[:, 1]))
    cage.data.vertices[k].co.x -= 0.35
    cage.data.vertices[k].co.y += 0.12
    cage.data.update()
    yield 1.0


@picture
def use() -> Steps:
    yield from use_bound()
    yield from shoot("use")


def use_bound() -> Steps:
    """The letter, bound to its cages."""
    yield from sign()
    generate(levels="20%, 8%")
    with override():
        bpy.ops.object.nested_cages_bind("EXEC_DEFAULT")
    view()[1].spaces.active.overlay.wireframe_threshold = 0.5  # as the button does
    yield 1.5


@picture
def posed() -> Steps:
    yield from use_bound()
    cage = bpy.data.objects["Letter & Cage 2"]
    only(cage)
    with override():
        bpy.ops.object.nested_cages_add_handles("EXEC_DEFAULT")
        for bone in bpy.context.object.pose.bones:
            lean = Matrix.Translation((0.35 * bone.bone.head_local.y, 0.0, 0.0))
            bone.matrix = lean @ bone.matrix
    yield from shoot("posed")


@picture
def playing() -> Steps:
    yield from clear()
    letters = [letter(text) for text in ("A", "g", "&")]
    for obj, x, colour in zip(letters, (0.0, 1.6, 3.1), ((0.7, 0.35, 0.3), (0.3, 0.45, 0.7), GREEN[:3]), strict=True):
        obj.location.x, obj.color = x, (*colour, 1.0)
    only(*letters)
    look(4.6, (2.2, 0.6))
    yield from sidebar()
    generate(levels="40%, 30%")
    bpy.context.scene.frame_set(80)
    yield from shoot("playing")


@picture
def running() -> Steps:
    yield from clear()
    outline("Coast", coast())
    look(3.0)
    yield from sidebar()
    bpy.context.scene.nested_cages.levels = "200, 60"
    yield 1.0
    with override():
        bpy.ops.object.nested_cages_generate("INVOKE_DEFAULT", levels="200, 60")
    yield 1.2
    yield from shoot("running", (56, 85, 1035, 720))
    bpy.ops.object.nested_cages_cancel()
    yield 2.0


@picture
def redo() -> Steps:
    yield from sign()
    with override():
        bpy.ops.object.nested_cages_generate("EXEC_DEFAULT", True, levels="20%, 8%", fit_length=True)
    yield 2.0
    with override():
        bpy.ops.screen.redo_last("INVOKE_DEFAULT")
    yield from shoot("redo")


def make(names: list[str]) -> Steps:
    """Make pictures one after the other, and end Blender; with a status of 1 if one fails."""
    failed = False
    for name in names:
        try:
            yield from PICTURES[name]()
        except Exception:
            traceback.print_exc()
            failed = True
    print("READY", flush=True)
    yield 2.0
    os._exit(1 if failed else 0)


if __name__ == "__main__":
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    register_extension()
    later = ["blender_5_2"]
    everything = later if bpy.app.version >= (5, 2) else [name for name in PICTURES if name not in later]
    steps = make(os.environ.get("GUIDE_PICTURES", "").split() or everything)
    bpy.app.timers.register(lambda: next(steps, None), first_interval=1.0, persistent=True)
