"""Simple cages from level sets of the signed distance (Sellán et al. 2022) in the plane."""

from .level_set import LevelSet

__all__ = [
    "LevelSet",  # a decimated level set, at the smallest offset that encloses the mesh
]
