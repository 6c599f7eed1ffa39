"""What is run: every experiment returns the measurements that the report and the plots are made of."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from comparison import methods
from comparison.drawings import drawings, letter_a, letter_a_coarse
from comparison.measure import Measurement, measure
from data import COARSE_RING_VERTICES, TABLE_1_WITHOUT_REFERENCE, Table1Row, annulus, read_shape, read_table1
from nestedcages_core import IPC, Mesh, OnCurve
from nestedcages_core.contact.pairs import Bodies, CandidateList, Pairs

COUNT = 32  # vertices of the coarse meshes of the shapes
TABLE_1_ON_THE_LADDER = (32, 128)
TABLE_1_LIMIT = 60.0  # CPU seconds: the paper as written is to come to its end there
DRAWINGS_ON_THE_LADDER = ("octagon with a hole in a square with a hole", "letter A")

PAPER_PAIRS = (("A", "A_guy_fine", "A_guy_coarse"), ("octagon", "octagon_hole_hand", "square_hole_hand"))

Results = dict[str, dict[str, Measurement]]
"""Shape -> method -> measurement."""


class Inputs(NamedTuple):
    """What the comparison runs on."""

    table1: tuple[Table1Row, ...]
    shapes: dict[str, Mesh]
    paper: dict[str, tuple[Mesh, Mesh]]
    """The paper's own pairs of meshes, where they are there."""


def read_inputs(folder: Path) -> Inputs:
    """``folder/paper/table1.csv`` and ``folder/shapes/*_V.csv``, as far as they are there."""
    reference = folder / "paper" / "table1.csv"
    rows = read_table1(reference) if reference.is_file() else TABLE_1_WITHOUT_REFERENCE
    names = sorted(path.name.removesuffix("_V.csv") for path in (folder / "shapes").glob("*_V.csv"))
    paper = {
        f"the paper's {title}": (read_shape(folder / "paper", fine), read_shape(folder / "paper", coarse))
        for title, fine, coarse in PAPER_PAIRS
        if (folder / "paper" / f"{fine}_V.csv").is_file()
    }
    return Inputs(rows, {name: read_shape(folder / "shapes", name) for name in names}, paper)


def _run(shape: str, name: str, work: Callable[[], Measurement]) -> Measurement:
    began = time.perf_counter()
    result = work()
    state = "ok" if result.success else f"{result.failed or 'not certified'} {result.problem[:60]}"
    print(f"{time.perf_counter() - began:7.2f} s  {shape}: {name}: {state}", file=sys.stderr, flush=True)
    return result


def table1(rows: tuple[Table1Row, ...]) -> Results:
    """The paper as written and ours on the discs of Table 1."""
    coarse = annulus(COARSE_RING_VERTICES)
    chosen = {"paper as written": methods.PAPER}
    chosen |= {name: methods.with_contact(name) for name in methods.CONTACTS}
    return {
        str(row.fine_vertices): {
            name: _run(
                f"Table 1, {row.fine_vertices}", name,
                lambda settings=settings, row=row: measure(
                    settings, annulus(row.fine_ring_vertices), coarse, limit=TABLE_1_LIMIT
                ),
            )
            for name, settings in chosen.items()
        }
        for row in rows
    }  # fmt: skip


