"""Cages that follow a moving drawing: certified at every pose and between, the given poses bit by bit."""

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import Mesh, NestingError, Settings, animated_cages, followed, nested_cages, verify
from support.judging import rejected
from support.marks import slow_after
from support.shapes import disc, ring, star, turned


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
X = np.linspace(0.0, 10.0, 12)
BAR = np.concatenate([np.stack([X, 0.0 * X], axis=1), np.stack([X[::-1], 0.0 * X + 0.1], axis=1)])


def assert_certified(level, fine: Mesh, poses: np.ndarray, clearance: float) -> None:
    assert np.array_equal(level.fine_steps[level.report.given], poses)
    assert (np.diff(level.times) > 0.0).all()
    for cage, pose in zip(level.cage_steps, level.fine_steps, strict=True):
        assert verify(level.cage.moved(cage), fine.moved(pose), clearance)
    assert core.verify_motion(level.cage, fine, level.cage_steps, level.fine_steps)


def test_every_pose_and_every_instant_is_certified() -> None:
    fine, poses = waving(4, SMALL)
    moving = animated_cages(fine, poses, [12, 6], Settings(clearance=1e-3))
    inner, outer = moving.levels
    assert_certified(inner, fine, poses, 1e-3)
    assert_certified(outer, inner.cage, inner.cage_steps, 1e-3)
    assert len(inner.cage.vertices) == 12 and len(outer.cage.vertices) == 6
    assert np.array_equal(inner.report.excess, [inner.report.certificates[k].excess for k in inner.report.given])


@pytest.mark.slow
def test_each_level_gets_into_gaps_narrower_than_the_default_clearance() -> None:
    fine = Mesh.from_loops([ring(6), disc(6, 1.0, 2.000012, 0.0)])
    poses = np.stack([fine.vertices, turned(fine.vertices, 0.05)])
    inner, outer = animated_cages(fine, poses, [6, 6], loops="keep").levels
    assert_certified(inner, fine, poses, 0.0)
    assert_certified(outer, inner.cage, inner.cage_steps, 0.0)


def test_a_clearance_that_a_key_does_not_have_is_not_reported() -> None:
    turn, radius = 2.0 * np.pi * np.arange(40) / 40, np.where(np.arange(40) % 8 == 0, 0.5, 0.15)
    fine = Mesh.from_loops([np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)])  # needles
    x, y = fine.vertices.T
    bent = [1.1 * (np.cos(0.1 * y) * x - np.sin(0.1 * y) * y), np.sin(0.1 * y) * x + np.cos(0.1 * y) * y]
    moving = animated_cages(fine, [fine.vertices, np.stack(bent, axis=1)], [16])
    assert core.check(fine, moving)
    reached, (note,) = moving.levels[0].report.clearance.min(), moving.levels[0].report.notes
    assert note.code == "note.clearance" and reached >= note.data["given"] == moving.levels[0].report.wanted_clearance


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
    assert_certified(animated_cages(fine, poses, [24]).levels[0], fine, poses, 0.0)


@pytest.mark.slow
def test_a_cyclic_motion_closes() -> None:
    fine, poses = waving(4, SMALL)
    closed = animated_cages(fine, poses, [8], cyclic=True).levels[0]
    assert_certified(closed, fine, poses, 0.0)
    assert np.array_equal(closed.cage_steps[0], closed.cage_steps[-1])
    assert (len(closed.report.given), closed.report.keys_added) == (4, len(closed.times) - 4)
    opened = animated_cages(fine, poses[:-1], [8], cyclic=True, times=np.arange(3) / 24.0).levels[0]
    assert np.array_equal(opened.cage_steps[0], opened.cage_steps[-1])
    assert np.array_equal(opened.fine_steps[-1], poses[0])
    assert opened.times[-1] == pytest.approx(3.0 / 24.0)


UNREACHED = {
    "one part passes through another": (
        [ring(8), ring(8, centre=(3.0, 0.0))], lambda points: points + np.outer(np.arange(16) < 8, [6, 0]),
        "motion.blocked", 1,
    ),
    "a bar shrinks to a point and comes out turned": ([BAR], lambda points: -points, "motion.collides", 0),
}  # fmt: skip


@pytest.mark.parametrize(("fine", "pose", "code", "place"), slow_after(1, UNREACHED.values()), ids=UNREACHED.keys())
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_pose_that_no_motion_reaches_is_named_and_those_before_it_are_kept(fine, pose, code, place) -> None:
    fine = Mesh.from_loops(fine)
    with rejected(code, NestingError, pose=place) as caught:
        animated_cages(fine, [fine.vertices, pose(fine.vertices)], 8)
    for level in caught.value.partial.levels:
        assert np.array_equal(level.fine_steps, fine.vertices[None])
        assert_certified(level, fine, fine.vertices[None], 0.0)


