"""Cages as curves, faces, prisms, strokes and animated faces, which Alembic and glTF carry out and back in."""

import addon_utils
import bpy
import numpy as np
import pytest

from support.blender import new_file, refused
from support.drawings import at_frame, choose, circle, evaluated, generate, in_world, made, poly_curve, solid, star
from support.marks import slow_after

pytestmark = pytest.mark.slow

# Frames at which a step is shown, and frames between two steps.
PER_STEP = 3


@pytest.fixture
def playing():
    """The fine mesh and two cages of a drawing with a hole, with their animation."""
    poly_curve("Drawing", [star(), circle(20, 0.4)])
    generate("24, 12", frames_per_step=PER_STEP)
    return made()


def seen(objects, frames):
    """Points of the objects by name and frame where they are shown."""
    found = {}
    for frame in frames:
        depsgraph = at_frame(frame)
        for obj in objects:
            if not obj.hide_viewport:
                found[obj.name, frame] = in_world(obj, evaluated(obj, depsgraph))
    return found


def test_faces_fill_the_cage(cages) -> None:
    _, _, (inner, _) = cages
    choose(inner)
    assert bpy.ops.object.nested_cages_to_objects(shape="FILLED") == {"FINISHED"}
    new = bpy.context.active_object
    bpy.context.view_layer.update()
    assert new.matrix_world == inner.matrix_world
    assert sum(face.area for face in new.data.polygons) == pytest.approx(solid(inner).area, rel=1e-5)
    assert all(face.normal.z > 0.999 for face in new.data.polygons)


def test_prisms_are_closed_and_point_out(cages) -> None:
    _, _, both = cages
    choose(*both)
    assert bpy.ops.object.nested_cages_to_objects(shape="PRISM", height=1.0) == {"FINISHED"}
    for obj, new in zip(both, sorted(bpy.context.selected_objects, key=lambda obj: obj.name), strict=True):
        uses = np.zeros(len(new.data.edges), int)
        for corner in new.data.loops:
            uses[corner.edge_index] += 1
        assert (uses == 2).all()
        new.data.calc_loop_triangles()
        points = in_world(new, evaluated(new))
        triangles = points[[list(triangle.vertices) for triangle in new.data.loop_triangles]]
        volume = np.einsum("ij,ij->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6.0
        assert volume == pytest.approx(4.0 * solid(obj).area * 1.0, rel=1e-4)


def test_curves_have_the_cage_s_points(cages) -> None:
    _, _, (inner, _) = cages
    choose(inner)
    assert bpy.ops.object.nested_cages_to_objects(shape="CURVE") == {"FINISHED"}
    new = bpy.context.active_object
    bpy.context.view_layer.update()
    assert new.type == "CURVE"
    assert len(new.data.splines) == 2
    points = np.array([point.co[:3] for spline in new.data.splines for point in spline.points])
    np.testing.assert_array_equal(
        np.unique(in_world(new, points), axis=0), np.unique(in_world(inner, evaluated(inner)), axis=0)
    )


def test_cages_as_grease_pencil_strokes() -> None:
    poly_curve("Drawing", [star(), circle(12, 0.3)])
    generate("24")
    cage = bpy.data.objects["Drawing Cage 1"]
    choose(cage)
    if bpy.app.version < (4, 3):
        with refused():
            bpy.ops.object.nested_cages_to_objects(shape="GREASE_PENCIL")
        return
    assert bpy.ops.object.nested_cages_to_objects(shape="GREASE_PENCIL") == {"FINISHED"}
    new = bpy.context.object
    assert new.type == "GREASEPENCIL" and new.name == "Drawing Cage 1 Grease Pencil"
    strokes = new.data.layers[0].frames[0].drawing.strokes
    assert [stroke.cyclic for stroke in strokes] == [True, True]
    points = np.array([point.position[:] for stroke in strokes for point in stroke.points])
    home = np.array([key.co[:] for key in cage.data.shape_keys.key_blocks[0].data])
    assert {tuple(point) for point in points} == {tuple(point) for point in home}
    assert new.active_material.grease_pencil.color[:] == pytest.approx(cage.color[:])


def animated_faces(cages):
    choose(*cages)
    assert bpy.ops.object.nested_cages_to_objects(shape="ANIMATED") == {"FINISHED"}
    return sorted(bpy.context.selected_objects, key=lambda obj: obj.name)


def frames_to_compare():
    return np.linspace(1, bpy.context.scene.frame_end, 30).round().astype(int)


def test_animated_faces_move_as_the_cages_do(playing) -> None:
    shown = animated_faces(playing)
    for frame in frames_to_compare():
        depsgraph = at_frame(frame)
        for obj, cage in zip(shown, sorted(playing, key=lambda obj: obj.name), strict=True):
            if not cage.hide_viewport:
                np.testing.assert_array_equal(evaluated(obj, depsgraph), evaluated(cage, depsgraph))
            assert not obj.hide_viewport and not obj.hide_render
            assert len(obj.data.polygons) > 0
            assert not any(name.startswith("nested_cages_") for name in obj.keys())  # noqa: SIM118


@pytest.mark.parametrize("faces", slow_after(1, [False, True]))
def test_gltf_carries_the_animation_as_morph_targets(playing, tmp_path, faces) -> None:
    """Lone edges become lines, and faces triangles; either has a morph target for each step. What is hidden on the
    first frame is left out, so of the playing themselves only the fine mesh goes.
    """
    found = animated_faces(playing) if faces else playing[:1]
    choose(*found)
    frames = frames_to_compare()
    expected = seen(found, frames)
    path = str(tmp_path / "cages.glb")
    addon_utils.enable("io_scene_gltf2")
    bpy.ops.export_scene.gltf(
        filepath=path,
        use_selection=True,
        use_mesh_edges=True,
        export_animation_mode="ACTIVE_ACTIONS",
        export_optimize_animation_size=False,
    )
    new_file()
    addon_utils.enable("io_scene_gltf2")
    bpy.ops.import_scene.gltf(filepath=path)
    by_name = {obj.name: obj for obj in bpy.data.objects if obj.type == "MESH"}
    for (name, frame), points in expected.items():
        obj = by_name.get(name) or pytest.fail(f"{name} is not in {by_name}")
        there = in_world(obj, evaluated(obj, at_frame(frame)))
        gaps = np.linalg.norm(there[:, None] - points[None], axis=2)
        assert gaps.min(axis=0).max() < 1e-4, (name, frame)
        assert gaps.min(axis=1).max() < 1e-4, (name, frame)
