"""Few vertices and some room to move in, as for posing by hand."""

import bpy

settings = bpy.context.scene.nested_cages

settings.levels = "24, 12"
settings.use_selected_as_levels = False
settings.clearance = 0.02
settings.decimation = "ON_CURVE"
settings.show_flow = True
