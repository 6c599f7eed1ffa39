"""The choices of a run, each an object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..contact import IPC, Contact, SequentialQP
from ..decimation import Decimation, OuterHull
from ..energies import Area, Energy
from ..errors import NestedCagesError
from ..flow import FlowMethod, TwoSidedFlow
from ..solver import ProjectedNewton, Solver
from ..tightening import Tightening

DEFAULT_CLEARANCE = 1e-5
"""Clearance when none is given, as a fraction of the bounding-box diagonal of the fine mesh."""

IPC_FIRST = 50_000
"""Product of the vertex counts up to which IPC is tried first: there it costs as little and leaves less to tighten."""

CROWD = 10.0
"""Pairs per vertex at which it leaves them to the other one after all. Usual are 1 to 3; around cores of many needles,
where each iteration costs fifty times as much as elsewhere, 20 to 140."""

METHODS = {
    "decimation": ("decimate", "OuterHull()"),
    "fallback": ("decimate", "OuterHull()"),
    "flow": ("run", "TwoSidedFlow()"),
    "energy": ("at", "Area()"),
    "expansion_energy": ("at", "Area()"),
    "solver": ("minimise", "ProjectedNewton()"),
    "tightening": ("run", "Tightening()"),
}
"""What each choice must be able to do, and an example of it."""

OPTIONAL = ("fallback", "expansion_energy")
"""Choices that may be None."""


@dataclass(frozen=True)
class Settings:
    """How nested cages are made. Nothing here needs tuning per shape."""

    clearance: float | None = None
    """Smallest allowed distance between cage and fine mesh, in the input's units. None: 1e-5 of the fine mesh's
    bounding-box diagonal, or as much of it as the gaps of the fine mesh leave room for."""
    decimation: Decimation = field(default_factory=OuterHull)
    """How a vertex count becomes a coarse mesh."""
    starts: int = 3
    """From how many coarse meshes the cage is tightened, to keep the tightest, where the decimation offers several."""
    fallback: Decimation | None = field(default_factory=OuterHull)
    """Where to start instead when the flow does not get inside a coarse mesh or the way back is blocked; None makes
    that an error."""
    flow: FlowMethod = field(default_factory=TwoSidedFlow)
    """How the fine mesh is brought inside the coarse one."""
    energy: Energy = field(default_factory=Area)
    """What the cage minimises, on the way of the fine mesh home and once it is there."""
    expansion_energy: Energy | None = None
    """What it minimises on the way home instead, for contacts that minimise; None: the same."""
    contact: Contact | Sequence[Contact] | None = None
    """How contact is resolved on the way home; of several, each begins anew where the one before got stuck. None: IPC,
    which leaves the cage tighter, and sequential QPs, which stay fast, each backed by the other; by size."""
    solver: Solver = field(default_factory=ProjectedNewton)
    """How contacts that minimise an energy do so."""
    tightening: Tightening = field(default_factory=Tightening)
    """How the cage is brought to its optimum once the fine mesh is home."""

    def __post_init__(self) -> None:
        if self.clearance is not None and not _is_length(self.clearance):
            raise NestedCagesError(
                f"The clearance must be a finite length of at least 0, not {self.clearance!r}; leave it out for the "
                f"default."
            )
        if not isinstance(self.starts, int | np.integer) or self.starts < 1:
            raise NestedCagesError(f"The number of starts must be a whole number of at least 1, not {self.starts!r}.")
        for name, (method, example) in METHODS.items():
            chosen = getattr(self, name)
            if not _can(chosen, method) and not (chosen is None and name in OPTIONAL):
                what = name.replace("_", " ")
                raise NestedCagesError(f"The {what} must be an object such as {example}, not {chosen!r}.")
        contact: object = self.contact
        several = contact if isinstance(contact, Sequence) and not isinstance(contact, str) else [contact]
        if contact is not None and not (several and all(_can(each, "reinflate") for each in several)):
            raise NestedCagesError(
                f"The contact must be an object such as IPC(), or several of them in a list, not {contact!r}; leave it "
                "out for the default."
            )

    def contacts(self, cage_vertices: int, fine_vertices: int) -> tuple[Contact, ...]:
        """The contacts to try, in turn, for meshes of that many vertices."""
        if self.contact is None:
            small = cage_vertices * fine_vertices <= IPC_FIRST
            return (IPC(crowd=CROWD), SequentialQP()) if small else (SequentialQP(), IPC())
        return tuple(self.contact) if isinstance(self.contact, Sequence) else (self.contact,)


def _is_length(value: object) -> bool:
    """Whether a value is a finite number of at least 0."""
    try:
        return isinstance(value, int | float | np.number) and 0.0 <= float(value) < np.inf
    except OverflowError:
        return False


def _can(chosen: object, method: str) -> bool:
    """Whether something is an object, not a class, with a method of that name."""
    return not isinstance(chosen, type) and callable(getattr(chosen, method, None))
