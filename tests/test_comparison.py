"""The comparison's own measuring: the paper as written fails as its program does, ours does not, and all is told."""

from __future__ import annotations

import csv
import importlib
import json
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]
BENCHMARKS = ROOT / "benchmarks"
PAGES = ROOT / "docs" / "comparison"


@pytest.fixture
def comparison(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("comparison")


@pytest.mark.skipif(not (PAGES / "digest.json").is_file(), reason="the pages were made before there were digests")
def test_the_comparison_is_of_this_code(comparison: ModuleType) -> None:
    from comparison import digest

    assert digest.changed(PAGES) == [], "run: python benchmarks/compare.py"


def test_comments_do_not_change_a_digest_but_code_does(comparison: ModuleType, tmp_path: Path) -> None:
    from comparison import digest

    def of(text: str) -> str:
        path = tmp_path / "module.py"
        path.write_text(text, encoding="utf-8")
        return digest._digest(path)

    before = of(
        '"""Doc."""\nLIMIT = 3  # seconds\n"""What it is."""\n\ndef f(x):\n    """Twice."""\n    return 2 * x\n'
    )
    assert of('"""Other."""\nLIMIT = 3\n\n\ndef f(x):\n    return 2 * x\n') == before
    assert of("LIMIT = 4\n\ndef f(x):\n    return 2 * x\n") != before
    assert of("LIMIT = 3\n\ndef f(x):\n    return 3 * x\n") != before
    assert of("LIMIT = 3\n\ndef f(y):\n    return 2 * y\n") != before


def test_what_the_results_depend_on_is_named(comparison: ModuleType) -> None:
    from comparison import digest

    names = digest.digests()
    for part in ("nestedcages_core/contact/ccd.py", "nestedcages_core/published/li_2020/barrier.py",
                 "nestedcages_core/verification/certificate.py", "benchmarks/comparison/methods.py",
                 "benchmarks/comparison/experiments/sweeps.py", "benchmarks/random_shapes.py",
                 "benchmarks/data/table1.csv"):  # fmt: skip
        assert part in names
    assert not any(name.startswith("nestedcages_core/exchange") for name in names)


def test_a_changed_file_is_named(comparison: ModuleType, tmp_path: Path) -> None:
    from comparison import digest

    digest.write(tmp_path)
    assert digest.changed(tmp_path) == []
    record = json.loads((tmp_path / digest.FILE).read_text(encoding="utf-8"))
    record["nestedcages_core/contact/ccd.py"] = "another"
    record["nestedcages_core/gone.py"] = "gone"
    (tmp_path / digest.FILE).write_text(json.dumps(record), encoding="utf-8")
    assert digest.changed(tmp_path) == ["nestedcages_core/contact/ccd.py", "nestedcages_core/gone.py"]


def test_measurements_are_kept(comparison: ModuleType, tmp_path: Path) -> None:
    from comparison.bench import Bench

    asked: list[int] = []

    def square(number: int) -> int:
        asked.append(number)
        return number * number

    first = Bench(store=tmp_path)
    assert first.each("squares", square, {k: (k,) for k in (1, 2)}) == {1: 1, 2: 4}
    again = Bench(store=tmp_path)
    assert again.each("squares", square, {k: (k,) for k in (2, 3)}) == {2: 4, 3: 9}
    assert asked == [1, 2, 3]
    with (tmp_path / "squares.pickle").open("ab") as file:
        file.write(b"\x80\x04\x95")  # of a run that was ended while it wrote
    assert Bench(store=tmp_path).each("squares", square, {3: (3,)}) == {3: 9}


def test_a_conclusion_that_the_runs_contradict_is_marked(comparison: ModuleType, capsys) -> None:
    pytest.importorskip("matplotlib")
    from comparison import making, report
    from comparison.conclusions import CONCLUSIONS, CONFIRMED, Verdict

    assert len({c.name for c in CONCLUSIONS} & set(CONFIRMED)) == 3
    assert report.said(Verdict("It is so.", True)) == "It is so."
    assert "Contradicted by these runs" in report.said(Verdict("It is so.", False))
    assert making.told({CONCLUSIONS[0]: Verdict("It is so.", True)}) == 0
    assert making.told({CONCLUSIONS[0]: Verdict("It is so.", False)}) == making.CONTRADICTED
    assert "CONTRADICTED: original. It is so." in capsys.readouterr().out


def test_the_front_is_what_nothing_beats(comparison: ModuleType) -> None:
    pytest.importorskip("matplotlib")
    from comparison.experiments.sweeps import Point, front

    made = {p.label: p for p in (
        Point("fast", 1.0, 5.0, 9.0, 0.0), Point("tight", 3.0, 1.0, 5.0, 0.0), Point("beaten", 3.0, 2.0, 6.0, 0.0),
        Point("fails", 0.5, 0.5, 4.0, 0.5),
    )}  # fmt: skip
    assert [point.label for point in front(made)] == ["fails", "fast", "tight"]


def test_kept_trees_find_the_pairs_that_the_grid_finds(comparison: ModuleType) -> None:
    from comparison.kept_trees import FineTree
    from nestedcages_core import Mesh
    from nestedcages_core.contact.pairs import Bodies, find_pairs

    random = np.random.default_rng(0)
    turn = 2.0 * np.pi * np.arange(60) / 60
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    cage, fine = Mesh.from_loops([1.3 * circle[::6]]), Mesh.from_loops([circle])
    bodies = Bodies.of(cage, fine)
    x = np.concatenate([cage.vertices, fine.vertices])
    tree = FineTree.of(fine.vertices, fine.successor)
    for radius in (0.05, 0.2, 0.5):
        moved = x + 0.05 * random.normal(size=x.shape)
        pairs = [tree.pairs(bodies, moved, radius), find_pairs(bodies, moved, radius)]
        found, expected = ({tuple(row) for row in p.corners.tolist()} for p in pairs)
        assert found == {row for row in expected if row in found}
        near = pairs[1].measure(moved).distance < radius
        assert {tuple(row) for row in pairs[1].corners[near].tolist()} <= found


@pytest.mark.slow
def test_what_a_run_is_said_to_be(comparison: ModuleType, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from comparison import methods, tables
    from comparison.bench import Bench
    from comparison.cases import disc
    from comparison.experiments.figures import kind_of_failure

    chosen = {"paper": methods.PAPER, "repaired": methods.HOME, "ours": methods.TIGHT}
    (found,) = Bench().compare("test", {"disc": disc(32)}, chosen).values()
    late = Bench().compare("test", {"disc": disc(32)}, {"late": methods.HOME}, limit=0.1)["disc"]["late"]

    assert not found["paper"].success
    assert found["paper"].certified
    assert 0.0 < found["paper"].short < 1e-3
    assert abs(found["paper"].excess - 19.5) < 2.0  # of the paper's program in its Table 1
    assert "short of its target" in kind_of_failure(found["paper"])
    assert found["repaired"].success
    assert found["ours"].success
    assert found["ours"].excess < 0.1
    assert kind_of_failure(late) == "out of time"
    assert late.cage is not None  # how far it came is kept

    assert tables.write_runs({"test": {"disc": found}}, tmp_path / "runs.csv") == 3
    with (tmp_path / "runs.csv").open(newline="", encoding="utf-8") as file:
        lines = {line["method"]: line for line in csv.DictReader(file)}
    assert [lines[name]["success"] for name in found] == ["False", "True", "True"]
    assert float(lines["ours"]["total_s"]) == pytest.approx(found["ours"].total, abs=1e-4)
    assert lines["paper"]["failed_in"] == "reinflation"


@pytest.mark.slow
def test_pages_and_report_come_of_the_runs(comparison: ModuleType, tmp_path: Path, monkeypatch) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("fpdf")
    from comparison import digest, making
    from comparison.bench import Bench
    from comparison.cases import Sizes, read_inputs

    inputs = read_inputs(sizes=Sizes(first_seed=1, contact_random=2, contact_glyphs=1))
    making.compare(inputs, Bench(), ["contacts"], tmp_path)
    page = (tmp_path / "comparison.md").read_text(encoding="utf-8")
    assert "](comparison/contacts.md)" in page
    tables = (tmp_path / "comparison" / "contacts.md").read_text(encoding="utf-8")
    assert tables.startswith("# Contacts from the same starts")
    assert "3 starts: 2 random shapes" in tables
    results = json.loads((tmp_path / "comparison" / "results.json").read_text(encoding="utf-8"))
    assert set(results["conclusions"]) == {"barrier", "tightening"}

    report = importlib.import_module("report")
    report.make(results, tmp_path / "comparison", tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
    assert report.plain("**So** it *is*: `a__b`.") == "**So** it __is__: ab."

    assert digest.check(tmp_path / "comparison") == 0
    assert digest.check(tmp_path) == digest.CHANGED
    monkeypatch.setattr(making, "EXPERIMENTS", {})
    with pytest.raises(SystemExit, match="no experiment 'none'"):
        making.run(SimpleNamespace(only=["none"]), tmp_path, tmp_path)
