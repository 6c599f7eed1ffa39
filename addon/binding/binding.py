"""Cages that move what is in them: each level follows the next coarser one, and the drawing follows the first.

Bound objects show a mesh without shape keys, so that the animation of the cages does not play; the mesh and the action
that they had are kept and come back when they are unbound.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from types import ModuleType

import bpy
import numpy as np
from mathutils import Matrix

from ..errors import Refusal, load_core, say
from ..scene import display, filling, ownership, rollback
from ..scene.plane import PLANARITY, size, transform
from . import deform_modifiers, node_groups, originals
from .deform_modifiers import HELPER, Link

# Custom properties of bound objects and of their collection.
BOUND = "nested_cages_bound"
PARKED_MESH, PARKED_ACTION, PARKED_STATE = "nested_cages_mesh", "nested_cages_action", "nested_cages_before"


@dataclass(frozen=True)
class Binding:
    """The links from the inside out, and how the original object follows, or a sentence why it does not."""

    links: tuple[Link, ...]
    original: str


def is_bound(collection: bpy.types.Collection) -> bool:
    """Whether the cages of an output collection move what is in them."""
    return bool(collection.get(BOUND, False))


def bind(context: bpy.types.Context, collection: bpy.types.Collection, method: str = "AUTO") -> Binding:
    """Makes every level of an output collection follow the next one. Raises: Refusal, leaving all as it was."""
    core = load_core()
    levels = _levels(context, collection)
    for obj in levels:
        _park(obj)
    context.view_layer.update()
    try:
        _fill(levels, core)
        return _connect(context, collection, levels, method, core)
    except BaseException:
        unbind(collection)
        raise


def rebind(context: bpy.types.Context, collection: bpy.types.Collection, method: str = "AUTO") -> Binding:
    """Binds anew, cages and drawing as their vertices and transforms are now. Raises: Refusal.

    What follows goes back to its own shape first. If the cages do not enclose what is in them like that, nothing is
    changed.
    """
    core = load_core()
    levels = _levels(context, collection)
    for inner, cage in pairwise(levels):
        _check_enclosed(inner, cage, core)
    _disconnect(collection, levels)
    _fill(levels, core)
    return _connect(context, collection, levels, method, core)


def unbind(collection: bpy.types.Collection) -> None:
    """Takes everything back to what it was before it was bound; poses are lost."""
    levels = ownership.members(collection)
    _disconnect(collection, levels)
    for obj in levels:
        _unpark(obj)
    if BOUND in collection:
        del collection[BOUND]


def forget(collection: bpy.types.Collection) -> str:
    """Removes what is left of a binding on output that has been written anew; returns the method it was bound by, or
    nothing.
    """
    if not is_bound(collection):
        return ""
    levels = ownership.members(collection)
    _disconnect(collection, levels, lines_back=False)
    for obj in levels:
        mesh, action = obj.get(PARKED_MESH), obj.get(PARKED_ACTION)
        for name in (PARKED_MESH, PARKED_ACTION, PARKED_STATE):
            if name in obj:
                del obj[name]
        if mesh is not None:
            rollback.remove_mesh(mesh)
        if action is not None and action.users == 0:
            bpy.data.actions.remove(action)
    method = collection[BOUND]
    del collection[BOUND]
    return str(method)


def _levels(context: bpy.types.Context, collection: bpy.types.Collection) -> list[bpy.types.Object]:
    levels = ownership.members(collection)
    if len(levels) < 2:
        raise Refusal("'{name}' has no cages: generate some first", name=collection.name)
    for obj in levels:
        if obj.mode != "OBJECT":
            raise Refusal("'{name}' is being edited: go back to Object Mode first", name=obj.name)
        if not obj.is_editable or not obj.data.is_editable:
            raise Refusal("'{name}' cannot be bound because it is linked from another file", name=obj.name)
        if obj.name not in context.view_layer.objects:
            raise Refusal("'{name}' is not in this view layer: tick its collection in the Outliner", name=obj.name)
    return levels


def _park(obj: bpy.types.Object) -> None:
    """Gives an object a copy of its mesh without shape keys and takes its own action away, and keeps both for later."""
    obj[PARKED_STATE] = [*(x for row in obj.matrix_basis for x in row), float(obj.hide_render)]
    obj[PARKED_MESH] = obj.data
    animation = obj.animation_data
    if animation is not None and animation.action is not None:
        obj[PARKED_ACTION] = animation.action
        animation.action = None
    plain = bpy.data.meshes.new(obj.data.name)
    plain.from_pydata(filling.points_of(obj.data).tolist(), filling.loop_edges(obj.data).tolist(), [])
    for material in obj.data.materials:
        plain.materials.append(material)
    obj.data = plain
    obj.hide_viewport = False
    obj.hide_set(False)


def _unpark(obj: bpy.types.Object) -> None:
    if PARKED_MESH not in obj:
        return
    posed, obj.data = obj.data, obj[PARKED_MESH]
    del obj[PARKED_MESH]
    rollback.remove_mesh(posed)
    if PARKED_ACTION in obj:
        animation = obj.animation_data or obj.animation_data_create()
        animation.action = obj[PARKED_ACTION]
        if getattr(animation, "action_slot", True) is None and animation.action_suitable_slots:
            animation.action_slot = animation.action_suitable_slots[0]
        del obj[PARKED_ACTION]
    *basis, hidden = obj[PARKED_STATE]
    before = Matrix(np.reshape(basis, (4, 4)).tolist())
    if obj.matrix_basis != before:
        obj.matrix_basis = before
    obj.hide_render = bool(hidden)
    del obj[PARKED_STATE]


def _fill(levels: list[bpy.types.Object], core: ModuleType) -> None:
    """Gives the cages triangles inside their outlines. Raises: Refusal."""
    for cage in levels[1:]:
        old, shape = cage.data, filling.outline(cage, core)
        cage.data = filling.filled(old.name, filling.points_of(old), shape, core)
        rollback.remove_mesh(old)
        cage.hide_render = True  # as wires they were not seen in renders


def _check_enclosed(inner: bpy.types.Object, cage: bpy.types.Object, core: ModuleType) -> None:
    """Raises: Refusal unless the cage, unposed, strictly encloses the unposed inner mesh in its plane."""
    there = np.linalg.inv(np.array(cage.matrix_world)) @ np.array(inner.matrix_world)
    points, corners = transform(there, filling.points_of(inner.data)), filling.points_of(cage.data)
    if np.ptp(np.concatenate([points[:, 2], corners[:, 2]])) > PLANARITY * size(corners):
        raise Refusal(
            "'{inner}' and '{cage}' do not lie in one plane: move the cage back into it, then bind again",
            inner=inner.name,
            cage=cage.name,
        )
    try:
        fine = core.Mesh(points[:, :2], filling.loop_edges(inner.data))
    except core.NestedCagesError as error:
        raise Refusal("'{name}': {problem}", name=inner.name, problem=error) from error
    certificate = core.verify(filling.outline(cage, core), fine)
    if not certificate.holds:
        raise Refusal(
            "'{cage}' does not enclose '{inner}' as it is now ({problem}): move its vertices out, then bind again",
            inner=inner.name,
            cage=cage.name,
            problem="; ".join(certificate.problems),
        )


def _connect(
    context: bpy.types.Context,
    collection: bpy.types.Collection,
    levels: list[bpy.types.Object],
    method: str,
    core: ModuleType,
) -> Binding:
    """Links the levels from the inside out, so that each link is measured before its cage follows another."""
    collection[BOUND] = method
    context.view_layer.update()
    for inner, cage in pairwise(levels):
        _check_enclosed(inner, cage, core)
    links = tuple(deform_modifiers.link(context, inner, cage, method) for inner, cage in pairwise(levels))
    for obj, made in zip(levels, links, strict=False):
        obj["nested_cages_link"] = say(
            "{method}, error {rest:.1e} at rest, {affine:.1e} under affine poses",
            method=deform_modifiers.NAMES[made.method],
            rest=made.rest,
            affine=made.affine,
        )
    for obj in levels:
        _take_lines_out(obj, collection)
    sentence = originals.follow(context, collection, levels, links[0].method)
    _remove_helpers([obj for obj in collection.objects if HELPER in obj and not _used(obj)])
    return Binding(links, sentence)


def _disconnect(collection: bpy.types.Collection, levels: list[bpy.types.Object], *, lines_back: bool = True) -> None:
    for obj in levels:
        deform_modifiers.release(obj)
        if "nested_cages_link" in obj:
            del obj["nested_cages_link"]
    originals.release(collection)
    for helper in [obj for obj in collection.objects if HELPER in obj]:
        owner = helper.get("nested_cages_lines_of")
        if lines_back and owner is not None:
            display.set_thickness(owner, owner[ownership.LEVEL], helper["nested_cages_thickness"])
    _remove_helpers([obj for obj in collection.objects if HELPER in obj])


def _used(helper: bpy.types.Object) -> bool:
    """Whether a modifier follows a helper, or it has lines to show."""
    targets = [
        m.object if m.type == deform_modifiers.PRISM else m.target
        for obj in bpy.data.objects
        for m in obj.modifiers
        if m.type in (deform_modifiers.PRISM, deform_modifiers.SURFACE)
    ]
    return helper in targets or "nested_cages_lines_of" in helper


def _remove_helpers(helpers: Iterable[bpy.types.Object]) -> None:
    for helper in helpers:
        mesh = helper.data
        for modifier in list(helper.modifiers):
            display.remove_modifier(helper, modifier)
        bpy.data.objects.remove(helper)
        rollback.remove_mesh(mesh)


def _take_lines_out(obj: bpy.types.Object, collection: bpy.types.Collection) -> None:
    """Lets another object show the thick lines, because those that follow an object need its plain shape in renders."""
    modifier = obj.modifiers.get(display.THICKNESS)
    if modifier is None:
        return
    radius = display.get_input(modifier, "Radius")
    display.set_thickness(obj, obj[ownership.LEVEL], 0.0)
    name = f"{obj.name} Lines"
    helper = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    helper[HELPER], helper["nested_cages_lines_of"], helper["nested_cages_thickness"] = True, obj, 2.0 * radius
    helper.hide_viewport = helper.hide_select = True
    helper.parent = obj
    collection.objects.link(helper)
    node_groups.add(helper, node_groups.EDGES, Object=obj)
    display.set_thickness(helper, obj[ownership.LEVEL], 2.0 * radius)
