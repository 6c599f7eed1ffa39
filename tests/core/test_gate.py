"""Each caller of the gate is broken in turn: what comes out is an error, and never a wrong level or key."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from test_animated_cages import turned, waving

from nestedcages_core import (
    Level,
    Mesh,
    NestingError,
    Within,
    animated_cages,
    inner_cages,
    nested_cages,
    verify,
    verify_motion,
)
from nestedcages_core.cache import forget
from nestedcages_core.hierarchy import run
from nestedcages_core.level import gate, level_cache, settling, steps
from nestedcages_core.level.assembly import Assembly
from nestedcages_core.level.gate import Way, passed, rerouted
from nestedcages_core.level.steps import as_stored, shrunk
from nestedcages_core.motion.between import Straightener
from nestedcages_core.motion.following import Follower
from nestedcages_core.motion.level import LevelMotion
from nestedcages_core.tolerance import fewest
from support.marks import slow_after
from support.shapes import ring, star

TEETH = Mesh.from_loops(
    [[(0, 0), (9, 0), (9, 4), (8, 4), (8, 1), (6, 1), (6, 4), (5, 4), (5, 1), (3, 1), (3, 4), (2, 4), (2, 1), (0, 1)]]
)
"""Straight motion from one gap to another crosses a tooth."""


@pytest.fixture(autouse=True)
def _nothing_remembered() -> None:
    forget()


def of(way: Way, *, cages: np.ndarray | None = None, moving: np.ndarray | None = None) -> Way:
    """The way with other steps."""
    path = way.reinflation
    cages, moving = path.cage_steps if cages is None else cages, path.moving_steps if moving is None else moving
    return way._replace(reinflation=replace(path, cage_steps=cages, moving_steps=moving))


def with_detour(cages: np.ndarray) -> np.ndarray:
    """Steps with one more before the last: its vertices in turn, which is nested, but not on the way there."""
    return np.concatenate([cages[:-1], np.roll(cages[-1:], len(cages[0]) // 2, axis=1), cages[-1:]])


def is_right(level: Level) -> bool:
    """Whether a level is what its report tells, by the public judges and comparisons."""
    way, report = level.reinflation, level.report
    pair = (level.fine, level.cage) if level.inside else (level.cage, level.fine)
    certificate = verify(*pair, report.wanted_clearance, same_loops=False)
    ends = np.array_equal(way.fine_steps[-1], level.fine.vertices) and np.array_equal(
        way.cage_steps[-1], level.cage.vertices
    )
    starts = np.array_equal(way.cage_steps[0], level.coarse.vertices) and np.array_equal(
        way.fine_steps[0], level.flow.steps[-1]
    )
    told = report.clearance == certificate.clearance and report.excess == level.cage.area / level.fine.area - 1.0
    motion = verify_motion(level.cage, level.fine, way.cage_steps, way.fine_steps)
    return bool(certificate and motion and ends and starts and told)


def is_refused(work: Any, *asked: Any, **options: Any) -> bool:
    """Whether there is an error, or a level that is right since something else made it."""
    try:
        levels = work(*asked, **options).levels
    except NestingError:
        return True
    return all(map(is_right, levels))


@pytest.mark.parametrize(
    ("work", "options"),
    slow_after(
        2,
        [
            (nested_cages, {"stored": np.float16}),
            (inner_cages, {}),
            (nested_cages, {}),
            (nested_cages, {"convex": True}),
            (nested_cages, {"grid": 0.05}),
        ],
        thorough_after=4,
    ),
    ids=["stored", "inside", "plain", "convex", "grid"],
)
@pytest.mark.parametrize("fault", ["too small", "too large", "turned", "detour", "fine away", "fine elsewhere"])
def test_what_the_solvers_hand_over_is_judged(fault: str, work: Any, options: Any, monkeypatch: Any) -> None:
    true = Assembly.in_input_units

    def wrong(self: Assembly, cage: Any) -> Way:
        way = true(self, cage)
        cages, moving = way.reinflation.cage_steps.copy(), way.reinflation.moving_steps
        if fault in ("too small", "too large"):
            cages[-1] *= 0.5 if (fault == "too small") != (work is inner_cages) else 2.0
        elif fault == "turned":
            cages[-1] = turned(cages[-1], 0.6)
        elif fault == "detour":
            cages = with_detour(cages)
        else:
            moving = moving * 0.9 if fault == "fine away" else moving.copy()
            moving[0] = moving[0] + 5.0
        return of(way, cages=cages, moving=moving)

    monkeypatch.setattr(Assembly, "in_input_units", wrong)
    assert is_refused(work, star(5, 40), 10, clearance=1e-3, **options)
    monkeypatch.setattr(Assembly, "untightened", lambda *_: iter_of(None))  # the last resort
    assert is_refused(work, star(5, 40), 10, clearance=1e-3, fallback=None, **options)


@pytest.mark.slow
def test_motion_to_a_grid_is_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    """On the way, the cage is where another vertex ends, across the teeth: without such a motion, it stands still."""
    true = settling._paths

    def wrong(way: Way, vertices: np.ndarray, *rest: Any) -> Any:
        yield from (replace(path, cage_steps=with_detour(path.cage_steps)) for path in true(way, vertices, *rest))

    (level,) = nested_cages(TEETH, 12, grid=0.25).levels
    assert level.report.grid == 0.25 and len(level.reinflation.cage_steps) > 1
    forget()
    monkeypatch.setattr(settling, "_paths", wrong)
    (still,) = nested_cages(TEETH, 12, grid=0.25).levels
    assert still.cage == level.cage and len(still.reinflation.cage_steps) == 1
    assert "stands still" in str(still.report)


@pytest.mark.parametrize("fine", slow_after(1, [star(7, 56), TEETH]), ids=["star", "teeth"])
def test_settling_obeys_needs_and_certificates(fine: Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    true = settling.placements

    def beside(*asked: Any) -> Any:
        return [points + 0.01 for points in (yield from true(*asked))]

    monkeypatch.setattr(settling, "placements", beside)
    with pytest.raises(NestingError, match="grid"):  # by the judge of the need
        nested_cages(fine, 14, grid=0.25)
    monkeypatch.setattr(settling, "judged", lambda *asked: gate.judged(*asked, promised=False))
    with pytest.raises(NestingError, match=r"not judged|grid"):
        nested_cages(fine, 14, grid=0.25)
    monkeypatch.setattr(settling, "admitted", lambda cage, way, report, level: iter_of(replace(level, report=report)))
    with pytest.raises(NestingError, match=r"not judged|grid"):
        nested_cages(fine, 14, grid=0.25)


def test_settling_keeps_the_clearance_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(settling, "judged", lambda plan, cage, wanted: gate.judged(plan, cage, 0.0))
    with pytest.raises(NestingError, match="not judged"):
        nested_cages(star(7, 56), 14, grid=0.05, clearance=0.01)


def iter_of(result: Any) -> Any:
    """A stage that has a result."""
    return result
    yield


@pytest.mark.parametrize("factor", [0.999, 1.001])
def test_stored_steps_are_judged(factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(points: np.ndarray, stored: str) -> np.ndarray:
        return as_stored(points * (factor if len(points) > 1 else 1.0), stored)

    monkeypatch.setattr(steps, "as_stored", wrong)
    with pytest.raises(NestingError, match="steps of the level"):
        nested_cages(star(7, 56), 14, stored=np.float32)
    monkeypatch.setattr(steps, "as_stored", lambda points, stored: points.copy())
    with pytest.raises(NestingError, match="steps of the level"):
        nested_cages(star(7, 56), 14, stored=np.float32)
    monkeypatch.setattr(steps, "with_stored_steps", lambda level, stored: level)
    with pytest.raises(NestingError, match="not measured"):
        nested_cages(star(7, 56), 14, stored=np.float32)


def test_a_type_holds_all_steps_but_the_drawing_itself() -> None:
    fine, cage = Mesh.from_loops([ring(7)]), Mesh.from_loops([as_stored(ring(8, 2.0), "float16")])
    way, inside = Way.at_rest(fine, cage), 0.7 * fine.vertices
    for between, holds in ((inside, False), (as_stored(inside, "float16"), True)):
        flow = replace(way.flow, steps=np.stack([fine.vertices, between, fine.vertices]))
        assert way._replace(flow=flow).is_stored("float16") is holds
        assert way._replace(flow=flow).is_stored(None)
    assert not Way.at_rest(fine, Mesh.from_loops([ring(7, 2.0)])).is_stored("float16")


def test_shrinking_is_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    level = nested_cages(star(7, 56), 14).levels[0]
    further = shrunk(level)
    assert len(further.flow.steps) > len(level.flow.steps)
    assert np.array_equal(passed(further, level.fine).cage.vertices, level.cage.vertices)
    wide = level.flow.steps[-1] * np.array([1.5, 3.0, 1.0])[:, None, None]
    monkeypatch.setattr(steps, "shrink", lambda *_: wide)
    assert shrunk(level) is level
    astray = replace(level, cage=level.cage.moved(0.5 * level.cage.vertices))
    with pytest.raises(NestingError):
        shrunk(astray)


def test_only_what_is_new_is_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    judged: list[int] = []
    true = gate.certifying

    def counted(bodies: Any, cages: Any, fines: Any) -> Any:
        judged.append(len(cages) - 1)
        return (yield from true(bodies, cages, fines))

    monkeypatch.setattr(gate, "certifying", counted)
    (level,) = nested_cages(TEETH, 12).levels
    assert judged == [len(level.reinflation.cage_steps) - 1]
    added = len(shrunk(level).reinflation.cage_steps) - len(level.reinflation.cage_steps)
    assert judged[1:] == [added] * (added > 0)
    monkeypatch.setattr(gate, "judged", lambda *_, **__: pytest.fail("judged twice"))
    rerouted(pickle.loads(pickle.dumps(level)), Way.of(level))
    assert len(judged) == 1 + (added > 0)


CHANGES = {
    "cage": lambda level: replace(level, cage=level.cage.moved(1.01 * level.cage.vertices)),
    "fine": lambda level: replace(level, fine=level.fine.moved(0.99 * level.fine.vertices)),
    "coarse": lambda level: replace(level, coarse=level.coarse.moved(1.01 * level.coarse.vertices)),
    "flow": lambda level: replace(level, flow=replace(level.flow, steps=level.flow.steps[::-1] + 1.0)),
    "path": lambda level: replace(
        level, reinflation=replace(level.reinflation, cage_steps=with_detour(level.reinflation.cage_steps))
    ),
    "excess": lambda level: replace(level, report=replace(level.report, excess=0.9 * level.report.excess)),
    "clearance": lambda level: replace(level, report=replace(level.report, clearance=1.0)),
    "wanted": lambda level: replace(level, report=replace(level.report, wanted_clearance=0.0)),
    "grid": lambda level: replace(level, report=replace(level.report, grid=0.5)),
    "stored": lambda level: replace(level, report=replace(level.report, stored="float16")),
    "seal": lambda level: replace(level, seal=None),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_is_changed_after_the_gate_is_found(change: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By whom it is: a memory of levels, a search for the fewest vertices."""
    altered = CHANGES[change]
    fine = star(7, 56)
    nested_cages(fine, 14)
    true = level_cache.copied
    monkeypatch.setattr(level_cache, "copied", lambda level: altered(true(level)))
    with pytest.raises(NestingError):
        nested_cages(fine, 14)
    monkeypatch.undo()
    find = fewest.fewest
    monkeypatch.setattr(fewest, "fewest", lambda *asked, **how: after(find(*asked, **how), altered))
    with pytest.raises(NestingError):
        nested_cages(fine, Within(excess=0.5))


