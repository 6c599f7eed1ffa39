"""Bases of operators: reasons why one is not available, work in slices that can be cancelled and dialogs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, Literal

import bpy
from bpy.types import Context, Object

from ..blender import views
from ..blender.jobs import SLICE, Job, Work, drain, running
from ..blender.props import flag, length
from ..cage_sets import CageSet
from ..cage_sets.selection import each_of_chosen, scene_of, select
from ..drawing.grease_pencil import hidden_parts
from ..errors import UserError, counted, last_fault
from ..generate.write import Kind
from ..messages import sentence

Outcome = set[Literal["RUNNING_MODAL", "CANCELLED", "FINISHED", "PASS_THROUGH", "INTERFACE"]]

NOTHING = "Select a drawing that has cages, or one of its cages"

# Blender only reads properties of bases that are not registered.
if TYPE_CHECKING:
    Mixin = bpy.types.Operator
else:
    Mixin = object


class Named(Mixin):
    """The name of an operator's class is its identifier, and its docstring what the user reads about it."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        room, is_operator, name = cls.__name__.partition("_OT_")
        if is_operator:
            cls.bl_idname, cls.bl_description = f"{room.lower()}.{name}", " ".join((cls.__doc__ or "").split())


class Operator(Named):
    """The pattern of all operators: a poll with a reason, options, and `run`, whose errors the user sees.

    `modes`: where it works; anywhere if there are none. `during_jobs`: whether it works while a job is running.
    """

    bl_options = {"REGISTER", "UNDO"}
    modes: tuple[str, ...] = ("OBJECT",)
    wrong_mode = "Switch to Object Mode"
    during_jobs = False
    # Whether the place of the last message stays that of Show.
    keeps_fault = False
    # What must be there, given the context, and what is said if it is not.
    needs: Any = None
    missing = ""

    @classmethod
    def poll(cls, context: Context) -> bool:
        if running() and not cls.during_jobs:
            problem = "Wait for the job that is running, or press Escape"
        elif cls.modes and context.mode not in cls.modes:
            problem = cls.wrong_mode
        else:
            problem = cls.unavailable(context)
        if problem:
            cls.poll_message_set(problem)
        return not problem

    @classmethod
    def unavailable(cls, context: Context) -> str:
        """Why the operator cannot be used now; empty if it can."""
        return "" if cls.needs is None or cls.needs(context) else cls.missing

    def run(self, context: Context) -> None:
        """Does what the operator is for. Raises: UserError, with nothing changed."""
        raise NotImplementedError

    def execute(self, context: Context) -> Outcome:
        self._forget()
        try:
            self.run(context)
        except UserError as error:
            return self.fail(error)
        return {"FINISHED"}

    def _forget(self) -> None:
        """What the last message was about."""
        if not self.keeps_fault:
            last_fault.clear()

    def fail(self, error: UserError) -> Outcome:
        """Reports the error and stores its place; the operator has changed nothing."""
        last_fault[:] = filter(None, [error.fault])
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def tell(self, kind: Kind, text: str) -> None:
        """Reports a sentence."""
        self.report({kind}, text)

    def tell_skipped(self, problems: Sequence[UserError], noun: str = "drawing") -> None:
        """Lists what could not be worked on; the rest was."""
        last_fault[:] = [problem.fault for problem in problems if problem.fault is not None][:1]
        for problem in problems:
            self.report({"WARNING"}, f"Skipped: {problem}")
        if problems:
            self.report({"WARNING"}, f"{counted(len(problems), noun)} skipped, see the Info editor")

    def tell_hidden(self, context: Context, objects: Sequence[Object]) -> None:
        """Says what of Grease Pencil drawings does not show and is left out."""
        for hidden in hidden_parts(context, objects):
            self.report({"INFO"}, sentence("drawing.hidden", hidden))


