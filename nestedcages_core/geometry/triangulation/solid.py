"""The triangulation of a mesh."""

from __future__ import annotations

from ..mesh import Mesh
from .constrained import constrained_delaunay
from .sampling import Sampling, sample
from .triangulation import Triangulation


def triangulate(mesh: Mesh, sampling: Sampling | None = None) -> Triangulation:
    """The constrained Delaunay triangulation of the solid that a mesh bounds, holes left open.

    Its first vertices are those of the mesh, in their order; without a sampling there are no others. Raises
    InvalidMeshError if the loops are not valid, as may happen for a mesh made by `moved`.
    """
    samples = sample(mesh.validated(), sampling)
    triangles = constrained_delaunay(samples.points, samples.segments)
    return Triangulation(samples.points, triangles, samples.edge, mesh.successor[samples.edge], samples.parameter)
