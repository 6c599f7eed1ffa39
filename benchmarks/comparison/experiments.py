"""Which methods run on which shapes. Each experiment gives its runs; what they say is written elsewhere."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

import numpy as np

from comparison import methods
from comparison.bench import Bench
from comparison.conclusions import APART, spread
from comparison.drawings import bean, letter_a, letter_a_coarse, star, star_coarse
from comparison.measure import Measurement, measure, measure_default, tightened
from comparison.runs import Run, of
from comparison.shapes import DISCS, FIGURES, HELD_OUT, RANDOM, Case, Sizes, case, cases, disc, figures, start
from data import read_table1
from nestedcages_core import ArcLength, Mesh, NestedCagesError, as_published
from nestedcages_core.level.units import SolverUnits
from nestedcages_core.tasks import drain
from nestedcages_core.verification import verify

CONTACT_LIMIT = 2.0  # CPU seconds of a contact by itself
LADDER_SHAPES = ("figure 3: disc with a hole in a pentagon",)
BEAN_VERTICES, BEAN_COUNT = 160, 12
Runs = list[Run]


def run(sizes: Sizes, bench: Bench) -> Runs:
    """All experiments."""
    contact_cases, whole_cases = list(cases(sizes.contacts)), [*figures(), *cases(sizes.methods)]
    tasks: dict[tuple[str, ...], tuple[Any, ...]] = {}
    for made in contact_cases:
        tasks["contacts", made.family, made.shape, made.start] = (contacts, made)
    for made in whole_cases:
        tasks["methods", made.family, made.shape, made.start] = (whole, made)
    for made in cases(sizes.flows, (ONE_START,)):
        tasks["flows", made.family, made.shape] = (flows, made)
    for row in read_table1():
        tasks["table 1", DISCS, str(row.fine_vertices)] = (table_1, disc(row.fine_ring_vertices))
    for made in (one for one in figures() if one.shape in LADDER_SHAPES):
        tasks["ladder", made.family, made.shape] = (ladder, made)
    for made in symmetric():
        tasks["energies", made.family, made.shape] = (energies, made)
    found = bench.each("comparison", _made, tasks, lambda runs: f"{sum(run.success for run in runs)} of {len(runs)}")
    return [run for runs in found.values() for run in runs]


def _made(experiment: Any, made: Case) -> Runs:
    return list(experiment(made))


def contacts(made: Case, names: Collection[str] = methods.CELLS) -> Runs:
    """Every contact and range from the same coarse mesh and flow; the same tightening after each."""
    begun = start(made)
    if begun is None:
        return []
    found = []
    for name in (name for name in methods.CELLS if name in names):
        result = measure(methods.alone(methods.CELLS[name].contact), made.fine, begun, 1, CONTACT_LIMIT)
        after = tightened(result) if result.success else None
        line = _run("contacts", made, name, result, result.seconds.get("reinflation"))
        found.append(replace(line, tightened=after.excess if after is not None and after.success else None))
    return found


def whole(made: Case) -> Runs:
    """Whole methods, published and ours, from the same coarse mesh; simple cages make their own."""
    extra = {"drawn": methods.ON_FIGURES, DESCENT_START: methods.DESCENDING}
    chosen = methods.WHOLE | extra.get(made.start, {})
    found = []
    for name, settings in chosen.items():
        wanted = len(made.coarse.vertices) if name == methods.SIMPLE else made.coarse
        found.append(_run("methods", made, name, measure(settings, made.fine, wanted)))
    found.append(_run("methods", made, methods.DEFAULT, measure_default(made.fine, made.coarse)))
    return found


def ladder(made: Case) -> Runs:
    """The paper turned into ours, one change at a time."""
    return [_run("ladder", made, name, measure(s, made.fine, made.coarse)) for name, s in methods.LADDER.items()]


def table_1(made: Case) -> Runs:
    """The disc by the paper's program as it is, with absolute lengths, and by others."""
    result = as_published(made.fine, made.coarse)
    certificate = verify(result.cage, made.fine)
    program = Measurement(made.fine, made.coarse, certified=certificate.holds, excess=100.0 * certificate.excess)
    program.short, program.smallest = result.short / made.fine.diagonal, certificate.clearance
    program.failed, program.problem = "reinflation", "the fine mesh rests short of its target"
    program.seconds = dict(zip(("flow", "reinflation"), result.seconds, strict=True))
    found = [_run("table 1", made, methods.WRITTEN, program, sum(result.seconds))]
    for name in (methods.ORIGINAL, methods.NEWTON, methods.OURS):
        found.append(_run("table 1", made, name, measure(methods.WHOLE[name], made.fine, made.coarse)))
    return [*found, _run("table 1", made, methods.DEFAULT, measure_default(made.fine, made.coarse))]


