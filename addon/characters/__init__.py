"""Characters: many drawings in one cage, which the bones of an armature move.

`rig`: one outline of all, bones, weights and modifier. `engine`: as JSON for game engines.
"""
