"""Cages that follow a moving drawing: certified at every pose and between, the given poses bit by bit."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core import (
    InvalidMeshError,
    Mesh,
    NestedCagesError,
    NestingError,
    Settings,
    animated_cages,
    followed,
    nested_cages,
    stream_cages,
    verify,
    verify_motion,
)
from nestedcages_core.checker import check as check_moving
from nestedcages_core.motion import between
from nestedcages_core.motion import level as motion_level
from nestedcages_core.motion.between import Instant
from nestedcages_core.motion.following import Follower, carried
from support.shapes import disc, ring, star


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def waving(frames: int = 9, loops: list[np.ndarray] | None = None) -> tuple[Mesh, np.ndarray]:
    """A star, or other loops, in waves; the last pose is the first one."""
    fine = Mesh.from_loops(loops) if loops else star(7, 84)
    size = fine.diagonal
    poses = []
    for phase in np.append(np.linspace(0.0, 2.0 * np.pi, frames)[:-1], 0.0):
        shift = 0.05 * size * np.sin(phase + 4.0 * fine.vertices[:, ::-1] / size)
        poses.append(turned(fine.vertices + shift, 0.2 * np.sin(phase)))
    return fine, np.array(poses)


SMALL = [star(5, 30).vertices]


def check(level, fine: Mesh, poses: np.ndarray, clearance: float) -> None:
    assert np.array_equal(level.fine_steps[level.report.given], poses)
    assert (np.diff(level.times) > 0.0).all()
    for cage, pose in zip(level.cage_steps, level.fine_steps, strict=True):
        assert verify(level.cage.moved(cage), fine.moved(pose), clearance)
    assert verify_motion(level.cage, fine, level.cage_steps, level.fine_steps)


def test_every_pose_and_every_instant_is_certified() -> None:
    fine, poses = waving(4, SMALL)
    moving = animated_cages(fine, poses, [12, 6], Settings(clearance=1e-3))
    inner, outer = moving.levels
    check(inner, fine, poses, 1e-3)
    check(outer, inner.cage, inner.cage_steps, 1e-3)
    assert len(inner.cage.vertices) == 12 and len(outer.cage.vertices) == 6
    assert np.array_equal(inner.report.excess, [inner.report.certificates[k].excess for k in inner.report.given])


@pytest.mark.slow
def test_about_as_tight_as_a_cage_for_the_pose_alone() -> None:
    fine, poses = waving()
    level = animated_cages(fine, poses, [20]).levels[0]
    alone = [nested_cages(fine.moved(pose).validated(), [20]).cages[0].area for pose in poses[::2]]
    areas = [level.cage.moved(level.cage_steps[k]).area for k in level.report.given[::2]]
    assert np.median(np.array(areas) / alone) < 1.03


@pytest.mark.slow
def test_holes_and_several_parts_are_followed() -> None:
    fine, poses = waving(5, [ring(40), ring(16, 0.4), disc(20, 0.3, 2.0, 0.0)])
    check(animated_cages(fine, poses, [24]).levels[0], fine, poses, 0.0)


@pytest.mark.slow
def test_a_cyclic_motion_closes() -> None:
    fine, poses = waving(4, SMALL)
    closed = animated_cages(fine, poses, [8], cyclic=True).levels[0]
    check(closed, fine, poses, 0.0)
    assert np.array_equal(closed.cage_steps[0], closed.cage_steps[-1])
    assert str(closed.report).startswith(f"4 poses certified, {len(closed.times) - 4} keys added, excess ")
    opened = animated_cages(fine, poses[:-1], [8], cyclic=True, times=np.arange(3) / 24.0).levels[0]
    assert np.array_equal(opened.cage_steps[0], opened.cage_steps[-1])
    assert np.array_equal(opened.fine_steps[-1], poses[0])
    assert opened.times[-1] == pytest.approx(3.0 / 24.0)


def test_a_pose_that_no_step_reaches_gets_a_cage_anew_or_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    fine, poses = waving(3, SMALL)
    monkeypatch.setattr(Follower, "next", lambda *_: None)
    level = animated_cages(fine, poses[:2], [12]).levels[0]
    check(level, fine, poses[:2], 0.0)
    assert [note.code for note in level.report.notes] == ["note.pose"]
    with pytest.raises(NestingError, match=r"cannot follow to pose 1: the drawing blocks its path") as caught:
        animated_cages(fine, [poses[0], poses[0] + 99.0], [12])
    assert caught.value.data["pose"] == 1


@pytest.mark.slow
def test_pins_and_weights_go_with_the_drawing_and_from_level_to_level() -> None:
    fine, poses = waving(3)
    spike = int(np.hypot(*fine.vertices.T).argmax())
    other = (spike + len(fine.vertices) // 2) % len(fine.vertices)
    weights = 1.0 + (fine.vertices[:, 0] > 0.0)
    settings = Settings(clearance=1e-3, pins=[spike, tuple(poses[0][other])], weights=weights)
    inner, outer = animated_cages(fine, poses, [20, 14], settings).levels
    check(inner, fine, poses, 1e-3)
    check(outer, inner.cage, inner.cage_steps, 1e-3)
    for level, reach in ((inner, 0.005), (outer, 0.04)):
        for given, pose in zip(level.report.given, poses, strict=True):
            for pin in (spike, other):
                assert np.hypot(*(level.cage_steps[given] - pose[pin]).T).min() < reach * fine.diagonal


@pytest.mark.slow
def test_a_rigid_motion_takes_the_cage_along() -> None:
    fine = star()
    poses = np.array([turned(fine.vertices, 0.3 * k) + np.array([2.0 * k, 0.0]) for k in range(5)])
    level = animated_cages(fine, poses, [12]).levels[0]
    first = level.cage_steps[0]
    for k, cage in enumerate(level.cage_steps):
        assert np.abs(turned(first, 0.3 * k) + np.array([2.0 * k, 0.0]) - cage).max() < 0.02 * fine.diagonal


def test_an_own_coarse_mesh_keeps_its_edges() -> None:
    fine, poses = waving(4)
    coarse = Mesh.from_loops([ring(12, 1.3 * np.abs(fine.vertices).max())])
    level = animated_cages(fine, poses, [coarse]).levels[0]
    assert np.array_equal(level.cage.edges, coarse.edges)
    check(level, fine, poses, 0.0)


def test_fast_turns_get_keys_or_room() -> None:
    """Half-way between poses a quarter turn apart, straight lines cut a thin shape's way short."""
    bar = np.array([(-1.0, -0.03), (1.0, -0.03), (1.0, 0.03), (-1.0, 0.03)])
    ends = np.linspace(0.0, 1.0, 12)[:, None]
    outline = np.concatenate([a + ends[:-1] * (b - a) for a, b in zip(bar, np.roll(bar, -1, axis=0), strict=True)])
    bent = [outline + np.outer(outline[:, 0] ** 2, [0.0, 0.4 * np.sin(1.5 * k)]) for k in range(3)]
    fine, poses = Mesh.from_loops([outline]), np.array([turned(points, 1.5 * k) for k, points in enumerate(bent)])
    level = animated_cages(fine, poses, [10]).levels[0]
    check(level, fine, poses, 0.0)
    assert level.report.keys_added > 0


