"""Needs together: each pair of them gives a certified cage that keeps both promises, or a code from a written list;
pairs and triples on shapes with the smallest details give a cage that the checker accepts, or a sentence."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import combinations_with_replacement
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from nestedcages_core import (
    BoundaryARAP,
    FlowResult,
    Found,
    InitialDisplacement,
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
    check,
    followed,
    inner_cages,
    nested_cages,
    verify,
    verify_motion,
)
from nestedcages_core.constraints.convex import is_convex
from nestedcages_core.errors import CODES
from nestedcages_core.geometry.group import orbits_of
from nestedcages_core.level.steps import with_stored_steps
from nestedcages_core.tolerance.reach import reach
from support.marks import slow_after
from support.shapes import annulus, islands, letter_a, ring, star

PAGE = Path(__file__).resolve().parents[2] / "docs" / "needs.md"
CLEARANCE, SPACING, DISTANCE = 0.004, 0.02, 0.15
NEEDS = ("symmetry", "rotation", "grid", "float32", "weights", "convex", "merge", "inner", "within", "motion")
IMPOSSIBLE = {
    frozenset({"symmetry", "rotation"}): None,  # one setting
    frozenset({"convex", "inner"}): "convex.impossible",
    frozenset({"convex", "motion"}): "setting.conflict",
    frozenset({"inner", "motion"}): None,  # no function for it
    frozenset({"within", "motion"}): "level.invalid",
    **{
        frozenset({need, "merge"}): "setting.conflict"
        for need in ("symmetry", "rotation", "weights", "convex", "inner")
    },
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
        "merge": {"merge": 0.1},
    }
    return {name: value for need in pair for name, value in of.get(need, {}).items()}


def check_promises(pair: tuple[str, ...], made: Any, cage: Mesh, fine: Mesh, settings: Settings) -> None:
    """Every promise, judged anew by the checker, which reads grid and stored numbers from the levels."""
    loops = False if {"convex", "merge"} & set(pair) else None
    distance = DISTANCE if "within" in pair and "inner" not in pair else None
    verdict = check(fine, made, CLEARANCE, same_loops=loops, inside="inner" in pair, distance=distance, motions=4)
    assert verdict, verdict.problems[:3]
    if settings.symmetry is not None:
        orbits = orbits_of(cage, settings.symmetry)
        assert orbits is not None
        assert np.abs(orbits.symmetrised(cage.vertices) - cage.vertices).max() <= 2e-7 * ("float32" in pair) + 1e-15
    if "convex" in pair:
        assert is_convex(cage)
    if {"within", "inner"} <= set(pair):
        assert reach(fine, cage) <= DISTANCE * (1.0 + 1e-6)


def made(pair: tuple[str, ...], seed: int) -> str:
    """Makes and checks the cage of some needs; returns the code of the error instead, if there is one."""
    fine = drawn(seed, 4 if "rotation" in pair else 2)
    try:
        settings = Settings(clearance=CLEARANCE, **options(pair, fine))
        wanted = Within(distance=DISTANCE) if "within" in pair else 8 if "convex" in pair else 16
        if "motion" in pair:
            poses = [fine.vertices * scale for scale in (1.0, 1.03, 1.08)]
            found = animated_cages(fine, poses, [wanted], settings)
        else:
            found = (inner_cages if "inner" in pair else nested_cages)(fine, [wanted], settings)
    except NestedCagesError as error:
        return error.code
    check_promises(pair, found, found.levels[0].cage, fine, settings)
    if "float32" in pair and "motion" not in pair:
        (one,) = found.levels
        steps = one.reinflation
        inner = (one.flow.steps[1:], steps.moving_steps[:-1], steps.cage_steps, one.coarse.vertices)
        assert all(np.array_equal(points, points.astype(np.float32)) for points in inner)
    return ""


@pytest.mark.parametrize(
    "pair", slow_after(7, [(pair,) for pair in sorted(PAIRS, key=len)], thorough_after=24), ids=" and ".join
)
def test_a_pair_of_needs_is_kept_or_has_a_code(pair: tuple[str, ...]) -> None:
    assert (code := IMPOSSIBLE.get(frozenset(pair), "")) is None or made(pair, 0) == code


def hull_is_near(fine: Mesh) -> bool:
    """Whether the points of a drawing's convex hull are near it: where some are not, no convex cage is."""
    drawing = shapely.Polygon(fine.vertices)
    return bool(shapely.hausdorff_distance(drawing.convex_hull, drawing, densify=0.01) <= DISTANCE)


