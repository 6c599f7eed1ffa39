"""The certificate of a cage against shapely and fractions, and that of a motion against exact instants of contact."""

import math
from contextlib import suppress
from fractions import Fraction
from math import nan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely.geometry

from nestedcages_core import Certificate, InvalidMeshError, Mesh, check, verify, verify_motion
from support.judging import rejected
from support.marks import slow_after
from support.shapes import jagged, mesh, polygon, ring

polygon_of = shapely.geometry.shape


def square(half: float, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """An upright square, (4, 2)."""
    return np.array([[-half, -half], [half, -half], [half, half], [-half, half]]) + np.array(centre)


def test_a_square_in_a_square() -> None:
    certificate = verify(mesh(square(2.0)), mesh(square(1.0)), 1.0)
    assert certificate == Certificate(True, True, True, 1.0, 3.0, ())
    assert certificate.holds and certificate


def test_holes_islands_and_components() -> None:
    fine = mesh(ring(40, 5.0), ring(30, 3.0), ring(20, 2.0), ring(10, 1.0), ring(9, 1.0, centre=(9.0, 0.0)))
    cage = mesh(ring(4, 1.6, centre=(9.0, 0.0)), ring(8, 2.2), ring(16, 5.5), ring(6, 2.9), ring(3, 0.9))
    certificate = verify(cage, fine)
    assert (certificate.holds, certificate.simple, certificate.strict, certificate.loops_kept) == (True,) * 4
    assert certificate.excess == pytest.approx(polygon_of(cage).area / polygon_of(fine).area - 1)
    assert certificate.clearance == pytest.approx(polygon_of(cage).boundary.distance(polygon_of(fine).boundary))


# Cages that do not: what is said of them, the code of a problem, and its data

TWO = mesh(ring(9), ring(9, 1.0, centre=(5.0, 0.0)))
DISC, RING = mesh(ring(40)), mesh(ring(40), ring(40, 0.5))
STRICT, NOT_STRICT, NOT_SIMPLE = (True, True, False), (True, False, False), (False, False, False)
"""Simple, strict, loops kept; a cage that meets or leaves out something has no loops to speak of."""

WRONG: dict[str, tuple[Mesh, Mesh, tuple[bool, bool, bool | None], str, dict[str, Any]]] = {
    "a thin ring around the boundary": (
        mesh(ring(40, 1.01), ring(40, 0.99)), DISC, (True, False, None), "cage.leaves_out",
        {"loops": (1,), "place": (0.99, 0.0)},
    ),
    "a thin ring around both boundaries": (
        mesh(ring(40, 1.01), ring(40, 0.99), ring(40, 0.49), ring(40, 0.51)), RING, (True, False, None),
        "cage.leaves_out", {"loops": (1,)},
    ),
    "a component is left out": (
        mesh(ring(9, 1.5)), TWO, NOT_STRICT, "cage.leaves_out", {"loops": (1,), "place": (6.0, 0.0)},
    ),
    "as many loops, one of them elsewhere": (
        mesh(ring(9, 1.5), ring(9, 1.5, centre=(9.0, 0.0))), TWO, NOT_STRICT, "cage.leaves_out", {"loops": (1,)},
    ),
    "a component in a hole": (
        mesh(ring(9, 6.0), ring(9, 2.5)), mesh(ring(9), ring(9, 5.0), ring(9, 3.0)), (True, False, None),
        "cage.leaves_out", {"loops": (0,), "place": (1.0, 0.0)},
    ),
    "inside": (mesh(square(0.3)), DISC, NOT_STRICT, "cage.leaves_out", {"loops": (0,), "place": (1.0, 0.0)}),
    "beside": (mesh(square(2.0, (9.0, 9.0))), DISC, NOT_STRICT, "cage.leaves_out", {"place": (1.0, 0.0)}),
    "a hole is covered": (mesh(square(2.0)), RING, STRICT, "cage.loops_differ", {}),
    "two share a loop": (mesh(square(9.0)), TWO, STRICT, "cage.loops_differ", {}),
    "two share a loop beside another": (
        mesh(square(9.0), square(1.0, (20.0, 0.0))), TWO, STRICT, "cage.loops_differ",
        {"loops": (0,), "place": (1.0, 0.0)},
    ),
    "a hole instead of a loop": (mesh(square(9.0), square(0.5, (2.5, 2.5))), TWO, STRICT, "cage.loops_differ", {}),
    "a hole beside": (mesh(square(9.0), square(0.5, (5.0, 5.0))), RING, STRICT, "cage.loops_differ", {"loops": (1,)}),
    "an island and a hole apart": (
        mesh(square(9.0), square(4.0, (20.0, 0.0)), square(3.0, (20.0, 0.0))),
        mesh(square(5.0), square(3.0), square(1.0)), STRICT, "cage.loops_differ",
        {"loops": (2,), "place": (17.0, -3.0)},
    ),
    "a hole wider than that of the shape": (
        mesh(square(9.0), square(2.0)), mesh(square(5.0), square(1.0)), NOT_STRICT, "cage.leaves_out", {"loops": (1,)},
    ),
    "two holes in one of the shape": (
        mesh(square(9.5), square(0.2, (-0.5, 0.0)), square(0.2, (0.5, 0.0))),
        mesh(square(9.0), square(1.0), square(1.0, (5.0, 0.0))), STRICT, "cage.loops_differ",
        {"loops": (1,), "place": (-0.7, -0.2)},
    ),
    "the shape itself": (mesh(square(1.0)), mesh(square(1.0)), NOT_STRICT, "cage.meets", {}),
    "across": (mesh(square(2.0, (1.0, 0.0))), mesh(square(1.0)), NOT_STRICT, "cage.meets", {}),
    "an edge touches a corner": (
        mesh([[-9, -9], [9, -9], [1, 1], [-9, 9]]), mesh(square(1.0)), NOT_STRICT, "cage.meets", {"place": (1.0, 1.0)},
    ),
    "it crosses itself": (
        mesh(square(3.0)).moved(square(3.0)[[0, 2, 1, 3]]), DISC, NOT_SIMPLE, "cage.invalid",
        {"loops": (0,), "place": (0.0, 0.0)},
    ),
    "the shape crosses itself": (
        mesh(square(3.0)), mesh(square(1.0)).moved(square(1.0)[[0, 2, 1, 3]]), NOT_STRICT, "fine.invalid", {},
    ),
    "turned inside out": (
        mesh(square(3.0)).moved(square(3.0)[::-1]), DISC, STRICT, "cage.turned", {"loops": (0,), "place": (-3.0, 3.0)},
    ),
    "loops that changed roles": (
        mesh(square(3.0), square(0.2)).moved(np.concatenate((square(0.2), square(3.0)[::-1]))), RING, STRICT,
        "cage.turned", {"loops": (0,), "place": (-0.2, -0.2)},
    ),
}  # fmt: skip


@pytest.mark.parametrize(("cage", "fine", "verdicts", "code", "data"), WRONG.values(), ids=WRONG.keys())
def test_what_is_wrong_with_a_cage_is_named(
    cage: Mesh, fine: Mesh, verdicts: tuple[bool, bool, bool | None], code: str, data: dict[str, Any]
) -> None:
    found = verify(cage, fine)
    assert not found
    assert (found.simple, found.strict) == verdicts[:2]
    assert verdicts[2] is None or found.loops_kept == verdicts[2]
    assert any(
        problem.code == code and all(problem.data[name] == pytest.approx(value) for name, value in data.items())
        for problem in found.problems
    ), [(problem.code, problem.data) for problem in found.problems]
    # one loop may wrap two, and holes may be covered, where that is wanted; the independent checker agrees
    assert verify(cage, fine, same_loops=False).holds == (code == "cage.loops_differ")
    assert (found.clearance == 0.0) == (code == "cage.meets")
    assert math.isnan(found.clearance) == code.endswith(".invalid")
    if code not in ("cage.turned", "fine.invalid"):
        assert not check(fine, cage)
        assert bool(check(fine, cage, same_loops=False)) == (code == "cage.loops_differ")


def test_a_loop_beside_does_not_make_up_for_a_hole() -> None:
    found = verify(mesh(square(9.0), square(1.0, (20.0, 0.0))), RING)
    assert (found.strict, found.loops_kept, found.problems[0].code) == (True, False, "cage.loops_differ")


def test_loops_that_a_cage_has_no_part_for_are_listed() -> None:
    """Two squares in one loop, one of them with two holes of which one is filled; what lies in that is not named."""
    fine = mesh(square(4.0), square(1.0, (-2.0, 0.0)), square(1.0, (2.0, 0.0)), square(0.5, (2.0, 0.0)))
    fine = mesh(*fine.rings, square(2.0, (9.0, 0.0)))
    cage = mesh([(-5, -5), (12, -5), (12, 5), (-5, 5)], square(0.5, (-2.0, 0.0)))
    lost = verify(cage, fine, same_loops=False).lost
    assert (lost.filled, lost.joined) == ((2,), ((0, 4),))
    assert len({str(each) for each in (lost, lost._replace(filled=()), lost._replace(joined=()))}) == 3
    assert len(check(fine, cage, same_loops=False).lost) == 2
    in_hole = mesh(square(4.0), square(3.0), square(1.0), square(0.5, (2.0, 2.0)))
    assert verify(mesh(square(5.0), square(2.9)), in_hole, same_loops=False).problems[0].code == "cage.leaves_out"
    assert verify(mesh(square(5.0)), in_hole, same_loops=False).lost.filled == (1,)


def test_edges_that_meet_are_named() -> None:
    long = mesh([[-9.0, -9.0], [0.0, -9.0], [0.0, 9.0], [-9.0, 9.0]])
    (problem,) = verify(long, mesh(square(1.0))).problems
    assert problem.data["vertices"] in ((1, 2, 0, 1), (1, 2, 2, 3))


@pytest.mark.parametrize("value", [nan, np.inf, 1e200])
def test_numbers_that_are_none(value: float) -> None:
    coarse, fine = mesh(square(3.0)), mesh(ring(9))
    for which, points, code in ((coarse, square(3.0), "cage.invalid"), (fine, ring(9), "fine.invalid")):
        points[2, 1] = value
        broken = which.moved(points)
        certificate = verify(broken, fine) if which is coarse else verify(coarse, broken)
        assert (certificate.simple, certificate.strict, certificate.loops_kept) == (which is fine, False, False)
        assert [problem.code for problem in certificate.problems] == [code]


def test_clearance_is_asked_for_to_a_billionth() -> None:
    cage, fine = mesh(square(2.0)), mesh(square(1.0))
    assert verify(cage, fine, 1.0 + 5e-10).holds
    for wanted in (1.0 + 2e-9, 1.5):
        found = verify(cage, fine, wanted)
        assert (found.simple, found.strict, found.loops_kept) == (True, True, True)
        (problem,) = found.problems
        assert (problem.code, problem.data) == ("cage.too_close", {"clearance": 1.0, "wanted": wanted})
    assert verify(cage, fine, nan).problems[0].code == "cage.too_close"


@pytest.mark.parametrize("seed", slow_after(6, range(12)))
def test_clearance_against_shapely(seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = mesh(jagged(random, int(random.integers(5, 2000))))
    cage = mesh(ring(int(random.integers(5, 300)), random.uniform(1.3, 3.0)))
    expected = polygon_of(cage).boundary.distance(polygon_of(fine).boundary)
    for a, b in ((cage, fine), (fine, cage)):
        assert verify(a, b).clearance == pytest.approx(expected, rel=1e-12)


def test_cages_at_a_constant_distance_are_measured() -> None:
    circle = ring(5000)
    assert verify(mesh(1.001 * circle), mesh(circle)).clearance == pytest.approx(1e-3 * np.cos(np.pi / 5000), rel=1e-9)


def test_one_double_decides() -> None:
    a, b, c = (Fraction(x) for x in (0.1, 0.7, 1.3))
    cage = mesh([[0.1, 0.1], [1.3, 0.7], [0.3, 1.9]])
    verdicts = []
    for share in np.linspace(0.05, 0.95, 60):
        x = 0.1 + share * 1.2
        height = a + (Fraction(x) - a) * (b - a) / (c - a)  # of the lower edge at x, exactly
        y = float(height)
        for corner in (np.nextafter(y, -1.0), y, np.nextafter(y, 9.0)):
            certificate = verify(cage, mesh([[x, corner], [0.5, 0.9], [0.45, 0.9]]))
            assert certificate.strict == (Fraction(float(corner)) > height)
            verdicts.append(certificate.strict)
    assert len(set(verdicts)) == 2


def random_shape(random: np.random.Generator, size: float) -> Mesh:
    loops = [jagged(random, int(random.integers(8, 40))) * size]
    if random.random() < 0.6:
        loops.append(jagged(random, int(random.integers(3, 20))) * size * random.uniform(0.1, 0.25))
    if random.random() < 0.3:
        loops.append(jagged(random, 5) * 0.3 + np.array([size * 1.4, 0.0]))
    return mesh(*loops)


@pytest.mark.parametrize("seeds", slow_after(1, [range(40), range(40, 340)], thorough_after=1), ids=str)
def test_random_pairs_against_shapely(seeds: range) -> None:
    for random in map(np.random.default_rng, seeds):
        fine, cage = random_shape(random, 1.0), random_shape(random, random.uniform(0.5, 5.0))
        inner, outer = polygon_of(fine), polygon_of(cage)
        certificate = verify(cage, fine)
        assert certificate.strict == outer.contains_properly(inner)
        assert certificate.simple
        assert certificate.excess == pytest.approx(outer.area / inner.area - 1)
        assert certificate.clearance == pytest.approx(outer.boundary.distance(inner.boundary), rel=1e-9, abs=1e-12)
        if certificate.strict:
            between = outer.difference(inner)
            rings = [between] if between.geom_type == "Polygon" else list(between.geoms)
            kept = len(rings) == len(fine.loops) and all(len(part.interiors) == 1 for part in rings)
            assert certificate.loops_kept == (kept and len(cage.loops) == len(fine.loops))


@pytest.mark.parametrize("hole", [False, True])
def test_offsets_of_random_shapes_hold_at_their_distance(hole: bool) -> None:
    random = np.random.default_rng(3)
    for _ in range(10):
        loop = jagged(random, 30)
        fine = mesh(loop, 0.3 * loop) if hole else mesh(loop)
        cage = Mesh.from_geometry(shapely.geometry.mapping(polygon(fine).buffer(0.02, join_style="mitre")))
        certificate = verify(cage, fine, 0.02 * (1 - 1e-6))
        assert certificate.holds, certificate.problems


@pytest.mark.parametrize("exponent", slow_after(3, [-450, 1, 450, -60, -1, 60]))
def test_the_verdict_does_not_depend_on_the_unit(exponent: int) -> None:
    random = np.random.default_rng(abs(exponent))
    inner, outer = [jagged(random, 50), 0.3 * jagged(random, 20)], [ring(7, 1.3), 0.05 * ring(5)]
    for cage in (outer, [ring(7, 0.9), 0.05 * ring(5)], outer[:1]):
        here = verify(mesh(*cage), mesh(*inner))
        there = verify(mesh(*(np.ldexp(p, exponent) for p in cage)), mesh(*(np.ldexp(p, exponent) for p in inner)))
        assert (here.simple, here.strict, here.loops_kept) == (there.simple, there.strict, there.loops_kept)
        assert there.clearance == math.ldexp(here.clearance, exponent)
        assert there.excess == here.excess


@pytest.mark.slow
def test_crowded_pairs_are_no_trouble() -> None:
    random = np.random.default_rng(5)
    spikes = jagged(random, 10_000)
    certificate = verify(mesh(1.001 * spikes), mesh(spikes))
    assert certificate.strict == polygon_of(mesh(1.001 * spikes)).contains_properly(polygon_of(mesh(spikes)))
    scribble = mesh(ring(10_000)).moved(random.uniform(-1, 1, size=(10_000, 2)))
    assert verify(scribble, mesh(ring(9))).problems[0].code == "cage.invalid"


def test_what_is_no_shape_is_rejected() -> None:
    for thing in (None, 5, "square", Mesh, {1, 2}, object()):
        for pair in ((thing, [ring(8)]), ([ring(8)], thing)):
            with rejected("mesh.unreadable", InvalidMeshError):
                verify(*pair)  # type: ignore[arg-type]


# The certificate of a motion

AROUND_A_CORNER = mesh([[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]])
PRONGS = mesh([[-3, 0], [3, 0], [3, 5], [0.5, 5], [0.5, 2], [-0.5, 2], [-0.5, 5], [-3, 5]])
DOT = mesh(0.1 * ring(8))


def certificate(cage: Mesh, fine: Mesh, fine_steps: np.ndarray) -> Any:
    """That of a drawing that moves in a cage that rests."""
    return verify_motion(cage, fine, np.repeat(cage.vertices[None], len(fine_steps), axis=0), fine_steps)


def motion_checked(cage: Mesh, fine: Mesh, cage_steps: Any, fine_steps: Any) -> bool:
    """Whether the independent checker finds no contact in a motion whose first step is nested: backwards it is the way
    of a level, of which only the end has to be."""
    back = SimpleNamespace(cage_steps=cage_steps[::-1], fine_steps=fine_steps[::-1])
    begin = fine.moved(fine_steps[0])
    return bool(check(begin, [SimpleNamespace(cage=cage.moved(cage_steps[0]), fine=begin, reinflation=back)]))


@pytest.mark.parametrize("jump", range(5))
def test_every_interval_is_looked_at_and_the_first_that_fails_is_named(jump: int) -> None:
    """A jump through the corner, so long that little else is looked at together with it."""
    places = [(3.5, 0.5)] * (jump + 1) + [(0.5, 3.5)] * (5 - jump)
    found = certificate(AROUND_A_CORNER, DOT, DOT.vertices + np.array(places)[:, None])
    assert not found
    assert found.step == jump


CORRIDOR = mesh([[-2, -0.2], [2, -0.2], [2, 0.2], [-2, 0.2]])


@pytest.mark.parametrize(
    ("room", "corners", "begin", "count", "travel", "wall"),
    [
        (mesh(2.0 * ring(4, angle=np.pi / 4.0)), 8, (0.5, 0.5), 8, 1.2, np.sqrt(2.0)),
        pytest.param(CORRIDOR, 1600, (0.0, 0.0), 520, 2.0, 2.0, marks=pytest.mark.slow),
    ],
    ids=["a few steps", "many steps along walls"],
)
def test_small_steps_to_a_wall_add_up(
    room: Mesh, corners: int, begin: Any, count: int, travel: float, wall: float
) -> None:
    """Those that meet it are shorter than its distance at first; the vertex that meets it is named."""
    dot = mesh(0.1 * ring(corners))
    moves = np.linspace(0.0, travel, count + 1)[:, None, None] * [1.0, 0.0]
    meets = int(np.argmax(begin[0] + 0.1 + moves[:, 0, 0] >= wall)) - 1
    steps = dot.vertices + np.array(begin) + moves
    found = certificate(room, dot, steps)
    assert not found
    assert found.step == meets
    assert found.vertex == len(room.vertices)  # the one on the right
    assert certificate(room, dot, steps[: meets + 1])


ON_BOTH_SIDES: list[tuple[Mesh, dict[int, Any], Any]] = [
    (PRONGS, {3: (-0.7, 0.0), 6: (0.7, 0.0)}, (0.0, 1.0)),
    *((mesh(4.0 * ring(4)), {0: (-2.0, 0.0)}, (1.7, side * 1.7)) for side in (-1.0, 1.0)),
]


@pytest.mark.parametrize(("cage", "moves", "place"), ON_BOTH_SIDES, ids=["two corners", "the start", "the end"])
def test_what_moves_on_either_side_of_a_pair_counts(cage: Mesh, moves: dict[int, Any], place: Any) -> None:
    """Two corners that each go more than half of their distance; an edge of which only the start or the end moves."""
    fine, after = DOT.moved(DOT.vertices + np.array(place)), cage.vertices.copy()
    for corner, move in moves.items():
        after[corner] += move
    steps = np.stack([cage.vertices, after]), np.stack([fine.vertices] * 2)
    assert not verify_motion(cage, fine, *steps)
    assert not motion_checked(cage, fine, *steps)
    halfway = np.stack([cage.vertices, 0.5 * (cage.vertices + after)]), steps[1]
    assert verify_motion(cage, fine, *halfway).free == motion_checked(cage, fine, *halfway)


@pytest.mark.slow
def test_distances_count_with_the_rounding_of_large_coordinates() -> None:
    """A corner comes to lie on a wall exactly, in one step as long as their distance, far from the origin."""
    random = np.random.default_rng(5)
    for _ in range(40):
        k, j, gap = (int(number) for number in random.integers((8, 1, 1), (400, 7, 40)))
        start = 2.0**10 + random.integers(0, 2**20, 2) * 2.0**-20
        along, across = np.array([3.0, 4.0]) * 2.0**-30, np.array([-4.0, 3.0]) * 2.0**-30
        foot = start + j * (k // 8) * along
        cage = mesh([start, start + k * along, start + 1e4 * k * across])
        there = np.array([foot, foot + 2.0 * k * across, foot + 2.0 * k * across - along])
        here = there + np.outer([1.0, 0.0, 0.0], gap * across)
        assert not certificate(cage, mesh(here), np.stack([here, there]))


@pytest.mark.slow
def test_a_touch_that_rounding_hides_is_not_certified() -> None:
    """A point arrives on an edge or less than a rounding behind it; by the checker, half of these motions touch."""
    random = np.random.default_rng(5)
    touched = 0
    for _ in range(120):
        start, end = random.uniform(-1.0, 1.0, 2) * 10.0 ** random.integers(-6, 1, 2), random.uniform(-1.0, 1.0, 2)
        left = np.array([start[1] - end[1], end[0] - start[0]])
        cage = mesh([start, end, 0.5 * (start + end) + 2.0 * left])
        fine = mesh(0.01 * ring(3) + cage.vertices.mean(axis=0))
        after = fine.vertices.copy()
        after[0] = start + random.uniform(0.2, 0.8) * (end - start)
        steps = np.stack([cage.vertices, cage.vertices]), np.stack([fine.vertices, after])
        if not motion_checked(cage, fine, *steps):
            touched += 1
            assert not verify_motion(cage, fine, *steps)
    assert touched > 30


@pytest.mark.slow
def test_contact_in_passing_is_never_certified() -> None:
    """A point runs through the start of an edge while the edge points along its path: they touch for an instant, at
    s = 2^-k. Exact contact, by differences of doubles that round."""
    random = np.random.default_rng(1)
    shape = mesh(ring(3))
    for _ in range(150):
        parts = 2 ** int(random.integers(1, 12))
        far = random.integers(1, 2**20, 2) * 2.0**-20 * random.choice([-1, 1], 2)
        near = random.integers(1, 2**10, 2) * 2.0**-60
        # p - a is far + near at first and -(parts - 1) (far + near) at last, so zero at s = 1 / parts
        p0, a0, p1, a1 = near, -far, -(parts - 1) * near, (parts - 1) * far
        for k in range(2):
            at_first, at_last = Fraction(p0[k]) - Fraction(a0[k]), Fraction(p1[k]) - Fraction(a1[k])
            assert (parts - 1) * at_first + at_last == 0
        path = p0 - a0
        turning = np.array([-path[1], path[0]]) * random.uniform(0.2, 2.0) * random.choice([-1, 1])
        along = path * random.uniform(0.5, 2.0) * random.choice([-1, 1])
        cage = np.array([[a0, a0 + along - turning / parts], [a1, a1 + along + turning * (1 - 1 / parts)]])
        away = np.array([50.0, 80.0])  # the third corners are nowhere near
        cage = np.concatenate([cage, np.tile(away, (2, 1, 1))], axis=1)
        fine = np.array([[p0, p0 - away, p0 - away[::-1]], [p1, p1 - away, p1 - away[::-1]]])
        assert not verify_motion(shape, shape, cage, fine)


@pytest.mark.parametrize(("scale", "shift"), slow_after(1, [(1.0, 0.0), (0.1, 100.1), (2.0**-490, 0.0)]))
def test_motions_on_a_lattice_are_certified_only_without_contact(scale: float, shift: float) -> None:
    """Points and edges that move between points of a small lattice, where contacts are common: as they are, rounded,
    and as small as shapes may be. By the checker, in whole numbers."""
    random, met, tried = np.random.default_rng(1), 0, 0
    for _ in range(200):
        before = random.integers(-4, 5, (3, 2)).astype(float)
        (a, b, p), after = before, before + random.integers(-1, 2, (3, 2))
        left = 10.0 * np.array([a[1] - b[1], b[0] - a[0]])
        cage = np.array([[a, b, a + left], [*after[:2], a + left]])
        inner = a + 0.8 * left + 0.02 * (b - a)  # beside the third corner
        fine = np.array([[p, inner, inner - 0.1 * left], [after[2], inner, inner - 0.1 * left]])
        cage, fine = scale * cage + shift, scale * fine + shift
        with suppress(InvalidMeshError):
            shape, drawing = mesh(cage[0]), mesh(fine[0])
            if (shape.vertices[shape.edges] == cage[0][[[0, 1], [1, 2], [2, 0]]]).all() and verify(shape, drawing):
                free, exactly = (of(shape, drawing, cage, fine) for of in (verify_motion, motion_checked))
                assert exactly or not free
                assert scale != 1.0 or bool(free) == exactly
                tried, met = tried + 1, met + (not exactly)
    assert 10 < met < tried - 10


def test_an_edge_that_turns_around_through_a_point_meets_nothing_far_away() -> None:
    """A fine edge shrinks to a point in the middle of the way and comes out reversed."""
    fine = mesh([[0, 0], [1, 0], [1, 1], [0, 1]])
    after = fine.vertices.copy()
    after[[0, 1]] = after[[1, 0]]
    fine_steps = np.stack([fine.vertices, after])
    for half, free in ((0.6, True), (0.5, False)):
        assert certificate(mesh(0.5 + square(half)), fine, fine_steps).free == free


def test_a_cage_that_crosses_itself_on_the_way_is_found() -> None:
    cage, fine = mesh(square(3.0)), mesh(square(0.1, (-2.5, -2.5)))
    after = cage.vertices.copy()
    after[2] = [-2.9, -2.8]
    assert not verify_motion(cage, fine, np.stack([cage.vertices, after]), np.stack([fine.vertices] * 2))


def test_bad_steps_are_rejected() -> None:
    cage, fine = mesh(ring(8, 2.0)), mesh(ring(6))
    still, standing = np.stack([cage.vertices] * 2), np.stack([fine.vertices] * 2)
    assert verify_motion(cage, fine, still, standing)
    assert verify_motion([cage.vertices], fine.__geo_interface__, still, standing)
    broken = standing.copy()
    broken[1, 4, 0] = nan
    for steps, code in (
        ((still, broken), "mesh.not_finite"),
        ((still[:, 1:], standing), "mesh.unreadable"),
        ((still, standing[0]), "mesh.unreadable"),
        ((still, standing[:1]), "mesh.unreadable"),
        ((still, "none"), "mesh.unreadable"),
        ((still[:0], standing[:0]), "mesh.unreadable"),
    ):
        with rejected(code):
            verify_motion(cage, fine, *steps)  # type: ignore[arg-type]
