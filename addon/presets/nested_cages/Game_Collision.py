"""One outline of very few vertices around each drawing, without the story of how it came about."""

import bpy

settings = bpy.context.scene.nested_cages

settings.levels = "12"
settings.use_selected_as_levels = False
settings.clearance = 0.0
settings.decimation = "OUTER_HULL"
settings.show_flow = False
