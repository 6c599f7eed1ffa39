"""The methods that are compared as settings, our drawings of the paper's figures, and one run of a method."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from common import forget
from nestedcages_core import (
    AUGMENTED_2022,
    AUGMENTED_2022_REPAIRED,
    IPC,
    ArcLength,
    Area,
    GradientDescent,
    Mesh,
    NestedCagesError,
    NoEnergy,
    OnCurve,
    PaperContact,
    PaperFlow,
    ProjectedNewton,
    Repairs,
    SequentialQP,
    Settings,
    Tightening,
    TwoSidedFlow,
    nested_cages,
    verify,
    verify_motion,
)
from paper.li_2020 import OriginalIPC
from paper.newton_2022 import ContactByNewton
from paper.sacht_2015 import ElTopo, SachtFlow
from paper.sellan_2022 import Decimation, edge_collapse, level_set
from shapes import ring

STARTS = {"edge collapse": Decimation(edge_collapse), "arc length": ArcLength(), "line cycles": OnCurve()}
"""Coarse meshes that methods start from: that of 2015, evenly spaced vertices, and ours put on the curve."""

REPAIRS = Repairs(parity=True, exact_home=True)
BY_NEWTON = ContactByNewton(repairs=REPAIRS, solver=ProjectedNewton())
"""The energy of 2022 with its faults repaired, by projected Newton, its further work."""
DESCENT = PaperContact(repairs=REPAIRS, solver=GradientDescent(refuse_infinite=True))
RANGES = (1e-3, 1e-2, PaperContact().d_hat)  # d̂ in diagonals: the default of IPC (2020), and up to that of 2022
OURS = Settings(fallback=None, flow=TwoSidedFlow(), contact=IPC(), tightening=Tightening())
"""Ours with IPC, from one coarse mesh and without a fallback."""


def of_2022(contact: Any) -> Settings:
    return replace(AUGMENTED_2022_REPAIRED, flow=PaperFlow(exact_parity=True), contact=contact)


NESTED_CAGES_2015 = replace(
    AUGMENTED_2022,
    decimation=Decimation(edge_collapse),
    flow=SachtFlow(),
    contact=ElTopo(energy=NoEnergy(), final_energy=Area()),
)
"""Sacht et al. (2015): expansion by El Topo without an energy, and a final pass that lowers the area."""
WHOLE: dict[str, Settings] = {
    "Nested Cages 2015": NESTED_CAGES_2015,
    "2022 by Newton": of_2022(BY_NEWTON),
    f"2022 by Newton, d̂ = {RANGES[0]:g}": of_2022(replace(BY_NEWTON, d_hat=RANGES[0])),
    "ours": OURS,
    "default": Settings(),
}
"""Whole methods from one coarse mesh, the last with its fallbacks."""
SIMPLE_2022 = replace(AUGMENTED_2022_REPAIRED, decimation=Decimation(level_set))
"""Sellán et al. (2022): the level set itself is the cage, with no flow and no contact."""
CONTACTS: dict[str, Any] = {
    "IPC, ours": IPC(),
    "sequential QP": SequentialQP(),
    "El Topo": ElTopo(energy=Area(), final_energy=NoEnergy()),
    **{f"IPC 2020, {d:.2g}": OriginalIPC(d_hat=d) for d in RANGES},
    **{f"energy of 2022, {d:.2g}": replace(BY_NEWTON, d_hat=d) for d in RANGES},
}
# our drawings of the figures


def letter_a_coarse() -> Mesh:
    """A letter A with arms and a triangular hole."""
    half = [(0.5, 1.1), (0.85, 0.0), (1.5, 0.0), (1.55, 0.3), (1.25, 0.4), (0.95, 1.8), (1.9, 2.15), (1.85, 2.6)]
    half += [(0.72, 2.4), (0.3, 3.8)]
    outline = np.array(half + [(-x, y) for x, y in reversed(half)])
    return Mesh.from_loops([outline, np.array([(-0.3, 1.7), (0.3, 1.7), (0.0, 2.7)])])


def letter_a() -> Mesh:
    """The same with its corners cut twice and its edges halved."""
    loops = []
    for loop in letter_a_coarse().loops:
        points = letter_a_coarse().vertices[loop]
        for _ in range(2):
            after = np.roll(points, -1, axis=0)
            points = np.stack([0.8 * points + 0.2 * after, 0.2 * points + 0.8 * after], axis=1).reshape(-1, 2)
        middle = 0.5 * (points + np.roll(points, -1, axis=0))
        loops.append(np.stack([points, middle], axis=1).reshape(-1, 2))
    return Mesh.from_loops(loops)


def holed(outer: int, inner: int) -> Mesh:
    """A regular polygon with a hole of half its radius."""
    return Mesh.from_loops([ring(outer), ring(inner, 0.5)])


def figures() -> dict[str, tuple[Mesh, Mesh]]:
    """Number in the paper and what it shows -> fine and coarse mesh."""
    letter = OnCurve().decimate(letter_a(), [45, 6])
    holes = Mesh.from_loops([ring(64), ring(32, 0.5), ring(16, 0.2) + np.array([0.75, 0.0])])
    return {
        "1, 2: letter A": (letter, OnCurve().decimate(letter, [32, 3])),
        "3: disc in a pentagon": (holed(16, 16), holed(5, 5)),
        "4: one of two holes": (holes, holed(5, 5)),
        "5: pentagon in a triangle": (holed(5, 5), holed(3, 3)),
    }


# one run


class Run(NamedTuple):
    """What became of a run: excess in per cent, CPU seconds; a distance in diagonals."""

    failed: str  # the stage that failed or ran out of time, or empty
    excess: float = np.nan
    seconds: float = np.nan
    contact_seconds: float = np.nan
    distance: float = np.nan  # between cage and fine mesh at the end
    flow_steps: int = 0


class OutOfTimeError(Exception):
    """The run has used up its seconds."""


def measured(settings: Settings, fine: Mesh, coarse: Mesh | int, limit: float = 6.0) -> Run:
    """A method from a coarse mesh, or from its own with so many vertices: certified with its motion, or failed."""
    stage, spent = "start", {"start": 0.0}
    last = begin = time.process_time()

    def progress(told: Any = None) -> None:
        nonlocal stage, last
        now = time.process_time()
        spent[stage] = spent.get(stage, 0.0) + now - last
        stage, last = told.stage if told is not None else stage, now
        if now - begin > limit:
            raise OutOfTimeError

    forget()
    begin = last = time.process_time()
    try:
        level = nested_cages(fine, [coarse], settings, progress=progress)[0]
    except OutOfTimeError:
        return Run(f"{stage}, time")
    except NestedCagesError:
        return Run(stage)
    progress()
    way = level.reinflation
    home = np.array_equal(way.fine_steps[-1], fine.vertices)
    certificate = verify(level.cage, fine, 0.0, same_loops=level.cage.loop_signs.tolist() == fine.loop_signs.tolist())
    if not (home and certificate.holds and verify_motion(level.cage, fine, way.cage_steps, way.fine_steps)):
        return Run("certificate")
    return Run("", 100.0 * certificate.excess, sum(spent.values()), spent.get("reinflation", 0.0),
               certificate.clearance / fine.diagonal, len(level.flow.steps) - 1)  # fmt: skip


def alone(contact: Any, fine: Mesh) -> Settings:
    """A contact without the tightening, and with hardly a clearance."""
    return replace(OURS, contact=contact, tightening=Tightening(iterations=0), clearance=1e-8 * fine.diagonal)
