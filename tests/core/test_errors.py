"""Errors and notes say one sentence, carry a code and data, and what was finished before them."""

from __future__ import annotations

import ast
import copy
import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from nestedcages_core import Mesh, Settings, Within, nested_cages, verify
from nestedcages_core.errors import (
    CODES,
    UNKNOWN,
    Fault,
    FlowError,
    InvalidMeshError,
    NestedCagesError,
    NestingError,
    ReinflationError,
)
from nestedcages_core.errors.notes import in_units, sentence
from support.shapes import annulus, star

CORE = Path(__file__).resolve().parents[2] / "nestedcages_core"
KINDS = (InvalidMeshError, FlowError, ReinflationError, NestingError)
NAMES = {kind.__name__ for kind in (NestedCagesError, *KINDS)} | {"LimitError", "AsymmetricError"}


@pytest.mark.parametrize("kind", [NestedCagesError, *KINDS])
def test_errors_carry_what_they_know_and_travel_between_processes(kind: type[NestedCagesError]) -> None:
    error = kind("stuck", partial=[1, 2], code="flow.stuck", place=np.array([1.0, 2.0]), loops=[np.int64(3)])
    for copied in (error, pickle.loads(pickle.dumps(error)), copy.copy(error)):
        assert type(copied) is kind
        assert isinstance(copied, NestedCagesError)
        assert (str(copied), copied.partial, copied.code) == ("stuck", [1, 2], "flow.stuck")
        assert copied.data == {"place": (1.0, 2.0), "loops": (3,)}
    assert (kind("stuck").partial, kind("stuck").code, dict(kind("stuck").data)) == (None, UNKNOWN, {})


def test_a_fault_is_its_sentence() -> None:
    fault = Fault("Loop 2 is open.", "mesh.open", vertices=[1, 2])
    assert fault == "Loop 2 is open." == f"{fault}"
    for other in (pickle.loads(pickle.dumps(fault)), copy.deepcopy(fault), fault.said("Loop 2 of 'Tree' is open.")):
        assert (other.code, other.data) == ("mesh.open", {"vertices": (1, 2)})
    assert NestingError(fault).fault is fault


def test_notes_of_other_versions_are_their_text_and_lengths_have_units() -> None:
    assert sentence("note.of_tomorrow", {"text": "It is so."}) == "It is so."
    data = {"limit": 2.0, "taken": 1.0, "on": ""}
    assert in_units(data, "note.tolerance", 10.0) == {"limit": 20.0, "taken": 10.0, "on": ""}
    assert in_units({**data, "on": "excess"}, "note.tolerance", 10.0)["limit"] == 2.0


def _is_sentence(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr | ast.BinOp) or (isinstance(node, ast.Constant) and bool(node.value))


@pytest.mark.slow
def test_every_place_that_raises_names_a_code_and_data_of_the_table() -> None:
    used: set[str] = set()
    without: list[str] = []
    for path in sorted(CORE.rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        shorthand = "code=" if path.parent.name == "errors" else ""  # the table itself is no use
        used |= {code for code in CODES if f'{shorthand}"{code}"' in source}
        for node in ast.walk(ast.parse(source)):
            name = node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else ""
            if not isinstance(node, ast.Call) or name not in NAMES | {"Fault", "note"}:
                continue
            given = {keyword.arg: keyword.value for keyword in node.keywords}
            place = {"Fault": 1, "note": 0}.get(name, len(node.args))
            code = node.args[place] if place < len(node.args) else given.get("code")
            if isinstance(code, ast.Constant):
                data = {key for key in given if key is not None} - {"code", "partial"}
                if code.value not in CODES or not data <= set(CODES[code.value]):
                    without.append(f"{path.name}:{node.lineno}: {code.value} with {sorted(data)}")
            elif code is None and node.args and _is_sentence(node.args[0]):
                without.append(f"{path.name}:{node.lineno}: no code")
    assert without == []
    assert sorted(set(CODES) - used) == ["note.text"]  # for programs that add notes of their own


BOWTIE = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)]
APART = [[(0, 0), (1, 0), (1, 1), (0, 1)], [(1.01, 0), (2, 0), (2, 1), (1.01, 1)]]
SQUARE = Mesh.from_loops([[(-1, -1), (1, -1), (1, 1), (-1, 1)]])


@pytest.mark.parametrize(
    ("work", "code", "data"),
    [
        (lambda: Mesh.from_loops([BOWTIE]), "mesh.crossing", {"loops": (0,), "place": (1.0, 1.0)}),
        (lambda: Mesh([(0, 0), (1, 0), (0, 1)], [(0, 1), (1, 2)]), "mesh.open", {"vertices": (0,)}),
        (lambda: nested_cages(annulus(8), [5], loops="keep"), "count.too_small", {"total": 5, "least": 6}),
        (
            lambda: nested_cages(Mesh.from_loops(APART), [8], Settings(clearance=0.1)),
            "clearance.no_room",
            {"loops": (0, 1), "wanted": 0.1, "largest": pytest.approx(0.005)},
        ),
        (
            lambda: nested_cages(star(), [SQUARE.moved(SQUARE.vertices + 9.0)], Settings(fallback=None)),
            "flow.loops_differ",
            {},
        ),
        (lambda: Settings(clearance=-1.0), "setting.invalid", {}),
        (lambda: Within(distance=-1.0), "setting.invalid", {}),
    ],
)
def test_errors_say_where_in_data_too(work: Callable[[], object], code: str, data: dict[str, object]) -> None:
    with pytest.raises(NestedCagesError) as caught:
        work()
    assert caught.value.code == code
    assert {name: caught.value.data.get(name) for name in data} == data


def test_problems_and_notes_have_codes() -> None:
    fine = star(9)
    assert [problem.code for problem in verify(fine, fine).problems] == ["cage.meets"]
    (close,) = verify(SQUARE.moved(2.0 * SQUARE.vertices), SQUARE, 1.5).problems
    assert (close.code, close.data) == ("cage.too_close", {"clearance": 1.0, "wanted": 1.5})
    notes = nested_cages(SQUARE, [9]).levels[0].report.notes
    assert [(note.code, dict(note.data)) for note in notes] == [("note.count", {"on": "mesh", "asked": 9, "given": 4})]
