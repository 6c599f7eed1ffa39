"""Advice to users: whether gaps allow a clearance, and why a cage is loose."""

from __future__ import annotations

from math import ceil, pi

from ..core import core
from ..errors import UserError, counted
from ..notes import note
from ..scene.convert import Drawing
from .memory import remembered

# Excess over the drawing above which a cage is called loose, and the excess that the advice aims at.
LOOSE, GOOD = 0.5, 0.25
# Excess from which on it is said in times, and the part of a cage's that a clearance takes alone, to be called its
# cause; one that is loose by itself always is, since no number of vertices helps.
MANY_TIMES, CLEARANCE_PART = 10.0, 0.25
# Factor from one tested vertex count to the next; drawings with more vertices than this are not tested.
COUNT_GROWTH, LARGEST_TRIED = 1.3, 5000
# Size in bytes of a bound, for the memory.
BOUND_BYTES = 1000


def check_room(fine: core.Mesh, clearance: float, levels: int, drawing: Drawing) -> None:
    """Raises: UserError if holes or gaps are too narrow for the cages at a clearance, in the drawing's units.

    Each level keeps its own clearance, so the last one is as many clearances away from the drawing.
    """
    (bound,) = remembered(lambda: (core.hierarchy.tightest_place(fine),), BOUND_BYTES, "tightest place", fine)
    if bound is None or bound.clearance > levels * clearance:
        return
    scale, most = drawing.frame.scale, bound.clearance / levels
    several = f" on {levels} levels" if levels > 1 else ""
    raise UserError(
        f"'{drawing.name}': No cage keeps the clearance of {clearance * scale:.6g}{several} {bound.where}: "
        f"{bound.why}; ask for less than {most * scale:.6g}, or {bound.remedy}.",
        drawing.fault(bound.message(clearance)),
    )


def excess_note(fine: core.Mesh, cage: core.Mesh, wanted: object, clearance: float) -> tuple[core.Fault, ...]:
    """Why a cage is loose, and what number of vertices would be enough; empty if it is not."""
    excess, count = cage.area / fine.area - 1.0, len(cage.vertices)
    if excess <= LOOSE or not isinstance(wanted, int):
        return ()
    around = clearance * (float(fine.edge_lengths.sum()) + pi * clearance) / fine.area
    if around > min(CLEARANCE_PART * excess, LOOSE):
        return (note("loose.clearance", excess=float(excess), share=float(clearance / fine.diagonal)),)
    better, loops = _enough(fine, count, clearance), counted(len(fine.loops), "loop")
    facts = {"count": count, "loops": loops, "excess": float(excess)}
    return (note("loose.enough", **facts, better=better, good=GOOD) if better else note("loose.count", **facts),)


def part(excess: float) -> str:
    """An excess in percent or, from `MANY_TIMES` on, in times."""
    return f"{100.0 * excess:.2f} %" if excess < MANY_TIMES else f"{excess:,.0f} times"


def _enough(fine: core.Mesh, count: int, clearance: float) -> int | None:
    """A vertex count whose outer hull, without tightening, is close enough; None if there is none."""
    total = len(fine.vertices)
    while count < total <= LARGEST_TRIED:
        count = min(ceil(COUNT_GROWTH * count), total)
        try:
            hull = core.OuterHull().decimate(fine, count, clearance=clearance)
        except core.NestedCagesError:
            continue
        if hull.area <= (1.0 + GOOD) * fine.area:
            return count
    return None
