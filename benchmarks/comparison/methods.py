"""The methods that are compared, each a Settings object. A method that is not listed here is not in the comparison."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from nestedcages_core import (
    IPC,
    ArcLength,
    Area,
    BoundaryARAP,
    DouglasPeucker,
    EdgeCollapse,
    ElTopo,
    EvenSamples,
    GaussLegendre,
    GradientDescent,
    InitialDisplacement,
    InteriorARAP,
    LevelSet,
    Midpoint,
    NoEnergy,
    NoFilter,
    OnCurve,
    OriginalIPC,
    OuterHull,
    OwnDecimation,
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
    VelocityFilter,
    Visvalingam,
)
from nestedcages_core.contact import AllPairs, Contact
from nestedcages_core.decimation import Decimation
from nestedcages_core.energies import Energy
from nestedcages_core.flow import FlowMethod
from nestedcages_core.published.settings import (
    AUGMENTED_2022,
    AUGMENTED_2022_REPAIRED,
    NESTED_CAGES_2015,
)


class Method(NamedTuple):
    """A method and what distinguishes it."""

    name: str
    settings: Settings


PAPER = AUGMENTED_2022
"""Gurditta & Jacobson (2022) as written."""

ONE_PROGRAM = replace(NESTED_CAGES_2015, contact=VelocityFilter())
"""Sacht et al. (2015) with one quadratic program in place of El Topo, and the area lowered at every step."""

EXACT_FLOW = PaperFlow(exact_parity=True)
EXACT_PARITY = PaperContact(repairs=Repairs(parity=True))
FINITE_STEPS = replace(EXACT_PARITY, solver=GradientDescent(steps=100, refuse_infinite=True))
REPAIRED = replace(FINITE_STEPS, repairs=Repairs(parity=True, exact_home=True))
BY_NEWTON = replace(REPAIRED, step_filter=TimeOfImpact(), broad_phase=UniformGrid(), solver=ProjectedNewton())

PARITY = replace(PAPER, flow=EXACT_FLOW, contact=EXACT_PARITY)
FINITE = replace(PARITY, contact=FINITE_STEPS)
HOME = replace(FINITE, contact=REPAIRED)
BOUND = replace(HOME, contact=replace(REPAIRED, step_filter=SmallestDistance()))
IMPACT = replace(HOME, contact=replace(REPAIRED, step_filter=TimeOfImpact()))
NEAR = replace(HOME, contact=replace(REPAIRED, step_filter=TimeOfImpact(), broad_phase=UniformGrid()))
NEWTON = replace(NEAR, contact=BY_NEWTON)
LOCAL = replace(NEWTON, contact=IPC())
TWO_SIDED = replace(LOCAL, flow=TwoSidedFlow())
TIGHT = replace(TWO_SIDED, tightening=Tightening())

PUBLISHED = {
    "Nested Cages 2015": NESTED_CAGES_2015,
    "2015 by programs": ONE_PROGRAM,
    "paper as written": PAPER,
    "paper repaired": AUGMENTED_2022_REPAIRED,
}
"""Methods that take a coarse mesh, as they were published, and the paper with its three repairs."""
LEVEL_SETS = "Simple Nested Cages"
"""The name of the published method that makes its own."""

LADDER = (
    Method("paper as written", PAPER),
    Method("+ exact parity", PARITY),
    Method("+ infinite energies refused", FINITE),
    Method("+ exact return", HOME),
    Method("+ smallest distance bounds the step", BOUND),
    Method("+ time of impact bounds it instead", IMPACT),
    Method("+ pairs found by cells", NEAR),
    Method("+ projected Newton", NEWTON),
    Method("+ local ranges, weights per length: IPC", LOCAL),
    Method("+ two-sided flow", TWO_SIDED),
    Method("+ tightening: ours", TIGHT),
)
"""The paper turned into ours, one repair or improvement at a time; every line keeps those above it."""

CONTACTS: dict[str, Contact] = {
    "IPC": IPC(),
    "sequential QP": SequentialQP(),
    "velocity filter": VelocityFilter(energy=NoEnergy()),
}
"""The velocity filter moves without an energy, as the original does, and leaves the area to the final pass."""

STARTS: dict[str, Decimation] = {"flow": OnCurve(), "outer hull": OuterHull(), "level set": LevelSet()}
"""How a vertex count becomes a coarse mesh: one on the curve, which needs the flow, or one that encloses already."""

ENERGIES: dict[str, Energy] = {
    "none": NoEnergy(),
    "step displacement": StepDisplacement(),
    "initial displacement": InitialDisplacement(),
    "area": Area(),
    "boundary ARAP": BoundaryARAP(),
    "interior ARAP": InteriorARAP(),
    "shape keeping": ShapeKeeping(),
}

WITHOUT_FINAL_PASS = ("none", "step displacement")
"""Energies that are at rest wherever the cage is when the fine mesh is back."""

FILTERS = {"none": NoFilter(), "smallest distance": SmallestDistance(), "time of impact": TimeOfImpact()}
BROAD_PHASES = {"all pairs": AllPairs(), "cells": UniformGrid()}


FLOWS: dict[str, FlowMethod] = {
    "the program's": PaperFlow(exact_parity=True),
    "Algorithm 2": PaperFlow(exact_parity=True, over_length=False),
    "fall-off by length": SignedDistanceFlow(quadrature=QuadraticFallOff()),
    "midpoints": SignedDistanceFlow(quadrature=Midpoint()),
    "Gauss 2": SignedDistanceFlow(quadrature=GaussLegendre(2)),
    "Gauss 3": SignedDistanceFlow(quadrature=GaussLegendre(3)),
    "even samples": SignedDistanceFlow(quadrature=EvenSamples()),
    "new samples each step": SignedDistanceFlow(quadrature=RandomSamples()),
    "two-sided": TwoSidedFlow(),
}
"""How the gradient is sampled and weighed along the edges, and the flow that needs none."""


def every_kth(loops: Sequence[np.ndarray], count: int) -> list[np.ndarray]:
    """The user's own decimation, for example: vertices at even steps of their numbers."""
    total = sum(len(loop) for loop in loops)
    shares = [max(3, count * len(loop) // total) for loop in loops]
    return [loop[np.arange(share) * len(loop) // share] for loop, share in zip(loops, shares, strict=True)]


DECIMATIONS: dict[str, Decimation] = {
    "arc length": ArcLength(),
    "Douglas–Peucker": DouglasPeucker(),
    "Visvalingam": Visvalingam(),
    "edge collapse": EdgeCollapse(),
    "on the curve": OnCurve(),
    "outer hull": OuterHull(),
    "level set": LevelSet(),
    "own: every k-th": OwnDecimation(every_kth),
}


def with_contact(name: str, start: str = "flow") -> Settings:
    """Ours, with another contact and another start."""
    return replace(TIGHT, contact=CONTACTS[name], decimation=STARTS[start])


class Alone(NamedTuple):
    """A contact by itself."""

    descent: Contact | None
    """With the area as its energy, None if it has no energy."""
    clearing: Contact
    """Without an energy: it only makes way. IPC of 2020 needs one, and has the inertia of the cage."""


ALONE: dict[str, Alone] = {
    "IPC": Alone(IPC(), IPC(energy=NoEnergy())),
    "IPC 2020": Alone(OriginalIPC(), OriginalIPC(energy=StepDisplacement())),
    "sequential QP": Alone(None, SequentialQP()),
    "velocity filter": Alone(VelocityFilter(), VelocityFilter(energy=NoEnergy())),
    "El Topo": Alone(
        ElTopo(energy=Area(), final_energy=NoEnergy()), ElTopo(energy=NoEnergy(), final_energy=NoEnergy())
    ),
    "paper's energy, Newton": Alone(BY_NEWTON, replace(BY_NEWTON, energy=NoEnergy())),
}
"""Every contact that the starts of the others are given to."""


def alone(contact: Contact) -> Settings:
    """A contact without the tightening."""
    return replace(TIGHT, contact=contact, tightening=Tightening(iterations=0))


def with_energy(name: str, contact: str = "IPC") -> Settings:
    """Ours, with another energy during reinflation, by contacts that have one, and in the final pass."""
    energy = ENERGIES[name]
    contacts: dict[str, Contact] = {"IPC": IPC(energy=energy), "velocity filter": VelocityFilter(energy=energy)}
    return replace(TIGHT, contact=contacts.get(contact, CONTACTS[contact]), energy=energy)


def on_the_way(name: str) -> Settings:
    """The same without the final pass."""
    return replace(with_energy(name), tightening=Tightening(iterations=0))


def papers_energy(name: str) -> Settings:
    """Ours, with the paper's weights and its one range by projected Newton, and another energy of the cage."""
    return replace(TIGHT, contact=replace(BY_NEWTON, energy=ENERGIES[name]), energy=ENERGIES[name])


def with_flow(name: str) -> Settings:
    """Ours, with another flow."""
    return replace(TIGHT, flow=FLOWS[name])


def with_decimation(name: str) -> Settings:
    """Ours, with another way to make the coarse mesh."""
    return replace(TIGHT, decimation=DECIMATIONS[name])
