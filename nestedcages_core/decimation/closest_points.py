"""The vertices of a cage, moved to the closest points of the mesh inside it."""

from __future__ import annotations

import numpy as np

from ..errors import InvalidMeshError
from ..geometry.broad_phase import BoxTree
from ..geometry.group import Symmetry, orbits_of
from ..geometry.mesh import Mesh


def closest_on_curve(cage: Mesh, fine: Mesh, symmetry: Symmetry | None = None) -> Mesh | None:
    """The cage with its vertices moved to the closest points of the fine mesh, loop k to loop k.

    symmetry: of the fine mesh, kept where the cage has it. None where the result crosses itself. Flow and reinflation
    lead from it to nearly the same cage.
    """
    places = np.empty_like(cage.vertices)
    for own, other in zip(cage.loops, fine.loops, strict=True):
        starts, ends = fine.vertices[other], fine.vertices[fine.successor[other]]
        places[own] = BoxTree(starts, ends).nearest(cage.vertices[own])
    if symmetry is not None:
        orbits = orbits_of(cage, symmetry)
        if orbits is not None:
            places = orbits.symmetrised(places)
    try:
        coarse = Mesh.from_loops([places[own] for own in cage.loops])
    except InvalidMeshError:
        return None
    return coarse if coarse.has_roles_of(fine) else None
