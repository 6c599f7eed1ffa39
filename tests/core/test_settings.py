"""The choices of a run: as an object or as keywords, checked when they are made, described in the help."""

import re
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import IPC, Area, AxisAligned, Box, LeastAngle, LeastEdge, LineCycles, Settings, nested_cages
from support.judging import rejected
from support.shapes import annulus, letter_a, ring, star

OUTER = ring(60)
NO_LENGTHS = (-1.0, np.nan, np.inf, "1", [0.1], -np.inf, None)


def test_settings_can_be_keywords() -> None:
    assert nested_cages(OUTER, 12, clearance=0.02)[0].report.wanted_clearance == 0.02
    both = nested_cages(OUTER, 12, Settings(clearance=0.02, grid=0.001), clearance=0.03)
    assert (both[0].report.wanted_clearance, both[0].report.grid) == (0.03, 0.001)
    assert core.inner_cages(OUTER, 12, clearance=0.02)[0].excess < 0.0
    assert Settings.of(Settings(grid=0.1), loops="keep") == Settings(grid=0.1, loops="keep")
    assert Settings.of(None) == Settings()


@pytest.mark.parametrize("name", ["starts", "clearence"])
def test_settings_that_there_are_not_are_refused(name: str) -> None:
    with pytest.raises(TypeError):
        nested_cages(OUTER, 12, **{name: 3})  # type: ignore[arg-type]


def test_help_describes_every_setting() -> None:
    told = dict(
        re.findall(r"^ {8}(\w+): (.*?)(?=^ {8}\w+: |\Z)", Settings.__doc__ or "", flags=re.MULTILINE | re.DOTALL)
    )
    assert told.keys() == {each.name for each in fields(Settings)}
    assert [name for name, words in told.items() if "Default:" not in words] == []


REFUSED: list[dict[str, Any]] = [
    {"energy": "area"}, {"energy": Area}, {"decimation": "hull"}, {"fallback": 7}, {"flow": None},
    {"tightening": False}, {"contact": IPC}, {"contact": []}, {"contact": "IPC"}, {"symmetry": 3},
    *({name: value} for name in ("clearance", "grid", "seconds", "min_edge")
      for value in NO_LENGTHS if value is not None),
    {"grid": 0.0}, {"seconds": 0.0}, {"min_edge": 0.0},
    {"min_angle": 0.0}, {"min_angle": 60.0}, {"min_angle": "1"}, {"min_angle": np.nan},
    {"stored": "int8"}, {"stored": "no type"}, {"about": 3}, {"convex": 1}, {"loops": "all"}, {"constraints": 3},
    {"constraints": [Box]}, {"constraints": ["box"]},
    {"weights": [1.0, -1.0]}, {"weights": [0.0, 0.0]}, {"weights": [np.nan]}, {"weights": "many"}, {"weights": 1.0},
    {"pins": 3}, {"pins": [(1.0, 2.0, 3.0)]}, {"pins": [True]}, {"pins": [(np.nan, 0.0)]},
    {"pins": ["corner"]}, {"pins": [(1.0,)]}, {"joints": [3]}, {"joints": [(0.0, np.inf)]}, {"joints": None},
    {"symmetry": core.Mirror},
]  # fmt: skip
CONFLICTS: list[dict[str, Any]] = [
    {"convex": True, "pins": [0]}, {"convex": True, "joints": [(0.0, 0.0)]}, {"convex": True, "min_edge": 0.1},
    {"loops": "one", "convex": True}, {"loops": "one", "weights": [1.0]}, {"loops": "one", "min_angle": 20.0},
    {"convex": True, "min_angle": 20.0}, {"loops": "one", "pins": [0]},
]  # fmt: skip


BY_CODE = [*(("setting.invalid", each) for each in REFUSED), *(("setting.conflict", each) for each in CONFLICTS)]


@pytest.mark.parametrize(("code", "choice"), BY_CODE, ids=str)
def test_settings_that_make_no_sense_are_refused_when_they_are_made(code: str, choice: dict[str, Any]) -> None:
    with rejected(code):
        Settings(**choice)


