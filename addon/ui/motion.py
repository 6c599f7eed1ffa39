"""The part of the sidebar about drawings that move."""

from __future__ import annotations

import textwrap

import bpy

from ..following import live


def draw_live(layout: bpy.types.UILayout, width: int) -> None:
    """The switch for following edits, with its state and the reason why the cages cannot follow, wrapped to a number of
    letters.
    """
    now = live.current()
    layout.operator("object.nested_cages_live", icon="REC", depress=now is not None)
    if now is None:
        return
    column = layout.column(align=True)
    column.label(text="Out of date" if now.behind else "Up to date", icon="TIME" if now.behind else "CHECKMARK")
    for line in textwrap.wrap(now.problem, width):
        column.label(text=line, translate=False)
