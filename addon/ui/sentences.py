"""Sentences in panels, in as many lines as the width of the region needs: Blender would cut them."""

from __future__ import annotations

from typing import Any

import blf
from bpy.types import Context

# Interface units at scale 1: the margins of a panel in its region, and the width of an icon.
MARGINS, ICON = 62.0, 22.0
# The width of the sidebar where no region is known.
USUAL_WIDTH = 260.0


def draw(layout: Any, context: Context, text: str, icon: str = "NONE") -> None:
    """Draws a sentence below each other, with an icon before its first line; nothing if it is empty."""
    scale = context.preferences.system.ui_scale
    region = context.region
    room = (region.width / scale if region is not None and region.width > 1 else USUAL_WIDTH) - MARGINS
    blf.size(0, context.preferences.ui_styles[0].widget.points)
    for number, line in enumerate(lines(text, room - ICON * (icon != "NONE"))):
        layout.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon, translate=False)


def lines(text: str, room: float) -> list[str]:
    """The words of a text in lines that are no wider, in the font and size that are set, unless a word alone is."""
    found: list[str] = []
    for word in text.split():
        longer = f"{found[-1]} {word}" if found else word
        if found and blf.dimensions(0, longer)[0] <= room:
            found[-1] = longer
        else:
            found.append(word)
    return found
