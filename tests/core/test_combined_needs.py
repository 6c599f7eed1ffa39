"""Needs combine: every pair of them gives a certified cage that keeps both promises, or a code from a written list."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import combinations_with_replacement
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nestedcages_core import (
    FlowResult,
    Level,
    Mesh,
    Mirror,
    NestedCagesError,
    NestingReport,
    Reinflation,
    Rotation,
    Settings,
    Within,
    animated_cages,
    followed,
    inner_cages,
    nested_cages,
    verify,
    verify_motion,
)
from nestedcages_core.errors import CODES
from nestedcages_core.geometry.lattice import Grid
from nestedcages_core.level.steps import with_stored_steps
from nestedcages_core.level.symmetrised_start import orbits_of
from nestedcages_core.needs.convex.need import is_convex
from nestedcages_core.tolerance.reach import reach
from shapes import ring

PAGE = Path(__file__).resolve().parents[2] / "docs" / "needs.md"
CLEARANCE, SPACING, DISTANCE = 0.004, 0.02, 0.15
NEEDS = ("symmetry", "rotation", "grid", "float32", "weights", "convex", "inner", "within", "motion")
STILL = ("symmetry", "rotation", "grid", "float32", "weights")
IMPOSSIBLE = {
    frozenset({"symmetry", "rotation"}): None,  # one setting
    frozenset({"convex", "inner"}): "convex.impossible",
    frozenset({"convex", "motion"}): "setting.conflict",
    frozenset({"inner", "motion"}): None,  # no function for it
    frozenset({"within", "motion"}): "level.invalid",
}
"""Pairs that cannot be made, each with the code that says so."""
PAIRS = [tuple(dict.fromkeys(pair)) for pair in combinations_with_replacement(NEEDS, 2)]
UNLUCKY = {"numbers.no_room", "count.too_small", "clearance.no_room", "tolerance.unreachable"}
"""Codes of shapes that have no such cage, or where none was found."""


def drawn(seed: int, order: int = 2) -> Mesh:
    """A random shape with rotations of an order and a vertical mirror."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 2.0 * np.pi, 60 + 20 * (seed % 3), endpoint=False)
    waves = zip((order, 3 * order, 5 * order), (0.25, 0.08, 0.03), strict=True)
    r = 1.0 + sum(rng.uniform(0.4, 1.0) * size * np.cos(k * t) for k, size in waves)
    return Mesh.from_loops([np.c_[r * np.cos(t), r * np.sin(t)]])


def options(pair: tuple[str, ...], fine: Mesh) -> dict[str, Any]:
    """The settings of some needs."""
    of: Mapping[str, dict[str, Any]] = {
        "symmetry": {"symmetry": Mirror((0.0, 0.0), (0.0, 1.0))},
        "rotation": {"symmetry": Rotation((0.0, 0.0), 4)},
        "grid": {"grid": SPACING},
        "float32": {"stored": np.float32},
        "weights": {"weights": 1.0 + 9.0 * (np.abs(fine.vertices[:, 1]) > 0.6)},
        "convex": {"convex": True},
    }
    return {name: value for need in pair for name, value in of.get(need, {}).items()}


def check_promises(pair: tuple[str, ...], cage: Mesh, fine: Mesh, settings: Settings) -> None:
    """Every promise, judged anew."""
    outer, inner = (fine, cage) if "inner" in pair else (cage, fine)
    assert verify(outer, inner, CLEARANCE, same_loops="convex" not in pair)
    if "grid" in pair:
        lattice = Grid(SPACING)
        exact = lattice.points(lattice.places(cage.vertices))
        held = exact.astype(np.float32) if "float32" in pair else exact
        assert np.array_equal(cage.vertices, held)
    if "float32" in pair:
        assert np.array_equal(cage.vertices, cage.vertices.astype(np.float32))
    if settings.symmetry is not None:
        orbits = orbits_of(cage, settings.symmetry)
        assert orbits is not None
        assert np.abs(orbits.symmetrised(cage.vertices) - cage.vertices).max() <= 2e-7 * ("float32" in pair) + 1e-15
    if "convex" in pair:
        assert is_convex(cage)
    if "within" in pair:
        assert reach(outer, inner) <= DISTANCE * (1.0 + 1e-6)