def ladder() -> Results:
    """Every repair and improvement in turn."""
    cases = {f"annulus {n}": (annulus(n // 2), annulus(COARSE_RING_VERTICES)) for n in TABLE_1_ON_THE_LADDER}
    cases |= {name: drawings()[name] for name in DRAWINGS_ON_THE_LADDER}
    return {
        shape: {
            method.name: _run(shape, method.name, lambda method=method, pair=pair: measure(method.settings, *pair, 1))
            for method in methods.LADDER
        }
        for shape, pair in cases.items()
    }


def figures(paper: dict[str, tuple[Mesh, Mesh]]) -> Results:
    """The shapes of the paper's figures."""
    chosen = {"paper as written": methods.PAPER, "paper repaired": methods.HOME}
    chosen |= {name: methods.with_contact(name) for name in methods.CONTACTS}
    return {
        shape: {
            name: _run(shape, name, lambda settings=settings, pair=pair: measure(settings, *pair, 1))
            for name, settings in chosen.items()
        }
        for shape, pair in (paper | drawings()).items()
    }


def starts(shapes: dict[str, Mesh]) -> Results:
    """Every contact from every start, on the shapes of the folder."""
    return {
        shape: {
            f"{contact}, {start}": _run(
                shape, f"{contact}, {start}",
                lambda fine=fine, contact=contact, start=start: measure(
                    methods.with_contact(contact, start), fine, COUNT, 1
                ),
            )
            for start in methods.STARTS
            for contact in methods.CONTACTS
        }
        for shape, fine in shapes.items()
    }  # fmt: skip


def _flow_cases(shapes: dict[str, Mesh]) -> dict[str, tuple[Mesh, Mesh]]:
    """Cases in which the flow has work to do."""
    cases = {"annulus 512": (annulus(256), annulus(COARSE_RING_VERTICES)), "letter A": (letter_a(), letter_a_coarse())}
    for name in ("glyph_g", "blob_500", "blob_2000"):
        if name in shapes:
            cases[name] = shapes[name], OnCurve().decimate(shapes[name], COUNT)
    return cases


def contacts_alone(shapes: dict[str, Mesh]) -> Results:
    """What each contact reaches by itself, without tightening; energy of all: area."""
    chosen = {name: methods.alone(name) for name in methods.CONTACTS}
    return {
        shape: {
            name: _run(shape, f"{name} alone", lambda settings=settings, pair=pair: measure(settings, *pair, 1))
            for name, settings in chosen.items()
        }
        for shape, pair in _flow_cases(shapes).items()
    }


def filters(shapes: dict[str, Mesh]) -> Results:
    """Step filters and broad phases of IPC."""
    return {
        shape: {
            f"{step_filter}, {broad_phase}": _run(
                shape, f"{step_filter}, {broad_phase}",
                lambda pair=pair, chosen=chosen, phase=phase: measure(
                    replace(methods.TIGHT, contact=IPC(step_filter=chosen, broad_phase=phase)), *pair
                ),
            )
            for step_filter, chosen in methods.FILTERS.items()
            for broad_phase, phase in methods.BROAD_PHASES.items()
        }
        for shape, pair in _flow_cases(shapes).items()
    }  # fmt: skip


def energies() -> Results:
    """Every energy on the letter A, for the way home and the final pass."""
    pair = letter_a(), letter_a_coarse()
    return {
        "letter A": {
            name: _run("letter A", f"energy {name}", lambda name=name: measure(methods.with_energy(name), *pair))
            for name in methods.ENERGIES
        }
    }


@dataclass(frozen=True)
class TimedCells:
    """The broad phase by cells with a clock on the building of its lists."""

    clock: dict[str, float]

    def candidates(self, bodies: Bodies) -> _TimedList:
        """A list that adds the seconds of its builds to the clock."""
        return _TimedList(bodies, self.clock)


class _TimedList(CandidateList):
    def __init__(self, bodies: Bodies, clock: dict[str, float]) -> None:
        super().__init__(bodies)
        self.clock = clock

    def within(self, x: np.ndarray, reach: float, skin: float) -> Pairs:
        builds, began = self.builds, time.process_time()
        pairs = super().within(x, reach, skin)
        if self.builds > builds:
            self.clock["builds"] += 1
            self.clock["seconds"] += time.process_time() - began
        return pairs


class Reuse(NamedTuple):
    """What building lists costs in one reinflation: the most that reusing a structure of the flow could save."""

    builds: int
    building: float
    """CPU seconds."""
    reinflation: float
    """CPU seconds."""


def reuse(shapes: dict[str, Mesh]) -> dict[str, Reuse]:
    """The share of building among the costs of IPC."""
    found: dict[str, Reuse] = {}
    for shape, pair in _flow_cases(shapes).items():
        clock = {"builds": 0.0, "seconds": 0.0}
        result = measure(replace(methods.TIGHT, contact=IPC(broad_phase=TimedCells(clock))), *pair, 1)
        found[shape] = Reuse(int(clock["builds"]), clock["seconds"], result.seconds.get("reinflation", 0.0))
    return found
