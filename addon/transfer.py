"""New outlines for objects on which an artist has worked: the work stays in the mesh, at the same places along the
outline, and so do the placement, the pose, hooks and vertex parents.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import bmesh
import bpy
import numpy as np
from bpy.types import Mesh, Object
from mathutils import Matrix
from numpy.typing import NDArray

from . import cage_sets, keys
from .blender import display, shape_keys
from .blender.mesh_data import loop_edges, mesh_of, points_of, stored
from .core import core, distance
from .drawing import placement
from .drawing.plane import size
from .errors import FloatArray

IntArray: TypeAlias = NDArray[np.int64]

# Blender's own attributes, which new meshes have too.
BUILT_IN = ("position", "material_index", "sharp_face", "sharp_edge", "shade_smooth")
# Smallest overlap of the boxes of two loops on each axis, as a fraction of their common range, to compare them in
# place; otherwise the new loop is first scaled into the box of the old one.
SHARED_RANGE = 0.5
# A share of a vertex that counts for nothing; without any, Blender copies what Python refers to it by.
TINY = 1e-30
# Distances that are computed at once.
CHUNK = 2_000_000
# All properties of a placement, in the order in which they are set.
PLACEMENT = (*placement.PARENTING, *placement.TRANSFORM)
# Smaller offsets of vertices, as a fraction of the size, are rounding, not a pose.
SMALLEST_POSE = 1e-5


class Along(NamedTuple):
    """For each new vertex, the ends (m,) of the old edge that it lies on, and its parameter (m,) there."""

    first: IntArray
    second: IntArray
    part: FloatArray

    def of(self, values: FloatArray) -> FloatArray:
        """Values (n, 3) of the old vertices at the new ones, (m, 3)."""
        mixed: FloatArray = values[self.first] + self.part[:, None] * (values[self.second] - values[self.first])
        return mixed


def reshape(
    obj: Object, points: FloatArray, edges: IntArray, *, numbered: bool = False
) -> tuple[list[str], FloatArray]:
    """Gives an object without steps the vertices (n, 3) and edges (m, 2) of an outline; returns what of the artist's
    work could not be kept, in words, and how far (n, 3) the old outline was moved since it was bound.

    numbered: vertices keep their numbers if there are as many as before, wherever they are.
    """
    if mesh_of(obj).users > 1:
        obj.data = mesh_of(obj).copy()
    mesh = mesh_of(obj)
    rest, outline = rest_points(mesh), loop_edges(mesh)
    offsets = points_of(mesh) - rest
    attributes: Any = mesh.attributes
    for name in [each.name for each in attributes if each.name.startswith(keys.PREFIX)]:
        attributes.remove(attributes[name])
    lost = [f"the attribute '{each.name}'" for each in _artists(mesh) if each.domain != "POINT"]
    if (numbered and len(points) == len(rest)) or np.array_equal(points, rest):
        along = Along(np.arange(len(points)), np.arange(len(points)) - 1, np.zeros(len(points)))
    else:
        along = _along(rest, outline, points, edges)
        _renumber(obj, along, rest)
    if is_worked_on(obj):
        _interpolate(mesh, along, points, edges)
    else:
        if mesh.shape_keys is not None:
            obj.shape_key_clear()
        mesh.clear_geometry()
        mesh_of(obj).vertices.add(len(points))
        mesh.edges.add(len(edges))
        mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
        mesh.edges.foreach_set("vertices", edges.astype(np.int32).ravel())
    mesh.update()
    return lost, along.of(offsets)


def _interpolate(mesh: Mesh, along: Along, points: FloatArray, edges: IntArray) -> None:
    """Replaces the geometry of a mesh; all that its vertices carry is interpolated, of shape keys what they move."""
    work = bmesh.new()
    work.from_mesh(mesh)
    shapes: Any = work.verts.layers.shape.values()
    weights: Any = work.verts.layers.deform.values()
    old, new = list(work.verts), [work.verts.new(point) for point in points]
    for vertex, first, second, part in zip(new, *(each.tolist() for each in along), strict=True):
        ends = (first, second) if part < 1.0 else (second, first)
        vertex.copy_from_vert_interp([old[end] for end in ends], part if TINY < part < 1.0 else TINY)
        for groups in (vertex[layer] for layer in weights):
            for group in [group for group, weight in groups.items() if weight <= TINY]:
                del groups[group]
        for shape in shapes[1:]:
            vertex[shape] += vertex.co - vertex[shapes[0]]
        for basis in shapes[:1]:
            vertex[basis] = vertex.co
    for start, end in edges.tolist():
        work.edges.new([new[start], new[end]])
    for vertex in old:
        work.verts.remove(vertex)
    work.to_mesh(mesh)
    work.free()


def _artists(mesh: Mesh) -> list[Any]:
    """The artist's attributes of a mesh."""
    attributes: Any = mesh.attributes
    return [each for each in attributes if not each.name.startswith((".", keys.PREFIX)) and each.name not in BUILT_IN]


