"""The plane that a drawing lies in: a frame to the world, and how far points are off it. numpy only.

A drawing is handled in the x and y of its ``Frame``. Blender stores float32, so a frame also says which numbers are
stored.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Largest distance from the plane, as a part of the drawing's size, at which points still count as lying in it. A plane
# through points that went through float32 rotations is met to some 1e-6; a drawing that is off by more than 1e-4 is
# bent on purpose.
PLANARITY = 1e-4
# The same for "flat in the object's own z", where no rotation spoils anything: a few float32 roundings.
OWN_PLANARITY = 1e-6
# Largest relative difference between the axes' lengths, and largest cosine between axes, of a scale that counts as
# uniform.
UNIFORMITY = 1e-5


@dataclass(frozen=True)
class Frame:
    """Where a drawing's plane is: ``matrix`` (4, 4) takes (x, y, height, 1) to the world.

    ``scale`` is the world length of one unit of the frame. ``own`` says that the matrix is that of the object the
    drawing came from.
    """

    matrix: Array
    height: float
    scale: float
    own: bool

    def points(self, plane_points: NDArray[np.float32] | Array) -> Array:
        """Points (n, 2) of the plane with their height, (n, 3)."""
        return np.column_stack([plane_points, np.full(len(plane_points), self.height)])

    def to_world(self, plane_points: Array) -> Array:
        """Points (n, 2) of the plane in the world, (n, 3)."""
        return transform(self.matrix, self.points(plane_points))

    def from_world(self, world_points: Array) -> tuple[Array, Array]:
        """Points (n, 3) of the world in the plane, (n, 2), and their signed world distance from it, (n,)."""
        local = transform(np.linalg.inv(self.matrix), world_points)
        return local[:, :2], (local[:, 2] - self.height) * self.scale


def transform(matrix: Array, points: Array) -> Array:
    """Points (n, 3) under an affine matrix (4, 4)."""
    moved: Array = points @ matrix[:3, :3].T + matrix[:3, 3]
    return moved


def size(points: Array) -> float:
    """Diagonal of the bounding box of points (n, d)."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def own_frame(matrix: Array, points: Array) -> Frame | None:
    """The object's own frame if its points (n, 3) are flat in z and its matrix scales uniformly without mirroring, else
    None.
    """
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


def fitted_frame(matrix: Array, points: Array) -> Frame:
    """A frame of unit scale through the world positions of an object's points (n, 3), by least squares.

    Its origin is the middle of the points. Its x and z follow the object's x and z axes, so that the drawing is not
    turned or mirrored more than needed. The points may still be off the plane: ``Frame.from_world`` tells how far.
    """
    world = transform(matrix, points)
    middle = 0.5 * (world.min(axis=0) + world.max(axis=0))
    directions = np.linalg.svd(world - world.mean(axis=0), full_matrices=False)[2]
    normal = directions[2]
    if normal @ matrix[:3, 2] < 0.0:
        normal = -normal
    along = matrix[:3, 0] - (matrix[:3, 0] @ normal) * normal
    # An x axis that stands on the plane gives no direction in it: the longest extent does.
    x_axis = along if np.linalg.norm(along) > PLANARITY * np.linalg.norm(matrix[:3, 0]) else directions[0]
    x_axis = x_axis / np.linalg.norm(x_axis)
    middle = middle - ((middle - world.mean(axis=0)) @ normal) * normal
    # Blender stores the matrix in float32: the drawing is expressed in the frame as it is stored.
    fitted = np.eye(4)
    fitted[:3, :] = np.column_stack([x_axis, np.cross(normal, x_axis), normal, middle]).astype(np.float32)
    return Frame(matrix=fitted, height=0.0, scale=1.0, own=False)
