"""Results depend on the input and the libraries alone: not on hash seeds, threads, what was asked for before, how numpy
treats its errors, or the system; nothing warns."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from nestedcages_core import Mesh, from_geojson, from_svg, to_svg
from support.sources import ROOT

PROGRAM = """
import hashlib, sys
import numpy as np

if "raise" in sys.argv:
    np.seterr(all="raise")
from nestedcages_core import (
    IPC, ArcLength, NoEnergy, OnCurve, Settings, ShapeKeeping, nested_cages, verify, verify_motion)
from support.shapes import comb, islands, letter_a, letter_a_coarse, star

def digest_of(hierarchy):
    digest = hashlib.sha256()
    for level in hierarchy.levels:
        way = level.reinflation
        assert verify(level.cage, level.fine, level.report.wanted_clearance, same_loops=False)
        assert verify_motion(level.cage, level.fine, way.cage_steps, way.fine_steps)
        for array in (level.coarse.vertices, level.cage.vertices, way.cage_steps, way.fine_steps, level.flow.steps):
            digest.update(np.ascontiguousarray(array).tobytes())
        digest.update(repr([note.code for note in level.report.notes]).encode())
    return digest.hexdigest()

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
if "dragged" in sys.argv:  # settings as a hand on sliders gives them
    fine = star(5, 60)
    size = fine.diagonal
    runs = [(fine, [5], Settings(energy=ShapeKeeping(strength))) for strength in (0.5, 4.0, 0.5, 2.0)]
    runs += [(fine, [5], Settings(clearance=share * size)) for share in (1e-5, 3e-4, 1.05e-2, 3e-4)]
    runs += [(fine, [5], Settings(energy=NoEnergy(), clearance=1e-2 * size)), (fine, [5], Settings(contact=IPC()))]
    runs += [(fine, [5], Settings())]
order = sorted(range(len(runs)), reverse="backwards" in sys.argv)
digests = {number: digest_of(nested_cages(*runs[number])) for number in order}
print(*(digests[number] for number in sorted(digests)))
"""


def bits(*arguments: str, options: tuple[str, ...] = (), **environment: str) -> list[str]:
    """Digests of results in a process with such surroundings; its log must be empty."""
    paths = os.pathsep.join([str(ROOT), str(ROOT / "tests")])
    done = subprocess.run(
        [sys.executable, *options, "-c", PROGRAM, *arguments],
        env={**os.environ, "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1", "PYTHONHASHSEED": "0", **environment},
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.split()


@pytest.fixture(scope="module")
def plain() -> list[str]:
    """The digests in plain surroundings."""
    return bits()


@pytest.mark.slow
def test_hash_seeds_and_the_order_of_requests_do_not_matter(plain: list[str]) -> None:
    assert bits("backwards", PYTHONHASHSEED="123456") == plain
    assert len(set(plain)) == len(plain)


@pytest.mark.slow
def test_what_was_asked_for_before_does_not_matter() -> None:
    forwards = bits("dragged")
    assert bits("dragged", "backwards") == forwards
    assert len(set(forwards)) > len(forwards) // 2


@pytest.mark.thorough
def test_threads_of_the_linear_algebra_do_not_matter() -> None:
    one, four = (bits("large", OPENBLAS_NUM_THREADS=count, OMP_NUM_THREADS=count) for count in ("1", "4"))
    assert one == four


@pytest.mark.slow
def test_nothing_warns_and_no_error_of_numpy_is_left_to_chance(plain: list[str]) -> None:
    assert bits("raise", options=("-W", "error")) == plain


SHAPE = Mesh.from_loops([np.array([[0, 0], [10, 0], [10, 10], [6, 10], [5, 4], [4, 10], [0, 10]], float)])


@pytest.mark.parametrize(
    ("read", "text"),
    [
        (from_svg, to_svg(SHAPE).replace("><", ">\n<")),
        (from_geojson, json.dumps(SHAPE.__geo_interface__, indent=1)),
    ],
    ids=["svg", "geojson"],
)
def test_texts_that_windows_wrote_are_read(read: object, text: str) -> None:
    """A byte order mark, and lines that end with a carriage return too."""
    windows = b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode("utf-8")
    assert read(windows) == read(text) == SHAPE  # type: ignore[operator]
