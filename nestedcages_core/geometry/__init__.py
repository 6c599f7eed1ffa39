"""What a planar shape is. The rooms and files, in the order in which one would explain them:

- `mesh/`: `Mesh`, the oriented boundary of a solid, validated once; `Nesting`, how the loops of two meshes lie in each
  other: the test of enclosure.
- `predicates/`: exact orientation, crossing segments and winding numbers.
- `vectors`: cross products, lengths and turned vectors of arrays of vectors.
- `distance`: from points to edges, with gradient and Hessian.
- `signed_distance`: to the solid of a mesh, with gradient.
- `smallest_gap`: the smallest distance between two boundaries.
- `broad_phase`: the pairs of points and edges that are closer than a radius.
- `symmetry`: mirrors and rotations; `orbits`: of the vertices of a mesh; `symmetry_search`: that of a drawing.
- `overlay`: union and intersection of solids.
- `shortest_cycle`: the cheapest choice of one candidate per layer.
- `grid`: the multiples of a length.
- `quadrature`: sample points along edges.
- `triangulation/`: triangles inside a mesh, with or without extra points.
- `arrays`: array types of all signatures.

Which search to use: `predicates.BoxTree` (kept as `Mesh.edge_tree`) for edges that touch edges and for rays,
`broad_phase.near_pairs` for all pairs within a radius, `signed_distance.EdgeSearch` for the nearest edge,
`Triangulation.locate` for the triangle around a point. All of them are built once and read; for loops that change edge
by edge, decimation has its `EdgeBoxes`, and for steps of a motion, contact has its candidate list over `near_pairs`.
`all_pairs` says when no search is needed.
"""
