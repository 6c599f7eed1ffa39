"""Characters: many drawings in one cage, which the bones of an armature move.

`drawing`: all that is seen as one outline. `bones`: armatures as the core's bones, and back.
`rig`: weights, modifier.
"""