def made(pair: tuple[str, ...], seed: int) -> str:
    """Makes and checks the cage of some needs; returns the code of the error instead, if there is one."""
    fine = drawn(seed, 4 if "rotation" in pair else 2)
    try:
        settings = Settings(clearance=CLEARANCE, **options(pair, fine))
        wanted = Within(distance=DISTANCE) if "within" in pair else 8 if "convex" in pair else 16
        if "motion" in pair:
            poses = [fine.vertices * scale for scale in (1.0, 1.03, 1.08)]
            (level,) = animated_cages(fine, poses, [wanted], settings).levels
            for at, points in zip(level.fine_steps, level.cage_steps, strict=True):
                check_promises(pair, level.cage.moved(points), fine.moved(at), settings)
            assert verify_motion(level.cage, fine, level.cage_steps, level.fine_steps)
            return ""
        (one,) = (inner_cages if "inner" in pair else nested_cages)(fine, [wanted], settings).levels
    except NestedCagesError as error:
        return error.code
    check_promises(pair, one.cage, fine, settings)
    steps = one.reinflation
    assert verify_motion(one.cage, fine, steps.cage_steps, steps.fine_steps)
    if "float32" in pair:
        inner = (one.flow.steps[1:], steps.moving_steps[:-1], steps.cage_steps, one.coarse.vertices)
        assert all(np.array_equal(points, points.astype(np.float32)) for points in inner)
    return ""


@pytest.mark.parametrize("pair", PAIRS, ids=" and ".join)
def test_a_pair_of_needs_is_kept_or_has_a_code(pair: tuple[str, ...]) -> None:
    if frozenset(pair) in IMPOSSIBLE:
        code = IMPOSSIBLE[frozenset(pair)]
        assert code is None or made(pair, 0) == code
    else:
        assert made(pair, 0) == ""


@pytest.mark.thorough
@pytest.mark.parametrize("first", [0, 10, 20])
@pytest.mark.parametrize("pair", [pair for pair in PAIRS if frozenset(pair) not in IMPOSSIBLE], ids=" and ".join)
def test_a_pair_of_needs_on_thirty_shapes(pair: tuple[str, ...], first: int) -> None:
    codes = [made(pair, seed) for seed in range(first, first + 10)]
    assert set(codes) <= UNLUCKY | {""}
    assert codes.count("") >= 9


@pytest.mark.parametrize(
    "needs",
    [
        ("symmetry", "grid", "inner"),
        ("rotation", "grid", "float32"),
        ("symmetry", "grid", "weights"),
        ("symmetry", "float32", "weights", "inner"),
        ("symmetry", "inner", "within"),
    ],
    ids=" and ".join,
)
def test_more_than_two_needs_are_kept(needs: tuple[str, ...]) -> None:
    assert made(needs, 1) == ""


def test_no_square_grid_has_other_symmetries() -> None:
    fine = drawn(0)
    for symmetry in (Rotation((0.0, 0.0), 3), Mirror((0.0, 0.0), (1.0, 2.0))):
        with pytest.raises(NestedCagesError) as caught:
            nested_cages(fine, [16], Settings(grid=SPACING, symmetry=symmetry))
        assert caught.value.code == "symmetry.off_lattice"


def test_a_mirror_off_the_grid_moves_to_it() -> None:
    fine = drawn(0).moved(drawn(0).vertices + np.array([0.0137, 0.0]))
    settings = Settings(grid=SPACING, symmetry=Mirror((0.0137, 0.0), (0.0, 1.0)), clearance=CLEARANCE)
    (level,) = nested_cages(fine, [16], settings).levels
    assert "note.symmetry" in [note.code for note in level.report.notes]
    orbits = orbits_of(level.cage, Mirror((0.02, 0.0), (0.0, 1.0)))
    assert orbits is not None
    assert np.abs(orbits.symmetrised(level.cage.vertices) - level.cage.vertices).max() < 1e-15


