"""The main job: certified cages for the shapes of the paper, drawn here and checked by shapely; starts and levels."""

import logging
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Hierarchy, LineCycles, Mesh, NestingError, Settings, Within, nested_cages
from support import shapes
from support.judging import assert_right, codes, rejected
from support.marks import slow_after
from support.methods import Offering
from support.shapes import annulus, assert_nested, islands, letter_a, letter_a_coarse, ring, star

OUTER, HOLE = ring(60, 1.0), ring(20, 0.4)


LETTER, PLATE = (letter_a(), letter_a_coarse()), (shapes.octagon_with_hole(), shapes.square_with_hole())


def assert_sound(hierarchy: Hierarchy) -> None:
    for level in hierarchy:
        assert_right(level)
        assert_nested(level.cage, level.fine)
        assert (level.report.strict, level.report.simple) == (True, True)


@pytest.mark.parametrize("per_ring", slow_after(4, [16, 32, 64, 256, 24, 48, 96, 128], thorough_after=4))
def test_discs_of_table_1_come_within_3_percent(per_ring: int) -> None:
    """Annuli of radii 1 and 0.5 in a coarse one of 16 + 16 vertices (Gurditta & Jacobson 2022, Table 1)."""
    hierarchy = nested_cages(annulus(per_ring), [annulus(16)])
    assert_sound(hierarchy)
    assert (hierarchy[0].excess < 0.03, hierarchy[0].report.start) == (True, "flow")


@pytest.mark.parametrize(("fine", "coarse"), [LETTER, PLATE])
def test_shapes_with_holes_flow_into_their_own_coarse_mesh(fine: Mesh, coarse: Mesh) -> None:
    """In the spirit of figure 1: arms, legs and a hole."""
    hierarchy = nested_cages(fine, [coarse])
    assert_sound(hierarchy)
    assert hierarchy[0].report.start == "flow"


@pytest.mark.parametrize(
    "decimation", [LineCycles(on_curve=False), core.OnCurve(), core.ArcLength()], ids=lambda d: type(d).__name__
)
@pytest.mark.parametrize("shape", slow_after(0, [islands, letter_a, star], thorough_after=1), ids=lambda s: s.__name__)
def test_several_levels_by_every_decimation(shape: Callable[[], Mesh], decimation: Any) -> None:
    hierarchy = nested_cages(shape(), [48, 24], decimation=decimation, loops="keep")
    assert_sound(hierarchy)
    assert all(len(cage.vertices) <= most for cage, most in zip(hierarchy.cages, (48, 24), strict=True))


FAR_AWAY = Mesh(letter_a_coarse().vertices + 100.0, letter_a_coarse().edges)


@pytest.mark.parametrize(("fine", "coarse"), [LETTER, PLATE], ids=["letter", "plate"])
def test_without_steps_the_drawing_flows_into_an_own_mesh(fine: Mesh, coarse: Mesh) -> None:
    moving, still = (nested_cages(fine, [coarse], steps=steps)[0] for steps in (True, False))
    assert_sound(Hierarchy(fine, (still,)))
    assert moving.report.start == still.report.start == "flow"
    assert still.cage == moving.cage


@pytest.mark.parametrize("count", [10, 24])
def test_without_steps_cages_are_as_tight_and_stand_still(count: int) -> None:
    moving, still = (nested_cages(star(), count, steps=steps)[0] for steps in (True, False))
    assert_sound(Hierarchy(still.fine, (still,)))
    assert still.excess == pytest.approx(moving.excess, rel=0.01)
    assert len(still.reinflation.cage_steps) == len(still.flow.steps) == 1


@dataclass(frozen=True)
class Failing:
    """A decimation that never succeeds."""

    def decimate(self, fine: Mesh, count: Any, *, clearance: float = 0.0) -> Mesh:
        raise NestingError("This decimation makes nothing.", code="count.too_small")


@dataclass(frozen=True)
class BoundingPolygon:
    """A decimation that encloses, and is none of ours."""

    def decimate(self, fine: Mesh, count: Any, *, clearance: float = 0.0) -> Mesh:
        return LineCycles(on_curve=False).decimate(fine, count, clearance=clearance)


