"""The add-on's function for scripts: cages around objects."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any, TypeAlias

import bpy
from bpy.types import Context, Object

from .animation import visibility
from .blender.jobs import drain
from .cage_sets import CageSet
from .cage_sets.selection import scene_of
from .core import core
from .drawing import planar
from .errors import UserError
from .generate import request
from .generate.levels import OWN, OWN_UNIT
from .generate.settings import NAMES
from .generate.write import Kind
from .properties import NestedCagesUsed

Level: TypeAlias = "str | int | float | core.Within | bpy.types.Object"
Levels: TypeAlias = "str | int | float | core.Within | Sequence[Level]"


def cages(objects: Sequence[Object], levels: Levels = "20%, 8%", **settings: Any) -> list[CageSet]:
    """Makes cages around each object and returns their sets: sequences of the cages, finest first, that know more.

    objects: curves, texts, Grease Pencil drawings, hair curves or flat meshes, in the current view layer.
    levels: vertex counts (int), fractions of the vertices (float below 1), `Within` of the core in units of the scene,
    or objects of your own; or a text such as "64, 24", "20%, 8%" or "5mm, +25%".
    settings: properties of the operator `object.nested_cages_generate`, by the same names: clearance, decimation,
    energy, inside, together, close_open ... All others have the operator's defaults, whatever the panel shows.

    An object that cannot be caged has a set without cages if others can be; with ``together=True`` there is one set for
    all objects. Earlier cages of the same objects are replaced. Selection, active object and current frame stay.

    Raises: ValueError with the operator's message if nothing can be caged.
    """
    context, chosen = bpy.context, list(objects)
    if not chosen:
        raise ValueError("No objects were given")
    for obj in chosen:
        if not isinstance(obj, Object):
            raise ValueError(f"{obj!r:.60} is not an object: give objects, such as bpy.data.objects[name]")
        if not planar.readable(obj):
            raise ValueError(f"'{obj.name}' has no outline, it is of the type {obj.type}")
    text, own = _levels(levels)
    values = values_of(levels=text, **settings)
    if context.mode != "OBJECT":
        raise ValueError("Switch to Object Mode first")
    context.view_layer.update()
    drawings = chosen[:1] if values.use_selected_as_levels else chosen
    own = [*own, *(chosen[1:] if values.use_selected_as_levels else ())]
    with _shown(context, chosen):
        for obj in chosen:
            if obj.name not in context.view_layer.objects or not obj.visible_get():
                raise ValueError(f"'{obj.name}' is not visible in the current view layer, so it cannot be caged")
        try:
            made, _ = drain(request.make(context, drawings, own, values, _tell, jump=False))
        except UserError as error:
            raise ValueError(str(error)) from error
    known = [next((each for each in made if obj in each.parts), CageSet(obj)) for obj in drawings]
    return known[:1] if values.together else known


def _tell(kind: Kind, text: str) -> None:
    if kind == "WARNING":
        warnings.warn(text, stacklevel=2)


def values_of(**given: Any) -> Any:
    """All settings, by name: those given, and the defaults of others. Raises: ValueError for what is unknown."""
    known: Any = NestedCagesUsed.bl_rna.properties
    unknown = [name for name in given if name not in NAMES]
    if unknown:
        raise ValueError(f"There is no setting '{unknown[0]}'")
    values = {name: known[name].default for name in NAMES}
    return SimpleNamespace(**values | {name: _value(known[name], value) for name, value in given.items()})


def _value(prop: Any, value: Any) -> Any:
    """A value for a property, in its range. Raises: ValueError."""
    if prop.type == "ENUM":
        known = [item.identifier for item in prop.enum_items]
        if value not in known:
            raise ValueError(f"{prop.identifier} is one of {', '.join(known)}, not {value!r:.60}")
    elif prop.type in {"INT", "FLOAT"} and isinstance(value, int | float):
        kind = int if prop.type == "INT" else float
        return kind(min(max(value, prop.hard_min), prop.hard_max))
    elif not isinstance(value, {"STRING": str, "BOOLEAN": int}.get(prop.type, ())):
        raise ValueError(f"{prop.identifier} is of the type {prop.type.lower()}, not {value!r:.60}")
    return value


def _levels(levels: Levels) -> tuple[str, list[Object]]:
    """The text for levels, which the cages keep, and own objects."""
    if isinstance(levels, str):
        return levels, []
    listed = [levels] if isinstance(levels, int | float | core.Within) else list(levels)
    return ", ".join(map(_word, listed)), [level for level in listed if isinstance(level, Object)]


def _word(level: Level) -> str:
    """One level as text. Raises: ValueError."""
    if isinstance(level, Object):
        return OWN
    if isinstance(level, core.Within):
        return f"+{100.0 * level.excess!r}%" if level.excess is not None else f"{level.limit!r}{OWN_UNIT}"
    if isinstance(level, float):
        if not 0.0 < level < 1.0:
            raise ValueError(f"A level given as a fraction is between 0 and 1, not {level!r}")
        return f"{100.0 * level:.6f}%"
    return str(level)


@contextmanager
def _shown(context: Context, objects: Sequence[Object]) -> Iterator[None]:
    """Temporarily shows drawings that the animation of earlier cages hides, on the frame that it is."""
    scene = scene_of(context)
    moment = (scene.frame_current, scene.frame_subframe)
    hiding = [each for obj in objects for each in CageSet.all_of(obj) if each.record.playing]
    visibility.leave(*hiding)
    context.view_layer.update()
    try:
        yield
    finally:
        for cage_set in hiding:
            if cage_set.counts:
                visibility.enter(cage_set)
        if (scene.frame_current, scene.frame_subframe) != moment:
            scene.frame_set(moment[0], subframe=moment[1])
