"""The comparison: statistics, runs and pages, what does not show a conclusion, and what the check finds."""

from __future__ import annotations

import importlib
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "comparison"


@pytest.fixture
def comparison(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    pytest.importorskip("shapely")
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    importlib.import_module("clone")
    return importlib.import_module("comparison")


def pretended(comparison: ModuleType) -> list:
    """Runs in which the range decides which method is tighter, and the start what is left after the tightening."""
    from comparison import methods, runs, shapes

    made = []

    def add(
        experiment: str, family: str, number: int, start: str, method: str, excess: float, seconds: float, after: float
    ) -> None:
        made.append(runs.Run(
            experiment, family, number, f"shape {number}", start, method, 60, 10, True, True, "", excess, after, 1e-3,
            0.0, seconds, 5, 7, None, "",
        ))  # fmt: skip

    for family in (shapes.RANDOM, shapes.GLYPHS, shapes.HELD_OUT):
        for number in range(18):
            for place, start in enumerate(methods.STARTS):
                for method, excess, seconds in (
                    (methods.ORIGINAL, 10.0, 0.01), (methods.REPAIRED, 30.0, 1.0), (methods.NEWTON, 29.0, 0.03),
                    (methods.NEWTON_SMALL, 9.0, 0.3),
                ):  # fmt: skip
                    add("methods", family, number, start, method, excess + number, seconds, 5.0)
                for method in methods.CELLS:
                    near = start == "line cycles"
                    after = 5.0 + (1.0 if method == "El Topo" and not near else 0.0)
                    excess = 10.0 + (1e3 * float(method.split()[-1]) if method in methods.AT_RANGES else 0.0)
                    add("contacts", family, number, start, method, excess, 0.01, after + 3.0 * place)
    return made


@pytest.mark.slow
def test_intervals_and_paired_tests_are_those_of_the_textbook(comparison: ModuleType) -> None:
    from comparison import statistics

    values = np.random.default_rng(1).normal(3.0, 1.0, 400)
    mean = statistics.bootstrap(values, np.mean)
    assert mean.value == values.mean()
    assert (mean.low, mean.high) == pytest.approx(values.mean() + np.array([-1.96, 1.96]) * values.std() / 20, abs=0.02)
    assert statistics.geometric_mean([1.0, 4.0, 2.0]).value == pytest.approx(2.0)
    test = statistics.sign_test([1.0] * 8 + [3.0] * 2 + [2.0], [2.0] * 10 + [np.inf])
    assert (test.wins, test.losses) == (9, 2)
    assert test.p == pytest.approx(2 * (1 + 11 + 55) / 2**11)  # two tails of the binomial distribution
    assert np.isnan(statistics.bootstrap([]).value)
    several = {name: test._replace(p=p) for name, p in (("a", 0.03), ("b", 0.01), ("c", 0.9), ("d", 0.011))}
    corrected = statistics.corrected(several)
    assert list(corrected) == list(several)
    assert [corrected[name].p for name in "abcd"] == pytest.approx([0.06, 0.04, 0.9, 0.04])  # 4 b, 3 d below it, 2 a


@pytest.mark.slow
def test_conclusions_say_when_runs_do_not_show_them(comparison: ModuleType) -> None:
    from comparison import conclusions, methods, pages

    made = pretended(comparison)
    known = {c.name: both for c, both in conclusions.verdicts(made).items()}
    assert [verdict.failed for both in known.values() for verdict in both] == [()] * 6
    far = "edge collapse, d̂ = 0.035, both solve: 2015 tighter"
    assert known["original"][0].tests[far].wins == 36
    swap = {methods.ORIGINAL: methods.NEWTON, methods.NEWTON: methods.ORIGINAL}
    turned = [replace(run, method=swap.get(run.method, run.method)) for run in made]
    verdict = conclusions.original(turned, conclusions.KNOWN)
    assert "arc length: at d̂ = 0.035, 2015 is tighter" in verdict.failed
    assert "not shown by these runs**: edge collapse: at d̂ = 0.035" in pages.said(known["original"][0], verdict)
    lost = [replace(run, success=False) if run.method == methods.NEWTON else run for run in made]
    verdict = conclusions.original(lost, conclusions.KNOWN)
    assert verdict.tests["arc length, d̂ = 0.035: 2015 solves and 2022 does not"].wins == 36
    assert verdict.tests["arc length, d̂ = 0.035, all shapes: 2015 tighter"].wins == 36
    flat = [replace(run, excess=10.0) if run.experiment == "contacts" else run for run in made]
    assert not conclusions.ranges(flat, conclusions.KNOWN).holds
    near = methods.at(methods.ENERGY_2022, methods.SMALL_RANGE)
    loose = [replace(run, excess=1.1 * run.excess) if run.method == near else run for run in made]
    assert len(conclusions.ranges(loose, conclusions.KNOWN).failed) == len(methods.STARTS)
    apart = [replace(run, tightened=50.0) if run.method == "El Topo" else run for run in made]
    assert conclusions.starts(apart, conclusions.KNOWN).failed == ("contacts differ less than starts",)


@pytest.mark.slow
def test_runs_survive_their_file_and_make_the_pages(comparison: ModuleType, tmp_path: Path) -> None:
    from comparison import check, pages, runs

    made = [*pretended(comparison), replace(pretended(comparison)[0], shape="lost", success=False, excess=None)]
    runs.write(made, tmp_path / pages.RUNS)
    assert runs.read(tmp_path / pages.RUNS) == made
    record = {"commit": "abc", "date": "today", "machine": "here", "minutes": 1.5}
    pages.write(made, record, tmp_path)
    assert len(list(tmp_path.rglob("*.md"))) == 6
    assert "abc" in (tmp_path / "comparison.md").read_text(encoding="utf-8")
    assert check.other_pages(made, record, tmp_path) == []
    page = tmp_path / "comparison" / "contacts.md"
    page.write_text(page.read_text(encoding="utf-8").replace("10.0", "19.0"), encoding="utf-8")
    assert check.other_pages(made, record, tmp_path) == [f"{page} is not what its runs give"]


@pytest.mark.slow
def test_the_check_names_runs_that_come_out_otherwise(comparison: ModuleType, tmp_path: Path) -> None:
    from comparison import check, experiments, shapes

    (case,) = shapes.cases(((shapes.HELD_OUT, 1),), (experiments.ONE_START,))
    made = experiments.contacts(case, ("IPC, ours", "sequential QP"))
    again = experiments.sample(made)
    assert [run.method for run in again] == list(experiments.SAMPLED)
    assert check.other_runs(made, again[:2]) == []
    looser = [replace(made[0], excess=1.1 * made[0].excess + 1.0), *made[1:]]
    (line,) = check.other_runs(looser, again[:2])
    assert case.shape in line and "IPC, ours" in line
    assert len(check.other_runs(made, again)) == 1  # one that was not recorded
    assert check.check(tmp_path) == check.CHANGED


@pytest.mark.skipif(not (PAGES / "results.json").is_file(), reason="the comparison was not made yet")
def test_the_pages_are_what_their_runs_give(comparison: ModuleType) -> None:
    from comparison import check, pages, runs

    assert check.other_pages(runs.read(PAGES / pages.RUNS), pages.read_record(PAGES), PAGES.parent) == []


def test_held_out_shapes_are_valid_and_name_source_and_licence(comparison: ModuleType) -> None:
    from comparison import held_out, methods, shapes

    made = list(shapes.cases(((shapes.HELD_OUT, 4),)))
    assert [case.start for case in made] == 4 * list(methods.STARTS)
    assert all(len(case.coarse.vertices) < len(case.fine.vertices) <= shapes.MOST_VERTICES for case in made)
    every = [held_out.held_out(number) for number in range(len(held_out.shapes()))]
    assert {name.split(":")[0] for name, _ in every} == {"letters", "icons", "maps"}
    assert {licence for *_, licence in held_out.sources()} == {"OFL-1.1", "CC0-1.0", "MIT", "CC-BY-4.0"}
    assert held_out.held_out(len(every)) is None


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


@pytest.mark.slow
def test_a_disc_by_published_methods_and_ours(comparison: ModuleType) -> None:
    from comparison import experiments, methods, shapes
    from comparison.measure import measure

    found = {run.method: run for run in experiments.table_1(shapes.disc(32))}
    assert found[methods.WRITTEN].excess == pytest.approx(21.8, abs=0.1)  # of the compiled program
    assert found[methods.WRITTEN].encloses and not found[methods.WRITTEN].success
    assert found[methods.OURS].success and found[methods.OURS].excess < 1.96  # the optimum is 1.947
    late = measure(methods.DESCENT, *shapes.disc(16)[3:5], limit=0.1)
    assert late.out_of_time and late.cage is not None  # how far it came is kept


@pytest.mark.slow
def test_figures_have_three_panes_and_what_the_paper_says(comparison: ModuleType) -> None:
    pytest.importorskip("matplotlib")
    from comparison import figures, pictures

    fifth = figures.panes(figures.FIGURES[-1])
    assert fifth.outcome == "outside after 100 steps of the flow"  # as the paper says
    assert fifth.ours.success
    assert fifth.ended.area < fifth.flowed.area < fifth.fine.area
    assert len(pictures.panes([fifth]).axes) == 4
