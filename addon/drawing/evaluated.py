"""The lines of an object: wire edges and open boundaries of its evaluated shape."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

import bmesh
import bpy
import numpy as np
from bpy.types import Context, Object
from numpy.typing import NDArray

from ..blender.display import add_nodes_modifier, is_ours
from ..blender.mesh_data import evaluated_mesh, loop_edges, mesh_of, stored
from ..errors import UserError

# How many times as many segments as displayed tell where the true curve lies, and the maximum that Blender allows.
FINER, MOST_SEGMENTS = 4, 1024
# Places along each segment of a render that are compared with what the viewport displays.
ALONG = 4

# Makes an object whose evaluated mesh has the lines of another one, or returns that; notes new blocks in a list.
# The number: segments between two control points of a curve, 0 = its own.
Reader = Callable[[Context, Object, list[Any], int], Object]


class Lines(NamedTuple):
    """Points (n, 3) in the object's own space, and edges (m, 2) between them; ``curve``: places (k, 3) of its true
    curve, and of its lines in renders, if these were asked for.
    """

    vertices: NDArray[np.float32]
    edges: NDArray[np.int64]
    curve: tuple[NDArray[np.float32], ...] = ()


def lines_of(context: Context, obj: Object) -> Lines:
    """The current evaluated lines of an object, or the selected ones of a mesh in Edit Mode. Raises: UserError."""
    if obj.type == "MESH" and obj.mode == "EDIT":
        return _selected_edges(obj)
    if obj.type not in READERS:
        raise UserError(
            f"'{obj.name}' is of a kind without an outline: select a curve, a text, a Grease Pencil or a mesh"
        )
    with temporary() as blocks:
        return _evaluated_lines(context, _with_lines(context, obj, blocks))


def lines_of_all(context: Context, objects: Sequence[Object]) -> dict[Object, Lines]:
    """`lines_of` several objects by one evaluation of the scene, with their true curves; without those that must be
    read by themselves.
    """
    meshes_first = sorted(objects, key=lambda obj: obj.type != "MESH")  # these need no copy, which would be evaluated
    with temporary() as blocks:
        subjects = {}
        for obj in meshes_first:
            if obj.type in READERS and (obj.mode != "EDIT" or obj.type != "MESH"):
                with suppress(UserError):
                    subjects[obj] = [_with_lines(context, obj, blocks, each) for each in (0, *other_resolutions(obj))]
        found = {obj: [_evaluated_lines(context, each) for each in every] for obj, every in subjects.items()}
        return {obj: lines._replace(curve=tuple(map(_along, others))) for obj, (lines, *others) in found.items()}


def _along(lines: Lines) -> NDArray[np.float32]:
    """Places (k, 3) along all edges of lines."""
    start, end = lines.vertices[lines.edges].swapaxes(0, 1)[:, :, None]
    shares = np.linspace(0.0, 1.0, ALONG, endpoint=False, dtype=np.float32)[:, None]
    places: NDArray[np.float32] = (start + shares * (end - start)).reshape(-1, 3)
    return places


def render_resolution(obj: Object) -> int:
    """The resolution of a curve or text in renders, 0 for that of the viewport."""
    return int(obj.data.render_resolution_u) if obj.type in {"CURVE", "FONT"} else 0


def other_resolutions(obj: Object) -> tuple[int, ...]:
    """Resolutions that show the true curve of a curve or text, and that of renders; none of straight ones."""
    splines = obj.data.splines if obj.type == "CURVE" else ()
    if obj.type not in {"CURVE", "FONT"} or (splines and all(spline.type == "POLY" for spline in splines)):
        return ()
    displayed = max([obj.data.resolution_u, *(spline.resolution_u for spline in splines)])
    return tuple(filter(None, (min(FINER * displayed, MOST_SEGMENTS), render_resolution(obj))))


@contextmanager
def temporary() -> Iterator[list[Any]]:
    """A list of data-blocks, which are removed in the end."""
    blocks: list[Any] = []
    try:
        yield blocks
    finally:
        if blocks:
            bpy.data.batch_remove(blocks)


def _itself(context: Context, obj: Object, blocks: list[Any], _resolution: int = 0) -> Object:
    """A mesh object itself, or an enabled copy if it is disabled and hence not evaluated."""
    if obj.evaluated_get(context.evaluated_depsgraph_get()).is_evaluated:
        return obj
    return _shown_copy(context, obj, blocks)


def _shown_copy(context: Context, obj: Object, blocks: list[Any]) -> Object:
    """A copy that is evaluated, since nothing hides it; other animated values are already current."""
    copy = obj.copy()
    blocks.append(copy)
    copy.animation_data_clear()
    copy.hide_viewport = False
    context.scene.collection.objects.link(copy)
    return copy


def shown_at(context: Context, obj: Object, blocks: list[Any], resolution: int = 0) -> Object:
    """A curve or text itself, or with a resolution a copy of it."""
    if not resolution:
        return _itself(context, obj, blocks)
    copy = _shown_copy(context, obj, blocks)
    copy.data = obj.data.copy()
    blocks.append(copy.data)
    _set_resolution(copy.data, resolution)
    return copy


def _set_resolution(data: Any, resolution: int) -> None:
    """Sets the segments between two control points of a curve or text."""
    data.resolution_u = resolution
    for spline in getattr(data, "splines", ()):
        spline.resolution_u = resolution


def _plain_copy(context: Context, obj: Object, blocks: list[Any], resolution: int = 0) -> Object:
    """A copy of a curve or text, with its modifiers, without bevel, extrusion and fill."""
    data: Any = obj.data.copy()
    blocks.append(data)
    data.bevel_mode = "ROUND"
    data.bevel_depth = data.extrude = 0.0
    if data.bevel_object or data.taper_object:
        data.bevel_object = data.taper_object = None
    if obj.type == "FONT":
        data.fill_mode = "NONE"
    else:
        data.dimensions = "3D"
    if resolution:
        _set_resolution(data, resolution)
    if _is_deformed(obj):
        copy = _shown_copy(context, obj, blocks)
        copy.data = data
    else:  # nothing to evaluate, which would take a new dependency graph of the scene
        copy = bpy.data.objects.new(obj.name, data)
        blocks.append(copy)
    return copy


def _is_deformed(obj: Object) -> bool:
    """Whether anything else than its own points makes the shape of a curve or text."""
    data: Any = obj.data
    return bool(
        obj.modifiers
        or obj.parent_type in {"ARMATURE", "LATTICE"}
        or data.shape_keys
        or data.animation_data
        or getattr(data, "follow_curve", None)
    )


def realized(context: Context, obj: Object, blocks: list[Any]) -> Object:
    """A new mesh object with the faces and lines that an object displays, its instances included."""
    tree, mesh = bpy.data.node_groups.new(obj.name, "GeometryNodeTree"), bpy.data.meshes.new(obj.name)
    helper = bpy.data.objects.new(obj.name, mesh)
    blocks += [helper, mesh, tree]
    nodes: Any = tree.nodes
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    source = nodes.new("GeometryNodeObjectInfo")
    source.transform_space = "ORIGINAL"
    source.inputs["Object"].default_value = obj

    def then(geometry: Any, kind: str) -> Any:
        node = nodes.new(kind)
        tree.links.new(geometry, node.inputs[0])
        return node.outputs[0]

    real = then(source.outputs["Geometry"], "GeometryNodeRealizeInstances")
    parts, both = nodes.new("GeometryNodeSeparateComponents"), nodes.new("GeometryNodeJoinGeometry")
    tree.links.new(real, parts.inputs[0])
    lines = then(parts.outputs["Curve"], "GeometryNodeCurveToMesh")
    for geometry in (parts.outputs["Mesh"], lines):
        tree.links.new(geometry, both.inputs[0])
    tree.links.new(both.outputs[0], nodes.new("NodeGroupOutput").inputs[0])
    add_nodes_modifier(helper, "Curves", tree)
    context.scene.collection.objects.link(helper)
    return helper


def _with_lines(context: Context, obj: Object, blocks: list[Any], resolution: int = 0) -> Object:
    """An object, maybe a temporary one, whose evaluated mesh has the lines of another one."""
    shown = READERS[obj.type](context, obj, blocks, resolution)
    return realized(context, shown, blocks) if obj.type == "CURVES" or has_nodes(obj) else shown


def has_nodes(obj: Object) -> bool:
    """Whether Geometry Nodes of the user's add to what an object displays: instances, which are not in its mesh."""
    return any(each.type == "NODES" and each.show_viewport and not is_ours(each) for each in obj.modifiers)