@pytest.mark.slow
def test_pins_and_weights_go_with_the_drawing_and_from_level_to_level() -> None:
    fine, poses = waving(3)
    spike = int(np.hypot(*fine.vertices.T).argmax())
    other = (spike + len(fine.vertices) // 2) % len(fine.vertices)
    weights = 1.0 + (fine.vertices[:, 0] > 0.0)
    settings = Settings(clearance=1e-3, pins=[spike, tuple(poses[0][other])], weights=weights)
    inner, outer = animated_cages(fine, poses, [20, 14], settings).levels
    assert_certified(inner, fine, poses, 1e-3)
    assert_certified(outer, inner.cage, inner.cage_steps, 1e-3)
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
    assert_certified(level, fine, poses, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(("high", "turn", "count"), [(0.03, 1.5, 10), (0.06, 1.9, 6)])
def test_fast_turns_get_keys_or_room(high: float, turn: float, count: int) -> None:
    """Half-way between poses a quarter turn apart, straight lines cut a thin shape's way short."""
    bar = np.array([(-1.0, -high), (1.0, -high), (1.0, high), (-1.0, high)])
    ends = np.linspace(0.0, 1.0, 12)[:, None]
    outline = np.concatenate([a + ends[:-1] * (b - a) for a, b in zip(bar, np.roll(bar, -1, axis=0), strict=True)])
    bent = [outline + np.outer(outline[:, 0] ** 2, [0.0, 0.4 * np.sin(1.5 * k)]) for k in range(3)]
    fine, poses = Mesh.from_loops([outline]), np.array([turned(points, turn * k) for k, points in enumerate(bent)])
    level = animated_cages(fine, poses, [count]).levels[0]
    assert_certified(level, fine, poses, 0.0)
    assert level.report.keys_added > 0


@pytest.mark.slow
def test_a_stream_is_read_as_it_is_needed() -> None:
    fine, poses = waving(40, SMALL)
    read = []

    def source():
        for number in range(400):
            read.append(number)
            yield poses[number % 39]

    keys = core.stream_cages(fine, source(), 8)
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
    with rejected("poses.invalid", core.InvalidMeshError, pose=2) as caught:
        animated_cages(fine, iter(poses), [8])
    (level,) = caught.value.partial.levels
    assert np.array_equal(level.fine_steps[level.report.given], poses[:2])


@pytest.mark.parametrize(
    ("poses", "times", "pose"),
    [
        (np.zeros((3, 4, 2)), None, 0),
        (waving(4, SMALL)[1][:1], None, None),
        (5, None, None),
        (waving(4, SMALL)[1], [0.0, 1.0], None),
        (waving(4, SMALL)[1], [0, 1, 2, np.nan], None),
        (waving(4, SMALL)[1], [0, 1, 1, 3], 2),
        (iter(waving(4, SMALL)[1]), [0, 1, 2], 3),
        (waving(4, SMALL)[1] * [-1.0, 1.0], None, 0),
    ],
)
def test_bad_poses_and_times_are_named(poses, times, pose) -> None:
    with rejected("poses.invalid", pose=pose):
        animated_cages(waving(4, SMALL)[0], poses, [8], times=times)


def test_motions_without_levels_and_with_others_than_counts_are_refused() -> None:
    fine, poses = waving(3, SMALL)
    for levels, options, code in (
        ([], {}, "level.invalid"),
        ([core.Within(distance=0.1)], {}, "level.invalid"),
        ([8], {"convex": True}, "setting.conflict"),
    ):
        with rejected(code):
            animated_cages(fine, poses, levels, **options)


def test_a_similarity_of_the_drawing_is_one_of_the_cage() -> None:
    fine = star(5, 60)
    cage = nested_cages(fine, [12]).cages[0]

    def similar(points: np.ndarray) -> np.ndarray:
        return 1.7 * turned(points, 0.8) + [3.0, -1.0]

    moved = followed(cage, fine, fine.moved(similar(fine.vertices)), 1.7e-5 * fine.diagonal)
    assert moved is not None
    assert np.abs(moved.vertices - similar(cage.vertices)).max() < 1e-3 * fine.diagonal


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
    moving = animated_cages(fine, poses, [7])  # with six, both loops might have three
    assert len(moving.levels[0].cage.loops) == 1 and core.check(fine, moving)
    assert [each.code for each in moving.levels[0].report.notes] == ["note.loops"]
    loops = [len(animated_cages(fine, poses, 12, loops=kept).levels[0].cage.loops) for kept in ("keep", "one")]
    assert loops == [2, 1]
    with rejected("count.too_small", NestingError, least=6):
        animated_cages(fine, poses, [5], loops="keep")


def test_the_error_of_a_level_around_one_with_less_clearance_is_raised() -> None:
    """A bay closes until the first cage needs less than the default clearance; the second one lies elsewhere."""

    def bay(width: float) -> list[tuple[float, float]]:
        right = [(2 + width, 0), (2 + width, 2), (1 + width, 2), (1 + width, 1)]
        return [(0, 0), *right, (1, 1), (1, 2), (0, 2)]

    poses = np.array([bay(width) for width in np.linspace(0.2, 1e-5, 4)])
    with rejected("flow.loops_differ", core.FlowError) as caught:
        animated_cages([poses[0]], poses, [8, Mesh.from_loops([ring(4) + 50.0])], fallback=None)
    (first,) = caught.value.partial.levels
    assert first.report.wanted_clearance < 1e-5
