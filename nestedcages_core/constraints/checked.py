"""Constraints written elsewhere: what they answer is looked at before it is used.

A method that fails, or answers with what is no number or has another shape, ends the run with one sentence that names
the constraint and the method. What a constraint asks for is judged by its own `fault`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeVar, cast

import numpy as np

from ..decimation.base import MIN_PER_LOOP, LevelTarget
from ..decimation.outline import Lines, Outline
from ..decimation.sampling import NormalFrame
from ..energies import CageEnergy
from ..errors import Fault, NestedCagesError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh
from ..solver.banded import Rows
from ..solver.elimination import Elimination
from .base import Bound, Constraint, Rounding, Terms, Units
from .loop_clearance import LoopClearance

Answer = TypeVar("Answer")

LARGEST = 1e100
"""Upper bound of numbers in rows: their squares are numbers, too."""

MISSED = "constraint.missed"
"""Code of what is missed, if a constraint gives a plain sentence."""


@dataclass(frozen=True)
class Checked(Constraint):
    """A constraint that another one answers for."""

    given: Constraint

    @property
    def must(self) -> bool:  # type: ignore[override]
        """Of the given one, like the others."""
        return bool(self.given.must)

    @property
    def on(self) -> str:  # type: ignore[override]
        """What a note on the number of vertices says."""
        return self.given.on

    @property
    def is_rule(self) -> bool:  # type: ignore[override]
        """Whether lines show it."""
        return bool(self.given.is_rule)

    @property
    def group(self) -> Symmetry | None:  # type: ignore[override]
        """Its symmetry."""
        return self.given.group

    @property
    def turn_limits(self) -> tuple[float, float]:
        """Two numbers of at least 0."""
        limits = _numbers(self.given, "turn_limits", lambda: self.given.turn_limits, (2,))
        if (limits < 0.0).any() or not np.isfinite(limits).all():
            raise _wrong(self.given, "turn_limits", "must be a finite length and an angle of at least 0")
        return float(limits[0]), float(limits[1])

    def of(self, about: Mesh, side: int) -> Constraint:
        """A constraint."""
        return self._again("of", about, side)

    def around(self, outline: Mesh) -> Constraint:
        """A constraint."""
        return self._again("around", outline)

    def rounded(self, numbers: Rounding) -> Constraint:
        """A constraint."""
        return self._again("rounded", numbers)

    def outline(self, outline: LevelTarget, side: int) -> LevelTarget:
        """An outline."""
        return _instance(self.given, "outline", LevelTarget, self.given.outline, outline, side)

    def count(self, outline: Mesh, count: int) -> int:
        """A whole number, at least that asked for or three a loop, at most that asked for or that of the outline."""
        found = _asked(self.given, "count", self.given.count, outline, count)
        least, most = min(count, MIN_PER_LOOP * len(outline.loops)), max(count, len(outline.vertices))
        if isinstance(found, bool | np.bool_) or not isinstance(found, int | np.integer) or not least <= found <= most:
            raise _wrong(self.given, "count", f"must return a whole number from {least} to {most}, not {found!r}")
        return int(found)

    def distances(self, fine: Mesh) -> FloatArray | None:
        """None, or a length for each loop."""
        found = _asked(self.given, "distances", self.given.distances, fine)
        if found is None:
            return None
        lengths = _numbers(self.given, "distances", lambda: found, (len(fine.loops),))
        if not ((lengths >= 0.0) & (lengths < np.inf)).all():
            raise _wrong(self.given, "distances", "must return finite lengths of at least 0")
        return lengths

    def candidates(self, outline: Outline, at: IntArray, lines: Lines, frame: NormalFrame, shift: float) -> Lines:
        """Lines with places on the loop."""
        found = _instance(self.given, "candidates", Lines, self.given.candidates, outline, at, lines, frame, shift)
        if found is lines:
            return lines
        count = len(np.atleast_1d(found.place))
        if count == 0:
            raise _wrong(self.given, "candidates", "must return some lines")
        shapes = {
            "point": (count, 2),
            "place": (count,),
            "direction": (count, 2),
            "skipped": (count,),
            "span": (count,),
        }
        parts = [_numbers(self.given, "candidates", lambda n=n: getattr(found, n), shapes[n]) for n in shapes]
        if (
            not all(np.isfinite(part).all() for part in parts)
            or not ((parts[1] >= 0) & (parts[1] < outline.size)).all()
        ):
            raise _wrong(self.given, "candidates", f"must return finite numbers, and places from 0 to {outline.size}")
        return Lines(*parts)

    def reach(self, outline: Outline, lines: Lines, shift: float) -> FloatArray:
        """Numbers, which may be infinite."""
        return _numbers(self.given, "reach", lambda: self.given.reach(outline, lines, shift), (2, len(lines)))

    def started(self, coarse: Mesh, side: int) -> Mesh:
        """A mesh with the same edges."""
        found = _instance(self.given, "started", Mesh, self.given.started, coarse, side)
        if not np.array_equal(found.edges, coarse.edges):
            raise _wrong(self.given, "started", "must keep the edges of the coarse mesh")
        return found if found is coarse else found.validated()

    def restored(self, coarse: Mesh, steps: FloatArray) -> FloatArray:
        """Finite numbers."""
        found = _numbers(self.given, "restored", lambda: self.given.restored(coarse, _sealed(steps)), steps.shape)
        if not np.isfinite(found).all():
            raise _wrong(self.given, "restored", "must return finite numbers")
        return found.copy()

    def free(self, lines: Lines, frame: NormalFrame) -> FloatArray:
        """Numbers, which may be infinite."""
        return _numbers(self.given, "free", lambda: self.given.free(lines, frame), (2, len(lines)))

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """A bound that is looked at, too."""
        bound = _instance(self.given, "bound", Bound, self.given.bound, coarse, fine, units)
        return bound if type(bound) is Bound else CheckedBound(self.given, bound)

    def term(self, coarse: Mesh, units: Units) -> CageEnergy | None:
        """None, or an energy."""
        found = _asked(self.given, "term", self.given.term, coarse, units)
        if found is None or isinstance(found, CageEnergy):
            return found
        raise _wrong(self.given, "term", f"must return an energy or None, not {found!r}")

    def faults(self, cage: Mesh, fine: Mesh) -> Iterator[Fault]:
        """Sentences, which have a code then; distances of loops are judged, too."""
        distances = self.distances(fine)
        if distances is not None and (close := LoopClearance(loops=tuple(distances.tolist())).fault(cage, fine)):
            yield close
        found = _asked(self.given, "fault", lambda: list(self.given.faults(cage, fine)))
        for fault in found:
            if not isinstance(fault, str) or not fault:
                raise _wrong(self.given, "fault", f"must return a Fault, a sentence, or None, not {fault!r}")
            yield fault if isinstance(fault, Fault) else Fault(fault, MISSED)

    def mended(self, cage: Mesh) -> tuple[Mesh, Fault] | None:
        """None, or a mesh and a note."""
        found = _asked(self.given, "mended", self.given.mended, cage)
        if found is None or (isinstance(found, tuple) and [*map(type, found)] == [Mesh, Fault]):
            return cast("tuple[Mesh, Fault] | None", found)
        raise _wrong(self.given, "mended", "must return a Mesh with a Fault, or None")

    def _again(self, method: str, *arguments: object) -> Constraint:
        return checked(_instance(self.given, method, Constraint, getattr(self.given, method), *arguments))


@dataclass(frozen=True, eq=False)
class CheckedBound(Bound):
    """A bound that another one answers for."""

    of: Constraint
    given: Bound

    @property
    def only_equal(self) -> bool:  # type: ignore[override]
        """Of the given one."""
        return bool(self.given.only_equal)

    def settled(self, cage: FloatArray, successor: IntArray) -> FloatArray:
        """Finite numbers."""
        found = _numbers(self.of, "settled", lambda: self.given.settled(_sealed(cage), successor), cage.shape)
        if not np.isfinite(found).all():
            raise _wrong(self.of, "settled", "must return finite numbers")
        return found.copy()

    def eliminated(self, images: Elimination | None, successor: IntArray) -> Elimination | None:
        """None, or an elimination."""
        found = _asked(self.of, "eliminated", self.given.eliminated, images, successor)
        return found if found is None else _instance(self.of, "eliminated", Elimination, lambda: found)

    def rows(self, cage: FloatArray, radius: float) -> Iterator[Terms]:
        """Finite numbers, for vertices that there are."""
        for found in _asked(self.of, "rows", lambda: list(self.given.rows(_sealed(cage), radius))):
            try:
                rows, rooms = Terms(*found)
                vertex, weight, direction, room = map(np.asarray, (rows.vertex, rows.weight, rows.direction, rooms))
                sound = all((np.abs(each.astype(np.float64)) < LARGEST).all() for each in (weight, direction, room))
            except (TypeError, ValueError, AttributeError):
                raise _wrong(self.of, "rows", "must yield Terms(Rows(vertex, weight, direction), room)") from None
            shapes = vertex.ndim == 2 and weight.shape == vertex.shape and room.shape == vertex.shape[1:]
            if not shapes or direction.shape not in ((2, len(room)), (len(vertex), 2, len(room))):
                raise _wrong(
                    self.of,
                    "rows",
                    "must yield vertices and weights (k, K), directions (2, K) or (k, 2, K), and rooms (K,), not "
                    f"{vertex.shape}, {weight.shape}, {direction.shape} and {room.shape}",
                )
            if vertex.dtype.kind not in "iu" or (vertex.size and not 0 <= vertex.min() <= vertex.max() < len(cage)):
                raise _wrong(self.of, "rows", f"must be about vertices from 0 to {len(cage) - 1}")
            ordered = np.sort(vertex, axis=0)
            if (ordered[1:] == ordered[:-1]).any():
                raise _wrong(self.of, "rows", "must be about different vertices in each row")
            if not sound:
                raise _wrong(self.of, "rows", f"must yield finite numbers, below {LARGEST:g}")
            yield Terms(
                Rows(vertex.astype(np.int64), weight.astype(np.float64), direction.astype(np.float64)),
                room.astype(np.float64),
            )

    def allowed(self, vertex: IntArray, start: FloatArray, end: FloatArray) -> BoolArray:
        """Whether each edge may run so."""
        allowed = _numbers(self.of, "allowed", lambda: self.given.allowed(vertex, start, end), (len(vertex),))
        return np.asarray(allowed != 0.0)

    def short(self, cage: FloatArray) -> FloatArray:
        """Finite lengths of at least 0."""
        lack = _numbers(self.of, "short", lambda: self.given.short(_sealed(cage)), (len(cage),))
        if not ((lack >= 0.0) & (lack < np.inf)).all():
            raise _wrong(self.of, "short", "must return finite lengths of at least 0")
        return lack


def checked(constraint: Constraint) -> Constraint:
    """The constraint, looked at if it is not one of the package."""
    ours = type(constraint).__module__.startswith(__package__)
    return constraint if ours else Checked(constraint)


def _sealed(cage: FloatArray) -> FloatArray:
    """The same numbers, which can't be written."""
    view = cage.view()
    view.flags.writeable = False
    return view


