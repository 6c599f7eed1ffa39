"""What a planar shape is: meshes, their loops, exact predicates, distances and triangulations.

The one search is `broad_phase.BoxTree` (kept as `Mesh.edge_tree`): which segments may touch, which points are near
them, and the closest one. `Triangulation.locate` finds the triangle around a point, and for steps of a motion, contact
has its candidate list.
"""
