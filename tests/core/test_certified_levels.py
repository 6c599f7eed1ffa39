"""What is handed out is certified: a user's own methods do something wrong, and an error or a right level comes out."""

from collections.abc import Callable
from itertools import groupby
from typing import Any

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import Mesh, NestingError, Settings, Within, animated_cages, check, inner_cages, nested_cages
from support.judging import assert_right, codes, rejected
from support.marks import slow_after
from support.methods import Continued, Detouring, Elsewhere, GivingUp, Misleading, Moved, Offering, Pretending, Refusing
from support.shapes import annulus, letter_a, letter_a_coarse, ring, star, turned

pytestmark = pytest.mark.slow

FINE = star(5, 40)
OWN = Mesh.from_loops([ring(10, 1.2)])
"""A coarse mesh that the flow gets into."""


STEPS: dict[str, tuple[Callable[[np.ndarray], list[np.ndarray]], str]] = {
    "a part of the shape is left out": (lambda cage: [cage * [0.5, 2.0]], "certificate.failed"),
    "it lies elsewhere": (lambda cage: [cage + 3.0], "certificate.failed"),
    "it is turned": (lambda cage: [turned(cage, 0.6)], "certificate.failed"),
    "it crosses itself": (lambda cage: [cage[np.r_[1, 0, 2 : len(cage)]]], "certificate.failed"),
    "it is no number": (lambda cage: [cage * np.nan], "certificate.failed"),
    "there and back through the shape": (lambda cage: [np.roll(cage, len(cage) // 2, axis=0), cage], "motion.collides"),
}
"""What a tightening ends with, and the code of the error where nothing else is left to try."""

NEEDS: dict[str, tuple[Any, dict[str, Any]]] = {
    "around": (nested_cages, {}),
    "on a grid": (nested_cages, {"grid": 0.05}),
    "inside": (inner_cages, {}),
    "stored": (nested_cages, {"stored": np.float16}),
    "convex": (nested_cages, {"convex": True}),
    "inside, on a grid": (inner_cages, {"grid": 0.05}),
    "inside, stored": (inner_cages, {"stored": np.float16}),
}


@pytest.mark.parametrize(("work", "needs"), slow_after(3, NEEDS.values(), thorough_after=5), ids=NEEDS.keys())
@pytest.mark.parametrize(("further", "code"), STEPS.values(), ids=STEPS.keys())
def test_a_cage_that_its_tightening_spoils_is_not_handed_out(
    further: Any, code: str, work: Any, needs: dict[str, Any]
) -> None:
    spoiling = Settings(tightening=Continued(further=further), clearance=1e-3, **needs)
    try:
        (level,) = work(FINE, 10, spoiling)
    except NestingError as error:
        assert error.code == code
    else:
        assert_right(level)


def test_a_cage_that_its_tightening_only_loosens_is_a_cage() -> None:
    (level,) = nested_cages(FINE, 10, tightening=Continued(further=lambda cage: [2.0 * cage]))
    assert_right(level)
    assert level.excess > 3.0


def test_a_cage_nearer_than_asked_for_is_not_handed_out() -> None:
    near = Settings(tightening=Continued(share=0.5), clearance=0.02)
    with rejected("clearance.no_room", NestingError) as caught:
        nested_cages(FINE, 10, near)
    assert caught.value.data["largest"] == pytest.approx(0.01, rel=1e-2)


def test_where_no_clearance_is_asked_for_a_cage_is_tightened_again_at_each_smaller_one() -> None:
    tightening = Continued(share=0.5)
    (level,) = nested_cages(letter_a(), [letter_a_coarse()], tightening=tightening, fallback=None)
    assert_right(level)
    assert len(tightening.asked) > 1
    assert np.array(tightening.asked[:-1]) == pytest.approx(10.0 * np.array(tightening.asked[1:]), rel=1e-5)
    (note,) = level.report.notes
    assert (note.code, note.data["given"]) == ("note.clearance", level.report.wanted_clearance)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda x, m: np.concatenate([x[:m] + 9.0, x[m:]]), "certificate.failed"),
        (lambda x, m: np.concatenate([np.roll(x[:m], 5, axis=0), x[m:]]), "motion.collides"),
        (lambda x, m: x * np.nan, "solver.not_finite"),
    ],
    ids=["the cage lies elsewhere", "the cage jumps", "nothing is a number"],
)
def test_a_contact_that_loses_the_cage_is_found_out(change: Any, code: str) -> None:
    with rejected(code):
        nested_cages(FINE, OWN, contact=Elsewhere(change=change), fallback=None)


