"""What a level tries, in which order, and what is left out; no cage is computed here but where it says so."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
import pytest

from nestedcages_core import (
    IPC,
    ArcLength,
    InitialDisplacement,
    LineCycles,
    Mesh,
    NestingError,
    OuterHull,
    SequentialQP,
    Settings,
    TwoSidedFlow,
    nested_cages,
    verify,
)
from nestedcages_core.decimation import Start
from nestedcages_core.geometry.precision import INPUT_ROUND_OFF
from nestedcages_core.level.attempts import (
    MAX_CLEARANCE,
    TIGHTENED_HULL,
    Attempt,
    attempts,
    clearances_for,
    contacts_for,
    in_turn,
)
from nestedcages_core.published.gurditta_jacobson_2022 import SignedDistanceFlow
from support.shapes import annulus, ring

CLEARANCES = (1e-3, 1e-4)


def tried(settings: Settings, wanted: int | Mesh, fine: Mesh | None = None) -> list[Attempt]:
    return list(attempts(settings, annulus(24) if fine is None else fine, wanted, CLEARANCES))


def kinds(found: list[Attempt]) -> list[tuple[str, bool]]:
    """Source, and whether it is a fallback."""
    return [(type(attempt.source).__name__, attempt.fallback) for attempt in found]


class TestOrder:
    def test_line_cycles_are_followed_by_the_hull(self) -> None:
        assert kinds(tried(Settings(), 12)) == [("LineCycles", False), ("OuterHull", True)]

    def test_another_decimation_is_followed_by_the_fallback(self) -> None:
        found = tried(Settings(decimation=ArcLength()), 12)
        assert kinds(found) == [("ArcLength", False), ("OuterHull", True)]
        assert [attempt.count for attempt in found] == [12, 12]

    def test_a_fallback_that_is_the_decimation_is_left_out(self) -> None:
        assert kinds(tried(Settings(decimation=OuterHull()), 12)) == [("OuterHull", False)]

    def test_without_a_fallback_nothing_else_is_tried(self) -> None:
        found = tried(Settings(decimation=ArcLength(), fallback=None), 12)
        assert kinds(found) == [("ArcLength", False)]
        assert not any(attempt.may_fall_back for attempt in found)

    def test_all_have_the_same_clearances(self) -> None:
        for settings in (Settings(), Settings(decimation=ArcLength())):
            assert {attempt.clearances for attempt in tried(settings, 12)} == {CLEARANCES}


class TestOwnMeshes:
    def test_they_are_tried_once_then_the_fallback_with_as_many_vertices_per_loop(self) -> None:
        own = Mesh.from_loops([ring(9, 1.2), 0.4 * ring(4)])
        found = tried(Settings(), own)
        assert [attempt.source for attempt in found] == [own, LineCycles(on_curve=False), OuterHull()]
        assert found[0].flow == TwoSidedFlow()
        assert list(found[1].count) == [9, 4]  # type: ignore[arg-type]

    def test_without_a_fallback_they_are_the_only_attempt(self) -> None:
        own = Mesh.from_loops([ring(9, 1.2), 0.4 * ring(4)])
        assert [attempt.source for attempt in tried(Settings(fallback=None), own)] == [own]

    def test_other_loops_give_the_fallback_their_total_and_at_least_triangles(self) -> None:
        assert tried(Settings(), Mesh.from_loops([ring(9, 1.2)]))[1].count == 9
        assert tried(Settings(), Mesh.from_loops([ring(4, 1.5)]))[1].count == 6

    def test_loops_that_do_not_match_give_their_total_too(self) -> None:
        aside = Mesh.from_loops([ring(9, 1.2) + 50.0, 0.4 * ring(4) + 50.0])
        assert tried(Settings(), aside)[1].count == 13


class TestFlowAndContact:
    def test_where_hulls_compete_the_flow_is_given_up_early(self) -> None:
        quick, hull = tried(Settings(fallback=OuterHull()), 12)
        assert isinstance(quick.flow, TwoSidedFlow)
        assert quick.flow.limit < TwoSidedFlow().limit
        assert quick.contacts == (SequentialQP(),) and hull.flow == quick.flow

    def test_of_other_coarse_meshes_and_without_a_fallback_it_is_as_it_was_chosen(self) -> None:
        for settings in (Settings(decimation=ArcLength()), Settings(fallback=None)):
            first = tried(settings, 12)[0]
            assert first.flow == TwoSidedFlow() and first.contacts == (SequentialQP(),)

    def test_from_own_meshes_there_is_a_second_contact(self) -> None:
        first = tried(Settings(), Mesh.from_loops([ring(9, 1.2), 0.4 * ring(4)]))[0]
        assert first.flow == TwoSidedFlow() and len(first.contacts) == 2
        assert first.contacts[0] == SequentialQP()

    def test_a_chosen_flow_and_contact_are_not_changed(self) -> None:
        contacts = (SequentialQP(), IPC())
        first = tried(Settings(flow=SignedDistanceFlow(), contact=contacts), 12)[0]
        assert first.flow == SignedDistanceFlow() and first.contacts == contacts

    def test_ipc_backs_sequential_programs(self) -> None:
        first, second = contacts_for(Settings(energy=InitialDisplacement()), own=True)
        assert first == SequentialQP()
        assert second == IPC(energy=InitialDisplacement())

    def test_a_single_contact_is_the_only_one(self) -> None:
        assert contacts_for(Settings(contact=SequentialQP())) == (SequentialQP(),)


class TestClearances:
    def test_only_the_default_one_is_reduced(self) -> None:
        fine = annulus(24)
        assert clearances_for(Settings(clearance=0.01), fine) == (0.01,)
        reduced = clearances_for(Settings(), fine)
        assert reduced[0] == pytest.approx(1e-5 * fine.diagonal)
        assert np.array(reduced[:-1]) == pytest.approx(10.0 * np.array(reduced[1:]))
        assert reduced[-1] >= 0.99 * INPUT_ROUND_OFF * fine.diagonal

    def test_one_that_leaves_nothing_of_the_shape_is_rejected(self) -> None:
        fine = annulus(24)
        with pytest.raises(NestingError, match="ask for less"):
            clearances_for(Settings(clearance=1.01 * MAX_CLEARANCE * fine.diagonal), fine)


def starts_for(*, on_curve: bool) -> tuple[list[Start], Mesh]:
    fine = annulus(24)
    hulls = [Mesh.from_loops([ring(6, 1.3 + 0.1 * k), 0.3 * ring(3)]) for k in range(3)]
    curve = Mesh.from_loops([ring(6), 0.5 * ring(3)])
    return [Start(hull, "outer hull", curve if on_curve and k == 0 else None) for k, hull in enumerate(hulls)], fine


def ran(starts: list[Start], fine: Mesh, ranks: list[float], **options: Any) -> list[str]:
    """The starts that are tried if they have these ranks, by name and number."""
    attempt = Attempt(LineCycles(), 9, TwoSidedFlow(), (SequentialQP(),), CLEARANCES, **options)
    turn = in_turn(starts, fine, attempt)
    names, start = [], next(turn)
    while True:
        number = next((k for k, one in enumerate(starts) if one.coarse is start.coarse), None)
        names.append(f"{start.source} {number}")
        rank = ranks[len(names) - 1] if len(names) <= len(ranks) else inf
        try:
            start = turn.send(rank)
        except StopIteration:
            return names


CURVE, HULLS = "on the curve None", ["outer hull 0", "outer hull 1", "outer hull 2"]


class TestInTurn:
    @pytest.mark.parametrize(
        ("on_curve", "ranks", "options", "names"),
        [
            (False, [0.3, 0.2, 0.1], {}, HULLS),
            (True, [0.1, 0.3, 0.2], {}, [CURVE, *HULLS[1:]]),  # the best one on the curve stands for its hull
            (True, [inf, inf, inf, inf], {}, [CURVE, *HULLS]),  # where it fails, its hull is tried too
            (True, [inf], {"may_fall_back": False}, [CURVE]),
        ],
    )
    def test_starts_are_tried_one_after_the_other(
        self, on_curve: bool, ranks: list[float], options: dict[str, bool], names: list[str]
    ) -> None:
        assert ran(*starts_for(on_curve=on_curve), ranks, **options) == names

    @pytest.mark.parametrize(("source", "most"), [("outer hull", TIGHTENED_HULL), ("line cycles", 1.0)])
    def test_a_single_start_is_tried_itself_where_its_cage_is_probably_tighter(self, source: str, most: float) -> None:
        starts, fine = starts_for(on_curve=True)
        start, bound = starts[0]._replace(source=source), starts[0].coarse.area / fine.area - 1.0
        for share, names in ((0.95 * most, [CURVE]), (1.05 * most, [CURVE, f"{source} 0"])):
            assert ran([start], fine, [share * bound, inf], seeks_area=True) == names
            assert ran([start], fine, [share * bound, inf]) == names[:1]


@dataclass(frozen=True)
class Failing:
    """A decimation that never succeeds."""

    def decimate(self, fine: Mesh, count: Any, *, clearance: float = 0.0) -> Mesh:
        raise NestingError("This decimation makes nothing.")


class TestRun:
    """Attempts as a run makes them."""

    def test_the_report_says_what_was_used_instead(self) -> None:
        level = nested_cages(annulus(24), [12], Settings(decimation=Failing())).levels[0]
        assert level.report.start == "outer hull"
        assert any("This decimation makes nothing." in note for note in level.report.notes)

    def test_without_a_fallback_its_error_is_raised(self) -> None:
        with pytest.raises(NestingError, match="This decimation makes nothing"):
            nested_cages(annulus(24), [12], Settings(decimation=Failing(), fallback=None))


@pytest.mark.slow
def test_a_loose_cage_from_an_own_mesh_is_compared_with_that_of_the_other_contact() -> None:
    random = np.random.default_rng(30)  # needles of different lengths: the contacts end in different minima
    length = np.where(np.arange(24) % 3 == 0, random.uniform(0.6, 1.0, 24), 0.1)
    fine = Mesh.from_loops([ring(24) * length[:, None]])
    own = Mesh.from_loops([0.45 * ring(13) + random.uniform(-0.05, 0.05, 2)])
    first, second, kept = (
        nested_cages(fine, [own], **options).levels[0]
        for options in ({"contact": SequentialQP()}, {"contact": IPC()}, {})
    )
    assert abs(first.report.excess - second.report.excess) > 0.1
    assert kept.report.excess == pytest.approx(min(first.report.excess, second.report.excess), rel=1e-3)
    assert verify(kept.cage, fine, kept.report.clearance)
