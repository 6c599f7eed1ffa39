"""Symmetric cages: symmetric to the last bit, certified, with as few vertices as asked."""

from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import (
    Area,
    DetectSymmetry,
    Mesh,
    Mirror,
    NestedCagesError,
    Rotation,
    inner_cages,
    nested_cages,
    verify,
)
from support.judging import codes, is_mirrored, is_symmetric, note, rejected
from support.marks import slow_after
from support.shapes import letter_a, polygon, ring, star

pytestmark = pytest.mark.slow

AXES = (Mirror(), Mirror((0.25, 0.0)), Mirror((0.1, 3.0), (1.0, 0.0)), Mirror((0.3, -0.2), (1.0, 2.0)))


def blob(seed: int, symmetry: Any, count: int = 60) -> Mesh:
    """A wavy disc that has the symmetry; its vertices are images of each other."""
    rng = np.random.default_rng(seed)
    turn = np.linspace(0.0, 2.0 * np.pi / symmetry.order, count // symmetry.order, endpoint=False)
    turn = turn + 0.5 * turn[1]
    radius = np.full(len(turn), 1.0)
    mirrored = isinstance(symmetry, Mirror)
    for wave in range(1, 4):
        shape = np.cos if mirrored else lambda x: np.cos(x + rng.uniform(0.0, 6.0))
        radius += rng.uniform(-0.12, 0.12) * shape(symmetry.order * wave * turn / (2 if mirrored else 1))
    part = radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    if mirrored:
        along = np.array(symmetry.direction) / np.hypot(*symmetry.direction)
        part = part @ np.stack([along, [-along[1], along[0]]]) + symmetry.point
        return Mesh.from_loops([np.concatenate([part, symmetry.image(part)[::-1]])])
    return Mesh.from_loops([np.concatenate([symmetry.image(part + symmetry.centre, k) for k in range(symmetry.order)])])


def assert_symmetric(level: core.Level, symmetry: Any) -> None:
    """Certified, and symmetric at every step."""
    outer, inner = (level.fine, level.cage) if level.inside else (level.cage, level.fine)
    assert verify(outer, inner, level.report.wanted_clearance)
    for step in (level.cage.vertices, *level.reinflation.cage_steps):
        assert is_symmetric(step, symmetry)
        if isinstance(symmetry, Mirror) and 0.0 in symmetry.direction:
            axis = 0 if symmetry.direction[0] == 0.0 else 1
            assert is_mirrored(step, axis, symmetry.point[axis])


def on_axis(cage: Mesh, mirror: Mirror) -> int:
    """The number of vertices that are their own image."""
    return int((np.abs(mirror.image(cage.vertices) - cage.vertices).max(axis=1) < 1e-12).sum())


@pytest.mark.parametrize("count", slow_after(1, [9, 16], thorough_after=1))
@pytest.mark.parametrize("symmetry", AXES)
def test_mirrored_vertices_are_mirrored_to_the_last_bit(symmetry: Mirror, count: int) -> None:
    level = nested_cages(blob(3, symmetry), count, symmetry=symmetry)[0]
    assert_symmetric(level, symmetry)
    assert len(level.cage.vertices) == count and on_axis(level.cage, symmetry) % 2 == count % 2
    assert level.excess < 1.1 * nested_cages(blob(3, symmetry), count)[0].excess


@pytest.mark.parametrize("order", slow_after(1, [3, 4, 2, 7]))
def test_rotations(order: int) -> None:
    symmetry = Rotation((0.4, -1.3), order)
    fine = blob(order, symmetry, 12 * order)
    level = nested_cages(fine, 3 * order, symmetry=symmetry)[0]
    assert_symmetric(level, symmetry)
    assert len(level.cage.vertices) == 3 * order and level.excess < 1.6 * nested_cages(fine, 3 * order)[0].excess


@pytest.mark.parametrize("seed", slow_after(0, range(40), thorough_after=4))
def test_random_shapes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    symmetry = [*AXES, Rotation((0.0, 1.0), 3), Rotation((1.0, 0.0), 2)][seed % 6]
    count = int(rng.integers(6, 25))
    level = nested_cages(blob(seed, symmetry), count, symmetry=symmetry)[0]
    assert_symmetric(level, symmetry)
    assert count - symmetry.order < len(level.cage.vertices) <= count


def test_around_a_disc_symmetric_cages_are_regular_polygons() -> None:
    """Which have the symmetries that are asked for, where the count allows."""
    fine = Mesh.from_loops([ring(120, 1.0, np.pi / 120)])
    for symmetry, count in ((Mirror(), 6), (Mirror(), 5), (Rotation((0.0, 0.0), 3), 6), (Rotation((0.0, 0.0), 4), 8)):
        level = nested_cages(fine, count, symmetry=symmetry, clearance=1e-6)[0]
        assert_symmetric(level, symmetry)
        assert level.cage.area == pytest.approx(count * np.tan(np.pi / count), rel=2e-3)


def test_holes_pairs_of_parts_and_several_levels() -> None:
    eye = np.array([[0.5, 0.4], [0.9, 0.4], [0.9, 0.7], [0.7, 0.8], [0.5, 0.7]])
    head = np.array([[-1.5, -1.0], [1.5, -1.0], [1.7, 0.5], [1.2, 1.4], [-1.2, 1.4], [-1.7, 0.5]])
    ear = np.array([[2.0, 0.0], [2.6, 0.1], [2.4, 0.9]])
    mirror = Mirror()
    fine = Mesh.from_loops([head, eye, mirror.image(eye), ear, mirror.image(ear)])
    for level in nested_cages(fine, [21, 18], symmetry=mirror):
        assert_symmetric(level, mirror)
        assert sorted(level.cage.loop_signs) == sorted(fine.loop_signs)


@pytest.mark.slow
def test_symmetric_costs_little_and_inner_cages_too() -> None:
    fine = letter_a()
    free = nested_cages(fine, 36)[0].excess
    assert nested_cages(fine, 36, symmetry=Mirror())[0].excess < 1.1 * free
    inner = inner_cages(fine, 30, symmetry=Mirror())[0]
    assert_symmetric(inner, Mirror())
    assert inner.excess > 1.2 * inner_cages(fine, 30)[0].excess


def test_counts_that_cannot_be_had() -> None:
    level = nested_cages(star(9), 20, symmetry=Rotation((0, 0), 9))[0]
    data = note(level, "note.count").data
    assert len(level.cage.vertices) == 18 == data["given"] and data["asked"] == 20
    assert len(nested_cages(star(9), 4, symmetry=Rotation((0, 0), 9))[0].cage.vertices) == 9


# Detected


@pytest.mark.parametrize("turn", slow_after(1, [0.7, 0.0]))
def test_a_mirror_is_found(turn: float) -> None:
    c, s = np.cos(turn), np.sin(turn)
    moved = Mesh(letter_a().vertices @ np.array([[c, s], [-s, c]]) + [3.0, -1.0], letter_a().edges)
    level = nested_cages(moved, 24, symmetry=DetectSymmetry(), loops="keep")[0]
    found, difference = DetectSymmetry().of(moved)
    assert isinstance(found, Mirror) and difference < 1e-6 * moved.diagonal
    assert_symmetric(level, found)
    assert note(level, "note.symmetry").data["on"] == "found"
    x, y = found.direction
    assert abs(x * c + y * s) < 1e-6  # the axis of the letter is vertical before it is turned


@pytest.mark.slow
def test_rotations_are_found_and_where_there_is_nothing_that_is_noted() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 150, endpoint=False)
    whirl = Mesh.from_loops([(1.0 + 0.2 * np.cos(5 * turn) + 0.1 * np.sin(10 * turn))[:, None] * ring(150)])
    found, _ = DetectSymmetry().of(whirl)
    assert isinstance(found, Rotation) and found.order == 5
    level = nested_cages(whirl, 20, symmetry=DetectSymmetry())[0]
    assert_symmetric(level, found)
    crooked = Mesh.from_loops([[(0, 0), (4, 0), (4.3, 1), (1, 1.4), (0.5, 5)]])
    assert note(nested_cages(crooked, 4, symmetry=DetectSymmetry())[0], "note.symmetry").data["on"] == "none"


