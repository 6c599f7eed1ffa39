"""The operators, thin wrappers of the public functions of other rooms."""

from __future__ import annotations

import bpy

from ..following import live as following_live
from ..generation.job import running
from . import (
    adopt,
    bake,
    bind,
    cutout,
    exporters,
    fault,
    follow,
    handles,
    image_outline,
    importers,
    levels,
    live,
    pieces,
    report,
    rig,
    silhouette,
)
from .generate import OBJECT_OT_nested_cages_cancel, OBJECT_OT_nested_cages_generate
from .verify import OBJECT_OT_nested_cages_verify

CLASSES = (
    OBJECT_OT_nested_cages_generate,
    OBJECT_OT_nested_cages_cancel,
    OBJECT_OT_nested_cages_verify,
    *adopt.CLASSES,
    *fault.CLASSES,
    *bake.CLASSES,
    *bind.CLASSES,
    *handles.CLASSES,
    *rig.CLASSES,
    *report.CLASSES,
    *follow.CLASSES,
    *live.CLASSES,
    *importers.CLASSES,
    *exporters.CLASSES,
    *pieces.CLASSES,
    *levels.CLASSES,
    *image_outline.CLASSES,
    *cutout.CLASSES,
    *silhouette.CLASSES,
)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    following_live.stop()
    job = running()
    if job is not None:
        job.end(bpy.context)  # Blender drops a running operator whose class is unregistered, without calling cancel
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
