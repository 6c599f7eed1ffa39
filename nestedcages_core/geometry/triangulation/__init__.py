"""Triangles inside a mesh: constrained Delaunay, with points added where a computation wants them."""

from .constrained import constrained_delaunay
from .solid import Sampling, sample, triangulate
from .triangulation import Triangulation

__all__ = [
    "Sampling",
    "Triangulation",
    "constrained_delaunay",
    "sample",
    "triangulate",
]