@pytest.mark.slow
def test_cages_of_mirrored_drawings_are_mirrored_where_that_costs_little() -> None:
    """Without being asked; a constraint, though it asks for nothing, turns that off."""
    turn = (np.arange(60) + 0.5) / 30 * np.pi
    for seed, count, alike in ((1, 10, True), (4, 7, True), (7, 7, False)):
        waves = np.random.default_rng(seed).normal(size=6) / np.arange(1, 7) / 4
        radius = np.maximum(1.0 + waves @ np.cos(np.arange(1, 7)[:, None] * (turn - np.pi / 2)), 0.3)
        fine = Mesh.from_loops([radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1) + 3.0])
        level, plain = (nested_cages(fine, count, constraints=nothing)[0] for nothing in ((), [core.Constraint()]))
        mirrored = level.cage.vertices * (-1.0, 1.0) + (6.0, 0.0)
        off = np.abs(mirrored[:, None] - level.cage.vertices).sum(axis=2).min(axis=1).max()
        assert (off < 1e-3) == alike
        assert level.excess <= 1.01 * plain.excess


# Drawings that are nearly symmetric, or not


@pytest.mark.parametrize("symmetry", slow_after(1, [Mirror(), DetectSymmetry(tolerance=0.02)]))
def test_a_drawing_by_hand_is_enclosed_with_its_image(symmetry: Mirror | DetectSymmetry) -> None:
    fine = letter_a()  # not quite symmetric:
    fine = Mesh(fine.vertices + 0.02 * np.sin(3.0 * fine.vertices[:, ::-1] + 1.0), fine.edges)
    level = nested_cages(fine, 30, symmetry=symmetry)[0]
    mirror = symmetry.of(fine)[0] if isinstance(symmetry, DetectSymmetry) else symmetry
    assert mirror is not None
    assert_symmetric(level, mirror)
    image = Mesh.from_loops([mirror.image(loop) for loop in fine.rings])
    assert verify(level.cage, image, 0.99 * level.report.wanted_clearance)
    both = polygon(fine).union(polygon(image))
    change = note(level, "note.outline").data["change"]
    assert change == pytest.approx(both.area / polygon(fine).area - 1.0, rel=1e-3)
    inner = inner_cages(fine, 30, symmetry=mirror)[0]
    assert verify(fine, inner.cage) and verify(image, inner.cage) and is_symmetric(inner.cage.vertices, mirror)


