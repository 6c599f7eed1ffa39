"""Merged parts: one loop around a shape with specks, what it contains, and what notes say about it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import (
    Mesh,
    NestedCagesError,
    NestingError,
    OuterHull,
    Settings,
    inner_cages,
    nested_cages,
    verify,
)
from nestedcages_core.decimation.merging import Bridged, Merging
from nestedcages_core.hierarchy import Share
from support.marks import slow_after
from support.shapes import islands, polygon, ring


def sprite() -> Mesh:
    """A disc with a small hole and eight specks around it."""
    at = 1.15 * np.stack([np.cos(0.7 * np.arange(8)), np.sin(0.7 * np.arange(8))], axis=1)
    return Mesh.from_loops([ring(60), 0.05 * ring(12) + 0.3, *(ring(5, 0.02) + place for place in at)])


def test_a_sprite_with_specks_gets_one_outline() -> None:
    fine = sprite()
    level = nested_cages(fine, 16, merge=0.3).levels[0]
    assert (len(level.cage.loops), len(level.cage.vertices)) == (1, 16)
    assert verify(level.cage, fine, level.report.clearance, same_loops=False) and level.report.excess < 0.15
    assert (level.reinflation.fine_steps[-1] == fine.vertices).all()
    assert any("1 outer loop and no holes" in note for note in level.report.notes)
    with pytest.raises(NestedCagesError, match="at least 30"):
        nested_cages(fine, 16, loops="keep")


@pytest.mark.parametrize("distance", [1e-3, 0.05, 0.3, 3.0])
def test_merged_shapes_contain_the_shape_and_have_no_more_loops(distance: float) -> None:
    for fine in (sprite(), islands()):
        whole = Bridged.of(fine, distance).closed(1.0)
        assert polygon(whole).buffer(1e-9).contains(polygon(fine)) and len(whole.loops) <= len(fine.loops)


def three() -> Mesh:
    """A square with a large and a small hole, a disc 0.4 away from it, and a disc 0.9 away from that."""
    holes = [np.array([(1, 1), (1, 3), (3, 3), (3, 1)]), np.array([(3.4, 3.4), (3.4, 3.7), (3.7, 3.7), (3.7, 3.4)])]
    square = np.array([(0, 0), (4, 0), (4, 4), (0, 4)])
    return Mesh.from_loops([square, *holes, ring(24, centre=(5.4, 2.0)), ring(24, centre=(8.3, 2.0))])


@pytest.mark.parametrize(
    ("distance", "outer", "holes"), [(0.1, 3, 2), (0.35, 3, 1), (0.45, 2, 1), (0.95, 1, 1), (2.1, 1, 0), (np.inf, 1, 0)]
)
def test_parts_closer_than_the_distance_are_joined_and_holes_below_its_square_filled(
    distance: float, outer: int, holes: int
) -> None:
    fine = three()
    solid, bridged = polygon(fine), Bridged.of(fine, distance)
    for part in (0.0, 0.5, 1.0):
        whole = bridged.closed(part)
        assert (sum(whole.loop_signs > 0), sum(whole.loop_signs < 0)) == (outer, holes)
        assert polygon(whole).contains(solid.buffer(-1e-9))
        reach = 0.5 * part * (distance if np.isfinite(distance) else 0.9)
        closed = parts(solid.buffer(reach, quad_segs=4).buffer(-reach, quad_segs=4))
        large = [[hole for hole in each.interiors if shapely.Polygon(hole).area >= distance**2] for each in closed]
        filled = [shapely.Polygon(each.exterior, kept) for each, kept in zip(closed, large, strict=True)]
        bridges = sum(0.02 * gap**2 for gap in (0.4, 0.9) if gap < distance)
        assert whole.area == pytest.approx(shapely.union_all(filled).area, abs=1.2 * bridges + 2e-3)


def parts(solid: shapely.Geometry) -> list[shapely.Polygon]:
    return list(getattr(solid, "geoms", [solid]))


def test_the_shape_of_least_area_is_used() -> None:
    """Of the shape itself, its bridges, and gaps closed over half and all of the distance."""
    fine, made = three(), list[Mesh]()

    class Noted:
        def decimate(self, shape: Mesh, count: Any, *, clearance: float | None = None) -> Mesh:
            made.append(OuterHull().decimate(shape, count, clearance=clearance))
            return made[-1]

    found = Merging(1.0, Noted()).decimate(fine, 24)
    assert len(made) == 4 and [len(mesh.loops) for mesh in made] == [5, 2, 2, 2]
    assert made[1].area < made[2].area < made[3].area
    assert found is min(made, key=lambda mesh: mesh.area) and len(found.vertices) == 24
    made.clear()
    assert len(Merging(1.0, Noted()).decimate(fine, 14).loops) == 2 and len(made) == 3
    with pytest.raises(NestingError, match="5 vertices are too few") as caught:
        Merging(1.0).decimate(fine, 5)
    assert caught.value.data["least"] == 6
    assert len(Merging(np.inf).decimate(fine, 60).loops) == 1
    with pytest.raises(NestedCagesError, match="Merging"):
        Merging(-1.0)


def test_all_parts_share_one_loop() -> None:
    for fine in (sprite(), Mesh.from_loops([ring(24), 0.9 * ring(24)])):
        level = nested_cages(fine, Share(0.02), merge=np.inf).levels[0]
        assert len(level.cage.loops) == 1 and verify(level.cage, fine, level.report.clearance, same_loops=False)


@pytest.mark.slow
def test_parts_further_apart_share_a_loop_where_the_count_needs_it() -> None:
    level = nested_cages(islands(), Share(0.01), merge=1e-6).levels[0]
    assert len(level.cage.vertices) == 3 and any("closer than 1e-06 merged" in note for note in level.report.notes)
    with pytest.raises(NestedCagesError, match="3 vertices is too small"):
        nested_cages(islands(), 3, merge=1e-6, loops="keep")


def test_what_does_not_go_together_is_told() -> None:
    for options in ({"merge": 0.0}, {"merge": 1.0, "convex": True}, {"merge": 1.0, "pins": [0]}):
        with pytest.raises(NestedCagesError, match="merge"):
            Settings(**options)  # type: ignore[arg-type]
    with pytest.raises(NestedCagesError, match="Inner cages keep all loops"):
        inner_cages(sprite(), 30, merge=1.0)


@pytest.mark.parametrize(("distance", "loops"), [(0.3, 5), (0.7, 1)])
def test_parts_that_are_smaller_than_the_gaps_around_them_share_a_loop(distance: float, loops: int) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 80, endpoint=False)
    blob = (1.0 + 0.2 * np.cos(5.0 * angle))[:, None] * ring(80)
    at = 0.1 + np.arange(8) * np.pi / 4.0
    specks = [ring(8, 0.02) + 1.4 * np.array([np.cos(each), np.sin(each)]) for each in at]
    fine = Mesh.from_loops([blob, *specks])
    level = nested_cages(fine, 32, merge=distance).levels[0]
    assert len(Bridged.of(fine, distance).closed(1.0).loops) == loops
    assert verify(level.cage, fine, level.report.clearance, same_loops=False) and level.report.excess < 0.08


def test_a_note_says_when_there_are_fewer_vertices_than_asked_for() -> None:
    """Whatever the reason: a merged outline may have fewer corners than its parts."""

    class Fewer:
        def decimate(self, fine: Mesh, count: Any, *, clearance: float | None = None) -> Mesh:
            return OuterHull().decimate(fine, count - 2, clearance=clearance)

    level = nested_cages(ring(20), 8, decimation=Fewer())[0]
    (said,) = [note for note in level.report.notes if note.code == "note.count"]
    assert (len(level.cage.vertices), said.data["asked"], said.data["given"]) == (6, 8, 6)
    assert not nested_cages(ring(20), 8, decimation=OuterHull())[0].report.notes


@pytest.mark.parametrize("size", slow_after(0, [1e-170, 1e-155, 1e-165], thorough_after=1))
def test_parts_too_small_to_tell_apart_are_told_as_such(size: float) -> None:
    tiny = [ring(6, size), ring(6, size, 0.0, (4.0 * size, 0.0)), ring(12, 1.0, 0.0, (3.0, 0.0))]
    for options in ({}, {"pins": [0]}, {"weights": np.arange(24) + 1.0}):
        for count in (9, 24):
            try:
                nested_cages(Mesh.from_loops(tiny), count, **options)
            except NestedCagesError as error:
                assert "derivatives" not in str(error)
                assert "less than 0" not in str(error)