def _asked(constraint: Constraint, method: str, ask: Any, *arguments: object) -> Any:
    """The answer of a method. Raises NestedCagesError if it fails; its own errors pass."""
    try:
        return ask(*arguments)
    except NestedCagesError:
        raise
    except Exception as error:
        raise _wrong(constraint, method, f"failed with {type(error).__name__}: {error}") from error


def _instance(constraint: Constraint, method: str, kind: type[Answer], ask: Any, *arguments: object) -> Answer:
    """The answer of a method, of a class. Raises NestedCagesError."""
    found = _asked(constraint, method, ask, *arguments)
    if not isinstance(found, kind):
        raise _wrong(constraint, method, f"must return a {kind.__name__}, not {found!r}")
    return found


def _numbers(constraint: Constraint, method: str, ask: Any, shape: tuple[int, ...]) -> FloatArray:
    """The answer of a method as numbers, none of them NaN, of a shape. Raises NestedCagesError."""
    found = _asked(constraint, method, ask)
    try:
        numbers = np.asarray(found, np.float64)
    except (TypeError, ValueError):
        raise _wrong(constraint, method, f"must return numbers, not {found!r}") from None
    if numbers.shape != shape:
        raise _wrong(constraint, method, f"must return numbers of the shape {shape}, not {numbers.shape}")
    if np.isnan(numbers).any():
        raise _wrong(constraint, method, "must not return NaN")
    return numbers


def _wrong(constraint: Constraint, method: str, what: str) -> NestedCagesError:
    """The error; no other attempt is made after it."""
    name = type(constraint).__name__
    return NestedCagesError(f"{name}.{method} {what}.", code="constraint.failed", name=name, method=method)
