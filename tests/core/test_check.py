"""The independent checker: it knows wrong cages, needs and motions by hand, and no certificate says more than it."""

from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Hierarchy, Level, LineCycles, Mesh, Mirror, Rotation, check, nested_cages
from support.marks import slow_after
from support.shapes import comb, disc, islands, letter_a, letter_a_coarse, mesh, polygon, ring, square_with_hole, star

SQUARE = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], float)
FAST = core.Settings(decimation=LineCycles(on_curve=False), fallback=LineCycles(on_curve=False))


SMALL = mesh(disc(8, 0.5, 2.0, 2.0))
TWO = mesh(disc(8, 0.2, 1.0, 1.0), disc(8, 0.2, 3.0, 3.0))

WRONG: dict[str, tuple[Any, Mesh]] = {
    "a loop too many": (mesh(SQUARE, disc(8, 0.2, 7.0, 7.0)), SMALL),
    "turned inside out": (mesh(SQUARE).moved(SQUARE[::-1]), SMALL),
    "an edge without length": (mesh(SQUARE).moved(SQUARE[[0, 0, 2, 3]]), SMALL),
    "no numbers": (mesh(SQUARE).moved(np.full((4, 2), np.nan)), SMALL),
    "edges that are no loop": (SimpleNamespace(vertices=SQUARE, edges=[[0, 1], [1, 2], [3, 2], [3, 0]]), SMALL),
    "no shape": ("a cage", SMALL),
    "no cage": ([], SMALL),
    "levels in the wrong order": ([mesh(2.0 * SQUARE - 4.0), mesh(1.5 * SQUARE - 2.5)], mesh(0.5 * SQUARE)),
}


@pytest.mark.parametrize(("cage", "fine"), WRONG.values(), ids=WRONG.keys())
def test_wrong_cages_are_known(cage: Any, fine: Mesh) -> None:
    verdict = check(fine, cage)
    assert not verdict
    assert verdict.problems


@pytest.mark.parametrize(
    "read",
    [
        lambda cage: cage,
        lambda cage: list(cage.rings),
        lambda cage: [ring_[::-1] for ring_ in cage.rings],
        lambda cage: cage.__geo_interface__,
        lambda cage: {"type": "Polygon", "coordinates": [[*points, points[0]] for points in
                                                        map(np.ndarray.tolist, cage.rings)]},
    ],
    ids=["a mesh", "loops", "loops backwards", "a mapping", "a polygon"],
)  # fmt: skip
def test_shapes_of_all_kinds_are_read(read: Any) -> None:
    cage, fine = square_with_hole(0.2).moved(2.0 * square_with_hole(0.2).vertices), square_with_hole(0.5)
    assert check(fine, read(cage))
    assert check(list(fine.rings), [read(cage)])
    assert not check(cage, read(fine))


def test_cages_may_be_inside_and_may_wrap_several_parts() -> None:
    assert check(0.5 * SQUARE + 1.0, SQUARE)
    assert not check(SQUARE, 0.5 * SQUARE + 1.0)
    assert check(SQUARE, 0.5 * SQUARE + 1.0, inside=True)
    wrapped = check(TWO, mesh(SQUARE), same_loops=False)
    assert wrapped
    assert len(wrapped.lost) == 1
    assert check(TWO, [mesh(SQUARE), mesh(SQUARE * 2 - 2)], same_loops=[False, True])
    assert not check(TWO, [mesh(SQUARE), mesh(SQUARE * 2 - 2)], same_loops=[True, False])


def test_the_distance_is_exact() -> None:
    fine = mesh([(1, 1), (2, 1), (2, 2), (1, 2)])
    assert check(fine, SQUARE, 1.0)
    assert check(fine, SQUARE, 1.0 + 5e-10)
    assert not check(fine, SQUARE, 1.0 + 1.5e-9)
    slanted, half = mesh([(1, 1), (2, 1), (1, 2)]), 0.5 / np.sqrt(2.0)
    for wanted, kept in ((0.5, False), (half * (1.0 + 1e-8), False), (half, True)):
        assert bool(check(slanted, [(0, 0), (3.5, 0), (0, 3.5)], wanted)) == kept
    tiny = 1e-170 * SQUARE
    assert check(tiny, 1.5 * tiny - 1e-170, 0.9e-170)
    for wrong in (1.1e-170, np.nan, np.inf):
        assert not check(tiny, 1.5 * tiny - 1e-170, wrong)


