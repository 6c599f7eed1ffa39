"""Write Report: all stored numbers of the cages, as a text."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from .. import keys
from ..scene import ownership
from ..scene.selection import output_of_active
from .base import OnOutput, Outcome

NAME = "Nested Cages Report"
# Lines of a report about a cage, by custom property.
NUMBERS = (
    ("vertices", keys.VERTICES),
    ("excess", keys.EXCESS),
    ("clearance", keys.CLEARANCE),
    ("seconds", keys.SECONDS),
    ("first frame", keys.FLOW_START),
    ("growing back from frame", keys.REINFLATION_START),
    ("tightening from frame", keys.TIGHTENING_START),
    ("result on frame", keys.END),
)
SENTENCES = (keys.BEGINS_FROM, keys.CERTIFICATE, keys.NEED, keys.LINK, keys.NOTES, keys.FINDING)


class OBJECT_OT_nested_cages_report(OnOutput, bpy.types.Operator):
    """Writes a report."""

    bl_idname = "object.nested_cages_report"
    bl_label = "Write Report"
    bl_description = "Write a text with all facts about these cages: certificates, binding errors, times, notes"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> Outcome:
        collection = output_of_active(context)
        text = bpy.data.texts.get(NAME) or bpy.data.texts.new(NAME)
        text.from_string("\n".join(lines(collection)) + "\n")
        self.report({"INFO"}, f"Written to the text '{NAME}': open it in a Text Editor")
        return {"FINISHED"}


def lines(collection: bpy.types.Collection) -> Iterator[str]:
    """The lines of the report, level by level."""
    yield collection.name
    for obj in ownership.members(collection):
        yield ""
        yield obj.name
        for label, key in NUMBERS:
            value = keys.number(obj, key)
            if value is not None:
                yield f"    {label}: {value:.6g}"
        for key in SENTENCES:
            if sentence := keys.text(obj, key):
                yield f"    {sentence}"


CLASSES = (OBJECT_OT_nested_cages_report,)
