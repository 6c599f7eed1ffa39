"""How the package is used from Python: plain arrays, a single level, settings as keywords, pictures, writers."""

from __future__ import annotations

import builtins
import json
import re
import xml.etree.ElementTree as ET
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from nestedcages_core import (
    Hierarchy,
    Level,
    Mesh,
    NestedCagesError,
    NestingError,
    Progress,
    Settings,
    Share,
    Within,
    animated_cages,
    from_geojson,
    from_svg,
    inner_cages,
    nested_cages,
    nested_cages_many,
    to_engine_json,
    to_geojson,
    to_svg,
)
from nestedcages_core.geometry.drawable import Drawable
from nestedcages_core.hierarchy import in_order
from nestedcages_core.hierarchy.keywords import SettingsKeywords
from support.shapes import ring

OUTER, HOLE = ring(60, 1.0), ring(20, 0.4)


@pytest.fixture(scope="module")
def hierarchy() -> Hierarchy:
    return nested_cages([OUTER, HOLE], [24, 12], clearance=0.01)


@pytest.mark.parametrize("shape", [OUTER, OUTER.tolist(), tuple(map(tuple, OUTER)), [OUTER], OUTER[None]])
def test_a_single_loop_is_a_shape(shape: Any) -> None:
    assert Mesh.of(shape) == Mesh.from_loops([OUTER])


@pytest.mark.parametrize(
    "level", [12, np.int64(12), Mesh.from_loops([ring(12, 1.5)]), ring(12, 1.5), Within(excess=0.2)]
)
def test_a_single_level_needs_no_list(level: Any) -> None:
    alone = nested_cages(OUTER, level)
    assert alone[0].cage == nested_cages(OUTER, [level])[0].cage


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("20%", Share(0.2)),
        ("0.2u", Within(distance=0.2)),
        ("0.2px", Within(distance=0.2)),
        ("+25%", Within(excess=0.25)),
        ("24", 24),
        ("24, 12", [24, 12]),
        (["20%", 9], [12, 9]),
    ],
)
def test_levels_can_be_texts_as_in_the_command(text: Any, same: Any) -> None:
    make = inner_cages if text == "24" else nested_cages
    assert make(OUTER, text).cages == make(OUTER, same).cages


def test_texts_that_are_no_levels_are_told() -> None:
    with pytest.raises(NestingError, match=r"'5mm' is none of these\. Coordinates have no mm here; 5u is 5"):
        nested_cages(OUTER, "5mm")
    with pytest.raises(NestingError, match="A level is a number of vertices such as 24, a share of them such as 8%"):
        nested_cages(OUTER, [24, ""])
    poses = np.stack([OUTER, OUTER + 0.1])
    assert len(animated_cages(OUTER, poses, "20%").levels[0].cage.vertices) == 12


@pytest.mark.parametrize(
    ("given", "counts"), [([12, 24], [24, 12]), (["20%", 24, "10%"], [24, 12, 6]), ([24, 24], [24, 24])]
)
def test_counts_in_any_order_are_made_finest_first(given: list[Any], counts: list[int]) -> None:
    assert [len(cage.vertices) for cage in nested_cages(OUTER, given).cages] == counts


def test_levels_that_cannot_be_compared_stay_in_order() -> None:
    coarse = Mesh.from_loops([ring(12, 1.5)])
    for levels in ([24, coarse, 48], [24, Within(distance=0.2)], [True, 3]):
        assert in_order(levels, 60) == levels
    assert in_order([Within(excess=0.5), Within(excess=0.1)]) == [Within(excess=0.1), Within(excess=0.5)]
    assert in_order([Share(0.1), Share(0.5)]) == [Share(0.5), Share(0.1)]
    assert in_order([24, Share(0.5)]) == [24, Share(0.5)]


def test_settings_can_be_keywords() -> None:
    assert nested_cages(OUTER, 12, clearance=0.02)[0].report.wanted_clearance == 0.02
    both = nested_cages(OUTER, 12, Settings(clearance=0.02, grid=0.001), clearance=0.03)
    assert (both[0].report.wanted_clearance, both[0].report.grid) == (0.03, 0.001)
    assert inner_cages(OUTER, 12, clearance=0.02)[0].excess < 0.0
    gone, misspelt = {"starts": 3}, {"clearence": 0.02}
    with pytest.raises(TypeError, match=r"There is no setting 'starts'; see help\(Settings\)"):
        nested_cages(OUTER, 12, **gone)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="There is no setting 'clearence'; did you mean 'clearance'"):
        nested_cages(OUTER, 12, **misspelt)  # type: ignore[arg-type]
    told = {name: hint.__forward_arg__ for name, hint in SettingsKeywords.__annotations__.items()}
    assert told == {each.name: each.type for each in fields(Settings)}


def test_help_describes_every_setting() -> None:
    told = dict(
        re.findall(r"^ {8}(\w+): (.*?)(?=^ {8}\w+: |\Z)", Settings.__doc__ or "", flags=re.MULTILINE | re.DOTALL)
    )
    assert told.keys() == {each.name for each in fields(Settings)}
    assert [name for name, words in told.items() if "Default:" not in words] == []