def test_a_gap_that_the_image_closes_is_no_hole() -> None:
    fine = Mesh.from_loops([[(-2, -2), (2, -2), (2, -1), (-1, -1), (-1, 1), (2, 1), (2, 2), (-2, 2)]])
    (cage,) = nested_cages(fine, 8, symmetry=Mirror((0.0, 0.0), (0.0, 1.0))).cages
    assert len(cage.loops) == 1 and cage.area == pytest.approx(16.0, rel=1e-3)


@pytest.mark.parametrize("seed", slow_after(1, range(60), thorough_after=5))
def test_any_drawing_is_enclosed_with_all_of_its_images(seed: int) -> None:
    """The union, or for cages inside the intersection, is that of shapely; notes have its area."""
    rng = np.random.default_rng(seed)
    symmetry = [*AXES, Rotation((0.1, 0.0), 3)][seed % 5]
    count = int(rng.integers(5, 30))
    turn = np.sort(rng.uniform(0.0, 2.0 * np.pi, count)) + 1e-3 * np.arange(count)
    loop = rng.uniform(0.3, 1.0, count)[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1) + [0.2, 0.1]
    rounded = np.round(loop, 1)  # edges that touch and coincide
    loop = rounded if rng.random() < 0.5 and shapely.Polygon(rounded).is_valid else loop
    try:
        fine, *images = (Mesh.from_loops([symmetry.image(loop, k)]) for k in range(symmetry.order))
    except core.InvalidMeshError:  # points that coincide once they are rounded
        return
    union, common = (polygon(fine),) * 2
    for image in map(polygon, images):
        union, common = union.union(image), common.intersection(image)
    for made, whole in ((nested_cages, union), (inner_cages, common)):
        try:
            level = made(fine, 24, symmetry=symmetry)[0]
        except NestedCagesError as error:
            assert made is inner_cages or error.code == "overlay.empty", error
            continue
        cage = polygon(level.cage)
        assert is_symmetric(level.cage.vertices, symmetry)
        assert cage.contains(whole) if made is nested_cages else whole.contains(cage)


def test_vertices_that_are_not_images_of_each_other_do_not_matter() -> None:
    square = [(-1, -1), (0.3, -1), (1, -1), (1, 0.2), (1, 1), (-1, 1), (-1, -0.7)]
    level = nested_cages(Mesh.from_loops([square]), 4, symmetry=Mirror())[0]
    assert_symmetric(level, Mirror())
    assert level.excess < 1e-3 and codes(level) == []


