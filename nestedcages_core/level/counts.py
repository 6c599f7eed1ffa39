"""The least number of vertices, where a level asks for less."""

from __future__ import annotations

from collections.abc import Sequence

from ..decimation import LineCycles
from ..errors import NestedCagesError, NestingError
from ..geometry.mesh import Mesh

MAX_TRIED = 1
"""Numbers of vertices that are tried below the least one of the hull."""


def with_least(failures: Sequence[NestedCagesError], outline: Mesh, clearance: float) -> NestedCagesError:
    """The last of the failures of all attempts; for a count that is too small, with the least one that has a start."""
    error = failures[-1]
    named = [int(each.data["least"]) for each in failures if each.code == "count.too_small" and "least" in each.data]
    if error.code != "count.too_small" or "least" not in error.data or min(named) == error.data["least"]:
        return error
    for count in range(min(named), min(min(named) + MAX_TRIED, int(error.data["least"]))):
        try:
            mesh = LineCycles(on_curve=False).decimate(outline, count, clearance=clearance)
        except NestingError:
            continue
        sizes = ", ".join(str(len(loop)) for loop in mesh.loops)
        return NestingError(
            f"A level of {error.data['total']} vertices is too small for this shape, whose loops block each other: "
            f"the smallest that was found has {count} ({sizes} for its loops); ask for at least {count}.",
            code="count.too_small",
            total=error.data["total"],
            least=count,
        )
    return error
