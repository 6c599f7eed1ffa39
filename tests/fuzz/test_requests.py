"""Random shapes with random settings: a cage that the checker accepts and that keeps what was asked, or a code."""

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import nestedcages_core as core
from nestedcages_core import (
    Box,
    DetectSymmetry,
    Mesh,
    Mirror,
    NestedCagesError,
    Rotation,
    Settings,
    Within,
    nested_cages,
)
from support.families import drawing
from support.judging import is_convex, is_on_grid, lengths_of, lies_within, sharpest
from support.shapes import annulus, islands, letter_a, ring, star

pytestmark = [pytest.mark.thorough, pytest.mark.timeout(900)]

NO_CAGE = {"unknown", "solver.not_finite", "constraint.failed"}
"""Codes that no request of these may end in."""
SHAPES = [star(5, 30), annulus(24), letter_a(), islands(), Mesh.from_loops([ring(12) * [2.0, 1.0]])]
WISHES: dict[str, st.SearchStrategy[Any]] = {
    "clearance": st.sampled_from([0.0, 1e-9, 1e-3, 0.05]),
    "grid": st.sampled_from([1e-9, 0.01, 0.1, 0.3]),
    "symmetry": st.sampled_from([Mirror(None), Mirror((0.0, 0.0), (1.0, 0.2)), Rotation(None, 2), DetectSymmetry()]),
    "convex": st.just(True),
    "min_edge": st.sampled_from([1e-6, 0.1, 1.0]),
    "min_angle": st.sampled_from([5.0, 40.0]),
    "pins": st.lists(st.integers(0, 11), min_size=1, max_size=3, unique=True),
    "joints": st.just([(0.0, 0.5)]),
    "weights": st.sampled_from([0.0, 1.0, 1e6]),
    "energy": st.sampled_from([core.InitialDisplacement(), core.BoundaryARAP()]),
    "loops": st.sampled_from(["auto", "keep", "one"]),
    "stored": st.just("float32"),
    "constraints": st.sampled_from([[Box((-9.0, -9.0), (9.0, 9.0))], [core.LeastEdge(0.01, must=False)]]),
}
"""Settings, each with values from the smallest to the largest that make sense."""


def drawing_of_size_1(seed: int) -> Mesh:
    fine = drawing(seed)
    return Mesh((fine.vertices - fine.vertices.mean(axis=0)) / fine.diagonal, fine.edges)


@st.composite
def shapes(draw: st.DrawFn) -> Mesh:
    """A shape whose loops begin anywhere, if wanted with an edge or a hole of any small size."""
    fine = draw(st.sampled_from(SHAPES) | st.builds(drawing_of_size_1, st.integers(1000, 1200)))
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
def requests(draw: st.DrawFn) -> tuple[Mesh, dict[str, Any], Any, bool]:
    fine = draw(shapes())
    names = draw(st.lists(st.sampled_from(sorted(WISHES)), min_size=1, max_size=3, unique=True))
    wanted = {name: draw(WISHES[name]) for name in names}
    if "weights" in wanted:
        wanted["weights"] = np.full(len(fine.vertices), 1.0) + wanted["weights"] * (np.arange(len(fine.vertices)) < 5)
    level = draw(st.sampled_from([6, 12, 20, Within(distance=0.3), Within(excess=0.5)]))
    return fine, wanted, level, draw(st.booleans())


def fulfilled(fine: Mesh, wanted: dict[str, Any], count: Any, inside: bool = False) -> bool:
    """Whether there is a cage, which then is judged; raises whatever is not a NestedCagesError with a code."""
    try:
        level = (core.inner_cages if inside else nested_cages)(fine, [count], Settings(**wanted))[0]
    except NestedCagesError as error:
        assert error.code not in NO_CAGE and str(error).strip(), (wanted, count, inside, error)
        return False
    cage, symmetry, distance = level.cage, wanted.get("symmetry"), getattr(count, "distance", None)
    loops = False if {"convex", "loops"} & set(wanted) else None
    placed = None if isinstance(symmetry, DetectSymmetry) or "stored" in wanted else symmetry  # exact on doubles alone
    verdict = core.check(fine, level, wanted.get("clearance"), same_loops=loops, grid=wanted.get("grid"),
                         symmetry=placed, distance=None if inside else distance, motions=4)  # fmt: skip
    assert verdict, (wanted, count, inside, verdict.problems[:3])
    assert not isinstance(count, int) or len(cage.vertices) <= count or "symmetry" in wanted or "convex" in wanted
    if wanted.get("grid", 0.0) > 1e-6 and "stored" not in wanted:
        assert is_on_grid(cage, wanted["grid"])
    assert not wanted.get("convex") or is_convex(cage)
    stored = wanted.get("stored")
    assert stored is None or np.array_equal(cage.vertices, cage.vertices.astype(stored))
    assert getattr(count, "excess", None) is None or abs(level.excess) <= count.excess
    if distance is not None:
        assert lies_within(*((fine, cage) if inside else (cage, fine)), distance)
    notes = {note.code for note in level.report.notes}
    if lengths_of(fine).min() < 1e-9 * fine.diagonal:  # wishes about details below round-off are not judged
        return True
    if "min_edge" in wanted and "note.edge" not in notes:
        assert lengths_of(cage).min() >= wanted["min_edge"] * (1.0 - (1e-6 if stored else 1e-12))
    if "min_angle" in wanted and "note.angle" not in notes:
        assert sharpest(cage) >= wanted["min_angle"] * (1.0 - (1e-6 if stored else 1e-12))
    return True


def test_settings_on_drawings_and_on_shapes_with_the_smallest_details() -> None:
    found = []

    @settings(max_examples=800, deadline=None, suppress_health_check=list(HealthCheck))
    @given(requests())
    def one(drawn: Any) -> None:
        found.append(fulfilled(*drawn))

    one()
    assert sum(found) > len(found) // 4
