"""The mesh M = (V, E) of the paper, validated once, when it is made.

- `Mesh`: closed loops that bound a planar solid; `Mesh.of` reads whatever is `MeshLike`.
- `Nesting`: how the loops of two meshes lie in each other.
"""

from .mesh import Mesh
from .mesh_like import MESH_LIKE, MeshLike, is_mesh_like
from .nesting import Nesting, outer_and_inner

__all__ = ["MESH_LIKE", "Mesh", "MeshLike", "Nesting", "is_mesh_like", "outer_and_inner"]
