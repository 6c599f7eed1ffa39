"""The field of a cage: a hidden mesh with weights of the cage's corners, and what follows both by one modifier.

The modifier reads the cage itself, and the field refers to nothing: copies follow their own cages at once.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import AbstractContextManager
from typing import Any, Final

import bpy
import numpy as np
from bpy.types import Mesh, Object
from mathutils import Matrix

from .. import cage_sets, keys
from ..blender import display, mesh_data
from ..core import core
from ..drawing import placement
from ..drawing.grease_pencil import KINDS, matrix_of
from ..drawing.painted import instances_collection
from ..drawing.plane import size, space_to_space, transform
from ..errors import FloatArray, UserError
from ..memory import remembered

HARMONIC: Final = "HARMONIC"
LINEAR: Final = "LINEAR"
NAMES = {HARMONIC: "Harmonic Coordinates", LINEAR: "Linear Coordinates"}
# Maximum number of weights: Blender sums as many in a few hundredths of a second per frame.
MAX_WEIGHTS = 1_000_000
# Bytes of a field per vertex of its cage, for the memory.
FIELD_BYTES = 20_000
# The modifier of all that follows a cage, and its node groups: by triangles alone, or by weights.
FOLLOW = "Nested Cages Follow"
FOLLOWERS = (display.FOLLOW_PLAIN, display.FOLLOW)
# Edges of a picture are halved until those of its outline are shorter than this fraction of its size, so that it bends;
# at most this often.
BENDING_PART, MAX_HALVINGS = 1.0 / 32.0, 5
# Largest difference of a layer's matrix from none that is round-off.
UNMOVED = 1e-6


def make(cage: Object, space: Object, method: str) -> Object:
    """The field of a filled cage, a new hidden object with a mesh in the space of another one. Raises: UserError.

    Where weights would be too many, it is the cage's own triangles alone.
    """
    outline, corners = mesh_data.shape_of(cage), mesh_data.points_of(mesh_data.mesh_of(cage))
    name, sampling = f"{cage.name} Field", None if method == LINEAR else core.coordinates.field.INSIDE
    field = remembered(
        lambda: core.coordinates.field_of(outline, sampling),
        FIELD_BYTES * len(corners),
        "field", outline.vertices, outline.edges, sampling,
    )  # fmt: skip
    if field.weights.size > MAX_WEIGHTS:
        data = mesh_data.filled(name, _in(space, cage, corners), outline)
    else:
        height = np.full(len(field.vertices), corners[0, 2])
        places = _in(space, cage, np.column_stack([field.vertices, height]))
        data = mesh_data.new_mesh(name, places, faces=field.triangles)
        for number, weights in enumerate(field.weights.T.astype(np.float32)):
            mesh_data.add_attribute(data, f"{keys.WEIGHT}{number}", "FLOAT", weights)
    made = bpy.data.objects.new(name, data)
    cage_sets.make_helper(made, cage_sets.FIELD, cage)
    made.display_type = "WIRE"
    made.hide_viewport = made.hide_render = made.hide_select = True
    for collection in cage.users_collection:
        collection.objects.link(made)
    placement.carry(made, space)
    return made


def pose(cage: Object, space: Object) -> None:
    """Lets a cage know where it is in the space of a drawing, by a modifier after all others.

    Drivers read the drawing's matrix: a reference to the drawing, which follows the cage, would be a circle.
    """
    unpose(cage)
    modifier = display.add_nodes_modifier(cage, display.POSE, display.group(display.POSE))
    modifier.use_pin_to_last = True
    for column, name in enumerate(display.COLUMNS):
        for row in range(3):
            driver = cage.driver_add(display.path_of(modifier, name), row).driver
            driver.type = "AVERAGE"
            variable = driver.variables.new()
            variable.targets[0].id, variable.targets[0].data_path = space, f"matrix_world[{column}][{row}]"


def unpose(cage: Object) -> None:
    """Removes what `pose` has added."""
    modifier = display.nodes_modifier(cage, display.POSE)
    if modifier is None:
        return
    for name in display.COLUMNS:
        cage.driver_remove(display.path_of(modifier, name), -1)
    display.remove_modifier(cage, modifier)
    data = cage.animation_data
    if data is not None and data.action is None and not len(data.drivers) and not len(data.nla_tracks):
        cage.animation_data_clear()


def follow(obj: Object, cage: Object, space: Object, offset: Matrix | None = None) -> None:
    """Makes an object follow a cage, and no other, by a modifier after its others. Raises: UserError.

    space: the object in whose space the cage's field is; offset: the matrix into it if that stays as it is, as with a
    cage, which must not depend on a drawing.
    """
    if problem := why_not(obj):
        raise UserError(problem)
    release(obj)
    in_place = obj == space
    if instances_collection(obj):  # empties cannot bend: a new object shows the collection
        empty, name = obj, f"{obj.name} Bound"
        obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
        cage_sets.make_helper(obj, cage_sets.PROXY, empty)
        for home in empty.users_collection:
            home.objects.link(obj)
        obj.parent = empty
        empty.instance_type = "NONE"
    shows = field_of(cage)
    assert shows is not None
    kind = FOLLOWERS[f"{keys.WEIGHT}0" in mesh_data.mesh_of(shows).attributes]
    inputs: dict[str, Any] = {"Cage": cage, "Field": shows, "Subdivide": _halvings(obj)}
    if not in_place and offset is None:
        inputs["Space"] = space
    shown = cage_sets.shown(obj, cage_sets.PROXY)
    if shown is not None:
        inputs["Collection"] = shown.instance_collection
    if obj.type == KINDS[0]:
        _place_layers(obj)
    modifier = display.add_nodes_modifier(obj, FOLLOW, display.group(kind), inputs)
    if offset is not None:
        display.set_matrix(modifier, offset)


def move_offset(obj: Object, back: Matrix) -> None:
    """Keeps a cage where it follows while the space of its drawing changes; back: from the one before to this one."""
    modifier = display.nodes_modifier(obj, FOLLOW)
    if modifier is not None and followed(obj) is not None:
        display.set_matrix(modifier, back @ display.matrix_in(modifier))
        obj.update_tag()


def why_not(obj: Object) -> str:
    """Why an object cannot follow; empty if it can."""
    if not obj.is_editable:
        return f"'{obj.name}' is linked from another file: make it local first"
    if instances_collection(obj):
        return ""
    if obj.type not in {"MESH", "CURVE", "FONT", "CURVES", "GREASEPENCIL"}:
        return f"'{obj.name}' is of a kind without modifiers: convert it to a mesh or a curve"
    return ""


def _place_layers(obj: Object) -> None:
    """Stores where the layers of a Grease Pencil object are: their later motion comes after the bend."""
    data: Any = obj.data
    places = np.array([matrix_of(obj, layer).T for layer in data.layers])
    stored = data.attributes.get(keys.SPACE)
    if stored is None and np.abs(places - np.eye(4)).max(initial=0.0) <= UNMOVED:
        return
    if not data.is_editable:
        raise UserError(f"Layers of '{obj.name}' have transforms of their own: make its data local first")
    stored = stored or data.attributes.new(keys.SPACE, "FLOAT4X4", "LAYER")
    stored.data.foreach_set("value", places.astype(np.float32).ravel())


def field_of(cage: Object) -> Object | None:
    """The field of a cage; a copy shares that of the original."""
    helpers = cage_sets.objects_in(cage_sets.node_of(cage).helpers)
    return next((obj for obj in helpers if cage_sets.is_helper(obj, cage_sets.FIELD)), None)


def followed(obj: Object) -> Object | None:
    """The cage that an object follows, or the object that shows what it instances."""
    modifier = display.nodes_modifier(shown_by(obj), FOLLOW)
    # A group that was appended to a file with its own has a number after its name.
    if modifier is None or modifier.node_group is None or modifier.node_group.name.partition(".")[0] not in FOLLOWERS:
        return None
    return display.get_input(modifier, "Cage")


def shown_by(obj: Object) -> Object:
    """The object that shows what an empty instances, if that is bound; else the object itself."""
    return next(iter(_proxies(obj)), obj)


def _proxies(obj: Object) -> list[Object]:
    """The objects that show what an empty instances."""
    return cage_sets.helpers_of(obj, cage_sets.PROXY)


def release(obj: Object) -> None:
    """Removes the modifier, and the object that shows what this one instances."""
    for proxy in _proxies(obj):
        release(proxy)
        mesh = mesh_data.mesh_of(proxy)
        bpy.data.objects.remove(proxy)
        bpy.data.meshes.remove(mesh)
        obj.instance_type = "COLLECTION"
    modifier = obj.modifiers.get(FOLLOW)
    if modifier is not None:
        display.remove_modifier(obj, modifier)
    places = obj.data.attributes.get(keys.SPACE) if obj.type == KINDS[0] else None
    if places is not None and obj.data.is_editable and obj.data.users == 1:
        obj.data.attributes.remove(places)


def unposed(objects: Iterable[Object]) -> AbstractContextManager[None]:
    """Temporarily shows the own shapes of drawings that follow their cages."""
    return display.unmodified(objects, FOLLOW)


def _in(space: Object, cage: Object, points: FloatArray) -> FloatArray:
    """Points (n, 3) of a cage in the space of another object; unchanged if both stand at the same place."""
    return points if space.matrix_world == cage.matrix_world else transform(space_to_space(space, cage), points)


def _halvings(obj: Object) -> int:
    """How often the edges of a mesh are halved, so that a picture on few faces bends."""
    mesh = obj.data
    if not isinstance(mesh, Mesh) or not mesh.uv_layers or not len(mesh_data.loop_edges(mesh)):
        return 0
    points = mesh_data.points_of(mesh)
    ends = mesh_data.loop_edges(mesh)
    typical = float(np.median(np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)))
    wanted = BENDING_PART * size(points)
    return int(np.clip(np.ceil(np.log2(typical / wanted)), 0, MAX_HALVINGS)) if typical > wanted > 0.0 else 0
