"""The artist's work on output survives new output and binding.

`rig`: the artist's work on a mesh, transferred to the mesh that replaces it. `pose`: poses of bound objects, and
evaluation at rest.
"""