@pytest.mark.parametrize("factor", [0.9, 9.0])
def test_a_contact_that_loses_the_shape_does_not_move_it(factor: float) -> None:
    lost = Elsewhere(change=lambda x, m: np.concatenate([x[:m], factor * x[m:]]))
    try:
        assert_right(nested_cages(FINE, OWN, contact=lost, fallback=None)[0])
    except NestingError as error:
        assert error.code in ("motion.collides", "certificate.failed")


def test_a_contact_that_gives_up_leads_to_the_next_and_then_to_the_fallback() -> None:
    with rejected("reinflation.blocked", core.ReinflationError):
        nested_cages(FINE, OWN, contact=GivingUp(), fallback=None)
    for contact, notes in ([GivingUp(), Elsewhere()], []), (GivingUp(), ["note.start"]):
        (level,) = nested_cages(FINE, OWN, contact=contact)
        assert_right(level)
        assert codes(level) == notes
    elsewhere = Offering((Mesh.from_loops([ring(10) + 9.0]),))
    (level,) = nested_cages(FINE, 10, decimation=elsewhere, contact=GivingUp(), fallback=core.LineCycles())
    assert level.report.start == "line cycles"  # as it is, where the one on the curve is given up


FLOWS: dict[str, tuple[Callable[[np.ndarray], np.ndarray], str | None]] = {
    "it stops before it is inside": (lambda steps: steps[:1], "reinflation.blocked"),
    "it ends outside": (lambda steps: np.concatenate([steps[:-1], 3.0 * steps[-1:]]), "certificate.failed"),
    "it begins elsewhere": (lambda steps: 1.1 * steps, "reinflation.blocked"),
    "it is no number": (lambda steps: steps * np.nan, "solver.not_finite"),
    "it leaves steps out": (lambda steps: steps[[0, -1]], None),
}


@pytest.mark.parametrize(("change", "code"), FLOWS.values(), ids=FLOWS.keys())
def test_a_flow_that_is_not_one_is_found_out(change: Any, code: str | None) -> None:
    pretending, coarse = Pretending(change=change), Mesh.from_loops([ring(10, 0.9)])
    if code is None:
        assert_right(nested_cages(FINE, coarse, flow=pretending, fallback=None)[0])
        return
    with rejected(code):
        nested_cages(FINE, coarse, flow=pretending, fallback=None)
    if code != "solver.not_finite":
        assert_right(nested_cages(FINE, coarse, flow=pretending)[0])


MESHES: dict[str, tuple[Mesh, str | None]] = {
    "inside": (Mesh.from_loops([ring(10, 0.2)]), None),
    "across": (Mesh.from_loops([ring(10)]), None),
    "around, walked the other way": (Mesh.from_loops([ring(10, 1.5)[::-1]]), None),
    "elsewhere": (Mesh.from_loops([ring(10) + 9.0]), "flow.loops_differ"),
    "other loops": (annulus(5, 0.1), "flow.loops_differ"),
    "crossing itself": (OWN.moved(np.random.default_rng(0).normal(size=(10, 2))), "flow.stuck"),
}


