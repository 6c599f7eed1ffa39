"""Constraints written elsewhere: what is broken ends in a sentence, and what is sound is kept wherever cages are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from nestedcages_core import Mesh, NestedCagesError, Within, animated_cages, inner_cages, nested_cages, verify
from nestedcages_core.constraints import Bound, Box, Constraint, Rows, Terms, Units
from nestedcages_core.decimation.line_cycles.chain import Lines
from nestedcages_core.errors import Fault
from nestedcages_core.geometry.arrays import FloatArray, IntArray
from support.shapes import ring, star


class Odd(Constraint):
    """Keeps nothing, but for what a test puts in."""

    def rows(self, cage: FloatArray) -> Any:
        return ()

    def short(self, cage: FloatArray) -> Any:
        return np.zeros(len(cage))

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        return OddBound(self)


class OddBound(Bound):
    def __init__(self, of: Odd) -> None:
        self.of = of

    def rows(self, cage: FloatArray, radius: float) -> Any:
        return self.of.rows(cage)

    def short(self, cage: FloatArray) -> Any:
        return self.of.short(cage)


def odd(**methods: Any) -> Constraint:
    made: Constraint = type("Odd", (Odd,), methods)()
    return made


def terms(**other: Any) -> Callable[..., list[Terms]]:
    """Rows of three vertices, one of whose arrays is another."""
    parts = {"vertex": np.arange(3)[None], "weight": np.ones((1, 3)), "direction": np.ones((2, 3)), **other}
    room = parts.pop("room", np.ones(3))
    return lambda *_: [Terms(Rows(**parts), room)]


def answer(value: Any) -> Callable[..., Any]:
    return lambda *_: value


def fails(*_: Any) -> Any:
    raise ZeroDivisionError("division by zero")


BROKEN = [
    ("rows", fails, "failed with ZeroDivisionError: division by zero"),
    ("rows", answer(None), "failed with TypeError"),
    ("rows", answer(["x"]), "must yield Terms"),
    ("rows", terms(room=np.full(3, np.nan)), "must yield finite numbers"),
    ("rows", terms(direction=np.full((2, 3), 1e300)), "must yield finite numbers"),
    ("rows", terms(direction=np.ones((2, 4))), r"not \(1, 3\), \(1, 3\), \(2, 4\) and \(3,\)"),
    ("rows", terms(vertex=np.full((1, 3), 99)), "must be about vertices from 0 to 11"),
    ("rows", terms(vertex=np.ones((1, 3))), "must be about vertices from 0 to 11"),
    ("rows", terms(vertex=np.ones((2, 3), int), weight=np.ones((2, 3))), "different vertices in each row"),
    ("rows", lambda _, cage: cage.__setitem__(0, 9.0), "failed with ValueError: assignment destination is read-only"),
    ("short", answer(np.full(12, np.nan)), "must not return NaN"),
    ("short", answer(np.full(12, -1.0)), "lengths of at least 0"),
    ("short", answer(np.zeros(5)), r"the shape \(12,\), not \(5,\)"),
    ("free", answer(None), "must return numbers of the shape"),
    ("free", answer("far"), "must return numbers, not 'far'"),
    ("count", answer(2), "a whole number from 3 to 80, not 2"),
    ("count", lambda _, outline, count: count + 1, "a whole number from 3 to 80, not 81"),
    ("count", answer(8.5), "a whole number"),
    ("distances", answer(np.array([-1.0])), "finite lengths of at least 0"),
    ("distances", answer(np.ones(4)), r"the shape \(1,\)"),
    ("turn_limits", (np.nan, 0.0), "must not return NaN"),
    ("turn_limits", (-1.0, 0.0), "a finite length and an angle"),
    ("candidates", lambda _, chain, at, lines, *rest: lines.take(at[:0]), "must return some lines"),
    (
        "candidates",
        lambda _, chain, at, all_, *rest: Lines.of(all_.point, all_.place - 1e3, all_.direction),
        "places from 0",
    ),
    ("reach", answer(np.zeros(3)), "must return numbers of the shape"),
    ("started", answer(None), "must return a Mesh, not None"),
    ("restored", lambda _, coarse, steps: steps * np.nan, "must not return NaN"),
    ("started", answer(star(5, 14)), "must keep the edges"),
    ("bound", answer(None), "must return a Bound, not None"),
    ("term", answer(1.0), "must return an energy or None"),
    ("outline", answer(None), "must return a Outline"),
    ("of", answer(None), "must return a Constraint"),
    ("of", fails, "failed with ZeroDivisionError"),
    ("mended", lambda _, cage: cage, "must return a Mesh with a Fault, or None"),
    ("fault", fails, "failed with ZeroDivisionError"),
    ("fault", answer(True), "must return a Fault, a sentence, or None, not True"),
]


@pytest.mark.parametrize(("method", "wrong", "said"), BROKEN, ids=[f"{k}-{row[0]}" for k, row in enumerate(BROKEN)])
def test_what_a_broken_constraint_answers_is_told(method: str, wrong: Any, said: str) -> None:
    coarse = Mesh.from_loops([2.0 * star(3, 12).vertices])
    wanted: Any = coarse if method == "mended" else 12
    kept = {"grid": 0.02} if method == "mended" else {}
    with pytest.raises(NestedCagesError, match=rf"Odd\.{method} .*{said}") as caught:
        nested_cages(star(5, 80), wanted, constraints=[odd(**{method: wrong})], **kept)
    assert caught.value.code == "constraint.failed" and caught.value.data["method"] == method


@pytest.mark.slow
@pytest.mark.parametrize("made", [
    lambda *kept: nested_cages(star(5, 80), 12, constraints=kept)[0].report,
    lambda *kept: inner_cages(star(5, 80), 12, constraints=kept)[0].report,
    lambda *kept: animated_cages(star(5, 80), [star(5, 80).vertices] * 2, 12, constraints=kept).levels[0].report,
])  # fmt: skip
def test_what_is_never_kept_is_an_error_in_its_own_words_or_a_note(made: Callable[..., Any]) -> None:
    for never, code in (("Never.", "constraint.missed"), (Fault("Never.", "never", place=(1, 2)), "never")):
        with pytest.raises(NestedCagesError, match=r"Never\.") as caught:
            made(odd(fault=answer(never)))
        assert caught.value.code == code
    hopeless = terms(direction=np.zeros((2, 3)), room=np.full(3, -1.0))
    assert made(odd(rows=hopeless, short=lambda _, cage: np.ones(len(cage)))).notes == ()


def test_a_wish_that_is_missed_is_a_note() -> None:
    level = nested_cages(star(), 12, constraints=[odd(fault=answer("Never."), must=False)])[0]
    assert level.report.notes == ("Never.",) and level.report.notes[0].code == "constraint.missed"


def test_distances_of_loops_are_judged_without_a_judge() -> None:
    level = nested_cages(star(), 12, constraints=[odd(distances=answer(np.array([0.05])))])[0]
    assert verify(level.cage, star(), 0.05)


@pytest.mark.parametrize("wrong", [Box, object(), 3])
def test_what_is_no_constraint_is_told_at_once(wrong: Any) -> None:
    with pytest.raises(NestedCagesError, match="of a class derived from Constraint"):
        nested_cages(star(), 12, constraints=[wrong])


@dataclass(frozen=True)
class LongestEdge(Constraint):
    """No edge is longer than a length: rows of two vertices, and no help for the start."""

    length: float

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        return BoundLongest(coarse.successor, self.length / units.scale * (1.0 - 1e-9))

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        longest = float(cage.edge_lengths.max())
        return None if longest <= self.length else Fault(f"An edge is {longest:.4g} long.", "edge.long")


@dataclass(frozen=True, eq=False)
class BoundLongest(Bound):
    successor: IntArray
    most: float

    def rows(self, cage: FloatArray, radius: float) -> Iterator[Terms]:
        edge = cage[self.successor] - cage
        length = np.hypot(*edge.T)
        near = np.flatnonzero(self.most - length < 3.0 * radius)
        pair, weight = np.stack((near, self.successor[near])), np.tile([[1.0], [-1.0]], len(near))
        yield Terms(Rows(pair, weight, (edge[near] / length[near, None]).T), (self.most - length)[near])

    def short(self, cage: FloatArray) -> FloatArray:
        lack = np.maximum(np.hypot(*(cage[self.successor] - cage).T) - self.most, 0.0)
        both = lack.copy()
        np.maximum.at(both, self.successor, lack)
        return both


@pytest.mark.slow
def test_a_constraint_written_elsewhere_is_kept_by_all_kinds_of_cages() -> None:
    fine, kept = star(5, 80), LongestEdge(0.7)
    free = nested_cages(fine, 16)[0].cage.edge_lengths.max()
    assert free > kept.length
    levels = [
        *nested_cages(fine, 16, constraints=[kept]),
        *nested_cages(fine, 20, constraints=[kept, Box((-1.6, -1.6), (1.6, 1.6))]),
        *nested_cages(fine, Within(excess=0.5), constraints=[kept]),
        *inner_cages(fine, 16, constraints=[kept]),
    ]
    poses = [fine.vertices * (1.0, 1.0 + 0.02 * k) for k in range(3)]
    moving = animated_cages(fine, poses, 20, constraints=[kept]).levels[0]
    for cage in (*(level.cage for level in levels), *map(moving.cage.moved, moving.cage_steps)):
        assert cage.edge_lengths.max() <= kept.length


def test_a_constraint_written_elsewhere_lets_loops_be_joined() -> None:
    fine = Mesh.from_loops([ring(40), np.array([2.2, 0.0]) + ring(40), 0.3 * ring(20)])
    for count in (8, 30):
        level = nested_cages(fine, count, constraints=[LongestEdge(4.0)])[0]
        assert len(level.cage.vertices) <= count and verify(level.cage, fine, same_loops=False)
        assert level.cage.edge_lengths.max() <= 4.0


@pytest.mark.slow
def test_on_a_grid_the_sentence_is_that_of_the_constraint() -> None:
    with pytest.raises(NestedCagesError, match=r"On the grid of 0\.1: An edge is .* long\.") as caught:
        nested_cages(star(5, 80), 16, constraints=[LongestEdge(0.7)], grid=0.1)
    assert caught.value.code == "edge.long"
