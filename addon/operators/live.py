"""Live: a switch to let cages follow the edits of their drawing."""

from __future__ import annotations

import bpy

from .. import record
from ..animation import bake
from ..binding.adoption import adopt
from ..following import live
from ..properties import conversion
from ..scene import ownership
from ..scene.selection import chosen, collection_of_active, scene_of
from .base import Operator, redraw


class OBJECT_OT_nested_cages_live(Operator, bpy.types.Operator):
    """Let the cages of the active object follow the edits of its drawing, in any mode, until it is switched off or
    another file is opened. Removes the animation of how the cages form
    """

    bl_label = "Live"
    modes = ()

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        if live.current() is not None:
            return ""
        collection = collection_of_active(context)
        if collection is None:
            return "Select a drawing that has cages, or one of its cages"
        if ownership.source_of(collection) is None:
            return "The drawing of these cages is gone"
        return live.why_not(collection)

    def run(self, context: bpy.types.Context) -> None:
        if live.current() is not None:
            live.stop()
            return
        scene = scene_of(context)
        adopt(scene, chosen(context)[:1])
        collection = collection_of_active(context)
        source = ownership.source_of(collection) if collection is not None else None
        assert collection is not None and source is not None
        settings = record.written(collection).settings
        options = conversion.options(settings, scene)
        if bake.is_animated(collection):
            bake.remove(scene, collection)
            self.report({"INFO"}, "The animation was removed: Generate makes it again")
        reading = conversion.reading_options(settings)
        used = conversion.used(settings)
        live.start(live.Live(scene, source, options, reading, used, lambda: redraw(bpy.context)))
