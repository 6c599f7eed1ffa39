"""Meshes as arrays, and cages as triangulated faces."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Literal

import bmesh
import bpy
import numpy as np
from bpy.types import Mesh, Object
from numpy.typing import NDArray

from ..core import blamed, core, triangulation
from ..errors import FloatArray

AttributeType = Literal["INT", "FLOAT", "FLOAT_VECTOR"]


def mesh_of(obj: Object) -> Mesh:
    """The mesh of a mesh object."""
    assert isinstance(obj.data, Mesh), obj.name
    return obj.data


def stored(items: Any, name: str, width: int, kind: type[Any] = np.float32) -> NDArray[Any]:
    """A property (n, width) of all n items of a collection of Blender's, such as the coordinates of vertices."""
    values = np.empty((len(items), width), kind)
    items.foreach_get(name, values.ravel())
    return values


def points_of(owner: Mesh | bpy.types.ShapeKey) -> FloatArray:
    """Vertices (n, 3) of a mesh or shape key as they are stored."""
    items = owner.points if isinstance(owner, bpy.types.ShapeKey) else owner.vertices
    return stored(items, "co", 3).astype(np.float64)


def corner_vertices(mesh: Mesh) -> NDArray[np.int32]:
    """The vertex (L,) of each corner of the faces of a mesh."""
    return stored(mesh.loops, "vertex_index", 1, np.int32).ravel()


def texture_places(mesh: Mesh) -> NDArray[np.float32] | None:
    """Places (L, 2) in a texture of the corners of the faces of a mesh, from 0 to 1; None without any."""
    layer = mesh.uv_layers.active
    return None if layer is None else stored(layer.data, "uv", 2)


def place_texture(mesh: Mesh, places: FloatArray) -> None:
    """Sets the places (n, 2) of the vertices of a mesh in its texture."""
    layer = mesh.uv_layers.get("UVMap") or mesh.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", places[corner_vertices(mesh)].astype(np.float32).ravel())


def weights_of(mesh: Mesh, groups: int) -> FloatArray:
    """Weights (groups, n) of vertices in vertex groups, by their numbers; nan for vertices that are not in a group."""
    weights = np.full((groups, len(mesh.vertices)), np.nan)
    for vertex in mesh.vertices if groups else ():
        for element in vertex.groups:
            if element.group < groups:
                weights[element.group, vertex.index] = element.weight
    return weights


def loop_edges(mesh: Mesh, most: int = 1) -> NDArray[np.int64]:
    """Edges (m, 2) of a mesh that at most one face uses: its outline; most: another number of faces."""
    edges = stored(mesh.edges, "vertices", 2, np.int32)
    faces = np.bincount(stored(mesh.loops, "edge_index", 1, np.int32).ravel(), minlength=len(edges))
    return edges[faces <= most].astype(np.int64)


@contextmanager
def evaluated_mesh(evaluated: Object) -> Iterator[Mesh | None]:
    """The mesh that an evaluated object shows, for a while; None without geometry."""
    mesh = evaluated.to_mesh()
    try:
        yield mesh
    finally:
        if mesh is not None:
            evaluated.to_mesh_clear()


def shape_of(obj: Object) -> core.Mesh:
    """The core's ``Mesh`` of a mesh object's own x and y, unposed. Raises: UserError."""
    with blamed(f"'{obj.name}'"):
        return core.Mesh(points_of(mesh_of(obj))[:, :2], loop_edges(mesh_of(obj)))


def new_mesh(name: str, points: FloatArray, edges: Any = (), faces: Any = ()) -> Mesh:
    """A new mesh with points (n, 3), or (n, 2) at height 0, edges (m, 2) and faces, lists of vertices or (t, k)."""
    data = bpy.data.meshes.new(name)
    data.vertices.add(len(points))
    high = points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])
    data.vertices.foreach_set("co", high.astype(np.float32).ravel())
    if len(edges):
        data.edges.add(len(edges))
        data.edges.foreach_set("vertices", np.asarray(edges, np.int32).ravel())
    if len(faces):
        corners = np.concatenate([np.asarray(face, np.int32) for face in faces])
        ends = np.cumsum([len(face) for face in faces], dtype=np.int32)
        data.loops.add(len(corners))
        data.loops.foreach_set("vertex_index", corners)
        data.polygons.add(len(faces))
        data.polygons.foreach_set("loop_start", np.append(np.int32(0), ends[:-1]))
    data.update(calc_edges=len(faces) > 0, calc_edges_loose=len(edges) > 0)
    return data


def filled(name: str, points: FloatArray, mesh: core.Mesh) -> Mesh:
    """A new mesh with the points (n, 3), the outline's edges and then its triangles, which leave holes open."""
    return new_mesh(name, points, mesh.edges, triangulation.triangulate(mesh).triangles)


def remove_faces(mesh: Mesh) -> None:
    """Removes the faces of a mesh, and the edges between them."""
    if not len(mesh.polygons):
        return
    work = bmesh.new()
    work.from_mesh(mesh)
    inner = [edge for edge in work.edges if len(edge.link_faces) > 1]
    for face in list(work.faces):
        work.faces.remove(face)
    for edge in inner:
        work.edges.remove(edge)
    work.to_mesh(mesh)
    work.free()


def add_faces(data: Mesh, triangles: NDArray[np.int64]) -> None:
    """Adds triangles (t, 3) to a mesh without faces; its vertices and shape keys stay."""
    data.loops.add(triangles.size)
    data.loops.foreach_set("vertex_index", triangles.astype(np.int32).ravel())
    data.polygons.add(len(triangles))
    data.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    data.update(calc_edges=True)
    data.validate()


def select_vertices(mesh: Mesh, chosen: NDArray[np.bool_]) -> None:
    """Selects vertices (n,) of a mesh, and nothing else."""
    # Blender 5.0 may store a selection as one value for all, and crashes when it is written as an array: made again.
    for name in (".select_vert", ".select_edge", ".select_poly"):
        layer: Any = mesh.attributes.get(name)
        if layer is not None:
            mesh.attributes.remove(layer)
    layer = mesh.attributes.new(".select_vert", "BOOLEAN", "POINT")
    layer.data.foreach_set("value", chosen)
    mesh.update()


def add_attribute(data: Mesh, name: str, kind: AttributeType, values: NDArray[Any]) -> None:
    """Sets an attribute of the vertices, a new one if there is none of that name."""
    attribute: Any = data.attributes.get(name) or data.attributes.new(name, kind, "POINT")
    attribute.data.foreach_set("vector" if kind == "FLOAT_VECTOR" else "value", values.ravel())
