"""Constraints: each alone and every pair is kept, or the error has a code; rows are derivatives; judges are exact."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from nestedcages_core import Mesh, Mirror, NestedCagesError, animated_cages, inner_cages, nested_cages, verify
from nestedcages_core.constraints import (
    AxisAligned,
    Bound,
    Box,
    Constraint,
    LeastAngle,
    LeastEdge,
    LoopClearance,
    Outside,
    Rows,
    Terms,
    Units,
)
from nestedcages_core.constraints.angles import BoundAngle, angles_of
from nestedcages_core.constraints.least_edge import BoundEdge
from nestedcages_core.errors import Fault
from nestedcages_core.geometry.arrays import FloatArray
from nestedcages_core.geometry.predicates import BoxTree
from nestedcages_core.geometry.smallest_gap import smallest_gap
from nestedcages_core.level.units import SolverUnits
from support.marks import slow_after
from support.shapes import annulus, derivative, letter_a, ring, star


def box_around(fine: Mesh, room: float = 0.01) -> Box:
    low, high = fine.vertices.min(axis=0), fine.vertices.max(axis=0)
    return Box(tuple(low - room * fine.diagonal), tuple(high + room * fine.diagonal))


def disc(fine: Mesh) -> Mesh:
    """A disc right of a shape, close to it."""
    k = int(np.argmax(fine.vertices[:, 0]))
    return Mesh.from_loops([fine.vertices[k] + 0.02 * fine.diagonal * (ring(12) + np.array([1.4, 0.0]))])


@dataclass(frozen=True)
class Above(Constraint):
    """A constraint as others write it, by rows and a judge alone."""

    height: float

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        return BoundAbove(float(units.points(np.array([0.0, self.height]))[1]) + 1e-12)

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        low = cage.vertices[:, 1] < self.height
        return Fault("The cage is too low.", "height.missed") if low.any() else None


@dataclass(frozen=True)
class BoundAbove(Bound):
    height: float

    def rows(self, cage: FloatArray, radius: float) -> Iterable[Terms]:
        room = cage[:, 1] - self.height
        near = np.flatnonzero(room < 1.5 * radius)
        up = np.tile([[0.0], [1.0]], len(near))
        return [Terms(Rows(near[None], np.ones((1, len(near))), up), room[near])]

    def short(self, cage: FloatArray) -> FloatArray:
        return np.asarray(np.maximum(self.height - cage[:, 1], 0.0))


MAKERS: dict[str, Callable[[Mesh], Constraint]] = {
    "box": box_around,
    "loops": lambda fine: LoopClearance(outer=0.002 * fine.diagonal, holes=0.006 * fine.diagonal),
    "edge": lambda fine: LeastEdge(0.3 * float(fine.edge_lengths.sum()) / 24),
    "angle": lambda fine: LeastAngle(40.0),
    "obstacle": lambda fine: Outside(disc(fine), 0.002 * fine.diagonal),
    "axes": lambda fine: AxisAligned(),
    "above": lambda fine: Above(float(fine.vertices[:, 1].min()) - 0.004 * fine.diagonal),
}
SHAPES = {"star": star(5, 90), "letter": letter_a(), "ring": annulus(60)}


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("shape", slow_after(1, SHAPES, thorough_after=1))
@pytest.mark.parametrize(
    "names",
    slow_after(len(MAKERS), [((name,),) for name in MAKERS] + [(pair,) for pair in combinations(MAKERS, 2)]),
    ids="+".join,
)
def test_constraints_are_kept(names: tuple[str, ...], shape: str, inside: bool) -> None:
    fine = SHAPES[shape]
    constraints = [MAKERS[name](fine) for name in names]
    try:
        level = (inner_cages if inside else nested_cages)(fine, 24, constraints=constraints, loops="keep")[0]
    except NestedCagesError as error:  # stairs have short edges where there is no room for others
        assert {"axes", "edge"} == set(names) and error.code == "edge.short", error
        return
    assert verify(*((fine, level.cage) if inside else (level.cage, fine)))
    assert [constraint.fault(level.cage, fine) for constraint in constraints] == [None] * len(constraints)


def test_a_box_holds_back_vertices_that_would_leave_it() -> None:
    fine = star(5, 90)
    free, held = nested_cages(fine, 10)[0], nested_cages(fine, 10, constraints=[box_around(fine, 0.003)])[0]
    assert box_around(fine, 0.003).fault(free.cage, fine) is not None
    assert box_around(fine, 0.003).fault(held.cage, fine) is None
    assert held.excess > free.excess


def test_boxes_are_judged_exactly() -> None:
    fine, cage = Mesh.from_loops([ring(12)]), Mesh.from_loops([2.0 * ring(4)])
    low, high = cage.vertices.min(axis=0), cage.vertices.max(axis=0)
    assert Box(tuple(low), tuple(high)).fault(cage, fine) is None
    for axis in (0, 1):
        inner = high.copy()
        inner[axis] = np.nextafter(inner[axis], 0.0)
        fault = Box(tuple(low), tuple(inner)).fault(cage, fine)
        assert fault is not None and fault.code == "box.left" and fault.data["distance"] > 0.0
        assert fault.data["place"][axis] == high[axis]
    assert Box((-np.inf, low[1]), (np.inf, np.inf)).fault(cage, fine) is None


def test_loops_keep_distances_of_their_own() -> None:
    fine = annulus(60)
    wanted = [0.05 if sign > 0 else 0.02 for sign in fine.loop_signs]
    for constraint in (LoopClearance(outer=0.05, holes=0.02), LoopClearance(loops=tuple(wanted))):
        level = nested_cages(fine, 30, constraints=[constraint])[0]
        for loop, distance in zip(fine.loops, wanted, strict=True):
            tree = BoxTree(fine.vertices[loop], fine.edge_ends[loop])
            gap = smallest_gap(level.cage.edge_tree, tree)
            assert distance * (1.0 - 1e-9) <= gap < 1.01 * distance


def test_the_next_level_keeps_them_too() -> None:
    fine = star(5, 90)
    box = box_around(fine, 0.02)
    hierarchy = nested_cages(fine, [32, 14], constraints=[box, LoopClearance(outer=0.01)])
    for level in hierarchy:
        assert box.fault(level.cage, level.fine) is None
        assert level.report.clearance >= 0.01 * (1.0 - 1e-9)


@pytest.mark.slow
def test_symmetric_and_gridded_cages_keep_a_box() -> None:
    fine = star(5, 90)
    box = box_around(fine, 0.02)
    for options in (
        {"symmetry": Mirror((0.0, 0.0), (1.0, 0.0))},
        {"grid": 0.01},
        {"stored": np.float32},
        {"min_edge": 0.2},
        {"pins": [0]},
    ):
        level = nested_cages(fine, 16, constraints=[box], **options)[0]
        assert verify(level.cage, fine) and box.fault(level.cage, fine) is None


def test_what_is_missed_is_an_error_or_a_note() -> None:
    fine = Mesh.from_loops([ring(40)])
    with pytest.raises(NestedCagesError, match="leaves the box by") as caught:
        nested_cages(fine, 3, constraints=[Box((-1.01, -1.01), (1.01, 1.01))])
    assert caught.value.code == "box.left" and caught.value.data["distance"] > 0.0
    wish = Box((-1.01, -1.01), (1.01, 1.01), must=False)
    level = nested_cages(fine, 3, constraints=[wish])[0]
    assert verify(level.cage, fine) and "box.left" in [note.code for note in level.report.notes]


@pytest.mark.parametrize("name", ["box", "above"])
def test_rows_are_derivatives_of_their_rooms(name: str) -> None:
    fine = star(5, 90)
    cage = Mesh.from_loops([1.2 * ring(9)])
    units = SolverUnits.of(fine)
    bound = MAKERS[name](fine).bound(units.from_input(cage), units.from_input(fine), units)
    x = units.points(cage.vertices) + 0.003 * np.random.default_rng(3).normal(size=(9, 2))
    check_rows(bound, x)


def test_rows_of_lengths_and_angles_are_derivatives() -> None:
    cage = Mesh.from_loops([ring(9)])
    x = cage.vertices + 0.1 * np.random.default_rng(3).normal(size=(9, 2))
    check_rows(BoundEdge(cage.successor, cage.predecessor, 0.6, BoundAngle.of(cage, 1e-3)), x, groups=1)
    for k, degrees in enumerate(
        angles_of(cage.moved(x))
    ):  # the shorter edge counts as constant, as it does at a room of 0
        angle = replace(BoundAngle.of(cage, 1.0), least=float(np.radians(degrees)))
        (terms,) = angle.rows(x, 10.0)
        slope = derivative(lambda at, k=k, angle=angle: next(angle.rows(at, 10.0)).room[k], x)
        dense = np.zeros((9, 2))
        np.add.at(dense, terms.rows.vertex[:, k], terms.rows.direction[:, :, k])
        assert np.abs(slope - dense).max() < 1e-6
    assert (BoundAngle.of(cage, 170.0).short(x) > 0.0).all()


def check_rows(bound: Bound, x: FloatArray, groups: int = 9) -> None:
    """All rows at x, whatever the radius, against finite differences; those that are missed are short."""
    for number, terms in enumerate(list(bound.rows(x, 10.0))[:groups]):
        terms, dense = Terms(*terms), np.zeros((len(terms[1]), *x.shape))
        slope = terms.rows.weight[:, None] * np.broadcast_to(
            terms.rows.direction, (len(terms.rows.vertex), 2, terms.rows.count)
        )
        for row in range(terms.rows.count):
            np.add.at(dense[row], terms.rows.vertex[:, row], slope[:, :, row])
        measured = derivative(lambda at, k=number: Terms(*list(bound.rows(at, 10.0))[k]).room, x)
        assert np.abs(measured.reshape(dense.shape) - dense).max() < 1e-6
        missed = terms.rows.vertex[:, terms.room < 0.0]
        assert (bound.short(x)[missed] > 0.0).all()


def test_bad_constraints_are_rejected() -> None:
    fine = star(5, 90)
    for wrong in (Box, "box", 3.0):
        with pytest.raises(NestedCagesError, match="A constraint must be an object"):
            nested_cages(fine, 12, constraints=[wrong])
    for low, high in (
        ((0.0,), (1.0, 1.0)),
        ((0.0, 0.0), (0.0, 1.0)),
        (("a", 0.0), (1.0, 1.0)),
        ((np.nan, 0.0), (1, 1)),
    ):
        with pytest.raises(NestedCagesError, match="Box: "):
            Box(low, high)
    for options in ({"outer": -1.0}, {"holes": np.inf}, {"loops": (0.1, "a")}):
        with pytest.raises(NestedCagesError, match="LoopClearance: "):
            LoopClearance(**options)
    with pytest.raises(NestedCagesError, match="2 distances, but the mesh has 1 loops"):
        nested_cages(fine, 12, constraints=[LoopClearance(loops=(0.1, 0.2))])
    with pytest.raises(NestedCagesError, match="the drawing reaches its border"):
        nested_cages(fine, 12, constraints=[Box((-9.0, -9.0), (0.5, 9.0))])


@pytest.mark.parametrize("name", slow_after(1, MAKERS))
def test_moving_cages_keep_constraints_at_every_key(name: str) -> None:
    fine = star(5, 60)
    poses = [fine.vertices + 0.1 * step * fine.vertices[:, 1:] * [1.0, 0.0] for step in range(3)]
    bent = fine.moved(poses[-1])
    constraint = MAKERS[name](bent) if name != "box" else box_around(bent, 0.03)
    level = animated_cages(fine, poses, 16, constraints=[constraint]).levels[0]
    for cage, pose in zip(level.cage_steps, level.fine_steps, strict=True):
        assert constraint.fault(level.cage.moved(cage), fine.moved(pose)) is None


def test_least_edges_are_reached_and_judged_exactly() -> None:
    fine = letter_a()
    level = nested_cages(fine, 32, constraints=[LeastEdge(0.3)])[0]
    assert 0.3 <= level.cage.edge_lengths.min() < 0.3 + 1e-6
    cage = Mesh.from_loops([[(0.0, 0.0), (3.0, 0.0), (3.0, 4.0), (0.0, 4.0)]])
    assert LeastEdge(3.0).fault(cage, fine) is None
    fault = LeastEdge(float(np.nextafter(3.0, 4.0))).fault(cage, fine)
    assert fault is not None and fault.code == "edge.short" and fault.data["given"] == 3.0
    third = Mesh.from_loops([[(0.0, 0.0), (0.1, 0.0), (0.3, 0.0 + 1e-17), (0.0, 1.0)]])
    assert LeastEdge(0.1).fault(third, fine) is None
    assert LeastEdge(3.5, must=False).fault(cage, fine).code == "note.edge"


def test_least_angles_are_reached() -> None:
    level = nested_cages(letter_a(), 20, constraints=[LeastAngle(40.0)])[0]
    assert 40.0 <= angles_of(level.cage).min() < 40.01
    wedge = Mesh.from_loops([[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]])
    fault = LeastAngle(50.0).fault(wedge, wedge)
    assert fault is not None and fault.code == "angle.sharp" and abs(fault.data["given"] - 45.0) < 1e-9
    assert LeastAngle(44.9).fault(wedge, wedge) is None
    assert LeastAngle(50.0, must=False).fault(wedge, wedge).code == "note.angle"


def test_obstacles_push_the_cage_aside() -> None:
    fine = star(5, 90)
    free = nested_cages(fine, 10)[0]
    tip = free.cage.vertices[int(np.argmax(np.hypot(*free.cage.vertices.T)))]
    obstacle = Outside(Mesh.from_loops([tip + 0.03 * ring(8)]), 0.01)
    assert obstacle.fault(free.cage, fine) is not None
    level = nested_cages(fine, 10, constraints=[obstacle])[0]
    assert verify(level.cage, fine) and obstacle.fault(level.cage, fine) is None
    assert smallest_gap(level.cage.edge_tree, obstacle.shape.edge_tree) >= 0.01 * (1.0 - 1e-9)


@pytest.mark.parametrize("count", [6, 7, 24])
def test_obstacles_in_a_bay_stay_outside_if_a_straight_way_leads_out(count: int) -> None:
    horseshoe = np.concatenate((ring(40)[:34], 0.6 * ring(40)[33::-1]))
    fine = Mesh.from_loops([horseshoe])
    obstacle = Outside(Mesh.from_loops([0.3 * ring(9)]), 0.02)
    assert count > 7 or obstacle.fault(nested_cages(fine, count)[0].cage, fine) is not None
    level = nested_cages(fine, count, constraints=[obstacle])[0]
    assert verify(level.cage, fine) and obstacle.fault(level.cage, fine) is None


def test_a_bay_that_winds_is_named() -> None:
    turn = np.linspace(2.0, 14.0, 120)
    spiral = turn[:, None] * np.column_stack((np.cos(turn), np.sin(turn)))
    fine = Mesh.from_loops([np.concatenate((spiral, 1.15 * spiral[::-1] + 0.3))])
    with pytest.raises(NestedCagesError, match="no straight way out") as caught:
        nested_cages(fine, 5, constraints=[Outside(Mesh.from_loops([0.5 * ring(9)]))])
    assert caught.value.code == "obstacle.met"


def test_obstacles_are_judged_exactly() -> None:
    cage = Mesh.from_loops([[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]])
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    for corner, code in (((2.0, 0.5), "obstacle.met"), ((0.5, 0.5), "obstacle.met"), ((2.5, 0.5), None)):
        fault = Outside([square + corner], 0.5).fault(cage, cage)
        assert (fault and fault.code) == code
    around = Outside(Mesh.from_loops([4.0 * square - 1.0]))
    assert around.fault(cage, cage) is not None
    with pytest.raises(NestedCagesError, match="The drawing is not clear of the obstacle"):
        nested_cages(cage, 4, constraints=[around])
    with pytest.raises(NestedCagesError, match="Outside: distance"):
        Outside(cage, -1.0)
    near = Outside([square + np.array([2.5, 0.5])], 0.6).fault(cage, cage)
    assert near is not None and near.data["clearance"] == 0.5 and near.data["wanted"] == 0.6


def test_rows_of_an_obstacle_are_derivatives() -> None:
    cage, obstacle = Mesh.from_loops([ring(9)]), Mesh.from_loops([0.5 * ring(7) + [1.7, 0.1]])
    units = SolverUnits.of(cage)
    bound = Outside(obstacle, 0.1).bound(units.from_input(cage), units.from_input(cage), units)
    check_rows(bound, units.points(cage.vertices))
    inside = Outside(Mesh.from_loops([0.1 * ring(5)])).bound(cage, cage, SolverUnits(np.zeros(2), 1.0, 0.0))
    assert (inside.short(cage.vertices) >= 1.0).all()


@pytest.mark.parametrize("asked", [{"min_edge": 1e300}, {"constraints": [LeastEdge(1e300)]}], ids=str)
def test_edges_that_no_drawing_is_seen_beside_are_refused(asked: dict[str, Any]) -> None:
    with pytest.raises(NestedCagesError, match=r"min_edge=1e\+300 is more than 1e\+06 times as long"):
        nested_cages(Mesh.from_loops([ring(9)]), 5, **asked)


@pytest.mark.slow
def test_promised_limits_without_room_are_errors() -> None:
    fine = Mesh.from_loops([ring(64)])
    for constraint, code in ((LeastEdge(20.0), "edge.short"), (LeastAngle(59.9), "angle.sharp")):
        with pytest.raises(NestedCagesError) as caught:
            box = Box((-1.2, -1.2), (1.2, 1.2))
            nested_cages(annulus(60), 6, clearance=0.001, constraints=[constraint, box], loops="keep")
        assert caught.value.code in {code, "box.left"}
    assert nested_cages(fine, 40, constraints=[LeastEdge(0.3)])[0].cage.edge_lengths.min() >= 0.3
