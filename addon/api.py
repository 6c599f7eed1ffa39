"""The add-on's function for scripts: cages around objects."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeAlias

import bpy
from bpy.types import Context, Object

from . import record
from .animation import visibility
from .core import core
from .generation.levels import OWN_UNIT
from .scene import convert, ownership
from .scene.ownership import scene_of

Level: TypeAlias = "str | int | float | core.Within | bpy.types.Object"
Levels: TypeAlias = "str | int | float | core.Within | Sequence[Level]"


def cages(objects: Sequence[Object], levels: Levels = "20%, 8%", **settings: Any) -> list[list[Object]]:
    """Makes cages around each object and returns them, finest first.

    objects: curves, texts, Grease Pencil drawings, hair curves or flat meshes, in the current view layer.
    levels: vertex counts (int), fractions of the vertices (float below 1), `Within` of the core in units of the scene,
    or objects of your own; or a text such as "64, 24", "20%, 8%" or "5mm, +25%".
    settings: properties of the operator `object.nested_cages_generate`, by the same names: clearance, decimation,
    energy, inside, together, close_open ... All others have the operator's defaults, whatever the panel shows.

    An object that cannot be caged has an empty list if others can be; with ``together=True`` there is one list for all
    objects. Earlier cages of the same objects are replaced. Selection, active object and current frame stay.

    Raises: ValueError with the operator's message if nothing can be caged.
    """
    context, chosen, inside = bpy.context, list(objects), bool(settings.get("inside", False))
    operator: Any = bpy.ops.object.nested_cages_generate  # type: ignore[attr-defined]
    if not chosen:
        raise ValueError("No objects were given")
    for obj in chosen:
        if not isinstance(obj, Object):
            raise ValueError(f"{obj!r:.60} is not an object: give objects, such as bpy.data.objects[name]")
        if not convert.readable(obj):
            raise ValueError(f"'{obj.name}' has no outline, it is of the type {obj.type}")
    unknown = [name for name in settings if name not in operator.get_rna_type().properties]
    if unknown:
        raise ValueError(f"There is no setting '{unknown[0]}'")
    text, own = _levels(levels)
    context.view_layer.update()
    with _shown(context, chosen):
        for obj in chosen:
            if obj.name not in context.view_layer.objects or not obj.visible_get():
                raise ValueError(f"'{obj.name}' is not visible in the current view layer, so it cannot be caged")
        before = {obj: _meshes(context, obj, inside) for obj in chosen}
        with _selected(context, chosen):
            try:
                operator(**{"levels": text, "level_objects": "\n".join(own), "show_result": False, **settings})
            except RuntimeError as error:
                raise ValueError(str(error).removeprefix("Error: ").strip()) from error
        made = {obj: _cages_of(context, obj, inside) for obj in chosen if _meshes(context, obj, inside) != before[obj]}
    common = settings.get("together") or settings.get("use_selected_as_levels")
    return [made.get(obj, []) for obj in (chosen[:1] if common else chosen)]


def _cages_of(context: Context, obj: Object, inside: bool) -> list[Object]:
    """The cages around an object or inside of it, finest first."""
    collection = ownership.by_drawing(scene_of(context)).get((obj, inside))
    return ownership.members(collection)[1:] if collection is not None else []


def _meshes(context: Context, obj: Object, inside: bool) -> list[int]:
    """The session IDs of the meshes of an object's cages: new cages have new ones."""
    return [cage.data.session_uid for cage in _cages_of(context, obj, inside) if cage.data is not None]


def _levels(levels: Levels) -> tuple[str, list[str]]:
    """The operator's text for levels, and the names of own objects."""
    if isinstance(levels, str):
        return levels, []
    listed = [levels] if isinstance(levels, int | float | core.Within) else list(levels)
    own = [level.name for level in listed if isinstance(level, Object)]
    return ", ".join(map(_word, listed)), own


def _word(level: Level) -> str:
    """One level as text for the operator. Raises: ValueError."""
    if isinstance(level, Object):
        return "*"
    if isinstance(level, core.Within):
        return f"+{100.0 * level.excess!r}%" if level.excess is not None else f"{level.limit!r}{OWN_UNIT}"
    if isinstance(level, float):
        if not 0.0 < level < 1.0:
            raise ValueError(f"A level given as a fraction is between 0 and 1, not {level!r}")
        return f"{100.0 * level:.6f}%"
    return str(level)


@contextmanager
def _shown(context: Context, objects: Sequence[Object]) -> Iterator[None]:
    """Temporarily shows drawings that the animation of earlier cages hides."""
    outputs = [output for obj in objects for output in ownership.outputs_about(scene_of(context), obj)]
    hiding = [each for each in outputs if record.of(each).playing]
    for collection in hiding:
        visibility.leave(collection)
    context.view_layer.update()
    try:
        yield
    finally:
        for collection in hiding:
            visibility.enter(collection)


@contextmanager
def _selected(context: Context, objects: Sequence[Object]) -> Iterator[None]:
    """Temporarily selects only these objects, in Object Mode, the first of them active."""
    if context.mode != "OBJECT":
        raise ValueError("Switch to Object Mode first")
    scene, layer = scene_of(context), context.view_layer
    moment, active = (scene.frame_current, scene.frame_subframe), layer.objects.active
    layer.objects.active = objects[0]
    try:
        with context.temp_override(selected_objects=list(objects)):
            yield
    finally:
        layer.objects.active = active
        if (scene.frame_current, scene.frame_subframe) != moment:
            scene.frame_set(moment[0], subframe=moment[1])
