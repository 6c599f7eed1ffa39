"""Cages that deform their contents, by modifiers and node groups that work without the add-on.

`binding`: bind, rebind and unbind an output. `deform_modifiers`: one mesh follows one cage, by the best modifier.
`weights`: cage coordinates as attributes. `node_groups`: the Geometry Nodes. `originals`: the drawing's own object.
"""
