"""The 3D views: settings that show results, unless the user has changed them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, TypeAlias

import bpy
import numpy as np
from bpy.types import Context, Object
from mathutils import Matrix, Vector
from numpy.typing import NDArray

from ..errors import FloatArray, UserError

# A setting by its part of the view and its name, its default, and what is better.
Setting: TypeAlias = "tuple[str, str, object, object]"
# Colours as in a picture: without shadows, and with textures.
FLAT_LIGHT: Setting = ("shading", "light", "STUDIO", "FLAT")
TEXTURES: Setting = ("shading", "color_type", "MATERIAL", "TEXTURE")
# Borders and edges between faces at an angle instead of all edges.
OUTLINES: Setting = ("overlay", "wireframe_threshold", 1.0, 0.5)
# Distance of a view from places in it, as a multiple of how far they are apart, and at least of their object's size.
NEAR, CLOSEST = 2.5, 0.25
# Size of a view as a multiple of what it frames, millimetres of a view's sensor, and the least distance.
MARGIN, SENSOR, SMALLEST = 1.3, 72.0, 1e-3
# Cages in their own colours.
WIRES: Setting = ("shading", "wireframe_color_type", "THEME", "OBJECT")
# Directions to the right and upwards, (2, 3), as seen along an axis of the world.
FRONT, TOP, RIGHT = np.eye(3)[[0, 2]], np.eye(3)[[0, 1]], np.eye(3)[[1, 2]]


def show(context: Context, settings: Iterable[Setting]) -> None:
    """Changes what still has its default, in the view of a context, or in all of its window if it is another editor's,
    such as a menu of the top bar.
    """
    for space in _spaces(context):
        for part, name, default, better in settings:
            if getattr(getattr(space, part), name) == default:
                setattr(getattr(space, part), name, better)


def _spaces(context: Context) -> list[Any]:
    """The view of a context, or all of its window."""
    here = context.space_data
    areas = context.window.screen.areas if context.window is not None else ()
    others = [area.spaces.active for area in areas if area.type == "VIEW_3D"]
    return [here] if isinstance(here, bpy.types.SpaceView3D) else others


def axes_of(context: Context) -> FloatArray:
    """Directions to the right and upwards, (2, 3), in the 3D view. Raises: UserError without one."""
    view = getattr(context, "region_data", None)
    if view is None:
        raise UserError("There is no view to look from: call it in a 3D view, or choose another plane")
    return np.array(view.view_matrix.to_3x3(), dtype=np.float64)[:2]


def turned(axes: FloatArray) -> Matrix:
    """The rotation (4, 4) that gives what lies on the floor these directions (2, 3) of its x and y axes."""
    return Matrix(np.column_stack([*axes, np.cross(*axes)]).tolist()).to_4x4()


def look_at(context: Context, objects: Sequence[Object], axes: FloatArray) -> None:
    """Turns the 3D view to new drawings, with these axes, as near as they fill it; not a camera's."""
    space = _spaces(context)[:1]
    corners = np.array([obj.matrix_world @ Vector(corner) for obj in objects for corner in obj.bound_box])
    if not space or not len(corners) or space[0].region_3d.view_perspective == "CAMERA":
        return
    area = next(each for each in context.window.screen.areas if each.spaces.active == space[0])
    width, height = np.ptp(corners @ axes.T, axis=0)
    shown: Any = space[0].region_3d
    shown.view_perspective = "ORTHO"
    shown.view_rotation = turned(axes).to_quaternion()
    shown.view_location = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    longer = max(area.width, area.height)
    across = MARGIN * max(width * longer / area.width, height * longer / area.height)
    shown.view_distance = max(across * space[0].lens / SENSOR, SMALLEST)


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
