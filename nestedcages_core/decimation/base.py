"""The interface of all decimations, and the counts they take."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeAlias, runtime_checkable

import numpy as np

from ..errors import Fault, NestingError, note
from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.loops import Loops
from ..geometry.mesh import Mesh
from ..tasks import Stage

Count: TypeAlias = int | Sequence[int]
"""Vertices of a level: a total, or one number per loop in the order of `fine.loops`."""

REACH = 1.5
"""How far new vertices may run away, in diameters: from the centre, or along an edge from its contact. Tightening needs
no limit, since edges of least area touch what is inside at their middle or on either side of it."""

PIN_REACH = 1e-3
"""Distance from a pin, in diameters of the shape, up to which a vertex counts as pinned."""

LEAST_PER_LOOP = 3
"""Vertices of the smallest polygon."""


class Decimation(Protocol):
    """A way to make a coarse mesh with a wanted number of vertices."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh of the fine one whose loop k stands for loop k of the fine mesh.

        count: the total number of vertices, distributed over the loops, or one number per loop.
        clearance: the distance to the fine mesh that the cage must keep, in input units.

        Raises NestingError.
        """


class Importance(Protocol):
    """What a need says of a shape to a decimation, in input units."""

    @property
    def weights(self) -> FloatArray | None: ...
    @property
    def min_edge(self) -> float | None: ...
    @property
    def min_angle(self) -> float | None: ...
    def at(self, points: FloatArray) -> FloatArray:
        """(P,) weight at the closest place on the shape to each of the points (P, 2)."""

    def pinned(self, outline: Loops) -> BoolArray:
        """(n,) the vertices of an outline that the decimation keeps."""

    def with_vertices(self, outline: Loops, most: float = np.inf) -> Loops:
        """The outline with additional vertices at places that keep one, as long as it has at most so many."""


class Start(NamedTuple):
    """A coarse mesh to start a level from."""

    coarse: Mesh
    source: str
    """What it is, such as "outer hull"."""
    on_curve: Mesh | None = None
    """The mesh with its vertices on the fine mesh, where that is preferred; the flow leads from it to a cage."""
    makeshift_for: NestingError | None = None
    """Why it differs from the request; raised if it does not lead to a cage."""


@runtime_checkable
class SeveralStarts(Protocol):
    """A decimation that offers several coarse meshes to start from, and whose search can be cancelled."""

    def starts(self, fine: Mesh, count: Count, *, clearance: float, most: int) -> Stage[float, list[Start]]:
        """Up to ``most`` different coarse meshes, the most promising first; otherwise like `Decimation.decimate`.

        A generator: yields the fraction done and returns the list.
        """


@runtime_checkable
class CurveStarts(SeveralStarts, Protocol):
    """A decimation whose starts come with meshes on the curve, and that knows the fewest vertices there can be."""

    @property
    def on_curve(self) -> bool:
        """Whether they do."""

    @property
    def outside(self) -> Decimation:
        """The same without meshes on the curve."""

    @property
    def inside(self) -> Decimation:
        """The same for meshes inside the fine one."""


@runtime_checkable
class KnowsCounts(Protocol):
    """A decimation one search of which knows the areas for all numbers of vertices."""

    def fewest(self, fine: Mesh, most: int, area: float) -> Stage[float, int | None]:
        """About how many vertices a mesh of at most an area around the fine one needs; None if more than so many."""


def clamped(count: int, fine: Mesh) -> tuple[int, tuple[Fault, ...]]:
    """A number of vertices, clamped to that of the fine mesh, with a note if it was larger."""
    available = len(fine.vertices)
    if count <= available:
        return count, ()
    return available, (note("note.count", on="mesh", asked=count, given=available),)


def shared_anew(count: Count, coarse: Mesh) -> tuple[Fault, ...]:
    """A note if the numbers of vertices per loop of a coarse mesh differ from the request."""
    if isinstance(count, int | np.integer) or list(count) == [len(loop) for loop in coarse.loops]:
        return ()
    return (note("note.count", on="loops", asked=list(count), given=[len(loop) for loop in coarse.loops]),)


def blocked(total: int, least: int) -> Fault:
    """The message for a number of vertices below the least for which a coarse mesh was found."""
    return Fault(
        f"A level of {total} vertices is too small for this shape, whose loops block each other: the smallest that was "
        f"found has {least}; ask for at least {least}.",
        "count.too_small",
        total=total,
        least=least,
    )


@dataclass(frozen=True)
class Budget:
    """A checked count: `total` vertices; `per_loop` in the order of `fine.loops`, or None to distribute them freely."""

    total: int
    per_loop: tuple[int, ...] | None


def checked_budget(fine: Mesh, count: Count) -> Budget:
    """The count as a Budget. Raises NestingError unless every loop gets 3 and the total is at most that of `fine`.

    Numbers per loop may exceed those of the fine mesh, as they come from a given coarse mesh.
    """
    loops, available = len(fine.loops), len(fine.vertices)
    try:
        if isinstance(count, Sequence | np.ndarray):
            per_loop = tuple(operator.index(k) for k in count)
            total = sum(per_loop)
        else:
            per_loop = None
            total = operator.index(count)
    except TypeError:
        raise NestingError(
            f"A level needs a whole number of vertices, or one per loop, not {count!r}.", code="level.invalid"
        ) from None
    if per_loop is not None:
        if len(per_loop) != loops:
            raise NestingError(
                f"The level lists vertices for {len(per_loop)} loops, but the mesh inside it has {loops}; give one "
                "number per loop, or only their sum.",
                code="count.per_loop",
            )
        if min(per_loop) < LEAST_PER_LOOP:
            k = int(np.argmin(per_loop))
            raise NestingError(
                f"The level gives {per_loop[k]} vertices to loop {k}, but a loop needs at least {LEAST_PER_LOOP}.",
                code="count.too_small",
                total=total,
                least=LEAST_PER_LOOP * loops,
            )
    elif total < LEAST_PER_LOOP * loops:
        raise NestingError(
            f"A level of {total} vertices is too small: the mesh inside it has {loops} "
            f"loop{'s' if loops > 1 else ''} and each needs at least {LEAST_PER_LOOP}, so ask for at least "
            f"{LEAST_PER_LOOP * loops}.",
            code="count.too_small",
            total=total,
            least=LEAST_PER_LOOP * loops,
        )
    elif total > available:
        raise NestingError(
            f"A level of {total} vertices has more than the {available} of the mesh inside it; ask for at most "
            f"{available}.",
            code="count.too_large",
            total=total,
            largest=available,
        )
    return Budget(total, per_loop)
