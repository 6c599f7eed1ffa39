"""Random edits of a character and of a puppet: after each, all parts follow the bones, and Verify holds or tells."""

from random import Random

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .drawings import certificate, choose, holds
from .figure import LIMBS, capsule, face, figure, points


class Animator:
    """Edits a character; its objects are looked up by their names each time, since undo and loading make new ones."""

    def __init__(self, random: Random, path: str) -> None:
        self.random, self.path, self.count = random, path, 0
        self.others: dict[str, np.ndarray] = {}
        self.names = list(figure())
        assert bpy.ops.object.nested_cages_puppet(source="BONES") == {"FINISHED"}
        self.bones = bpy.context.object.name
        self.rig()
        self.move()

    @property
    def parts(self):
        return [bpy.data.objects[name] for name in self.names]

    @property
    def armature(self):
        return bpy.data.objects[self.bones]

    @property
    def cages(self):
        """The cage that the bones of the character move."""
        found = [o for o in bpy.context.scene.objects if any(m.type == "ARMATURE" for m in o.modifiers)]
        return [o for o in found if next(m for m in o.modifiers if m.type == "ARMATURE").object == self.armature]

    def shown(self):
        """Displayed points of each part."""
        bpy.context.view_layer.update()
        return {part.name: points(part) for part in self.parts}

    def went_by(self, motion: Matrix, before) -> None:
        """All parts went from where they were as one piece."""
        for name, now in self.shown().items():
            wanted = np.array([motion @ Vector(point) for point in before[name]])
            np.testing.assert_allclose(now, wanted, atol=2e-4, err_msg=name)

    def as_drawn(self) -> None:
        """Meshes are shown as they were drawn."""
        for name, now in self.shown().items():
            part = bpy.data.objects[name]
            if part.type == "MESH":
                own = np.array([part.matrix_world @ vertex.co for vertex in part.data.vertices])
                np.testing.assert_allclose(now, own, atol=1e-4, err_msg=name)

    def others_stay(self) -> None:
        bpy.context.view_layer.update()
        for name, before in self.others.items():
            np.testing.assert_allclose(points(bpy.data.objects[name]), before, atol=1e-5, err_msg=name)

    def rig(self) -> None:
        """Regenerates."""
        choose(*self.parts, self.armature)
        assert bpy.ops.object.nested_cages_puppet(source="ONE_CAGE") == {"FINISHED"}
        bpy.ops.object.mode_set(mode="OBJECT")

    def turn(self) -> None:
        for bone in self.armature.pose.bones:
            if self.random.random() < 0.3:
                turned = Matrix.Rotation(np.deg2rad(self.random.uniform(-30.0, 30.0)), 3, "Z")
                local = bone.bone.matrix_local.to_3x3()
                bone.rotation_quaternion = (local.inverted() @ turned @ local).to_quaternion()

    def move(self) -> None:
        """Moves the armature, which carries all parts."""
        before, shown = self.armature.matrix_world.copy(), self.shown()
        self.armature.location += Vector(self.random.uniform(-2.0, 2.0) for _ in range(3))
        self.armature.rotation_euler.z += self.random.uniform(-1.0, 1.0)
        bpy.context.view_layer.update()
        self.went_by(self.armature.matrix_world @ before.inverted(), shown)

    def redraw(self) -> None:
        """Moves a part a little, and in the stack, and gives another one other data."""
        part = self.random.choice(self.parts)
        part.location += Vector((0.01, -0.01, self.random.uniform(-0.01, 0.01)))
        part = self.random.choice([part for part in self.parts if part.type == "MESH"])
        part.data = part.data.copy()
        part.data.transform(Matrix.Translation((self.random.uniform(-0.02, 0.02), 0.0, 0.0)))
        part.data.update()

    def add(self) -> None:
        """Draws a part, which is bound by its button."""
        self.rest()
        self.count += 1
        (x, y), _, radius = self.random.choice(list(LIMBS.values()))
        part = face(f"Part {self.count}", capsule((x, y), (x + 0.02, y), 0.6 * radius))
        part.matrix_world = self.armature.matrix_world @ part.matrix_world
        self.names.append(part.name)
        choose(part, *self.cages)
        assert bpy.ops.object.nested_cages_bind() == {"FINISHED"}

    KEPT: tuple[str, ...] = ()
    """Beginnings of the names of parts that are never deleted."""

    def delete(self) -> None:
        """Deletes a part, and regenerates, since the others may have stood in its space."""
        if len(self.names) > 6:
            name = self.random.choice([each for each in self.names if not each.startswith(self.KEPT)])
            choose(bpy.data.objects[name])
            bpy.ops.object.delete()
            self.names.remove(name)
            self.rest()
            self.rig()

    def copy(self) -> None:
        """Goes on with a copy of all that is seen; what was copied stays as it is."""
        choose(*self.parts, *self.cages, self.armature)
        kept = list(bpy.context.selected_objects)
        assert bpy.ops.object.duplicate() == {"FINISHED"}
        copies = list(bpy.context.selected_objects)
        assert len(copies) == len(kept)
        self.others = self.shown()
        self.bones = next(obj.name for obj in copies if obj.type == "ARMATURE")
        self.names = [obj.name for obj in copies if obj.type != "ARMATURE" and "Cage" not in obj.name]
        if self.random.random() < 0.5:  # else it is a character as it is
            self.rig()

    def undo(self) -> None:
        bpy.ops.ed.undo_push(message="before")
        self.turn()
        bpy.ops.ed.undo_push(message="turned")
        bpy.ops.ed.undo()

    def save(self) -> str:
        self.count += 1
        path = f"{self.path}{self.count}.blend"
        bpy.ops.wm.save_as_mainfile(filepath=path)
        return path

    def reload(self) -> None:
        bpy.ops.wm.open_mainfile(filepath=self.save())

    def append(self) -> None:
        """Goes on in a new file with parts and bones appended from the old one, which take their cages along."""
        path, names = self.save(), [*self.names, self.bones]
        bpy.ops.wm.read_homefile(use_empty=True)
        bpy.ops.wm.append(directory=f"{path}/Object/", files=[{"name": name} for name in names])
        self.others = {}

    EDITS = (rig, turn, move, redraw, add, delete, copy, undo, reload, append)

    def rest(self) -> None:
        for bone in self.armature.pose.bones:
            bone.matrix_basis = Matrix()
        bpy.context.view_layer.update()

    def check(self) -> None:
        self.others_stay()
        for part in self.parts:
            assert [m.name for m in part.modifiers] == ["Nested Cages Follow"], part.name
        kept = {bone.name: bone.matrix_basis.copy() for bone in self.armature.pose.bones}
        posed = self.shown()
        self.rest()
        self.as_drawn()
        before, (cage,) = self.shown(), self.cages
        choose(cage)
        assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
        told = certificate(cage).finding
        assert holds(cage) or any(f"'{name}" in told for name in self.names), told
        # All roots together turn and move everything as one piece.
        inverse, turn = self.armature.matrix_world.inverted(), Matrix.Rotation(0.5, 4, "Z")
        motion = self.armature.matrix_world @ Matrix.Translation((0.3, 0.2, 0.0)) @ turn @ inverse
        for bone in self.armature.pose.bones:
            if bone.parent is None:
                bone.matrix = inverse @ motion @ self.armature.matrix_world @ bone.bone.matrix_local
        self.went_by(motion, before)
        for bone in self.armature.pose.bones:
            bone.matrix_basis = kept[bone.name]
        self.went_by(Matrix(), posed)