def flows(made: Case) -> Runs:
    """Flows alone: whether they get inside, in how many steps."""
    units, found = SolverUnits.of(made.fine), []
    fine, coarse = units.from_input(made.fine), units.from_input(made.coarse)
    for name, flow in methods.FLOWS.items():
        result = Measurement(made.fine, made.coarse)
        try:
            result.flow_steps = len(drain(units.method(flow).run(fine, coarse)).steps) - 1
        except NestedCagesError as error:
            result.failed, result.problem = "flow", str(error)
        line = _run("flows", made, name, result)
        found.append(replace(line, success=not result.failed))
    return found


def symmetric() -> list[Case]:
    """Two drawings that are their own mirror images, and a curved one."""
    curved = bean(BEAN_VERTICES)
    drawn = {"letter A": (letter_a(), letter_a_coarse()), "star": (star(), star_coarse())}
    drawn["bean"] = (curved, ArcLength().decimate(curved, BEAN_COUNT))
    return [Case(FIGURES, number, name, *pair) for number, (name, pair) in enumerate(drawn.items())]


def energies(made: Case) -> Runs:
    """Every energy on the way and in the tightening."""
    found = []
    for name in methods.ENERGIES:
        result = measure(methods.with_energy(name), made.fine, made.coarse)
        line = _run("energies", made, name, result)
        found.append(replace(line, asymmetry=asymmetry(result.cage) if made.shape != "bean" else None))
    return found


def asymmetry(cage: Mesh | None) -> float | None:
    """Largest distance of a cage vertex from the nearest mirrored one, about the upright axis, in diagonals."""
    if cage is None:
        return None
    mirrored = cage.vertices * np.array([-1.0, 1.0])  # the units of a run have the middle of the drawing at the origin
    return float(np.hypot(*(cage.vertices[:, None] - mirrored[None]).transpose(2, 0, 1)).min(axis=1).max())


SAMPLE = {RANDOM: 2, HELD_OUT: 2}
"""How many shapes of a family are run again to check the pages."""
SAMPLED = ("IPC, ours", "sequential QP", methods.at(methods.ENERGY_2022, methods.LARGE_RANGE))
"""Contacts that are run on them."""
ONE_START = "line cycles"
"""The start of the sample, and of flows."""
DESCENT_START = "edge collapse"
"""That of gradient descent."""


def sample(runs: Runs) -> Runs:
    """Some of the runs again: on shapes on which all recorded contacts end in one cage after the tightening.

    On others, round-off decides between local optima.
    """
    found: Runs = []
    for family, count in SAMPLE.items():
        tightened: dict[int, list[float | None]] = {}
        for run in of(runs, "contacts", family, start=ONE_START):
            if run.success:
                tightened.setdefault(run.number, []).append(run.tightened)
        stable = [number for number, ends in tightened.items() if spread(ends) <= APART]
        for number in stable[:count]:
            for made in case(family, number) or []:
                found += contacts(made, SAMPLED) if made.start == ONE_START else []
    return found


def _run(experiment: str, made: Case, name: str, result: Measurement, seconds: float | None = None) -> Run:
    seconds = seconds if seconds is not None else (result.total if result.seconds else None)
    return Run(
        experiment, made.family, made.number, made.shape, made.start, name, len(made.fine.vertices),
        len(made.coarse.vertices), result.success, result.certified, result.failed, result.excess, None,
        result.smallest, result.short, seconds, result.flow_steps, result.iterations, None,
        " ".join(result.problem.split())[:120],
    )  # fmt: skip
