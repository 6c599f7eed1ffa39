"""The mesh M = (V, E) of the paper, validated once, when it is made.

- `Mesh`: closed loops that bound a planar solid; `Mesh.of` reads whatever is `MeshLike`.
- `Nesting`: how the loops of two meshes lie in each other.
"""

from .mesh import Mesh
from .mesh_like import MESH_LIKE, MeshLike, is_mesh_like
from .nesting import Nesting, by_side

__all__ = ["MESH_LIKE", "Mesh", "MeshLike", "Nesting", "by_side", "is_mesh_like"]