def is_worked_on(obj: Object) -> bool:
    """Whether the vertices of an object carry work of an artist."""
    return bool(obj.vertex_groups or artists_keys(obj.data.shape_keys) or _artists(mesh_of(obj)))


def is_rigged(obj: Object) -> bool:
    """Whether an output object carries work of an artist that would be lost with it."""
    modifiers = [modifier for modifier in obj.modifiers if not display.is_ours(modifier)]
    children = [child for child in obj.children if not cage_sets.is_helper(child, cage_sets.FIELD, cage_sets.LINES)]
    constrained = len(obj.constraints) > (placement.constraint_of(obj) is not None)
    return bool(is_worked_on(obj) or constrained or modifiers or children or shape_keys.action_of(obj) is not None)


def artists_keys(block: bpy.types.Key | None) -> list[bpy.types.ShapeKey]:
    """The shape keys of a mesh that are neither its basis nor steps of our animation."""
    blocks = block.key_blocks if block is not None else ()
    return [key for key in blocks if key != block.reference_key and not shape_keys.STEP.fullmatch(key.name)]


def rest_points(mesh: Mesh) -> FloatArray:
    """Vertices (n, 3) of a mesh at rest: as bound, or of the basis of its shape keys."""
    attribute: Any = mesh.attributes.get(keys.REST)
    if attribute is not None and attribute.data_type == "FLOAT_VECTOR" and attribute.domain == "POINT":
        return stored(attribute.data, "vector", 3).astype(np.float64)
    return points_of(mesh if mesh.shape_keys is None else mesh.shape_keys.reference_key)


def _renumber(obj: Object, along: Along, rest: FloatArray) -> None:
    """Changes vertex indices in hooks and vertex parents to the nearest new vertices."""
    there = along.of(rest)

    def nearest(old: Iterable[int]) -> list[int]:
        return [int(((there - rest[index]) ** 2).sum(axis=1).argmin()) for index in old if index < len(rest)]

    for modifier in obj.modifiers:
        if isinstance(modifier, bpy.types.HookModifier) and len(modifier.vertex_indices):
            modifier.vertex_indices_set(sorted(set(nearest(modifier.vertex_indices))))
    for child in obj.children:
        if child.parent_type in {"VERTEX", "VERTEX_3"}:
            child.parent_vertices = [*nearest(child.parent_vertices), 0, 0, 0][:3]


def _along(rest: FloatArray, outline: IntArray, points: FloatArray, edges: IntArray) -> Along:
    """The nearest points of an old outline, loop by loop, on edges that face the same way.

    Loops are matched by their boxes if there are equally many, otherwise all old loops are searched; edges that make no
    outline are searched whichever way they face.
    """
    try:
        old, new = core.Mesh(rest[:, :2], outline), core.Mesh(points[:, :2], edges)
    except core.NestedCagesError:
        ends = outline.T if len(outline) else np.stack([np.arange(len(rest)), np.arange(len(rest)) - 1])
        return _nearest(rest, ends, points[:, :2], np.zeros((len(points), 2)))
    found = Along(np.empty(len(points), int), np.empty(len(points), int), np.empty(len(points)))
    for loop, partner in zip(new.loops, _partners(old, new), strict=True):
        start = np.concatenate(old.loops) if partner is None else old.loops[partner]
        places = new.vertices[loop]
        tangents = np.roll(places, -1, axis=0) - np.roll(places, 1, axis=0)
        if partner is not None:
            places = _into(places, old.vertices[start])
        nearest = _nearest(rest, np.stack([start, old.successor[start]]), places, tangents)
        for values, of_loop in zip(found, nearest, strict=True):
            values[loop] = of_loop
    return found


def _partners(old: core.Mesh, new: core.Mesh) -> Sequence[int | None]:
    """The old loop for each new one, if there are as many of each kind: the nearest box."""
    from scipy.optimize import linear_sum_assignment

    if sorted(old.loop_signs) != sorted(new.loop_signs):
        return [None] * len(new.loops)
    boxes = [np.array([_box(mesh.vertices[loop]).ravel() for loop in mesh.loops]) for mesh in (new, old)]
    apart = np.linalg.norm(boxes[0][:, None] - boxes[1], axis=2)
    apart[new.loop_signs[:, None] != old.loop_signs] += len(apart) * apart.max()
    partners: list[int | None] = linear_sum_assignment(apart)[1].tolist()
    return partners


def _box(points: FloatArray) -> FloatArray:
    """Lower and upper corner (2, d) of points (n, d)."""
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _into(points: FloatArray, others: FloatArray) -> FloatArray:
    """Points (k, 2), scaled into the box of others if the boxes overlap little."""
    here, there = _box(points), _box(others)
    common = np.minimum(here[1], there[1]) - np.maximum(here[0], there[0])
    if (common >= SHARED_RANGE * (np.maximum(here[1], there[1]) - np.minimum(here[0], there[0]))).all():
        return points
    extent = np.maximum(here[1] - here[0], np.finfo(float).tiny)
    scaled: FloatArray = there[0] + (points - here[0]) / extent * (there[1] - there[0])
    return scaled