def test_a_motion_that_is_too_tight_is_given_up_after_a_number_of_trials(monkeypatch: pytest.MonkeyPatch) -> None:
    trials = 0

    def counted(motion: motion_level.LevelMotion, begin: Instant, end: Instant) -> bool:
        nonlocal trials
        trials += 1
        return is_free(motion, begin, end)

    is_free = motion_level.LevelMotion._is_free
    monkeypatch.setattr(motion_level.LevelMotion, "_is_free", counted)
    monkeypatch.setattr(between, "MOST_TRIALS", 20)
    x = np.linspace(0.0, 10.0, 40)
    bar = np.concatenate([np.stack([x, 0.0 * x], axis=1), np.stack([x[::-1], 0.0 * x + 0.1], axis=1)])
    poses = [turned(bar, angle) for angle in (0.0, 1.5, 3.0)]  # the second turn takes 507 trials
    with pytest.raises(NestingError, match="to the next could not be certified") as caught:
        animated_cages(Mesh.from_loops([bar]), poses, 10)
    assert caught.value.code == "motion.collides" and 20 <= trials <= 60


def test_a_stream_is_read_as_it_is_needed() -> None:
    fine, poses = waving(40, SMALL)
    read = []

    def source():
        for number in range(400):
            read.append(number)
            yield poses[number % 39]

    keys = stream_cages(fine, source(), 8)
    taken = [next(keys) for _ in range(6)]
    assert [key.number for key in taken if key.given] == sorted(key.number for key in taken if key.given)
    assert len(read) < 100
    assert all(key.certificate for key in taken)


