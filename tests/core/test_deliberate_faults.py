"""Faults that were once put in by hand and went unnoticed: each test here fails when its fault is put in again, which
``python packaging/mutants.py --by-hand`` does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import gcd
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from test_quadratic_program import random_program

from nestedcages_core import (
    Mesh,
    NestingError,
    Rotation,
    Settings,
    Tightening,
    Within,
    animated_cages,
    check,
    followed,
    nested_cages,
    to_engine_json,
    verify_motion,
)
from nestedcages_core.checker import faults_of_motion
from nestedcages_core.command import main, making
from nestedcages_core.constraints import convex
from nestedcages_core.constraints.numbers import Numbers
from nestedcages_core.constraints.symmetric import Symmetric
from nestedcages_core.contact.pairs import Bodies
from nestedcages_core.decimation import Start
from nestedcages_core.geometry.lattice import Grid
from nestedcages_core.geometry.predicates import orientation
from nestedcages_core.level import motion_gate
from nestedcages_core.level.builder import LevelBuilder
from nestedcages_core.level.settling import Settling
from nestedcages_core.motion import following
from nestedcages_core.motion.animated import certified_still
from nestedcages_core.solver.quadratic_program import InteriorPoint, QPSolution
from nestedcages_core.tasks import Stage, drain
from nestedcages_core.tightening.trust_region import Trial, TrustRegion
from nestedcages_core.tolerance.reach import reach
from nestedcages_core.verification import motion
from support.marks import slow_after
from support.shapes import islands, letter_a, letter_a_coarse, resampled, ring, star


def test_a_touch_that_rounding_hides_is_not_certified() -> None:
    """Motion certificate without bounds on its rounding errors: a point arrives on an edge or less than a rounding
    behind it, where the product in float64 is at times above zero; by the checker, half of these motions touch."""
    random = np.random.default_rng(5)
    touched = 0
    for _ in range(120):
        start, end = random.uniform(-1.0, 1.0, 2) * 10.0 ** random.integers(-6, 1, 2), random.uniform(-1.0, 1.0, 2)
        left = np.array([start[1] - end[1], end[0] - start[0]])
        cage = Mesh.from_loops([np.array([start, end, 0.5 * (start + end) + 2.0 * left])])
        fine = Mesh.from_loops([0.01 * ring(3) + cage.vertices.mean(axis=0)])
        after = fine.vertices.copy()
        after[0] = start + random.uniform(0.2, 0.8) * (end - start)
        cage_steps, fine_steps = np.stack([cage.vertices, cage.vertices]), np.stack([fine.vertices, after])
        if faults_of_motion(cage.edges, fine.edges, cage_steps, fine_steps, [0]):
            touched += 1
            assert not verify_motion(cage, fine, cage_steps, fine_steps)
    assert touched > 30


@dataclass(frozen=True)
class Offered:
    """A decimation that offers given coarse meshes."""

    meshes: tuple[Mesh, ...]

    def decimate(self, fine: Mesh, count: Any, *, clearance: float = 0.0) -> Mesh:
        return self.meshes[0]

    def starts(self, fine: Mesh, count: Any, *, clearance: float) -> Stage[float, list[Start]]:
        yield 0.0
        return [Start(mesh, "offered") for mesh in self.meshes]


@pytest.mark.parametrize("order", slow_after(1, [((1, 2, 0),), ((0, 1, 2),), ((2, 1, 0),)]))
def test_the_tightest_of_several_starts_is_kept(order: tuple[int, ...]) -> None:
    """The loosest of several starts kept: here, they end in optima that are far apart, and come in several orders."""
    letter = letter_a()
    fine = Mesh.from_loops([letter.vertices[letter.loops[0]]])
    starts = tuple(Mesh.from_loops([ring(5, 5.2, angle) + np.array([0.0, 2.0])]) for angle in (0.0, 0.63, 0.94))
    areas = [nested_cages(fine, [start], Settings(fallback=None)).cages[0].area for start in starts]
    assert max(areas) > 1.08 * min(areas) > (1.0 + 1e-9) * min(areas)
    offered = Offered(tuple(starts[k] for k in order))
    chosen = Settings(decimation=offered, fallback=None)
    assert nested_cages(fine, [5], chosen).cages[0].area < (1.0 + 1e-9) * min(areas)


@dataclass(frozen=True)
class Careless(Tightening):
    """A tightening that turns the cage over and back again before it does its work."""

    def run(self, bodies: Any, cage: Any, fine: Any, **options: Any) -> Any:
        yield cage * np.array([-1.0, 1.0])
        yield cage
        return (yield from super().run(bodies, cage, fine, **options))


def test_a_level_whose_motion_fails_is_not_returned() -> None:
    """A level returned although its motion failed: its cage is sound, but the way to it is not."""
    with pytest.raises(NestingError, match="could not be certified free of collisions"):
        nested_cages(letter_a(), [letter_a_coarse()], Settings(tightening=Careless(), fallback=None))


GOLDENS = {
    "letter at 24": (lambda: letter_a(6), 24, 0.0990683),
    "star at 18": (star, 18, 0.1654790),
    "islands on their own coarse mesh": (islands, resampled(islands(), 40), 0.1339393),
}
"""Shape, level and excess of the default settings: a cage that is 1.01 times as loose fails; round-off is far less."""

WORSE = 1.005
"""Factor on the excess up to which a cage is as tight as it was."""


@pytest.mark.parametrize(("shape", "level", "excess"), GOLDENS.values(), ids=GOLDENS.keys())
def test_cages_stay_as_tight_as_they_are(shape: Callable[[], Mesh], level: int | Mesh, excess: float) -> None:
    """Excess goldens; one that falls is to be lowered, one that rises is a loss."""
    found = nested_cages(shape(), [level]).levels[0].report.excess
    assert excess / 1.02 < found < WORSE * excess


MEAN_ITERATIONS = 4.5
"""Linear systems of small random programs: 3.65 today, 5.6 where the centring parameter is 0.3 at least."""

# The certificate of motions

AROUND_A_CORNER = Mesh.from_loops([np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]], float)])
DOT = Mesh.from_loops([0.1 * ring(8)])


def certificate(cage: Mesh, fine: Mesh, fine_steps: np.ndarray) -> Any:
    """That of a drawing that moves in a cage that rests."""
    return verify_motion(cage, fine, np.repeat(cage.vertices[None], len(fine_steps), axis=0), fine_steps)


@pytest.mark.parametrize("jump", [0, 1, 2, 3, 4])
def test_the_interval_between_two_blocks_of_steps_is_looked_at(jump: int) -> None:
    """A jump through the corner, so long that a new block begins with it."""
    places = [(3.5, 0.5)] * (jump + 1) + [(0.5, 3.5)] * (5 - jump)
    found = certificate(AROUND_A_CORNER, DOT, DOT.vertices + np.array(places)[:, None])
    assert not found
    assert found.step == jump


def test_earlier_steps_of_a_block_count_as_travelled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small steps to the wall: those that meet it are shorter than its distance at first."""
    moves = np.linspace(0.0, 1.2, 9)[:, None, None] * [1.0, 0.0]
    room, steps = Mesh.from_loops([2.0 * ring(4, angle=np.pi / 4.0)]), DOT.vertices + 0.5 + moves
    meets = int(np.argmax(0.6 + moves[:, 0, 0] >= np.sqrt(2.0))) - 1
    found = certificate(room, DOT, steps)
    assert not found
    assert found.step == meets
    block = motion._Block(Bodies.of(room, DOT), [room.vertices] * 9, steps)
    monkeypatch.setattr(motion, "CHUNK_PAIRS", 1)  # the pairs of one step at a time
    assert next(block.may_meet())[0] == meets