STARTS: dict[str, tuple[Mesh, Any, dict[str, Any], str, list[str]]] = {
    "line cycles enclose": (star(5, 60), 24, {"decimation": LineCycles(on_curve=False)}, "line cycles", []),
    "another one that encloses": (star(5, 60), 24, {"decimation": BoundingPolygon()}, "bounding polygon", []),
    "a decimation fails": (annulus(24), 12, {"decimation": Failing()}, "line cycles", ["note.start"]),
    "another fallback": (
        annulus(24), 12, {"decimation": Failing(), "fallback": BoundingPolygon()}, "bounding polygon", ["note.start"],
    ),
    "nothing flows into an own mesh": (letter_a(1), FAR_AWAY, {}, "line cycles", ["note.start"]),
    "nothing flows there, by another fallback": (
        letter_a(1), FAR_AWAY, {"decimation": core.ArcLength(), "fallback": BoundingPolygon()}, "bounding polygon",
        ["note.start"],
    ),
}  # fmt: skip


@pytest.mark.parametrize(("fine", "level", "options", "start", "notes"), STARTS.values(), ids=STARTS.keys())
def test_the_report_says_what_a_level_started_from(
    fine: Mesh, level: Any, options: dict[str, Any], start: str, notes: list[str]
) -> None:
    found = nested_cages(fine, level, **options)[0]
    assert (found.report.start, codes(found)) == (start, notes)
    assert_nested(found.cage, found.fine)
    assert sorted(len(loop) for loop in found.cage.loops) == (
        [24] if level == 24 else [5, 7] if level == 12 else [3, 20]
    )
    if notes == []:  # it encloses: nothing flows, and the shape is at home
        assert (len(found.flow.steps), found.reinflation.tightening_start) == (1, 0)


def test_without_a_fallback_the_error_is_raised() -> None:
    with rejected("count.too_small", NestingError):
        nested_cages(annulus(24), [12], Settings(decimation=Failing(), fallback=None))
    with rejected("flow.loops_differ", core.FlowError) as stuck:
        nested_cages(letter_a(1), [40, FAR_AWAY], Settings(fallback=None))
    assert isinstance(stuck.value.partial, Hierarchy)
    assert [len(cage.vertices) for cage in stuck.value.partial.cages] == [40]


def test_the_fallback_has_as_many_vertices_as_the_own_mesh() -> None:
    for own, vertices in (
        ([ring(9, 1.2) + 50.0, 0.4 * ring(4) + 50.0], 13),  # loops that match none
        ([ring(4, 1.5) + 50.0], 6),  # fewer loops: at least triangles
        ([ring(9, 1.5) + 50.0], 9),
    ):
        (level,) = nested_cages(annulus(24), [Mesh.from_loops(own)])
        assert len(level.cage.vertices) == vertices
        assert_nested(level.cage, level.fine)


@dataclass(frozen=True)
class OfferingSeveral(Offering):
    """A decimation that offers several coarse meshes, the most promising first."""

    def starts(self, fine: Mesh, count: Any, **options: Any) -> Iterator[Any]:
        first = next(LineCycles(on_curve=False).starts(fine, count, **options))
        yield from (first._replace(coarse=coarse, source="offered", on_curve=None) for coarse in self.meshes)


@pytest.mark.parametrize("order", slow_after(1, [((1, 2, 0),), ((0, 1, 2),), ((2, 1, 0),)]))
def test_the_first_of_several_starts_is_taken(order: tuple[int, ...]) -> None:
    """They end in optima that are far apart, and come in several orders."""
    fine = Mesh.from_loops([letter_a().rings[0]])
    starts = [Mesh.from_loops([ring(5, 5.2, angle) + np.array([0.0, 2.0])]) for angle in (0.0, 0.63, 0.94)]
    areas = [nested_cages(fine, [start], fallback=None).cages[0].area for start in starts]
    assert max(areas) > 1.08 * min(areas) > (1.0 + 1e-9) * min(areas)
    offered = OfferingSeveral(tuple(starts[k] for k in order))
    (level,) = nested_cages(fine, [5], decimation=offered, fallback=None)
    assert level.report.start == "offered" and level.cage.area == pytest.approx(areas[order[0]], rel=1e-9)


def test_a_cage_that_its_energy_leaves_as_it_starts_has_a_note() -> None:
    """Energies that keep a shape have their minimum at the hull."""
    (level,) = nested_cages(star(), [16], Settings(energy=core.BoundaryARAP(), decimation=LineCycles(on_curve=False)))
    assert (level.cage.vertices == level.coarse.vertices).all()
    assert codes(level) == ["note.energy"]
    assert not nested_cages(star(), [16], Settings(decimation=LineCycles(on_curve=False)))[0].report.notes


