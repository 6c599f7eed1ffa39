"""Several objects as one drawing: their painted areas united, with edges short enough to bend."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ..core import core
from ..errors import UserError
from ..generation.job import Work
from ..io import silhouette
from ..scene.convert import Drawing
from ..scene.plane import size
from ..scene.uniting import divided, stored

# Longest edge of the outline as a fraction of its size: straight limbs bend, and few corners don't limit the cage.
LONGEST_EDGE = 0.01


def united(
    context: bpy.types.Context, objects: Sequence[bpy.types.Object], gap: float
) -> Work[tuple[Drawing, list[UserError]]]:
    """All that objects paint as one drawing of the largest of them, and why some were left out. Raises: UserError.

    gap: parts closer than this length of the scene are joined.
    """
    first = max(sorted(objects, key=lambda obj: obj.name), key=lambda obj: float(obj.dimensions.length))
    ordered = [first, *(obj for obj in objects if obj != first)]
    frame = silhouette.plane_of(context, first, "ACTIVE")
    options = silhouette.Options(gap=gap, closed=True)
    loops, problems = yield from silhouette.outline(context, ordered, frame, options)
    longest = LONGEST_EDGE * size(np.concatenate(loops))
    shorter = tuple(stored(divided(loop, longest)) for loop in loops)
    others = tuple(Drawing(obj.name, frame, (), obj.session_uid) for obj in ordered[1:])
    drawing = Drawing(first.name, frame, shorter, first.session_uid, others, united=True)
    try:
        core.Mesh.from_loops(shorter)
    except core.NestedCagesError:  # rounding closed a gap between new points
        drawing = Drawing(first.name, frame, loops, first.session_uid, others, united=True)
    return drawing, problems
