"""Symmetric cages: which symmetry, which numbers of vertices it allows, and symmetric coarse meshes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..contact import SequentialQP
from ..decimation import Decimation, OnCurve, OuterHull, Start
from ..decimation.base import LEAST_PER_LOOP
from ..errors import NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.symmetry import Orbits, Symmetry
from ..geometry.symmetry_search import Found
from ..solver.tied import Tie
from .settings import Settings

ALIKE_TOLERANCE = 1e-6
"""Distance between vertices of a coarse mesh and the images of others, in diagonals, up to which it is symmetric."""


@dataclass(frozen=True, eq=False)
class Alike:
    """A coarse mesh with exact symmetry, and the ties of its vertices."""

    start: Start
    orbits: Orbits
    tie: Tie

    def symmetrised(self, steps: FloatArray) -> FloatArray:
        """Steps (K, m, 2) of the cage in the input's units with exact symmetry."""
        return np.stack([self.orbits.symmetrised(step) for step in steps])


def with_symmetry(settings: Settings, fine: Mesh) -> tuple[Settings, tuple[str, ...]]:
    """The settings with a symmetry that has been found, and methods that keep it; and a note about it.

    Raises NestingError for methods that cannot keep a symmetry.
    """
    symmetry = settings.symmetry
    notes: tuple[str, ...] = ()
    if symmetry is None:
        return settings, ()
    if isinstance(symmetry, Found):
        found, difference = symmetry.of(fine)
        if found is None:
            note = (
                f"No symmetry was found within {100.0 * symmetry.tolerance:.3g} % of the diagonal; the cage has none."
            )
            return replace(settings, symmetry=None), (note,)
        symmetry = found
        notes = (f"Found {found}; the drawing differs from its image by at most {difference:.3g}.",)
    contact = settings.contact
    several = [SequentialQP()] if contact is None else [contact] if isinstance(contact, SequentialQP) else contact
    if not isinstance(several, list | tuple) or not all(isinstance(each, SequentialQP) for each in several):
        raise NestingError(f"Symmetric cages need contact=SequentialQP(), not {contact!r}; leave it out.")
    return replace(
        settings,
        symmetry=symmetry,
        contact=tuple(several),
        decimation=_alike(settings.decimation, symmetry),
        fallback=None if settings.fallback is None else _alike(settings.fallback, symmetry),
    ), notes


def _alike(decimation: Decimation, symmetry: Symmetry) -> Decimation:
    if isinstance(decimation, OnCurve):
        return replace(decimation, hull=replace(decimation.hull, symmetry=symmetry))
    if isinstance(decimation, OuterHull):
        return replace(decimation, symmetry=symmetry)
    raise NestingError(f"Symmetric cages need decimation=OnCurve() or OuterHull(), not {decimation!r}.")


def possible_count(count: int, fine: Mesh, symmetry: Symmetry) -> tuple[int, tuple[str, ...]]:
    """The number of vertices closest to `count`, less if possible, that a cage around a symmetric mesh can have.

    And a note if it is another one. With a mirror, loops that cross it take any number, and pairs of loops even ones;
    with rotations every number is a multiple of their order.
    """
    orbits = orbits_of(fine, symmetry)
    if orbits is None:
        return count, ()
    image = fine.loop_of_vertex[orbits.partner[[loop[0] for loop in fine.loops]]]
    own = image == np.arange(len(image))
    step = 1 if symmetry.reverses and own.any() else symmetry.order
    own_least = LEAST_PER_LOOP if symmetry.reverses else -(-LEAST_PER_LOOP // symmetry.order) * symmetry.order
    least = int(own.sum()) * own_least + int((~own).sum()) * LEAST_PER_LOOP
    possible = max(count // step * step, least)
    if possible == count:
        return count, ()
    return possible, (f"{count} vertices were asked for; with {symmetry} the cage can have {possible}.",)


def orbits_of(mesh: Mesh, symmetry: Symmetry) -> Orbits | None:
    """The orbits of a mesh; None if it is not symmetric, vertex by vertex."""
    return Orbits.of(mesh.vertices, mesh.successor, symmetry, ALIKE_TOLERANCE * mesh.diagonal)


def made_alike(start: Start, symmetry: Symmetry, *, inside: bool = False) -> Alike:
    """A start with exact symmetry; inside: for a cage that is walked the other way round. Raises NestingError."""
    coarse = start.coarse
    orbits = orbits_of(coarse, symmetry)
    if orbits is None:
        raise NestingError(
            f"The coarse mesh does not have {symmetry}; give a mesh whose vertices are images of each other, or a "
            "vertex count."
        )
    on_curve = start.on_curve
    if on_curve is not None and orbits_of(on_curve, symmetry) is None:
        on_curve = None
    exact = coarse.moved(orbits.symmetrised(coarse.vertices)).validated()
    return Alike(
        start._replace(coarse=exact, on_curve=on_curve),
        orbits,
        Tie.of(orbits, coarse.predecessor if inside else coarse.successor),
    )