@pytest.mark.parametrize(
    "choice",
    [
        {"clearance": 0.0}, {"clearance": np.float32(1.0)}, {"stored": np.float16},
        {"stored": "float64"}, {"stored": np.dtype("float32")}, {"pins": [np.int64(1), (0.0, 1.0)]},
        {"min_angle": 59.9}, {"contact": [IPC()]}, {"fallback": None}, {"weights": np.ones(3)},
    ],
    ids=str,
)  # fmt: skip
def test_settings_that_make_sense_are_taken(choice: dict[str, Any]) -> None:
    assert Settings(**choice) == Settings(**choice)


def test_settings_that_a_shape_does_not_bear_are_refused() -> None:
    for choice, code, data in (
        ({"clearance": 1e200}, "clearance.too_large", {"wanted": 1e200}),
        ({"about": letter_a()}, "coarse.not_nested", {}),
        ({"weights": [1.0]}, "priorities.mismatch", {"given": 1, "available": 60}),
        ({"pins": [60]}, "priorities.mismatch", {"given": 60, "available": 60}),
    ):
        with rejected(code, **data):
            nested_cages(star(5, 60), [12], **choice)
    with rejected("setting.invalid"):
        nested_cages(OUTER, 12, 0.02)  # type: ignore[arg-type]


OBSTACLE = core.Mesh.from_loops([0.1 * ring(9) + (1.2, 0.1)])
PARTS: list[tuple[Any, list[tuple[Any, ...]], list[tuple[Any, ...]]]] = [
    (LeastEdge, [(0.0,), (np.inf,), (np.nan,), ("1",), (-1.0,)], [(1e-3,)]),
    (LeastAngle, [(0.0,), (60.0,), (60.5,), ("1",), (np.nan,)], [(0.5,), (59.5,)]),
    (AxisAligned, [((),), ((0.0,),), ((10.0, 190.0),), ((np.nan, 1.0),), ((0.0, 181.0),), ((0.0, 180.0),),
                   ((0.0, 3.0),), (("a", 1.0),), (7.0,)], [((180.0, 90.0),)]),
    (Box, [((0.0, 0.0), (0.0, 1.0)), ((0.0, 0.0), (1.0, -1.0)), ((np.nan, 0.0), (1.0, 1.0)), ((0.0,), (1.0, 1.0)),
           (("a", 0.0), (1.0, 1.0))], [((0.0, 0.0), (1.0, 0.5))]),
    (core.LoopClearance, [(-1.0,), (0.5, -0.5), (np.inf,), (0.0, np.inf), (0.0, 0.0, (-1.0,)), (0.0, 0.0, (0.1, "a"))],
     [(0.5,), (0.0, 0.5), (0.0, 0.0, (1, 2.0))]),
    (core.Within, [(), (0.5, 0.5), *((wrong,) for wrong in (0.0, -1.0, np.inf, np.nan, True, "1")),
                   *((None, wrong) for wrong in (0.0, -1.0, np.inf, np.nan, True, "1"))], [(0.5,), (None, 0.5)]),
    (LineCycles, [(1,)], [()]),
    (core.Outside, [(OBSTACLE, -0.5), (OBSTACLE, np.inf)], [(OBSTACLE,), (OBSTACLE, 0.5)]),
    (core.Mirror, [((0.0, np.nan),), ((0, 0), (0, 0)), ("up",)], [(), (None,)]),
    (core.Rotation, [((0, 0), 1)], [(None, 2)]),
    (core.DetectSymmetry, [(-1.0,)], [()]),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "refused", "taken"), PARTS, ids=lambda part: getattr(part, "__name__", ""))
def test_parts_of_settings_check_their_numbers(kind: Any, refused: Any, taken: Any) -> None:
    for given in taken:
        assert kind(*given)
    for given in refused:
        with rejected("setting.invalid"):
            kind(*given)


def test_a_setting_has_its_effect_on_the_report() -> None:
    (level,) = nested_cages(annulus(24), 12, grid=0.01, stored=np.float32, clearance=0.02)
    report = level.report
    assert (report.grid, report.stored, report.wanted_clearance) == (0.01, "float32", 0.02)
    assert set(report.seconds) >= {"decimation", "tightening", "verification"}
    assert all(seconds >= 0.0 for seconds in report.seconds.values())
    assert report.iterations["tightening"] > 0