@pytest.mark.parametrize(("coarse", "code"), MESHES.values(), ids=MESHES.keys())
def test_whatever_a_decimation_offers_the_cage_is_certified(coarse: Mesh, code: str | None) -> None:
    (level,) = nested_cages(FINE, 10, decimation=Offering((coarse,)))
    assert_right(level)
    if code is None:
        assert_right(nested_cages(FINE, 10, decimation=Offering((coarse,)), fallback=None)[0])
        return
    assert level.report.start == "line cycles"
    with rejected(code):
        nested_cages(FINE, 10, decimation=Offering((coarse,)), fallback=None)


@pytest.mark.parametrize("factor", [-1.0, 0.0])
def test_an_energy_with_wrong_derivatives_makes_loose_cages(factor: float) -> None:
    (level,) = nested_cages(FINE, 10, energy=Misleading(factor))
    assert_right(level)


def test_an_energy_that_is_no_number_is_found_out() -> None:
    with rejected("solver.not_finite"):
        nested_cages(FINE, 10, energy=Misleading(np.nan))


@pytest.mark.parametrize("needs", [{}, {"grid": 0.05}, {"stored": np.float32}], ids=str)
def test_a_constraint_has_the_last_word(needs: dict[str, Any]) -> None:
    with rejected("constraint.missed", NestingError):
        nested_cages(FINE, 10, constraints=[Refusing()], **needs)
    (level,) = nested_cages(FINE, 10, constraints=[Refusing(must=False)], **needs)
    assert_right(level)
    assert codes(level) == ["constraint.missed"]


@pytest.mark.parametrize("symmetry", [core.Mirror(), core.Rotation(None, 5)])
def test_a_constraint_may_not_take_the_symmetry(symmetry: Any) -> None:
    with rejected("symmetry.missed", NestingError):
        nested_cages(FINE, 10, constraints=[Moved()], symmetry=symmetry, fallback=None)


def test_the_way_is_certified_and_not_the_cage_alone() -> None:
    with rejected("motion.collides", NestingError):
        nested_cages(letter_a(), [letter_a_coarse()], tightening=Detouring(), fallback=None)


@pytest.mark.parametrize("name, limit", [("distance", 0.1), ("excess", 0.21)])
def test_what_a_square_around_a_square_takes_of_a_tolerance_is_known(name: str, limit: float) -> None:
    """From corner to corner, and of the areas."""
    fine, cage = (Mesh.from_loops([size * ring(4)]) for size in (1.0, 1.1))
    for share, met in ((1.005, True), (0.995, False)):
        tolerance = Within(**{name: share * limit})
        assert tolerance.is_met(cage, fine) == met
        assert tolerance.measured(cage, fine) == pytest.approx(limit, rel=2e-4)


def test_an_excess_that_a_cage_just_has_needs_no_further_vertex() -> None:
    excess = nested_cages(FINE, 8)[0].excess
    for share, count in ((1.005, 8), (0.995, 9)):
        assert len(nested_cages(FINE, Within(excess=share * excess))[0].vertices) == count


@pytest.mark.parametrize(("share", "count"), [(1.005, 6), (0.996, 7)])
def test_a_distance_that_a_cage_just_has_needs_no_further_vertex(share: float, count: int) -> None:
    """A hexagon around a disc of radius 1 reaches 1 / cos 30° - 1 farther."""
    distance = share * (1.0 / np.cos(np.pi / 6.0) - 1.0)
    hierarchy = nested_cages(ring(400), Within(distance=distance))
    assert len(hierarchy[0].vertices) == count
    assert check(ring(400), hierarchy, distance=distance)


def test_a_step_that_leaves_the_drawing_is_no_cage() -> None:
    fine = star()
    (cage,) = nested_cages(fine, [12]).cages
    after = fine.moved(1.1 * fine.vertices)
    assert core.verify(core.followed(cage, fine, after, 0.01), after, 0.01)
    for spoiling in (Continued(further=lambda step: [step + 3.0]), Continued(share=0.5)):
        assert core.followed(cage, fine, after, 0.01, Settings(tightening=spoiling)) is None


