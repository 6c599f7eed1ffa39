"""Make Puppet: an armature that moves the parts of a layered drawing by themselves, or one cage around all of them, or
the vertices of cages; clips of its bones.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy.types import Context, Object

from .. import cage_sets
from ..bind import bind, field, handles
from ..bind.copies import complete
from ..blender import mesh_data
from ..blender.blocks import removed_on_failure
from ..blender.jobs import Progress, Work, drain
from ..blender.props import choice, flag, text, whole
from ..blender.views import OUTLINES
from ..cage_sets import CageSet, selection
from ..cage_sets.selection import check_local, chosen, each_of_chosen, scene_of, select, sets_of_chosen
from ..drawing import grease_pencil
from ..drawing.painted import paints
from ..drawing.planar import Drawing
from ..errors import UserError, counted
from ..files.pictures import image_on
from ..puppets import armatures, caps, clips, controls, duplicates, moving, one_cage
from .base import GapProperty, JobOperator, Operator, hide, pose

# Roles of objects that are no drawings of their own.
OWN_ROLES = (cage_sets.FIELD, cage_sets.PROXY)
# Degrees: joints that turn less without a fold are told, and what a joint of a rigid part turns.
WIDE, HALF_TURN = 60.0, 180.0


PARTS, ONE_CAGE, BONES, HANDLES = "PARTS", "ONE_CAGE", "BONES", "HANDLES"
SOURCE_ITEMS = (
    (PARTS, "Parts", "Each part moves by itself: those that overlap are joined, and long ones bend"),
    (ONE_CAGE, "One Cage", "A cage around all drawings bends them: by the selected armature, or bones along the limbs"),
    (BONES, "Bones Only", "An armature along the limbs, to edit before a puppet of one cage is made with it"),
    (HANDLES, "Handles", "A bone for each vertex of the coarsest cage, which moves that vertex and the drawing"),
)


class OBJECT_OT_nested_cages_puppet(JobOperator, GapProperty, bpy.types.Operator):
    """Give the selected drawings bones: a puppet of parts that move by themselves, one cage that bends them all, or a
    bone for each vertex of their cages. Parent a bone to another one and press again, and the puppet follows
    """

    bl_label = "Make Puppet"
    modes = ("OBJECT", "POSE")
    exclusive = True

    source: choice("From", "What the bones move", SOURCE_ITEMS, options={"SKIP_SAVE"})
    limits: flag("Limit Turns", "Limit each joint to the range in which nothing folds over itself", default=True)
    reach: flag("IK", "Let legs and arms follow the controls at their ends, instead of the turns of their bones")
    caps: flag("Painted Joints", "Let paint stay behind at joints, so that nothing opens there", default=True)
    linear: flag("Blend as Engines", "Blend bones linearly, as game engines do, instead of with Preserve Volume")
    vertices: whole("Vertices", "Vertices of the cage apart from those at joints; 0: as many as its loops need", min=0)

    needs = staticmethod(lambda context: _has_parts(context))
    missing = "Select the parts of a drawing: meshes, curves, texts, pictures or Grease Pencil"

    def draw(self, _context: Context) -> None:
        self.layout.use_property_split = True
        shown = {PARTS: ("limits", "reach", "caps", "linear"), ONE_CAGE: ("vertices", "gap"), BONES: ("gap",)}
        for name in ("source", *shown.get(self.source, ())):
            self.layout.prop(self, name)

    def work(self, context: Context) -> Work[None]:
        self.shown_by = () if self.source == BONES else (OUTLINES,)
        if self.source != PARTS and context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        work = {PARTS: self._parts, ONE_CAGE: self._one_cage, BONES: self._bones, HANDLES: self._handles}
        yield from work[self.source](context)

    def _parts(self, context: Context) -> Work[None]:
        """Bones for each part."""
        duplicates.complete_puppets()
        objects, old = _selected_parts(context)
        if not objects:
            raise UserError(self.missing)
        self.tell_hidden(context, objects)
        with removed_on_failure():
            layers = grease_pencil.stacked(context, objects[0]) if old is None and len(objects) == 1 else []
            title = objects[0].name if layers else ""
            options = moving.Making(self.limits, self.linear, float(self.reach), self.caps, title)
            yield from make_puppet(self, context, layers or objects, old, options)
        if layers:
            hide(objects)

    def _one_cage(self, context: Context) -> Work[None]:
        """A cage around all drawings, with vertices where joints need them, that bones move."""
        complete()
        parts = [part for group in selection.with_parts(_drawings(context)) for part in group]
        yield from make_one_cage(self, context, parts, _armature(context), self.vertices, self.gap)

    def _bones(self, context: Context) -> Work[None]:
        """An armature along the limbs of the drawings."""
        parts = _drawings(context)
        whole, problems = _united(self, context, parts, self.gap)
        yield Progress(0.0, "uniting painted areas")
        armature, number = one_cage.add_skeleton(context, whole)
        select(context, *parts, armature)
        self.tell_skipped(problems, "object")
        self.report({"INFO"}, f"{counted(number, 'bone')}: edit them, then make a puppet of one cage")

    def _handles(self, context: Context) -> Work[None]:
        """A bone for each vertex of the coarsest cages."""
        complete()
        sets = [each for each in sets_of_chosen(context, both=False) if not each.inside]
        if not sets:
            raise UserError("Select a drawing that has cages around it, or one of these cages")
        yield from add_handles(self, context, sets)


def add_handles(operator: Operator, context: Context, sets: Sequence[CageSet]) -> Work[None]:
    """A bone for each vertex of the coarsest cages of sets, which are bound first. Raises: UserError."""
    cages = [each.cages[-1] for each in sets]
    for cage in cages:
        check_local(cage)
        if handles.handles_of(cage):
            raise UserError(f"'{cage.name}' has handles already")
    yield from bind.bind_all(context, [each for each in sets if not each.bound])
    pose(context, handles.add(context, cages))
    number = sum(len(mesh_data.points_of(mesh_data.mesh_of(cage))) for cage in cages)
    operator.report({"INFO"}, f"{counted(number, 'handle')}: move them, and the drawing follows")


def make_one_cage(
    operator: Operator,
    context: Context,
    parts: Sequence[Object],
    armature: Object | None = None,
    vertices: int = 0,
    gap: float = 0.0,
) -> Work[None]:
    """One cage around drawings, bound, that an armature moves, or a new one along their limbs. Raises: UserError."""
    whole, problems = _united(operator, context, parts, gap)
    yield Progress(0.0, "uniting painted areas")
    with removed_on_failure():
        armature = armature or one_cage.add_skeleton(context, whole)[0]
        cage_set = yield from one_cage.make(context, whole, armature, vertices)
    pose(context, armature)
    operator.tell_skipped(problems, "object")
    operator.report(
        {"INFO"},
        f"{counted(len(parts), 'drawing')} in a cage of {len(cage_set.cages[-1].data.vertices)} vertices: "
        f"pose '{armature.name}', and they follow",
    )


def _united(
    operator: Operator, context: Context, parts: Sequence[Object], gap: float
) -> tuple[Drawing, list[UserError]]:
    """The parts in their own shapes as one drawing, and why some were left out. Raises: UserError."""
    if not parts:
        raise UserError("Select the drawings: meshes, curves, texts or Grease Pencil")
    operator.tell_hidden(context, parts)
    with field.unposed(map(field.shown_by, parts)):
        return drain(one_cage.united_drawing(context, parts, gap))


def _has_parts(context: Context) -> bool:
    """Whether something is selected that bones could move; looks at no more than it must."""
    selected = context.selected_objects
    drawn = any(paints(obj) and cage_sets.level_of(obj) is None for obj in selected)
    return drawn or armatures.puppet_of(selected) is not None or next(each_of_chosen(context), None) is not None


def _drawings(context: Context) -> Sequence[Object]:
    """The selected objects that paint something and are no cages; of an armature alone, what it moves."""
    drawn = [obj for obj in context.selected_objects if paints(obj) and cage_sets.level_of(obj) is None]
    return drawn or [obj for each in sets_of_chosen(context) for obj in each.originals]


def _armature(context: Context) -> Object | None:
    """The selected armature, of several the active one; else the one that moves the selected drawings already."""
    active = context.view_layer.objects.active
    armatures = [obj for obj in context.selected_objects if obj.type == "ARMATURE"]
    cages = [each.members[-1] for each in sets_of_chosen(context)] if not armatures else []
    rigs = [each for cage in cages for each in cage.modifiers if isinstance(each, bpy.types.ArmatureModifier)]
    moving = [each.object for each in rigs if each.object is not None]
    return active if active in armatures else next(iter((*armatures, *moving)), None)


def make_puppet(
    operator: Operator, context: Context, objects: Sequence[Object], old: Object | None, options: moving.Making
) -> Work[None]:
    """Makes a puppet of drawings, or makes the old one again, in Pose Mode, and tells what to look at."""
    if old is not None:
        check_local(old)
        if not old.visible_get():
            raise UserError(f"'{old.name}' is hidden: show it first")
    if any(map(armatures.is_skinned, objects)):
        raise UserError(
            "A painting follows its bones as they are: hang them elsewhere, move them and paint weights, without this"
        )
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    with moving.at_rest(context, objects, old):
        given = yield from moving.drawn(context, objects, old)
        armature, puppet = yield from moving.articulate(context, given, old, options)
    pose(context, armature)
    operator.tell_skipped(list(given.problems))
    bare = {given.parts[cap.part].name for cap in puppet.caps if not caps.with_faces(given.objects[cap.part])}
    if options.caps and bare:
        names = ", ".join(sorted(bare))
        kinds = "Grease Pencil and collection instances"
        operator.report({"INFO"}, f"Joints of {kinds} are not painted: draw '{names}' on beyond their joints")
    flat = ", ".join(sorted(obj.name for obj in objects if _is_rectangle(obj)))
    if flat:
        operator.report(
            {"WARNING"}, f"'{flat}' counts as its rectangle: import all pictures at once instead, as a painting"
        )
    for note in puppet.draft.notes:
        operator.report({"WARNING"}, note)
    turns = {bone.name: min(-each.low, each.high) for bone, each in zip(puppet.bones, puppet.ranges, strict=True)}
    for name, proved in turns.items():
        if proved < WIDE:
            operator.report(
                {"WARNING"}, f"Beyond {proved:.0f}°, '{name}' may fold: smooth its weights, or turn it less"
            )
    least = min(turns.values())
    folds = f"; nothing folds within {least:.0f}° of any joint that bends" if least < HALF_TURN else ""
    count = counted(len(given.parts), "part")
    operator.report({"INFO"}, f"{count} on {counted(len(puppet.bones), 'bone')}: pose '{armature.name}'{folds}")


class OBJECT_OT_nested_cages_walk(Operator, bpy.types.Operator):
    """Let the puppet walk on the spot by a new action, which repeats and folds nothing on any frame; the action that
    it had stays in the file
    """

    bl_label = "Walk"
    modes = ("OBJECT", "POSE")

    needs = staticmethod(lambda context: armatures.puppet_of(chosen(context)))
    missing = "Select a puppet, or a drawing that it moves"

    def run(self, context: Context) -> None:
        duplicates.complete_puppets()
        armature = _chosen_puppet(context)
        action = clips.add_walk(context, armature)
        frames = round(action.frame_end - action.frame_start)
        folds = clips.beyond(armature)
        if folds:
            self.report({"WARNING"}, f"Frame {min(folds)}: a bone turns further than is proved: verify the animation")
        self.report({"INFO"}, f"'{action.name}': {frames} frames that repeat{'' if folds else '; nothing folds'}")


class OBJECT_OT_nested_cages_snap(Operator, bpy.types.Operator):
    """Let a limb follow its control, or turn by its bones if it follows, in the pose that it shows. What has keys gets
    keys on this frame, all with Auto Keying
    """

    bl_label = "Snap FK/IK"
    modes = ("OBJECT", "POSE")

    control: text("Control", "Control of the limb; if empty, limbs with selected bones", options={"SKIP_SAVE"})

    needs = staticmethod(lambda context: armatures.puppet_of(chosen(context)))
    missing = "Select a puppet, or a drawing that it moves"

    def run(self, context: Context) -> None:
        armature = _chosen_puppet(context)
        limbs = controls.limbs_of(armature)
        picked = {bone.name for bone in context.selected_pose_bones or ()}
        wanted = [end for end, chain in limbs.items() if picked & {end, *(bone.name for bone in chain)}]
        ends = [self.control] if self.control in limbs else wanted
        if not ends:
            raise UserError("Select a bone or the control of a limb with IK")
        for end in ends:
            controls.snap(armature, end, scene_of(context).tool_settings.use_keyframe_insert_auto)


def _chosen_puppet(context: Context) -> Object:
    """The puppet to be animated. Raises: UserError."""
    armature = armatures.puppet_of(chosen(context))
    assert armature is not None
    if not armature.is_editable:
        raise UserError(f"'{armature.name}' is linked from another file: make it local first")
    return armature


def _is_rectangle(obj: Object) -> bool:
    """Whether an object shows a picture on a single face, which has no outline of what is painted."""
    return obj.type == "MESH" and len(mesh_data.mesh_of(obj).polygons) == 1 and image_on(obj) is not None


def _selected_parts(context: Context) -> tuple[list[Object], Object | None]:
    """The drawings of a puppet, and its armature if there is one: what is selected, with all that moves with it."""
    selected = list(context.selected_objects)
    ours = [obj for obj in selected if cage_sets.level_of(obj) is not None or cage_sets.is_helper(obj, *OWN_ROLES)]
    drawings = [obj for obj in selected if paints(obj) and obj not in ours and not armatures.is_cap(obj)]
    old = armatures.puppet_of(sorted(selected, key=lambda obj: obj.type != "ARMATURE"))
    known = armatures.drawings_of(old) if old is not None else []
    return [*known, *(obj for obj in drawings if obj not in known)], old
