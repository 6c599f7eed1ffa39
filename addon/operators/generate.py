"""Generate Nested Cages: in slices with progress when invoked, at once when executed."""

from __future__ import annotations

import itertools
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

import bpy
import numpy as np
from bpy.types import Collection, Context, Object, Scene

from .. import record
from ..animation.timeline import Timing
from ..binding import binding, field
from ..binding.adoption import adopt
from ..errors import UserError, counted
from ..following import claims
from ..generation import output
from ..generation.generate import Generation, Request, Result, percentage
from ..generation.job import Progress, Work, running
from ..generation.levels import OWN
from ..generation.rules import Places
from ..notes import in_scene, note
from ..properties import groups
from ..properties.settings import GenerationProperties, OperatorProperties, all_values, filled, options_of
from ..rigging.pose import Pose, unmoved
from ..scene import areas, convert, ownership
from ..scene.grease_pencil import hidden_parts
from ..scene.ownership import scene_again, scene_of
from ..scene.reading import Lines, lines_of_all
from .base import JobOperator, Operator
from .views import WIRES

# Weight in a vertex group from which on a vertex is pinned.
PINNED = 0.5


class DrawingsOperator(JobOperator, OperatorProperties):
    """Works on the drawings of the selection, with the settings."""

    bl_options = {"REGISTER", "UNDO", "PRESET"}

    @classmethod
    def unavailable(cls, context: Context) -> str:
        return "" if sources(context) else why_nothing(context)


class OBJECT_OT_nested_cages_generate(DrawingsOperator, bpy.types.Operator):
    """Wrap the selected drawings in coarse outlines that strictly enclose them, and animate how the outlines grow"""

    bl_label = "Generate Nested Cages"
    modes = ("OBJECT", "EDIT_MESH")
    wrong_mode = "Switch to Object Mode, or select edge loops of a mesh in Edit Mode"
    shown_by = (WIRES,)

    def prepare(self, context: Context) -> None:
        self.take_from_panel(context)

    def draw(self, _context: Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "levels")
        if OWN in self.levels:
            layout.prop(self, "level_objects")
        groups.draw(layout.column(), self, groups.SPACE)
        for title, names in groups.SECTIONS.items():
            header, body = layout.panel(f"nested_cages_{title}", default_closed=title != "Animation")
            header.label(text=title)
            if body is not None:
                groups.draw(body.column(), self, names)

    def work(self, context: Context) -> Work[None]:
        options, name = options_of(self, scene_of(context)), context.scene.name
        chosen = sources(context)
        adopt(scene_of(context), chosen)
        groups = ownership.with_parts(scene_of(context), chosen, inside=self.inside)
        for group in groups:
            if not set(group) <= set(chosen):
                self.report(
                    {"INFO"},
                    f"'{group[0].name}' shares its cages with {counted(len(group) - 1, 'drawing')}: all are used",
                )
        with field.unposed(itertools.chain(*groups)):
            asked, problems = requests(context, self)
            generation = Generation(asked, options)
        read = time.perf_counter()
        yield from generation
        yield Progress(1.0, "writing")
        problems += generation.problems
        scene = scene_again(name)
        used = all_values(self)
        edited = claims.changed_since(read)
        self._write(scene, [replace(result, used=used) for result in generation.results], edited)
        self.tell_skipped(problems)

    def _write(self, scene: Scene, results: Sequence[Result], edited: set[str]) -> None:
        """Puts the results into the scene; edited: outputs whose drawing has changed since. Raises: UserError."""
        gone = next((result.drawing.name for result in results if result.drawing.source is None), None)
        if gone is not None:
            raise UserError(f"'{gone}' was deleted meanwhile, so its cages were discarded")
        if bpy.context.mode == "EDIT_MESH":
            # Undo in Edit Mode only covers the edited mesh.
            bpy.ops.object.mode_set(mode="OBJECT")
        adopt(scene, [result.drawing.source for result in results if result.drawing.source is not None])
        poses = {}
        for earlier in filter(None, output.earlier_outputs(scene, results)):
            source = ownership.source_of(earlier)
            poses[earlier] = {ownership.level_of(obj): Pose.of(obj, source) for obj in ownership.members(earlier)}
        collections, lost = output.write(scene, results, filled(Timing, self), self.thickness)
        bound = {collection: binding.forget(collection) for collection in collections}
        if self.show_result:
            scene.frame_set(max(record.of(collection).frames[1] for collection in collections))
        for collection, method in bound.items():
            self._bind_again(collection, method)
            for obj in ownership.members(collection):
                pose = poses.get(collection, {}).get(ownership.level_of(obj))
                if pose is not None:
                    pose.give(obj, bound=ownership.is_bound(collection))
        claims.certified(collections, edited)
        for sentence in lost:
            self.report({"WARNING"}, sentence)
        cages = [level for result in results for level in result.levels]
        scale = results[0].drawing.frame.scale
        for said in dict.fromkeys(said for level in cages for said in level.report.notes):
            self.report({"INFO"} if said.code == record.TOLERANCE else {"WARNING"}, in_scene(said, scale))
        sizes = [abs(level.excess) for level in cages]
        around, shown = "", ", ".join(map(percentage, sizes))
        if len(results) > 1:
            around = f" for {len(results)} drawings"
            shown = f"{percentage(min(sizes))} to {percentage(max(sizes))}"
        kind, measure = ("certified inner cage", "less area") if results[0].inside else ("certified cage", "excess")
        self.report({"INFO"}, f"{counted(len(cages), kind)}{around}; {measure} {shown}")

    def _bind_again(self, collection: Collection, method: str) -> None:
        """Binds again what was bound before, by the same method; if that fails, the cages stay and the user is told."""
        if method:
            try:
                with unmoved(ownership.members(collection)):
                    binding.bind(bpy.context, collection, method)
            except UserError as error:
                self.report({"WARNING"}, f"Not bound again, and poses were lost: {error}")


