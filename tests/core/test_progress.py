"""Runs as iterators of their progress: fractions, cancelling, listeners that raise, and time that is over."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import AnimatedCagesRun, Mesh, NestedCagesError, NestedCagesRun, Progress, nested_cages
from support.judging import rejected
from support.marks import slow_after
from support.shapes import letter_a, ring, star
from support.sources import ROOT

STAGES = ["decimation", "flow", "reinflation", "tightening", "verification"]


def changed(fine: Mesh, k: int) -> Mesh:
    """The same shape in another size, so that nothing is known of it yet."""
    return fine.moved(fine.vertices * (1.0 + 1e-3 * k)).validated()


RUNS: dict[str, Callable[[int], Any]] = {
    "cages": lambda k: NestedCagesRun(changed(star(5, 60), k), [20, 12]),
    "inner cages": lambda k: core.InnerCagesRun(changed(star(5, 60), k), [20, 12]),
    "a motion": lambda k: AnimatedCagesRun(
        changed(star(5, 60), k), [(1.0 + 0.1 * t) * changed(star(5, 60), k).vertices for t in range(3)], [12]
    ),
}


def result_of(run: Any) -> Any:
    return run.moving if isinstance(run, AnimatedCagesRun) else run.hierarchy


@pytest.mark.parametrize("make", RUNS.values(), ids=RUNS.keys())
def test_a_run_reports_its_progress_and_has_its_result_at_the_end(make: Callable[[int], Any]) -> None:
    run = make(1)
    with pytest.raises(RuntimeError):
        result_of(run)
    reports = list(run)
    assert all(isinstance(report, Progress) and report.message for report in reports)
    fractions = [report.fraction for report in reports]
    assert fractions == sorted(fractions)
    assert 0.0 <= fractions[0] < 0.5 < fractions[-1] <= 1.0
    made = result_of(run)
    assert [report.level for report in reports] == sorted(report.level for report in reports)
    assert {report.level for report in reports} == set(range(len(made.levels)))
    assert list(run) == []
    run.close()
    assert result_of(run) is made


def test_the_stages_of_a_level_come_in_order_and_the_result_is_that_of_a_call() -> None:
    run = NestedCagesRun(changed(letter_a(2), 2), [24])
    reports = list(run)
    assert list(dict.fromkeys(report.stage for report in reports)) == STAGES
    begins = [min(report.fraction for report in reports if report.stage == stage) for stage in STAGES]
    assert begins == sorted(begins)
    assert run.hierarchy.cages == nested_cages(changed(letter_a(2), 2), [24]).cages


@pytest.mark.parametrize("make", slow_after(1, RUNS.values()), ids=RUNS.keys())
def test_a_run_can_be_stopped_at_every_step(make: Callable[[int], Any]) -> None:
    """At steps spread over the whole run; what was reported before is the same each time."""
    whole = [report.stage for report in make(10)]
    for k, stop in enumerate(sorted({round(k * (len(whole) - 1) / 3) for k in range(4)})):
        run = make(11 + k)
        assert [next(run).stage for _ in range(stop + 1)] == whole[: stop + 1]
        run.close()
        assert list(run) == []
        with pytest.raises(RuntimeError):
            result_of(run)


def test_a_run_that_failed_has_no_result() -> None:
    run = NestedCagesRun(letter_a(1), [30, ring(5) + 100.0], fallback=None)
    with pytest.raises(NestedCagesError) as caught:
        list(run)
    assert len(caught.value.partial.levels) == 1
    with pytest.raises(RuntimeError):
        result_of(run)


class StopError(Exception):
    """Raised by a listener to cancel."""


@pytest.mark.parametrize("work", [nested_cages, core.inner_cages])
@pytest.mark.parametrize("count", [0, 1, 7])
def test_a_listener_that_raises_stops_the_work_at_once(work: Callable[..., Any], count: int) -> None:
    seen: list[Progress] = []

    def listen(progress: Progress) -> None:
        seen.append(progress)
        if len(seen) > count:
            raise StopError

    with pytest.raises(StopError):
        work(changed(star(), 20 + count), [24], progress=listen)
    assert len(seen) == count + 1
    fine = star(5, 60)
    with pytest.raises(StopError):
        core.animated_cages(fine, [fine.vertices, 1.1 * fine.vertices], [12], progress=listen)
    assert len(seen) == count + 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("decimation", "least"),
    [
        (core.ArcLength(), {"reinflation": 4, "verification": 3}),
        (core.LineCycles(), {"decimation": 3}),
    ],
    ids=["a long way", "line cycles"],
)
def test_long_stages_can_be_cancelled_in_between(decimation: Any, least: dict[str, int]) -> None:
    turn = ring(1100)
    fine = Mesh.from_loops([turn * (1.0 + 0.2 * (turn[:, :1] * 20.0 % 1.0))])
    stages = [progress.stage for progress in NestedCagesRun(fine, [24], core.Settings(decimation=decimation))]
    assert {stage: stages.count(stage) >= count for stage, count in least.items()} == dict.fromkeys(least, True)


def test_progress_may_be_a_bar(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("tqdm")
    nested_cages(ring(60), 12, progress=True)
    assert "100%" in capsys.readouterr().err
    core.nested_cages_many([ring(60)], [12], progress=True)
    assert "100%" in capsys.readouterr().err
    nested_cages(ring(60), 12, progress=False)
    assert capsys.readouterr() == ("", "")


CLOCK = """
import itertools, json, sys, time
now = [0.0]
time.perf_counter = time.monotonic = lambda: now[0]
import numpy as np
from nestedcages_core import (
    DetectSymmetry, NestedCagesError, Within, check, inner_cages, nested_cages, verify, verify_motion)
