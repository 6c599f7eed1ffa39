"""The plane of a drawing: its frame in the world, distances of points from it, and areas in it united to one outline.

Drawings are 2D, in the x and y of their ``Frame``. Blender stores float32, so the frame also determines which numbers
are stored.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from bpy.types import Object
from numpy.typing import NDArray

from ..core import core
from ..errors import FloatArray, UserError
from .edge_loops import SMALLEST_LOOP

# Largest distance of coplanar points from the plane, as a fraction of the drawing's size. float32 rotations leave
# errors of about 1e-6; more than 1e-4 is intended.
PLANARITY = 1e-4
# The same for points flat in the object's own z, without errors from rotations: a few float32 roundings.
OWN_PLANARITY = 1e-6
# Largest relative difference between the axes' lengths, and largest cosine between axes, of a scale that counts as
# uniform.
UNIFORMITY = 1e-5
# Cosine between axes of objects that are turned alike.
ALIKE = 0.999


@dataclass(frozen=True)
class Frame:
    """The frame of a drawing's plane: ``matrix`` (4, 4) maps (x, y, height, 1) to the world.

    ``scale`` is the world length of one unit of the frame. ``own``: whether the matrix is that of the drawing's
    object.
    """

    matrix: FloatArray
    height: float
    scale: float
    own: bool

    @classmethod
    def through(cls, origin: FloatArray, x: FloatArray, y: FloatArray) -> Frame:
        """A frame of unit scale from its origin and unit axes, (3,) each, as Blender stores it: in float32."""
        matrix = np.eye(4)
        matrix[:3, :] = np.column_stack([x, y, np.cross(x, y), origin]).astype(np.float32)
        return cls(matrix=matrix, height=0.0, scale=1.0, own=False)

    def points(self, plane_points: NDArray[np.float32] | FloatArray) -> FloatArray:
        """Points (n, 2) of the plane with their height, (n, 3)."""
        return np.column_stack([plane_points, np.full(len(plane_points), self.height)])

    def to_world(self, plane_points: FloatArray) -> FloatArray:
        """Points (n, 2) of the plane in the world, (n, 3)."""
        return transform(self.matrix, self.points(plane_points))

    def from_world(self, world_points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Points (n, 3) of the world in the plane, (n, 2), and their signed world distance from it, (n,)."""
        local = transform(np.asarray(np.linalg.inv(self.matrix), np.float64), world_points)
        return local[:, :2], (local[:, 2] - self.height) * self.scale


def world_matrix(obj: Object) -> FloatArray:
    """The matrix (4, 4) from an object's space to the world. Raises: UserError if it is not finite."""
    matrix = np.array(obj.matrix_world, dtype=np.float64)
    if not np.isfinite(matrix).all():
        raise UserError(
            f"The location, rotation or scale of '{obj.name}' is not a finite number: clear it with Alt+G, Alt+R or "
            "Alt+S"
        )
    return matrix


def space_to_space(there: Object, here: Object) -> FloatArray:
    """The matrix (4, 4) from one object's space to that of another, `there`. Raises: UserError if there is none."""
    try:
        inverse = np.linalg.inv(world_matrix(there))
    except np.linalg.LinAlgError:
        inverse = np.full((4, 4), np.inf)
    if not np.isfinite(inverse).all():
        raise UserError(f"'{there.name}' is scaled to nothing along an axis: clear its scale with Alt+S")
    return inverse @ world_matrix(here)


def transform(matrix: FloatArray, points: FloatArray) -> FloatArray:
    """Points (n, 3) under an affine matrix (4, 4)."""
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def scale_of(obj: Object) -> float:
    """The world length of a unit of an object's space."""
    return float(np.linalg.norm(np.array(obj.matrix_world)[:3, :3], axis=0).mean())


def turned_as_most(frame: Frame, objects: Sequence[Object]) -> Frame:
    """A frame, turned over or upright where most objects in its plane are turned otherwise."""
    y, normal = (axis / np.linalg.norm(axis) for axis in frame.matrix.T[1:3, :3])
    axes = [np.array(obj.matrix_world)[:3, :3] for obj in objects]
    axes = [each / np.maximum(np.linalg.norm(each, axis=0), np.finfo(float).tiny) for each in axes]
    faces = np.array([each[:, 2] @ normal for each in axes])
    ups = [each[:, 1 if abs(each[:, 1] @ normal) < ALIKE else 2] for each in axes]
    over = np.sum(faces < -ALIKE) > np.sum(faces > ALIKE)
    if not over and np.sum(np.array(ups) @ y > ALIKE) > len(objects) / 2:
        return frame
    normal = -normal if over else normal
    up = np.eye(3)[2 if abs(normal[2]) < ALIKE else 1]
    y = (up - (up @ normal) * normal) / np.linalg.norm(up - (up @ normal) * normal)
    return Frame.through(frame.to_world(np.zeros((1, 2)))[0], np.cross(y, normal), y)


def middle_of_box(obj: Object) -> FloatArray:
    """The middle (3,) of an object's bounding box in the world; its origin if it has none."""
    corners = np.array([corner[:] for corner in obj.bound_box], dtype=np.float64)
    return transform(world_matrix(obj), 0.5 * (corners.min(axis=0) + corners.max(axis=0))[None])[0]


