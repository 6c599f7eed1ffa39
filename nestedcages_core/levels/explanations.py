"""Why there is no level, and what would help."""

from __future__ import annotations

from math import ceil

from ..errors import Fault, NestedCagesError, NestingError
from ..geometry.precision import INPUT_ROUND_OFF, MOST_STEPS
from .certify import Verdict
from .narrow_places import tightest_place, too_narrow
from .work import Work

GROWTH = 1.1
"""Factor on a number of vertices that was too small."""

MAX_SEARCHED = 400
"""Number of vertices above which no smaller one is sought."""


def explained(work: Work, error: NestedCagesError) -> NestedCagesError:
    """The error; where the decimation asks for more vertices, with a number that it finds a mesh for.

    Where no mesh around the outline keeps its loops and the clearance, whatever its number, this is the error instead.
    """
    plan, decimation = work.plan, work.settings.decimation
    if error.code != "count.too_small" or "total" not in error.data or not plan.is_free:
        return error
    outline, total = plan.outline.mesh, int(error.data["total"])
    clearance = work.clearances[0] if len(work.clearances) == 1 else 0.0
    bound = tightest_place(outline) if plan.side > 0 else None
    if bound is not None and bound.clearance <= max(clearance, INPUT_ROUND_OFF * outline.diagonal):
        return NestingError(bound.message(clearance))
    least: int | None = None
    too_few, count = total, max(int(error.data.get("least", 0)), total + 1)
    for _ in range(MOST_STEPS):
        try:
            decimation.decimate(outline, count, clearance=work.clearances[0])
            least = count
        except NestingError as failure:
            if count >= len(outline.vertices):
                break
            too_few, wanted = count, max(ceil(GROWTH * count), int(failure.data.get("least", 0)))
        if least is None:
            count = min(wanted, len(outline.vertices))
        elif least - too_few <= 1 or least > MAX_SEARCHED:
            break
        else:
            count = (too_few + least) // 2
    if least is None:
        return error
    return NestingError(
        f"A level of {total} vertices is too small for this shape, whose loops block each other: the smallest that was "
        f"found has {least}; ask for at least {least}.",
        code="count.too_small",
        total=total,
        least=least,
    )


def rejection(verdict: Verdict, wanted: float) -> Fault:
    """Why a cage is no level; wanted: the first clearance asked for."""
    found, inside = verdict.certificate, verdict.plan.side < 0
    if found.holds and verdict.fault is not None:
        return verdict.fault
    if not verdict.is_only_too_close:
        said = "The cage could not be certified: "
        if inside:
            said = (
                "The inner cage could not be certified; in the words of verify(fine, cage), which takes the fine mesh "
                "for the cage: "
            )
        return Fault(said + " ".join(found.problems), "certificate.failed", problems=found.problems)
    return (None if inside else too_narrow(verdict.plan.fine, wanted)) or Fault(
        f"No {'inner ' * inside}cage with this few vertices was found that keeps the clearance of {wanted:.6g}: the "
        f"best one comes as close as {found.clearance:.6g}; ask for less clearance or use more vertices.",
        "clearance.no_room",
        wanted=wanted,
        largest=found.clearance,
    )
