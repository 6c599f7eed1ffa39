"""Bases of operators that ask for their options first, or for files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import bpy
from bpy.props import CollectionProperty

from ..properties.kinds import flag, text
from .base import JobOperator, Outcome


class DialogJobOperator(JobOperator):
    """A job that asks for its options first. After a dialog, Blender executes an operator and cannot continue it in
    slices, so the operator is invoked again without a dialog.
    """

    answered: flag("Answered", "Start without asking for options", options={"HIDDEN", "SKIP_SAVE"})
    _asked = False

    def ask(self, context: bpy.types.Context, event: bpy.types.Event) -> Any:
        """Opens the dialog."""
        return context.window_manager.invoke_props_dialog(self)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Outcome:
        if self.answered or bpy.app.background or context.window is None:
            return super().invoke(context, event)
        self._asked = True
        self.prepare(context)
        asked: Outcome = self.ask(context, event)
        return asked

    def draw_options(self, *names: str) -> None:
        """Draws options below each other."""
        self.layout.use_property_split = True
        for name in names:
            self.layout.prop(self, name)

    def execute(self, context: bpy.types.Context) -> Outcome:
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


class FilesOperator(DialogJobOperator):
    """A job on one file or several."""

    directory: text("Folder", "Folder of the files", subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(
        name="Files",
        description="The files, if there are several",
        type=bpy.types.OperatorFileListElement,
        options={"HIDDEN", "SKIP_SAVE"},
    )


def paths_of(operator: Any) -> list[Path]:
    """The files that were chosen in an operator."""
    names = [file.name for file in operator.files if file.name]
    given = [os.path.join(operator.directory, name) for name in names] or [operator.filepath]
    return [Path(bpy.path.abspath(path)) for path in given if path]
