"""Placements and poses of output objects, and temporary removal of poses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from bpy.types import Mesh, Object
from mathutils import Matrix

from .. import cage_sets
from ..blender import display, shape_keys
from ..blender.mesh_data import mesh_of, points_of, stored
from ..drawing import placement
from ..drawing.plane import size
from ..errors import FloatArray
from .outline_map import Outline, outline_map
from .rig import mesh_outline, rest_points

# All properties of a placement, in the order in which they are set.
PLACEMENT = (*placement.PARENTING, *placement.TRANSFORM)
# Smaller offsets of vertices, as a fraction of the size, are rounding, not a pose.
SMALLEST_POSE = 1e-5


@dataclass(frozen=True)
class Placement:
    """Parent and transform of an object, and what carries it by our constraint, if anything."""

    values: dict[str, Any]
    carried: tuple[Object | None, Matrix] | None

    @classmethod
    def of(cls, obj: Object) -> Placement:
        carried = placement.carrier_of(obj) if placement.constraint_of(obj) is not None else None
        return cls({name: _copied_value(getattr(obj, name)) for name in PLACEMENT}, carried)

    def give(self, obj: Object, names: Iterable[str] = PLACEMENT) -> None:
        """Applies the placement to an object."""
        if "parent" in names:
            placement.carry(obj, *(self.carried or (None, None)))
        for name in names:
            if getattr(obj, name) != self.values[name]:
                setattr(obj, name, self.values[name])


@dataclass(frozen=True)
class Pose:
    """The placement of an output object; if bound, its transform then, and offsets (n, 3) of its vertices since."""

    placement: Placement
    own_parent: bool
    rest: Matrix | None
    basis: Matrix
    outline: Outline
    offsets: FloatArray

    @classmethod
    def of(cls, obj: Object, source: Object | None) -> Pose:
        """The pose of an object of the output of `source`."""
        mesh = mesh_of(obj)
        return cls(
            Placement.of(obj),
            obj.parent is not None and obj.parent != source,
            cage_sets.before(obj).matrix,
            obj.matrix_basis.copy(),
            mesh_outline(mesh),
            points_of(mesh) - rest_points(mesh),
        )

    @property
    def bends(self) -> bool:
        """Whether vertices were moved."""
        return self.rest is not None and bool(np.abs(self.offsets).max() > SMALLEST_POSE * size(self.outline.points))

    def give(self, obj: Object, *, bound: bool) -> None:
        """Applies the pose to an object that was made again; vertices only if it is bound again."""
        if self.own_parent:
            self.placement.give(obj)
            if bound and self.rest is not None:
                cage_sets.set_before(obj, cage_sets.before(obj)._replace(matrix=self.rest))
        elif bound and self.rest == Matrix():
            self.placement.give(obj, placement.TRANSFORM)
        elif bound and self.rest is not None:
            obj.matrix_basis = self.rest.inverted_safe() @ self.basis
        if bound and self.bends:
            mesh = mesh_of(obj)
            move(mesh, outline_map(self.outline, mesh_outline(mesh)).of(self.offsets))


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
