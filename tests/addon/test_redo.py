"""Redo computes only what has changed: what Blender does there is to undo the operator and to execute it anew."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Any

import bpy
import numpy as np
import pytest

from support.drawings import circle, facts, poly_curve, raised, star, wire
from support.marks import slow_after

Watch = Callable[[Any, str], list[Any]]


@pytest.fixture
def watch(monkeypatch: pytest.MonkeyPatch) -> Watch:
    """Makes a function note its calls in the list that is returned."""

    def watched(holder: Any, name: str) -> list[Any]:
        function, found = getattr(holder, name), []

        def noted(*arguments: Any, **options: Any) -> Any:
            found.append(arguments)
            return function(*arguments, **options)

        monkeypatch.setattr(holder, name, noted)
        return found

    return watched


def redo(operator: Callable[..., Any], first: dict[str, Any], *changes: dict[str, Any]) -> None:
    """Execute an operator; then, for each change, undo it and execute it anew."""
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="before")
    for change in ({}, *changes):
        if change:
            bpy.ops.ed.undo()
        assert operator(**{**first, **change}) == {"FINISHED"}
        bpy.ops.ed.undo_push(message="after")


NO_INPUT = (
    {"start_frame": 11},
    {"frames_per_step": 9},
    {"fit_length": True, "length": 40},
    {"show_flow": False},
    {"show_result": False},
    {"thickness": 0.02},
)


@pytest.mark.slow
@pytest.mark.parametrize("change", slow_after(3, NO_INPUT), ids=lambda change: next(iter(change)))
def test_animation_and_appearance_compute_nothing(runs, change) -> None:
    poly_curve("Drawing", [star(), circle(30, 0.3)])
    redo(bpy.ops.object.nested_cages_generate, {"levels": "24, 14", "clearance": 1e-3}, change)
    assert runs == [24, 14]


@pytest.mark.slow
def test_another_count_makes_its_level_and_those_around_it(runs) -> None:
    poly_curve("Drawing", [star()])
    changes = {"levels": "20, 12"}, {"levels": "20, 12, 6"}, {"levels": "18, 12"}, {"levels": "20, 10"}
    redo(bpy.ops.object.nested_cages_generate, {"levels": "20, 10"}, *changes)
    assert runs == [20, 10, 12, 6, 18, 12]


def test_another_energy_needs_the_same_coarse_meshes(core, watch) -> None:
    poly_curve("Drawing", [star()])
    searches = watch(core.LineCycles, "starts_keeping")
    cycles = watch(core.decimation.line_cycles.method, "cycles_around")
    redo(bpy.ops.object.nested_cages_generate, {"levels": "20"}, {"energy": "SHAPE_KEEPING"})
    assert len(searches) == 2
    assert len(cycles) == 1


@pytest.mark.slow
def test_advice_on_a_loose_cage_and_on_room_is_found_once(core, watch) -> None:
    poly_curve("Drawing", [star(120, 0.7, 9), circle(30, 0.1)])
    hulls, bounds = watch(core.OuterHull, "decimate"), watch(core.hierarchy, "tightest_place")
    first = {"levels": "8", "clearance": 1e-3, "loops": "keep"}
    redo(bpy.ops.object.nested_cages_generate, first, {"frames_per_step": 9})
    report = facts(bpy.data.objects["Drawing Cage 1"])["notes"]
    assert "vertices" in str(report) and "larger" in str(report)
    assert len({arguments[2] for arguments in hulls}) == len(hulls) > 0
    assert len(bounds) == 1


@pytest.mark.slow
def test_a_followed_animation_is_followed_once(core, watch) -> None:
    obj = wire("Drawing", [star()])
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Wide")
    key.points.foreach_set("co", (raised(star()) * (1.3, 1.0, 1.0)).astype(np.float32).ravel())
    for frame, value in ((1, 0.0), (7, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    moving, unions = watch(core, "AnimatedCagesRun"), watch(core, "swept")
    first = {"levels": "16, 10", "frame_start": 1, "frame_end": 7, "frame_step": 2}
    changes = {"thickness": 0.02}, {"levels": "16, 8"}, {"still": True}, {"still": True, "thickness": 0.02}
    redo(bpy.ops.object.nested_cages_follow, first, *changes)
    assert [arguments[2] for arguments in moving] == [[16], [10], [8]]
    assert len(unions) == 1


def test_pieces_are_cut_once(extension: ModuleType, watch) -> None:
    poly_curve("Drawing", [star()])
    cuts = watch(import_module(f"{extension.__name__}.nestedcages_core.geometry.triangulation"), "piece_vertices")
    redo(bpy.ops.object.nested_cages_pieces, {"most": 6}, {"height": 0.5}, {"body": "PASSIVE"}, {"most": 4})
    assert [most for _, most in cuts] == [6, 4]


@pytest.mark.slow
def test_what_is_bound_again_keeps_its_weights(core, watch) -> None:
    poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="20")
    assert bpy.ops.object.nested_cages_bind(method="HARMONIC") == {"FINISHED"}
    solved = watch(core.Harmonic, "weights")
    redo(bpy.ops.object.nested_cages_generate, {"levels": "20"}, {"frames_per_step": 9})
    assert len(solved) == 0


@pytest.mark.slow
def test_a_picture_is_traced_once(core, watch) -> None:
    image = bpy.data.images.new("Disc", 48, 48, alpha=True)
    y, x = np.mgrid[:48, :48] - 23.5
    pixels = np.ones((48, 48, 4), np.float32)
    pixels[..., 3] = np.hypot(x, y) < 18.0
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    traced = watch(import_module(f"{core.__name__}.exchange.pictures"), "picture_cages_run")
    first = {"image": image.name, "vertices": 12}
    redo(bpy.ops.object.nested_cages_from_image, first, {"padding": 2}, {"vertices": 10}, {"vertices": 12})
    assert len(traced) == 3
