"""What the sidebar says of results: a summary of each set of cages with notes, and Live."""

from __future__ import annotations

import textwrap

import bpy
from bpy.types import Collection, Object

from .. import record
from ..following import live
from ..scene import ownership

# Letters per line of a note: fits into the sidebar at its default width.
NOTE_WIDTH = 36


def draw_output(layout: bpy.types.UILayout, collection: Collection) -> None:
    """The drawing and its cages, with their summaries."""
    layout.label(text=collection.name, icon="OUTLINER_COLLECTION", translate=False)
    for obj in ownership.members(collection):
        box = layout.box().column(align=True)
        box.label(text=obj.name, icon="MOD_MESHDEFORM" if ownership.level_of(obj) else "MESH_DATA", translate=False)
        box.label(text=_in_short(obj), translate=False)
        for line in _notes(obj):
            box.label(text=line, translate=False)


def _in_short(obj: Object) -> str:
    """The most important facts about an output object; all numbers are in the report."""
    node = record.node_of(obj)
    parts = [f"{len(obj.data.vertices)} vertices"]
    if node.role == record.CAGE:
        parts.append(f"{100.0 * abs(node.excess):.3g} % {'smaller' if node.excess < 0.0 else 'larger'}")
    return ", ".join(parts)


def _notes(obj: Object) -> list[str]:
    """Lines of the notes about an output object."""
    method, _ = record.link(obj)
    follows = f"Follows by {method}" if method else ""
    node = record.node_of(obj)
    wrong = " ".join(record.sentences(node, checks=True, others=False)) if node.check == record.FAULT else ""
    sentences = [follows, record.verdict(node), wrong, *record.sentences(node)]
    home = ownership.home_of_member(obj)
    if (home is None or not ownership.is_bound(home)) and record.is_edited(obj):
        sentences = [record.verdict(node), wrong] if record.is_judged(obj) else [record.EDITED]
    return [line for sentence in sentences for line in textwrap.wrap(sentence, NOTE_WIDTH)]


def draw_live(layout: bpy.types.UILayout) -> None:
    """The switch for following edits, with its state and the reason why the cages cannot follow."""
    now = live.current()
    layout.operator("object.nested_cages_live", icon="REC", depress=now is not None)
    if now is None:
        return
    column = layout.column(align=True)
    column.label(text="Out of date" if now.behind else "Up to date", icon="TIME" if now.behind else "CHECKMARK")
    for line in textwrap.wrap(now.problem, NOTE_WIDTH):
        column.label(text=line, translate=False)
