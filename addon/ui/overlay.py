"""Cages in the 3D view: lines of constant width in pixels, and the corners of bound cages as handles.

In renders a modifier gives lines their width; see `scene.display`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import bpy
import gpu
import numpy as np
from bpy.types import Context, Object
from gpu_extras.batch import batch_for_shader
from numpy.typing import NDArray

from .. import watch
from ..blender import mesh_data
from ..cage_sets import CageSet
from ..drawing.plane import transform
from ..errors import last_fault
from ..generate import groups

# Pixels at interface scale 1: default width of lines, extra width of selected cages, and size of handles.
WIDTH, MORE, HANDLE = 2.5, 1.5, 9.0
# Size of marks of a fault in the same unit, and their colour.
MARK, RED = 12.0, (1.0, 0.15, 0.1, 1.0)
# Blend of the colour of a selected cage towards white.
LIGHTER = 0.45


class Strokes(NamedTuple):
    """Ends of lines (2 m, 3) and handles (k, 3) in the world, with their colour and the width of the lines."""

    ends: NDArray[np.float32]
    handles: NDArray[np.float32]
    colour: tuple[float, float, float, float]
    width: float


class Look(NamedTuple):
    """A cage as a view shows it now: object, colour and width of lines, and whether it has handles."""

    name: str
    colour: tuple[float, float, float, float]
    width: float
    handles: bool


def looks(context: Context) -> Iterator[tuple[Object, Look]]:
    """The cages that this view shows, without those being edited, which Blender shows."""
    chosen = groups.preferences()
    wide = WIDTH if chosen is None else chosen.line_width
    view: Any = {"viewport": context.space_data} if isinstance(context.space_data, bpy.types.SpaceView3D) else {}
    for cage_set in CageSet.everywhere():
        cages = cage_set.cages
        for obj in cages:
            if obj.mode == "OBJECT" and obj.visible_get(**view):
                selected = obj.select_get()
                r, g, b = (part + LIGHTER * (1.0 - part) if selected else part for part in obj.color[:3])
                handles = bool(cage_set.bound) and obj == cages[-1]
                yield obj, Look(obj.name_full, (r, g, b, 1.0), wide + MORE * selected, handles)


def strokes(context: Context) -> Iterator[Strokes]:
    """What these cages look like on this frame."""
    depsgraph = context.evaluated_depsgraph_get()
    for obj, look in looks(context):
        mesh = mesh_data.mesh_of(obj.evaluated_get(depsgraph))
        points = transform(np.array(obj.matrix_world), mesh_data.points_of(mesh)).astype(np.float32)
        ends = points[mesh_data.loop_edges(mesh)].reshape(-1, 3)
        yield Strokes(ends, points if look.handles else points[:0], look.colour, look.width)


def together(drawn: Iterable[Strokes]) -> Iterator[tuple[str, float, NDArray[np.float32], NDArray[np.float32]]]:
    """What is drawn in one go, which takes as long as a single cage: its kind, width or size, points (n, 3) and their
    colours (n, 4).
    """
    parts: dict[tuple[str, float], list[tuple[NDArray[np.float32], NDArray[np.float32]]]] = {}
    for each in drawn:
        for kind, size, points in (("LINES", each.width, each.ends), ("POINTS", HANDLE, each.handles)):
            colours = np.tile(np.array(each.colour, np.float32), (len(points), 1))
            parts.setdefault((kind, size), []).append((points, colours))
    for (kind, size), same in parts.items():
        points, colours = map(np.concatenate, zip(*same, strict=True))
        if len(points):
            yield kind, size, points, colours


def _draw() -> None:
    """Draws the lines over a 3D view that shows overlays."""
    context = bpy.context
    space = context.space_data
    chosen = groups.preferences()
    shown = isinstance(space, bpy.types.SpaceView3D) and space.overlay.show_overlays
    if not shown:
        return
    scale = context.preferences.system.ui_scale
    viewport: Any = gpu.state.viewport_get()  # type: ignore[func-returns-value]
    gpu.state.blend_set("ALPHA")
    gpu.state.point_size_set(HANDLE * scale)
    hidden = chosen is not None and not chosen.line_width
    for kind, size, shader, batch in () if hidden else _batches(context):
        shader.bind()
        if kind == "LINES":
            shader.uniform_float("viewportSize", viewport[2:])
            shader.uniform_float("lineWidth", size * scale)
        batch.draw(shader)
    if last_fault:
        places: Any = np.array(last_fault[0].places, np.float32)
        gpu.state.point_size_set(MARK * scale)
        shader = gpu.shader.from_builtin(SHADERS["POINTS"])
        shader.bind()
        colours: Any = np.tile(np.array(RED, np.float32), (len(places), 1))
        batch_for_shader(shader, "POINTS", {"pos": places, "color": colours}).draw(shader)
    gpu.state.blend_set("NONE")


def _batches(context: Context) -> list[tuple[str, float, Any, Any]]:
    """Kind, size, shader and batch of all that is drawn; the last ones, unless something has changed."""
    if _known.get("moment") != watch.moment(context):
        _known.clear()
        _known["moment"] = watch.moment(context)
    now = tuple(look for _, look in looks(context))
    if now not in _known:
        batches = _known[now] = []
        for kind, size, points, colours in together(strokes(context)):
            shader, buffers = gpu.shader.from_builtin(SHADERS[kind]), {"pos": points, "color": colours}
            batches.append((kind, size, shader, batch_for_shader(shader, kind, buffers)))  # type: ignore[arg-type]
    found: list[tuple[str, float, Any, Any]] = _known[now]
    return found


# Points have their own shader since Blender 4.5.
SHADERS = {
    "LINES": "POLYLINE_FLAT_COLOR",
    "POINTS": "POINT_FLAT_COLOR" if bpy.app.version >= (4, 5, 0) else "FLAT_COLOR",
}

_handlers: list[object] = []
# What was drawn last, by the looks of the cages, and the moment when it was.
_known: dict[Any, Any] = {}


def register() -> None:
    _handlers.append(bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW"))


def unregister() -> None:
    while _handlers:
        bpy.types.SpaceView3D.draw_handler_remove(_handlers.pop(), "WINDOW")
    _known.clear()
