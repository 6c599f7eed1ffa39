"""Settings together: each pair gives a certified cage that keeps both promises, or a code from a written list."""

from collections.abc import Mapping
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Mesh, Mirror, NestedCagesError, Rotation, Settings, check, inner_cages, nested_cages
from support.judging import codes, is_convex, is_symmetric, lies_within, note, rejected
from support.marks import slow_after
from support.shapes import letter_a, polygon, ring, turned

CLEARANCE, SPACING, DISTANCE = 0.004, 0.02, 0.15
NEEDS = ("symmetry", "rotation", "grid", "float32", "weights", "convex", "one", "inner", "within", "motion")
IMPOSSIBLE = {
    frozenset({"symmetry", "rotation"}): None,  # one setting
    frozenset({"convex", "inner"}): "convex.impossible",
    frozenset({"convex", "motion"}): "setting.conflict",
    frozenset({"inner", "motion"}): None,  # no function for it
    frozenset({"within", "motion"}): "level.invalid",
    **{frozenset({need, "one"}): "setting.conflict" for need in ("symmetry", "rotation", "weights", "convex", "inner")},
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
        "one": {"loops": "one"},
    }
    return {name: value for need in pair for name, value in of.get(need, {}).items()}


def assert_kept(pair: tuple[str, ...], made: Any, cage: Mesh, fine: Mesh, symmetry: Any) -> None:
    """Every promise, judged anew by the checker, which reads grid and stored numbers from the levels."""
    loops = False if {"convex", "one"} & set(pair) else None
    distance = DISTANCE if "within" in pair and "inner" not in pair else None
    verdict = check(fine, made, CLEARANCE, same_loops=loops, inside="inner" in pair, distance=distance, motions=4)
    assert verdict, verdict.problems[:3]
    if symmetry is not None and "float32" not in pair:
        assert is_symmetric(cage.vertices, symmetry)
    if symmetry is not None:
        off = np.abs(symmetry.image(cage.vertices)[:, None] - cage.vertices).max(axis=2).min(axis=1)
        assert off.max() <= 2e-7 * ("float32" in pair) + 1e-15
    assert "convex" not in pair or is_convex(cage)
    if {"within", "inner"} <= set(pair):
        assert lies_within(fine, cage, DISTANCE)


def made(pair: tuple[str, ...], seed: int) -> str:
    """Makes and checks the cage of some needs; returns the code of the error instead, if there is one."""
    fine = drawn(seed, 4 if "rotation" in pair else 2)
    try:
        settings = Settings(clearance=CLEARANCE, **options(pair, fine))
        wanted = core.Within(distance=DISTANCE) if "within" in pair else 8 if "convex" in pair else 16
        if "motion" in pair:
            poses = [fine.vertices * scale for scale in (1.0, 1.03, 1.08)]
            found: Any = core.animated_cages(fine, poses, [wanted], settings)
        else:
            found = (inner_cages if "inner" in pair else nested_cages)(fine, [wanted], settings)
    except NestedCagesError as error:
        return error.code
    assert_kept(pair, found, found.levels[0].cage, fine, settings.symmetry)
    if "float32" in pair and "motion" not in pair:
        (one,) = found.levels
        steps = one.reinflation
        moving = [step for step in steps.fine_steps if not np.array_equal(step, fine.vertices)]
        inner = (one.flow.steps[1:], steps.cage_steps, one.coarse.vertices, *moving)
        assert all(np.array_equal(points, points.astype(np.float32)) for points in inner)
    return ""


@pytest.mark.parametrize(
    "pair", slow_after(5, [(pair,) for pair in sorted(PAIRS, key=len)], thorough_after=26), ids=" and ".join
)
def test_a_pair_of_needs_is_kept_or_has_a_code(pair: tuple[str, ...]) -> None:
    assert (code := IMPOSSIBLE.get(frozenset(pair), "")) is None or made(pair, 0) == code


def hull_is_near(fine: Mesh) -> bool:
    """Whether the points of a drawing's convex hull are near it: where some are not, no convex cage is."""
    drawing = polygon(fine)
    return bool(shapely.hausdorff_distance(drawing.convex_hull, drawing, densify=0.01) <= DISTANCE)


@pytest.mark.thorough
@pytest.mark.timeout(900)
@pytest.mark.parametrize("pair", [pair for pair in PAIRS if frozenset(pair) not in IMPOSSIBLE], ids=" and ".join)
def test_a_pair_of_needs_on_thirty_shapes(pair: tuple[str, ...]) -> None:
    found = [made(pair, seed) for seed in range(30) if set(pair) != {"convex", "within"} or hull_is_near(drawn(seed))]
    assert set(found) <= UNLUCKY | {""}
    assert found.count("") >= 0.9 * len(found) > 20


TOGETHER = ["symmetry grid inner", "rotation grid float32", "symmetry grid weights", "symmetry float32 weights inner"]


