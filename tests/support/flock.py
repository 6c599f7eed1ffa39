"""A figure of three parts in common cages, and random edits of it and its copies."""

from random import Random
from typing import Any

import bpy
import numpy as np

from .drawings import bind, choose, circle, generate, save, set_of, sets, try_operator, wire, world

PARTS = ("Body", "Head", "Hat")


def flock(*, bound: bool = True) -> Any:
    """Three drawings in two common cages; their set."""
    parts = [wire(name, [circle(24, 1.0, (0.0, 3.0 * k))]) for k, name in enumerate(PARTS)]
    choose(*reversed(parts))
    generate("24, 12", together=True, show_flow=False)
    if bound:
        bind()
    return set_of(parts[0])


def copied(*objects: Any, linked: bool = False) -> dict[str, Any]:
    """Duplicates of objects by the names of the originals."""
    choose(*objects)
    bpy.ops.object.duplicate(linked=linked)
    bpy.context.view_layer.update()
    return {obj.name.rpartition(".")[0]: obj for obj in bpy.context.selected_objects}


class Flock:
    """A figure and what becomes of it and its copies."""

    def __init__(self, random: Random, path: str) -> None:
        self.path, self.random = f"{path}.blend", random
        flock()

    def some(self) -> Any:
        found = sorted((each for each in sets().everywhere() if each.parts), key=lambda each: each.cages[0].name)
        return self.random.choice(found) if found else flock()

    def copy(self) -> None:
        made = self.some()
        copied(*made.parts, *made.cages, linked=self.random.random() < 0.3)

    def copy_some(self) -> None:
        made = self.some()
        copied(*self.random.sample([*made.parts, *made.cages], 2))

    def delete(self) -> None:
        made = self.some()
        choose(self.random.choice([*made.parts, *made.cages]))
        bpy.ops.object.delete()

    def operate(self) -> None:
        choose(self.some().parts[0])
        action = self.random.choice(("UNBIND", "REST_FROM_POSE", "BIND", "TOGGLE"))
        if bpy.ops.object.nested_cages_bind.poll():
            try_operator(bpy.ops.object.nested_cages_bind, action=action)

    def generate(self) -> None:
        choose(self.some().parts[0])
        try_operator(bpy.ops.object.nested_cages_generate, levels=self.random.choice(("12", "20, 10")))

    def reload(self) -> None:
        save(self.path, again=True)
        gone = [obj.name for obj in bpy.data.objects if not obj.users_collection and obj.type != "MESH"]
        assert not gone and all("Cage" in each for made in sets().everywhere() for each in made.missing)

    def undo(self) -> None:
        bpy.ops.ed.undo_push(message="before")
        self.copy()
        bpy.ops.ed.undo_push(message="copied")
        bpy.ops.ed.undo()

    EDITS = (copy, copy_some, delete, operate, operate, generate, reload, undo)

    def check(self) -> None:
        bpy.context.view_layer.update()
        cages: list[Any] = []
        for made in sets().everywhere():
            assert all(made in sets().all_of(obj) for obj in (*made.parts, *made.cages))
            if made.bound:
                assert all(part.modifiers for part in made.parts)
            cages += made.cages
            assert all(np.isfinite(world(part)).all() for part in made.parts)
        assert len(cages) == len(set(cages))
