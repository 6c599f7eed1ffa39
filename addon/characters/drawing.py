"""Several objects as one drawing: their painted areas united, with edges short enough to bend."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import bpy
import numpy as np

from .. import record
from ..binding import field
from ..core import core
from ..errors import UserError
from ..generation.job import Work
from ..io import silhouette
from ..scene import ownership
from ..scene.convert import Drawing
from ..scene.plane import size
from ..scene.uniting import divided, stored

# Longest edge of the outline as a fraction of its size: straight limbs bend, and few corners don't limit the cage.
LONGEST_EDGE = 0.01


def united(
    context: bpy.types.Context, objects: Sequence[bpy.types.Object], gap: float
) -> Work[tuple[Drawing, list[UserError]]]:
    """All that objects paint as one drawing of the one that their cage is named after, or else of the largest, and why
    some were left out. Raises: UserError.

    gap: parts closer than this length of the scene are joined.
    """
    first = max(sorted(objects, key=lambda obj: obj.name), key=lambda obj: float(obj.dimensions.length))
    earlier = set_of(objects)
    if earlier is not None and ownership.source_of(earlier) in objects:
        first = next(obj for obj in objects if obj == ownership.source_of(earlier))
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


def set_of(objects: Sequence[bpy.types.Object]) -> bpy.types.Collection | None:
    """The output that the most of some objects are bound to."""
    fields = [field.followed(obj) for obj in objects]
    cages = [record.shown(made, record.FIELD) for made in fields if made is not None]
    homes = [ownership.home_of_member(cage) for cage in cages if cage is not None]
    found = Counter(home for home in homes if home is not None).most_common(1)
    return found[0][0] if found else None