SAME: list[tuple[Any, Any]] = [
    *((level, [level]) for level in (np.int64(12), Mesh.from_loops([ring(12, 1.5)]), ring(12, 1.5))),
    ("20%", core.Share(0.2)), *((text, Within(distance=0.2)) for text in ("0.2u", "0.2px", "0,2 u")),
    ("+25%", Within(excess=0.25)), ("24", 24), ("24, 12", [24, 12]), (["20%", 9], [12, 9]),
    ("24, 10 %; +40 %", [24, core.Share(0.1), Within(excess=0.4)]), ("24 10%", [24, 6]),
]  # fmt: skip


@pytest.mark.parametrize(("given", "same"), SAME)
def test_levels_may_stand_alone_or_be_texts_as_in_the_command(given: Any, same: Any) -> None:
    make = core.inner_cages if same == 24 else nested_cages
    assert make(OUTER, given).cages == make(OUTER, same).cages
    if same == core.Share(0.2):
        assert len(core.animated_cages(OUTER, [OUTER, OUTER + 0.1], given).levels[0].cage.vertices) == 12


ORDERED: list[tuple[list[Any], list[int]]] = [
    ([12, 24], [24, 12]), (["20%", 24, "10%"], [24, 12, 6]), ([24, 24], [24, 24]),
    ([core.Share(0.1), core.Share(0.5)], [30, 6]), (["+50%", "+5%"], [9, 4]),
    ([20, Mesh.from_loops([ring(9, 1.5)]), 12], [20, 9, 9]),  # what cannot be compared stays in order
]  # fmt: skip


@pytest.mark.parametrize(("given", "counts"), ORDERED)
def test_levels_in_any_order_are_made_finest_first(given: list[Any], counts: list[int]) -> None:
    assert [len(cage.vertices) for cage in nested_cages(OUTER, given).cages] == counts


def test_after_a_cage_with_fewer_loops_fewer_vertices_are_enough() -> None:
    hierarchy = nested_cages(annulus(60), [Mesh.from_loops([ring(9, 1.2)]), 3])
    assert [len(cage.vertices) for cage in hierarchy.cages] == [9, 3]
    assert_nested(hierarchy.cages[1], hierarchy.cages[0])


@pytest.mark.parametrize("make", [nested_cages, core.inner_cages])
def test_anything_that_describes_a_shape_has_cages(make: Callable[..., Hierarchy]) -> None:
    mesh = annulus(24)
    loops = list(mesh.rings)
    wanted = make(mesh, [12]).cages[0]
    for shape in (loops, np.array(loops), mesh.__geo_interface__, shapely.geometry.shape(mesh)):
        (level,) = make(shape, [12]).levels
        assert level.cage.area == pytest.approx(wanted.area, rel=1e-9)
        assert core.verify(*((shape, level.cage) if level.inside else (level.cage, shape)))


def test_what_is_no_shape_has_no_cages() -> None:
    for wrong in (None, "star.svg", ring(20)[:, :1], {"type": "Sphere"}):
        with rejected("mesh.unreadable", NestingError if isinstance(wrong, str | None) else core.InvalidMeshError):
            nested_cages(wrong, [5])  # type: ignore[arg-type]


def test_moved_meshes_are_validated_when_they_come_in() -> None:
    fine, coarse = Mesh.from_loops([ring(50)]), Mesh.from_loops([ring(8)])
    scribble = fine.moved(fine.vertices[np.random.default_rng(0).permutation(50)])
    for shape, level in ((scribble, 8), (fine, coarse.moved(coarse.vertices[[0, 4, 2, 6, 1, 5, 3, 7]]))):
        with rejected("mesh.crossing", core.InvalidMeshError):
            nested_cages(shape, [level])
    mirrored = fine.moved(fine.vertices * np.array([1.0, -1.0]))
    assert_nested(nested_cages(mirrored, [8]).cages[0], mirrored.validated())


def test_the_arrays_of_a_result_are_not_shared_with_later_ones() -> None:
    fine = star(5, 60)
    first = nested_cages(fine, [20])[0]
    kept = first.cage.vertices.copy()
    first.flow.steps[:] = 0.0
    first.reinflation.cage_steps[:] = 0.0
    again = nested_cages(fine, [20])[0]
    assert (again.cage.vertices == kept).all()
    assert (again.flow.steps[0] == fine.vertices).all()


def test_the_log_tells_the_story_of_a_run_at_debug_level_alone(caplog: pytest.LogCaptureFixture) -> None:
    nested_cages(star(5, 50), [12])
    assert caplog.text == ""
    with caplog.at_level(logging.DEBUG, logger="nestedcages_core"):
        nested_cages(star(5, 52), [12])
    assert len(caplog.records) > 3
    assert {record.levelno for record in caplog.records} == {logging.DEBUG}