@pytest.mark.parametrize("shape", slow_after(1, [star, islands, letter_a, lambda: comb(5, 0.05, per_unit=20)]))
def test_the_largest_distance_is_that_of_many_points(shape: Any) -> None:
    """By shapely, of points in the cage that are so close to each other that none is much farther away."""
    fine = shape()
    (cage,) = nested_cages(fine, [20], FAST, loops="keep").cages
    between = polygon(cage).difference(polygon(fine))
    spacing = 0.002 * fine.diagonal
    x, y = (np.arange(low, high, spacing) for low, high in np.reshape(cage.bounds, (2, 2)).T)
    inside = shapely.points(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
    inside = inside[shapely.contains(between, inside)]
    around = shapely.get_parts(shapely.extract_unique_points(shapely.segmentize(polygon(cage), spacing)))
    farthest = shapely.distance(polygon(fine), np.concatenate([inside, around])).max()
    assert not check(fine, cage, distance=farthest * (1.0 - 1e-6))
    assert check(fine, cage, distance=farthest + spacing)


@pytest.mark.parametrize("place", [0.0, 2.0**30])
def test_the_largest_distance_is_exact(place: float) -> None:
    """Of squares: the distance from corner to corner, and not the last digits of it that a coordinate can hold less."""
    rest, cage = 0.25 * SQUARE + 1.5 + place, SQUARE + place
    farthest, digits = 1.5 * np.sqrt(2.0), max(2e-9, 1e-12 * place)
    for around in ((rest, cage), (cage, rest)):  # an inner cage is as far from its drawing
        checked = partial(check, *around, inside=around[0] is cage)
        assert checked(distance=farthest)
        assert checked(distance=farthest * (1.0 - 0.1 * digits))
        assert not checked(distance=farthest * (1.0 - 2.0 * digits))


def test_loops_may_differ_where_the_coarse_mesh_did_or_as_said() -> None:
    fine, coarse = mesh(ring(24), 0.5 * ring(24)), mesh(ring(9, 1.2))
    (level,) = nested_cages(fine, [coarse]).levels
    assert check(fine, level)
    assert not check(fine, level, same_loops=True)
    assert check(fine, level.cage, same_loops=False)
    assert not check(fine, level.cage)


@pytest.mark.parametrize("symmetry", [Mirror(None, (3.0, 4.0)), Rotation(None, 5), Mirror((2.0**20, 0.0), (3.0, 4.0))])
def test_images_are_exact_anywhere(symmetry: Any) -> None:
    """Cages far from the origin on one axis: an image off by a millionth of their size is none."""
    away = np.array([2.0**20, 0.0])
    half, rest = away + ring(5, 4.0, angle=np.arctan2(4.0, 3.0)), away + ring(5)
    assert check(rest, half, symmetry=symmetry)
    half[1] *= 1.0 + 1e-12
    assert not check(rest, half, symmetry=symmetry)


@pytest.mark.parametrize("symmetry", slow_after(1, [Rotation(None, 5), Mirror(None), Mirror((0.0, 0.0), (1.0, 0.3))]))
def test_symmetric_cages_are_and_others_are_not(symmetry: Any) -> None:
    chosen = replace(FAST, symmetry=symmetry, decimation=LineCycles())
    assert check(star(), nested_cages(star(), [20], chosen), symmetry=symmetry)
    assert not check(star(), star().vertices * 1.3 * (1.0, 1.01), symmetry=symmetry)


def test_numbers_on_a_grid_are_and_others_are_not() -> None:
    (level,) = nested_cages(letter_a(1), [24], replace(FAST, grid=0.05))
    assert check(letter_a(1), level)
    assert not check(letter_a(1), level, grid=0.07)
    assert not check(letter_a(1), replace(level, cage=level.cage.moved(level.cage.vertices * (1.0 + 1e-15))))
    (stored,) = nested_cages(letter_a(1), [24], replace(FAST, stored=np.float32))
    assert check(letter_a(1), stored)
    assert not check(letter_a(1), replace(stored, cage=stored.cage.moved(stored.cage.vertices * (1.0 + 1e-15))))


def test_cages_that_move_are_checked_at_each_key() -> None:
    fine = star(5, 40)
    moving = core.animated_cages(fine, [fine.vertices * (1.0 + 0.2 * k, 1.0) for k in range(3)], [12], FAST)
    assert check(fine, moving)
    elsewhere = fine.moved(3.0 * fine.vertices - 7.0)  # it gives the topology alone
    assert check(elsewhere, moving)
    assert not check(SimpleNamespace(vertices=fine.vertices, edges=fine.edges[:, ::-1]), moving)
    assert not check(star(5, 50), moving)
    (level,) = moving.levels
    assert not check(fine, moving, 2.0 * float(level.report.clearance.min()))
    shrunk = replace(level, cage_steps=level.cage_steps * np.linspace(1.0, 0.8, len(level.times))[:, None, None])
    assert not check(fine, shrunk)


def way(cage: Mesh, fine: Mesh, cage_steps: Any, fine_steps: Any) -> Any:
    """A level of a user's own that moves so to its end, where it is nested."""
    steps = SimpleNamespace(cage_steps=np.array(cage_steps), fine_steps=np.array(fine_steps))
    return SimpleNamespace(cage=cage, fine=fine, reinflation=steps)


def test_contacts_that_last_an_instant_are_known() -> None:
    """A needle's tip reaches the wall between two steps and turns back; one unit in the last place less, and it does
    not."""
    cage, fine = mesh(SQUARE), mesh([(1, 1), (3, 1.5), (1, 2)])
    for x, meets in ((4.0, True), (np.nextafter(4.0, 0.0), False)):
        there = [[3.0, 1.5], [x, 1.5], [3.0, 2.0]]
        level = way(cage, fine, [cage.vertices] * 3, [fine.vertices, there, fine.vertices])
        assert bool(check(fine, level)) != meets


@pytest.mark.parametrize(("x", "meets"), [(1.0, True), (3.0, False), (0.999, False), (1.001, False)])
def test_an_edge_that_shrinks_to_a_point_meets_only_what_is_there(x: float, meets: bool) -> None:
    cage = mesh([(-20, -2), (x, -1), (20, -2), (20, 20), (-20, 20)])
    fine = mesh([(0, 0), (2, 0), (1, 5)])
    begin = cage.vertices.copy()
    begin[1, 1] = 0.0
    level = way(cage, fine, [begin, cage.vertices], [[(1, 0), (1, 0), (1, 5)], fine.vertices])
    assert bool(check(fine, level)) != meets


def moved_a_little(values: list[float], cage: Mesh, factor: float) -> Mesh:
    return cage.moved(cage.vertices + factor * np.resize(values, cage.vertices.shape))


def random_offsets(random: np.random.Generator) -> list[float]:
    return (random.integers(-8, 9, int(random.integers(4, 25))) / 8.0).tolist()


PAIRS = {
    "square": (square_with_hole(0.5), square_with_hole(0.25).moved(1.5 * square_with_hole(0.25).vertices)),
    "islands": (islands(), mesh(*(ring(12, r) for r in (1.1, 0.62, 0.35)))),
}


@pytest.mark.parametrize(("seed", "count"), slow_after(1, [(6, 40), (7, 600)], thorough_after=1))
def test_certificates_and_checker_agree(seed: int, count: int) -> None:
    """Of motions, no certificate says more than the checker; on a coarse grid, so that exact contacts are common."""
    random = np.random.default_rng(seed)
    held, free = set(), set()
    for k in range(count):
        fine, cage = PAIRS["islands" if k >= 40 and k % 2 else "square"]
        cage = moved_a_little(random_offsets(random), cage, (0.05, 0.05, 0.3, 1.0)[k % 4])
        held.add(core.verify(cage, fine).holds)
        assert core.verify(cage, fine).holds == bool(check(fine, cage))
    for _ in range(count):
        fine, cage = mesh([(1, 1), (2, 1), (2, 2), (1, 2)]), mesh(SQUARE)
        steps = [
            np.stack([moved_a_little(random_offsets(random), each, 1.0).vertices, each.vertices])
            for each in (cage, fine)
        ]
        free.add(certified := core.verify_motion(cage, fine, *steps).free)
        assert check(fine, way(cage, fine, *steps)) or not certified
    assert held == free == {True, False}


CHANGES: dict[str, Any] = {
    "cage": lambda level: replace(level, cage=level.cage.moved(0.9 * level.cage.vertices)),
    "cage, a little": lambda level: replace(level, cage=level.cage.moved((1.0 + 1e-15) * level.cage.vertices)),
    "a step": lambda level: with_steps(level, cage=lambda steps: steps[0] * 0.5),
    "fine steps": lambda level: with_steps(level, fine=lambda steps: steps * (1.0 + 1e-15)),
    "wanted clearance": lambda level: replace(level, report=replace(level.report, wanted_clearance=1.0)),
    "grid": lambda level: replace(level, report=replace(level.report, grid=0.5)),
    "stored": lambda level: replace(level, report=replace(level.report, stored="float16")),
}


def with_steps(level: Level, cage: Any = None, fine: Any = None) -> Level:
    """A level with a changed second step of its cage, or changed steps of its fine mesh."""
    path = level.reinflation
    cages, moving = path.cage_steps.copy(), path.moving_steps
    if cage is not None:
        cages[1] = cage(cages)
    return replace(
        level, reinflation=replace(path, cage_steps=cages, moving_steps=moving if fine is None else fine(moving))
    )


@pytest.fixture(scope="module")
def letter() -> Level:
    return nested_cages(letter_a(), [letter_a_coarse()], FAST)[0]


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES.keys())
def test_a_level_that_was_changed_is_none(letter: Level, change: Any) -> None:
    assert check(letter_a(), letter)
    assert not check(letter_a(), change(letter))


def test_these_tests_check_levels_when_they_are_made(letter: Level) -> None:
    with pytest.raises(AssertionError):
        Hierarchy(letter.fine, (CHANGES["cage"](letter),))
    with pytest.raises(AssertionError):
        Hierarchy(letter.fine, (CHANGES["a step"](letter),))