READERS: dict[str, Reader] = {
    "MESH": _itself,
    "CURVE": _plain_copy,
    "FONT": _plain_copy,
    "CURVES": _itself,
}


def _evaluated_lines(context: Context, obj: Object) -> Lines:
    """The evaluated object's edges with no face (wire) or one face (boundary)."""
    with evaluated_mesh(obj.evaluated_get(context.evaluated_depsgraph_get())) as mesh:
        if mesh is None:
            return Lines(np.empty((0, 3), np.float32), np.empty((0, 2), np.int64))
        return Lines(stored(mesh.vertices, "co", 3), loop_edges(mesh))


def _selected_edges(obj: Object) -> Lines:
    """The selected edges of a mesh in Edit Mode; of faces, the border. Raises: UserError without any."""
    mesh = bmesh.from_edit_mesh(mesh_of(obj))
    mesh.verts.index_update()
    faces = [sum(face.select for face in edge.link_faces) for edge in mesh.edges]
    chosen = [edge for edge, count in zip(mesh.edges, faces, strict=True) if count == 1 or (count == 0 and edge.select)]
    if not chosen:
        raise UserError(f"'{obj.name}' is in Edit Mode without selected edges: select the loops of the drawing")
    vertices = np.array([vertex.co for vertex in mesh.verts], dtype=np.float32)
    return Lines(vertices, np.array([[vertex.index for vertex in edge.verts] for edge in chosen], dtype=np.int64))