@pytest.mark.slow
def test_times_and_progress() -> None:
    fine, poses = waving(5)
    seen = []
    moving = animated_cages(fine, poses, [12, 6], times=[1, 2, 4, 8, 16], progress=seen.append)
    assert moving.levels[0].times[moving.levels[0].report.given].tolist() == [1, 2, 4, 8, 16]
    fractions = [progress.fraction for progress in seen]
    assert fractions == sorted(fractions) and fractions[0] >= 0.0 and fractions[-1] <= 1.0


def test_a_pose_that_crosses_itself_is_named_and_those_before_it_are_kept() -> None:
    fine, poses = waving(4, SMALL)
    poses[2, 0] = -2.0 * poses[2, 0]
    with pytest.raises(InvalidMeshError, match=r"^Pose 2: ") as caught:
        animated_cages(fine, iter(poses), [8])
    (level,) = caught.value.partial.levels
    assert np.array_equal(level.fine_steps[level.report.given], poses[:2])


@pytest.mark.parametrize(
    ("poses", "times", "sentence"),
    [
        (np.zeros((3, 4, 2)), None, "Pose 0: The moved vertices have shape"),
        (waving(4, SMALL)[1][:1], None, "at least two poses, not 1"),
        (5, None, "The poses must be an array"),
        (waving(4, SMALL)[1], [0.0, 1.0], "4 finite numbers, one per pose"),
        (waving(4, SMALL)[1], [0, 1, 1, 3], "must increase, but that of pose 2 is 1 after 1"),
        (waving(4, SMALL)[1] * [-1.0, 1.0], None, "Pose 0 is turned inside out"),
    ],
)
def test_bad_input_is_named(poses, times, sentence) -> None:
    with pytest.raises(NestedCagesError, match=sentence):
        animated_cages(waving(4, SMALL)[0], poses, [8], times=times)


def test_no_levels() -> None:
    fine, poses = waving(3, SMALL)
    with pytest.raises(NestingError, match="There are no levels"):
        animated_cages(fine, poses, [])


def test_points_are_carried_exactly_by_similarities() -> None:
    random = np.random.default_rng(5)
    before, cage = random.normal(size=(50, 2)), random.normal(size=(9, 2))

    def similarity(points: np.ndarray) -> np.ndarray:
        return 1.7 * turned(points, 0.8) + [3.0, -1.0]

    moved = carried(cage, before, similarity(before), np.ones(50))
    assert np.abs(moved - similarity(cage)).max() < 1e-12


def test_one_step_leads_to_the_cage_of_an_edit() -> None:
    fine = star()
    cage, clearance = nested_cages(fine, [16]).levels[0].cage, 1e-4 * fine.diagonal
    after = fine.moved(fine.vertices * (1.1, 0.9))
    found = followed(cage, fine, after, clearance)
    assert found is not None and np.array_equal(found.edges, cage.edges)
    certificate = verify(found, after, clearance)
    assert certificate.holds and certificate.excess < 1.1 * verify(cage, fine).excess + 0.01


def test_holes_that_there_are_too_few_vertices_for_are_filled() -> None:
    fine, poses = waving(3, [ring(40), ring(6, 0.1)])
    cage = nested_cages(fine, [5]).levels[0].cage
    moved = followed(cage, fine, fine.moved(poses[1]), 1e-5)
    assert moved is not None and verify(moved, fine.moved(poses[1]), same_loops=False)
    moving = animated_cages(fine, poses, [5])
    assert len(moving.levels[0].cage.loops) == 1 and check_moving(fine, moving)
    with pytest.raises(NestingError, match="need at least 6"):
        animated_cages(fine, poses, [5], loops="keep")
