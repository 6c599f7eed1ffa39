"""Constraints: kept to the last bit, alone and in pairs, or the error has a code; others may write their own."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import AxisAligned, Box, LeastAngle, LeastEdge, LoopClearance, Mesh, Outside, nested_cages
from support.judging import codes, directions, gap, is_along_the_axes, is_symmetric, lengths_of, rejected, sharpest
from support.marks import slow_after
from support.shapes import annulus, letter_a, polygon, resampled, ring, star

STAR, LETTER, RING = star(5, 90), letter_a(), annulus(60)
SHAPES = {"star": STAR, "letter": LETTER, "ring": RING}
SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
FLOWER = Mesh.from_loops([ring(120) * (1.0 + 0.3 * np.sin(5.0 * np.linspace(0.0, 2.0 * np.pi, 120, False)))[:, None]])
"""Petals and bays, with a mirror at the y axis."""
TRANSIT = (0.0, 45.0, 90.0, 135.0)


def box_around(fine: Mesh, room: float = 0.01) -> Box:
    low, high = fine.vertices.min(axis=0), fine.vertices.max(axis=0)
    return Box(tuple(low - room * fine.diagonal), tuple(high + room * fine.diagonal))


def obstacle(fine: Mesh) -> Mesh:
    """A disc right of a shape, close to it."""
    k = int(np.argmax(fine.vertices[:, 0]))
    return Mesh.from_loops([fine.vertices[k] + 0.02 * fine.diagonal * (ring(12) + np.array([1.4, 0.0]))])


MAKERS: dict[str, Callable[[Mesh], core.Constraint]] = {
    "box": box_around,
    "loops": lambda fine: LoopClearance(outer=0.002 * fine.diagonal, holes=0.006 * fine.diagonal),
    "edge": lambda fine: LeastEdge(0.3 * float(lengths_of(fine).sum()) / 24),
    "angle": lambda fine: LeastAngle(40.0),
    "obstacle": lambda fine: Outside(obstacle(fine), 0.002 * fine.diagonal),
    "axes": lambda fine: AxisAligned(),
}


def keeps(name: str, cage: Mesh, fine: Mesh) -> bool:
    """Whether a cage keeps a constraint of the makers, by arithmetic and shapely."""
    size = fine.diagonal
    if name == "box":
        low, high = fine.vertices.min(axis=0) - 0.01 * size, fine.vertices.max(axis=0) + 0.01 * size
        return bool((cage.vertices >= low).all() and (cage.vertices <= high).all())
    if name == "edge":
        return bool(lengths_of(cage).min() >= 0.3 * float(lengths_of(fine).sum()) / 24 * (1.0 - 1e-15))
    if name == "angle":
        return sharpest(cage) >= 40.0 * (1.0 - 1e-12)
    if name == "axes":
        return is_along_the_axes(cage)
    if name == "obstacle":
        return bool(polygon(cage).distance(polygon(obstacle(fine))) >= 0.002 * size * (1.0 - 1e-9))
    near = [polygon(cage).boundary.distance(shapely.LinearRing(each)) for each in fine.rings]
    wanted = [0.002 if sign > 0 else 0.006 for sign in fine.loop_signs]
    return all(here >= size * there * (1.0 - 1e-9) for here, there in zip(near, wanted, strict=True))


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
        level = (core.inner_cages if inside else nested_cages)(fine, 24, constraints=constraints, loops="keep")[0]
    except core.NestedCagesError as error:  # stairs have short edges where there is no room for others
        assert {"axes", "edge"} == set(names) and error.code == "edge.short", error
        return
    assert core.verify(*((fine, level.cage) if inside else (level.cage, fine)))
    assert [keeps(name, level.cage, fine) for name in names] == [True] * len(names)
    assert [constraint.fault(level.cage, fine) for constraint in constraints] == [None] * len(constraints)


@pytest.mark.parametrize("name", slow_after(1, MAKERS, thorough_after=3))
def test_moving_cages_keep_constraints_at_every_key(name: str) -> None:
    fine = star(5, 60)
    poses = [fine.vertices + 0.1 * step * fine.vertices[:, 1:] * [1.0, 0.0] for step in range(3)]
    bent = Mesh(poses[-1], fine.edges)
    constraint = MAKERS[name](bent) if name != "box" else box_around(bent, 0.03)
    level = core.animated_cages(fine, poses, 16, constraints=[constraint]).levels[0]
    for cage, pose in zip(level.cage_steps, level.fine_steps, strict=True):
        assert constraint.fault(Mesh(cage, level.cage.edges), Mesh(pose, fine.edges)) is None


def test_the_next_level_keeps_them_too() -> None:
    box = box_around(STAR, 0.02)
    for level in nested_cages(STAR, [32, 14], constraints=[box, LoopClearance(outer=0.01)]):
        assert box.fault(level.cage, level.fine) is None
        assert gap(level.cage, level.fine) >= 0.01 * (1.0 - 1e-9)


ALONG = core.Mirror((0.0, 0.0), (1.0, 0.0))


@pytest.mark.slow
@pytest.mark.parametrize("needs", [{"symmetry": ALONG}, {"grid": 0.01}, {"min_edge": 0.2}, {"pins": [0]}], ids=str)
def test_what_settings_ask_for_goes_with_a_box(needs: dict[str, Any]) -> None:
    level = nested_cages(STAR, 16, constraints=[box_around(STAR, 0.02)], **needs)[0]
    assert box_around(STAR, 0.02).fault(level.cage, STAR) is None


def test_a_box_holds_back_vertices_that_would_leave_it() -> None:
    free, held = nested_cages(STAR, 10)[0], nested_cages(STAR, 10, constraints=[box_around(STAR, 0.003)])[0]
    assert box_around(STAR, 0.003).fault(free.cage, STAR) is not None
    assert box_around(STAR, 0.003).fault(held.cage, STAR) is None
    assert free.excess < held.excess < 1.6 * free.excess
    disc = Mesh.from_loops([ring(160)])
    level = nested_cages(disc, 4, constraints=[Box((-1.01, -1.01), (1.01, 1.01))])[0]
    assert np.abs(level.cage.vertices).max() <= 1.01 and level.cage.area == pytest.approx(4.0, rel=1e-3)


def test_boxes_are_judged_exactly() -> None:
    cage = Mesh.from_loops([2.0 * ring(4)])
    low, high = cage.vertices.min(axis=0), cage.vertices.max(axis=0)
    assert Box(tuple(low), tuple(high)).fault(cage, cage) is None
    for axis in (0, 1):
        inner = high.copy()
        inner[axis] = np.nextafter(inner[axis], 0.0)
        fault = Box(tuple(low), tuple(inner)).fault(cage, cage)
        assert fault is not None and fault.code == "box.left" and fault.data["distance"] > 0.0
        assert fault.data["place"][axis] == high[axis]
    assert Box((-np.inf, low[1]), (np.inf, np.inf)).fault(cage, cage) is None


def test_what_is_missed_is_an_error_or_a_note() -> None:
    fine = Mesh.from_loops([ring(40)])
    with rejected("box.left") as caught:
        nested_cages(fine, 3, constraints=[Box((-1.01, -1.01), (1.01, 1.01))])
    assert caught.value.data["distance"] > 0.0
    level = nested_cages(fine, 3, constraints=[Box((-1.01, -1.01), (1.01, 1.01), must=False)])[0]
    assert core.verify(level.cage, fine) and "box.left" in codes(level)
    with rejected("box.left"):
        nested_cages(STAR, 12, constraints=[Box((-9.0, -9.0), (0.5, 9.0))])


def test_loops_keep_distances_of_their_own() -> None:
    wanted = [0.05 if sign > 0 else 0.02 for sign in RING.loop_signs]
    for constraint in (LoopClearance(outer=0.05, holes=0.02), LoopClearance(loops=tuple(wanted))):
        level = nested_cages(RING, 30, constraints=[constraint])[0]
        for loop, distance in zip(RING.rings, wanted, strict=True):
            near = polygon(level.cage).boundary.distance(shapely.LinearRing(loop))
            assert distance * (1.0 - 1e-9) <= near < 1.01 * distance


def test_least_edges_are_reached_and_judged_exactly() -> None:
    level = nested_cages(LETTER, 32, constraints=[LeastEdge(0.3)])[0]
    assert 0.3 <= lengths_of(level.cage).min() < 0.3 + 1e-4
    level = nested_cages(Mesh.from_loops([ring(64)]), 40, constraints=[LeastEdge(0.3)])[0]
    assert lengths_of(level.cage).min() >= 0.3 and level.excess < 0.02
    cage = Mesh.from_loops([[(0.0, 0.0), (3.0, 0.0), (3.0, 4.0), (0.0, 4.0)]])
    assert LeastEdge(3.0).fault(cage, LETTER) is None
    fault = LeastEdge(float(np.nextafter(3.0, 4.0))).fault(cage, LETTER)
    assert fault is not None and fault.code == "edge.short" and fault.data["given"] == 3.0
    third = Mesh.from_loops([[(0.0, 0.0), (0.1, 0.0), (0.3, 0.0 + 1e-17), (0.0, 1.0)]])
    assert LeastEdge(0.1).fault(third, LETTER) is None
    assert LeastEdge(3.5, must=False).fault(cage, LETTER).code == "note.edge"


@pytest.mark.slow
def test_least_angles_are_reached() -> None:
    level = nested_cages(LETTER, 20, constraints=[LeastAngle(40.0)], loops="keep")[0]
    assert 40.0 <= sharpest(level.cage) < 40.01
    assert sharpest(nested_cages(LETTER, 20, loops="keep")[0].cage) < 40.0
    wedge = Mesh.from_loops([[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]])
    fault = LeastAngle(50.0).fault(wedge, wedge)
    assert fault is not None and fault.code == "angle.sharp" and fault.data["given"] == pytest.approx(45.0)
    assert LeastAngle(44.9).fault(wedge, wedge) is None
    assert LeastAngle(50.0, must=False).fault(wedge, wedge).code == "note.angle"


@pytest.mark.slow
def test_promised_limits_without_room_are_errors() -> None:
    box = Box((-1.2, -1.2), (1.2, 1.2))
    for constraint, code in ((LeastEdge(20.0), "edge.short"), (LeastAngle(59.9), "angle.sharp")):
        with pytest.raises(core.NestedCagesError) as caught:
            nested_cages(RING, 6, clearance=0.001, constraints=[constraint, box], loops="keep")
        assert caught.value.code in {code, "box.left"}


def test_obstacles_push_the_cage_aside() -> None:
    free = nested_cages(STAR, 10)[0]
    tip = free.cage.vertices[int(np.argmax(np.hypot(*free.cage.vertices.T)))]
    shape = Mesh.from_loops([tip + 0.03 * ring(8)])
    assert Outside(shape, 0.01).fault(free.cage, STAR) is not None
    level = nested_cages(STAR, 10, constraints=[Outside(shape, 0.01)])[0]
    assert polygon(level.cage).distance(polygon(shape)) >= 0.01 * (1.0 - 1e-9)
    assert free.excess < level.excess < 1.6 * free.excess


@pytest.mark.parametrize("count", slow_after(1, [6, 7, 24]))
def test_obstacles_in_a_bay_stay_outside_if_a_straight_way_leads_out(count: int) -> None:
    fine = Mesh.from_loops([np.concatenate((ring(40)[:34], 0.6 * ring(40)[33::-1]))])
    shape = Mesh.from_loops([0.3 * ring(9)])
    assert count > 7 or polygon(nested_cages(fine, count)[0].cage).intersects(polygon(shape))
    level = nested_cages(fine, count, constraints=[Outside(shape, 0.02)])[0]
    assert polygon(level.cage).distance(polygon(shape)) >= 0.02 * (1.0 - 1e-9)


def test_a_bay_that_winds_is_an_error() -> None:
    turn = np.linspace(2.0, 14.0, 120)
    spiral = turn[:, None] * np.column_stack((np.cos(turn), np.sin(turn)))
    fine = Mesh.from_loops([np.concatenate((spiral, 1.15 * spiral[::-1] + 0.3))])
    with rejected("obstacle.met"):
        nested_cages(fine, 5, constraints=[Outside(Mesh.from_loops([0.5 * ring(9)]))])


def test_obstacles_are_judged_exactly() -> None:
    cage = Mesh.from_loops([2.0 * SQUARE])
    for corner, code in (((2.0, 0.5), "obstacle.met"), ((0.5, 0.5), "obstacle.met"), ((2.5, 0.5), None)):
        fault = Outside([SQUARE + corner], 0.5).fault(cage, cage)
        assert (fault and fault.code) == code
    around = Outside(Mesh.from_loops([4.0 * SQUARE - 1.0]))
    assert around.fault(cage, cage) is not None
    with rejected("obstacle.met"):
        nested_cages(cage, 4, constraints=[around])
    near = Outside([SQUARE + np.array([2.5, 0.5])], 0.6).fault(cage, cage)
    assert near is not None and near.data["clearance"] == 0.5 and near.data["wanted"] == 0.6


@pytest.mark.parametrize("count", slow_after(1, [12, 4, 28, 40], thorough_after=3))
@pytest.mark.parametrize("fine", [FLOWER, LETTER, RING], ids=["flower", "letter", "ring"])
def test_edges_are_exactly_along_the_axes(fine: Mesh, count: int) -> None:
    level = nested_cages(fine, max(count, 4 * len(fine.loops)), constraints=[AxisAligned()])[0]
    assert core.verify(level.cage, fine, same_loops=not any(level.report.lost)).lost == level.report.lost
    assert core.check(fine, level) and is_along_the_axes(level.cage)
    assert all(is_along_the_axes(Mesh(step, level.cage.edges)) for step in level.reinflation.cage_steps)
    if count == 4 and len(fine.loops) == 1:
        assert level.cage.area == pytest.approx(float(np.prod(np.ptp(fine.vertices, axis=0))), rel=1e-3)


@pytest.mark.parametrize(
    ("count", "area"), slow_after(1, [(8, 7.0), (12, 5.0), (4, 9.0), (5, 9.0), (6, 8.0), (10, 6.0)], thorough_after=4)
)
def test_around_a_cross_the_corners_are_left_out_that_vertices_are_for(count: int, area: float) -> None:
    """Of five unit squares in a box of nine; two more vertices leave out one more."""
    corners = [(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)]
    fine = resampled(Mesh.from_loops([np.array(corners, float)]), 96)
    level = nested_cages(fine, count, clearance=1e-6, constraints=[AxisAligned()])[0]
    assert len(level.cage.vertices) <= count and level.cage.area == pytest.approx(area, rel=1e-4)


@pytest.mark.parametrize("degrees", slow_after(1, [(TRANSIT,), ((0.0, 60.0, 120.0),), ((20.0, 110.0),)]))
def test_edges_may_have_other_directions(degrees: tuple[float, ...]) -> None:
    level = nested_cages(FLOWER, 20, constraints=[AxisAligned(degrees)], stored=np.float32)[0]
    off = directions(level.cage)[:, None] - degrees
    off = np.abs((off + 90.0) % 180.0 - 90.0).min(axis=1)
    assert (np.radians(off) * lengths_of(level.cage)).max() < 1e-6  # what rounding takes
    assert core.verify(level.cage, FLOWER)


@pytest.mark.parametrize(
    ("symmetry", "exact"), [(core.Mirror((0.0, 0.0), (0.0, 1.0)), True), (core.Rotation((0.0, 0.0), 4), False)]
)
def test_symmetric_cages_keep_directions(symmetry: core.Mirror | core.Rotation, exact: bool) -> None:
    fine = Mesh.from_loops([ring(120) * (1.0 + 0.2 * np.cos(4.0 * np.linspace(0.0, 2.0 * np.pi, 120, False)))[:, None]])
    cage = nested_cages(fine, 20, constraints=[AxisAligned()], symmetry=symmetry)[0].cage
    assert is_symmetric(cage.vertices, symmetry)
    assert is_along_the_axes(cage) if exact else np.abs((directions(cage) + 45.0) % 90.0 - 45.0).max() < 1e-12


@pytest.mark.slow
def test_each_level_and_the_side_within_keep_directions() -> None:
    for level in nested_cages(FLOWER, [40, 16], constraints=[AxisAligned(TRANSIT), LoopClearance(outer=0.02)]):
        assert AxisAligned(TRANSIT).fault(level.cage, FLOWER) is None
        assert level.report.clearance >= 0.02 * (1.0 - 1e-9)
    inner = core.inner_cages(FLOWER, 20, constraints=[AxisAligned()])[0]
    assert core.verify(FLOWER, inner.cage) and is_along_the_axes(inner.cage)
    poses = np.stack([FLOWER.vertices * (1.0 + 0.05 * t) + [0.03 * t * t, 0.1 * t] for t in range(4)])
    moving = core.animated_cages(FLOWER, poses, 16, constraints=[AxisAligned()]).levels[0]
    assert all(is_along_the_axes(Mesh(cage, moving.cage.edges)) for cage in moving.cage_steps)
    excess = [nested_cages(FLOWER, count, constraints=[AxisAligned()])[0].excess for count in (4, 12, 20, 28, 40)]
    assert excess == sorted(excess, reverse=True) and excess[-1] < 0.15


def test_meshes_of_ones_own_are_kept_if_they_have_the_directions() -> None:
    square = Mesh.from_loops([3.0 * SQUARE - 1.5])
    assert is_along_the_axes(nested_cages(FLOWER, [square], constraints=[AxisAligned()], fallback=None)[0].cage)
    skew = Mesh(square.vertices + 0.1 * (np.arange(8) == 1).reshape(4, 2), square.edges)
    with rejected("edges.not_aligned"):
        nested_cages(FLOWER, [skew], constraints=[AxisAligned()], fallback=None)
    assert "edges.not_aligned" in codes(nested_cages(FLOWER, [skew], constraints=[AxisAligned(must=False)])[0])


@pytest.mark.slow
def test_directions_that_no_cage_has_are_an_error() -> None:
    for count, constraints in ((3, [AxisAligned()]), (20, [AxisAligned(), AxisAligned((30.0, 120.0))])):
        with rejected("edges.not_aligned"):
            nested_cages(FLOWER, count, constraints=constraints)


def test_what_does_not_go_with_a_drawing_is_refused() -> None:
    for code, options in (
        ("setting.invalid", {"constraints": [object()]}),
        ("priorities.mismatch", {"constraints": [LoopClearance(loops=(0.1, 0.2))]}),
        ("setting.invalid", {"constraints": [LeastEdge(1e300)]}),
        ("setting.invalid", {"min_edge": 1e300}),
    ):
        with rejected(code):
            nested_cages(STAR, 12, **options)  # type: ignore[arg-type]


class Odd(core.Constraint):
    """Keeps nothing, but for what a test puts in."""

    def rows(self, cage: np.ndarray) -> Any:
        return ()

    def short(self, cage: np.ndarray) -> Any:
        return np.zeros(len(cage))

    def bound(self, coarse: Mesh, fine: Mesh, units: Any) -> core.Bound:
        return OddBound(self)


class OddBound(core.Bound):
    def __init__(self, of: Odd) -> None:
        self.of = of

    def rows(self, cage: np.ndarray, radius: float) -> Any:
        return self.of.rows(cage)

    def short(self, cage: np.ndarray) -> Any:
        return self.of.short(cage)


def odd(**methods: Any) -> core.Constraint:
    made: core.Constraint = type("Odd", (Odd,), methods)()
    return made


def terms(**other: Any) -> Callable[..., list[core.Terms]]:
    """Rows of three vertices, one of whose arrays is another."""
    parts = {"vertex": np.arange(3)[None], "weight": np.ones((1, 3)), "direction": np.ones((2, 3)), **other}
    room = parts.pop("room", np.ones(3))
    return lambda *_: [core.Terms(core.Rows(**parts), room)]


def answer(value: Any) -> Callable[..., Any]:
    return lambda *_: value


def fails(*_: Any) -> Any:
    raise ZeroDivisionError("division by zero")


WRONG: dict[str, list[Any]] = {
    "rows": [
        *(fails, answer(None), answer(["x"]), terms(room=np.full(3, np.nan)), terms(vertex=np.ones((1, 3)))),
        *(terms(direction=np.full((2, 3), 1e300)), terms(direction=np.ones((2, 4))), terms(vertex=np.full((1, 3), 99))),
        terms(vertex=np.ones((2, 3), int), weight=np.ones((2, 3))),
        lambda _, cage: cage.__setitem__(0, 9.0),
    ],
    "short": [answer(np.full(12, np.nan)), answer(np.full(12, -1.0)), answer(np.zeros(5))],
    "free": [answer(None), answer("far")],
    "count": [answer(2), lambda _, outline, count: count + 1, answer(8.5)],
    "distances": [answer(np.array([-1.0])), answer(np.ones(4))],
    "turn_limits": [(np.nan, 0.0), (-1.0, 0.0)],
    "bound": [answer(None)],
    "term": [answer(1.0)],
    "of": [answer(None), fails],
    "fault": [fails, answer(True)],
}
BROKEN = [(method, wrong) for method, answers in WRONG.items() for wrong in answers]


@pytest.mark.parametrize(("method", "wrong"), BROKEN, ids=[f"{k}-{row[0]}" for k, row in enumerate(BROKEN)])
def test_what_a_broken_constraint_answers_is_an_error_that_names_the_method(method: str, wrong: Any) -> None:
    with rejected("constraint.failed") as caught:
        nested_cages(star(5, 80), 12, constraints=[odd(**{method: wrong})])
    assert caught.value.data["method"] == method and caught.value.data["name"] == "Odd"


@pytest.mark.slow
@pytest.mark.parametrize("made", [
    lambda *kept: nested_cages(star(5, 80), 12, constraints=kept)[0].report,
    lambda *kept: core.inner_cages(star(5, 80), 12, constraints=kept)[0].report,
    lambda *kept: core.animated_cages(star(5, 80), [star(5, 80).vertices] * 2, 12, constraints=kept).levels[0].report,
], ids=["around", "inside", "moving"])  # fmt: skip
def test_what_is_never_kept_is_an_error_with_its_own_code(made: Callable[..., Any]) -> None:
    for never, code in (("Never.", "constraint.missed"), (core.Fault("Never.", "never", place=(1, 2)), "never")):
        with rejected(code):
            made(odd(fault=answer(never)))
    hopeless = terms(direction=np.zeros((2, 3)), room=np.full(3, -1.0))
    assert made(odd(rows=hopeless, short=lambda _, cage: np.ones(len(cage)))).notes == ()


def test_a_wish_that_is_missed_is_a_note_and_distances_need_no_judge() -> None:
    level = nested_cages(star(), 12, constraints=[odd(fault=answer("Never."), must=False)])[0]
    assert level.report.notes == ("Never.",) and codes(level) == ["constraint.missed"]
    level = nested_cages(star(), 12, constraints=[odd(distances=answer(np.array([0.05])))])[0]
    assert core.verify(level.cage, star(), 0.05)


@dataclass(frozen=True)
class LongestEdge(core.Constraint):
    """No edge is longer than a length: rows of two vertices, and no help for the start."""

    length: float

    def bound(self, coarse: Mesh, fine: Mesh, units: Any) -> core.Bound:
        return BoundLongest(coarse.successor, self.length / units.scale * (1.0 - 1e-9))

    def fault(self, cage: Mesh, fine: Mesh) -> core.Fault | None:
        longest = float(lengths_of(cage).max())
        return None if longest <= self.length else core.Fault(f"An edge is {longest:.4g} long.", "edge.long")


@dataclass(frozen=True, eq=False)
class BoundLongest(core.Bound):
    successor: np.ndarray
    most: float

    def rows(self, cage: np.ndarray, radius: float) -> Iterator[core.Terms]:
        edge = cage[self.successor] - cage
        length = np.hypot(*edge.T)
        near = np.flatnonzero(self.most - length < 3.0 * radius)
        pair, weight = np.stack((near, self.successor[near])), np.tile([[1.0], [-1.0]], len(near))
        yield core.Terms(core.Rows(pair, weight, (edge[near] / length[near, None]).T), (self.most - length)[near])

    def short(self, cage: np.ndarray) -> np.ndarray:
        lack = np.maximum(np.hypot(*(cage[self.successor] - cage).T) - self.most, 0.0)
        both = lack.copy()
        np.maximum.at(both, self.successor, lack)
        return both


@pytest.mark.slow
def test_a_constraint_of_ones_own_is_kept_by_all_kinds_of_cages() -> None:
    fine, kept = star(5, 80), LongestEdge(0.7)
    assert lengths_of(nested_cages(fine, 16)[0].cage).max() > kept.length
    levels = [
        *nested_cages(fine, 16, constraints=[kept]),
        *nested_cages(fine, 20, constraints=[kept, Box((-1.6, -1.6), (1.6, 1.6))]),
        *nested_cages(fine, core.Within(excess=0.5), constraints=[kept]),
        *core.inner_cages(fine, 16, constraints=[kept]),
    ]
    poses = [fine.vertices * (1.0, 1.0 + 0.02 * k) for k in range(3)]
    moving = core.animated_cages(fine, poses, 20, constraints=[kept]).levels[0]
    steps = [Mesh(step, moving.cage.edges) for step in moving.cage_steps]
    assert all(lengths_of(cage).max() <= kept.length for cage in (*(level.cage for level in levels), *steps))
    with rejected("edge.long"):
        nested_cages(fine, 16, constraints=[kept], grid=0.1)


def test_a_constraint_of_ones_own_lets_loops_be_joined() -> None:
    fine = Mesh.from_loops([ring(40), np.array([2.2, 0.0]) + ring(40), 0.3 * ring(20)])
    for count in (8, 30):
        level = nested_cages(fine, count, constraints=[LongestEdge(4.0)])[0]
        assert len(level.cage.vertices) <= count and core.verify(level.cage, fine, same_loops=False)
        assert lengths_of(level.cage).max() <= 4.0


OURS = [
    *(make(STAR) for make in MAKERS.values()),
    *(AxisAligned(TRANSIT), LongestEdge(1.2), Box((-np.inf, -2.0), (np.inf, np.inf))),
]


@pytest.mark.parametrize("constraint", OURS, ids=lambda each: type(each).__name__)
def test_our_own_constraints_obey_what_they_must(constraint: core.Constraint) -> None:
    core.check_constraint(constraint, STAR)


class Tried(core.Constraint):
    """No vertex lies right of a line, with hooks that a test makes wrong."""

    right = 1.4

    def bound(self, coarse: Mesh, fine: Mesh, units: Any) -> core.Bound:
        limit = float(units.points(np.array([self.right, 0.0]))[0])
        return type("BoundTried", (TriedBound,), type(self).wrong)(limit)  # type: ignore[attr-defined]

    def fault(self, cage: Mesh, fine: Mesh) -> core.Fault | None:
        beyond = float(cage.vertices[:, 0].max() - self.right)
        return core.Fault(f"{beyond} beyond.", "beyond") if beyond > 1e-12 else None


class TriedBound(core.Bound):
    slope, part, shift = -1.0, 1.0, 0.0

    def __init__(self, limit: float) -> None:
        self.limit = limit

    def rows(self, cage: np.ndarray, radius: float) -> Iterator[core.Terms]:
        room = self.limit - cage[:, 0] + self.shift
        near = np.flatnonzero(room < 1.5 * self.part * radius)
        direction = np.outer([self.slope, 0.0], np.ones(len(near)))
        yield core.Terms(core.Rows(near[None], np.ones((1, len(near))), direction), room[near])


TRIED: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "a wrong slope": ({}, {"slope": -0.5}, "derivatives of its room"),
    "rows left out": ({}, {"part": 0.01}, "within the radius"),
    "nothing is short": ({}, {"short": lambda bound, cage: np.zeros(len(cage))}, "missed"),
    "another limit": ({}, {"shift": 0.2}, "must accept"),
    "moved each time": ({"snapped": lambda self, coarse, steps, side: steps + 1e-3}, {}, "snapped"),
}


@pytest.mark.parametrize(("hooks", "wrong", "said"), TRIED.values(), ids=TRIED.keys())
def test_what_a_constraint_does_wrong_is_named(hooks: dict[str, Any], wrong: dict[str, Any], said: str) -> None:
    made = type("Tried", (Tried,), {**hooks, "wrong": wrong})
    core.check_constraint(type("Tried", (Tried,), {"wrong": {}})(), STAR)
    with rejected("constraint.failed") as caught:
        core.check_constraint(made(), STAR)
    assert said in str(caught.value)
