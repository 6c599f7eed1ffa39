"""Outlines for ever smaller scales, each of which encloses all land of the one before."""

import bpy

settings = bpy.context.scene.nested_cages

settings.levels = "25%, 8%, 2%"
settings.use_selected_as_levels = False
settings.clearance = 0.0
settings.decimation = "OUTER_HULL"
settings.show_flow = False
