"""What bound objects show instead of their own mesh: one without steps, cages filled, and thick lines apart."""

from __future__ import annotations

from contextlib import suppress

import bpy
from bpy.types import Object

from .. import cage_sets, keys, transfer
from ..animation import visibility
from ..blender import display, mesh_data, shape_keys
from ..core import triangulation


def park(obj: Object) -> None:
    """Shows a copy of an object's mesh without our steps; its own action keeps playing, but no longer hides it."""
    hidden = (obj.hide_render, obj.hide_viewport, obj.hide_get())
    mesh = mesh_data.mesh_of(obj)
    cage_sets.set_before(obj, cage_sets.Before(mesh, obj.matrix_basis, hidden))
    visibility.mute(obj, True)
    if transfer.artists_keys(mesh.shape_keys):
        obj.data = mesh.copy()
        shape_keys.remove_steps(obj)
        transfer.reshape(obj, mesh_data.points_of(mesh), mesh_data.loop_edges(mesh), numbered=True)
    else:  # a copy would leave its shape keys in the file
        obj.data = bpy.data.meshes.new_from_object(obj)
        keys.store(obj.data, dict(mesh.items()))
    obj.hide_viewport = False
    obj.hide_set(False)


def unpark(objects: list[Object]) -> list[str]:
    """Gives objects their own shapes and steps back, with the work done on them since; returns what could not be
    kept.
    """
    lost = list[str]()
    for obj in objects:
        mesh, matrix, hidden = cage_sets.before(obj)
        if mesh is None or matrix is None:
            continue
        cage_sets.set_before(obj, cage_sets.Before())
        posed, plain = mesh_data.mesh_of(obj), _is_plain(obj)
        if plain:
            obj.data = mesh
        if plain and _is_plain(obj):
            shape_keys.remove_mesh(posed)
        else:
            obj.data = posed
            points = transfer.rest_points(mesh)
            without, _ = transfer.reshape(obj, points, mesh_data.loop_edges(mesh), numbered=True)
            lost += [f"'{obj.name}': {what} could not be kept" for what in without]
            shape_keys.copy_steps(mesh, obj)
            name = mesh.name
            shape_keys.remove_mesh(mesh)
            obj.data.name = name
        visibility.mute(obj, False)
        if obj.matrix_basis != matrix:
            obj.matrix_basis = matrix
        obj.hide_render, obj.hide_viewport, away = hidden
        with suppress(RuntimeError):  # not in this view layer
            obj.hide_set(away)
    return lost


def _is_plain(obj: Object) -> bool:
    """Whether nothing of an artist's is in the mesh of an object."""
    mesh = mesh_data.mesh_of(obj)
    own = [key for key in mesh.keys() if not key.startswith(keys.PREFIX)]  # noqa: SIM118 - no mapping
    return not (own or len(mesh.materials) or transfer.is_worked_on(obj))


def fill(levels: list[Object]) -> None:
    """Gives the cages triangles inside their outlines. Raises: UserError."""
    for cage in levels[1:]:
        mesh, shape = mesh_data.mesh_of(cage), mesh_data.shape_of(cage)
        mesh_data.remove_faces(mesh)
        mesh_data.add_faces(mesh, triangulation.triangulate(shape).triangles)
        cage.hide_render = True  # as wires they did not show in renders


def take_lines_out(obj: Object) -> None:
    """Moves thick lines to a helper object, because followers of an object need its plain shape in renders."""
    display.render_lines(obj, False)
    thickness = display.thickness_of(obj)
    if thickness <= 0.0:
        return
    display.set_thickness(obj, 0.0)
    name = f"{obj.name} Lines"
    helper = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    cage_sets.make_helper(helper, cage_sets.LINES, obj, thickness)
    helper.hide_viewport = helper.hide_select = True
    helper.parent = obj
    for collection in obj.users_collection:
        collection.objects.link(helper)
    display.add_nodes_modifier(helper, display.EDGES, display.group(display.EDGES), {"Object": obj})
    helper.color = obj.color
    display.set_thickness(helper, thickness)
