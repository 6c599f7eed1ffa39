"""The field of a cage: a hidden mesh that carries the cage's motion, and whatever follows it by one modifier."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import AbstractContextManager
from typing import Final

import bpy
import numpy as np
from bpy.types import Mesh, Object

from .. import keys, record
from ..core import core, remembered
from ..errors import FloatArray, UserError
from ..scene import display, filling, placement
from ..scene.areas import instances_collection
from ..scene.grease_pencil import matrix_of
from ..scene.plane import size, space_to_space, transform

HARMONIC: Final = "HARMONIC"
LINEAR: Final = "LINEAR"
NAMES = {HARMONIC: "Harmonic Coordinates", LINEAR: "Linear Coordinates"}
# Maximum number of weights: Blender sums as many in a few hundredths of a second per frame.
MAX_WEIGHTS = 1_000_000
# Bytes of a field per vertex of its cage, for the memory.
FIELD_BYTES = 20_000
# The modifier of all that follows a field.
FOLLOW = "Nested Cages Follow"
# Edges of a picture are halved until those of its outline are shorter than this fraction of its size, so that it bends;
# at most this often.
BENDING_PART, MAX_HALVINGS = 1.0 / 32.0, 5
# Largest difference of a layer's matrix from none that is round-off.
UNMOVED = 1e-6


def make(cage: Object, space: Object, method: str) -> Object:
    """The field of a filled cage, a new hidden object in the space of another one, which carries it. Raises: UserError.

    Where weights would be too many, it is the cage's own triangles alone.
    """
    outline, corners = filling.shape_of(cage), filling.points_of(filling.mesh_of(cage))
    name, sampling = f"{cage.name} Field", None if method == LINEAR else core.coordinates.field.INSIDE
    field = remembered(
        lambda: core.coordinates.field_of(outline, sampling),
        FIELD_BYTES * len(corners),
        "field", outline.vertices, outline.edges, sampling,
    )  # fmt: skip
    if field.weights.size > MAX_WEIGHTS:
        data, shows = filling.filled(name, _in(space, cage, corners), outline), display.SAME
    else:
        height = np.full(len(field.vertices), corners[0, 2])
        places, shows = _in(space, cage, np.column_stack([field.vertices, height])), display.WEIGHTED
        data = filling.new_mesh(name, places, faces=field.triangles)
        for number, weights in enumerate(field.weights.T.astype(np.float32)):
            filling.add_attribute(data, f"{keys.WEIGHT}{number}", "FLOAT", weights)
    made = bpy.data.objects.new(name, data)
    record.make_helper(made, record.FIELD, cage)
    made.display_type = "WIRE"
    made.hide_viewport = made.hide_render = made.hide_select = True
    for collection in cage.users_collection:
        collection.objects.link(made)
    placement.carry(made, space)
    display.add_nodes_modifier(made, shows, display.group(shows), {"Object": cage})
    return made


def follow(obj: Object, field: Object, *, in_place: bool) -> None:
    """Makes an object follow a field, and no other, by a modifier after its others. Raises: UserError.

    in_place: the field is in the object's own space, so that copies and instances elsewhere show the same.
    """
    if problem := why_not(obj):
        raise UserError(problem)
    release(obj)
    if instances_collection(obj):  # empties cannot bend: a new object shows the collection
        empty, name = obj, f"{obj.name} Bound"
        obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
        record.make_helper(obj, record.PROXY, empty)
        for home in empty.users_collection:
            home.objects.link(obj)
        obj.parent = empty
        empty.instance_type = "NONE"
    inputs = {"Object": field, "In Place": in_place, "Subdivide": _halvings(obj)}
    shown = record.shown(obj, record.PROXY)
    if shown is not None:
        inputs["Collection"] = shown.instance_collection
    display.add_nodes_modifier(obj, FOLLOW, display.group(display.FOLLOW), inputs)


def leave_place(obj: Object) -> None:
    """Notes of a drawing that follows a field that this is no longer in its own space: not after Apply Scale."""
    modifier = display.nodes_modifier(shown_by(obj), FOLLOW)
    if modifier is not None and display.get_input(modifier, "In Place"):
        display.set_input(modifier, "In Place", False)
        obj.update_tag()


def why_not(obj: Object) -> str:
    """Why an object cannot follow; empty if it can."""
    if not obj.is_editable:
        return f"'{obj.name}' is linked from another file: make it local first"
    if instances_collection(obj):
        return ""
    if obj.type not in {"MESH", "CURVE", "FONT", "CURVES", "GREASEPENCIL"}:
        return f"'{obj.name}' is of a kind without modifiers: convert it to a mesh or a curve"
    for layer in obj.data.layers if obj.type == "GREASEPENCIL" else ():
        if np.abs(matrix_of(obj, layer) - np.eye(4)).max() > UNMOVED:
            return f"layer '{layer.name}' of '{obj.name}' has a transform of its own: clear it, then bind again"
    return ""


def field_of(cage: Object) -> Object | None:
    """The field of a cage."""
    return next((obj for obj in bpy.data.objects if record.shown(obj, record.FIELD) == cage), None)


def followed(obj: Object) -> Object | None:
    """The field that an object follows, or the object that shows what it instances."""
    modifier = display.nodes_modifier(shown_by(obj), FOLLOW)
    # A group that was appended to a file with its own has a number after its name.
    if modifier is None or modifier.node_group is None or modifier.node_group.name.partition(".")[0] != display.FOLLOW:
        return None
    return display.get_input(modifier, "Object")


def shown_by(obj: Object) -> Object:
    """The object that shows what an empty instances, if that is bound; else the object itself."""
    return next(iter(_proxies(obj)), obj)


def _proxies(obj: Object) -> list[Object]:
    """The objects that show what an empty instances; to tell the children of any object takes a pass over the file."""
    if obj.type != "EMPTY":
        return []
    return [child for child in obj.children if record.shown(child, record.PROXY) == obj]


def release(obj: Object) -> None:
    """Removes the modifier, and the object that shows what this one instances."""
    for proxy in _proxies(obj):
        release(proxy)
        mesh = filling.mesh_of(proxy)
        bpy.data.objects.remove(proxy)
        bpy.data.meshes.remove(mesh)
        obj.instance_type = "COLLECTION"
    modifier = obj.modifiers.get(FOLLOW)
    if modifier is not None:
        display.remove_modifier(obj, modifier)


def unposed(objects: Iterable[Object]) -> AbstractContextManager[None]:
    """Temporarily shows the own shapes of drawings that follow their cages."""
    return display.unmodified(objects, FOLLOW)


def _in(space: Object, cage: Object, points: FloatArray) -> FloatArray:
    """Points (n, 3) of a cage in the space of another object; unchanged if both stand at the same place."""
    return points if space.matrix_world == cage.matrix_world else transform(space_to_space(space, cage), points)


def _halvings(obj: Object) -> int:
    """How often the edges of a mesh are halved, so that a picture on few faces bends."""
    mesh = obj.data
    if not isinstance(mesh, Mesh) or not mesh.uv_layers or not len(filling.loop_edges(mesh)):
        return 0
    points = filling.points_of(mesh)
    ends = filling.loop_edges(mesh)
    typical = float(np.median(np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)))
    wanted = BENDING_PART * size(points)
    return int(np.clip(np.ceil(np.log2(typical / wanted)), 0, MAX_HALVINGS)) if typical > wanted > 0.0 else 0
