"""While the animation plays, a moving copy of the drawing replaces the originals. It follows the fine mesh and is
filled with the drawing's own materials.
"""

from __future__ import annotations

import bpy

from .. import record
from ..scene import display, filled_copy, ownership
from . import shape_keys, timeline, visibility


def enter(collection: bpy.types.Collection) -> None:
    """Hides the originals of an output before and after its result, and shows the moving copy instead.

    Around inner cages the drawing does not move; in another scene without the cages it stays as it is.
    """
    leave(collection)
    frames, fine = timeline.frames_of(collection), ownership.member(collection, 0)
    if frames is None or fine is None or ownership.is_bound(collection) or ownership.is_inside(collection):
        return
    first, result, last = frames
    # Before the return, if there is one, the result is held for a step.
    back = [] if last == result else [(result + 1 + (last - 2 * result + first), True), (last + 1, False)]
    playing = [(first - 1, False), (first, True), (result, False), *back]
    source = ownership.source_of(collection)
    if source is not None and _is_elsewhere(source, fine):
        return
    found = record.written(collection)
    found.playing = True
    for part in found.sources:
        if ownership.exists(part.object) and visibility.is_free(part.object):
            part.hidden = True
            visibility.switch(part.object, playing)
    copy = filled_copy.make(collection, fine, source)
    visibility.switch(copy, [(frame, not hidden) for frame, hidden in playing])


def _is_elsewhere(source: bpy.types.Object, fine: bpy.types.Object) -> bool:
    """Whether a drawing is in a scene that its cages are not in, where it would be hidden, and its copy a ghost."""
    return any(s.objects.get(source.name) == source and s.objects.get(fine.name) != fine for s in bpy.data.scenes)


def leave(*collections: bpy.types.Collection) -> None:
    """Shows the originals of outputs again and removes the moving copies."""
    actions: list[bpy.types.Action | None] = []
    copies: list[bpy.types.Object] = []
    for collection in collections:
        found = record.written(collection)
        for part in found.sources:
            if part.hidden and ownership.exists(part.object):
                actions.append(visibility.detach(part.object).action)
            part.hidden = False
        found.playing = False
        fine = ownership.member(collection, 0)
        copies += filled_copy.copies_of(fine) if fine is not None else []
    for copy in copies:
        for modifier in list(copy.modifiers):
            display.remove_modifier(copy, modifier)
    shape_keys.discard(copies, [copy.data for copy in copies if isinstance(copy.data, bpy.types.Mesh)], actions)
