"""What can be read as a mesh: geometries of other programs, loops, vertices with edges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, TypeAlias, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

MESH_LIKE = "a Mesh, an object with __geo_interface__, an array (k, 2), or a list of loops with rows (x, y)"
"""What `Mesh.of` reads, in words."""


class HasGeoInterface(Protocol):
    """An object that describes itself as a geometry, for instance a Mesh, or one of shapely or geopandas."""

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        """A mapping as in GeoJSON."""


MeshLike: TypeAlias = HasGeoInterface | Sequence[ArrayLike] | NDArray[Any] | Mapping[str, Any]
"""What `Mesh.of` reads."""


def is_mesh_like(shape: object) -> TypeGuard[MeshLike]:
    """Whether `Mesh.of` can try to read a value."""
    if isinstance(shape, list | tuple | np.ndarray | Mapping):
        return True
    name = "__geo_interface__"  # asked of the class first: as a property it would be computed
    return not isinstance(shape, type) and (hasattr(type(shape), name) or hasattr(shape, name))


def is_loop(shape: Sequence[Any] | NDArray[Any]) -> bool:
    """Whether the entries of a list or an array are points, not loops."""
    if isinstance(shape, np.ndarray):
        return shape.ndim == 2
    first = shape[0] if len(shape) else ()
    return isinstance(first, list | tuple | np.ndarray) and len(first) > 0 and bool(np.isscalar(first[0]))


def has_edges(shape: Sequence[Any] | NDArray[Any]) -> bool:
    """Whether a list is (V, E): the second of two arrays holds the numbers of all rows of the first, and no others."""
    if isinstance(shape, np.ndarray) or len(shape) != 2 or not isinstance(shape[1], np.ndarray):
        return False
    vertices, edges = shape
    if not isinstance(vertices, list | tuple | np.ndarray) or edges.dtype.kind not in "iu" or edges.shape[1:] != (2,):
        return False
    return bool(np.array_equal(np.unique(edges), np.arange(len(vertices))))
