"""As tight as possible, with vertex counts relative to the drawing."""

import bpy

settings = bpy.context.scene.nested_cages

settings.levels = "10%, 3%"
settings.use_selected_as_levels = False
settings.together = False
settings.clearance = 0.0
settings.decimation = "OUTER_HULL"
settings.energy = "AREA"
settings.contact = "AUTOMATIC"
settings.repairs = {"PARITY", "FINITE", "HOME", "LENGTHS"}
settings.expansion_energy = "AUTOMATIC"
settings.solver = "AUTOMATIC"
settings.step_filter = "AUTOMATIC"
settings.broad_phase = "AUTOMATIC"
settings.flow = "AUTOMATIC"
settings.quadrature = "AUTOMATIC"
settings.starts = 3
settings.tighten = True
settings.fall_back = True
settings.show_flow = True
