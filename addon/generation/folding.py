"""Where a pose of a bound cage folds what is in it: triangles of its field that are turned over."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import keys
from ..core import core
from ..scene import filling
from ..scene.plane import space_to_space, transform, world_matrix

# Smallest part of the drawing's area that is called a fold.
SMALLEST = 1e-4


@dataclass(frozen=True)
class Fold:
    """What part of the area is folded, where most of it is in the world, and the bone that bends it, if any."""

    share: float
    place: tuple[float, float, float]
    bone: str

    @property
    def where(self) -> str:
        """The place as a sentence shows it."""
        return f"({', '.join(f'{number:.3g}' for number in self.place)})"


@dataclass(frozen=True, eq=False)
class Folding:
    """The field `shows` of a cage at rest, and what follows it.

    rest: vertices (N, 3); triangles: (T, 3) those that hold a part of the drawing; areas: (T,) of these.
    """

    cage: bpy.types.Object
    inner: bpy.types.Object
    shows: bpy.types.Object
    rest: NDArray[np.float64]
    triangles: NDArray[np.int64]
    areas: NDArray[np.float64]

    @classmethod
    def of(cls, cage: bpy.types.Object, inner: bpy.types.Object, shows: bpy.types.Object) -> Folding:
        """The field of a cage, and an inner object that follows it. Raises: UserError."""
        outline, data = filling.outline(inner), filling.mesh_of(shows)
        rest, corners = filling.points_of(data), filling.stored(data.polygons, "vertices", 3, np.int32)
        places = np.column_stack([outline.vertices, np.zeros(len(outline.vertices))])
        shape = outline.moved(transform(space_to_space(shows, inner), places)[:, :2])
        triangles = corners.astype(np.int64)
        triangles = triangles[core.coordinates.holding(rest[:, :2], triangles, shape)]
        return cls(cage, inner, shows, rest, triangles, _areas(rest, triangles))

    def now(self, context: bpy.types.Context) -> Fold | None:
        """What is folded on this frame."""
        data = self.shows.evaluated_get(context.evaluated_depsgraph_get()).data
        motion = data.attributes.get(keys.MOTION)
        if motion is None or len(motion.data) != len(self.rest):
            return None
        posed = self.rest + filling.stored(motion.data, "vector", 3)
        folded = core.coordinates.folded(posed[:, :2], self.triangles)
        share = float(self.areas[folded].sum() / self.areas.sum())
        if share < SMALLEST:
            return None
        worst = self.triangles[folded][self.areas[folded].argmax()]
        x, y, z = transform(world_matrix(self.shows), posed[worst].mean(axis=0)[None])[0].tolist()
        return Fold(share, (x, y, z), self._bone(worst))

    def _bone(self, triangle: NDArray[np.int64]) -> str:
        """Of the bones that move a triangle through the cage's corners, the one that bends it most; maybe none."""
        armatures = [each.object for each in self.cage.modifiers if isinstance(each, bpy.types.ArmatureModifier)]
        bends = {bone.name: _bend(bone) for each in armatures if each is not None for bone in each.pose.bones}
        names = {group.index: group.name for group in self.cage.vertex_groups if group.name in bends}
        pull = dict.fromkeys(names.values(), 0.0)
        for number, vertex in enumerate(self.cage.data.vertices):
            weights = self.shows.data.attributes.get(f"{keys.WEIGHT}{number}")
            part = sum(weights.data[int(corner)].value for corner in triangle) if weights is not None else 0.0
            for element in vertex.groups if part > 0.0 else ():
                if element.group in names:
                    pull[names[element.group]] += part * element.weight
        return max(pull, key=lambda name: pull[name] * bends[name], default="")


def _bend(bone: bpy.types.PoseBone) -> float:
    """The angle by which a bone is turned against its parent, in radians."""
    now, rest = bone.matrix, bone.bone.matrix_local
    if bone.parent is not None:
        now, rest = bone.parent.matrix.inverted_safe() @ now, bone.parent.bone.matrix_local.inverted_safe() @ rest
    return float(rest.to_quaternion().rotation_difference(now.to_quaternion()).angle)


def _areas(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """(T,) areas of triangles in the plane."""
    areas: NDArray[np.float64] = 0.5 * np.abs(np.linalg.det(np.diff(points[triangles][:, :, :2], axis=1)))
    return areas
