"""The methods that are compared, each a Settings object. A method that is not listed here is not in the comparison."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

from li_2020 import OriginalIPC
from nestedcages_core import (
    AUGMENTED_2022_REPAIRED,
    IPC,
    Area,
    BoundaryARAP,
    EvenSamples,
    GradientDescent,
    InitialDisplacement,
    InteriorARAP,
    NoEnergy,
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
from nestedcages_core.energies import Energy
from nestedcages_core.flow import FlowMethod
from published import NESTED_CAGES_2015, SIMPLE_2022, ElTopo, SachtFlow

PUBLISHED = replace(AUGMENTED_2022_REPAIRED, flow=PaperFlow(), contact=PaperContact())
"""Gurditta & Jacobson (2022) as written, on a shape of the size of its Table 1."""

REPAIRED_CONTACT = PaperContact(
    solver=GradientDescent(refuse_infinite=True), repairs=Repairs(parity=True, exact_home=True)
)
BY_NEWTON = replace(
    REPAIRED_CONTACT, step_filter=TimeOfImpact(), broad_phase=UniformGrid(), solver=ProjectedNewton()
)  # fmt: skip
"""The energy of 2022 by projected Newton, its further work."""

ORIGINAL = "Nested Cages 2015"
WRITTEN, REPAIRED, NEWTON = "2022 as written", "2022 repaired", "2022 by Newton"
SIMPLE, OURS, DEFAULT = "simple cages 2022", "ours", "nested_cages"

TIGHT = Settings(fallback=None, flow=TwoSidedFlow(), contact=IPC(), tightening=Tightening())
"""Ours with IPC, from one coarse mesh and without a fallback."""

WHOLE: dict[str, Settings] = {
    SIMPLE: SIMPLE_2022,
    ORIGINAL: NESTED_CAGES_2015,
    WRITTEN: PUBLISHED,
    REPAIRED: AUGMENTED_2022_REPAIRED,
    NEWTON: replace(AUGMENTED_2022_REPAIRED, contact=BY_NEWTON),
    OURS: TIGHT,
}
"""Whole methods; `nested_cages` without settings comes on top."""

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
CONTACTS: dict[str, Alone] = {
    "IPC, ours": Alone(IPC()),
    "sequential QP": Alone(SequentialQP(), is_descent=False),
    "El Topo": Alone(ElTopo(energy=Area(), final_energy=NoEnergy())),
    IPC_2020: Alone(OriginalIPC()),
    ENERGY_2022: Alone(BY_NEWTON),
}
"""Contacts with their own defaults."""

RANGES = (1e-3, 3.5e-3, 1e-2, 3.5e-2)
"""d̂ in diagonals at which both barriers are tried: from the default of 2020 to that of 2022."""
AT_RANGES: dict[str, Alone] = {
    f"{name}, {d_hat:g}": Alone(replace(CONTACTS[name].contact, d_hat=d_hat))
    for name in (IPC_2020, ENERGY_2022)
    for d_hat in RANGES
}

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