class Puppeteer(Animator):
    """Edits a puppet; what its parts are comes from its armature, and so what was made by hand is known."""

    def __init__(self, random: Random, path: str) -> None:
        self.random, self.path, self.count = random, path, 0
        self.names, self.others = list(figure()), {}
        choose(*self.parts)
        assert bpy.ops.object.nested_cages_puppet() == {"FINISHED"}
        self.bones = bpy.context.object.name
        bpy.ops.object.mode_set(mode="OBJECT")

    @property
    def own(self):
        """The bones of parts."""
        return [bone for bone in self.armature.pose.bones if bone.bone["nested_cages_part"]]

    def rig(self) -> None:
        """Makes the puppet again: bones of parts that are still there stay in their places."""
        before = {bone.name: bone.bone.head_local.copy() for bone in self.own}
        choose(*self.parts, self.armature)
        assert bpy.ops.object.nested_cages_puppet() == {"FINISHED"}
        assert bpy.context.object == self.armature
        now = {bone.name: bone.bone.head_local for bone in self.own}
        for name in before.keys() & now.keys():
            np.testing.assert_allclose(now[name], before[name], atol=1e-5, err_msg=name)
        assert len(before.keys() - now.keys()) <= 3
        bpy.ops.object.mode_set(mode="OBJECT")

    def turn(self) -> None:
        for bone in self.own:
            if self.random.random() < 0.3:
                bone.rotation_euler.z = np.deg2rad(self.random.uniform(-50.0, 50.0))

    def paint(self) -> None:
        """Paints weights, and makes the puppet again, in which they stay."""
        bending = [obj for obj in bpy.context.scene.objects if "Bend" in obj.name and obj.vertex_groups]
        mine = [obj for obj in bending if obj.parent == self.armature]
        mesh = self.random.choice(mine)
        place = self.random.choice(mesh.data.vertices).co.copy()
        spot = sorted(mesh.data.vertices, key=lambda vertex: (vertex.co - place).length)[:20]
        for group in mesh.vertex_groups:
            group.add([vertex.index for vertex in spot], 0.5, "REPLACE")
        name = mesh.name
        self.rig()
        mesh = bpy.data.objects[name]  # whose vertices may be others
        vertex = min(mesh.data.vertices, key=lambda vertex: (vertex.co - place).length).index
        np.testing.assert_allclose([group.weight(vertex) for group in mesh.vertex_groups], 0.5, atol=1e-3)

    KEPT = ("Torso",)
    cages: tuple[()] = ()

    def rest(self) -> None:
        """Puppets are made again in any pose."""

    def copy(self) -> None:
        super().copy()
        choose(*self.parts, self.armature)
        assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}

    EDITS = (rig, turn, Animator.move, paint, Animator.delete, copy, *Animator.EDITS[-3:])

    def check(self) -> None:
        """The root moves all as one piece, and the drawing at rest is as it was drawn."""
        self.others_stay()
        posed = self.shown()
        root = self.armature.pose.bones["Root"]
        root.rotation_euler.z, root.location.x = 0.4, 0.3
        bpy.context.view_layer.update()
        local = root.matrix @ root.bone.matrix_local.inverted()
        self.went_by(self.armature.matrix_world @ local @ self.armature.matrix_world.inverted(), posed)
        root.rotation_euler.z, root.location.x = 0.0, 0.0
        kept = {bone.name: bone.rotation_euler.z for bone in self.own}
        for bone in self.own:
            bone.rotation_euler.z = 0.0
        self.as_drawn()
        for bone in self.own:
            bone.rotation_euler.z = kept[bone.name]
