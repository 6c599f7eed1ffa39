"""Handles move the corners of a bound cage, one each; only its outline is seen."""

import sys
from types import SimpleNamespace
from unittest.mock import MagicMock

import bpy
import gpu
import numpy as np
import pytest

from support.blender import refused
from support.drawings import choose, circle, evaluated, poly_curve, set_of, star


@pytest.fixture
def drawn(extension, monkeypatch):
    """What is drawn over a 3D view, where there is no graphics card: points by kind, lines by their two ends."""
    handlers, shown = [], []
    extension.unregister()
    with monkeypatch.context() as patched:
        patched.setattr(bpy.types.SpaceView3D, "draw_handler_add", lambda draw, *_: handlers.append(draw))
        patched.setattr(bpy.types.SpaceView3D, "draw_handler_remove", lambda *_: None)
        for name in ("types", "shader", "state"):
            patched.setattr(gpu, name, MagicMock())
        patched.setitem(sys.modules, "gpu.types", gpu.types)
        gpu.types.GPUBatch = lambda type, buf: SimpleNamespace(
            draw=lambda _, at=dict(call.args for call in buf.attr_fill.call_args_list)["pos"]: shown.append((type, at))
        )
        extension.register()

        def look(kind: str) -> np.ndarray:
            shown.clear()
            bpy.context.view_layer.update()
            (window,) = bpy.context.window_manager.windows
            view = next(area for area in window.screen.areas if area.type == "VIEW_3D")
            with bpy.context.temp_override(window=window, area=view):
                handlers[0]()
            return np.concatenate([np.zeros((0, 3)), *(points for each, points in shown if each == kind)])

        yield look
        extension.unregister()
    extension.register()


@pytest.fixture
def cage():
    """The coarsest cage of a bound drawing that is not at the origin."""
    drawing = poly_curve("Drawing", [star(), circle(12, 0.3)])
    drawing.location, drawing.rotation_euler = (2.0, 1.0, 0.5), (0.0, 0.0, 0.7)
    bpy.context.view_layer.update()
    bpy.ops.object.nested_cages_generate(levels="24, 12")
    assert bpy.ops.object.nested_cages_bind() == {"FINISHED"}
    return bpy.data.objects["Drawing Cage 2"]


@pytest.mark.slow
def test_each_handle_moves_its_corner_and_the_drawing_follows(cage) -> None:
    assert len(cage.data.polygons) and cage.display_type == "WIRE" and not cage.show_all_edges
    fine = set_of(cage).fine
    before, drawing = evaluated(cage), evaluated(fine)
    assert bpy.ops.object.nested_cages_puppet(source="HANDLES") == {"FINISHED"}
    assert bpy.context.mode == "POSE"
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    np.testing.assert_allclose(evaluated(cage), before, atol=1e-5)
    rig = next(modifier.object for modifier in cage.modifiers if modifier.type == "ARMATURE")
    assert len(rig.pose.bones) == len(before)
    corners = np.array([(cage.matrix_world.inverted() @ rig.matrix_world @ bone.head)[:] for bone in rig.pose.bones])
    np.testing.assert_allclose(corners, before, atol=1e-5)
    assert [len(group.bones) for group in rig.data.collections] == [len(before)]
    bone = rig.pose.bones[3]
    matrix = bone.matrix.copy()
    matrix.translation.x += 0.25
    bone.matrix = matrix
    bpy.context.view_layer.update()
    moved = evaluated(cage) - before
    np.testing.assert_allclose(moved[3], (0.25, 0.0, 0.0), atol=1e-5)
    np.testing.assert_allclose(np.delete(moved, 3, axis=0), 0.0, atol=1e-5)
    assert np.abs(evaluated(fine) - drawing).max() > 0.01


@pytest.mark.slow
def test_outlines_are_drawn_where_cages_are(drawn, cage) -> None:
    for off in (0.0, 1.0):
        cage.location.x += off
        ends = drawn("LINES")
        corners = np.array([cage.matrix_world @ vertex.co for vertex in cage.data.vertices])
        assert len(ends) == 2 * sum(len(each.data.vertices) for each in set_of(cage).cages)
        assert all(np.abs(ends - corner).max(axis=1).min() < 1e-5 for corner in corners)
    cage.hide_set(True)
    assert len(drawn("LINES")) == 2 * len(set_of(cage).cages[0].data.vertices)


@pytest.mark.slow
def test_handles_bind_and_are_added_once(cage) -> None:
    bpy.ops.object.nested_cages_bind(action="UNBIND")
    assert bpy.ops.object.nested_cages_puppet(source="HANDLES") == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    choose(cage)
    assert set_of(cage).bound
    with refused(f"'{cage.name}'"):
        bpy.ops.object.nested_cages_puppet(source="HANDLES")
