"""Bind to Cages: move, key, sculpt or rig a cage, and its contents follow."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty

from ..binding import binding
from ..binding.field import HARMONIC, LINEAR, NAMES
from ..errors import UserError
from ..generation.job import Work
from ..scene import ownership
from ..scene.selection import output_of_active, select
from .base import JobOperator, OnOutput, Outcome

METHOD_ITEMS = (
    ("AUTO", "Automatic", "Harmonic; linear where that would take too many weights to play"),
    (HARMONIC, NAMES[HARMONIC], "Smooth, also in concave cages and around holes"),
    (LINEAR, NAMES[LINEAR], "Linear on the triangles of the cage: nothing leaves it unless a triangle flips"),
)

# Wire threshold of a 3D view: all edges, Blender's default; or only borders and edges between faces at an angle.
ALL_EDGES, OUTLINES = 1.0, 0.5


class OnBinding(OnOutput):
    """Works on an output that is bound, or is not bound yet."""

    bl_options = {"REGISTER", "UNDO"}
    needs_bound = True
    purpose = "move it: select cages around it"

    @classmethod
    def unsuitable(cls, collection: bpy.types.Collection) -> str:
        if ownership.is_bound(collection) == cls.needs_bound:
            return ""
        return "Nothing is bound to these cages" if cls.needs_bound else "These cages are already bound"


class BindingOperator(OnBinding, JobOperator):
    """Base of Bind and Rebind."""

    exclusive = True

    method: EnumProperty(
        name="Method",
        description="How each level follows the next coarser one",
        items=METHOD_ITEMS,
        default="AUTO",
    )

    def show_result_in(self, context: bpy.types.Context) -> None:
        """Hides edges between coplanar triangles in the 3D view, unless the user has changed that setting."""
        space = context.space_data
        if isinstance(space, bpy.types.SpaceView3D) and space.overlay.wireframe_threshold == ALL_EDGES:
            space.overlay.wireframe_threshold = OUTLINES

    def work(self, context: bpy.types.Context) -> Work[Outcome]:
        collection = output_of_active(context)
        made = yield from (binding.rebind if self.needs_bound else binding.bind)(context, collection, self.method)
        cage = ownership.members(collection)[-1]
        select(context, cage)
        self.report(
            {"INFO"},
            f"Move '{cage.name}' and the drawing follows; error {max(link.rest for link in made.links):.1e} at rest. "
            f"{made.original}",
        )
        return {"FINISHED"}


class OBJECT_OT_nested_cages_bind(BindingOperator, bpy.types.Operator):
    """Binds every level to the next one."""

    bl_idname = "object.nested_cages_bind"
    bl_label = "Bind to Cages"
    bl_description = (
        "Make the drawing follow its cages: move, key, sculpt or rig the coarsest one, and edit finer ones for detail. "
        "The file works without the add-on"
    )
    needs_bound = False

    @classmethod
    def unsuitable(cls, collection: bpy.types.Collection) -> str:
        bound = ownership.is_bound(collection)
        return "" if bound and binding.newcomers(bpy.context, collection) else super().unsuitable(collection)

    def work(self, context: bpy.types.Context) -> Work[Outcome]:
        collection = output_of_active(context)
        if not ownership.is_bound(collection):
            return (yield from super().work(context))
        self.report({"INFO"}, f"{binding.take_in(context, collection)} bound, with what is in the cages already")
        return {"FINISHED"}


class OBJECT_OT_nested_cages_rebind(BindingOperator, bpy.types.Operator):
    """Binds again to edited cages."""

    bl_idname = "object.nested_cages_rebind"
    bl_label = "Rebind"
    bl_description = "Bind the drawing in its original shape to the cages as they are now"


class OBJECT_OT_nested_cages_unbind(OnBinding, bpy.types.Operator):
    """Restores cages and drawing."""

    bl_idname = "object.nested_cages_unbind"
    bl_label = "Unbind"
    bl_description = "Restore cages and drawing as they were before binding, with their animation"

    def execute(self, context: bpy.types.Context) -> Outcome:
        collection = output_of_active(context)
        problem = next(filter(None, map(ownership.why_locked, ownership.members(collection))), "")
        if problem:
            return self.fail(UserError(problem))
        for sentence in binding.unbind(collection):
            self.report({"WARNING"}, sentence)
        return {"FINISHED"}


CLASSES = (OBJECT_OT_nested_cages_bind, OBJECT_OT_nested_cages_rebind, OBJECT_OT_nested_cages_unbind)
