"""Cages that follow a drawing: its animation, or its edits.

`poses`: a drawing on some frames, or while it is edited. `moving`: from poses to cages as Blender stores them.
`writing`: cages as keyed shape keys. `live`: following edits.
`claims`: checks after edits.
"""