@pytest.mark.thorough
@pytest.mark.timeout(900)
@pytest.mark.parametrize("pair", [pair for pair in PAIRS if frozenset(pair) not in IMPOSSIBLE], ids=" and ".join)
def test_a_pair_of_needs_on_thirty_shapes(pair: tuple[str, ...]) -> None:
    codes = [made(pair, seed) for seed in range(30) if set(pair) != {"convex", "within"} or hull_is_near(drawn(seed))]
    assert set(codes) <= UNLUCKY | {""}
    assert codes.count("") >= 0.9 * len(codes) > 20


@pytest.mark.slow
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
    listed = set(re.findall(r"`((?:symmetry|convex|setting|numbers|level)\.[a-z_]+)`", text)) - {"level.tradeoff"}
    assert {code for code in IMPOSSIBLE.values() if code} | {"symmetry.off_lattice"} <= listed <= set(CODES)


def test_steps_that_rounding_spoils_count_as_flow() -> None:
    """In the first two steps the circle is a hair too large for the octagon; from the third step on there is room."""
    circle = [ring(48), ring(8).astype(np.float32).astype(np.float64)]
    sizes = np.cos(np.pi / 8) * np.array([1.0 + 1e-6, 1.0 + 1e-6, 0.9, 0.8, 0.7])
    fine, cage = Mesh.from_loops([sizes[-1] * circle[0]]), Mesh.from_loops([circle[1]])
    moving, cages = circle[0] * sizes[:, None, None], np.repeat(circle[1][None], len(sizes), axis=0)
    report = NestingReport(True, True, 0.1, 0.1, 1.0, "flow", {}, {})
    flow = FlowResult(np.stack([fine.vertices, moving[0]]), 0, "inside")
    level = with_stored_steps(Level(fine, cage, cage, flow, Reinflation(moving, cages, 0), report), "float32")
    assert level.report.stored == "float32"
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


FEW, MANY = 12, 1500
"""Examples in every run of the tests, and in the thorough ones."""

SHAPES = [star(5, 30), annulus(24), letter_a(), islands(), Mesh.from_loops([ring(12) * [2.0, 1.0]])]

WISHES: dict[str, st.SearchStrategy[Any]] = {
    "clearance": st.sampled_from([0.0, 1e-9, 1e-3, 0.05]),
    "grid": st.sampled_from([1e-9, 0.01, 0.1, 0.3]),
    "symmetry": st.sampled_from([Mirror(None), Mirror((0.0, 0.0), (1.0, 0.2)), Rotation(None, 2), Found()]),
    "convex": st.just(True),
    "merge": st.sampled_from([1e-9, 0.1, 1.0, inf]),
    "min_edge": st.sampled_from([1e-6, 0.1, 1.0]),
    "min_angle": st.sampled_from([5.0, 40.0]),
    "pins": st.lists(st.integers(0, 11), min_size=1, max_size=3, unique=True),
    "joints": st.just([(0.0, 0.5)]),
    "weights": st.sampled_from([0.0, 1.0, 1e6]),
    "energy": st.sampled_from([InitialDisplacement(), BoundaryARAP()]),
}
"""Settings, each with values from the smallest to the largest that make sense."""


