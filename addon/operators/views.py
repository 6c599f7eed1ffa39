"""The 3D views: settings that show results, unless the user has changed them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeAlias

import bpy
import numpy as np
from bpy.types import Context
from numpy.typing import NDArray

# A setting by its part of the view and its name, its default, and what is better.
Setting: TypeAlias = "tuple[str, str, object, object]"
# Colours as in a picture: without shadows, and with textures.
FLAT_LIGHT: Setting = ("shading", "light", "STUDIO", "FLAT")
TEXTURES: Setting = ("shading", "color_type", "MATERIAL", "TEXTURE")
# Borders and edges between faces at an angle instead of all edges.
OUTLINES: Setting = ("overlay", "wireframe_threshold", 1.0, 0.5)
# Distance of a view from places in it, as a multiple of how far they are apart, and at least of their object's size.
NEAR, CLOSEST = 2.5, 0.25
# Cages in their own colours.
WIRES: Setting = ("shading", "wireframe_color_type", "THEME", "OBJECT")


def show(context: Context, settings: Iterable[Setting]) -> None:
    """Changes what still has its default, in the view of a context, or in all of its window if it is another editor's,
    such as a menu of the top bar.
    """
    here = context.space_data
    areas = context.window.screen.areas if context.window is not None else ()
    others: list[Any] = [area.spaces.active for area in areas if area.type == "VIEW_3D"]
    for space in [here] if isinstance(here, bpy.types.SpaceView3D) else others:
        for part, name, default, better in settings:
            if getattr(getattr(space, part), name) == default:
                setattr(getattr(space, part), name, better)


def frame(context: Context, places: NDArray[np.float64], size: float) -> None:
    """Moves the 3D view to places (k, 3) of the world on something of some size, as near as they are apart."""
    region: Any = getattr(context, "region_data", None)
    if region is not None:
        apart = float(np.linalg.norm(np.ptp(places, axis=0)))
        region.view_location = places.mean(axis=0)
        region.view_distance = max(NEAR * apart, CLOSEST * size)


def redraw(context: Context) -> None:
    """Redraws the 3D views."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
