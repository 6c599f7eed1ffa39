"""Errors and notes carry a code and data, and are one sentence each."""

import copy
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import Mesh, NestedCagesError, NestingError, Rotation, inner_cages, nested_cages, verify
from support.judging import codes, rejected
from support.shapes import annulus, ring, star

PAGE = Path(__file__).resolve().parents[2] / "docs" / "errors.md"
KINDS = (core.InvalidMeshError, core.FlowError, core.ReinflationError, NestingError)


@pytest.mark.parametrize("kind", [NestedCagesError, *KINDS])
def test_errors_carry_what_they_know_and_travel_between_processes(kind: type[NestedCagesError]) -> None:
    error = kind("stuck", partial=[1, 2], code="flow.stuck", place=np.array([1.0, 2.0]), loops=[np.int64(3)])
    for copied in (error, pickle.loads(pickle.dumps(error)), copy.copy(error)):
        assert type(copied) is kind
        assert isinstance(copied, NestedCagesError)
        assert (str(copied), copied.partial, copied.code) == ("stuck", [1, 2], "flow.stuck")
        assert copied.data == {"place": (1.0, 2.0), "loops": (3,)}
    plain = kind("stuck")
    assert (plain.partial, plain.code, dict(plain.data)) == (None, "unknown", {})


def test_a_fault_is_its_sentence() -> None:
    fault = core.Fault("Loop 2 is open.", "mesh.open", vertices=[1, 2])
    assert fault == "Loop 2 is open." == f"{fault}"
    for other in (pickle.loads(pickle.dumps(fault)), copy.deepcopy(fault), fault.said("Loop 2 of 'Tree' is open.")):
        assert (other.code, other.data) == ("mesh.open", {"vertices": (1, 2)})
    assert NestingError(fault).fault is fault


BOWTIE = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)]
APART = [[(0, 0), (1, 0), (1, 1), (0, 1)], [(1.01, 0), (2, 0), (2, 1), (1.01, 1)]]
SQUARE = Mesh.from_loops([[(-1, -1), (1, -1), (1, 1), (-1, 1)]])
THIN = Mesh.from_loops([[[0.0, 0.0], [1.0, 0.0], [1.0, 1e-6], [0.0, 1e-6]]])
STILL = np.stack([SQUARE.vertices] * 2)

BAD: dict[str, tuple[Callable[[], object], str, dict[str, Any]]] = {
    "crossing": (lambda: Mesh.from_loops([BOWTIE]), "mesh.crossing", {"loops": (0,), "place": (1.0, 1.0)}),
    "open": (lambda: Mesh([(0, 0), (1, 0), (0, 1)], [(0, 1), (1, 2)]), "mesh.open", {"vertices": (0,)}),
    "too few": (lambda: nested_cages(annulus(8), [5], loops="keep"), "count.too_small", {"total": 5, "least": 6}),
    "no room": (
        lambda: nested_cages(Mesh.from_loops(APART), [8], loops="keep", clearance=0.1),
        "clearance.no_room", {"loops": (0, 1), "wanted": 0.1, "largest": pytest.approx(0.005)},
    ),
    "elsewhere": (
        lambda: nested_cages(star(), [SQUARE.moved(SQUARE.vertices + 9.0)], fallback=None), "flow.loops_differ", {},
    ),
    "no setting": (lambda: core.Settings(clearance=-1.0), "setting.invalid", {}),
    "no progress": (
        lambda: nested_cages(SQUARE, 4, progress="x"), "setting.invalid", {"name": "progress", "value": "x"},  # type: ignore[arg-type]
    ),
    "a conflict": (lambda: core.Settings(convex=True, pins=[0]), "setting.conflict", {}),
    "no tolerance": (lambda: core.Within(distance=-1.0), "setting.invalid", {}),
    "no shape": (lambda: verify(None, SQUARE), "mesh.unreadable", {}),  # type: ignore[arg-type]
    "no level": (lambda: nested_cages(SQUARE, "x"), "level.invalid", {}),
    "a box": (lambda: nested_cages(SQUARE, 4, constraints=[core.Box((0.0, 0.0), (1.0, 1.0))]), "box.left", {}),
    "an obstacle": (
        lambda: nested_cages(SQUARE, 4, constraints=[core.Outside(SQUARE.moved(SQUARE.vertices + 1.0), 0.1)]),
        "obstacle.met", {},
    ),
    "a grid": (lambda: nested_cages(SQUARE, 4, grid=50.0, clearance=0.1), "numbers.no_room", {"spacing": 50.0}),
    "a tolerance": (lambda: nested_cages(SQUARE, "0.001u", clearance=0.1), "tolerance.unreachable", {}),
    "inside": (lambda: inner_cages(THIN, [4], clearance=1e-5), "clearance.no_room", {}),
    "not inside": (lambda: inner_cages(SQUARE, [ring(8, 3.0)], fallback=None), "coarse.not_nested", {}),
    "a pose": (lambda: core.animated_cages(SQUARE, STILL[:1], 4), "poses.invalid", {}),
    "a swept pose": (lambda: core.swept(SQUARE, [SQUARE.vertices, BOWTIE]), "poses.invalid", {"pose": 1}),
    "steps": (lambda: core.verify_motion(SQUARE, SQUARE, STILL, STILL[:1]), "mesh.unreadable", {}),
    "a point": (
        lambda: core.cage_coordinates([[0, 0], [5, 5]], SQUARE), "coordinates.outside", {"vertex": 1, "place": (5, 5)},
    ),
    "no points": (lambda: core.cage_coordinates([1.0, 2.0], SQUARE), "mesh.unreadable", {}),
    "an excess": (lambda: nested_cages(ring(40), core.Within(excess=1e-9)), "tolerance.unreachable", {"limit": 1e-9}),
    "weights": (lambda: core.deform(np.eye(4), np.zeros((5, 2))), "mesh.unreadable", {}),
    "pieces": (lambda: core.convex_pieces(SQUARE, 2), "setting.invalid", {}),
    "a rotation": (lambda: Rotation(None, 1), "setting.invalid", {}),
    "a batch": (lambda: core.nested_cages_many({"a": SQUARE}, {"b": [4]}), "batch.invalid", {}),
    "a drawing": (lambda: core.from_svg("<svg"), "file.invalid", {}),
    "a map": (lambda: core.from_geojson("{"), "file.invalid", {}),
    "a limit": (lambda: core.from_geojson("{}", limits=core.Limits(bytes=1)), "limit.exceeded", {"what": "bytes"}),
}  # fmt: skip


