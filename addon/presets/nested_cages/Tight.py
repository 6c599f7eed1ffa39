"""As tight as the number of vertices allows, which follows the drawing."""

import bpy

settings = bpy.context.scene.nested_cages

settings.levels = "10%, 3%"
settings.use_selected_as_levels = False
settings.clearance = 0.0
settings.decimation = "OUTER_HULL"
settings.show_flow = True
