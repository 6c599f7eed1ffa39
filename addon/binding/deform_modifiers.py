"""One mesh follows one cage by a modifier of Blender's own, chosen by measured errors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Final

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import keys
from ..errors import UserError
from ..scene import display, filling, placement
from ..scene.plane import size, space_to_space, transform
from . import node_groups, weights

SURFACE: Final = "SURFACE_DEFORM"
PRISM: Final = "MESH_DEFORM"
SURFACE_MODIFIER, PRISM_MODIFIER = "Nested Cages Surface Deform", "Nested Cages Mesh Deform"
OURS = (node_groups.REMEMBER, node_groups.COORDINATES, SURFACE_MODIFIER, PRISM_MODIFIER, node_groups.ADD_EDITS)
# Names of the methods, in the order in which they are tried.
NAMES = {
    weights.HARMONIC: "Harmonic Coordinates",
    weights.LINEAR: "Linear Coordinates",
    SURFACE: "Surface Deform",
    PRISM: "Mesh Deform",
}
AUTOMATIC = (weights.HARMONIC, SURFACE, PRISM)

# Largest error of a vertex, as a fraction of the size, that counts as following: at rest some roundings of float32;
# under affine poses the measured error of Mesh Deform's grid, with a margin.
REST_ERROR, AFFINE_ERROR = 1e-5, 0.1
# Affine error up to which no other method is tried.
EXACT = 1e-4
# Blender's measure of how fine the grid of Mesh Deform is: its cells are 1/2^precision of the prism's size. Each step
# takes eight times as long; 5 is Blender's own default.
PRECISION = 5
# The affine poses for measurements: a quarter turn, a stretch, and a shear with shrinking.
POSES = (((0.0, -1.0), (1.0, 0.0)), ((2.0, 0.0), (0.0, 1.0)), ((0.8, 0.5), (-0.2, 0.7)))

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Link:
    """Follower, cage and modifier of a link, and its measured errors as fractions of the size."""

    inner: str
    cage: str
    method: str
    rest: float
    affine: float


def link(context: bpy.types.Context, inner: bpy.types.Object, cage: bpy.types.Object, method: str) -> Link:
    """Makes `inner` follow `cage`, a filled mesh, by `method`, or by the best one if "AUTO". Raises: UserError."""
    wanted: Sequence[str] = (method,)
    if method == "AUTO":
        wanted = AUTOMATIC if weights.fits(inner, cage) else AUTOMATIC[1:]
    found: list[Link] = []
    for kind in wanted:
        try:
            tried = _try(context, inner, cage, kind)
        except UserError:
            if method != "AUTO":
                raise
            tried = None
        if tried is not None and tried.rest <= REST_ERROR and tried.affine <= AFFINE_ERROR:
            found.append(tried)
            if tried.affine <= EXACT:
                break
        if kind != wanted[-1]:
            release(inner)
    if not found:
        release(inner)
        raise UserError(
            f"'{inner.name}' cannot follow '{cage.name}': no modifier of Blender keeps it within {REST_ERROR:g} of its "
            "size at rest; move vertices of the cage that lie nearly on one line or on each other, and try again"
        )
    best = min(found, key=lambda tried: tried.affine)
    if best is not tried:
        release(inner)
        attach(context, inner, cage, best.method)
    return best


def attach(context: bpy.types.Context, inner: bpy.types.Object, cage: bpy.types.Object, method: str) -> bool:
    """Adds the modifiers, before all others, and binds them; returns whether Blender succeeded."""
    mesh = filling.mesh_of(inner)
    filling.add_attribute(mesh, keys.REST, "FLOAT_VECTOR", filling.points_of(mesh).astype(np.float32))
    modifier = bind_modifier(context, inner, cage, method)
    node_groups.add(inner, node_groups.REMEMBER)
    ours = [node_groups.REMEMBER, modifier.name]
    if method not in weights.KINDS:  # these place edits themselves
        ours.append(node_groups.add(inner, node_groups.ADD_EDITS).name)
    for place, name in enumerate(ours):
        inner.modifiers.move(inner.modifiers.find(name), place)
    bound = is_bound(modifier)
    if bound:
        # The modifier's error at rest, for instance in thin triangles, does not count as an edit.
        filling.add_attribute(mesh, keys.REST, "FLOAT_VECTOR", evaluated_points(context, inner).astype(np.float32))
        mesh.update()
    return bound


def target_of(modifier: bpy.types.Modifier) -> bpy.types.Object | None:
    """The object that a deforming modifier follows."""
    if isinstance(modifier, bpy.types.MeshDeformModifier):
        return modifier.object
    if isinstance(modifier, bpy.types.NodesModifier) and modifier.node_group in node_groups.following():
        found: bpy.types.Object | None = display.get_input(modifier, "Object")
        return found
    return modifier.target if isinstance(modifier, bpy.types.SurfaceDeformModifier) else None


def is_bound(modifier: bpy.types.Modifier) -> bool:
    """Whether a modifier is bound; node groups always are."""
    return bool(getattr(modifier, "is_bound", True))


def bind_modifier(
    context: bpy.types.Context,
    obj: bpy.types.Object,
    cage: bpy.types.Object,
    method: str,
    half_height: float = 0.0,
    *,
    in_place: bool = False,
) -> bpy.types.Modifier:
    """Adds and binds the modifier alone; `half_height`: largest distance of the object from its plane; `in_place`: let
    copies of the object elsewhere follow too, where Blender supports it.
    """
    if method in weights.KINDS:
        points = evaluated_points(context, obj)
        return weights.add(obj, cage, points, method, surface_of(obj, cage) if in_place else None)
    if method == SURFACE:
        surface = obj.modifiers.new(SURFACE_MODIFIER, SURFACE)
        assert isinstance(surface, bpy.types.SurfaceDeformModifier)
        surface.target = surface_of(obj, cage)
        modifier: bpy.types.Modifier = surface
        operator = bpy.ops.object.surfacedeform_bind
    else:
        prism = obj.modifiers.new(PRISM_MODIFIER, PRISM)
        assert isinstance(prism, bpy.types.MeshDeformModifier)
        prism.object = prism_of(obj, cage, half_height)
        prism.precision = PRECISION
        modifier = prism
        operator = bpy.ops.object.meshdeform_bind
    context.view_layer.update()
    # After Blender's errors about faces and edges the modifier stays unbound.
    with context.temp_override(object=obj, active_object=obj), suppress(RuntimeError):
        operator(modifier=modifier.name)
    return modifier


def surface_of(follower: bpy.types.Object, cage: bpy.types.Object) -> bpy.types.Object:
    """The hidden object that shows a follower's cage in the follower's own space, made if there is none.

    Surface Deform ignores its target's transform; through this object, moving the cage as an object works too.
    """
    found = next((child for child in follower.children if child.get(keys.SURFACE_OF) == cage), None)
    return found or _helper(f"{cage.name} Surface", cage, follower, node_groups.WHOLE, {keys.SURFACE_OF: cage})


def prism_of(follower: bpy.types.Object, cage: bpy.types.Object, half_height: float = 0.0) -> bpy.types.Object:
    """The hidden prism over a follower's cage, which moves with the cage, made if there is none high enough."""
    high = max(filling.HALF_HEIGHT * size(filling.points_of(filling.mesh_of(cage))), half_height)
    for child in follower.children:
        if child.get(keys.PRISM_OF) == cage and child[keys.PRISM_HEIGHT] >= high:
            return child
    name = f"{cage.name} Prism"
    data = filling.prism(name, filling.points_of(filling.mesh_of(cage)), filling.outline(cage), high)
    properties = {keys.PRISM_OF: cage, keys.PRISM_HEIGHT: high}
    return _helper(name, cage, follower, node_groups.WALLS, properties, data)


