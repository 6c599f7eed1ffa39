"""Which decimation leads to the tightest cage, and what becomes of the loops of a level set?"""

from __future__ import annotations

from pathlib import Path

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import COUNT, Inputs
from comparison.drawings import two_discs, two_holes
from comparison.measure import Results
from comparison.tables import count, excess_and_time, matrix, table
from nestedcages_core import LevelSet, Mesh, NestedCagesError, Settings, nested_cages

SHOWN = ("glyph_g", "blob_500", "comb")
"""Shapes in the picture."""


def run(inputs: Inputs, bench: Bench) -> Results:
    """Every decimation of every shape of the folder."""
    chosen = {name: methods.with_decimation(name) for name in methods.DECIMATIONS}
    return bench.compare("decimations", {name: (fine, COUNT) for name, fine in inputs.shapes.items()}, chosen)


def changing() -> dict[str, tuple[Mesh, int]]:
    """Drawings, and vertex counts at which level sets lose holes or merge parts before a coarse contour encloses."""
    return {"two discs, 8": (two_discs(), 8), "disc with two holes, 10": (two_holes(), 10)}


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Excess and times, a picture, and what is said of loops that change."""
    if not found:
        return ""
    names = list(methods.DECIMATIONS)
    shown = {shape: found[shape] for shape in SHOWN if shape in found} or dict(list(found.items())[:1])
    plots.gallery(shown, names, pictures / "decimations.png")
    lines = []
    for name, (fine, few) in changing().items():
        lines.append([name, _told(fine, few, LevelSet()), _told(fine, few, LevelSet(change_loops=True))])
    return "\n\n".join([
        f"## Decimations, {COUNT} vertices",
        "Ways to make the coarse mesh, each followed by flow (where it does not enclose the shape), IPC and "
        "tightening; one start each, where `nested_cages` would try several. *On the curve* chooses the vertices that "
        "describe the curve best; the last is a function of five lines, as a user's own may be (`OwnDecimation`).",
        matrix("shape", names, found, excess_and_time),
        "![Decimations](decimations.png)",
        "A level set at a large offset closes holes and merges parts. `LevelSet()` refuses that and says which loop is "
        "lost; `LevelSet(change_loops=True)` allows it, and the report says so:",
        table(["drawing, vertices", "LevelSet()", "LevelSet(change_loops=True)"], lines),
    ])  # fmt: skip


def _told(fine: Mesh, few: int, decimation: LevelSet) -> str:
    """What the run says."""
    try:
        (level,) = nested_cages(fine, [few], Settings(decimation=decimation, fallback=None)).levels
    except NestedCagesError as error:
        return f"error: {error}"
    notes = " ".join(level.report.notes)
    return f"{len(level.cage.loops)} of {len(fine.loops)} loops, {100.0 * level.report.excess:.0f} % excess. {notes}"


def finding(found: Results, inputs: Inputs) -> str:
    """Successes and wins."""
    if not found:
        return ""
    wins = dict.fromkeys(methods.DECIMATIONS, 0)
    for runs in found.values():
        good = {name: run.excess for name, run in runs.items() if run.success}
        for name, excess in good.items():
            wins[name] += excess <= min(good.values()) + 0.005
    return (
        "**Decimations.** Successes, and how often within 0.005 points of the tightest: "
        + "; ".join(f"{name} {count(found, name)}, {times}" for name, times in wins.items())
        + ". After the tightening the choice of vertices remains: it fixes how many stand where."
    )
