"""Counts of vertices: larger ones than the drawing's are clamped, and numbers per loop shared out anew, with notes."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core import (
    ArcLength,
    Mesh,
    NestingError,
    OnCurve,
    OuterHull,
    Settings,
    nested_cages,
)
from nestedcages_core.decimation import Decimation
from nestedcages_core.decimation.budget import clamped, shared_anew
from support.shapes import annulus, assert_nested, ring


def banana(inner: float, outer: float, count: int) -> np.ndarray:
    """A ring with a gap on the right, (2 count, 2)."""
    turn = np.linspace(0.3, 5.8, count)
    along = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return np.concatenate([outer * along, inner * along[::-1]])


def test_clamping_is_noted() -> None:
    fine = annulus(8)
    assert clamped(16, fine) == (16, ())
    count, (note,) = clamped(64, fine)
    assert count == 16
    assert note == "A cage has no more vertices than what it encloses: 16, not 64."


@pytest.mark.parametrize("levels", [[64], [64, 500], [12, 16]])
def test_levels_above_the_drawings_own_are_clamped(levels: list[int]) -> None:
    hierarchy = nested_cages(annulus(8), levels, Settings(decimation=OuterHull()))
    inside = 16
    for level, wanted in zip(hierarchy.levels, sorted(levels, reverse=True), strict=True):
        assert_nested(level.cage, level.fine)
        assert len(level.cage.vertices) == min(wanted, inside)
        assert any("no more vertices than what it encloses" in note for note in level.report.notes) == (wanted > inside)
        inside = len(level.cage.vertices)


def test_a_coarse_mesh_of_ones_own_may_have_more_vertices_than_the_drawing() -> None:
    level = nested_cages(Mesh.from_loops([ring(8)]), [Mesh.from_loops([ring(24, 1.3)])]).levels[0]
    assert len(level.cage.vertices) == 24
    assert_nested(level.cage, level.fine)


def test_numbers_per_loop_that_do_not_fit_are_shared_out_anew() -> None:
    """Nested rings with gaps: with 14 and 6 vertices the inner ones block each other, with 60 in all they do not."""
    fine = Mesh.from_loops([banana(0.9, 1.1, 60), banana(0.6, 0.8, 40), banana(0.3, 0.5, 30)])
    wanted = [40, 14, 6]
    coarse = OuterHull().decimate(fine, wanted)
    sizes = [len(loop) for loop in coarse.loops]
    assert sum(sizes) == 60
    assert sizes != wanted
    assert_nested(coarse, fine)
    assert "redistributed" in shared_anew(wanted, coarse)[0]
    assert shared_anew(sizes, coarse) == shared_anew(60, coarse) == ()


METHODS = (OuterHull(), OnCurve(), ArcLength())

TINY_EDGES = {
    "square underflows": [(0, 0), (1, 0), (0, 1), (0, 1e-200)],
    "subnormal": [(0, 0), (1, 0), (1, 1), (0.5, 1.5), (0, 1), (0, 1e-310)],
    "no area in float64": [(0, 1), (1.2e-38, 0), (-1, 0), (0, 1.2e-38)],
    "subnormal corners": [(0, 0), (1e-320, 0), (1, 0), (1, 1), (0, 1), (0, 1e-320)],
}


@pytest.mark.parametrize("name", TINY_EDGES)
@pytest.mark.parametrize("count", [3, 4])
def test_edges_whose_squares_underflow_are_caged(name: str, count: int) -> None:
    fine = Mesh.from_loops([TINY_EDGES[name]])
    level = nested_cages(fine, [count]).levels[0]
    assert level.report.strict
    assert level.report.simple
    assert len(level.cage.vertices) == count


@pytest.mark.parametrize("method", METHODS, ids=repr)
@pytest.mark.parametrize("name", TINY_EDGES)
def test_every_decimation_survives_them(name: str, method: Decimation) -> None:
    fine = Mesh.from_loops([TINY_EDGES[name]])
    for count in (3, 4):
        try:
            assert len(method.decimate(fine, count, clearance=1e-5).vertices) == count
        except NestingError as error:
            assert str(error).endswith((".", "hull."))
