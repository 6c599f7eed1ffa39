"""Generate Nested Cages: in slices with progress when invoked, at once when executed."""

from __future__ import annotations

from typing import Any

import bpy

from .. import keys
from ..binding import binding, originals
from ..errors import UserError, counted
from ..generation import output
from ..generation.generate import OWN, Generation, Request
from ..generation.job import TICK, Job, running
from ..properties import settings as properties
from ..properties.settings import GenerationProperties
from ..scene import convert


class OBJECT_OT_nested_cages_generate(bpy.types.Operator, GenerationProperties):
    """Makes cages around the selected drawings."""

    bl_idname = "object.nested_cages_generate"
    bl_label = "Generate Nested Cages"
    bl_description = (
        "Wrap the selected drawings in coarse outlines that strictly enclose them, and animate how the outlines grow"
    )
    bl_options = {"REGISTER", "UNDO", "PRESET"}

    _job: Job | None = None
    _timer: Any = None
    _scene_name: str = ""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if running() is not None:
            cls.poll_message_set("Cages are being generated: wait, or press Escape")
        elif context.mode not in {"OBJECT", "EDIT_MESH"}:
            cls.poll_message_set("Switch to Object Mode, or select edge loops of a mesh in Edit Mode")
        elif not sources(context):
            cls.poll_message_set("Select a closed curve, a text, a Grease Pencil or a mesh made of edge loops")
        else:
            return True
        return False

    def draw(self, _context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "levels")
        if OWN in self.levels:
            layout.prop(self, "level_objects")
        for names in (properties.WHAT, properties.FRAMES, properties.ANIMATION, properties.LOOKS):
            properties.draw(layout.column(), self, names)
        for title, names in (("Drawing", properties.READING), ("Advanced", properties.ADVANCED)):
            header, body = layout.panel(f"nested_cages_{title}", default_closed=True)
            header.label(text=title)
            if body is not None:
                properties.draw(body.column(), self, names)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            job = self._prepare(context)
            job.drain()
            return self._write(context.scene, job)
        except UserError as error:
            return self._refuse(error)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self._job = self._prepare(context)
        except UserError as error:
            return self._refuse(error)
        self._scene_name = context.scene.name
        self._job.start(self.cancel)
        self._timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        self._show(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        job = self._job
        if job.cancelled or (event.type == "ESC" and event.value == "PRESS"):
            self.cancel(context)
            self.report({"INFO"}, "Nested Cages: cancelled, nothing was changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            if not job.advance():
                self._show(context)
                return {"PASS_THROUGH"}
            self.cancel(context)
            scene = bpy.data.scenes.get(self._scene_name)
            if scene is None:
                raise UserError("The scene of the drawing is gone, so its cages were dropped")
            outcome = self._write(scene, job)
            _show_colours(context)
            _redraw(context)
            return outcome
        except UserError as error:
            self.cancel(context)
            return self._refuse(error)
        except Exception:
            self.cancel(context)
            raise

    def cancel(self, context: bpy.types.Context) -> None:
        """Stops the work; Blender calls this too when it ends or opens another file."""
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        if self._job is not None:
            self._job.stop()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        _redraw(context)

    def _prepare(self, context: bpy.types.Context) -> Job:
        """Reads the selection. Raises: UserError."""
        options = properties.options(self)
        with originals.unposed(sources(context)):
            return Job(Generation(requests(context, self), options))

    def _write(self, scene: bpy.types.Scene, job: Job) -> set[str]:
        """Puts the results into the scene. Raises: UserError."""
        results = job.generation.results
        gone = next((result.drawing.name for result in results if result.drawing.source is None), None)
        if gone is not None:
            raise UserError(f"'{gone}' was deleted meanwhile, so its cages were dropped")
        if bpy.context.mode == "EDIT_MESH":
            # Undo in Edit Mode knows of that mesh only.
            bpy.ops.object.mode_set(mode="OBJECT")
        collections = output.write(scene, results, properties.timing(self), self.thickness)
        bound = {collection: binding.forget(collection) for collection in collections}
        if self.show_result:
            scene.frame_set(max(collection[keys.END] for collection in collections))
        for collection, method in bound.items():
            self._bind_again(collection, method)
        cages = [level for result in results for level in result.levels]
        excess = ", ".join(f"{100.0 * level.certificate.excess:.2f} %" for level in cages)
        for note in dict.fromkeys(note for level in cages for note in level.report.notes):
            self.report({"WARNING"}, note)
        self.report({"INFO"}, f"{counted(len(cages), 'certified cage')}; excess {excess}")
        return {"FINISHED"}

    def _bind_again(self, collection: bpy.types.Collection, method: str) -> None:
        """Binds what was bound before, by the same method; where it cannot be, the cages stay and the user is told."""
        if method:
            try:
                binding.bind(bpy.context, collection, method)
            except UserError as error:
                self.report({"WARNING"}, f"Not bound again: {error}")

    def _refuse(self, error: UserError) -> set[str]:
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def _show(self, context: bpy.types.Context) -> None:
        """Progress in the status bar, and in the panel by drawing it again."""
        text = f"Nested Cages {100.0 * self._job.fraction:.0f} %  {self._job.message}   |   Esc: cancel"
        context.workspace.status_text_set(text)
        _redraw(context)


class OBJECT_OT_nested_cages_cancel(bpy.types.Operator):
    """Stops the job."""

    bl_idname = "object.nested_cages_cancel"
    bl_label = "Cancel"
    bl_description = "Stop generating cages and leave the scene as it is"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        if running() is None:
            cls.poll_message_set("No cages are being generated")
            return False
        return True

    def execute(self, _context: bpy.types.Context) -> set[str]:
        running().cancelled = True
        return {"FINISHED"}


def sources(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The drawings of the selection: all selected objects that can have an outline, or the meshes in Edit Mode.

    Output of a drawing that is selected itself is about to be replaced, not to be caged.
    """
    if context.mode == "EDIT_MESH":
        return list(context.objects_in_mode_unique_data)
    selected = [obj for obj in context.selected_objects if convert.readable(obj)]
    return [obj for obj in selected if not _is_output_of(obj, selected)]


def _is_output_of(obj: bpy.types.Object, drawings: list[bpy.types.Object]) -> bool:
    collection = next((c for c in obj.users_collection if keys.SOURCE in c), None)
    return keys.LEVEL in obj and collection is not None and collection[keys.SOURCE] in drawings


def requests(context: bpy.types.Context, values: GenerationProperties) -> list[Request]:
    """What the selection asks for: each drawing with its own cages, all in common ones, or the active one with the
    others as its levels. Raises: UserError.
    """
    reading = properties.reading_options(values)
    selected, active = sources(context), context.view_layer.objects.active
    if values.use_selected_as_levels:
        if active not in selected or len(selected) < 2:
            raise UserError(
                "'Selected as Levels' needs the drawing as the active object and at least one coarse mesh selected "
                "beside it"
            )
        own = [obj for obj in selected if obj is not active]
        drawings = [[active]]
    else:
        own = _own_objects(context, values)
        alone = sorted((obj for obj in selected if obj not in own), key=lambda obj: obj is not active)
        drawings = [alone] if values.together else [[obj] for obj in alone]
        if not alone:
            raise UserError("Select the drawing too: all that is selected is one of its levels")
    found = []
    for objects in drawings:
        outlines = [convert.read(context, obj, reading) for obj in objects]
        fine = convert.fine_drawing(outlines[0], reading)
        fine = convert.joined(fine, [convert.drawing_in(fine.frame, outline, reading) for outline in outlines[1:]])
        coarse = [convert.drawing_in(fine.frame, convert.read(context, obj, reading), reading) for obj in own]
        if values.use_selected_as_levels:
            coarse.sort(key=lambda drawing: -sum(map(len, drawing.loops)))
        found.append(Request(fine, tuple(coarse)))
    return found


def _own_objects(context: bpy.types.Context, values: GenerationProperties) -> list[bpy.types.Object]:
    """The objects that are levels. Raises: UserError."""
    objects = []
    for name in properties.own_names(values):
        obj = context.scene.objects.get(name)
        if obj is None:
            raise UserError(f"'{name}' is named as a level but is not in the scene")
        if not convert.readable(obj):
            raise UserError(f"'{name}' is named as a level but has no outline")
        objects.append(obj)
    return objects


def _show_colours(context: bpy.types.Context) -> None:
    """Lets the 3D view that the user works in show wires in the colours of their objects, unless that was chosen."""
    space = context.space_data
    if space is not None and space.type == "VIEW_3D" and space.shading.wireframe_color_type == "THEME":
        space.shading.wireframe_color_type = "OBJECT"


def _redraw(context: bpy.types.Context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
