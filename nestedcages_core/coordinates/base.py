"""Interface and use of cage coordinates: a matrix W with W @ cage = points."""

from __future__ import annotations

from typing import Protocol, TypeAlias

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .harmonic import Harmonic

Weights: TypeAlias = "FloatArray | scipy.sparse.csr_array"
"""(P, m) matrix of coordinates: rows sum to 1, W @ cage.vertices = points."""


class CageCoordinates(Protocol):
    """Weights that write points as combinations of cage vertices."""

    def weights(self, points: FloatArray, cage: Mesh) -> Weights:
        """W (P, m) for (P, 2) points and a cage of m vertices: rows sum to 1, W @ cage.vertices = points."""


def cage_coordinates(fine: Mesh | ArrayLike, cage: Mesh, coordinates: CageCoordinates | None = None) -> Weights:
    """Weights that move a shape with its cage: ``deform(weights, posed)`` follows the cage's vertices.

    Parameters
    ----------
    fine : Mesh or (n, 2) array_like
        The shape, or points inside the cage, in the cage's unit.
    cage : Mesh
        A cage of m vertices.
    coordinates : CageCoordinates, optional
        Default: `Harmonic`.

    Returns
    -------
    (n, m) array or sparse array
        Rows sum to 1, and W @ cage.vertices gives the points, so every affine motion of the cage moves them alike.

    Raises
    ------
    NestedCagesError
        For points that are not finite, and for points outside the cage if the coordinates need them inside.

    Examples
    --------
    >>> from nestedcages_core import Mesh, cage_coordinates, deform
    >>> cage = Mesh.from_loops([[(0, 0), (4, 0), (4, 4), (0, 4)]])
    >>> weights = cage_coordinates([(1.0, 2.0)], cage)
    >>> deform(weights, cage.vertices + (10, 0)).round(6)
    array([[11.,  2.]])
    """
    points = fine.vertices if isinstance(fine, Mesh) else np.asarray(fine, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise NestedCagesError(
            f"The points have shape {points.shape}, but (n, 2) finite numbers are needed.", code="mesh.unreadable"
        )
    return (coordinates if coordinates is not None else Harmonic()).weights(points, cage.validated())


def deform(weights: Weights, posed_cage: Mesh | ArrayLike) -> FloatArray:
    """The points under a pose of the cage: W @ posed_cage.

    Parameters
    ----------
    weights : (n, m) array or sparse array
        From `cage_coordinates`.
    posed_cage : Mesh or (..., m, d) array_like
        Positions of the cage's vertices in their order, of one pose or several. A posed cage may cross itself.

    Returns
    -------
    (..., n, d) array
        Positions of the points, for each pose.

    Raises
    ------
    NestedCagesError
        For another number of vertices.
    """
    given = posed_cage.vertices if isinstance(posed_cage, Mesh) else posed_cage
    posed = np.asarray(given, dtype=np.float64)
    count = weights.shape[1]
    if posed.ndim < 2 or posed.shape[-2] != count:
        raise NestedCagesError(
            f"The posed cage has shape {posed.shape}, but the coordinates belong to a cage of {count} vertices; give "
            f"({count}, 2) positions, one per vertex in the cage's order.",
            code="mesh.unreadable",
        )
    if posed.ndim == 2 or isinstance(weights, np.ndarray):
        return np.asarray(weights @ posed)
    poses = posed.reshape(-1, *posed.shape[-2:])
    moved = np.stack([weights @ pose for pose in poses]) if len(poses) else np.zeros((0, len(posed), posed.shape[-1]))
    return moved.reshape(*posed.shape[:-2], *moved.shape[-2:])
