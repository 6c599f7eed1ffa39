"""The main job: certified cages for the shapes of the paper, drawn here and checked by shapely; progress, refusals."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import (
    IPC,
    ArcLength,
    Area,
    BoundaryARAP,
    FlowError,
    Hierarchy,
    InvalidMeshError,
    Mesh,
    NestedCagesError,
    NestedCagesRun,
    NestingError,
    OnCurve,
    OuterHull,
    Progress,
    Settings,
    inner_cages,
    nested_cages,
    verify,
)
from nestedcages_core.decimation.base import Count
from support.marks import slow_after
from support.shapes import (
    annulus,
    assert_nested,
    islands,
    letter_a,
    letter_a_coarse,
    octagon_with_hole,
    ring,
    square_with_hole,
    star,
)


def assert_sound(hierarchy: Hierarchy, clearance: float | None = None) -> None:
    """Everything that a result promises."""
    inner = hierarchy.fine
    wanted = 1e-5 * hierarchy.fine.diagonal if clearance is None else clearance
    for level in hierarchy.levels:
        assert level.fine is inner
        assert_nested(level.cage, level.fine)
        assert level.report.strict
        assert level.report.simple
        assert level.report.clearance >= wanted * (1 - 1e-9)
        assert verify(level.cage, level.fine, wanted).holds
        assert (level.cage.edges == level.coarse.edges).all()
        steps = level.reinflation
        assert (level.flow.steps[0] == level.fine.vertices).all()
        assert (steps.fine_steps[0] == level.flow.steps[-1]).all()
        assert (steps.fine_steps[steps.tightening_start :] == level.fine.vertices).all()
        assert (steps.cage_steps[0] == level.coarse.vertices).all()
        assert (steps.cage_steps[-1] == level.cage.vertices).all()
        assert len(steps.fine_steps) == len(steps.cage_steps)
        inner = level.cage


@pytest.mark.parametrize("per_ring", [16, 24, 32, 48, 64, 96, 128, 256])
def test_discs_of_table_1_come_within_3_percent(per_ring: int) -> None:
    """Annuli of radii 1 and 0.5 in a coarse one of 16 + 16 vertices (Gurditta & Jacobson 2022, Table 1)."""
    fine = annulus(per_ring)
    hierarchy = nested_cages(fine, [annulus(16)])
    assert_sound(hierarchy)
    assert hierarchy.levels[0].report.excess < 0.03
    assert hierarchy.levels[0].report.start == "flow"


def test_letter_with_its_own_coarse_mesh() -> None:
    """In the spirit of figure 1: arms, legs and a hole."""
    hierarchy = nested_cages(letter_a(), [letter_a_coarse()])
    assert_sound(hierarchy)
    assert hierarchy.levels[0].report.start == "flow"
    assert_sound(nested_cages(octagon_with_hole(), [square_with_hole()]))


@pytest.mark.parametrize("decimation", [OuterHull(), OnCurve(), ArcLength()], ids=lambda d: type(d).__name__)
@pytest.mark.parametrize("shape", slow_after(0, [islands, letter_a, star], thorough_after=1), ids=lambda s: s.__name__)
def test_several_levels_by_every_decimation(shape: object, decimation: object) -> None:
    fine = shape()  # type: ignore[operator]
    hierarchy = nested_cages(fine, [48, 24], Settings(decimation=decimation, loops="keep"))  # type: ignore
    assert_sound(hierarchy)
    assert len(hierarchy.levels[0].cage.vertices) <= 48
    assert len(hierarchy.levels[1].cage.vertices) <= 24


@pytest.mark.slow
@pytest.mark.parametrize("clearance", [0.0, 1e-4, 0.05, 0.1])
def test_the_wanted_clearance_is_kept(clearance: float) -> None:
    hierarchy = nested_cages(letter_a(), [24], Settings(clearance=clearance))
    assert_sound(hierarchy, clearance)


def test_an_outer_hull_needs_no_flow() -> None:
    level = nested_cages(star(), [24], Settings(decimation=OuterHull())).levels[0]
    assert level.report.start == "outer hull"
    assert len(level.flow.steps) == 1
    assert level.reinflation.tightening_start == 0


class BoundingPolygon:
    """A decimation that encloses, and is none of ours."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        return OuterHull().decimate(fine, count, clearance=clearance)