def documented() -> dict[str, set[str]]:
    """Codes and the names of their data, as the page on errors has them."""
    rows = re.findall(r"^\| `([a-z_.]+)` \|.*\|([^|]*)\|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    return {code: set(re.findall(r"`(\w+)`", names)) for code, names in rows}


def assert_is_sentence(text: str) -> None:
    """With a capital, or the name of a setting, and a full stop, in one line, without a trace of code."""
    assert text[0].isupper() or text[0].isdigit() or re.match(r"['\"]|[a-z_]+(\W)", text)
    assert text.endswith((".", "…"))
    assert "\n" not in text
    assert not re.search(r"\{\w*\}|<\w+ object|Traceback|  |\.\.|None\b", text), text


@pytest.mark.parametrize(("work", "code", "data"), BAD.values(), ids=BAD.keys())
def test_errors_say_what_and_where_in_data_and_in_a_sentence(
    work: Callable[[], object], code: str, data: dict[str, object]
) -> None:
    with rejected(code, **data) as caught:
        work()
    assert_is_sentence(str(caught.value))
    assert set(caught.value.data) <= documented()[code] and np.inf not in caught.value.data.values()


NOTES: dict[str, tuple[Callable[[], Any], str, dict[str, Any]]] = {
    "more than there are": (lambda: nested_cages(SQUARE, [9]), "note.count", {"on": "mesh", "asked": 9, "given": 4}),
    "a symmetry": (lambda: nested_cages(star(5, 40), 12, symmetry=Rotation(None, 5)), "note.count", {"given": 10}),
    "loops": (lambda: nested_cages(annulus(24, 0.2), [ring(6, 1.2)]), "note.loops", {"filled": (1,), "joined": ()}),
    "a tolerance": (lambda: nested_cages(star(5, 40), "+50%"), "note.tolerance", {"on": "excess", "limit": 0.5}),
    "narrow": (lambda: inner_cages(THIN, 4), "note.clearance", {"on": "inside"}),
    "a pin": (lambda: nested_cages(star(5, 40), 5, pins=range(0, 40, 4)), "note.pin", {"pins": 10}),
    "elsewhere": (lambda: nested_cages(star(5, 40), [ring(6) + 9.0]), "note.start", {"on": "fallback"}),
}


@pytest.mark.parametrize(("work", "code", "data"), NOTES.values(), ids=NOTES.keys())
def test_notes_say_what_differs_in_data_and_in_a_sentence(
    work: Callable[[], Any], code: str, data: dict[str, object]
) -> None:
    (level,) = work()
    assert code in codes(level)
    (note, *_) = [note for note in level.report.notes if note.code == code]
    assert {name: note.data[name] for name in data} == data
    assert str(note) in str(level.report)
    for said in level.report.notes:
        assert_is_sentence(said)
        assert set(said.data) <= documented().get(said.code, set(said.data))


def test_problems_of_certificates_are_sentences() -> None:
    fine, wide = star(9), SQUARE.moved(2.0 * SQUARE.vertices)
    for found, wanted in (
        (verify(fine, fine), ["cage.meets"]),
        (verify(wide, SQUARE, 1.5), ["cage.too_close"]),
        (verify(SQUARE, wide), ["cage.leaves_out"] * 2),
        (verify(wide, annulus(8)), ["cage.loops_differ"]),
        (verify([BOWTIE], SQUARE), ["cage.invalid"]),
    ):
        assert [problem.code for problem in found.problems] == wanted
        for problem in found.problems:
            assert_is_sentence(problem)
            assert set(problem.data) <= documented()[problem.code]
