"""The mesh M = (V, E) of the paper: the oriented boundary of a planar solid, validated once, when it is made."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InvalidMeshError, unreadable
from ..arrays import FloatArray, IntArray
from ..broad_phase import BoxTree
from ..drawable import Drawable
from ..loops import Loops, enclosing_pairs, extreme_places, parents, trace_loops, turning_senses
from ..vectors import format_point, norm
from .mesh_like import MESH_LIKE, MeshLike, has_edges, is_loop, is_mesh_like
from .validation import as_edges, as_rings, as_vertices, check_simple

Number = TypeVar("Number", bound=np.generic)

EXTENT_FACTOR = 2.4
"""The extent of a mesh in units of the largest distance of a vertex from their mean."""

TOPOLOGY = {"edges", "successor", "predecessor", "loops", "loop_signs"}
TOPOLOGY |= {"loop_of_vertex", "parent_of_loop", "component_of_loop"}
"""Attributes that do not change when vertices move."""


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Mesh(Drawable):
    """Closed loops that bound a planar solid with holes and components; normals point out.

    Parameters
    ----------
    vertices : (n, 2) array_like
        Coordinates, in any unit of length.
    edges : (n, 2) array_like of int
        Indices of the two vertices of each edge, in any direction.

    Attributes
    ----------
    vertices : (n, 2) array of float64
        The exact input values, in their order; read-only, as are all arrays.
    edges : (n, 2) array of int64
        In the order of the input; turned where needed, so that outer loops run counter-clockwise and holes clockwise,
        by nesting depth.

    Raises
    ------
    InvalidMeshError
        Unless the loops are closed, have at least three vertices and neither cross nor touch. ``code`` and ``data``
        name the vertices, the loops and the place.

    Examples
    --------
    >>> from nestedcages_core import Mesh
    >>> square = Mesh([(0, 0), (4, 0), (4, 4), (0, 4)], [(0, 1), (1, 2), (2, 3), (3, 0)])
    >>> square.area
    16.0
    """

    vertices: FloatArray
    edges: IntArray
    successor: IntArray = field(init=False)
    """(n,) the vertex after each vertex; the edge that starts at vertex v ends at successor[v]."""
    loops: tuple[IntArray, ...] = field(init=False)
    """Vertices of each loop in oriented order from its smallest one; loops are in the order of these."""
    loop_signs: IntArray = field(init=False)
    """(L,) role of each loop: 1 outer, -1 hole."""
    parent_of_loop: IntArray = field(init=False)
    """(L,) the smallest loop around each loop, -1 for none."""
    component_of_loop: IntArray = field(init=False)
    """(L,) the component each loop bounds, numbered by outer loops; a hole belongs to the smallest loop around it."""
    is_validated: bool = field(init=False)
    """Whether these vertices have been validated; False for a mesh made by `moved`."""
    loop_order: Loops = field(init=False)
    """The loops one after the other, for all that walks along them."""

    def __init__(self, vertices: ArrayLike, edges: ArrayLike) -> None:
        checked = as_vertices(vertices)
        joined = as_edges(edges, len(checked))
        self._build(checked, joined, trace_loops(joined, checked))

    def _build(self, checked: FloatArray, joined: IntArray, order: Loops) -> None:
        """Validate and orient loops of vertices (n, 2) joined by edges (n, 2), which are turned in place."""
        check_simple(order)
        extreme = extreme_places(order)
        if len(order.sizes) > 1:
            depth, parent = parents(*enclosing_pairs(order.vertices[extreme], order), len(order.sizes))
        else:
            depth, parent = np.array([0]), np.array([-1])
        signs = 1 - 2 * (depth % 2)
        reversed_ = turning_senses(order, extreme) != signs
        if reversed_.any():
            order = order.turned(reversed_)
        following = order.successor
        turned = following[joined[:, 0]] != joined[:, 1]
        joined[turned] = joined[turned, ::-1]
        outer = signs > 0
        component = np.cumsum(outer) - 1
        component[~outer] = component[parent[~outer]]
        self._fill(
            vertices=checked,
            edges=_frozen(joined),
            successor=_frozen(following),
            loops=tuple(np.split(_frozen(order.numbers), order.begins[1:])),
            loop_signs=_frozen(signs),
            parent_of_loop=_frozen(parent),
            component_of_loop=_frozen(component),
            is_validated=True,
            loop_order=order,
        )
        if not self.area > 0.0:
            raise InvalidMeshError(
                f"The area inside the loops around {format_point(checked[0])} is too small for floating-point numbers; "
                "scale the shape up or make it wider.",
                code="mesh.out_of_range",
            )

    @classmethod
    def from_loops(cls, loops: Iterable[ArrayLike]) -> Mesh:
        """A mesh from closed loops of points.

        Parameters
        ----------
        loops : iterable of (k, 2) array_like
            Each in any direction; a repeated closing point is dropped.

        Returns
        -------
        Mesh
            With the vertices loop after loop.

        Raises
        ------
        InvalidMeshError
            As for `Mesh`.
        """
        checked, sizes = as_rings(loops)
        mesh, order = object.__new__(cls), Loops.of(checked, sizes)
        mesh._build(checked, np.stack((order.numbers, order.ahead), axis=1), order)
        return mesh

    @classmethod
    def from_geometry(cls, geometry: Any) -> Mesh:
        """A mesh from polygons, multipolygons, features and collections of these.

        Parameters
        ----------
        geometry : Any
            An object with `__geo_interface__`, or such a mapping.

        Returns
        -------
        Mesh

        Raises
        ------
        InvalidMeshError
            As for `Mesh`, and where a polygon lies inside another one, or a hole outside its polygon.
        """
        mesh: Mesh = cls.formats("meshes").mesh_of(geometry, strict=True)
        return mesh

    @classmethod
    def of(cls, shape: MeshLike, *, strict: bool = False, inside: bool = False) -> Mesh:
        """A mesh as it is, or read from what describes one.

        Geometries may be all that is valid for shapely: repeated points are left out, parts that touch in a point are
        joined by a very narrow neck, and members of collections are united; a NestedCagesWarning names each repair. The
        mesh holds all polygons exactly, or lies in them.

        Parameters
        ----------
        shape : MeshLike
            A mesh, an object with `__geo_interface__`, such a mapping, a loop (k, 2), a list of loops, or a tuple
            (V, E) of vertices and edges.
        strict : bool, optional
            Reject geometries that need a repair.
        inside : bool, optional
            For cages inside: what a repair changes is cut off. Default: it is added.

        Returns
        -------
        Mesh

        Raises
        ------
        InvalidMeshError
            For what is none of these or cannot be repaired.
        """
        if isinstance(shape, cls):
            return shape
        if not is_mesh_like(shape):
            raise unreadable(f"A shape must be {MESH_LIKE}, not {type(shape).__name__}.")
        if isinstance(shape, list | tuple | np.ndarray):
            if has_edges(shape):
                return cls(*shape)
            return cls.from_loops([shape] if is_loop(shape) else shape)
        mesh: Mesh = cls.formats("meshes").mesh_of(shape, strict=strict, inside=inside)
        return mesh

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        """A Polygon, or a MultiPolygon if there are several components."""
        polygons: list[Any] = [()] * (int(self.component_of_loop.max()) + 1)
        for k in np.argsort(-self.loop_signs, kind="stable"):
            ring = tuple(map(tuple, self.vertices[self.loops[k]].tolist()))
            polygons[self.component_of_loop[k]] += ((*ring, ring[0]),)
        if len(polygons) == 1:
            return {"type": "Polygon", "coordinates": polygons[0]}
        return {"type": "MultiPolygon", "coordinates": tuple(polygons)}

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.loops)} loop{'s' if len(self.loops) > 1 else ''})"

    def __eq__(self, other: object) -> bool:
        """Whether another mesh has the same vertices and edges, in the same order."""
        if not isinstance(other, Mesh):
            return NotImplemented
        return np.array_equal(self.vertices, other.vertices) and np.array_equal(self.edges, other.edges)

    def __hash__(self) -> int:
        return hash((len(self.vertices), tuple((self.vertices[:2] + 0.0).flat)))  # equal for 0.0 and -0.0

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """The mesh alone."""
        return (self,)

    @property
    def rings(self) -> tuple[FloatArray, ...]:
        """(k, 2) vertices of each loop in oriented order; the first one is not repeated at the end."""
        return tuple(self.vertices[loop] for loop in self.loops)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Bounding box: least x, least y, largest x, largest y."""
        return (*self.vertices.min(axis=0).tolist(), *self.vertices.max(axis=0).tolist())

    def moved(self, vertices: ArrayLike) -> Mesh:
        """The same edges and roles with other vertices.

        Parameters
        ----------
        vertices : (n, 2) array_like
            As many as before.

        Returns
        -------
        Mesh
            Not validated and not re-oriented; see `validated`.

        Raises
        ------
        InvalidMeshError
            For another shape of the array.
        """
        moved = np.array(vertices, dtype=np.float64)
        if moved.shape != self.vertices.shape:
            raise unreadable(
                f"The moved vertices have shape {moved.shape}, but the mesh has {self.vertices.shape}; give as many."
            )
        mesh = object.__new__(Mesh)
        kept = {name: value for name, value in vars(self).items() if name in TOPOLOGY}
        order = self.loop_order.moved(moved.take(self.loop_order.numbers, axis=0))
        mesh._fill(**kept, vertices=_frozen(moved), is_validated=False, loop_order=order)
        return mesh

    def validated(self) -> Mesh:
        """This mesh if it is validated, else a validated copy.

        Returns
        -------
        Mesh

        Raises
        ------
        InvalidMeshError
            As for `Mesh`.
        """
        return self if self.is_validated else Mesh(self.vertices, self.edges)

    def has_loops_like(self, other: Mesh) -> bool:
        """Whether another mesh has as many outer loops and as many holes."""
        return np.array_equal(np.sort(self.loop_signs), np.sort(other.loop_signs))

    def has_roles_of(self, other: Mesh) -> bool:
        """Whether each loop lies in the others as that of the same number in another mesh of as many loops."""
        same = (self.loop_signs == other.loop_signs) & (self.component_of_loop == other.component_of_loop)
        return bool(same.all())

    @property
    def predecessor(self) -> IntArray:
        """(n,) the vertex before each vertex."""
        return _frozen(self.loop_order.predecessor)

    @cached_property
    def loop_of_vertex(self) -> IntArray:
        """(n,) the loop of each vertex."""
        owner = np.empty_like(self.successor)
        owner[self.loop_order.numbers] = self.loop_order.loop
        return _frozen(owner)

    @property
    def edge_ends(self) -> FloatArray:
        """(n, 2) where the edge that starts at each vertex ends."""
        return self.vertices.take(self.successor, axis=0)

    @cached_property
    def edge_lengths(self) -> FloatArray:
        """(n,) length of the edge that starts at each vertex."""
        return _frozen(norm(self.edge_ends - self.vertices))

    @property
    def edge_tree(self) -> BoxTree:
        """Bounding boxes of the edges, loop after loop: segment k starts at vertex ``loop_order.numbers[k]``."""
        return self.loop_order.tree

    @property
    def edge_search(self) -> BoxTree:
        """The edges in the order of their starts: segment v starts at vertex v."""
        return BoxTree(self.vertices, self.edge_ends)

    @cached_property
    def diagonal(self) -> float:
        """Diagonal of the bounding box."""
        return float(np.hypot(np.ptp(self.vertices[:, 0]), np.ptp(self.vertices[:, 1])))

    @cached_property
    def extent(self) -> float:
        """Size that does not depend on the rotation of the mesh; on average near the diagonal of the bounding box.

        2.4 times the largest distance of a vertex from the mean of all: 0.85 diagonals for a disc, 1.2 for a line.
        """
        return EXTENT_FACTOR * float(np.hypot(*(self.vertices - self.vertices.mean(axis=0)).T).max())

    @property
    def loop_areas(self) -> FloatArray:
        """(L,) signed area of each loop: holes count negative."""
        return _frozen(self.loop_order.areas)

    @property
    def area(self) -> float:
        """Area of the solid; positive for a validated mesh."""
        return self.loop_order.area

    def _fill(self, **fields: Any) -> None:
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Pickled arrays lose their write protection, which is restored here."""
        for value in state.values():
            for array in value if isinstance(value, tuple) else (value,):
                if isinstance(array, np.ndarray):
                    array.flags.writeable = False
        self._fill(**state)


def _frozen(array: NDArray[Number]) -> NDArray[Number]:
    """The array itself, made read-only."""
    array.flags.writeable = False
    return array
