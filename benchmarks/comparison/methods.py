"""The methods that are compared, each a Settings object. A method that is not listed here is not in the comparison."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

from li_2020 import OriginalIPC
from nestedcages_core import (
    AUGMENTED_2022,
    AUGMENTED_2022_REPAIRED,
    IPC,
    ArcLength,
    Area,
    BoundaryARAP,
    EvenSamples,
    GradientDescent,
    InitialDisplacement,
    InteriorARAP,
    NoEnergy,
    OnCurve,
    PaperContact,
    PaperFlow,
    ProjectedNewton,
    QuadraticFallOff,
    RandomSamples,
    Repairs,
    SequentialQP,
    Settings,
    ShapeKeeping,
    SignedDistanceFlow,
    SmallestDistance,
    StepDisplacement,
    Tightening,
    TimeOfImpact,
    TwoSidedFlow,
    UniformGrid,
)
from nestedcages_core.decimation import Decimation
from nestedcages_core.energies import Energy
from nestedcages_core.flow import FlowMethod
from published import NESTED_CAGES_2015, SIMPLE_2022, EdgeCollapse, ElTopo, SachtFlow

STARTS: dict[str, Decimation] = {"edge collapse": EdgeCollapse(), "arc length": ArcLength(), "line cycles": OnCurve()}
"""Coarse meshes that methods start from: that of 2015, evenly spaced vertices, and ours put on the curve."""

PUBLISHED = replace(AUGMENTED_2022, flow=PaperFlow(), contact=PaperContact())
"""Gurditta & Jacobson (2022) as written, with lengths relative to the drawing as on the discs of its Table 1."""

REPAIRED_CONTACT = PaperContact(
    solver=GradientDescent(refuse_infinite=True), repairs=Repairs(parity=True, exact_home=True)
)
BY_NEWTON = replace(
    REPAIRED_CONTACT, step_filter=TimeOfImpact(), broad_phase=UniformGrid(), solver=ProjectedNewton()
)  # fmt: skip
"""The energy of 2022 by projected Newton, its further work."""
DESCENT = replace(AUGMENTED_2022_REPAIRED, flow=PaperFlow(exact_parity=True), contact=REPAIRED_CONTACT)
SMALL_RANGE, LARGE_RANGE = 1e-3, PaperContact().d_hat
"""d̂ in diagonals: the default of IPC (2020), and that of 2022."""


def newton(d_hat: float) -> Settings:
    """The method of 2022 by projected Newton, with a range."""
    return replace(DESCENT, contact=replace(BY_NEWTON, d_hat=d_hat))


ORIGINAL = "Nested Cages 2015"
WRITTEN, REPAIRED = "2022 as written", "2022 repaired"
NEWTON, NEWTON_SMALL = "2022 by Newton", f"2022 by Newton, d̂ = {SMALL_RANGE:g}"
SIMPLE, OURS, DEFAULT = "simple cages 2022", "ours", "nested_cages"

TIGHT = Settings(fallback=None, flow=TwoSidedFlow(), contact=IPC(), tightening=Tightening())
"""Ours with IPC, from one coarse mesh and without a fallback."""

WHOLE: dict[str, Settings] = {
    ORIGINAL: NESTED_CAGES_2015,
    NEWTON: newton(LARGE_RANGE),
    NEWTON_SMALL: newton(SMALL_RANGE),
    OURS: TIGHT,
}
"""Whole methods from one coarse mesh; `nested_cages` without settings comes on top."""

DESCENDING: dict[str, Settings] = {REPAIRED: DESCENT}
"""By gradient descent, which takes as long as all others together: from the start of 2015 alone."""
ON_FIGURES: dict[str, Settings] = {SIMPLE: SIMPLE_2022, WRITTEN: PUBLISHED}
"""On our drawings of the figures alone: one with its own coarse mesh, one that never returns exactly."""

LADDER: dict[str, Settings] = {
    "2022 as written": PUBLISHED,
    "+ exact parity": (PARITY := replace(
        PUBLISHED, flow=PaperFlow(exact_parity=True), contact=PaperContact(repairs=Repairs(parity=True))
    )),
    "+ infinite energies rejected": (FINITE := replace(
        PARITY, contact=PaperContact(solver=GradientDescent(refuse_infinite=True), repairs=Repairs(parity=True))
    )),
    "+ exact return": (HOME := replace(FINITE, contact=REPAIRED_CONTACT)),
    "+ smallest distance bounds the step": replace(
        HOME, contact=replace(REPAIRED_CONTACT, step_filter=SmallestDistance())
    ),
    "+ time of impact instead": replace(HOME, contact=replace(REPAIRED_CONTACT, step_filter=TimeOfImpact())),
    "+ projected Newton, pairs by cells": (BY := replace(HOME, contact=BY_NEWTON)),
    "+ local ranges, weights per length: IPC": (LOCAL := replace(BY, contact=IPC())),
    "+ two-sided flow": (TWO_SIDED := replace(LOCAL, flow=TwoSidedFlow())),
    "+ tightening: ours": replace(TWO_SIDED, tightening=Tightening()),
}  # fmt: skip
"""The paper turned into ours, one change at a time; every line keeps those above it."""


class Alone(NamedTuple):
    """A contact by itself, with area descent if it has an energy."""

    contact: Any
    is_descent: bool = True


IPC_2020, ENERGY_2022 = "IPC 2020", "energy of 2022"
RANGES = (SMALL_RANGE, 1e-2, LARGE_RANGE)
"""d̂ in diagonals at which both barriers are tried."""


def at(name: str, d_hat: float) -> str:
    """Name of a barrier at a range."""
    return f"{name}, {d_hat:.2g}"


AT_RANGES: dict[str, Alone] = {
    at(name, d_hat): Alone(replace(contact, d_hat=d_hat))
    for name, contact in ((IPC_2020, OriginalIPC()), (ENERGY_2022, BY_NEWTON))
    for d_hat in RANGES
}
CELLS: dict[str, Alone] = {
    "IPC, ours": Alone(IPC()),
    "sequential QP": Alone(SequentialQP(), is_descent=False),
    "El Topo": Alone(ElTopo(energy=Area(), final_energy=NoEnergy())),
    **AT_RANGES,
}
"""All contacts of the factorial."""
CONTACTS = ("IPC, ours", "sequential QP", "El Topo", at(IPC_2020, SMALL_RANGE), at(ENERGY_2022, LARGE_RANGE))
"""Those with their own ranges."""

FLOWS: dict[str, FlowMethod] = {
    "the program's": PaperFlow(exact_parity=True),
    "Algorithm 2": PaperFlow(exact_parity=True, over_length=False),
    "fall-off by length": SignedDistanceFlow(quadrature=QuadraticFallOff()),
    "even samples": SignedDistanceFlow(quadrature=EvenSamples()),
    "new samples each step": SignedDistanceFlow(quadrature=RandomSamples()),
    "2015": SachtFlow(),
    "two-sided": TwoSidedFlow(),
}

ENERGIES: dict[str, Energy] = {
    "none": NoEnergy(),
    "step displacement": StepDisplacement(),
    "initial displacement": InitialDisplacement(),
    "area": Area(),
    "boundary ARAP": BoundaryARAP(),
    "interior ARAP": InteriorARAP(),
    "shape keeping": ShapeKeeping(),
}


def alone(contact: Any) -> Settings:
    """A contact without the tightening."""
    return replace(TIGHT, contact=contact, tightening=Tightening(iterations=0))


def with_energy(name: str) -> Settings:
    """Ours, with another energy during reinflation and in the tightening."""
    return replace(TIGHT, contact=IPC(energy=ENERGIES[name]), energy=ENERGIES[name])
