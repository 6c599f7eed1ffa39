"""Random edits of a rigged drawing: after each of them weights, keys and places are where they belong."""

from __future__ import annotations

from random import Random
from typing import Any

import bpy
import numpy as np
from mathutils import Vector

from .drawings import base, choose, curves_of, evaluated, in_world, set_of, star, wire

SOURCE, ROOT = "Drawing", "Root"
LEVELS = ("20, 12", "24, 12", "16, 10", "14")
# Largest error of a weight that was resampled along outlines of other vertices, however often, and of one that was not.
RESAMPLED, SAME = 0.15, 1e-6


def field(points, seed):
    """A smooth value in [0, 1] for points (n, 3) of the drawing's space."""
    angle = 1.7 * seed
    return 0.5 + (points[:, 0] * np.cos(angle) + points[:, 1] * np.sin(angle)) / 8.0


class Rigger:
    """Edits a drawing with cages, and knows what must be found of it afterwards. Objects are looked up by their names
    each time, since undo and loading make new ones.
    """

    def __init__(self, random: Random, path: str) -> None:
        self.random, self.path = random, path
        self.groups: dict[str, int] = {}
        self.keys: dict[str, float] = {}
        self.resampled: set[str] = set()
        wire(SOURCE, [star() * 2.0])
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(ROOT, None))
        self.regenerate()
        self.push()

    @property
    def source(self):
        return bpy.data.objects[SOURCE]

    @property
    def fine(self) -> Any:
        return set_of(self.source).fine

    @property
    def cage(self) -> Any:
        """The cage that is worked on: the first one, which is always there."""
        return set_of(self.source).cages[0]

    @property
    def bound(self) -> bool:
        return bool(set_of(self.source).bound)

    def push(self) -> None:
        bpy.ops.ed.undo_push(message="edit")

    def regenerate(self) -> None:
        choose(self.source)
        bpy.context.scene.frame_set(1)
        assert bpy.ops.object.nested_cages_generate(levels=self.random.choice(LEVELS)) == {"FINISHED"}
        self.resampled = {*self.groups, *self.keys}

    def bind(self) -> None:
        choose(self.source)
        name = "unbind" if self.bound else "bind"
        assert getattr(bpy.ops.object, f"nested_cages_{name}")() == {"FINISHED"}

    def rebind(self) -> None:
        if self.bound:
            choose(self.source)
            assert bpy.ops.object.nested_cages_rebind() == {"FINISHED"}

    def paint(self) -> None:
        seed = len(self.groups)
        group = self.cage.vertex_groups.new(name=f"Group {seed}")
        for index, weight in enumerate(field(base(self.cage), seed)):
            group.add([index], float(weight), "REPLACE")
        self.groups[group.name] = seed

    def key(self) -> None:
        cage, stretch = self.cage, 1.0 + 0.1 * len(self.keys)
        if cage.data.shape_keys is None:
            cage.shape_key_add(name="Basis")
        key = cage.shape_key_add(name=f"Key {len(self.keys)}", from_mix=False)
        points = base(cage) * (1.0, stretch, 1.0)
        key.points.foreach_set("co", points.astype(np.float32).ravel())
        for frame, value in ((301, 0.0), (311, 1.0)):
            key.value = value
            key.keyframe_insert("value", frame=frame)
        self.keys[key.name] = stretch

    def move(self) -> None:
        step = Vector(self.random.uniform(-3.0, 3.0) for _ in range(3))
        self.source.location += step

    def parent(self) -> None:
        root = bpy.data.objects[ROOT]
        root.location = [self.random.uniform(-3.0, 3.0) for _ in range(3)]
        root.rotation_euler = [self.random.uniform(-1.0, 1.0) for _ in range(3)]
        self.source.parent = root

    def undo(self) -> None:
        """Moves and takes it back."""
        place = self.source.location.copy()
        self.move()
        self.push()
        bpy.ops.ed.undo()
        assert (self.source.location - place).length < 1e-6

    def redo(self) -> None:
        """Binds or unbinds, takes it back and does it again."""
        before = self.bound
        self.bind()
        self.push()
        bpy.ops.ed.undo()
        assert self.bound == before
        bpy.ops.ed.redo()
        assert self.bound != before

    def reload(self) -> None:
        bpy.ops.wm.save_as_mainfile(filepath=self.path)
        bpy.ops.wm.open_mainfile(filepath=self.path)
        self.push()

    EDITS = (regenerate, bind, rebind, paint, key, move, parent, undo, redo, reload)

    def check(self) -> None:
        self.push()
        bpy.context.view_layer.update()
        cage, points = self.cage, base(self.cage)
        names = {group.name: group.index for group in cage.vertex_groups}
        assert list(names) == list(self.groups)
        for name, seed in self.groups.items():
            found = np.zeros(len(points))
            for vertex in cage.data.vertices:
                for element in vertex.groups:
                    if element.group == names[name]:
                        found[vertex.index] = element.weight
            assert np.abs(found - field(points, seed)).max() < self.error(name), name
        for name, stretch in self.keys.items():
            key = cage.data.shape_keys.key_blocks[name]
            found = np.empty((len(points), 3), np.float32)
            key.points.foreach_get("co", found.ravel())
            assert np.abs(found - points * (1.0, stretch, 1.0)).max() < 4.0 * self.error(name), name
            curve = next(c for c in curves_of(cage.data.shape_keys) if c.data_path == f'key_blocks["{name}"].value')
            assert [tuple(point.co) for point in curve.keyframe_points] == [(301.0, 0.0), (311.0, 1.0)]
        assert self.source.matrix_world == cage.matrix_world == self.fine.matrix_world
        if self.bound and not any(key.value for key in (cage.data.shape_keys.key_blocks if self.keys else ())):
            shown, rest = evaluated(self.source), np.array([vertex.co for vertex in self.source.data.vertices])
            assert np.abs(in_world(self.source, shown) - in_world(self.source, rest)).max() < 2e-5

    def error(self, name) -> float:
        return RESAMPLED if name in self.resampled else SAME
