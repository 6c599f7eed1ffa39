"""Cages that move what is in them: each level follows the next coarser one, and the drawing follows the first.

Bound objects show a mesh without shape keys, so that the animation of the cages does not play; the mesh and the action
that they had are kept and come back when they are unbound.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise

import bpy
import numpy as np
from mathutils import Matrix

from .. import keys
from ..animation import stage
from ..animation.shape_keys import remove_mesh
from ..core import core
from ..errors import UserError
from ..generation.job import Progress, Work, completed
from ..scene import display, filling, ownership
from ..scene.plane import PLANARITY, size, transform
from . import deform_modifiers, node_groups, originals
from .deform_modifiers import Link

# What the job says.
STAGE = "binding"


@dataclass(frozen=True)
class Binding:
    """The links from the inside out, and how the original object follows, or a sentence why it does not."""

    links: tuple[Link, ...]
    original: str


def bind(context: bpy.types.Context, collection: bpy.types.Collection, method: str = "AUTO") -> Work[Binding]:
    """Makes every level of an output collection follow the next one. Raises: UserError, leaving all as it was."""
    levels = _levels(context, collection)
    yield Progress(0.0, STAGE)
    try:
        stage.leave(collection)
        for obj in levels:
            _park(obj)
        context.view_layer.update()
        _fill(levels)
        return (yield from _connect(context, collection, levels, method))
    except BaseException:
        unbind(collection)
        raise


def rebind(context: bpy.types.Context, collection: bpy.types.Collection, method: str = "AUTO") -> Work[Binding]:
    """Binds anew, cages and drawing as their vertices and transforms are now. Raises: UserError.

    What follows goes back to its own shape first. If the cages do not enclose what is in them like that, nothing is
    changed. It can be cancelled up to the first change.
    """
    levels = _levels(context, collection)
    for done, (inner, cage) in enumerate(pairwise(levels)):
        yield Progress(done / len(levels), f"checking '{cage.name}'")
        _check_enclosed(inner, cage)
    yield Progress(1.0 - 1.0 / len(levels), STAGE)
    _disconnect(collection, levels)
    _fill(levels)
    return completed(_connect(context, collection, levels, method))


def unbind(collection: bpy.types.Collection) -> None:
    """Takes everything back to what it was before it was bound; poses are lost."""
    levels = ownership.members(collection)
    _disconnect(collection, levels)
    for obj in levels:
        _unpark(obj)
    keys.remove(collection, [keys.BOUND])
    stage.enter(collection)


def forget(collection: bpy.types.Collection) -> str:
    """Removes what is left of a binding on output that has been written anew; returns the method it was bound by, or
    nothing.
    """
    if not ownership.is_bound(collection):
        return ""
    levels = ownership.members(collection)
    _disconnect(collection, levels, lines_back=False)
    for obj in levels:
        mesh = keys.block(obj, keys.STORED_MESH, bpy.types.Mesh)
        action = keys.block(obj, keys.STORED_ACTION, bpy.types.Action)
        keys.remove(obj, [keys.STORED_MESH, keys.STORED_ACTION, keys.STORED_STATE])
        if mesh is not None:
            remove_mesh(mesh)
        if action is not None and action.users == 0:
            bpy.data.actions.remove(action)
    method = keys.text(collection, keys.BOUND)
    keys.remove(collection, [keys.BOUND])
    return method


def _levels(context: bpy.types.Context, collection: bpy.types.Collection) -> list[bpy.types.Object]:
    levels = ownership.members(collection)
    if len(levels) < 2:
        raise UserError(f"'{collection.name}' has no cages: generate some first")
    for obj in levels:
        if obj.mode != "OBJECT":
            raise UserError(f"'{obj.name}' is being edited: go back to Object Mode first")
        if not obj.is_editable or not obj.data.is_editable:
            raise UserError(f"'{obj.name}' cannot be bound because it is linked from another file")
        if obj.name not in context.view_layer.objects:
            raise UserError(f"'{obj.name}' is not in this view layer: tick its collection in the Outliner")
    return levels


def _park(obj: bpy.types.Object) -> None:
    """Gives an object a copy of its mesh without shape keys and takes its own action away, and keeps both for later."""
    hidden = (obj.hide_render, obj.hide_viewport, obj.hide_get())
    obj[keys.STORED_STATE] = [*np.ravel(np.array(obj.matrix_basis)).tolist(), *map(float, hidden)]
    mesh = filling.mesh_of(obj)
    obj[keys.STORED_MESH] = mesh
    animation = obj.animation_data
    if animation is not None and animation.action is not None:
        obj[keys.STORED_ACTION] = animation.action
        animation.action = None
    plain = bpy.data.meshes.new(mesh.name)
    plain.from_pydata(filling.points_of(mesh).tolist(), filling.loop_edges(mesh).tolist(), [])
    for material in mesh.materials:
        plain.materials.append(material)
    obj.data = plain
    obj.hide_viewport = False
    obj.hide_set(False)


def _unpark(obj: bpy.types.Object) -> None:
    mesh = keys.block(obj, keys.STORED_MESH, bpy.types.Mesh)
    if mesh is None:
        return
    posed, obj.data = filling.mesh_of(obj), mesh
    remove_mesh(posed)
    action = keys.block(obj, keys.STORED_ACTION, bpy.types.Action)
    if action is not None:
        animation = obj.animation_data or obj.animation_data_create()
        animation.action = action
        if getattr(animation, "action_slot", True) is None and animation.action_suitable_slots:
            animation.action_slot = animation.action_suitable_slots[0]
    _restore_state(obj)
    keys.remove(obj, [keys.STORED_MESH, keys.STORED_ACTION, keys.STORED_STATE])


def _restore_state(obj: bpy.types.Object) -> None:
    """The transform and what hid the object before it was bound; earlier versions stored `hide_render` alone."""
    state = keys.numbers(obj, keys.STORED_STATE, 19) or keys.numbers(obj, keys.STORED_STATE, 17)
    if state is None:
        return
    before = Matrix(np.reshape(state[:16], (4, 4)).tolist())
    if obj.matrix_basis != before:
        obj.matrix_basis = before
    obj.hide_render = bool(state[16])
    if len(state) > 17:
        obj.hide_viewport = bool(state[17])
        with suppress(RuntimeError):  # not in this view layer
            obj.hide_set(bool(state[18]))


def _fill(levels: list[bpy.types.Object]) -> None:
    """Gives the cages triangles inside their outlines. Raises: UserError."""
    for cage in levels[1:]:
        old, shape = filling.mesh_of(cage), filling.outline(cage)
        cage.data = filling.filled(old.name, filling.points_of(old), shape)
        remove_mesh(old)
        cage.hide_render = True  # as wires they were not seen in renders


def _check_enclosed(inner: bpy.types.Object, cage: bpy.types.Object) -> None:
    """Raises: UserError unless the cage, unposed, strictly encloses the unposed inner mesh in its plane."""
    there = np.linalg.inv(np.array(cage.matrix_world)) @ np.array(inner.matrix_world)
    drawing, corners = filling.mesh_of(inner), filling.points_of(filling.mesh_of(cage))
    points = transform(there, filling.points_of(drawing))
    if np.ptp(np.concatenate([points[:, 2], corners[:, 2]])) > PLANARITY * size(corners):
        raise UserError(
            f"'{inner.name}' and '{cage.name}' do not lie in one plane: move the cage back into it, then bind again"
        )
    try:
        fine = core.Mesh(points[:, :2], filling.loop_edges(drawing))
    except core.NestedCagesError as error:
        raise UserError(f"'{inner.name}': {error}") from error
    certificate = core.verify(filling.outline(cage), fine)
    if not certificate.holds:
        raise UserError(
            f"'{cage.name}' does not enclose '{inner.name}' as it is now ({'; '.join(certificate.problems)}): "
            "move its vertices out, then bind again"
        )


def _connect(
    context: bpy.types.Context,
    collection: bpy.types.Collection,
    levels: list[bpy.types.Object],
    method: str,
) -> Work[Binding]:
    """Links the levels from the inside out, so that each link is measured before its cage follows another."""
    collection[keys.BOUND] = method
    context.view_layer.update()
    for inner, cage in pairwise(levels):
        _check_enclosed(inner, cage)
    links: list[Link] = []
    for inner, cage in pairwise(levels):
        yield Progress((1.0 + len(links)) / len(levels), f"{STAGE}: '{inner.name}' follows '{cage.name}'")
        links.append(deform_modifiers.link(context, inner, cage, method))
    for obj, made in zip(levels, links, strict=False):
        obj[keys.LINK] = (
            f"{deform_modifiers.NAMES[made.method]}, error {made.rest:.1e} at rest, "
            f"{made.affine:.1e} under affine poses"
        )
    for obj in levels:
        _take_lines_out(obj, collection)
    sentence = originals.follow(context, collection, levels, links[0].method)
    _remove_helpers([obj for obj in ownership.helpers(collection) if not _used(obj)])
    return Binding(tuple(links), sentence)


def _disconnect(collection: bpy.types.Collection, levels: list[bpy.types.Object], *, lines_back: bool = True) -> None:
    for obj in levels:
        deform_modifiers.release(obj)
        display.render_lines(obj, True)
        keys.remove(obj, [keys.LINK])
    originals.release(collection)
    for helper in ownership.helpers(collection):
        owner = keys.block(helper, keys.LINES_OF, bpy.types.Object)
        if lines_back and owner is not None:
            thickness = keys.number(helper, keys.LINE_THICKNESS) or 0.0
            display.set_thickness(owner, thickness)
    _remove_helpers(ownership.helpers(collection))


def _used(helper: bpy.types.Object) -> bool:
    """Whether a modifier follows a helper, or it has lines to show."""
    targets = [deform_modifiers.target_of(modifier) for obj in bpy.data.objects for modifier in obj.modifiers]
    return helper in targets or keys.has(helper, keys.LINES_OF)


def _remove_helpers(helpers: Iterable[bpy.types.Object]) -> None:
    for helper in helpers:
        mesh = filling.mesh_of(helper)
        for modifier in list(helper.modifiers):
            display.remove_modifier(helper, modifier)
        bpy.data.objects.remove(helper)
        remove_mesh(mesh)


def _take_lines_out(obj: bpy.types.Object, collection: bpy.types.Collection) -> None:
    """Lets another object show the thick lines, because those that follow an object need its plain shape in renders."""
    display.render_lines(obj, False)
    thickness = display.thickness_of(obj)
    if thickness <= 0.0:
        return
    display.set_thickness(obj, 0.0)
    name = f"{obj.name} Lines"
    helper = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    keys.store(helper, {keys.HELPER: True, keys.LINES_OF: obj, keys.LINE_THICKNESS: thickness})
    helper.hide_viewport = helper.hide_select = True
    helper.parent = obj
    collection.objects.link(helper)
    node_groups.add(helper, node_groups.EDGES, Object=obj)
    helper.color = obj.color
    display.set_thickness(helper, thickness)
