"""Random edits before, between and during jobs: only sentences, nothing half done, and outputs that verify."""

import random
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np

from .blender import ESCAPE, GOES_ON, OTHER, TIMER, Window, running
from .drawings import circle, grid_face, poly_curve, snapshot, star, text, try_operator, wire
from .panels import draw

SECONDS = 60.0
"""Time after which a sequence takes no further step."""

STRANGE = [None, 0, -1, 10**9, 1.5, float("nan"), float("inf"), "", "x", "\N{SNOWMAN}" * 70, b"\xff", [1, 2], [0.5], {}]
"""Values that files of strangers may have under names of ours."""

OTHERS = (
    "generate", "verify", "bind", "puppet", "cancel", "follow", "live",
    "remove_animation", "select_fault",
)  # fmt: skip
"""Operators that need no file."""

KEYS = tuple(
    f"nested_cages_{name}" for name in ("member", "part", "layer", "cap", "playing", "proved", "cage", "level")
)
"""Names of properties as the add-on writes them, of today and of other versions."""

WAYS_TO_STOP = ("escape", "button", "Blender", "quit", "another file")


class Artist:
    """Does random things to the scene, and checks what must hold after each."""

    def __init__(self, seed: int, extension: ModuleType, window: Window, folder: Path) -> None:
        self.random = random.Random(seed)
        self.extension, self.window = extension, window
        self.file = folder / "scene.blend"
        self.done: list[str] = []
        self.opened = False

    def act(self) -> None:
        """One random step."""
        step = self.random.choice([self.draw, self.generate, self.generate, self.run_other, self.edit, self.edit])
        step()
        self.push()
        assert not running()
        draw()  # what is in the panels can be drawn, whatever the scene is

    def live_through(self, steps: int) -> None:
        """So many steps, as long as there is time."""
        began = time.monotonic()
        self.draw()
        try:
            for _ in range(steps):
                if time.monotonic() - began < SECONDS:
                    self.act()
        except BaseException:
            print("steps:", *self.done, sep="\n  ")
            raise

    def tell(self, what: str) -> None:
        self.done.append(what)

    # Edits

    def draw(self) -> None:
        """Add a drawing; it is selected and active."""
        self.object_mode()
        bpy.context.scene.frame_end = 6
        name, count = self.random.choice("ABC"), self.random.randint(5, 40)
        made = self.random.randrange(5)
        self.tell(f"draw {made} {name} {count}")
        for obj in bpy.context.selected_objects:
            obj.select_set(self.random.random() < 0.3)
        if made == 0:
            poly_curve(name, [star(3 * count, 0.3)])
        elif made == 1:
            wire(name, [circle(count), circle(count, 0.4)])
        elif made == 2:
            grid_face(name)
        elif made == 3:
            text(name, "ab")
        else:
            wire(name, [circle(count) * self.random.choice([1.0, 0.0, 1e-9, 1e9])])  # some are no drawing at all
        bpy.context.view_layer.update()

    def edit(self) -> None:
        """Any change that an artist can make between two clicks."""
        changes = [
            self.move_points, self.delete_points, self.rename, self.delete, self.transform, self.select, self.duplicate,
            self.undo, self.redo, self.save_and_load, self.edit_mode, self.strange_property, self.join, self.frame,
            self.remove_collection, self.unlink,
        ]  # fmt: skip
        change = self.random.choice(changes)
        self.tell(change.__name__)
        change()
        self.push()

    def push(self) -> None:
        """What Blender does after every change; without it, undo and redo of Blender itself leave loose ends."""
        bpy.context.view_layer.update()
        bpy.ops.ed.undo_push(message="edit")

    def object_mode(self) -> None:
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")

    def some(self) -> Any:
        """An object, or None."""
        objects = sorted(bpy.data.objects, key=lambda obj: obj.name)
        return self.random.choice(objects) if objects else None

    def meshes(self) -> list[Any]:
        return sorted(bpy.data.meshes, key=lambda mesh: mesh.name)

    def move_points(self) -> None:
        self.object_mode()
        for mesh in self.meshes()[:3]:
            points = np.empty(3 * len(mesh.vertices), np.float32)
            mesh.vertices.foreach_get("co", points)
            if len(points):
                points[self.random.randrange(len(points))] += self.random.choice([0.1, -0.3, 5.0, float("nan")])
                mesh.vertices.foreach_set("co", points)
                mesh.update()

    def delete_points(self) -> None:
        self.object_mode()
        if self.meshes():
            mesh = self.random.choice(self.meshes())
            if not mesh.shape_keys:
                mesh.clear_geometry()

    def rename(self) -> None:
        for item in (self.some(), *list(bpy.data.collections)[:1]):
            if item is not None:
                item.name = self.random.choice(["A", "B", "x" * 63, "\N{SNOWMAN}", "A Cages", "."])

    def delete(self) -> None:
        self.object_mode()
        obj = self.some()
        if obj is not None:
            bpy.data.objects.remove(obj)

    def remove_collection(self) -> None:
        if bpy.data.collections:
            bpy.data.collections.remove(self.random.choice(list(bpy.data.collections)))

    def unlink(self) -> None:
        self.object_mode()
        obj = self.some()
        if obj is not None and obj.users_collection:
            obj.users_collection[0].objects.unlink(obj)

    def transform(self) -> None:
        obj = self.some()
        if obj is not None:
            obj.scale[self.random.randrange(3)] = self.random.choice([2.0, 0.0, -1.0, 1e-30, float("nan")])
            obj.location.x = self.random.choice([0.0, 100.0, 1e30, float("inf")])
            obj.rotation_euler.x = self.random.choice([0.0, 1.0])
            bpy.context.view_layer.update()

    def select(self) -> None:
        self.object_mode()
        known = [obj for obj in bpy.data.objects if bpy.context.view_layer.objects.get(obj.name) == obj]
        for obj in known:
            obj.select_set(self.random.random() < 0.5)
        bpy.context.view_layer.objects.active = self.random.choice(known) if known else None

    def duplicate(self) -> None:
        self.object_mode()
        if bpy.context.selected_objects:
            bpy.ops.object.duplicate(linked=self.random.random() < 0.3)

    def join(self) -> None:
        self.object_mode()
        active = bpy.context.view_layer.objects.active
        if active is not None and active.type == "MESH" and active.select_get():
            bpy.ops.object.join()

    def undo(self) -> None:
        if bpy.ops.ed.undo.poll():
            try_operator(bpy.ops.ed.undo)

    def redo(self) -> None:
        if bpy.ops.ed.redo.poll():
            try_operator(bpy.ops.ed.redo)

    def save_and_load(self) -> None:
        self.object_mode()
        bpy.ops.wm.save_as_mainfile(filepath=str(self.file), check_existing=False)
        if self.random.random() < 0.7:
            bpy.ops.wm.open_mainfile(filepath=str(self.file))
            self.opened = True

    def edit_mode(self) -> None:
        active = bpy.context.view_layer.objects.active
        if bpy.context.mode != "OBJECT":
            self.object_mode()
        elif active is not None and active.type in {"MESH", "CURVE"} and active.visible_get():
            try_operator(lambda: bpy.ops.object.mode_set(mode="EDIT"))

    def frame(self) -> None:
        bpy.context.scene.frame_set(self.random.choice([1, 20, -5, 1000]))

    def strange_property(self) -> None:
        for item in (self.some(), self.random.choice([*bpy.data.collections, None]), bpy.context.scene):
            if item is not None:
                key, value = self.random.choice(KEYS), self.random.choice(STRANGE)
                if value is None:
                    item.pop(key, None)
                else:
                    item[key] = value

    # Jobs

    def generate(self) -> None:
        """Generate cages by ticks; meanwhile the artist may edit, cancel, quit or open another file."""
        self.object_mode()
        levels = self.random.choice(["12", "20, 10", "4", "50%", "8, 9", "x", "", "1e9"])
        self.tell(f"generate {levels!r}")
        operator, context = self.window.operator("generate", levels=levels), self.window.context
        before = repr(snapshot())
        self.window.log.clear()
        outcome = self.window.invoke(operator)
        edited = False
        while outcome in GOES_ON:
            chance = self.random.random()
            if chance < 0.02:
                self.stop(operator, context, None if edited else before)
                return
            if chance < 0.1:
                edited, self.opened = True, False
                self.edit()
                self.object_mode()
                if self.opened:  # Blender ends the operator
                    operator.cancel(context)
                    return
            if chance < 0.2:
                assert operator.modal(context, OTHER) == {"PASS_THROUGH"}
            self.window.look()
            outcome = self.window.tick(operator)
        for entry in self.window.log:  # what was reported is in sentences, never an exception
            assert not isinstance(entry, tuple) or ("Traceback" not in entry[-1] and len(entry[-1]) < 2000)
        assert outcome in ({"FINISHED"}, {"CANCELLED"})
        if outcome == {"CANCELLED"} and not edited:
            assert repr(snapshot()) == before
        if outcome == {"FINISHED"} and not edited:
            assert try_operator(bpy.ops.object.nested_cages_verify) in ({"FINISHED"}, {"CANCELLED"})

    def stop(self, operator: Any, context: Any, before: str | None) -> None:
        """Stop the job in any way; where nothing was edited, nothing has changed."""
        how = self.random.choice(WAYS_TO_STOP)
        self.tell(f"stop by {how}")
        if how == "escape":
            assert operator.modal(context, ESCAPE) == {"CANCELLED"}
        elif how == "button":
            bpy.ops.object.nested_cages_cancel()
            assert operator.modal(context, TIMER) == {"CANCELLED"}
        elif how == "Blender":
            operator.cancel(context)
        elif how == "quit":
            self.extension.unregister()
            self.extension.register()
        else:
            bpy.ops.wm.read_factory_settings(use_empty=True)
            operator.cancel(context)
            before = None
        if before is not None:
            assert repr(snapshot()) == before

    def run_other(self) -> None:
        """Any other operator, as a script would call it."""
        self.object_mode()
        name = self.random.choice(OTHERS)
        self.tell(name)
        known = getattr(bpy.ops.object, f"nested_cages_{name}")
        if known.poll():
            try_operator(known)
