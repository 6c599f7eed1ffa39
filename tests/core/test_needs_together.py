"""Pairs and triples of needs on shapes with the smallest details: certified and checked, or one sentence."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from nestedcages_core import (
    BoundaryARAP,
    Found,
    InitialDisplacement,
    Mesh,
    Mirror,
    NestedCagesError,
    Rotation,
    Settings,
    Within,
    check,
    inner_cages,
    nested_cages,
)
from shapes import annulus, islands, letter_a, ring, star

FEW, MANY = 12, 1500
"""Examples in every run of the tests, and in the thorough ones."""

SHAPES = [star(5, 30), annulus(24), letter_a(), islands(), Mesh.from_loops([ring(12) * [2.0, 1.0]])]

NEEDS: dict[str, st.SearchStrategy[Any]] = {
    "clearance": st.sampled_from([0.0, 1e-9, 1e-3, 0.05]),
    "grid": st.sampled_from([1e-9, 0.01, 0.1, 0.3]),
    "symmetry": st.sampled_from([Mirror(None), Mirror((0.0, 0.0), (1.0, 0.2)), Rotation(None, 2), Found()]),
    "convex": st.just(True),
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
    names = draw(st.lists(st.sampled_from(sorted(NEEDS)), min_size=2, max_size=3, unique=True))
    wanted = {name: draw(NEEDS[name]) for name in names}
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
    loops = False if wanted.get("convex") else None
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
    ],
)
def test_details_that_once_were_too_small(fine: Mesh, wanted: dict[str, Any], level: int, inside: bool) -> None:
    fulfilled(fine, wanted, level, inside)