def _nearest(rest: FloatArray, ends: IntArray, points: FloatArray, tangents: FloatArray) -> Along:
    """The nearest points on edges with ends (2, e), on those that run along the tangents (k, 2) where there are any."""
    start, end = rest[ends, :2]
    chosen, part = np.empty(len(points), int), np.empty(len(points))
    step = max(1, CHUNK // len(start))
    for begin in range(0, len(points), step):
        rows = slice(begin, begin + step)
        near = distance.point_edge(points[rows, None], start, end)
        facing = tangents[rows] @ (end - start).T > 0.0
        facing |= ~facing.any(axis=1, keepdims=True)
        best = np.where(facing, near.distance, np.inf).argmin(axis=1)
        chosen[rows], part[rows] = best, near.parameter[np.arange(len(best)), best]
    return Along(ends[0, chosen], ends[1, chosen], part)


@dataclass(frozen=True)
class Pose:
    """Parent and transform of an output object, what carries it by our constraint, and its transform when bound."""

    values: dict[str, Any]
    carried: tuple[Object | None, Matrix] | None
    own_parent: bool
    rest: Matrix | None
    basis: Matrix

    @classmethod
    def of(cls, obj: Object, source: Object | None) -> Pose:
        """The pose of an object of the output of `source`."""
        carried = placement.carrier_of(obj) if placement.constraint_of(obj) is not None else None
        own_parent = obj.parent is not None and obj.parent != source
        values = {name: _copied_value(getattr(obj, name)) for name in PLACEMENT}
        return cls(values, carried, own_parent, cage_sets.before(obj).matrix, obj.matrix_basis.copy())

    def give(self, obj: Object, offsets: FloatArray, *, bound: bool) -> None:
        """Applies the pose to an object that was made again; offsets (n, 3) of vertices only if it is bound again."""
        if self.own_parent:
            placement.carry(obj, *(self.carried or (None, None)))
            self._give(obj, PLACEMENT)
            if bound and self.rest is not None:
                cage_sets.set_before(obj, cage_sets.before(obj)._replace(matrix=self.rest))
        elif bound and self.rest == Matrix():
            self._give(obj, placement.TRANSFORM)
        elif bound and self.rest is not None:
            obj.matrix_basis = self.rest.inverted_safe() @ self.basis
        if bound and np.abs(offsets).max() > SMALLEST_POSE * size(points_of(mesh_of(obj))):
            move(mesh_of(obj), offsets)

    def _give(self, obj: Object, names: Iterable[str]) -> None:
        for name in names:
            if getattr(obj, name) != self.values[name]:
                setattr(obj, name, self.values[name])


def move(mesh: Mesh, offsets: FloatArray) -> None:
    """Moves the vertices of a mesh, and its shape keys with them, by offsets (n, 3)."""
    shapes: Any = mesh.shape_keys.key_blocks if mesh.shape_keys is not None else ()
    blocks: tuple[Any, ...] = (mesh.vertices, *(key.points for key in shapes))
    for block in blocks:
        block.foreach_set("co", (stored(block, "co", 3) + offsets).astype(np.float32).ravel())
    mesh.update()


@contextmanager
def unshaped(objects: Sequence[Object]) -> Iterator[None]:
    """Temporarily disables the modifiers and shape keys of objects."""
    with ExitStack() as stack:
        stack.enter_context(display.unmodified(objects))
        for obj in objects:
            if obj.data.shape_keys is not None:
                _set(stack, obj, "active_shape_key_index", 0)
                _set(stack, obj, "show_only_shape_key", True)
        yield


@contextmanager
def unmoved(objects: Iterable[Object]) -> Iterator[None]:
    """Temporarily disables the artist's constraints and the animation of objects that were just put in their places."""
    with ExitStack() as stack:
        for obj in objects:
            for constraint in (each for each in obj.constraints if each != placement.constraint_of(obj)):
                _set(stack, constraint, "mute", True)
            animation = obj.animation_data
            if animation is None:
                continue
            _set(stack, animation, "use_nla", False)
            curves = (*shape_keys.curves_of(obj), *animation.drivers)
            moving = [each for each in curves if each.data_path in placement.TRANSFORM]
            for curve in moving:
                _set(stack, curve, "mute", True)
            if moving:
                obj.matrix_basis = Matrix()  # the animation has moved it on the frame of the result
        yield


def _set(stack: ExitStack, owner: Any, name: str, value: object) -> None:
    """Sets an attribute until the stack is left."""
    before = getattr(owner, name)
    if before != value:
        setattr(owner, name, value)
        stack.callback(setattr, owner, name, before)


def _copied_value(value: Any) -> Any:
    """A copy of a value, independent of the object."""
    if isinstance(value, str | bpy.types.ID) or not hasattr(value, "__len__"):
        return value
    return value.copy() if hasattr(value, "copy") else tuple(value)
