"""Symmetric cages: symmetric to the last bit, certified, with as few vertices as asked."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import (
    Area,
    Found,
    InvalidMeshError,
    Level,
    Mesh,
    Mirror,
    NestedCagesError,
    Rotation,
    Settings,
    inner_cages,
    nested_cages,
    verify,
)
from nestedcages_core.constraints import Constraint
from nestedcages_core.constraints.symmetric import Symmetric
from nestedcages_core.geometry.group import Orbits, Symmetry, mirror_axis
from nestedcages_core.geometry.solids import overlay
from support.marks import slow_after
from support.shapes import letter_a, star

AXES = (Mirror(), Mirror((0.25, 0.0)), Mirror((0.1, 3.0), (1.0, 0.0)), Mirror((0.3, -0.2), (1.0, 2.0)))
COORDINATE = st.floats(-1e3, 1e3).filter(lambda value: value == 0.0 or abs(value) > 1e-9)


def blob(seed: int, symmetry: Symmetry, count: int = 60) -> Mesh:
    """A wavy disc that has the symmetry; its vertices are images of each other."""
    rng = np.random.default_rng(seed)
    turn = np.linspace(0.0, 2.0 * np.pi / symmetry.order, count // symmetry.order, endpoint=False)
    turn = turn + 0.5 * turn[1]
    radius = np.full(len(turn), 1.0)
    for wave in range(1, 4):
        shape = np.cos if symmetry.reverses else lambda x: np.cos(x + rng.uniform(0.0, 6.0))
        radius += rng.uniform(-0.12, 0.12) * shape(symmetry.order * wave * turn / (2 if symmetry.reverses else 1))
    part = radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    if isinstance(symmetry, Mirror):
        along = np.array(symmetry.direction) / np.hypot(*symmetry.direction)
        part = part @ np.stack([along, [-along[1], along[0]]]) + symmetry.point
        return Mesh.from_loops([np.concatenate([part, symmetry.image(part)[::-1]])])
    assert isinstance(symmetry, Rotation)
    part = part + symmetry.centre
    return Mesh.from_loops([np.concatenate([symmetry.image(part, k) for k in range(symmetry.order)])])


def orbits(cage: Mesh, symmetry: Symmetry) -> Orbits:
    """The orbits of a cage that is symmetric to the last bit."""
    found = Orbits.of(cage.vertices, cage.successor, symmetry, 1e-9 * cage.diagonal)
    assert found is not None
    assert_symmetric(cage.vertices, found)
    return found


def assert_symmetric(vertices: np.ndarray, found: Orbits) -> None:
    """To the last bit; a vertex on an axis that is not along a coordinate lies there up to rounding."""
    again = found.symmetrised(vertices)
    on_axis = found.on_axis[found.orbit]
    assert np.array_equal(again[~on_axis], vertices[~on_axis])
    symmetry = found.symmetry
    exact = isinstance(symmetry, Mirror) and 0.0 in symmetry.direction
    assert np.abs(again[on_axis] - vertices[on_axis]).max(initial=0.0) <= (
        0.0 if exact else 1e-14 * np.abs(again).max()
    )


def check(level: Level, symmetry: Symmetry) -> None:
    """Certified, and symmetric at every step."""
    assert verify(level.cage, level.fine, level.report.wanted_clearance)
    found = orbits(level.cage, symmetry)
    for step in level.reinflation.cage_steps:
        assert_symmetric(step, found)


@pytest.mark.parametrize("count", slow_after(1, [9, 16], thorough_after=1))
@pytest.mark.parametrize("symmetry", AXES)
def test_mirrored_vertices_are_mirrored_to_the_last_bit(symmetry: Mirror, count: int) -> None:
    level = nested_cages(blob(3, symmetry), [count], Settings(symmetry=symmetry)).levels[0]
    check(level, symmetry)
    assert len(level.cage.vertices) == count
    found = orbits(level.cage, symmetry)
    assert found.on_axis.sum() % 2 == count % 2
    if 0.0 in symmetry.direction:
        across = 0 if symmetry.direction[0] == 0.0 else 1
        cage, image = level.cage.vertices, level.cage.vertices[found.partner]
        assert np.array_equal(symmetry.image(cage), image)
        assert np.array_equal(cage[:, 1 - across], image[:, 1 - across])
        on_axis = found.partner == np.arange(count)
        assert (cage[on_axis, across] == symmetry.point[across]).all()


@pytest.mark.parametrize("order", [2, 3, 4, 7])
def test_rotations(order: int) -> None:
    symmetry = Rotation((0.4, -1.3), order)
    level = nested_cages(blob(order, symmetry, 12 * order), [3 * order], Settings(symmetry=symmetry)).levels[0]
    check(level, symmetry)
    assert len(level.cage.vertices) == 3 * order


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from([*AXES, Rotation((0.0, 1.0), 3), Rotation((1.0, 0.0), 2)]),
       st.integers(6, 24))  # fmt: skip
def test_random_shapes(seed: int, symmetry: Symmetry, count: int) -> None:
    level = nested_cages(blob(seed, symmetry), [count], Settings(symmetry=symmetry)).levels[0]
    check(level, symmetry)
    assert count - symmetry.order < len(level.cage.vertices) <= count


@given(st.sampled_from(AXES[:3]), st.lists(st.tuples(COORDINATE, COORDINATE), min_size=1, max_size=5))
def test_settled_points_are_the_image_of_their_image(symmetry: Mirror, points: list[tuple[float, float]]) -> None:
    settled = symmetry.settled(np.array(points))
    assert np.array_equal(symmetry.image(symmetry.image(settled)), settled)


def test_holes_pairs_of_parts_and_several_levels() -> None:
    eye = np.array([[0.5, 0.4], [0.9, 0.4], [0.9, 0.7], [0.7, 0.8], [0.5, 0.7]])
    head = np.array([[-1.5, -1.0], [1.5, -1.0], [1.7, 0.5], [1.2, 1.4], [-1.2, 1.4], [-1.7, 0.5]])
    ear = np.array([[2.0, 0.0], [2.6, 0.1], [2.4, 0.9]])
    mirror = Mirror()
    fine = Mesh.from_loops([head, eye, mirror.image(eye), ear, mirror.image(ear)])
    hierarchy = nested_cages(fine, [21, 18], Settings(symmetry=mirror))
    for level in hierarchy.levels:
        check(level, mirror)
        assert level.cage.has_loops_like(fine)


def test_symmetric_costs_little_and_inner_cages_too() -> None:
    fine = letter_a()
    free = nested_cages(fine, [36]).levels[0].report.excess
    alike = nested_cages(fine, [36], Settings(symmetry=Mirror())).levels[0].report.excess
    assert alike < 1.1 * free
    inner = inner_cages(fine, [30], Settings(symmetry=Mirror())).levels[0]
    assert verify(inner.fine, inner.cage)
    orbits(inner.cage, Mirror())


def test_counts_that_cannot_be_had() -> None:
    level = nested_cages(star(9), [20], Settings(symmetry=Rotation((0, 0), 9))).levels[0]
    assert len(level.cage.vertices) == 18
    assert any("the cage can have 18" in note for note in level.report.notes)
    level = nested_cages(star(9), [4], Settings(symmetry=Rotation((0, 0), 9))).levels[0]
    assert len(level.cage.vertices) == 9


@pytest.mark.parametrize("turn", slow_after(1, [0.0, 0.7]))
def test_a_mirror_is_found(turn: float) -> None:
    c, s = np.cos(turn), np.sin(turn)
    moved = letter_a().moved(letter_a().vertices @ np.array([[c, s], [-s, c]]) + [3.0, -1.0]).validated()
    level = nested_cages(moved, [24], Settings(symmetry=Found())).levels[0]
    found, difference = Found().of(moved)
    assert isinstance(found, Mirror)
    assert difference < 1e-6 * moved.diagonal
    check(level, found)
    assert "Found a mirror" in level.report.notes[0]
    x, y = found.direction
    assert abs(x * c + y * s) < 1e-6  # the axis of the letter is vertical before it is turned


def test_rotations_are_found_and_nothing_is_said_to_be_nothing() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 150, endpoint=False)
    radius = 1.0 + 0.2 * np.cos(5 * turn) + 0.1 * np.sin(10 * turn)
    whirl = Mesh.from_loops([radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)])
    found, _ = Found().of(whirl)
    assert isinstance(found, Rotation)
    assert found.order == 5
    crooked = Mesh.from_loops([[(0, 0), (4, 0), (4.3, 1), (1, 1.4), (0.5, 5)]])
    level = nested_cages(crooked, [4], Settings(symmetry=Found())).levels[0]
    assert "has no symmetry" in level.report.notes[0]


def test_bad_symmetries_are_rejected() -> None:
    for wrong in (lambda: Mirror((0.0, np.nan)), lambda: Mirror((0, 0), (0, 0)), lambda: Mirror("up"),
                  lambda: Rotation((0, 0), 1), lambda: Settings(symmetry="x"), lambda: Settings(symmetry=Mirror),
                  lambda: Found(-1.0)):  # fmt: skip
        with pytest.raises(NestedCagesError):
            wrong()
    with pytest.raises(NestedCagesError, match="one symmetry at most"):
        nested_cages(star(), 12, symmetry=Mirror(), constraints=[Symmetric(Rotation())])
    coarse = Mesh.from_loops([[(-3, -3), (3, -3), (0, 6), (-3, 3)]])
    with pytest.raises(NestedCagesError, match="The start does not have a mirror"):
        nested_cages(star(), [coarse], Settings(symmetry=Mirror((0, 0), (1, 0)), fallback=None))
    level = nested_cages(star(), [coarse], Settings(symmetry=Mirror((0, 0), (1, 0)))).levels[0]
    check(level, Mirror((0, 0), (1, 0)))
    assert "does not have a mirror" in level.report.notes[0]


def test_an_energy_that_is_not_symmetric_gives_a_symmetric_cage() -> None:
    class Leaning(Area):
        """Pulls everything to the right."""

        def value(self, vertices, successor):
            return super().value(vertices, successor) - 0.05 * float(vertices[:, 0].sum())

        def gradient(self, vertices, successor):
            return super().gradient(vertices, successor) - [0.05, 0.0]

    level = nested_cages(letter_a(), [24], Settings(symmetry=Mirror(), energy=Leaning())).levels[0]
    check(level, Mirror())


def hand_drawn(amount: float = 0.02) -> Mesh:
    """The letter A, not quite symmetric."""
    fine = letter_a()
    return fine.moved(fine.vertices + amount * np.sin(3.0 * fine.vertices[:, ::-1] + 1.0)).validated()


@pytest.mark.parametrize("symmetry", slow_after(1, [Mirror(), Found(tolerance=0.02)]))
def test_a_drawing_by_hand_is_enclosed_with_its_image(symmetry: Mirror | Found) -> None:
    fine = hand_drawn()
    level = nested_cages(fine, [30], Settings(symmetry=symmetry)).levels[0]
    mirror = symmetry.of(fine)[0] if isinstance(symmetry, Found) else symmetry
    check(level, mirror)
    image = Mesh(mirror.image(fine.vertices), fine.edges)
    assert verify(level.cage, image, 0.99 * level.report.wanted_clearance)
    assert any("cover" in note for note in level.report.notes)
    inner = inner_cages(fine, [30], Settings(symmetry=mirror)).levels[0]
    assert verify(fine, inner.cage)
    assert verify(image, inner.cage)
    orbits(inner.cage, mirror)


def test_other_vertices_on_both_sides_do_not_matter() -> None:
    square = [(-1, -1), (0.3, -1), (1, -1), (1, 0.2), (1, 1), (-1, 1), (-1, -0.7)]
    level = nested_cages(Mesh.from_loops([square]), [4], Settings(symmetry=Mirror())).levels[0]
    check(level, Mirror())
    assert level.report.excess < 1e-3
    assert level.report.notes == ()


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from([*AXES, Rotation((0.1, 0.0), 3)]), st.booleans())
def test_overlays_are_those_of_shapely(seed: int, symmetry: Symmetry, intersection: bool) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(5, 40))
    turn = np.sort(rng.uniform(0.0, 2.0 * np.pi, count)) + 1e-3 * np.arange(count)
    loop = rng.uniform(0.3, 1.0, count)[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1) + [0.2, 0.1]
    if rng.random() < 0.5:
        loop = np.round(loop, 1)  # edges that touch and coincide
    try:
        meshes = [Mesh.from_loops([symmetry.image(loop, k)]) for k in range(symmetry.order)]
    except InvalidMeshError:
        return
    wanted = shapely.geometry.shape(meshes[0])
    for mesh in meshes[1:]:
        wanted = (
            wanted.intersection(shapely.geometry.shape(mesh))
            if intersection
            else wanted.union(shapely.geometry.shape(mesh))
        )
    try:
        found = shapely.geometry.shape(overlay(meshes, intersection=intersection))
    except InvalidMeshError:
        # nothing in common, or loops that touch
        assert wanted.area < 1e-9 or not touching_free(wanted)
        return
    assert found.symmetric_difference(wanted).area < 1e-7


def touching_free(shape: shapely.Geometry) -> bool:
    """Whether no vertex of a shape is the vertex of two of its loops."""
    parts = [ring.coords[:-1] for part in getattr(shape, "geoms", [shape]) if part.geom_type == "Polygon"
             for ring in [part.exterior, *part.interiors]]  # fmt: skip
    points = np.concatenate([np.array(part) for part in parts])
    close = np.abs(points[:, None] - points[None]).max(axis=2) < 1e-6
    return bool(close.sum() == len(points))


@pytest.mark.parametrize("scale", slow_after(1, [1e-5, 1e5]))
@pytest.mark.parametrize("offset", [0.0, 1e4])
def test_far_from_the_origin_and_of_any_size(scale: float, offset: float) -> None:
    centre = np.array([offset * scale, 0.3 * offset * scale])
    for symmetry in (Mirror(centre, (1.0, 0.7)), Mirror(centre), Rotation(centre, 3)):
        fine = blob(1, type(symmetry)((0.0, 0.0), symmetry.direction if isinstance(symmetry, Mirror) else 3))
        moved = Mesh(scale * fine.vertices + centre, fine.edges)
        level = nested_cages(moved, [15], Settings(symmetry=symmetry)).levels[0]
        check(level, symmetry)


def test_symmetries_without_a_place_take_that_of_the_drawing() -> None:
    fine = letter_a().moved(letter_a().vertices + np.array([7.25, 3.0])).validated()
    level = nested_cages(fine, [24], Settings(symmetry=Mirror(None))).levels[0]
    check(level, Mirror((7.25, 0.0)))
    wheel = blob(4, Rotation((0.0, 0.0), 5))
    level = nested_cages(wheel, [15], Settings(symmetry=Rotation(None, 5))).levels[0]
    check(level, Rotation((0.0, 0.0), 5))
    with pytest.raises(NestedCagesError, match="without a point"):
        Mirror(None).image(fine.vertices)


def test_images_that_are_too_many_are_told_at_once() -> None:
    square = Mesh.from_loops([[(0, 0), (1, 0), (1, 1), (0, 1)]])
    with pytest.raises(NestedCagesError, match="4000000, and at most 100000 can be overlaid") as caught:
        nested_cages(square, 16, symmetry=Rotation((0.5, 0.5), 1_000_000))
    assert caught.value.code == "limit.exceeded"
    level = nested_cages(square, 16, symmetry=Rotation((0.5, 0.5), 100)).levels[0]
    assert len(level.cage.vertices) == 100


@pytest.mark.slow
def test_cages_of_mirrored_drawings_are_mirrored_where_that_costs_little() -> None:
    turn = (np.arange(60) + 0.5) / 30 * np.pi
    for seed, count, alike in ((1, 10, True), (4, 7, True), (7, 7, False)):
        waves = np.random.default_rng(seed).normal(size=6) / np.arange(1, 7) / 4
        radius = np.maximum(1.0 + waves @ np.cos(np.arange(1, 7)[:, None] * (turn - np.pi / 2)), 0.3)
        fine = Mesh.from_loops([radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1) + 3.0])
        axis = mirror_axis(fine)
        assert axis is not None and abs(axis[0][0] - 3.0) < 1e-9 and abs(axis[1][0]) < 1e-9
        cage, plain = (nested_cages(fine, count, constraints=nothing)[0] for nothing in ((), [Constraint()]))
        mirrored = cage.cage.vertices * (-1.0, 1.0) + (6.0, 0.0)
        off = np.abs(mirrored[:, None] - cage.cage.vertices).sum(axis=2).min(axis=1).max()
        assert (off < 1e-3) == alike
        assert cage.report.excess <= 1.01 * plain.report.excess
    assert mirror_axis(blob(3, Rotation((0.0, 0.0), 3))) is None