def after(stage: Any, change: Any) -> Any:
    """A stage whose result is changed."""
    return change((yield from stage))


def test_a_level_around_another_mesh_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    another = nested_cages(star(5, 40), 8).levels[0]
    monkeypatch.setattr(run, "whole_level", lambda *_: iter_of(another))
    with pytest.raises(NestingError, match="not the one"):
        nested_cages(star(7, 56), 14)


def test_keys_keep_the_clearance(monkeypatch: pytest.MonkeyPatch) -> None:
    """A follower that keeps another clearance, or none, does not get its keys through."""
    true = Follower.of.__func__  # type: ignore[attr-defined]

    def careless(cls: Any, cage: Mesh, fine: Mesh, units: Any, clearance: float, promises: Any) -> Follower:
        return true(cls, cage, fine, units, 0.1 * clearance, promises)

    fine, poses = waving(5, [star(7, 56).vertices])
    monkeypatch.setattr(Follower, "of", classmethod(careless))
    with pytest.raises(NestingError, match="could not be certified: The cage comes as near as"):
        animated_cages(fine, poses, 12, clearance=2e-2)


@pytest.mark.parametrize("options", slow_after(1, [{"stored": np.float16}, {"grid": 0.02}]), ids=str)
def test_keys_keep_needs(options: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    fine, poses = waving(3, [star(7, 56).vertices])
    monkeypatch.setattr(Follower, "stored", lambda self, cage: self.units.to_input(cage))
    with pytest.raises(NestingError, match="not on the numbers"):
        animated_cages(fine, poses, 12, clearance=1e-2, **options)


def bump(count: int = 3, height: float = 0.6) -> tuple[Mesh, np.ndarray]:
    """A bump that jumps around a circle: between the poses the drawing cuts through cages of both."""
    angle = 2.0 * np.pi * np.arange(60) / 60
    away = (angle - 2.0 * np.arange(count)[:, None] + np.pi) % (2.0 * np.pi) - np.pi
    poses = (1.0 + height * np.exp(-((away / 0.35) ** 2)))[:, :, None] * ring(60)
    return Mesh.from_loops([poses[0]]), poses


def test_motion_to_a_key_is_judged_again_where_that_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Who says that motion is free without asking, or changes a key after that, gets an error."""
    fine, poses = bump()
    pushed: list[object] = []
    true, settle = Straightener._pushed, Straightener.settle

    def noted(self: Straightener, *keys: Any) -> Any:
        pushed.append(keys)
        return true(self, *keys)

    monkeypatch.setattr(Straightener, "_pushed", noted)
    assert animated_cages(fine, poses, 10, clearance=1e-3)
    assert pushed
    with monkeypatch.context() as broken, pytest.raises(NestingError, match="The motion from pose"):
        broken.setattr(LevelMotion, "_is_free", lambda *_: True)
        animated_cages(fine, poses, 10, clearance=1e-3)

    def careless(self: Straightener, key: Any) -> None:
        settle(self, key)
        key.cage = key.cage.mean(axis=0) + 3.0 * (np.roll(key.cage, 4, axis=0) - key.cage.mean(axis=0))

    with monkeypatch.context() as broken, pytest.raises(NestingError, match="The motion from pose"):
        broken.setattr(Straightener, "settle", careless)
        animated_cages(fine, poses, 10, clearance=1e-3)


@pytest.mark.slow
def test_neighbours_of_a_pushed_key_are_judged_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A push makes an interval free and that before it not, which only the gate sees if nobody looks back."""
    fine, poses = bump(5, 1.4)
    level = animated_cages(fine, poses, 16, clearance=1e-3).levels[0]
    assert verify_motion(level.cage, fine, level.cage_steps, level.fine_steps)
    settle = Straightener.settle

    def forgetful(self: Straightener, key: Any) -> None:
        before, key.before = key.before, None
        settle(self, key)
        key.before = before

    monkeypatch.setattr(Straightener, "settle", forgetful)
    with pytest.raises(NestingError, match="The motion from pose 1 to the next"):
        animated_cages(fine, poses, 16, clearance=1e-3)