@st.composite
def shapes(draw: st.DrawFn) -> Mesh:
    """A shape whose loops begin anywhere, if wanted with an edge or a hole of any small size."""
    fine = draw(st.sampled_from(SHAPES))
    loops = [np.roll(loop, draw(st.integers(0, 9)), axis=0) for loop in fine.rings]
    size = 10.0 ** draw(st.sampled_from([-3, -12, -40, -51, -170, -300]))
    detail = draw(st.sampled_from(["none", "edge", "hole"]))
    if detail == "edge":  # at the origin, where numbers are dense enough
        loops = [loop - loops[0][0] for loop in loops]
        loops[0] = np.insert(loops[0], 1, size * np.array([0.6, 0.8]), axis=0)
    elif detail == "hole" and len(loops) == 1:
        loops.append(size * ring(draw(st.integers(3, 12))))
    try:
        return Mesh.from_loops(loops)
    except NestedCagesError:  # the detail crosses something
        return fine


@st.composite
def wishes(draw: st.DrawFn) -> tuple[Mesh, dict[str, Any], Any, bool]:
    fine = draw(shapes())
    names = draw(st.lists(st.sampled_from(sorted(WISHES)), min_size=2, max_size=3, unique=True))
    wanted = {name: draw(WISHES[name]) for name in names}
    if "weights" in wanted:
        wanted["weights"] = np.full(len(fine.vertices), 1.0) + wanted["weights"] * (np.arange(len(fine.vertices)) < 5)
    level = draw(st.sampled_from([6, 12, 20, Within(distance=0.3), Within(excess=0.5)]))
    return fine, wanted, level, draw(st.booleans())


def fulfilled(fine: Mesh, wanted: dict[str, Any], level: Any, inside: bool) -> bool:
    """Whether there is a cage, which then is checked; raises whatever is not a NestedCagesError with a sentence."""
    try:
        made = (inner_cages if inside else nested_cages)(fine, [level], Settings(**wanted))
    except NestedCagesError as error:
        assert str(error).strip()
        assert "energy" not in str(error) or "energy" in wanted, error
        return False
    symmetry, distance = wanted.get("symmetry"), getattr(level, "distance", None)
    loops = False if {"convex", "merge"} & set(wanted) else None
    verdict = check(
        fine,
        made,
        wanted.get("clearance"),
        same_loops=loops,
        grid=wanted.get("grid"),
        symmetry=None if isinstance(symmetry, Found) else symmetry,
        distance=distance,
        motions=4,
    )
    assert verdict, (wanted, level, inside, verdict.problems[:3])
    return True


@pytest.mark.parametrize(
    "amount",
    [pytest.param(FEW, id="few", marks=pytest.mark.slow), pytest.param(MANY, id="many", marks=pytest.mark.thorough)],
)
def test_needs_together(amount: int) -> None:
    found = []

    @settings(max_examples=amount, deadline=None, suppress_health_check=list(HealthCheck))
    @given(wishes())
    def one(drawn: Any) -> None:
        found.append(fulfilled(*drawn))

    one()
    assert sum(found) > amount // 4


def with_edge(size: float) -> Mesh:
    return Mesh.from_loops([[(0.0, 0.0), (size, 0.0), (2.0, -1.0), (3.0, 2.0), (1.0, 3.0), (-1.0, 1.5)]])


@pytest.mark.parametrize(
    ("fine", "wanted", "level", "inside"),
    [
        (with_edge(1e-170), {"pins": [0]}, 5, False),
        (with_edge(1e-300), {"pins": [1], "clearance": 0.0}, 5, False),
        (with_edge(1e-170), {"symmetry": Mirror(None)}, 6, False),
        (Mesh.from_loops([ring(16), 1e-40 * ring(16)]), {}, 12, False),
        (Mesh.from_loops([ring(16), 1e-51 * ring(12)]), {}, 12, True),
        (letter_a(1), {"symmetry": Mirror(None), "pins": [20]}, 6, True),  # some starts are not symmetric
    ],
)
def test_details_and_starts_that_once_led_to_faults(
    fine: Mesh, wanted: dict[str, Any], level: int, inside: bool
) -> None:
    fulfilled(fine, wanted, level, inside)
