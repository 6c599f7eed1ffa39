"""Convex pieces of cages: they tile them, in the scene, as rigid bodies and in collision outlines."""

from itertools import combinations

import bpy
import numpy as np
import pytest
import shapely
from mathutils import Euler

from support.drawings import at_frame, choose, circle, generate, poly_curve, solid, star, world


@pytest.mark.parametrize("most", [3, 8])
def test_pieces_tile_the_coarsest_cage_of_a_drawing(most) -> None:
    obj = poly_curve("Drawing", [star(), circle(30, 0.3)])
    obj.location, obj.rotation_euler.z = (3.0, -2.0, 1.0), 0.5
    generate("40, 24")
    cage = bpy.data.objects["Drawing Cage 2"]
    shape = solid(cage, at_frame(9000))
    choose(obj)
    assert bpy.ops.object.nested_cages_pieces(most=most) == {"FINISHED"}
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


def test_pieces_of_any_outline_with_a_height() -> None:
    outlines = [poly_curve("One", [circle(20)]), poly_curve("Two", [circle(7, 2.0)])]
    for obj in outlines:
        obj.select_set(True)
    assert bpy.ops.object.nested_cages_pieces(most=8, height=0.5) == {"FINISHED"}
    for name, count in (("One", 4), ("Two", 1)):
        pieces = list(bpy.data.collections[f"{name} Pieces"].objects)
        assert len(pieces) <= count
        for piece in pieces:
            z = world(piece)[:, 2]
            assert (z.min(), z.max()) == (-0.25, 0.25)
            edges = [tuple(sorted(key)) for face in piece.data.polygons for key in face.edge_keys]
            assert all(edges.count(edge) == 2 for edge in edges)
            centre = world(piece).mean(axis=0)
            for face in piece.data.polygons:
                assert (np.array(face.center) - centre) @ np.array(face.normal) > 0.0


def test_passive_pieces_are_convex_bodies() -> None:
    obj = poly_curve("Drawing", [star(60, 0.3)])
    obj.rotation_euler = Euler((np.pi / 2, 0.0, 0.0))
    bpy.context.view_layer.update()
    assert bpy.ops.object.nested_cages_pieces(body="PASSIVE") == {"FINISHED"}
    pieces = list(bpy.data.collections["Drawing Pieces"].objects)
    assert {(piece.rigid_body.type, piece.rigid_body.collision_shape) for piece in pieces} == {
        ("PASSIVE", "CONVEX_HULL")
    }


def test_an_active_body_falls_as_one_with_its_pieces() -> None:
    """A ring of pieces falls over a post that fits its hole: its shape is hollow."""
    obj = poly_curve("Ring", [circle(24, 1.0, (4.0, 0.0)), circle(24, 0.6, (4.0, 0.0))])
    obj.location.x = -4.0
    bpy.context.view_layer.update()
    assert bpy.ops.object.nested_cages_pieces(body="ACTIVE", height=0.2) == {"FINISHED"}
    body = bpy.context.object
    assert body.name == "Ring Body"
    assert (body.rigid_body.type, body.rigid_body.collision_shape) == ("ACTIVE", "COMPOUND")
    bpy.context.view_layer.update()
    assert tuple(body.matrix_world.translation) == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)
    flat = np.unique(np.round(world(body), 5), axis=0)
    pieces = [piece for piece in bpy.data.collections["Ring Pieces"].objects if piece is not body]
    assert len(pieces) > 3
    assert np.allclose(np.unique(np.round(np.concatenate([world(piece) for piece in pieces]), 5), axis=0), flat)
    bpy.ops.mesh.primitive_cylinder_add(radius=0.3, depth=2.0, location=(0.0, 0.0, -1.5))
    bpy.ops.rigidbody.object_add(type="PASSIVE")
    for frame in range(1, 30):
        bpy.context.scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    place = body.evaluated_get(graph).matrix_world.translation
    assert place.z < -1.0
    assert abs(place.x) < 0.2
    assert pieces[0].evaluated_get(graph).matrix_world.translation.z < -1.0
    assert obj.evaluated_get(graph).matrix_world.translation.z == pytest.approx(place.z, abs=0.3)


def test_an_active_body_carries_the_drawing_and_its_cages() -> None:
    source = poly_curve("Drawing", [star()])
    source.location, source.rotation_euler = (1.0, 2.0, 0.5), (0.0, 0.0, 0.4)
    generate("20, 10")
    bpy.ops.object.nested_cages_remove_animation()  # hidden objects are not evaluated
    cage = bpy.data.objects["Drawing Cage 2"]
    choose(cage)
    bpy.context.view_layer.update()
    shown = {name: np.array(bpy.data.objects[name].matrix_world) for name in ("Drawing", "Drawing Cage 1", cage.name)}
    assert bpy.ops.object.nested_cages_pieces(body="ACTIVE") == {"FINISHED"}
    body = bpy.context.object
    bpy.context.view_layer.update()
    for name, place in shown.items():
        assert np.allclose(bpy.data.objects[name].matrix_world, place, atol=1e-6)
    for frame in range(1, 20):  # it falls
        bpy.context.scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    fallen = body.evaluated_get(graph).matrix_world.translation.z - 0.5
    assert fallen < -0.5
    for name, place in shown.items():
        height = bpy.data.objects[name].evaluated_get(graph).matrix_world.translation.z
        assert height == pytest.approx(place[2, 3] + fallen, abs=1e-3)


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
