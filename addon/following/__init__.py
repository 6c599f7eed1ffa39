"""Cages that follow a drawing: its animation, or its edits.

`poses`: the poses of an animated drawing. `moving`: from poses to certified cages as Blender stores them.
`writing`: cages as keyed shape keys. `editing`: a drawing while it is edited. `live`: following edits.
`claims`: checks after edits.
"""