def _helper(
    name: str,
    cage: bpy.types.Object,
    parent: bpy.types.Object,
    shows: str,
    properties: dict[str, object],
    data: bpy.types.Mesh | None = None,
) -> bpy.types.Object:
    """A new hidden object at its parent's place that shows the cage through a node group."""
    helper = bpy.data.objects.new(name, data or bpy.data.meshes.new(name))
    helper[keys.HELPER] = True
    for key, value in properties.items():
        helper[key] = value
    placement.carry(helper, parent)
    helper.display_type = "WIRE"
    helper.hide_viewport = helper.hide_render = helper.hide_select = True
    for collection in cage.users_collection:
        collection.objects.link(helper)
    node_groups.add(helper, shows, Object=cage)
    return helper


def release(inner: bpy.types.Object) -> None:
    """Removes the modifiers, which shows the stored mesh."""
    for name in OURS:
        modifier = inner.modifiers.get(name)
        if modifier is not None:
            display.remove_modifier(inner, modifier)
    weights.clear(inner)


def _try(context: bpy.types.Context, inner: bpy.types.Object, cage: bpy.types.Object, method: str) -> Link | None:
    if not attach(context, inner, cage, method):
        return None
    rest, affine = measure(context, inner, cage)
    return Link(inner.name, cage.name, method, rest, affine)


def measure(context: bpy.types.Context, inner: bpy.types.Object, cage: bpy.types.Object) -> tuple[float, float]:
    """Largest errors of the vertices as fractions of the size: at rest, and when `POSES` move the cage."""
    points = filling.points_of(filling.mesh_of(inner))
    extent = size(points)
    rest = float(np.abs(evaluated_points(context, inner) - points).max()) / extent
    there = space_to_space(cage, inner)
    back = np.linalg.inv(there)
    corners = filling.points_of(filling.mesh_of(cage))
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    affine = 0.0
    for pose in POSES:
        matrix = np.eye(4)
        matrix[:2, :2] = pose
        matrix[:3, 3] = middle - matrix[:3, :3] @ middle
        with _moved(cage, transform(matrix, corners), corners):
            expected = transform(back @ matrix @ there, points)
            affine = max(affine, float(np.abs(evaluated_points(context, inner) - expected).max()) / extent)
    context.view_layer.update()
    return rest, affine


def evaluated_points(context: bpy.types.Context, obj: bpy.types.Object) -> Matrix:
    """Vertices (n, 3) of a mesh object as it is evaluated now, in its own space."""
    return filling.points_of(filling.mesh_of(obj.evaluated_get(context.evaluated_depsgraph_get())))


@contextmanager
def _moved(obj: bpy.types.Object, points: Matrix, back: Matrix) -> Iterator[None]:
    """Temporarily moves the vertices of a mesh object."""
    shapes = obj.data.shape_keys

    def put(place: Matrix) -> None:
        for block in (obj.data.vertices, *((shapes.reference_key.points,) if shapes is not None else ())):
            block.foreach_set("co", place.astype(np.float32).ravel())
        obj.data.update()

    put(points)
    try:
        yield
    finally:
        put(back)