def size(points: FloatArray) -> float:
    """Diagonal of the bounding box of points (n, d)."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def own_frame(matrix: FloatArray, points: FloatArray) -> Frame | None:
    """An object's own frame if its points (n, 3) are flat in z and it scales evenly, unmirrored; else None."""
    axes = matrix[:3, :3]
    lengths = np.linalg.norm(axes, axis=0)
    if not lengths.min() > 0.0:
        return None
    cosines = (axes / lengths).T @ (axes / lengths) - np.eye(3)
    heights = points[:, 2]
    uniform = np.ptp(lengths) <= UNIFORMITY * lengths.max() and np.abs(cosines).max() <= UNIFORMITY
    if not uniform or np.linalg.det(axes) <= 0.0 or np.ptp(heights) > OWN_PLANARITY * size(points):
        return None
    height = float(np.float32(0.5 * (heights.min() + heights.max())))
    return Frame(matrix=matrix, height=height, scale=float(lengths.mean()), own=True)


def fitted_frame(matrix: FloatArray, points: FloatArray) -> Frame:
    """A frame of unit scale through the world positions of an object's points (n, 3), by least squares.

    Its origin is the centre of the points. Its x and z follow the object's x and z axes, so that the drawing is turned
    as little as possible and not mirrored; an upright one is seen from the object's front, or else from its right. The
    points may lie off the plane, see ``Frame.from_world``.
    """
    world = transform(matrix, points)
    finite = np.isfinite(world).all(axis=1)
    world[~finite] = world[finite].mean(axis=0) if finite.any() else 0.0
    middle = 0.5 * (world.min(axis=0) + world.max(axis=0))
    directions = np.linalg.svd(world - world.mean(axis=0), full_matrices=False)[2]
    normal, axes = directions[2], matrix[:3, :3]
    facing = [normal @ axis / np.linalg.norm(axis) for axis in (axes[:, 2], -axes[:, 1], axes[:, 0])]
    if next((cosine for cosine in facing if abs(cosine) > PLANARITY), 1.0) < 0.0:
        normal = -normal
    x, y = ((axis - (axis @ normal) * normal) / np.linalg.norm(axis) for axis in axes.T[:2])
    # If the x axis is perpendicular to the plane, use the y axis.
    x_axis = next((axis for axis in (x, y) if np.linalg.norm(axis) > PLANARITY), directions[0])
    x_axis = x_axis / np.linalg.norm(x_axis)
    middle = middle - ((middle - world.mean(axis=0)) @ normal) * normal
    return Frame.through(middle, x_axis, np.cross(normal, x_axis))


Loops = tuple[FloatArray, ...]

# Gaps narrower than this fraction of the size are closed if they collapse in float32: about ten roundings.
CLOSED_GAP = 1e-5


def united_loops(name: str, loops: Sequence[FloatArray], *, evenodd: bool = False) -> Loops:
    """The outline of one area given by loops (k, 2), in float32; unchanged unless they cross or touch.

    evenodd: the rule that decides what is inside, instead of non-zero winding. Raises: UserError.
    """
    try:
        core.Mesh.from_loops(loops)
    except core.NestedCagesError:
        return united(name, [core.formats.Painted(loops, evenodd)])
    return tuple(loops)


def united(name: str, areas: Sequence[core.formats.Painted], *, closed: bool = False) -> Loops:
    """The outline of the union of areas, loops (k, 2), float32 values as float64. Raises: UserError.

    closed: whether gaps of `CLOSED_GAP` are closed even if they do not collapse, wider ones if these do.
    """
    points = np.concatenate([loop for area in areas for loop in area.loops])
    extent = size(points)
    problem: core.NestedCagesError | None = None
    for gap in CLOSED_GAP * extent * np.array([1.0, 3.0, 0.0] if closed else [0.0, 1.0]):
        try:
            mesh = core.formats.solid(areas, width=float(gap))
            loops = tuple(float32_loop(mesh.vertices[loop]) for loop in mesh.loops)
            loops = tuple(loop for loop in loops if len(loop) >= SMALLEST_LOOP)  # others are slits of rounding
            core.Mesh.from_loops(loops)
        except core.NestedCagesError as error:
            problem = problem or error
        else:
            return loops
    raise UserError(f"'{name}': {problem}") from problem


def float32_loop(points: FloatArray) -> FloatArray:
    """A loop (k, 2) rounded to float32, as float64, without points that coincide then."""
    rounded = points.astype(np.float32).astype(np.float64)
    return rounded[(rounded != np.roll(rounded, 1, axis=0)).any(axis=1)]


def divided(loop: FloatArray, longest: float) -> FloatArray:
    """A loop (k, 2) whose edges are at most so long; an edge gets the same points in both directions."""
    pieces = []
    for start, end in zip(loop, np.roll(loop, -1, axis=0), strict=True):
        count = max(int(np.ceil(np.hypot(*(end - start)) / longest)), 1)
        first, last = sorted((start.tolist(), end.tolist()))
        points = np.linspace(first, last, count + 1)
        pieces.append(points[:-1] if first == start.tolist() else points[:0:-1])
    return np.concatenate(pieces)
