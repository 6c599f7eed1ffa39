"""The places that the last message is about, in the 3D view."""

from __future__ import annotations

from typing import Any

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ..errors import last_fault

# Size of a mark in pixels at interface scale 1, and its colour.
SIZE, RED = 12.0, (1.0, 0.15, 0.1, 1.0)


def _draw() -> None:
    """Marks the places over a 3D view that shows overlays."""
    context = bpy.context
    space = context.space_data
    if not last_fault or not (isinstance(space, bpy.types.SpaceView3D) and space.overlay.show_overlays):
        return
    places: Any = np.array(last_fault[0].places, np.float32)
    shader = gpu.shader.from_builtin("POINT_UNIFORM_COLOR" if bpy.app.version >= (4, 5, 0) else "UNIFORM_COLOR")
    shader.bind()
    shader.uniform_float("color", RED)
    gpu.state.point_size_set(SIZE * context.preferences.system.ui_scale)
    batch_for_shader(shader, "POINTS", {"pos": places}).draw(shader)


_handlers: list[object] = []


def register() -> None:
    _handlers.append(bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW"))


def unregister() -> None:
    while _handlers:
        bpy.types.SpaceView3D.draw_handler_remove(_handlers.pop(), "WINDOW")