@pytest.mark.slow
@pytest.mark.parametrize("needs", [*TOGETHER, "symmetry inner within"])
def test_more_than_two_needs_are_kept(needs: str) -> None:
    assert made(tuple(needs.split()), 1) == ""


@pytest.mark.parametrize("seed", range(6))
def test_a_box_around_a_slanted_mirror_has_no_more_vertices_than_asked_for(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.0, np.pi)
    half = np.stack([np.sort(rng.uniform(-1.0, 1.0, 4)), rng.uniform(0.1, 1.0, 4)], axis=1)
    shape = turned(np.concatenate([half, half[::-1] * (1.0, -1.0)]), angle)
    box = core.Box(tuple(shape.min(axis=0) - 0.01), tuple(shape.max(axis=0) + 0.01))
    mirror = Mirror((0.0, 0.0), (np.cos(angle), np.sin(angle)))
    for count in (4, 6, 8):
        try:
            level = nested_cages(shape, count, constraints=[box], symmetry=mirror, steps=False)[0]
        except NestedCagesError as error:
            assert error.code == "box.left" and count < 8  # the box is not symmetric itself
        else:
            assert len(level.vertices) <= count and is_symmetric(level.vertices, mirror)


def test_no_square_grid_has_other_symmetries() -> None:
    for symmetry in (Rotation((0.0, 0.0), 3), Mirror((0.0, 0.0), (1.0, 2.0))):
        with rejected("symmetry.off_lattice"):
            nested_cages(drawn(0), 16, grid=SPACING, symmetry=symmetry)


def test_a_mirror_off_the_grid_moves_to_it() -> None:
    fine = Mesh(drawn(0).vertices + np.array([0.0137, 0.0]), drawn(0).edges)
    mirror = Mirror((0.0137, 0.0), (0.0, 1.0))
    level = nested_cages(fine, 16, grid=SPACING, symmetry=mirror, clearance=CLEARANCE)[0]
    moved = note(level, "note.symmetry").data
    assert moved["on"] == "grid" and moved["difference"] == pytest.approx(0.0063, rel=1e-6)
    image = level.cage.vertices * (-1.0, 1.0) + (0.04, 0.0)
    assert np.abs(image[:, None] - level.cage.vertices).max(axis=2).min(axis=1).max() < 1e-15


def test_weights_count_on_a_grid() -> None:
    fine = drawn(2)
    weights = options(("weights",), fine)["weights"]
    heavy = shapely.points(fine.vertices[np.abs(fine.vertices[:, 1]) > 0.6])
    with_it, without = (nested_cages(fine, 14, grid=0.05, weights=given)[0] for given in (weights, None))
    far = [shapely.distance(polygon(level.cage).boundary, heavy).mean() for level in (with_it, without)]
    assert far[0] < far[1]


def test_a_cage_follows_on_the_numbers_that_are_stored() -> None:
    """One step of an edited drawing, far enough from the origin that rounding counts."""

    def stored(points: np.ndarray) -> np.ndarray:
        return np.asarray(points.astype(np.float32), float)

    settings = Settings(stored=np.float32)
    fine = Mesh(stored(drawn(0).vertices) + 300.0, drawn(0).edges)
    fine = Mesh(stored(fine.vertices), fine.edges)
    level = nested_cages(fine, 16, settings)[0]
    after = Mesh(stored(np.round(300.0 + 1.02 * (fine.vertices - 300.0), 4)), fine.edges)
    found = core.followed(level.cage, fine, after, CLEARANCE, settings)
    assert found is not None and core.verify(found, after, CLEARANCE)
    assert np.array_equal(found.vertices, stored(found.vertices))


def with_edge(size: float) -> Mesh:
    return Mesh.from_loops([[(0.0, 0.0), (size, 0.0), (2.0, -1.0), (3.0, 2.0), (1.0, 3.0), (-1.0, 1.5)]])


@pytest.mark.parametrize(
    ("fine", "wanted", "count", "inside"),
    [
        (with_edge(1e-170), {"pins": [0]}, 5, False),
        (with_edge(1e-300), {"pins": [1], "clearance": 0.0}, 5, False),
        (with_edge(1e-170), {"symmetry": Mirror(None)}, 6, False),
        (Mesh.from_loops([ring(16), 1e-40 * ring(16)]), {}, 12, False),
        (Mesh.from_loops([ring(16), 1e-51 * ring(12)]), {}, 12, True),
        (letter_a(1), {"symmetry": Mirror(None), "pins": [20]}, 6, True),  # some starts are not symmetric
    ],
)
def test_details_that_are_nearly_nothing_lead_to_a_cage_or_an_error(
    fine: Mesh, wanted: dict[str, Any], count: int, inside: bool
) -> None:
    try:
        level = (inner_cages if inside else nested_cages)(fine, count, **wanted)[0]
    except NestedCagesError as error:
        assert error.code not in {"unknown", "solver.not_finite", "constraint.failed"}
    else:
        assert len(level.cage.vertices) <= count and check(fine, level, motions=4)
        assert all(code.startswith("note.") for code in codes(level))
