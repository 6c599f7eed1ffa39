"""The certificate of an animation against samples of it, and against animations that are known to be bad."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest

from nestedcages_core import Mesh, NestedCagesError, verify_motion
from nestedcages_core.checker import touches, whole_numbers
from nestedcages_core.verification import motion
from nestedcages_core.verification.motion import COEFFICIENT_ROUNDING, UNDERFLOW, _bernstein, never_meet
from support.shapes import ring


@pytest.mark.parametrize(("scale", "shift"), [(1.0, 0.0), (0.1, 100.1), (2.0**-538, 0.0)])
def test_pairs_are_certified_only_where_exact_arithmetic_finds_no_contact(scale: float, shift: float) -> None:
    """Points and edges that move between points of a small lattice, where contacts are common: as they are, rounded,
    and so small that products leave the range of normal numbers."""
    lattice = scale * np.random.default_rng(1).integers(-4, 5, (2, 3, 2, 1200)) + shift
    before, after = whole_numbers(lattice)[0]
    meets = np.array([exactly_meet(before[:, :, k], after[:, :, k]) for k in range(before.shape[2])])
    free = never_meet(*lattice)
    assert 120 < meets.sum() < 1080
    assert not (free & meets).any()
    if scale == 1.0:
        assert np.array_equal(free, ~meets)
        assert [bool(never_meet(*lattice[..., k : k + 1])[0]) for k in range(100)] == free[:100].tolist()


@pytest.mark.parametrize("cross", [True, False])
def test_errors_of_coefficients_are_those_of_the_worst_rounding(cross: bool) -> None:
    random = np.random.default_rng(4)
    u0, u1, w0, w1 = random.normal(size=(4, 2, 50))
    margin, nothing = random.uniform(0.1, 1.0, 50), np.zeros(50)

    def product(u: np.ndarray, w: np.ndarray) -> np.ndarray:
        return u[0] * w[1] - u[1] * w[0] if cross else u[0] * w[0] + u[1] * w[1]

    values, errors = _bernstein(u0, u1, w0, w1, nothing, cross=cross)
    np.testing.assert_allclose(values, [product(u0, w0), (product(u0, w1) + product(u1, w0)) / 2, product(u1, w1)])
    sizes = abs(u0[0] * w0[1 if cross else 0]) + abs(u0[1] * w0[0 if cross else 1])
    np.testing.assert_allclose(errors[0], COEFFICIENT_ROUNDING * sizes)
    assert (_bernstein(*4 * [np.zeros((2, 50))], nothing, cross=cross)[1] == UNDERFLOW).all()
    # where nothing moves, and signs agree, the bound is reached; where one end is larger, that end counts
    u0, w0 = abs(u0), abs(w0) * ([[-1.0], [1.0]] if cross else 1.0)
    values, errors = _bernstein(u0, u0, w0, w0, margin, cross=cross)
    shifts = [np.array(signs)[:, None] * margin for signs in itertools.product((-1.0, 1.0), repeat=4)]
    worst = np.max([abs(product(u0 + shift[:2], w0 + shift[2:]) - values) for shift in shifts], axis=0)
    np.testing.assert_allclose(errors, worst)
    for larger in ((2.0 * u0, u0, w0, w0), (u0, 2.0 * u0, w0, w0), (u0, u0, 2.0 * w0, w0), (u0, u0, w0, 2.0 * w0)):
        assert (_bernstein(*larger, margin, cross=cross)[1] > 1.01 * errors).all()


def exactly_meet(before: np.ndarray, after: np.ndarray) -> bool:
    """Whether a point and an edge, (3, 2) whole numbers before and after, meet in linear motion."""
    u, v = ([place[0] - place[k] for place in (before, after)] for k in (1, 2))
    products = [
        [int(f(u[0], v[0])), int(f(u[0], v[1]) + f(u[1], v[0])), int(f(u[1], v[1]))]
        for f in (lambda p, q: p[0] * q[1] - p[1] * q[0], np.dot)
    ]
    return touches(*products)


def test_an_edge_that_turns_around_through_a_point_meets_nothing_far_away() -> None:
    """A fine edge shrinks to a point in the middle of the way and comes out reversed."""
    fine = Mesh.from_loops([np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)])
    after = fine.vertices.copy()
    after[[0, 1]] = after[[1, 0]]
    fine_steps = np.stack([fine.vertices, after])
    for half, free in ((0.6, True), (0.5, False)):
        cage = Mesh.from_loops([0.5 + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], float)])
        assert bool(verify_motion(cage, fine, np.stack([cage.vertices, cage.vertices]), fine_steps)) == free


def test_contact_in_passing_is_never_certified() -> None:
    """A point runs through the start of an edge while the edge points along its path: c(s) touches zero at s = 2^-k.

    Exact contact, by differences of doubles that round: relative error bounds alone certify half of these.
    """
    random = np.random.default_rng(1)
    count, before, after = 2000, [], []
    for _ in range(count):
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
        before += [p0, a0, a0 + along - turning / parts]
        after += [p1, a1, a1 + along + turning * (1 - 1 / parts)]
    assert not never_meet(*(np.array(x).reshape(count, 3, 2).transpose(1, 2, 0) for x in (before, after))).any()


def test_crossings_are_told_after_few_halvings(monkeypatch: pytest.MonkeyPatch) -> None:
    """A point that runs straight through an edge that turns, at 200 places of it and angles."""
    random, calls = np.random.default_rng(2), []
    angle, turn, at = random.uniform(0.0, 6.0, 200), random.uniform(-1.0, 1.0, 200), random.uniform(-0.4, 0.4, 200)

    def placed(s: float, beside: float) -> np.ndarray:
        along = np.stack([np.cos(angle + turn * s), np.sin(angle + turn * s)])
        still = np.stack([np.cos(angle), np.sin(angle)])
        point = at * still + beside * np.stack([-still[1], still[0]])
        return np.stack([point, -along, along])

    def counted(*arguments: np.ndarray, **options: bool) -> tuple[np.ndarray, np.ndarray]:
        calls.append(1)
        return bernstein(*arguments, **options)

    bernstein = motion._bernstein
    monkeypatch.setattr(motion, "_bernstein", counted)
    assert not never_meet(placed(-0.5, -0.5), placed(0.5, 0.5)).any()
    assert len(calls) < 60


def test_bad_steps_are_rejected() -> None:
    cage, fine = Mesh.from_loops([ring(8, 2.0)]), Mesh.from_loops([ring(6)])
    still, standing = np.stack([cage.vertices] * 2), np.stack([fine.vertices] * 2)
    assert verify_motion(cage, fine, still, standing)
    assert verify_motion([cage.vertices], fine.__geo_interface__, still, standing)
    broken = standing.copy()
    broken[1, 4, 0] = np.nan
    for steps, sentence in (
        ((still, broken), "Vertex 4 of fine step 1 is not finite"),
        ((still[:, 1:], standing), r"cage steps have shape \(2, 7, 2\)"),
        ((still, standing[0]), r"fine steps have shape \(6, 2\)"),
        ((still, standing[:1]), "2 steps of the cage, but 1 of the fine mesh"),
        ((still, "none"), "fine steps have shape"),
    ):
        with pytest.raises(NestedCagesError, match=sentence):
            verify_motion(cage, fine, *steps)  # type: ignore[arg-type]
