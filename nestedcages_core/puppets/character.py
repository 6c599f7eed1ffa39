"""A drawing that bones move through its cage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..coordinates import CageCoordinates, cage_coordinates
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.triangulation import triangulate
from .field.bone_weights import bone_weights, skinned
from .skeleton.bone import Bone, by_number


@dataclass(frozen=True, eq=False)
class Character:
    """What a game engine needs to pose a drawing."""

    shape: Mesh
    """The drawing at rest."""
    cage: Mesh
    """Its cage at rest."""
    bones: tuple[Bone, ...]
    bone_weights: FloatArray = field(repr=False)
    """(m, B) how much each bone moves each vertex of the cage; rows of sum 1."""
    cage_weights: FloatArray = field(repr=False)
    """(n, m) how much each vertex of the cage moves each vertex of the drawing; rows of sum 1."""
    triangles: IntArray = field(repr=False)
    """(T, 3) vertices of the drawing, counter-clockwise; they fill it."""

    @classmethod
    def of(
        cls, shape: Mesh, cage: Mesh, bones: Sequence[Bone], coordinates: CageCoordinates | None = None
    ) -> Character:
        """Weights for a drawing inside a cage. Raises NestedCagesError as `bone_weights` and `cage_coordinates`."""
        weights = cage_coordinates(shape, cage, coordinates)
        dense = weights if isinstance(weights, np.ndarray) else weights.toarray()
        return cls(shape, cage, tuple(bones), bone_weights(cage, bones), dense, triangulate(shape).triangles)

    def posed(self, turned: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
        """Vertices of the drawing (n, 2) and of the cage (m, 2) with bones turned by degrees relative to their parents.

        Raises NestedCagesError for the name of no bone.
        """
        cage = skinned(self.cage.vertices, self.bone_weights, self.bones, by_number(self.bones, turned))
        return self.cage_weights @ cage, cage
