"""From drawings to certified cages, in slices that can be cancelled, and into the scene.

`choices`: the available methods. `methods`: the chosen ones, as the core's settings. `generate`: from drawings to
levels as Blender stores them. `checking`: verification of edited cages. `job`: work in slices. `output`: levels as
objects. `rollback`: restores earlier output if new output fails.
"""