PRONGS = Mesh.from_loops(
    [np.array([[-3, 0], [3, 0], [3, 5], [0.5, 5], [0.5, 2], [-0.5, 2], [-0.5, 5], [-3, 5]], float)]
)


@pytest.mark.parametrize(
    ("cage", "moves", "place"),
    [
        pytest.param(PRONGS, {3: (-0.7, 0.0), 6: (0.7, 0.0)}, (0.0, 1.0), id="two corners of the cage"),
        *(
            pytest.param(Mesh.from_loops([4.0 * ring(4)]), {0: (-2.0, 0.0)}, (1.7, side * 1.7), id=f"at edge {side}")
            for side in (-1.0, 1.0)
        ),
    ],
)
def test_what_moves_on_either_side_of_a_pair_counts(cage: Mesh, moves: dict[int, Any], place: Any) -> None:
    """Two corners that each go more than half of their distance; an edge of which only the start or the end moves."""
    fine, after = DOT.moved(DOT.vertices + np.array(place)), cage.vertices.copy()
    for corner, move in moves.items():
        after[corner] += move
    assert not verify_motion(cage, fine, np.stack([cage.vertices, after]), np.stack([fine.vertices] * 2))


def test_distances_count_with_the_rounding_of_large_coordinates() -> None:
    """A corner comes to lie on a wall exactly, in one step as long as their distance, far from the origin."""
    random = np.random.default_rng(5)
    for _ in range(40):
        k, j, gap = (int(number) for number in random.integers((8, 1, 1), (400, 7, 40)))
        start = 2.0**10 + random.integers(0, 2**20, 2) * 2.0**-20
        along, across = np.array([3.0, 4.0]) * 2.0**-30, np.array([-4.0, 3.0]) * 2.0**-30
        foot = start + j * (k // 8) * along
        cage = Mesh.from_loops([np.array([start, start + k * along, start + 1e4 * k * across])])
        there = np.array([foot, foot + 2.0 * k * across, foot + 2.0 * k * across - along])
        here = there + np.outer([1.0, 0.0, 0.0], gap * across)
        assert not certificate(cage, Mesh.from_loops([here]), np.stack([here, there]))


def test_predicates_beyond_double_precision_are_exact() -> None:
    """Triples off one line by less than double-double numbers resolve: a - c and b - c are (m, n) u 2^40 and (m, n) v
    2^40 plus the same small vector, and both differences round."""
    random = np.random.default_rng(7)
    points, signs = [], []
    for _ in range(300):
        m, n, u, v = (int(number) | 1 for number in random.integers(2**24, 2**26, 4))
        if gcd(m, n) > 1 or u == v:
            continue
        i = pow(m, -1, n)
        j, t, side = (m * i - 1) // n, int(random.integers(2**12)), int(random.choice([-1, 1]))  # m i - n j = 1
        small = m * t + side * j, n * t + side * i
        points.append([(m * u * 2.0**40, n * u * 2.0**40), (m * v * 2.0**40, n * v * 2.0**40), (-small[0], -small[1])])
        signs.append(side if u > v else -side)
    a, b, c = np.array(points, float).transpose(1, 0, 2)
    assert orientation(a, b, c).tolist() == signs


# Needs


def test_limits_are_kept_to_the_digit() -> None:
    """A distance and an excess that count as kept when they are exceeded by 1 %; a reach that is told 2 % too large."""
    fine, cage = (Mesh.from_loops([size * ring(4)]) for size in (1.0, 1.1))
    distance, excess = 0.1, 0.21  # from corner to corner, and of the areas
    for need, other in ((Within(distance=distance * 1.005), Within(distance=distance * 0.995)),
                        (Within(excess=excess * 1.005), Within(excess=excess * 0.995))):  # fmt: skip
        assert need.is_met(cage, fine)
        assert not other.is_met(cage, fine)
    assert reach(cage, fine) == pytest.approx(distance, rel=2e-4)


def test_a_polygon_that_is_not_convex_is_no_convex_cage(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(convex, "is_convex", lambda mesh: False)
    with pytest.raises(NestingError, match="not convex"):
        nested_cages(star(5, 40), [8], Settings(convex=True))


def test_hulls_that_touch_have_no_convex_cages() -> None:
    squares = [np.array([[x, 0], [x + 1, 0], [x + 1, 1], [x, 1]], float) for x in (0.0, 0.9, 1.0, 1.1)]
    assert [convex._overlap(squares[0], other) for other in squares] == [True, True, True, False]
    assert convex._overlap(4.0 * squares[0], 1.0 + squares[0])
    assert convex._overlap(1.0 + squares[0], 4.0 * squares[0])


def test_every_option_of_the_command_reaches_the_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Settings] = []

    def made(fine: Mesh, levels: Any, settings: Settings, **_: Any) -> Any:
        asked.append(settings)
        raise NestingError("enough")

    monkeypatch.setattr(making, "nested_cages", made)
    path = tmp_path / "in.json"
    path.write_text(to_engine_json(star()))
    numbers = {"clearance": 0.01, "grid": 0.02, "min_edge": 0.03, "min_angle": 40.0}
    words = [f"--{name.replace('_', '-')}={value}" for name, value in numbers.items()]
    for others in (words, ["--symmetry", "5"], ["--convex"]):
        assert main([str(path), "--levels", "8", *others]) == 1
    assert {name: getattr(asked[0], name) for name in numbers} == numbers
    assert asked[1].symmetry == Rotation(None, 5)
    assert asked[2].convex


# What is returned


def test_a_step_that_leaves_the_drawing_is_no_cage(monkeypatch: pytest.MonkeyPatch) -> None:
    """A follower whose last cage lies elsewhere: `followed` certifies what it returns."""
    fine = star()
    cage = nested_cages(fine, [12]).cages[0]
    assert followed(cage, fine, fine, 0.0) is not None
    monkeypatch.setattr(following.Follower, "next", lambda self, cage, before, after: [cage, cage + 3.0])
    assert followed(cage, fine, fine, 0.0) is None


def test_a_key_that_leaves_the_drawing_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cage of each key is certified, whatever follower and motion certificate say."""
    monkeypatch.setattr(following.Follower, "next", lambda self, cage, before, after: [cage + 3.0])
    monkeypatch.setattr(motion_gate, "verify_motion", lambda *_: True)
    with pytest.raises(NestingError, match="The cage of pose 1 could not be certified"):
        animated_cages(star(), [star().vertices] * 2, [12])


def test_a_still_cage_holds_between_the_poses_too() -> None:
    """A jump through the corner, from one place inside to another."""
    poses = DOT.vertices + np.array([(3.5, 0.5), (0.5, 3.5)])[:, None]
    assert drain(certified_still(AROUND_A_CORNER, DOT, poses[[0, 0]]))
    with pytest.raises(NestingError, match="does not hold at pose 1: The drawing crosses it before"):
        drain(certified_still(AROUND_A_CORNER, DOT, poses))


@pytest.mark.parametrize("need", [Within(distance=0.08), Within(excess=0.2)], ids=str)
def test_the_fewest_vertices_keep_the_tolerance(need: Within) -> None:
    level = nested_cages(star(), [need]).levels[0]
    assert need.measured(level.cage, star()) <= need.limit
    assert check(star(), level, distance=need.distance, motions=4)


def test_the_least_number_of_vertices_is_a_lower_bound() -> None:
    """Around a square within a tenth of its side, there are four."""
    level = nested_cages(Mesh.from_loops([ring(4)]), [Within(distance=0.1)]).levels[0]
    assert len(level.cage.vertices) == level.report.fewest == 4


def test_constraints_find_cages_that_miss_them() -> None:
    """By less than a certificate of nesting would see: one corner of a square is off by a rounding or a little more."""
    square = Mesh.from_loops([[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]])
    for constraint, off in ((Symmetric(Rotation((0.0, 0.0), 4)), 1e-12), (Numbers(Grid(0.5), None, 1.0), 1e-15),
                            (Numbers(None, "float32", 1.0), 1e-15)):  # fmt: skip
        assert constraint.fault(square, square) is None
        assert constraint.fault(square.moved(square.vertices + off * np.eye(4, 2)), square) is not None


@dataclass(frozen=True)
class Squeezed(Tightening):
    """A tightening that goes a little below the clearance and notes for which ones it was run."""

    asked: list[float] = field(default_factory=list)

    def run(self, bodies: Any, cage: Any, fine: Any, *, clearance: float, **options: Any) -> Any:
        self.asked.append(clearance)
        return (yield from super().run(bodies, cage, fine, clearance=0.99 * clearance, **options))


def test_a_cage_is_tightened_again_at_each_smaller_clearance() -> None:
    tightening = Squeezed()
    nested_cages(letter_a(), [letter_a_coarse()], Settings(tightening=tightening, fallback=None))
    assert len(set(tightening.asked)) > 1


def test_a_margin_for_stored_numbers_is_there_at_the_first_trial(monkeypatch: pytest.MonkeyPatch) -> None:
    """Far from the origin, rounding would take from the clearance of a level, and of a motion that is read once."""
    fine = star(5, 40).moved((star(5, 40).vertices + 300.0).astype(np.float32).astype(float))
    chosen = Settings(stored=np.float32, clearance=0.01)
    monkeypatch.setattr(Settling, "rooms", property(lambda _: pytest.fail("made a second time")))
    assert check(fine, nested_cages(fine, [8], chosen), 0.01, motions=4)
    poses = (fine.vertices + np.array([0.125 * k, 0.0]) for k in range(3))
    assert check(fine, animated_cages(fine, poses, [8], chosen), 0.01, motions=4)


# How tight and how fast it is


def test_a_start_that_the_flow_entered_is_preferred_by_a_little() -> None:
    builder: Any = SimpleNamespace(unit_fine=SimpleNamespace(area=1.0), plan=SimpleNamespace(side=1))
    unit_coarse = Mesh.from_loops([ring(4)])
    starts: Any = [
        SimpleNamespace(is_measure=False, unit_coarse=unit_coarse, flow=SimpleNamespace(steps=[0] * steps))
        for steps in (1, 2)
    ]
    ranks = [LevelBuilder._rank(builder, start, ring(4)) for start in starts]
    assert ranks == pytest.approx([1.01, 1.0])


@pytest.mark.parametrize(("gain", "growth"), [(1.0, 2.5), (0.4, 1.0)])
def test_radii_grow_after_good_steps(gain: float, growth: float) -> None:
    region = TrustRegion(0.1, 0.1, 1.0, 1.0)
    step, cage = np.full((3, 2), (0.1, 0.0)), np.zeros((3, 2))
    trial = Trial(cage + step, np.ones(3), -gain, accepted=True)
    region.update(QPSolution(step, np.zeros(0), 1.0, 5, True, None), trial, 0.0)  # type: ignore[arg-type]
    assert region.radius == pytest.approx(0.1 * growth)


def test_quadratic_programs_take_few_iterations() -> None:
    taken = [InteriorPoint().solve(random_program(seed)).iterations for seed in range(20)]
    assert np.mean(taken) < MEAN_ITERATIONS
