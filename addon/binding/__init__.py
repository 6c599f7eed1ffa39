"""Cages that deform their contents, by modifiers and node groups that work without the add-on.

`binding`: bind, rebind and unbind an output. `field`: the mesh that carries a cage's motion, and what follows it.
`handles`: bones at corners. `shown`: meshes while bound.
"""
