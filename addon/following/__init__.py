"""Cages that follow a drawing: its animation, frame by frame, or its edits as they are made.

`poses`: an animated drawing to its poses. `moving`: poses to certified cages, in the numbers that Blender stores.
`writing`: these to keyed shape keys. `editing`: a drawing as it is being edited. `live`: following edits.
"""