def test_an_energy_that_is_not_symmetric_gives_a_symmetric_cage() -> None:
    class Leaning(Area):
        """Pulls everything to the right."""

        def value(self, vertices: np.ndarray, successor: np.ndarray) -> float:
            return super().value(vertices, successor) - 0.05 * float(vertices[:, 0].sum())

        def gradient(self, vertices: np.ndarray, successor: np.ndarray) -> np.ndarray:
            return np.asarray(super().gradient(vertices, successor) - [0.05, 0.0])

    assert_symmetric(nested_cages(letter_a(), 24, symmetry=Mirror(), energy=Leaning(), loops="keep")[0], Mirror())


# Places and sizes


@pytest.mark.parametrize("scale", slow_after(1, [1e-5, 1e5]))
@pytest.mark.parametrize("offset", [0.0, 1e4])
def test_far_from_the_origin_and_of_any_size(scale: float, offset: float) -> None:
    centre = np.array([offset * scale, 0.3 * offset * scale])
    for symmetry in (Mirror(centre, (1.0, 0.7)), Mirror(centre), Rotation(centre, 3)):
        fine = blob(1, type(symmetry)((0.0, 0.0), symmetry.direction if isinstance(symmetry, Mirror) else 3))
        level = nested_cages(Mesh(scale * fine.vertices + centre, fine.edges), 15, symmetry=symmetry)[0]
        assert_symmetric(level, symmetry)


@pytest.mark.slow
def test_symmetries_without_a_place_take_that_of_the_drawing() -> None:
    fine = Mesh(letter_a().vertices + np.array([7.25, 3.0]), letter_a().edges)
    assert_symmetric(nested_cages(fine, 24, symmetry=Mirror(None), loops="keep")[0], Mirror((7.25, 0.0)))
    wheel = blob(4, Rotation((0.0, 0.0), 5))
    assert_symmetric(nested_cages(wheel, 15, symmetry=Rotation(None, 5))[0], Rotation((0.0, 0.0), 5))
    with pytest.raises(NestedCagesError):
        Mirror(None).image(fine.vertices)


@pytest.mark.parametrize("symmetry", [Mirror((0.1, 0.2), (1.0, 2.0)), Rotation((0.1, 0.2), 5)])
def test_images_are_reflections_and_turns_and_each_its_own(symmetry: Mirror | Rotation) -> None:
    """To round-off, by shapely; and bit by bit the same alone and together."""
    points = np.random.default_rng(1).normal(size=(73, 2))
    images = symmetry.image(points)
    assert all(np.array_equal(symmetry.image(each[None])[0], image) for each, image in zip(points, images, strict=True))
    if isinstance(symmetry, Rotation):
        turned = shapely.affinity.rotate(shapely.MultiPoint(points), 72.0, origin=(0.1, 0.2))
    else:
        angle = np.degrees(np.arctan2(2.0, 1.0))
        flat = shapely.affinity.rotate(shapely.MultiPoint(points), -angle, origin=(0.1, 0.2))
        turned = shapely.affinity.rotate(
            shapely.affinity.scale(flat, 1.0, -1.0, origin=(0.1, 0.2)), angle, origin=(0.1, 0.2)
        )
    assert np.abs(shapely.get_coordinates(turned) - images).max() < 1e-14


@pytest.mark.slow
def test_images_that_are_too_many_are_refused_at_once() -> None:
    square = Mesh.from_loops([[(0, 0), (1, 0), (1, 1), (0, 1)]])
    with rejected("limit.exceeded"):
        nested_cages(square, 16, symmetry=Rotation((0.5, 0.5), 1_000_000))
    assert len(nested_cages(square, 16, symmetry=Rotation((0.5, 0.5), 100))[0].cage.vertices) == 100


def test_meshes_of_ones_own_that_lack_the_symmetry_are_replaced_or_refused() -> None:
    coarse, mirror = Mesh.from_loops([[(-3, -3), (3, -3), (0, 6), (-3, 3)]]), Mirror((0, 0), (1, 0))
    with rejected("symmetry.not_found"):
        nested_cages(star(), coarse, symmetry=mirror, fallback=None)
    level = nested_cages(star(), coarse, symmetry=mirror)[0]
    assert_symmetric(level, mirror)
    assert "note.start" in codes(level) and len(level.cage.vertices) <= 4
