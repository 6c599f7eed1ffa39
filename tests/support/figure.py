"""A figure of capsules: parts of many kinds in front of each other, its bones, and how they turn."""

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from .drawings import Loop, add, evaluated, grease_pencil, in_world, poly_curve, set_of, text, wire

# Ends and radius of each limb of a figure.
LIMBS = {
    "Torso": ((0.0, 0.2), (0.0, 1.0), 0.38),
    "Neck": ((0.0, 1.2), (0.0, 1.5), 0.12),
    "Head": ((0.0, 1.62), (0.0, 1.75), 0.3),
    "Arm.L": ((0.3, 1.15), (0.95, 1.12), 0.12),
    "Hand.L": ((0.9, 1.12), (1.6, 1.1), 0.1),
    "Arm.R": ((-0.3, 1.15), (-0.95, 1.12), 0.12),
    "Hand.R": ((-0.9, 1.12), (-1.6, 1.1), 0.1),
    "Leg.L": ((0.22, 0.0), (0.28, -1.3), 0.15),
    "Leg.R": ((-0.22, 0.0), (-0.28, -1.3), 0.15),
}


def capsule(start: Any, end: Any, radius: float, count: int = 36, sides: int = 8) -> Loop:
    """A loop (count + 2 · sides, 2) around a segment."""
    a, b = np.array(start), np.array(end)
    turn = np.arctan2(*(b - a)[::-1])
    half = np.linspace(-np.pi / 2.0, np.pi / 2.0, count // 2)
    ends = [
        c + radius * np.column_stack([np.cos(t), np.sin(t)]) for c, t in ((b, turn + half), (a, turn + np.pi + half))
    ]
    part = np.linspace(0.0, 1.0, sides + 2)[1:-1, None]
    there, back = ((1.0 - part) * p[-1] + part * q[0] for p, q in (ends, ends[::-1]))
    return np.concatenate([ends[0], there, ends[1], back])


def face(name: str, loop: Loop) -> Any:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(x, y, 0.0) for x, y in loop], [], [list(range(len(loop)))])
    return add(name, mesh)


def figure() -> dict[str, Any]:
    """The parts of a figure, of many kinds, in front of each other, all selected."""
    kinds = [face, lambda name, loop: poly_curve(name, [loop]), lambda name, loop: wire(name, [loop])]
    if hasattr(bpy.types, "GreasePencilDrawing"):
        kinds.append(lambda name, loop: grease_pencil(name, [loop]))
    made = {}
    for number, (name, limb) in enumerate(LIMBS.items()):
        made[name] = kinds[number % len(kinds)](name, capsule(*limb))
    made["Badge"] = text("Badge", "B")
    made["Badge"].data.size = 0.3
    made["Badge"].location = (-0.1, 0.5, 0.0)
    for number, obj in enumerate(made.values()):
        obj.location.z += 0.001 * number
    bpy.context.view_layer.update()
    return made


def points(obj: Any) -> Loop:
    """Displayed points (n, 3) in the world."""
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    if obj.type == "GREASEPENCIL":
        strokes = [s for layer in shape.data.layers for s in layer.current_frame().drawing.strokes]
        found = np.array([point.position for stroke in strokes for point in stroke.points], np.float32)
        return in_world(shape, found)
    return in_world(shape, evaluated(obj))


def rigged(parts: dict[str, Any]) -> tuple[Any, Any]:
    """The armature and the cage of a figure with suggested bones."""
    assert bpy.ops.object.nested_cages_puppet(source="BONES") == {"FINISHED"}
    armature = bpy.context.object
    assert bpy.ops.object.nested_cages_puppet(source="ONE_CAGE") == {"FINISHED"}
    assert bpy.context.object == armature and bpy.context.mode == "POSE"
    bpy.ops.object.mode_set(mode="OBJECT")
    return armature, set_of(parts["Torso"]).cages[0]


def bone_at(armature: Any, x: float, y: float) -> Any:
    """The bone whose middle is nearest to a place."""
    middles = {bone: armature.matrix_world @ ((bone.head + bone.tail) / 2.0) for bone in armature.pose.bones}
    return min(middles, key=lambda bone: float(np.hypot(*(np.array(middles[bone])[:2] - (x, y)))))


def turn(armature: Any, bone: Any, degrees: float) -> None:
    """Turns a bone in the plane around its head."""
    head = Matrix.Translation(bone.head)
    bone.matrix = head @ Matrix.Rotation(np.deg2rad(degrees), 4, "Z") @ head.inverted() @ bone.matrix
    bpy.context.view_layer.update()


def key_turn(bone: Any, frame: int, degrees: float) -> None:
    """Keys a turn of a bone in the plane."""
    local = bone.bone.matrix_local.to_3x3()
    turned = local.inverted() @ Matrix.Rotation(np.deg2rad(degrees), 3, "Z") @ local
    bone.rotation_quaternion = turned.to_quaternion()
    bone.keyframe_insert("rotation_quaternion", frame=frame)
