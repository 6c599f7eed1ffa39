"""What the sidebar says of results: a line for each cage, what is wrong in one sentence with Show, and Live."""

from __future__ import annotations

import textwrap
from typing import Any

import bpy
from bpy.types import Context, Object

from .. import notes, record
from ..following import claims, live
from ..record import CageSet

# Letters per line of a sentence: fits into the sidebar at its default width.
NOTE_WIDTH = 36
# Code of the note on a number of vertices that would be enough, which is on a button.
ENOUGH = "loose.enough"
HOLDS, BROKEN, EDITED, ADVICE, MADE = "CHECKMARK", "ERROR", "QUESTION", "INFO", "MOD_MESHDEFORM"


def draw_set(layout: Any, context: Context, cage_set: CageSet) -> None:
    """A line for each cage of a set, with its size against the drawing's."""
    layout.label(text=cage_set.name, icon="OUTLINER_COLLECTION", translate=False)
    column, size = layout.box().column(align=True), 1.0
    for cage in cage_set.cages:
        state, sentence = health(context, cage)
        size *= 1.0 + record.node_of(cage).excess
        name = cage.name.removeprefix(f"{cage_set.record.title} ").removeprefix("Inner ")
        column.label(
            text=f"{name}: {len(cage.data.vertices)} vertices, {notes.larger(size)}", icon=state, translate=False
        )
        for line in textwrap.wrap(sentence, NOTE_WIDTH):
            column.label(text=line, translate=False)
        if state == BROKEN:
            column.operator("object.nested_cages_select_fault", icon="VIEWZOOM").cage = cage.name
        for code, data in record.notes(record.node_of(cage)):
            if code == ENOUGH:  # a button that takes the better count
                counts = [data["better"] if each is cage else len(each.data.vertices) for each in cage_set.cages]
                button = column.operator("object.nested_cages_generate", text=notes.sentence(code, data), icon="ADD")
                button.levels = ", ".join(map(str, counts))


def health(context: Context, cage: Object) -> tuple[str, str]:
    """An icon for how a cage is, and one sentence on what is wrong with it, if anything is."""
    node, cage_set = record.node_of(cage), CageSet.of(cage)
    stands = claims.stands(context, cage)
    if node.check == record.FAULT and stands:
        return BROKEN, " ".join(record.sentences(node, checks=True, others=False))
    bound = cage_set is not None and bool(cage_set.bound)
    if not bound and record.is_edited(cage):
        return (HOLDS, "") if stands and record.is_judged(cage) else (EDITED, record.EDITED)
    advice = [
        notes.sentence(*each)
        for each in record.notes(node)
        if notes.is_told(*each) and not each[0].startswith((record.CHECK, ENOUGH))
    ]
    if advice:
        return ADVICE, advice[0]
    return (HOLDS if stands or not bound else MADE), ""


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
