"""The comparison's own measuring: the paper as written fails as its program does, ours does not, and all is told."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"


@pytest.mark.slow
def test_what_a_run_is_said_to_be(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    from comparison import methods, tables
    from comparison.cases import disc
    from comparison.experiments.figures import kind_of_failure
    from comparison.measure import compare

    chosen = {"paper": methods.PAPER, "repaired": methods.HOME, "ours": methods.TIGHT}
    (found,) = compare("test", {"disc": disc(32)}, chosen).values()
    late = compare("test", {"disc": disc(32)}, {"late": methods.HOME}, limit=0.1)["disc"]["late"]

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
