"""What artists made on output outlives new output and binding.

`outline_map`: where the vertices of a new outline lie along an old one. `rig`: what is on an object's mesh, given to
the mesh that replaces it. `pose`: how bound objects were posed, and how to bind while nothing is.
"""
