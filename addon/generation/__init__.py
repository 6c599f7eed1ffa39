"""From drawings to certified cages, in slices that can be cancelled, and into the scene.

`choices`: the methods to choose from. `methods`: a choice of each, as the core's settings. `generate`: drawings to
levels as Blender stores them. `checking`: whether cages still hold. `job`: work in slices. `output`: levels as objects.
`rollback`: earlier output comes back if new output fails.
"""