class OBJECT_OT_nested_cages_cancel(Operator, bpy.types.Operator):
    """Stop the running job and leave the scene as it was"""

    bl_label = "Cancel"
    bl_options = {"INTERNAL"}
    modes = ()
    during_jobs = True

    needs, missing = staticmethod(lambda _context: running()), "No job is running"

    def run(self, _context: Context) -> None:
        job = running()
        if job is not None:
            job.cancelled = True


def sources(context: Context, *, as_selected: bool = False) -> list[Object]:
    """The drawings of the selection: all selected objects that can have an outline, or the meshes in Edit Mode.

    Output of a selected drawing, and bound output, is about to be replaced, not to be caged, unless it is wanted
    `as_selected`. With nothing selected, the active object counts if it has cages: an original hidden for its animation
    is no longer selected.
    """
    if context.mode == "EDIT_MESH":
        return list(context.objects_in_mode_unique_data)
    selected = [obj for obj in context.selected_objects if convert.readable(obj)]
    active = context.view_layer.objects.active
    if not context.selected_objects and active is not None and convert.readable(active):
        return [active] if ownership.outputs_of(scene_of(context), active) else []
    if as_selected:
        return [obj for obj in selected if record.node_of(obj).of not in selected]
    return list(dict.fromkeys(drawing for obj in selected for drawing in _drawings_of(obj, selected)))


def why_nothing(context: Context) -> str:
    """Why there is nothing to cage: nothing is selected, or it is hidden or has no outline."""
    wanted = "a closed curve, a text, a Grease Pencil or a mesh made of edge loops"
    active = context.view_layer.objects.active
    if context.selected_objects:
        obj = active if active in context.selected_objects else context.selected_objects[0]
        kind = obj.bl_rna.properties["type"].enum_items[obj.type].name.lower()
        return f"'{obj.name}' has no outline, it is of the kind {kind}: select {wanted}"
    if active is not None and not active.visible_get():
        return f"'{active.name}' is hidden: show it (Alt H, or the Outliner) and select it"
    return f"Nothing is selected: select {wanted}"


def _drawings_of(obj: Object, selected: Sequence[Object]) -> list[Object]:
    """The drawings that an object stands for: those of a bound output, none of a moving copy, else itself."""
    if record.shown(obj, record.FILL) is not None:
        return []
    if ownership.level_of(obj) is None:
        return [obj]
    home, node = ownership.home_of_member(obj), record.node_of(obj)
    if node.of in selected:
        return []
    if home is None:
        return [node.of] if node.kept.bound and ownership.exists(node.of) else [obj]
    return (ownership.originals(home) if ownership.is_bound(home) else []) or [obj]


