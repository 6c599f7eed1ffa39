"""Cages as animated faces, which Alembic and glTF carry out and back in, and as convex pieces that tile them."""

from itertools import combinations

import addon_utils
import bpy
import numpy as np
import pytest
import shapely

from support.blender import new_file
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


@pytest.mark.parametrize("most", [3, 8])
def test_pieces_tile_the_coarsest_cage_of_a_drawing(most) -> None:
    obj = poly_curve("Drawing", [star(), circle(30, 0.3)])
    obj.location, obj.rotation_euler.z = (3.0, -2.0, 1.0), 0.5
    generate("40, 24")
    cage = bpy.data.objects["Drawing Cage 2"]
    shape = solid(cage, at_frame(9000))
    choose(obj)
    assert bpy.ops.object.nested_cages_to_objects(shape="PIECES", pieces=most) == {"FINISHED"}
    made = list(bpy.data.collections["Drawing Cage 2 Pieces"].objects)
    assert sorted(bpy.context.selected_objects, key=id) == sorted(made, key=id)
    polygons = []
    for piece in made:
        (face,) = piece.data.polygons
        assert 3 <= len(face.vertices) <= most
        assert face.normal.z > 0.99
        polygons.append(shapely.Polygon([tuple(vertex.co)[:2] for vertex in piece.data.vertices]))
        assert polygons[-1].convex_hull.area == pytest.approx(polygons[-1].area, rel=1e-6)
    bpy.context.view_layer.update()
    assert all(piece.matrix_world == obj.matrix_world for piece in made)
    assert shapely.union_all(polygons).symmetric_difference(shape).area < 1e-6
    assert sum(polygon.area for polygon in polygons) == pytest.approx(shape.area, rel=1e-6)
    assert max(one.intersection(other).area for one, other in combinations(polygons, 2)) < 1e-9
    assert (len(made) == len(cage.data.vertices)) == (most == 3)  # a triangle per vertex where there is one hole


def test_pieces_of_any_outlines_are_in_collections_of_their_own() -> None:
    outlines = [poly_curve("One", [circle(20)]), poly_curve("Two", [circle(7, 2.0)])]
    outlines[0].rotation_euler.x = 1.0
    choose(*outlines)
    assert bpy.ops.object.nested_cages_to_objects(shape="PIECES") == {"FINISHED"}
    bpy.context.view_layer.update()
    for outline, count in zip(outlines, (4, 1), strict=True):
        pieces = list(bpy.data.collections[f"{outline.name} Pieces"].objects)
        assert 1 <= len(pieces) <= count and all(piece.matrix_world == outline.matrix_world for piece in pieces)


def test_geojson_has_pieces(tmp_path, core) -> None:
    poly_curve("Drawing", [star(), circle(30, 0.3)])
    path = tmp_path / "outline.geojson"
    options = {"filepath": str(path), "kind": "GEOJSON", "scale": 10.0}
    for asked, most in ((6, 6), (1, 3)):
        bpy.ops.object.nested_cages_export(**options, pieces=asked)
        outline, *pieces = core.features_from_geojson(path.read_bytes())
        assert max(len(each.mesh.vertices) for each in pieces) <= most
        assert sum(each.mesh.area for each in pieces) == pytest.approx(outline.properties["area"])
        assert [each.properties["piece"] for each in pieces] == [*range(1, len(pieces) + 1)]
    assert bpy.ops.object.nested_cages_import(filepath=str(path)) == {"FINISHED"}
    assert len(bpy.context.selected_objects) == 1
    bpy.ops.object.nested_cages_export(**options)
    assert len(core.features_from_geojson(path.read_bytes())) == 1