def test_images_do_not_depend_on_what_is_imaged_with_them() -> None:
    points = np.random.default_rng(1).normal(size=(73, 2))
    for symmetry in (Mirror((0.1, 0.2), (1.0, 2.0)), Rotation((0.1, 0.2), 5)):
        together = symmetry.image(points)
        assert all(
            np.array_equal(symmetry.image(point[None])[0], image) for point, image in zip(points, together, strict=True)
        )
        fixed = symmetry.fixed(points)
        assert all(
            np.array_equal(symmetry.fixed(point[None])[0], there) for point, there in zip(points, fixed, strict=True)
        )


def test_weights_count_on_a_grid() -> None:
    fine = drawn(2)
    weights = options(("weights",), fine)["weights"]
    heavy = np.abs(fine.vertices[:, 1]) > 0.6

    def far(level: Any) -> float:
        """Mean distance of the heavy vertices from the cage."""
        ends = level.cage.edge_ends
        along = ends - level.cage.vertices
        to = fine.vertices[heavy][:, None] - level.cage.vertices[None]
        share = np.clip((to * along).sum(axis=2) / (along * along).sum(axis=1), 0.0, 1.0)
        return float(np.linalg.norm(to - share[..., None] * along, axis=2).min(axis=1).mean())

    with_it, without = (
        nested_cages(fine, [14], Settings(grid=0.05, weights=given)).levels[0] for given in (weights, None)
    )
    assert far(with_it) < far(without)


def test_the_page_lists_what_is_impossible() -> None:
    text = PAGE.read_text(encoding="utf-8")
    listed = set(re.findall(r"`((?:symmetry|convex|setting|numbers|level)\.[a-z_]+)`", text))
    assert {code for code in IMPOSSIBLE.values() if code} | {"symmetry.off_lattice"} <= listed <= set(CODES)


def test_steps_that_rounding_spoils_count_as_flow() -> None:
    """In the first two steps the circle is a hair too large for the octagon; from the third step on there is room."""
    circle = [ring(count) for count in (48, 8)]
    sizes = np.cos(np.pi / 8) * np.array([1.0 + 1e-6, 1.0 + 1e-6, 0.9, 0.8, 0.7])
    fine, cage = Mesh.from_loops([sizes[-1] * circle[0]]), Mesh.from_loops([circle[1]])
    moving, cages = circle[0] * sizes[:, None, None], np.repeat(circle[1][None], len(sizes), axis=0)
    report = NestingReport(True, True, 0.1, 0.1, 1.0, "flow", {}, {}, stored="float32")
    flow = FlowResult(np.stack([fine.vertices, moving[0]]), 0, "inside")
    level = with_stored_steps(Level(fine, cage, cage, flow, Reinflation(moving, cages, 0), report))
    assert (len(level.flow.steps), len(level.reinflation.cage_steps)) == (4, 3)
    assert verify_motion(cage, fine, level.reinflation.cage_steps, level.reinflation.fine_steps)
    np.testing.assert_array_equal(level.flow.steps[-1], level.reinflation.fine_steps[0])
    np.testing.assert_array_equal(level.reinflation.fine_steps[-1], fine.vertices)


def test_a_cage_follows_on_the_numbers_that_are_stored() -> None:
    """One step of an edited drawing, far enough from the origin that rounding counts."""
    fine, settings = drawn(0), Settings(stored=np.float32)
    fine = fine.moved(fine.vertices.astype(np.float32).astype(np.float64) + 300.0)
    (level,) = nested_cages(fine, [16], settings).levels
    after = fine.moved(np.round(300.0 + 1.02 * (fine.vertices - 300.0), 4).astype(np.float32).astype(np.float64))
    found = followed(level.cage, fine, after, CLEARANCE, settings)
    assert found is not None and verify(found, after, CLEARANCE)
    assert np.array_equal(found.vertices, found.vertices.astype(np.float32))
