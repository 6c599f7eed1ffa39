"""Does each energy do what its name says, in reinflation and in the final pass?"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import Inputs, Pair
from comparison.drawings import bean, letter_a, letter_a_coarse, star, star_coarse
from comparison.measure import REPEATS, Measurement, Results
from comparison.tables import number, table
from nestedcages_core import ArcLength

BEAN_VERTICES, BEAN_COUNT = 160, 12
MIRRORED = ("letter A", "star")
"""Drawings that are their own mirror images about the upright axis, and so are their coarse meshes."""
REACHED = 1.02
"""Times the least value of an energy, among all cages of a drawing, up to which that energy counts as reached."""


def pairs() -> dict[str, Pair]:
    """A letter, a symmetric drawing, and a curved one."""
    return {
        "letter A": (letter_a(), letter_a_coarse()),
        "star": (star(), star_coarse()),
        "bean": (bean(BEAN_VERTICES), ArcLength().decimate(bean(BEAN_VERTICES), BEAN_COUNT)),
    }


def run(inputs: Inputs, bench: Bench) -> Results:
    """Every energy with and without the final pass."""
    chosen = {f"{name}, on the way": methods.on_the_way(name) for name in methods.ENERGIES}
    chosen |= {f"{name}, final": methods.with_energy(name) for name in methods.ENERGIES}
    return bench.compare("energies", pairs(), chosen, repeats=REPEATS)


def asymmetry(result: Measurement) -> float | None:
    """Longest way from a cage vertex to the nearest mirrored one, about the fine mesh's upright axis, in diagonals."""
    if result.cage is None:
        return None
    points = result.cage.vertices  # the frame of a run has the middle of the drawing's box at its origin
    mirrored = points * np.array([-1.0, 1.0])
    return float(np.hypot(*(points[:, None] - mirrored[None]).transpose(2, 0, 1)).min(axis=1).max())


def values(found: dict[str, Measurement]) -> dict[str, dict[str, float]]:
    """Energy asked for -> every energy -> its value at the final cage, relative to the least of all cages; the area as
    the excess over the fine mesh."""
    known = {name: energy for name, energy in methods.ENERGIES.items() if name not in methods.WITHOUT_FINAL_PASS}
    reached: dict[str, dict[str, float]] = {name: {} for name in methods.ENERGIES}
    for measured, energy in known.items():
        at: dict[str, float] = {}
        for name in methods.ENERGIES:
            run = found[f"{name}, final"]
            if run.cage is None or run.coarse is None:
                continue
            cage, successor = run.cage.vertices, run.coarse.successor
            offset = run.fine.area / run.fine.diagonal**2 if measured in ("area", "shape keeping") else 0.0
            at[name] = energy.at(run.coarse).value(cage, successor) - offset
        least = min(at.values(), default=1.0)
        for name, value in at.items():
            reached[name][measured] = value / least if least > 0.0 else float("nan")
    return reached


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Pictures, the value of every energy in every cage, asymmetry."""
    rows = {f"{shape}, {phase}": {} for shape in found for phase in ("on the way", "final")}
    for shape, runs in found.items():
        for name in methods.ENERGIES:
            for phase in ("on the way", "final"):
                rows[f"{shape}, {phase}"][name] = runs[f"{name}, {phase}"]
    plots.gallery(rows, list(methods.ENERGIES), pictures / "energies.png")
    parts = [
        "## Energies",
        "Each energy in reinflation (first of two rows: the cage when the fine mesh is back, before the final "
        "pass) and in the final pass too (second row), on a letter, a star that is its own mirror image, and a curved "
        "drawing. Fine mesh (filled), coarse mesh (dashed), cage:",
        "![Energies](energies.png)",
        "What it looks like: *none* and *step displacement* stop where the fine mesh has pushed the cage, with no "
        "final pass; *initial displacement* stays with the coarse mesh's vertices wherever the fine mesh lets it; "
        "*area* hugs, and turns what is free to turn, as the hole of the letter; *boundary ARAP* keeps the lengths and "
        "angles along the curve, *interior ARAP* those of the triangles inside, so that limbs keep their widths; "
        "*shape keeping* is nearly as tight as the area where the coarse mesh fits, with its directions and mirror "
        "images kept.",
        "The same in numbers: the value of each energy (columns) in the cage that each energy (rows) ends with, as a "
        "multiple of the least in its column. Every energy should have about 1 in its own column. Area and shape "
        "keeping are counted beyond the area of the fine mesh.",
    ]  # fmt: skip
    for shape, runs in found.items():
        reached = values(runs)
        columns = [name for name in methods.ENERGIES if name not in methods.WITHOUT_FINAL_PASS]
        lines = []
        for name in methods.ENERGIES:
            cells = [number(reached[name].get(column), ".3g") for column in columns]
            own = columns.index(name) if name in columns else -1
            cells = [f"**{cell}**" if k == own else cell for k, cell in enumerate(cells)]
            final, way = runs[f"{name}, final"], runs[f"{name}, on the way"]
            lines.append([
                name, *cells, number(way.excess, ".1f"), number(final.excess, ".1f"),
                number(asymmetry(final), ".0e") if shape in MIRRORED else "–",
            ])  # fmt: skip
        parts.append(table([shape, *columns, "excess % on the way", "final", "asymmetry"], lines))
    parts.append(
        "*Asymmetry* is the longest way from a cage vertex to the nearest mirrored one, in diagonals, where drawing "
        "and coarse mesh are their own mirror images."
    )
    return "\n\n".join(parts)


def finding(found: Results, inputs: Inputs) -> str:
    """Whether each reaches its own minimum, and what it costs."""
    own = [
        (shape, name, value)
        for shape, runs in found.items()
        for name, row in values(runs).items()
        for measured, value in row.items()
        if measured == name
    ]
    reached = [value <= REACHED for _, _, value in own]
    missed = [f"{name} on the {shape} ({value:.2f})" for shape, name, value in own if value > REACHED]
    excess = {
        shape: {name: runs[f"{name}, final"].excess or np.inf for name in methods.ENERGIES}
        for shape, runs in found.items()
    }
    tightest = {shape: min(of, key=lambda name, of=of: of[name]) for shape, of in excess.items()}
    asymmetric = {
        name: max(asymmetry(found[shape][f"{name}, final"]) or 0.0 for shape in MIRRORED if shape in found)
        for name in ("area", "shape keeping", "interior ARAP")
    }
    return (
        f"**Energies.** In {sum(reached)} of {len(own)} cases an energy's own cage has the least value of it among the "
        f"cages of all energies, within {100 * (REACHED - 1):.0f} %"
        + (f"; not: {', '.join(missed)}" if missed else "")
        + ". The tightest is "
        + ", ".join(f"{name} on the {shape}" for shape, name in tightest.items())
        + ". What it costs is symmetry: on drawings that are their own mirror images the cage misses its mirror image "
        "by up to " + ", ".join(f"{value:.1e} diagonals ({name})" for name, value in asymmetric.items()) + "."
    )
