"""Cages inside: certified with the roles swapped, as tight as outer ones."""

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import Area, Mesh, NestingError, Settings, ShapeKeeping, StepDisplacement, inner_cages
from support.judging import assert_right, codes, gap, rejected
from support.marks import slow_after
from support.shapes import annulus, islands, letter_a, polygon, ring, square_with_hole, star


def assert_inside(level: core.Level) -> None:
    """Certified and, by shapely, inside at the clearance."""
    assert_right(level)
    assert polygon(level.fine).contains(polygon(level.cage)) and level.excess < 0.0
    assert gap(level.cage, level.fine) >= level.report.wanted_clearance * (1.0 - 1e-6)


@pytest.mark.parametrize("fine", slow_after(2, [star(), letter_a(), annulus(40), islands(), square_with_hole()]))
def test_levels_nest_inwards(fine: Mesh) -> None:
    counts = [max(len(fine.vertices) // 2, 6 * len(fine.loops)), 5 * len(fine.loops)]
    hierarchy = inner_cages(fine, counts)
    assert [len(cage.vertices) for cage in hierarchy.cages] == [min(k, len(fine.vertices)) for k in counts]
    assert hierarchy.levels[0].fine is hierarchy.fine
    assert hierarchy.levels[1].fine is hierarchy.levels[0].cage
    for level in hierarchy.levels:
        assert_inside(level)
        assert level.report.wanted_clearance == 1e-5 * fine.diagonal


def test_the_largest_octagon_in_a_disc() -> None:
    """The area of a regular octagon, whose vertices lie on those of the disc less the clearance."""
    fine = Mesh.from_loops([ring(64)])
    clearance = 1e-6
    level = inner_cages(fine, [8], Settings(clearance=clearance)).levels[0]
    octagon = 4.0 * np.sin(2.0 * np.pi / 8.0)
    assert octagon * (1.0 - 1e-5) < level.cage.area < octagon


@pytest.mark.slow
def test_as_tight_as_a_cage_around_the_complement_in_a_box() -> None:
    fine = letter_a(1)
    box = np.array([[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]]) * fine.diagonal
    others = Mesh.from_loops([box, *(fine.vertices[loop] for loop in fine.loops)])
    cage = core.nested_cages(others, [20], Settings(clearance=1e-5 * fine.diagonal)).levels[0].cage
    outer = max(np.abs(cage.loop_areas))
    in_box = outer - cage.area
    own = inner_cages(fine, [16]).levels[0].cage.area
    assert own >= in_box * (1.0 - 0.01)


def test_a_mesh_of_ones_own_is_the_start() -> None:
    fine = Mesh.from_loops([ring(64)])
    mine = Mesh.from_loops([0.5 * ring(6)])
    level = inner_cages(fine, [mine]).levels[0]
    assert level.coarse is mine
    assert level.report.start == "coarse mesh"
    assert level.cage.area > 2.5
    assert_inside(level)


def test_a_mesh_that_is_not_inside_gives_its_counts_to_the_line_cycles() -> None:
    fine = annulus(40)
    mine = annulus(10, 0.4)
    level = inner_cages(fine, [mine]).levels[0]
    assert level.report.start == "line cycles"
    assert codes(level) == ["note.start"]
    assert [len(loop) for loop in level.cage.loops] == [10, 10]
    with rejected("coarse.not_nested", NestingError):
        inner_cages(fine, [mine], Settings(fallback=None))


def test_too_few_vertices_for_a_thin_ring() -> None:
    with rejected("count.too_small", NestingError) as caught:
        inner_cages(annulus(64, 0.95), [8])
    assert inner_cages(annulus(64, 0.95), [caught.value.data["least"]])


@pytest.mark.parametrize("energy", [ShapeKeeping(), core.WeightedSum(((1.0, Area()), (0.1, StepDisplacement())))])
def test_energies(energy) -> None:
    assert_inside(inner_cages(star(), [24], Settings(energy=energy)).levels[0])


def test_far_from_the_origin_turned_and_scaled() -> None:
    fine = star(5, 60)
    wanted = inner_cages(fine, [20]).levels[0].report.excess
    c, s = np.cos(0.7), np.sin(0.7)
    other = Mesh(1e3 * fine.vertices @ np.array([[c, s], [-s, c]]) + 1e6, fine.edges)
    assert inner_cages(other, [20]).levels[0].report.excess == pytest.approx(wanted, abs=1e-3)


@pytest.mark.parametrize("seed", slow_after(0, range(8)))
def test_random_shapes(seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = Mesh.from_loops([ring(24) * random.uniform(0.3, 1.0, size=(24, 1))])
    assert_inside(inner_cages(fine, [int(random.integers(3, 25))]).levels[0])