def requests(context: Context, values: GenerationProperties) -> tuple[list[Request], list[UserError]]:
    """The requests of the selection: each drawing with its own cages, all in common ones, or the active one with the
    others as its levels; and for several drawings, why some cannot be caged. Raises: UserError if none can.
    """
    active = context.view_layer.objects.active
    selected = sources(context, as_selected=values.use_selected_as_levels)
    if values.use_selected_as_levels:
        if active not in selected or len(selected) < 2:
            raise UserError(
                "'Selected as Cages' needs the drawing as the active object and at least one coarse mesh selected "
                "as well"
            )
        own = [obj for obj in selected if obj is not active]
        drawings = ownership.with_parts(scene_of(context), [active], inside=values.inside)
    else:
        own = _own_objects(context, values)
        alone = sorted((obj for obj in selected if obj not in own), key=lambda obj: obj is not active)
        drawings = ownership.with_parts(scene_of(context), alone, inside=values.inside)
        drawings = [list(itertools.chain(*drawings))] if values.together else drawings
        if not alone:
            raise UserError("Select the drawing too: all that is selected is one of its levels")
    asked, problems = [], []
    lines = lines_of_all(context, [*itertools.chain(*drawings), *own], values.resolution)
    for objects in drawings:
        try:
            asked.append(_request(context, objects, own, lines, values))
        except UserError as error:
            problems.append(error)
    if problems and not asked:
        raise problems[0]
    return asked, problems


def _request(
    context: Context,
    objects: Sequence[Object],
    own: Sequence[Object],
    lines: Mapping[Object, Lines],
    values: GenerationProperties,
) -> Request:
    """One drawing, of all objects, and the user's own levels for it. Raises: UserError."""
    reading = filled(convert.ReadingOptions, values)
    outlines = [convert.read(context, obj, reading, lines.get(obj)) for obj in objects]
    fine = convert.fine_drawing(outlines[0], reading)
    layers = [convert.drawing_in(fine.frame, outline, reading, layer=True) for outline in outlines[1:]]
    fine = convert.joined(fine, layers)
    others = [convert.read(context, obj, reading, lines.get(obj)) for obj in own]
    coarse = [convert.drawing_in(fine.frame, outline, reading) for outline in others]
    if values.use_selected_as_levels:
        coarse.sort(key=lambda drawing: -sum(map(len, drawing.loops)))
    return Request(fine, tuple(coarse), _places(context, objects, fine, values))


def _places(context: Context, objects: Sequence[Object], fine: convert.Drawing, values: GenerationProperties) -> Places:
    """Where it matters in a drawing. Raises: UserError."""
    points = np.concatenate(fine.loops)
    missing = [note("drawing.hidden", **hidden) for hidden in hidden_parts(context, objects)]
    places = {}
    for group in filter(None, (values.weight_group, values.pin_group)):
        weights = areas.painted(context, objects, fine.frame, group, points)
        if weights is None or not weights.any():
            missing.append(note("places.empty", name=fine.name, group=group))
        else:
            places[group] = weights
    joints: list[list[float]] = []
    if values.joint_armature:
        armature = context.scene.objects.get(values.joint_armature)
        if armature is None or armature.type != "ARMATURE":
            raise UserError(f"'{values.joint_armature}' is not an armature in the scene: choose one for 'Joints'")
        joints = areas.bone_ends(armature, fine.frame).tolist()
    return Places(
        weights=tuple(places[values.weight_group].tolist()) if values.weight_group in places else (),
        pins=tuple(np.flatnonzero(places[values.pin_group] > PINNED).tolist()) if values.pin_group in places else (),
        joints=tuple((x, y) for x, y in joints),
        notes=tuple(missing),
    )


def _own_objects(context: Context, values: GenerationProperties) -> list[Object]:
    """The objects that are levels. Raises: UserError."""
    objects = []
    for name in list(filter(None, values.level_objects.split("\n")))[: values.levels.count(OWN)]:
        obj = context.scene.objects.get(name)
        if obj is None:
            raise UserError(f"'{name}' is named as a level but is not in the scene")
        if not convert.readable(obj):
            raise UserError(f"'{name}' is named as a level but has no outline")
        objects.append(obj)
    return objects
