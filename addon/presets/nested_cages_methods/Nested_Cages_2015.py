"""For comparisons, after Sacht, Vouga & Jacobson (2015): edge collapse, signed distance flow, El Topo."""

import bpy

settings = bpy.context.scene.nested_cages

settings.levels = "20%"
settings.use_selected_as_levels = False
settings.together = False
settings.clearance = 0.0
settings.decimation = "EDGE_COLLAPSE"
settings.energy = "AREA"
settings.contact = "EL_TOPO"
settings.repairs = {"PARITY", "FINITE", "HOME", "LENGTHS"}
settings.expansion_energy = "AUTOMATIC"
settings.solver = "AUTOMATIC"
settings.step_filter = "AUTOMATIC"
settings.broad_phase = "AUTOMATIC"
settings.flow = "SIGNED_DISTANCE_2015"
settings.quadrature = "AUTOMATIC"
settings.starts = 1
settings.tighten = False
settings.fall_back = False
settings.show_flow = True
