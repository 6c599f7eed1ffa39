"""Write Report: all stored numbers of the cages, as a text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import bpy

from .. import record
from ..generation.job import Work
from ..scene import ownership
from .base import OutputOperator

NAME = "Nested Cages Report"
FRAMES = ("first frame", "growing back from frame", "tightening from frame", "result on frame")


class OBJECT_OT_nested_cages_report(OutputOperator, bpy.types.Operator):
    """Write a text with all facts about these cages: certificates, binding errors, times, notes"""

    bl_label = "Write Report"
    modes = ("OBJECT", "POSE")
    both = True

    def each(self, _context: bpy.types.Context, collection: bpy.types.Collection) -> Work[list[str]]:
        yield from ()
        return list(lines(collection))

    def finish(self, _context: bpy.types.Context, done: Sequence[tuple[bpy.types.Collection, list[str]]]) -> None:
        text = bpy.data.texts.get(NAME) or bpy.data.texts.new(NAME)
        text.from_string("\n\n".join("\n".join(found) for _, found in done) + "\n")
        self.report({"INFO"}, f"Written to the text '{NAME}': open it in a Text Editor")


def lines(collection: bpy.types.Collection) -> Iterator[str]:
    """The lines of the report, level by level."""
    yield collection.name
    for obj in ownership.members(collection):
        found = record.member(obj)
        numbers: dict[str, float] = {"vertices": len(obj.data.vertices)}
        if found.role == record.CAGE:
            numbers |= {"excess": found.excess, "clearance": found.clearance, "seconds": found.seconds}
            numbers |= {name: frame for name, frame in zip(FRAMES, found.frames, strict=True) if frame >= 0}
        yield ""
        yield obj.name
        for label, value in numbers.items():
            yield f"    {label}: {value:.6g}"
        edited = not ownership.is_bound(collection) and record.is_edited(obj)
        unknown = "" if edited and record.is_judged(obj) else record.EDITED
        certificate = unknown if edited else record.certificate(found)
        method, error = record.link(obj)
        follows = f"{method}, error {error:.1e} at rest" if method else ""
        said = (found.start, certificate, follows, *record.sentences(found, checks=True))
        for sentence in filter(None, said):
            yield f"    {sentence}"