def test_a_level_is_a_geometry() -> None:
    shapely = pytest.importorskip("shapely")
    level = nested_cages(OUTER, 12)[0]
    assert shapely.geometry.shape(level).equals(shapely.geometry.shape(level.cage))
    assert Mesh.of(level) == level.cage
    with pytest.raises(NestedCagesError, match="settings must be Settings"):
        nested_cages(OUTER, 12, 0.02)  # type: ignore[arg-type]


def test_a_hierarchy_is_a_sequence_of_levels(hierarchy: Hierarchy) -> None:
    first, second = hierarchy
    assert len(hierarchy) == 2
    assert hierarchy[-1] is second is hierarchy.levels[1]
    assert hierarchy[:1] == (first,)
    assert first in hierarchy
    assert isinstance(first, Level)
    assert first.vertices is first.cage.vertices
    assert first.excess == first.report.excess
    assert repr(hierarchy).startswith("Hierarchy(80 vertices; cages: 24 vertices, excess ")
    assert repr(second).startswith("Level(12 vertices, excess ")
    assert max(len(repr(hierarchy)), len(repr(second))) < 120


def test_meshes_are_equal_by_value() -> None:
    mesh, again = (Mesh.from_loops([OUTER, HOLE]) for _ in range(2))
    assert mesh == again
    assert len({mesh, again}) == 1
    assert mesh != Mesh.from_loops([HOLE, OUTER])
    assert mesh != mesh.moved(mesh.vertices + 1e-12)
    assert mesh != "mesh"
    assert [len(loop) for loop in mesh.rings] == [60, 20]
    np.testing.assert_allclose(mesh.bounds, (-1.0, -1.0, 1.0, 1.0), atol=0.01)
    assert repr(mesh) == "Mesh(80 vertices, 2 loops)"


def test_every_writer_takes_every_result(hierarchy: Hierarchy) -> None:
    level = hierarchy[0]
    assert to_svg(hierarchy) == to_svg([hierarchy.fine, *hierarchy.cages])
    assert to_svg(level) == to_svg([level.fine, level.cage])
    assert from_svg(to_svg(level.cage)) == level.cage
    assert len(json.loads(to_geojson(hierarchy))["features"]) == 3
    assert from_geojson(to_geojson(level.cage)).has_loops_like(level.cage)
    assert from_svg(to_svg(OUTER)) == from_geojson(to_geojson(OUTER)) == Mesh.of(OUTER)
    assert to_engine_json([OUTER, HOLE]) == to_engine_json(hierarchy.fine)
    assert to_engine_json(hierarchy) == to_engine_json(hierarchy[-1].cage) == to_engine_json(hierarchy[-1])


@pytest.mark.slow
def test_results_have_pictures(hierarchy: Hierarchy) -> None:
    poses = np.stack([OUTER * (1.0 + 0.1 * k) for k in range(6)])
    moving = animated_cages(OUTER, poses, 12, clearance=0.01)
    shown: dict[Drawable, int] = {hierarchy: 3, hierarchy[0]: 2, hierarchy.fine: 1, moving: 8}
    for result, paths in shown.items():
        root = ET.fromstring(result._repr_svg_())
        drawn = root.findall(".//{*}path")
        assert len(drawn) == paths
        assert all("nan" not in path.attrib["d"] for path in drawn)


def test_the_picture_of_a_motion_shows_the_poses() -> None:
    poses = np.stack([OUTER, OUTER + 5.0])
    moving = animated_cages(OUTER, poses, 12)
    first, last = moving.frames
    assert first[0] == Mesh.from_loops([OUTER])
    np.testing.assert_array_equal(last[0].vertices, poses[1])


@pytest.mark.slow
def test_results_plot_themselves(hierarchy: Hierarchy, monkeypatch: pytest.MonkeyPatch) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = hierarchy.plot()
    assert len(axes.patches) == 6
    assert hierarchy[0].plot(axes) is axes
    assert len(axes.patches) == 10
    low, high = axes.get_xlim()
    assert low < hierarchy[-1].cage.bounds[0] < hierarchy[-1].cage.bounds[2] < high
    monkeypatch.setattr(builtins, "__import__", _without("matplotlib"))
    with pytest.raises(NestedCagesError, match="Plots need matplotlib"):
        hierarchy.plot()


def test_progress_may_be_a_bar_or_a_function(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    told: list[Progress] = []
    nested_cages(OUTER, 12, progress=told.append)
    assert told
    with_bar = nested_cages(OUTER, 12, progress=True)
    pytest.importorskip("tqdm")
    assert "100%" in capsys.readouterr().err
    with pytest.raises(NestedCagesError, match="progress must be True or a function, not 'yes'"):
        nested_cages(OUTER, 12, progress="yes")  # type: ignore[arg-type]
    nested_cages_many([OUTER], [12], progress=True)
    assert "1 of 1 shapes: 100%" in capsys.readouterr().err
    monkeypatch.setattr(builtins, "__import__", _without("tqdm"))
    assert nested_cages(OUTER, 13, progress=True)[0].cage == nested_cages(OUTER, 13)[0].cage != with_bar[0].cage
    assert "  0 %  Level 1" in capsys.readouterr().err


def _without(library: str) -> Any:
    """The import function, as if a library were not installed."""
    real = builtins.__import__

    def imported(name: str, *args: Any, **options: Any) -> Any:
        if name.partition(".")[0] == library:
            raise ImportError(f"No module named {name!r}")
        return real(name, *args, **options)

    return imported