def waving(fine: Mesh, frames: int = 4) -> np.ndarray:
    phases = np.linspace(0.0, 2.0 * np.pi, frames)
    shifts = [np.sin(phase + 4.0 * fine.vertices[:, ::-1] / fine.diagonal) for phase in phases]
    return np.array([fine.vertices + 0.05 * fine.diagonal * shift for shift in shifts])


@pytest.mark.parametrize("first", slow_after(2, [1, 6, 10]))
def test_keys_nearer_than_asked_for_are_refused(first: int) -> None:
    poses = waving(FINE)
    near = Continued(share=0.1, first=first)
    with rejected("certificate.failed", NestingError) as caught:
        animated_cages(FINE, poses, 10, clearance=2e-2, tightening=near)
    assert [problem.code for problem in caught.value.data["problems"]] == ["cage.too_close"]
    for level in caught.value.partial.levels:
        assert len(level.times) == caught.value.data["pose"]
        for cage, pose in zip(level.cage_steps, level.fine_steps, strict=True):
            assert core.verify(level.cage.moved(cage), FINE.moved(pose), 2e-2)


@pytest.mark.parametrize("further", slow_after(1, [STEPS["it lies elsewhere"][0], lambda cage: [0.5 * cage]]))
@pytest.mark.parametrize("first", slow_after(1, [2, 6]))
def test_keys_that_leave_the_drawing_are_made_anew_or_refused(further: Any, first: int) -> None:
    poses = waving(FINE)
    spoiling = Continued(further=further, first=first)
    try:
        moving = animated_cages(FINE, poses, 10, tightening=spoiling)
    except NestingError as error:
        assert error.code == "certificate.failed" and len(spoiling.asked) > first
        return
    assert check(FINE, moving)
    assert np.array_equal(moving.levels[0].fine_steps[moving.levels[0].report.given], poses)


def bump(count: int, height: float) -> tuple[Mesh, np.ndarray]:
    """A bump that jumps around a circle: between the poses the drawing cuts through cages of both."""
    angle = 2.0 * np.pi * np.arange(60) / 60
    away = (angle - 2.0 * np.arange(count)[:, None] + np.pi) % (2.0 * np.pi) - np.pi
    poses = (1.0 + height * np.exp(-((away / 0.35) ** 2)))[:, :, None] * ring(60)
    return Mesh.from_loops([poses[0]]), poses


@pytest.mark.parametrize(("jump", "count"), slow_after(1, [(bump(3, 0.6), 10), (bump(5, 1.4), 16)]))
def test_keys_that_a_jump_pushes_apart_stay_certified_on_both_sides(jump: tuple[Mesh, np.ndarray], count: int) -> None:
    """A push makes an interval free, and may spoil that before it."""
    fine, poses = jump
    moving = animated_cages(fine, poses, count, clearance=1e-3)
    (level,) = moving.levels
    assert core.verify_motion(level.cage, fine, level.cage_steps, level.fine_steps)
    assert check(fine, moving, 1e-3)


def test_keys_are_on_the_numbers_that_will_hold_them_at_the_first_trial() -> None:
    """Far from the origin rounding takes from the clearance, and poses that are read once are not tried again."""
    fine = FINE.moved((FINE.vertices + np.array([300.0, 0.0])).astype(np.float32).astype(float))
    steps: list[core.Progress] = []
    nested_cages(fine, 8, stored=np.float32, clearance=0.01, progress=steps.append)
    assert [stage for stage, _ in groupby(step.stage for step in steps)].count("decimation") == 1
    poses = (fine.vertices + np.array([0.125 * k, 0.0]) for k in range(3))
    moving = animated_cages(fine, poses, [8], stored=np.float32, clearance=0.01)
    (level,) = moving.levels
    assert np.array_equal(level.cage_steps, level.cage_steps.astype(np.float32))
    assert check(fine, moving, 0.01)
