"""Every reader against attacks that are known and documents that are nearly right: a result or one sentence, in bounded
time and memory."""

from __future__ import annotations

import contextlib
import io
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from benchmarks.hostile import grammars
from benchmarks.hostile.attacks import ATTACKS
from benchmarks.hostile.outcome import outcome
from benchmarks.hostile.readers import READERS
from nestedcages_core import (
    ArcLength,
    Mesh,
    OnCurve,
    OuterHull,
    Settings,
    nested_cages,
)
from nestedcages_core.checker import Loops
from nestedcages_core.command import main
from nestedcages_core.published.gurditta_jacobson_2022 import PaperFlow, SignedDistanceFlow
from support.marks import slowly
from support.shapes import letter_a, letter_a_coarse

FAST, FEW, MANY = 2, 12, 3000
"""Examples of each grammar in fast, slow and thorough tests."""

SEED = 20_260_101
"""Of the thorough ones."""

JUDGED_VERTICES = 300
"""Vertices of the largest mesh that the checker looks at here."""


def check_mesh(mesh: Mesh) -> None:
    """What a reader returns has closed loops that neither cross nor touch, says the checker."""
    assert isinstance(mesh, Mesh)
    if len(mesh.vertices) <= JUDGED_VERTICES:
        assert not Loops(mesh).contacts()


def check_features(features: Any) -> None:
    for feature in features:
        check_mesh(feature.mesh)


def check_picture(picture: np.ndarray) -> None:
    assert picture.ndim == 3
    assert picture.shape[2] == 4


def check_result(result: Any) -> None:
    """What a reader returns."""
    if isinstance(result, np.ndarray):
        check_picture(result)
    elif isinstance(result, list):
        check_features(result)
    else:
        check_mesh(result)


THOROUGH = pytest.mark.thorough
AMOUNTS = [FAST, *slowly(FEW), pytest.param(MANY, marks=[THOROUGH, pytest.mark.timeout(1800)])]


def try_many(check: Callable[[Any], None], strategy: st.SearchStrategy[Any], amount: int) -> None:
    """Run a check on so many examples."""
    quiet = settings(
        max_examples=amount, deadline=None, database=None, suppress_health_check=list(HealthCheck), derandomize=False
    )
    seed(SEED)(quiet(given(strategy)(check)))()


# Names in warnings may be half characters, which pytest cannot send from a worker.
@pytest.mark.filterwarnings("ignore::nestedcages_core.errors.NestedCagesWarning")
@pytest.mark.parametrize("amount", AMOUNTS)
@pytest.mark.parametrize("name", READERS)
def test_documents_that_are_nearly_right(name: str, amount: int) -> None:
    strategy, read = READERS[name]

    def check(document: Any) -> None:
        found = outcome(lambda: read(document))
        assert not found.fault, found.fault
        if not found.told:
            check_result(found.result)

    try_many(check, strategy, amount)


DECIMATIONS = [OuterHull(), OnCurve(), ArcLength()]


@pytest.mark.parametrize("amount", AMOUNTS)
def test_cages_around_extreme_loops(amount: int) -> None:
    """Every decimation, from coordinates at the limits of float64: certified, as the checker sees, or
    refused."""

    def check(drawn: tuple[Any, int, Any]) -> None:
        loops, more, decimation = drawn
        mesh = outcome(lambda: Mesh.from_loops(loops)).result
        if mesh is not None:
            count = min(len(mesh.vertices), 3 * len(mesh.loops) + more)
            found = outcome(lambda: nested_cages(mesh, [count], Settings(decimation=decimation)))
            assert not found.fault, found.fault

    try_many(check, st.tuples(grammars.loops(), st.integers(0, 4), st.sampled_from(DECIMATIONS)), amount)


@pytest.mark.parametrize("amount", AMOUNTS)
def test_the_command_says_what_is_wrong(amount: int, tmp_path: Path) -> None:
    """Exit status 0, 1 or 2; never a traceback; a sentence wherever it is not 0; outputs whole or not there."""
    statuses: Counter[int] = Counter()

    def check(drawn: tuple[str, bytes, list[str]]) -> None:
        ending, content, options = drawn
        path, written = tmp_path / f"in{ending}", tmp_path / "out.svg"
        path.write_bytes(content)
        written.unlink(missing_ok=True)
        said, complained = io.StringIO(), io.StringIO()

        def run() -> int:
            with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
                try:
                    return main([str(path), *options, "-o", str(written)])
                except SystemExit as left:
                    assert isinstance(left.code, int)
                    return left.code

        found = outcome(run)
        assert not found.fault, found.fault
        statuses[found.result] += 1
        assert found.result in (0, 1, 2)
        if found.result:
            assert "error: " in complained.getvalue()
            assert "error: None" not in complained.getvalue()
        if found.result == 0:
            assert "</svg>" in written.read_text()

    try_many(check, grammars.commands(), amount)
    assert len(statuses) > 1


@pytest.mark.slow
@pytest.mark.parametrize("method", [{"flow": PaperFlow()}, {"flow": SignedDistanceFlow()}, {}])
def test_coarse_meshes_half_outside_end_soon(method: dict[str, Any]) -> None:
    """With every method a sentence, or the outer hull instead, in seconds."""
    fine, coarse = letter_a(), letter_a_coarse()
    half = Mesh(coarse.vertices + 0.35 * fine.diagonal * np.array([1.0, 0.0]), coarse.edges)
    refused = outcome(lambda: nested_cages(fine, [half], Settings(fallback=None, **method)))
    assert refused.told and not refused.fault, refused.fault
    found = outcome(lambda: nested_cages(fine, [half], Settings(**method)))
    assert found.result and found.result.levels[0].report.start in ("line cycles", "outer hull")


@pytest.mark.slow
def test_a_star_of_thousands_of_spikes_ends_soon() -> None:
    random, spikes = np.random.default_rng(1), 2000
    angles = np.arange(2 * spikes) / spikes * np.pi
    radii = np.where(
        np.arange(2 * spikes) % 2, random.uniform(0.2, 0.3, 2 * spikes), random.uniform(0.6, 1.0, 2 * spikes)
    )
    fine = Mesh.from_loops([radii[:, None] * np.stack((np.cos(angles), np.sin(angles)), axis=1)])
    found = outcome(lambda: nested_cages(fine, [50]))
    assert not found.fault, found.fault
    assert len(found.result.cages[0].vertices) == 50


@pytest.mark.parametrize("name", ATTACKS)
@pytest.mark.slow
def test_known_attacks_are_held(name: str) -> None:
    faults = []
    for number, call in enumerate(ATTACKS[name]()):
        found = outcome(call)
        if found.fault:
            faults.append(f"{number}: {found.fault}")
        elif isinstance(found.result, Mesh):
            check_mesh(found.result)
    assert not faults, "\n".join(faults)