class JobOperator(Operator):
    """An operator whose work is a generator: run at once when executed, as by scripts, redo and in the background; in
    slices with progress when invoked.
    """

    # Whether the work changes the scene before it is done, which blocks all other changes.
    exclusive = False
    # Settings of the 3D view that show the result.
    shown_by: tuple[views.Setting, ...] = ()
    # New drawings that the view turns to, and the directions of their x and y axes.
    framed: tuple[Object, ...] = ()
    axes = views.FRONT

    _job: Job | None = None
    _timer: Any = None

    def work(self, context: Context) -> Work[None]:
        """Reads the scene before its first progress, computes, and writes at the end. Raises: UserError."""
        raise NotImplementedError

    def run(self, context: Context) -> None:
        drain(self.work(context))

    def prepare(self, context: Context) -> None:
        """Sets what was not given when a user invokes the operator, not a script."""

    def invoke(self, context: Context, _event: bpy.types.Event) -> Outcome:
        self.prepare(context)
        return self.execute(context) if bpy.app.background or context.window is None else self.start(context)

    def start(self, context: Context) -> Outcome:
        """Reads the scene, and leaves the rest to the driver; `modal` shows what it does."""
        self._forget()
        self._job = job = Job(self.work(context), scene_of(context).name)
        if job.advance(0.0):
            return self._ended(context, job)
        job.start(self.cancel)
        self._timer = context.window_manager.event_timer_add(SLICE, window=context.window)
        context.window_manager.modal_handler_add(self)
        self._show(context, job)
        return {"RUNNING_MODAL"}

    def modal(self, context: Context, event: bpy.types.Event) -> Outcome:
        job = self._job
        if job is None:
            return {"CANCELLED"}
        if job.done:
            return self._ended(context, job)
        if job.cancelled or _asks_to_cancel(context, event):
            self.cancel(context)
            self.report({"INFO"}, "Nested Cages: cancelled, nothing was changed")
            return {"CANCELLED"}
        if event.type == "TIMER":
            self._show(context, job)
        return {"RUNNING_MODAL"} if self.exclusive else {"PASS_THROUGH"}

    def _ended(self, context: Context, job: Job) -> Outcome:
        """Shows the result in the 3D view, unless the user has changed its settings, or why there is none."""
        self.cancel(context)
        if isinstance(job.error, UserError):
            return self.fail(job.error)
        if job.error is not None:
            raise job.error
        views.show(context, self.shown_by)
        views.look_at(context, self.framed, self.axes)
        return {"FINISHED"}

    def cancel(self, context: Context) -> None:
        """Stops the work; also called by Blender when it exits or opens another file."""
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        if self._job is not None:
            self._job.stop()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        views.redraw(context)

    def _show(self, context: Context, job: Job) -> None:
        """Shows progress in the status bar, and redraws the panel."""
        context.workspace.status_text_set(
            f"Nested Cages {100.0 * job.fraction:.0f} %  {job.message}   |   Esc over the 3D view: cancel"
        )
        views.redraw(context)


class GapProperty:
    """The gap that operators which unite drawings close."""

    gap: length("Join Gaps", "Join parts that are closer than this, so that they have one outline and one skeleton")


def why_none(context: Context, why_not: Callable[[CageSet], str]) -> str:
    """Why no set of the selection can be worked on, given why one cannot; empty if one can."""
    reasons = map(why_not, each_of_chosen(context, both=False))
    why = next(reasons, NOTHING)
    return "" if not why or "" in reasons else why


class DialogJobOperator(JobOperator):
    """A job that asks for its options first. After a dialog, Blender executes an operator and cannot continue it in
    slices, so the operator is invoked again without a dialog.
    """

    answered: flag("Answered", "Start without asking for options", options={"HIDDEN", "SKIP_SAVE"})
    _asked = False

    def ask(self, context: Context, event: bpy.types.Event) -> Any:
        """Opens the dialog."""
        return context.window_manager.invoke_props_dialog(self)

    def invoke(self, context: Context, event: bpy.types.Event) -> Outcome:
        if self.answered or bpy.app.background or context.window is None:
            return super().invoke(context, event)
        self._asked = True
        self.prepare(context)
        return self.ask(context, event)

    def draw_options(self, *names: str) -> None:
        """Draws options below each other."""
        self.layout.use_property_split = True
        for name in names:
            self.layout.prop(self, name)

    def execute(self, context: Context) -> Outcome:
        if not self._asked:
            return super().execute(context)
        rna: Any = self.bl_rna
        category, _, name = rna.identifier.partition("_OT_")
        again = getattr(getattr(bpy.ops, category.lower()), name)
        options: Any = self.as_keywords()  # type: ignore[func-returns-value]
        for key, value in options.items():
            if isinstance(value, bpy.types.bpy_prop_collection):
                options[key] = [{"name": item.name} for item in value]
        again("INVOKE_DEFAULT", **{**options, "answered": True})
        return {"CANCELLED"}  # this operator has changed nothing: undo and redo are for the invoked one


def _asks_to_cancel(context: Context, event: bpy.types.Event) -> bool:
    """Whether Escape was pressed over a 3D view or its panels; elsewhere, and while typing, it has other meanings."""
    if event.type != "ESC" or event.value != "PRESS" or context.mode == "EDIT_TEXT":
        return False
    areas = [area for area in context.window.screen.areas if area.type == "VIEW_3D"]
    x, y = event.mouse_x, event.mouse_y
    return any(0 <= x - area.x < area.width and 0 <= y - area.y < area.height for area in areas)


def hide(objects: Iterable[Object]) -> None:
    """Hides what new objects show instead."""
    for obj in objects:
        obj.hide_set(True)
        obj.hide_render = True


def pose(context: Context, rig: Object) -> None:
    """Selects an armature alone, in Pose Mode."""
    select(context, rig)
    bpy.ops.object.mode_set(mode="POSE")
