"""A drawing while it is edited."""

from __future__ import annotations

from dataclasses import replace

import bpy

from ..scene.convert import Drawing, Outline, ReadingOptions, drawing_in, fine_drawing, read
from ..scene.filling import mesh_of
from ..scene.plane import Frame
from .poses import in_own_space


def drawing_now(
    context: bpy.types.Context, obj: bpy.types.Object, options: ReadingOptions, frame: Frame | None = None
) -> Drawing:
    """The current drawing, in any mode, in its object's space. Raises: UserError.

    frame: its previous plane; used if the drawing is not flat in its object.
    """
    outline = in_own_space(_outline(context, obj, options))
    drawing = fine_drawing(outline, options)
    if frame is not None and not drawing.frame.own:
        return drawing_in(frame, outline, options)
    return drawing


def _outline(context: bpy.types.Context, obj: bpy.types.Object, options: ReadingOptions) -> Outline:
    if obj.mode != "EDIT":
        return read(context, obj, options)
    obj.update_from_editmode()
    if obj.type != "MESH":
        return read(context, obj, options)
    # Of a mesh in Edit Mode only the selection would be read; a copy is read completely.
    copy, data = obj.copy(), mesh_of(obj).copy()
    try:
        copy.data = data
        context.scene.collection.objects.link(copy)
        found = read(context, copy, options)
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(data)
    return replace(found, name=obj.name, identity=obj.session_uid)
