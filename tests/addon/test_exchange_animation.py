"""Alembic and glTF carry the animation: out, back in, and compared with what was seen, frame by frame."""

from __future__ import annotations

import addon_utils
import bpy
import numpy as np
import pytest

from support.drawings import at_frame, choose, circle, evaluated, facts, in_world, poly_curve, star
from support.marks import slow_after

# Frames at which a step is shown, and frames between two steps.
PER_STEP = 3


@pytest.fixture
def cages():
    """A drawing with a hole and two cages with their animation."""
    poly_curve("Drawing", [star(), circle(20, 0.4)])
    assert bpy.ops.object.nested_cages_generate(levels="24, 12", frames_per_step=PER_STEP) == {"FINISHED"}
    collection = bpy.data.collections["Drawing Cages"]
    return sorted(collection.objects, key=lambda obj: facts(obj)["level"])


def seen(objects, frames):
    """Points of the objects by name and frame where they are shown."""
    found = {}
    for frame in frames:
        depsgraph = at_frame(frame)
        for obj in objects:
            if not obj.hide_viewport:
                found[obj.name, frame] = in_world(obj, evaluated(obj, depsgraph))
    return found


def animated_faces(cages):
    choose(*cages)
    assert bpy.ops.object.nested_cages_to_objects(shape="ANIMATED") == {"FINISHED"}
    return sorted(bpy.context.selected_objects, key=lambda obj: obj.name)


def frames_to_compare():
    return np.linspace(1, bpy.context.scene.frame_end, 30).round().astype(int)


@pytest.mark.slow
def test_animated_faces_move_as_the_cages_do(cages) -> None:
    made = animated_faces(cages)
    for frame in frames_to_compare():
        depsgraph = at_frame(frame)
        for obj, cage in zip(made, sorted(cages, key=lambda obj: obj.name), strict=True):
            if not cage.hide_viewport:
                np.testing.assert_array_equal(evaluated(obj, depsgraph), evaluated(cage, depsgraph))
            assert not obj.hide_viewport and not obj.hide_render
            assert len(obj.data.polygons) > 0
            assert not any(name.startswith("nested_cages_") for name in obj.keys())  # noqa: SIM118


def test_still_objects_are_no_animated_faces() -> None:
    poly_curve("Drawing", [star()])
    with pytest.raises(RuntimeError, match="'Drawing' is not an animated cage"):
        bpy.ops.object.nested_cages_to_objects(shape="ANIMATED")


@pytest.mark.slow
def test_alembic_carries_the_animation(cages, tmp_path) -> None:
    made = animated_faces(cages)
    frames = frames_to_compare()
    expected = seen(made, frames)
    path, last = str(tmp_path / "cages.abc"), bpy.context.scene.frame_end
    bpy.ops.wm.alembic_export(filepath=path, start=1, end=last, selected=True, as_background_job=False)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.alembic_import(filepath=path, as_background_job=False)
    assert bpy.context.scene.frame_end >= last
    by_name = {obj.name.replace("_", " "): obj for obj in bpy.data.objects if obj.type == "MESH"}
    assert len(by_name) == 3, by_name
    for (name, frame), points in expected.items():
        obj = by_name.get(name) or pytest.fail(f"{name} is not in {by_name}")
        found = in_world(obj, evaluated(obj, at_frame(frame)))
        np.testing.assert_allclose(found, points, rtol=0.0, atol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("faces", slow_after(1, [False, True]))
def test_gltf_carries_the_animation_as_morph_targets(cages, tmp_path, faces) -> None:
    """Lone edges become lines, and faces triangles; either has a morph target for each step. What is hidden on the
    first frame is left out, so of the cages themselves only the fine mesh goes.
    """
    made = animated_faces(cages) if faces else cages[:1]
    choose(*made)
    frames = frames_to_compare()
    expected = seen(made, frames)
    path = str(tmp_path / "cages.glb")
    addon_utils.enable("io_scene_gltf2")
    bpy.ops.export_scene.gltf(
        filepath=path,
        use_selection=True,
        use_mesh_edges=True,
        export_animation_mode="ACTIVE_ACTIONS",
        export_optimize_animation_size=False,
    )
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils.enable("io_scene_gltf2")
    bpy.ops.import_scene.gltf(filepath=path)
    by_name = {obj.name: obj for obj in bpy.data.objects if obj.type == "MESH"}
    for (name, frame), points in expected.items():
        obj = by_name.get(name) or pytest.fail(f"{name} is not in {by_name}")
        found = in_world(obj, evaluated(obj, at_frame(frame)))
        gaps = np.linalg.norm(found[:, None] - points[None], axis=2)
        assert gaps.min(axis=0).max() < 1e-4, (name, frame)
        assert gaps.min(axis=1).max() < 1e-4, (name, frame)
