"""The gate of moving cages: the only place where a key of a motion is made."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from ..errors import NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..levels.certify import judge
from ..levels.plan import Plan
from ..verification import Certificate, verify_motion


class Posed(NamedTuple):
    """A pose with its cage, to be a key."""

    number: int
    time: float
    fine: FloatArray
    cage: FloatArray
    given: bool


@dataclass(frozen=True, eq=False)
class Key:
    """One certified instant; between consecutive keys fine mesh and cage move on straight lines."""

    number: int
    """Index of the given pose, or of the one before."""
    time: float
    fine: FloatArray = field(repr=False)
    """(n, 2) vertices of the fine mesh; exactly those of a given pose."""
    cage: FloatArray = field(repr=False)
    """(m, 2) vertices of the cage."""
    certificate: Certificate = field(repr=False)
    given: bool
    """Whether the key is a given pose, not one added between two of them."""


@dataclass(frozen=True, eq=False)
class MotionGate:
    """Makes the keys of one moving cage."""

    plan: Plan
    """That of the first pose."""
    topology: Mesh
    """The cage's."""
    wanted: float
    """The clearance that is promised."""

    def is_free(self, before: Posed | Key, after: Posed) -> bool:
        """Whether the straight motion from one pose to another is certified free of collisions."""
        cages, fines = np.stack([before.cage, after.cage]), np.stack([before.fine, after.fine])
        return bool(verify_motion(self.topology, self.plan.fine, cages, fines))

    def key(self, posed: Posed, before: Key | None) -> Key:
        """A key after the one before, if any. Raises NestingError."""
        number, time, fine, points, given = posed
        plan = replace(self.plan, fine=self.plan.fine.moved(fine))
        cage = judge(plan, self.topology.moved(points), self.wanted)
        if cage.fault is not None:
            raise NestingError(
                f"The cage of pose {number} could not be certified: {cage.fault}",
                code="certificate.failed",
                problems=cage.certificate.problems or (cage.fault,),
                pose=number,
            )
        if before is not None and not self.is_free(before, posed):
            raise NestingError(
                f"The motion from pose {before.number} to the next could not be certified free of collisions.",
                code="motion.collides",
                pose=before.number,
            )
        return Key(number, time, fine, points, cage.certificate, given)
