"""What a planar shape is: meshes, their loops, exact predicates, distances and triangulations.

Which search to use: `predicates.BoxTree` (kept as `Mesh.edge_tree`) for edges that touch edges and for rays,
`broad_phase.near_pairs` for all pairs within a radius, `signed_distance.EdgeSearch` for the nearest edge,
`Triangulation.locate` for the triangle around a point. For loops that change edge by edge, decimation has its
`EdgeBoxes`, and for steps of a motion, contact has its candidate list.
"""
