"""Results depend on the input and the libraries alone: not on hash seeds, threads or how numpy treats its errors;
nothing warns."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.slow

PROGRAM = """
import hashlib, sys
import numpy as np

if "raise" in sys.argv:
    np.seterr(all="raise")
from nestedcages_core import IPC, ArcLength, OnCurve, Settings, nested_cages, verify, verify_motion
from support.shapes import comb, islands, letter_a, letter_a_coarse, star

digest = hashlib.sha256()
runs = [
    (letter_a(), [40, 20], Settings()),
    (letter_a(), [letter_a_coarse()], Settings()),
    (star(), [20], Settings(decimation=OnCurve())),
    (star(), [12], Settings(decimation=ArcLength(), clearance=0.01)),
    (islands(), [40], Settings()),
    (comb(3, 0.02), [30], Settings()),
]
if "large" in sys.argv:
    runs += [
        (comb(80, 0.005), [240], Settings()),  # distant vertices of the cage touch
        (star(9, 3000), [140], Settings(decimation=ArcLength(), contact=IPC())),  # many vertices in one dense matrix
        (star(5, 10_500), [20], Settings()),  # sums of more than 10,000 terms
    ]
for fine, levels, settings in runs:
    for level in nested_cages(fine, levels, settings).levels:
        way = level.reinflation
        assert verify(level.cage, level.fine, level.report.wanted_clearance)
        assert verify_motion(level.cage, level.fine, way.cage_steps, way.fine_steps)
        for array in (level.coarse.vertices, level.cage.vertices, way.cage_steps, way.fine_steps, level.flow.steps):
            digest.update(np.ascontiguousarray(array).tobytes())
print(digest.hexdigest())
"""


def bits(*arguments: str, options: tuple[str, ...] = (), **environment: str) -> str:
    """The digest of all results in a process with such surroundings; its log must be empty."""
    paths = os.pathsep.join([str(ROOT), str(ROOT / "tests" / "core")])
    done = subprocess.run(
        [sys.executable, *options, "-c", PROGRAM, *arguments],
        env={**os.environ, "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1", "PYTHONHASHSEED": "0", **environment},
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.strip()


@pytest.fixture(scope="module")
def plain() -> str:
    """The digest in plain surroundings."""
    return bits()


@pytest.mark.parametrize("seed", ["1", "123456"])
def test_hash_seeds_do_not_matter(plain: str, seed: str) -> None:
    assert bits(PYTHONHASHSEED=seed) == plain


def test_threads_of_the_linear_algebra_do_not_matter() -> None:
    one, four = (bits("large", OPENBLAS_NUM_THREADS=count, OMP_NUM_THREADS=count) for count in ("1", "4"))
    assert one == four


def test_nothing_warns_and_no_error_of_numpy_is_left_to_chance(plain: str) -> None:
    assert bits("raise", options=("-W", "error")) == plain