@pytest.mark.parametrize(
    "how",
    slow_after(1, [{"decimation": BoundingPolygon()}, {"decimation": ArcLength(), "fallback": BoundingPolygon()}]),
)
def test_another_decimation_is_not_called_an_outer_hull(how: dict[str, Any]) -> None:
    coarse = Mesh(letter_a().vertices + 3.0, letter_a().edges)  # nothing flows into that
    level = nested_cages(letter_a(), [coarse if "fallback" in how else 40], Settings(**how)).levels[0]
    assert level.report.start == "bounding polygon"


class TestRun:
    @pytest.mark.slow
    def test_it_reports_and_gives_the_same_result(self) -> None:
        fine = letter_a()
        run = NestedCagesRun(fine, [40, 20])
        reports = list(run)
        assert all(isinstance(report, Progress) for report in reports)
        assert {report.level for report in reports} == {0, 1}
        fractions = [report.fraction for report in reports]
        assert fractions == sorted(fractions)
        assert fractions[0] >= 0.0
        assert fractions[-1] <= 1.0
        direct = nested_cages(fine, [40, 20])
        for one, other in zip(run.hierarchy.levels, direct.levels, strict=True):
            assert (one.cage.vertices == other.cage.vertices).all()

    def test_errors_come_out_of_the_iteration_with_the_finished_levels(self) -> None:
        run = NestedCagesRun(letter_a(), [40, far_away()], Settings(fallback=None))
        with pytest.raises(FlowError) as caught:
            list(run)
        assert isinstance(caught.value.partial, Hierarchy)
        assert len(caught.value.partial.levels) == 1


def far_away() -> Mesh:
    coarse = letter_a_coarse()
    return Mesh(coarse.vertices + 100.0, coarse.edges)


def test_a_stuck_flow_falls_back_to_line_cycles_and_says_so() -> None:
    level = nested_cages(letter_a(), [far_away()]).levels[0]
    assert level.report.start == "line cycles"
    assert len(level.report.notes) == 1
    assert "line cycles" in level.report.notes[0]
    assert (len(level.cage.vertices), len(level.cage.loops)) == (23, 2)
    assert_nested(level.cage, level.fine)


@pytest.mark.parametrize(
    ("levels", "sentence"),
    [
        ([], "no levels"),
        (
            ["many"],
            r"A level is a number of vertices such as 24, .* or more area such as \+25%; 'many' is none of these",
        ),
        ([True], r"Level 1 must be a number of vertices, a Mesh or Within\(…\), not True"),
        (2, r"Level 1 asks for 2 vertices, but 1 loop needs at least 3\."),
        (None, r"A level must be a vertex count, .* a Mesh or Within\(…\), for instance \[64, 16\], not None"),
        ("24x", r"'24x' is none of these"),
        ([Mesh.from_loops([ring(9, 1.2)]), 2], r"Level 2 asks for 2 vertices, but 1 loop needs at least 3\."),
    ],
)
def test_levels_that_make_no_sense_are_refused(levels: object, sentence: str) -> None:
    fine = Mesh.from_loops([ring(200, 1.0), ring(40, 0.4)])
    with pytest.raises(NestingError, match=sentence):
        nested_cages(fine, levels)  # type: ignore[arg-type]


@pytest.mark.parametrize("make", [nested_cages, inner_cages])
def test_anything_that_describes_a_shape_has_cages(make: Callable[..., Hierarchy]) -> None:
    mesh = annulus(24)
    loops = [mesh.vertices[loop] for loop in mesh.loops]
    wanted = make(mesh, [12]).cages[0]
    for shape in (loops, np.array(loops), mesh.__geo_interface__, shapely.geometry.shape(mesh)):
        (level,) = make(shape, [12]).levels
        back = shapely.geometry.shape(level.cage)
        assert back.is_valid
        assert len(back.interiors) == 1
        assert back.area == pytest.approx(wanted.area, rel=1e-9)
        assert verify(*((shape, level.cage) if level.inside else (level.cage, shape)))