from support.shapes import star

fresh = itertools.count()

def asked(work, levels, tick, **options):
    "The outcome of a run whose clock goes on by tick(number, progress) at each report, and its reports."
    seen, fine = [], star(9, 180)
    fine = fine.moved(fine.vertices * (1.0 + 1e-3 * next(fresh))).validated()

    def listen(progress):
        now[0] += tick(len(seen), progress)
        seen.append(progress.stage)

    try:
        made = work(fine, levels, progress=listen, **options)
    except NestedCagesError as error:
        data = {name: error.data.get(name) for name in ("level", "stage", "seconds")}
        return {"code": error.code, **data, "partial": told(error.partial)}, seen
    return {"levels": told(made)}, seen

def told(levels):
    return [{
        "notes": [note.code for note in each.report.notes],
        "excess": each.side * each.excess,
        "holds": bool(check(each.fine, each)) and bool(verify_motion(
            each.cage, each.fine, each.reinflation.cage_steps, each.reinflation.fine_steps)),
    } for each in levels]

works = {"around": nested_cages, "inside": inner_cages}
kind, options = sys.argv[1], json.loads(sys.argv[2])
if kind == "levels":
    print(json.dumps([
        asked(nested_cages, [8, 6, 4], lambda k, p: float(p.level > 0), seconds=1.0)[0],
        asked(nested_cages, [12, 6], lambda k, p: 9.0 * (p.stage == "tightening"), seconds=1.0)[0],
        *(asked(nested_cages, 8, lambda k, p: 0.3, seconds=0.5, **needs)[0]
          for needs in ({"grid": 0.01}, {"symmetry": DetectSymmetry()}, {"stored": np.float32})),
        asked(inner_cages, Within(excess=0.5), lambda k, p: 0.3, seconds=0.5)[0],
    ]))
else:
    whole, stages = asked(works[kind], 8, lambda k, p: 0.0, **options)
    late = [(last, asked(works[kind], 8, lambda k, p: 9.0 * (k == last), seconds=1.0, **options)[0])
            for last, stage in enumerate(stages) if last % 3 == 0 or stage == "tightening"]
    print(json.dumps([whole, stages, late]))
"""


def clocked(kind: str, options: dict[str, Any] | None = None) -> Any:
    """What the program with a clock of its own prints."""
    done = subprocess.run(
        [sys.executable, "-c", CLOCK, kind, json.dumps(options or {})],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests")])},
        capture_output=True,
        text=True,
        check=False,
        timeout=150,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.slow
def test_levels_made_in_time_are_kept() -> None:
    during_2, after_1, *others = clocked("levels")
    assert (during_2["code"], during_2["level"], during_2["seconds"]) == ("time.over", 1, 1.0)
    assert [level["holds"] for level in during_2["partial"]] == [True]
    # the first level is kept with a note, then comes the error: the hierarchy is not shorter in silence
    assert (after_1["code"], after_1["level"]) == ("time.over", 1)
    assert [level["notes"] for level in after_1["partial"]] == [["note.time"]]
    for other in others:  # needs and tolerances take their time too
        if "code" in other:
            assert (other["code"], other["level"], other["partial"]) == ("time.over", 0, [])
        else:
            assert ["note.time" in level["notes"] for level in other["levels"]] == [True]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("around", {"convex": True}),
        ("around", {}),
        ("inside", {}),
        *(pytest.param("around", kept, marks=pytest.mark.thorough) for kept in ({"stored": "float32"}, {"grid": 0.02})),
    ],
    ids=["convex", "around", "inside", "stored", "grid"],
)
def test_the_best_cage_by_then_is_kept(kind: str, options: dict[str, Any]) -> None:
    """Time ends during each stage and each step of the tightening in turn: a cage, or an error where none is."""
    whole, stages, late = clocked(kind, options)
    kept = 0
    for last, outcome in late:
        if "code" in outcome:
            assert outcome["code"] == "time.over"
            assert outcome["stage"] == stages[last] != "verification"
            assert not kept  # none before it, but always one after it
            continue
        (level,) = outcome["levels"]
        assert level["holds"]
        assert level["excess"] >= whole["levels"][0]["excess"] - 1e-6
        assert "note.time" in level["notes"] or set(stages[last + 1 :]) <= {"verification"}
        kept += level["notes"].count("note.time")
    assert kept


def test_time_that_is_over_at_once_is_an_error_and_enough_time_changes_nothing() -> None:
    with rejected("time.over", level=0) as caught:
        nested_cages(changed(star(), 30), 8, seconds=1e-9)
    assert not isinstance(caught.value, core.NestingError) and len(caught.value.partial) == 0
    limited, free = nested_cages(star(5, 50), 8, seconds=1e6), nested_cages(star(5, 50), 8)
    assert np.array_equal(limited.cages[0].vertices, free.cages[0].vertices)
