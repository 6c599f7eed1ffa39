"""Results of a motion: levels with their keys, and reports."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..errors import Fault
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.drawable import Drawable
from ..geometry.mesh import Mesh
from ..verification import Certificate

FRAMES_SHOWN = 4
"""Maximum number of poses in the picture of moving cages."""


@dataclass(frozen=True, eq=False)
class MotionReport:
    """What was certified, key by key."""

    certificates: tuple[Certificate, ...]
    """(K,) one per key; the motion between keys is certified as well."""
    given: IntArray
    """(T,) indices of the keys that are given poses."""
    wanted_clearance: float
    """Unit: the input's."""
    seconds: float
    """Wall-clock seconds."""
    notes: tuple[Fault, ...] = ()
    """Sentences about deviations from the request."""

    @property
    def excess(self) -> FloatArray:
        """(T,) area(cage) / area(fine) - 1 of the given poses."""
        return np.array([self.certificates[k].excess for k in self.given])

    @property
    def clearance(self) -> FloatArray:
        """(T,) measured distance between cage and fine mesh at the given poses."""
        return np.array([self.certificates[k].clearance for k in self.given])

    @property
    def keys_added(self) -> int:
        """Number of keys between the given poses."""
        return len(self.certificates) - len(self.given)

    def __str__(self) -> str:
        excess = 100.0 * self.excess
        summary = (
            f"{len(self.given)} poses certified, {self.keys_added} keys added, excess {np.median(excess):.2f} % in the "
            f"median and {excess.max():.2f} % at most, clearance {self.clearance.min():.3g} "
            f"(wanted {self.wanted_clearance:.3g}), {self.seconds:.2f} s"
        )
        return "\n".join([summary, *self.notes])


@dataclass(frozen=True, eq=False)
class MovingLevel:
    """One cage that moves."""

    cage: Mesh
    """Topology, and the vertices at the first pose."""
    times: FloatArray
    """(K,) increasing: all given times, and those of the keys added between them."""
    fine_steps: FloatArray = field(repr=False)
    """(K, n, 2) the enclosed mesh: exactly the given poses at their times, or the cage of the level before."""
    cage_steps: FloatArray = field(repr=False)
    """(K, m, 2)."""
    report: MotionReport = field(repr=False)


@dataclass(frozen=True, eq=False)
class MovingCages(Drawable):
    """Cages of a moving drawing: level k encloses level k - 1 at every instant, and all enclose the drawing."""

    fine: Mesh
    levels: tuple[MovingLevel, ...]

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """Drawing and cages at the first pose."""
        return self._at(0)

    @property
    def frames(self) -> tuple[tuple[Mesh, ...], ...]:
        """Drawing and cages at a few of the given poses."""
        count = len(self.levels[0].report.given) if self.levels else 1
        return tuple(self._at(k) for k in np.unique(np.linspace(0, count - 1, FRAMES_SHOWN).astype(int)))

    def _at(self, pose: int) -> tuple[Mesh, ...]:
        """Drawing and cages at a given pose."""
        if not self.levels:
            return (self.fine,)
        keys = [level.report.given[pose] for level in self.levels]
        cages = [level.cage.moved(level.cage_steps[key]) for level, key in zip(self.levels, keys, strict=True)]
        return self.fine.moved(self.levels[0].fine_steps[keys[0]]), *cages
