"""A user-defined decimation: any function that makes loops; its result is checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..errors import InvalidMeshError, NestingError
from ..geometry.mesh import Mesh
from ..parameters import check_part
from .base import Count
from .problem import checked_count


@dataclass(frozen=True)
class OwnDecimation:
    """A function of the fine loops and the wanted number of vertices."""

    function: Callable[[Sequence[ArrayLike], Count], Iterable[ArrayLike]]
    """Gets the loops (k, 2) of the fine mesh and the count, and returns the coarse loops in the same order. It may
    return fewer vertices than wanted, but not more."""

    def __post_init__(self) -> None:
        check_part(self, "function", "__call__", "a function")

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """The result of the function as a mesh. Raises NestingError where it is not valid or has too many vertices."""
        total, _ = checked_count(fine, count)
        try:
            mesh = Mesh.from_loops(self.function([fine.vertices[loop] for loop in fine.loops], count))
        except InvalidMeshError as error:
            raise NestingError(
                f"The coarse mesh of your own decimation is not valid: {error}", code="certificate.failed"
            ) from error
        if len(mesh.vertices) > total:
            raise NestingError(
                f"Your own decimation returned {len(mesh.vertices)} vertices where {total} are wanted.",
                code="count.per_loop",
            )
        return mesh
