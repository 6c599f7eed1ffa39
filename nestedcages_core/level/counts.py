"""The least number of vertices, where a level asks for less."""

from __future__ import annotations

from collections.abc import Sequence

from ..decimation import LineCycles
from ..errors import NestedCagesError, NestingError
from ..geometry.mesh import Mesh


def with_least(failures: Sequence[NestedCagesError], outline: Mesh, clearance: float) -> NestedCagesError:
    """The last of the failures of all attempts; for a count that is too small, with the least one that has a start."""
    error = failures[-1]
    named = [int(each.data["least"]) for each in failures if each.code == "count.too_small" and "least" in each.data]
    if error.code != "count.too_small" or "least" not in error.data or min(named) == error.data["least"]:
        return error
    try:
        mesh = LineCycles(on_curve=False).decimate(outline, min(named), clearance=clearance)
    except NestingError:
        return error
    sizes = ", ".join(str(len(loop)) for loop in mesh.loops)
    return NestingError(
        f"A level of {error.data['total']} vertices is too small for this shape, whose loops block each other: "
        f"the smallest that was found has {min(named)} ({sizes} for its loops); ask for at least {min(named)}.",
        code="count.too_small",
        total=error.data["total"],
        least=min(named),
    )