@pytest.mark.parametrize(
    ("fine", "error", "sentence"),
    [
        (
            None,
            NestingError,
            r"must be a Mesh, an object with __geo_interface__, an array \(k, 2\), or a list of loops",
        ),
        ("star.svg", NestingError, r"must be a Mesh, .* or a list of loops with rows \(x, y\), not str"),
        (ring(20)[:, :1], InvalidMeshError, r"Loop 0 has shape \(20, 1\), but \(k, 2\) is needed"),
        ({"type": "Point", "coordinates": [0, 0]}, InvalidMeshError, r"Point"),
    ],
)
def test_what_is_no_shape_has_no_cages(fine: object, error: type[Exception], sentence: str) -> None:
    with pytest.raises(error, match=sentence):
        nested_cages(fine, [5])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("choice", "example"),
    [
        ({"energy": "area"}, "Area()"),
        ({"energy": Area}, "Area()"),
        ({"decimation": "hull"}, "OuterHull()"),
        ({"fallback": 7}, "OuterHull()"),
        ({"flow": None}, "TwoSidedFlow()"),
        ({"tightening": False}, "Tightening()"),
        ({"contact": IPC}, "IPC()"),
    ],
)
def test_choices_that_are_no_objects_are_refused_with_an_example(choice: dict[str, object], example: str) -> None:
    with pytest.raises(NestedCagesError, match=f"must be an object such as {re.escape(example)}"):
        Settings(**choice)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("choice", "sentence"),
    [
        *(({"clearance": value}, "clearance must be a finite length") for value in (-1.0, np.nan, np.inf, "1", [0.1])),
        *(({"contact": value}, "contact must be an object such as IPC") for value in ([], "IPC")),
        ({"clearance": 1e200}, "times as long as the diagonal"),
        ({"stored": "int8"}, "stored must be float64, .* not 'int8'"),
        ({"about": 3}, "about must be a Mesh, not int"),
        ({"about": letter_a()}, "does not lie in the fine one"),
        ({"symmetry": 3}, "The symmetry must be an object such as Mirror"),
        ({"convex": True, "pins": [0]}, "Convex cages have no pins"),
    ],
)
def test_settings_that_make_no_sense_are_refused(choice: dict[str, Any], sentence: str) -> None:
    with pytest.raises(NestedCagesError, match=sentence):
        nested_cages(star(), [12], **choice)


def test_moved_meshes_are_validated_at_the_door() -> None:
    fine = Mesh.from_loops([ring(50)])
    with pytest.raises(InvalidMeshError, match="crosses itself near"):
        nested_cages(fine.moved(fine.vertices[np.random.default_rng(0).permutation(50)]), [8])
    coarse = Mesh.from_loops([ring(8)])
    with pytest.raises(InvalidMeshError, match="crosses itself near"):
        nested_cages(fine, [coarse.moved(coarse.vertices[[0, 4, 2, 6, 1, 5, 3, 7]])])
    mirrored = fine.moved(fine.vertices * np.array([1.0, -1.0]))
    assert_nested(nested_cages(mirrored, [8]).cages[0], mirrored.validated())


def test_after_a_cage_with_fewer_loops_fewer_vertices_are_enough() -> None:
    hierarchy = nested_cages(annulus(60), [Mesh.from_loops([ring(9, 1.2)]), 3])
    assert [len(cage.vertices) for cage in hierarchy.cages] == [9, 3]
    assert_nested(hierarchy.cages[1], hierarchy.cages[0])


def test_the_log_at_debug_level_tells_the_story_of_a_run(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG, logger="nestedcages_core"):
        nested_cages(letter_a(), [letter_a_coarse()])
        nested_cages(star(), [12])
    told = caplog.text
    chapters = ("flow by", "reinflation by", "tightening 1:", "tightening ended after", "start 1 of", "excess")
    for chapter in chapters:
        assert chapter in told
    caplog.clear()
    nested_cages(star(), [12])
    assert caplog.text == ""


def test_a_result_shows_itself_without_its_arrays() -> None:
    assert "array" not in repr(nested_cages(star(), [12])[0].flow)


def test_a_cage_that_its_energy_leaves_as_it_starts_says_so() -> None:
    """Energies that keep a shape have their minimum at the hull."""
    hull = Settings(energy=BoundaryARAP(), decimation=OuterHull())
    level = nested_cages(star(), [16], hull).levels[0]
    assert (level.cage.vertices == level.coarse.vertices).all()
    assert level.report.notes == (
        "The cage is the coarse mesh, where BoundaryARAP is smallest; Area() makes it tighter.",
    )
    assert not nested_cages(star(), [16], Settings(decimation=OuterHull())).levels[0].report.notes
