"""Convex Pieces: cages as convex polygons for collisions."""

from __future__ import annotations

import bpy

from ..errors import counted
from ..io import pieces
from ..properties.kinds import choice, length, whole
from ..scene.selection import select
from .exporters import OnOutlines, coarsest

BODY_ITEMS = (
    ("NONE", "None", "Objects alone"),
    (pieces.PASSIVE, "Passive", "Each piece is a static rigid body with the shape of its convex hull"),
    (pieces.ACTIVE, "Active", "One dynamic rigid body per cage, compounded of its pieces"),
)


class OBJECT_OT_nested_cages_pieces(OnOutlines, bpy.types.Operator):
    """Make objects that tile the selected cages, or the coarsest cage of a drawing, with convex polygons of few
    vertices, for collisions
    """

    bl_label = "Convex Pieces"

    most: whole("Vertices", "Maximum number of vertices of a piece; Box2D takes 8", default=8, min=3, soft_max=32)
    height: length(
        "Height",
        "Height of the pieces; 0 makes flat faces, or rigid bodies a fifth of the outline's size high",
        soft_max=10.0,
    )
    body: choice("Rigid Body", "What the pieces do in a simulation", BODY_ITEMS)

    def run(self, context: bpy.types.Context) -> None:
        objects = coarsest(context)
        made = pieces.make(context, objects, self.most, self.height, "" if self.body == "NONE" else self.body)
        if self.body == pieces.ACTIVE:
            select(context, *(group[0] for group in made))
        else:
            select(context, *(obj for group in made for obj in group))
        number = sum(len(group) - (self.body == pieces.ACTIVE) for group in made)
        self.report({"INFO"}, f"{counted(number, 'convex piece')} of at most {self.most} vertices")
