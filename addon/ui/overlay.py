"""Over the 3D view: cages as lines of constant width in pixels, and the places that the last message is about.

In renders a modifier gives lines their width; see `blender.display`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import gpu
import numpy as np
from bpy.types import Context, Object
from gpu_extras.batch import batch_for_shader

from .. import watch
from ..blender import mesh_data
from ..cage_sets import CageSet
from ..drawing.plane import transform
from ..errors import last_fault

# Pixels at interface scale 1: width of lines, extra width of selected cages, and size of the marks of a fault.
WIDTH, MORE, MARK = 2.5, 1.5, 12.0
# Blend of the colour of a selected cage towards white, and the colour of marks.
LIGHTER, RED = 0.45, (1.0, 0.15, 0.1, 1.0)

# The batches of the cages that a view shows, by their names, colours and widths, and the moment when they were made.
_known: dict[Any, Any] = {}
_handlers: list[object] = []


def shown(context: Context) -> Iterator[tuple[Object, tuple[float, ...], float]]:
    """The cages that this view shows, without those being edited, which Blender shows; their colour and width."""
    view: Any = {"viewport": context.space_data} if isinstance(context.space_data, bpy.types.SpaceView3D) else {}
    for cage_set in CageSet.everywhere():
        for obj in cage_set.cages:
            if obj.mode == "OBJECT" and obj.visible_get(**view):
                lighter = LIGHTER * obj.select_get()
                colour = (*(part + lighter * (1.0 - part) for part in obj.color[:3]), 1.0)
                yield obj, colour, WIDTH + MORE * obj.select_get()


def lines(context: Context) -> dict[float, Any]:
    """Ends (2 m, 3) of the lines of these cages on this frame, and their colours (2 m, 4), for each width."""
    depsgraph, found = context.evaluated_depsgraph_get(), dict[float, list[tuple[Any, Any]]]()
    for obj, colour, width in shown(context):
        mesh = mesh_data.mesh_of(obj.evaluated_get(depsgraph))
        points = transform(np.array(obj.matrix_world), mesh_data.points_of(mesh)).astype(np.float32)
        ends = points[mesh_data.loop_edges(mesh)].reshape(-1, 3)
        found.setdefault(width, []).append((ends, np.tile(np.array(colour, np.float32), (len(ends), 1))))
    return {width: tuple(map(np.concatenate, zip(*same, strict=True))) for width, same in found.items()}


def _batches(context: Context) -> dict[float, Any]:
    """What is drawn in one go for each width; the same as last time, unless something has changed."""
    if _known.get("moment") != watch.moment(context):
        _known.clear()
        _known["moment"] = watch.moment(context)
    now = tuple((obj.name_full, colour, width) for obj, colour, width in shown(context))
    if now not in _known:
        shader = gpu.shader.from_builtin("POLYLINE_FLAT_COLOR")
        drawn = lines(context).items()
        _known[now] = {
            width: batch_for_shader(shader, "LINES", {"pos": ends, "color": colours})
            for width, (ends, colours) in drawn
        }
    found: dict[float, Any] = _known[now]
    return found


def _draw() -> None:
    """Draws over a 3D view that shows overlays."""
    context = bpy.context
    space, scale = context.space_data, context.preferences.system.ui_scale
    if not isinstance(space, bpy.types.SpaceView3D) or not space.overlay.show_overlays:
        return
    viewport: Any = gpu.state.viewport_get()  # type: ignore[func-returns-value]
    batches = _batches(context)
    gpu.state.blend_set("ALPHA")
    shader = gpu.shader.from_builtin("POLYLINE_FLAT_COLOR")
    shader.bind()
    shader.uniform_float("viewportSize", viewport[2:])
    for width, batch in batches.items():
        shader.uniform_float("lineWidth", width * scale)
        batch.draw(shader)
    if last_fault:
        places: Any = np.array(last_fault[0].places, np.float32)
        # Points have their own shader since Blender 4.5.
        shader = gpu.shader.from_builtin("POINT_UNIFORM_COLOR" if bpy.app.version >= (4, 5, 0) else "UNIFORM_COLOR")
        shader.bind()
        shader.uniform_float("color", RED)
        gpu.state.point_size_set(MARK * scale)
        batch_for_shader(shader, "POINTS", {"pos": places}).draw(shader)
    gpu.state.blend_set("NONE")


def register() -> None:
    _handlers.append(bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW"))


def unregister() -> None:
    while _handlers:
        bpy.types.SpaceView3D.draw_handler_remove(_handlers.pop(), "WINDOW")
    _known.clear()
