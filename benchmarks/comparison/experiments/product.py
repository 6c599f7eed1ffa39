"""Contacts, starts and energies in all combinations, on every shape of the folder."""

from __future__ import annotations

import statistics
import time
from pathlib import Path

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import COUNT, Inputs
from comparison.measure import CLEARANCE, Decimated, Measurement, Results
from comparison.tables import excess_and_time, matrix, median, number, table
from nestedcages_core import Mesh, NestedCagesError, Settings
from nestedcages_core.cache import forget
from nestedcages_core.decimation import Decimation

PAPERS = "paper's energy, Newton"
"""The fourth way to resolve contact: the paper's barrier and weights, by projected Newton."""


def ways() -> dict[str, str]:
    """Column -> start. Where the coarse mesh encloses already there is no reinflation, so no contact is used."""
    on_the_way = {f"{contact}, flow": "flow" for contact in (*methods.CONTACTS, PAPERS)}
    return on_the_way | {start: start for start in methods.STARTS if start != "flow"}


def settings_of(way: str, energy: str) -> Settings:
    """Ours with the contact of a column and an energy, in reinflation and in the final pass."""
    contact = way.removesuffix(", flow")
    if contact == PAPERS:
        return methods.papers_energy(energy)
    return methods.with_energy(energy, contact if contact in methods.CONTACTS else "IPC")


def run(inputs: Inputs, bench: Bench) -> Results:
    """Method names are "column / energy"."""
    results: Results = {shape: {} for shape in inputs.shapes}
    tasks = {(s, d): (methods.STARTS[d], fine) for d in methods.STARTS for s, fine in inputs.shapes.items()}
    made = bench.each("coarse meshes", coarse_mesh, tasks)
    for start in methods.STARTS:
        chosen = {
            f"{way} / {energy}": settings_of(way, energy)
            for way, own in ways().items()
            if own == start
            for energy in methods.ENERGIES
        }
        cases = {}
        for shape, fine in inputs.shapes.items():
            coarse = made[shape, start]
            if isinstance(coarse, str):
                failed = Measurement(fine, failed="decimation", problem=coarse)
                results[shape].update(dict.fromkeys(chosen, failed))
            else:
                cases[shape] = fine, coarse
        for shape, runs in bench.compare("product", cases, chosen).items():
            results[shape].update(runs)
    return results


def coarse_mesh(decimation: Decimation, fine: Mesh) -> Decimated | str:
    """A coarse mesh for all that start from it, or why there is none."""
    forget()
    began = time.process_time()
    try:
        coarse = decimation.decimate(fine, COUNT, clearance=CLEARANCE * fine.diagonal)
    except NestedCagesError as error:
        return str(error)
    return Decimated(coarse, time.process_time() - began)


def _of_energy(found: Results, energy: str) -> Results:
    """The runs of an energy, by column."""
    return {shape: {way: runs[f"{way} / {energy}"] for way in ways()} for shape, runs in found.items()}


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Successes, excess and times of all combinations; the area shape by shape."""
    if not found:
        return ""
    columns = list(ways())
    area = _of_energy(found, "area")
    plots.starts(area, pictures / "starts.png")
    lines = []
    for energy in methods.ENERGIES:
        runs = {way: [shape[f"{way} / {energy}"] for shape in found.values()] for way in columns}
        lines.append([energy, *(_summary(of) for of in runs.values())])
    return "\n\n".join([
        f"## Contacts, starts and energies, {COUNT} vertices",
        f"All combinations on the {len(found)} shapes of the folder. *flow* starts from a coarse mesh with its "
        "vertices on the curve; *outer hull* and *level set* enclose the shape already, so that there is no "
        "reinflation and only the final pass works: no contact is used in them. The energy holds in reinflation "
        f"and in the final pass. *{PAPERS}* has the paper's weights and its one range for all pairs. Successes, median "
        "excess of these, and the geometric mean of their times, decimation included:",
        table(["energy", *columns], lines),
        "With the area, shape by shape (✗: the phase that failed):",
        matrix("shape", columns, area, excess_and_time),
        "![Contacts and starts](starts.png)",
    ])  # fmt: skip


def _summary(runs: list[Measurement]) -> str:
    good = [run for run in runs if run.success]
    if not good:
        return f"0 of {len(runs)}"
    seconds = statistics.geometric_mean(run.total for run in good)
    told = "all" if len(good) == len(runs) else f"**{len(good)} of {len(runs)}**"
    return f"{told} · {number(median(run.excess for run in good), '.1f')} % · {seconds:.2f} s"


def finding(found: Results, inputs: Inputs) -> str:
    """What matters more: the contact, the start or the energy."""
    if not found:
        return ""
    area = _of_energy(found, "area")
    contacts = list(methods.CONTACTS)
    flows = [f"{name}, flow" for name in contacts]
    solved = [shape for shape in area.values() if all(shape[way].success for way in flows)]
    fastest = [min(flows, key=lambda way: shape[way].total) for shape in solved]
    told = []
    for name, way in zip(contacts, flows, strict=True):
        ratios = [shape[way].total / min(shape[other].total for other in flows) for shape in solved]
        told.append(
            f"{name} is the fastest on {fastest.count(way)} and takes {statistics.median(ratios):.2f} times the "
            f"fastest in the median, {max(ratios):.1f} times at the worst"
        )
    behind = {
        name: sum(shape[way].excess > min(shape[other].excess for other in flows) + 0.005 for shape in solved)
        for name, way in zip(contacts, flows, strict=True)
    }
    starts = {"flow": "IPC, flow"} | {start: start for start in methods.STARTS if start != "flow"}
    best = dict.fromkeys(starts, 0)
    for shape in area.values():
        good = {start: shape[way] for start, way in starts.items() if shape[way].success}
        if good:
            best[min(good, key=lambda start: good[start].excess)] += 1
    spread_contacts = [_spread([shape[way] for way in flows]) for shape in area.values()]
    spread_starts = [_spread([shape[way] for way in starts.values()]) for shape in area.values()]
    final = [energy for energy in methods.ENERGIES if energy not in methods.WITHOUT_FINAL_PASS]
    energies = [_spread([shape[f"IPC, flow / {energy}"] for energy in final]) for shape in found.values()]
    total = sum(len(shape) for shape in found.values())
    good = sum(run.success for shape in found.values() for run in shape.values())
    return (
        f"**Contacts, starts, energies.** {good} of {total} combinations succeed. With the area as energy, on "
        f"{len(solved)} shapes that all three contacts solve, "
        + "; ".join(told)
        + ". Not the tightest by more than 0.005 points: "
        + ", ".join(f"{name} on {times}" for name, times in behind.items())
        + f". Contacts change the excess by {statistics.mean(spread_contacts):.2f} points in the mean, starts by "
        f"{statistics.mean(spread_starts):.2f}, energies that have a final pass by {statistics.mean(energies):.1f}: "
        "who wants a tighter cage should look at the energy and the start, not at the contact. The tightest start is "
        + ", ".join(f"the {start} on {times}" for start, times in best.items())
        + f" of {len(area)} shapes."
    )


def _spread(runs: list[Measurement]) -> float:
    """Largest minus smallest excess of the runs that succeeded."""
    values = [run.excess for run in runs if run.success and run.excess is not None]
    return max(values) - min(values) if values else 0.0
