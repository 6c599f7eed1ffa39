"""Bind, Rebind, Unbind, and handles at the corners of a bound cage; Rig and Suggest Bones."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy.types import Context, Object

from .. import characters, record
from ..binding import binding, field, handles
from ..binding.copies import complete
from ..binding.field import HARMONIC, LINEAR, NAMES
from ..core import core
from ..errors import UserError, counted
from ..generation.job import Progress, Work, drain
from ..keys import found_object
from ..properties.kinds import choice, length, number, whole
from ..record import CageSet
from ..scene import filling, ownership
from ..scene.areas import paints
from ..scene.blocks import removed_on_failure
from ..scene.convert import Drawing
from ..scene.ownership import check_free, select, sets_of_chosen
from .base import JobOperator, SetOperator, pose
from .views import OUTLINES

METHOD_ITEMS = (
    ("AUTO", "Automatic", "Harmonic; linear where that would take too many weights to play"),
    (HARMONIC, NAMES[HARMONIC], "Smooth, also in concave cages and around holes"),
    (LINEAR, NAMES[LINEAR], "Linear on the triangles of the cage: nothing leaves it unless a triangle flips"),
)


class BindingOperator(SetOperator):
    """Works on sets that are bound, or are not bound yet."""

    needs_bound = True
    purpose = "move it: select cages around it"
    exclusive = True

    @classmethod
    def unsuitable(cls, cage_set: CageSet) -> str:
        bound = bool(cage_set.bound)
        if bound == cls.needs_bound or (bound and next(binding.newcomers(bpy.context), None) is not None):
            return ""
        return "Nothing is bound to these cages" if cls.needs_bound else "These cages are already bound"


class LinkOperator(BindingOperator):
    """Base of Bind and Rebind."""

    method: choice("Method", "How each level follows the next coarser one", METHOD_ITEMS, default="AUTO")

    shown_by = (OUTLINES,)

    def each(self, context: Context, cage_set: CageSet) -> Work[str]:
        if not self.needs_bound and bool(cage_set.bound):
            return binding.take_in(context, cage_set)
        return (binding.rebind if self.needs_bound else binding.steps)(context, cage_set, self.method)

    def all(self, context: Context, sets: Sequence[CageSet]) -> Work[list[str | UserError]]:
        return binding.in_step(context, [self.each(context, cage_set) for cage_set in sets])

    def finish(self, context: Context, done: Sequence[tuple[CageSet, str]]) -> None:
        cages = [cage_set.cages[-1] for cage_set, _ in done]
        select(context, *cages)
        name = f"'{cages[0].name}'" if len(cages) == 1 else f"the {len(cages)} coarsest cages"
        said = done[0][1] if len(done) == 1 else f"{len(done)} drawings follow"
        self.report({"INFO"}, f"Move {name} and the drawing follows. {said}")


class OBJECT_OT_nested_cages_bind(LinkOperator, bpy.types.Operator):
    """Make the drawing follow its cages: move, key, sculpt or rig the coarsest one, and edit finer ones for detail. The
    file works without the add-on
    """

    bl_label = "Bind to Cages"
    needs_bound = False


class OBJECT_OT_nested_cages_rebind(LinkOperator, bpy.types.Operator):
    """Bind the drawing in its original shape to the cages as they are now"""

    bl_label = "Rebind"


class OBJECT_OT_nested_cages_unbind(BindingOperator, bpy.types.Operator):
    """Restore cages and drawing as they were before binding, with their animation"""

    bl_label = "Unbind"

    def each(self, _context: Context, cage_set: CageSet) -> Work[None]:
        check_free(cage_set.members)
        yield from ()

    def finish(self, _context: Context, done: Sequence[tuple[CageSet, None]]) -> None:
        for sentence in binding.unbind(*(cage_set for cage_set, _ in done)):
            self.report({"WARNING"}, sentence)


class OBJECT_OT_nested_cages_add_handles(SetOperator, bpy.types.Operator):
    """Add an armature with a bone per corner of the coarsest cage to move that corner and the drawing"""

    bl_label = "Add Handles"
    purpose = "move it: select cages around it"

    @classmethod
    def unsuitable(cls, cage_set: CageSet) -> str:
        if not cage_set.bound:
            return "Bind the drawing to its cages first"
        cage = cage_set.cages[-1]
        if handles.handles_of(cage):
            return f"'{cage.name}' has handles already"
        return "" if cage.is_editable else f"'{cage.name}' cannot be changed because it is linked from another file"

    def finish(self, context: Context, done: Sequence[tuple[CageSet, None]]) -> None:
        cages = [cage_set.cages[-1] for cage_set, _ in done]
        pose(context, handles.add(context, cages))
        number = sum(len(filling.points_of(filling.mesh_of(cage))) for cage in cages)
        self.report({"INFO"}, f"{counted(number, 'handle')}: move them, and the drawing follows")


class OnParts(JobOperator):
    """Works on all that the selected drawings paint."""

    gap: length("Join Gaps", "Join parts that are closer than this, so that one skeleton can move both")

    needs = staticmethod(lambda context: _drawings(context))
    missing = "Select the drawings: meshes, curves, texts or Grease Pencil"

    def united(self, context: Context, parts: Sequence[Object]) -> tuple[Drawing, list[UserError]]:
        """The parts in their own shapes as one drawing, and why some were left out. Raises: UserError."""
        self.tell_hidden(context, parts)
        with field.unposed(map(field.shown_by, parts)):
            return drain(characters.united_drawing(context, parts, self.gap))


class OBJECT_OT_nested_cages_rig(OnParts, bpy.types.Operator):
    """Put one cage around all selected drawings, with vertices where joints need them, and let bones move them all:
    those of the selected armature, or else new ones along the limbs
    """

    bl_label = "Rig"

    vertices: whole("Vertices", "Vertices of the cage apart from those at joints; 0: as many as its loops need", min=0)

    shown_by = (OUTLINES,)

    def work(self, context: Context) -> Work[None]:
        armature = _armature(context)
        complete()
        groups = ownership.with_parts(_drawings(context))
        parts, identity = [part for group in groups for part in group], armature and armature.session_uid
        whole, problems = self.united(context, parts)
        yield Progress(0.0, "uniting painted areas")
        with removed_on_failure():
            given = found_object(identity) if identity else None
            armature = given or characters.add_skeleton(context, whole, core.character.Skeleton())[0]
            if (identity and not given) or whole.source is None:
                raise UserError("The armature or a drawing was deleted meanwhile, so the cage was discarded")
            cage_set = yield from characters.make(context, whole, armature, self.vertices)
        cage = cage_set.cages[-1]
        pose(context, armature)
        self.tell_skipped(problems, "object")
        self.report(
            {"INFO"},
            f"{counted(len(parts), 'drawing')} in a cage of {len(cage.data.vertices)} vertices: "
            f"pose '{armature.name}', and they follow",
        )


class OBJECT_OT_nested_cages_suggest_bones(OnParts, bpy.types.Operator):
    """Draw an armature along the limbs of the selected drawings, to edit or to use as it is"""

    bl_label = "Suggest Bones"

    protrudes: number(
        "Limbs Protrude",
        "How far a limb reaches out at least, in radii of the body there; larger: fewer limbs",
        default=1.0,
        min=0.05,
        soft_max=5.0,
    )
    bends: number(
        "Limbs Bend",
        "How far a bone may be from the middle of its limb, in radii; larger: fewer joints",
        default=0.35,
        min=0.02,
        soft_max=2.0,
    )
    longest: number(
        "Longest Bone",
        "Straight bones longer than this get a joint in the middle, in radii of the limb",
        default=7.0,
        min=1.0,
        soft_max=30.0,
    )

    def work(self, context: Context) -> Work[None]:
        parts = [part.session_uid for part in _drawings(context)]
        whole, problems = self.united(context, _drawings(context))
        yield Progress(0.0, "uniting painted areas")
        skeleton = core.character.Skeleton(self.protrudes, self.bends, self.longest)
        armature, number = characters.add_skeleton(context, whole, skeleton)
        select(context, *(obj for part in parts if (obj := found_object(part)) is not None), armature)
        self.tell_skipped(problems, "object")
        self.report({"INFO"}, f"{counted(number, 'bone')}: edit them, then press Rig")


def _drawings(context: Context) -> Sequence[Object]:
    """The selected objects that paint something and are no cages; of an armature alone, what it moves."""
    drawn = [obj for obj in context.selected_objects if paints(obj) and record.level_of(obj) is None]
    return drawn or [obj for each in sets_of_chosen(context) for obj in each.originals]


def _armature(context: Context) -> Object | None:
    """The selected armature, of several the active one; else the one that moves the selected drawings already."""
    active = context.view_layer.objects.active
    armatures = [obj for obj in context.selected_objects if obj.type == "ARMATURE"]
    cages = [each.members[-1] for each in sets_of_chosen(context)] if not armatures else []
    rigs = [each for cage in cages for each in cage.modifiers if isinstance(each, bpy.types.ArmatureModifier)]
    moving = [each.object for each in rigs if each.object is not None]
    return active if active in armatures else next(iter((*armatures, *moving)), None)
