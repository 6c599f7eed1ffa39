"""Cutouts: from a picture to a mesh that shows it and follows its cage."""

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
import shapely
from mathutils import Matrix

from support.blender import refused
from support.drawings import choose, evaluated, faces_of, image_empty, in_world, solid
from support.engines import read_godot, read_spine

pytestmark = pytest.mark.slow

WIDTH, HEIGHT = 96, 48


def opacity() -> Any:
    """(HEIGHT, WIDTH) an ellipse with a hole, the bottom row first."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    radius = np.hypot((x - 47.5) / 44.0, (y - 23.5) / 20.0)
    return ((radius < 1.0) & (radius > 0.3)).astype(np.float32)


def picture(name: str = "part.png", alpha: Any = None) -> Any:
    image = bpy.data.images.new(name, WIDTH, HEIGHT, alpha=True)
    pixels = np.ones((HEIGHT, WIDTH, 4), np.float32)
    pixels[:, :, 3] = opacity() if alpha is None else alpha
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    return image


def file_of(image: Any, folder: Path) -> Path:
    path = folder / image.name
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return path


def plane(image: Any) -> Any:
    bpy.ops.mesh.primitive_plane_add(size=2.0)
    obj = bpy.context.object
    obj.scale = (2.0, 1.0, 1.0)
    material = bpy.data.materials.new("Shown")
    if material.node_tree is None:
        material.use_nodes = True
    material.node_tree.nodes.new("ShaderNodeTexImage").image = image
    obj.data.materials.append(material)
    return obj


def cut(**options: Any) -> Any:
    bpy.context.view_layer.update()
    assert bpy.ops.object.nested_cages_cutout(**options) == {"FINISHED"}
    return next((o for o in bpy.data.objects if o.name in ("part", "leg", "tile") and o.type == "MESH"), None)


def assert_shows_all_pixels(obj: Any, unit: float) -> None:
    """The mesh covers all opaque pixels, and each of its corners has the place of the picture that lies there."""
    rows, columns = np.nonzero(opacity())
    centres = (np.column_stack([columns, rows]) + 0.5 - (WIDTH / 2, HEIGHT / 2)) * unit
    area = faces_of(obj, evaluated(obj)[:, :2], None).buffer(1e-6)
    assert shapely.contains_xy(area, centres).all()
    layer = obj.data.uv_layers.active.data
    for face in obj.data.polygons:
        assert face.normal.z > 0.99
        for corner, vertex in zip(face.loop_indices, face.vertices, strict=True):
            place = np.array(obj.data.vertices[vertex].co[:2]) / (WIDTH * unit, HEIGHT * unit) + 0.5
            assert np.allclose(layer[corner].uv, place, atol=1e-6)


def cage_of(obj: Any) -> Any:
    return bpy.data.objects[f"{obj.name} Cage 1"]


def assert_follows(obj: Any) -> None:
    """The picture is at rest as it was made, and goes where the cage goes."""
    rest = np.array([vertex.co[:] for vertex in obj.data.vertices])
    assert np.abs(evaluated(obj) - rest).max() < 1e-5
    for vertex in cage_of(obj).data.vertices:
        vertex.co.x += 0.25
    cage_of(obj).data.update()
    bpy.context.view_layer.update()
    assert np.abs(evaluated(obj) - rest - (0.25, 0.0, 0.0)).max() < 1e-5


def test_a_file_becomes_a_bound_mesh_that_shows_it(tmp_path) -> None:
    path = file_of(picture(), tmp_path)
    obj = cut(filepath=str(path))
    assert obj.name == "part" and len(obj.data.vertices) > 100
    assert_shows_all_pixels(obj, 0.01)
    nodes = obj.active_material.node_tree.nodes
    assert [node.image.size[:] for node in nodes if node.bl_idname == "ShaderNodeTexImage"] == [(WIDTH, HEIGHT)]
    assert len(cage_of(obj).data.vertices) == 16
    assert solid(cage_of(obj)).area < 1.1 * faces_of(obj, evaluated(obj)[:, :2], None).area
    assert bpy.context.scene.timeline_markers[:] == []
    rig = bpy.context.object
    assert bpy.context.mode == "POSE" and rig.type == "ARMATURE" and len(rig.pose.bones) == 16
    rest = evaluated(obj)
    for bone in rig.pose.bones:
        bone.matrix = Matrix.Translation((0.0, 0.5, 0.0)) @ bone.matrix
    bpy.context.view_layer.update()
    assert np.abs(evaluated(obj) - rest - (0.0, 0.5, 0.0)).max() < 1e-5
    for bone in rig.pose.bones:
        bone.matrix_basis = Matrix()
    assert_follows(obj)


def test_with_a_skeleton_bones_along_the_limbs_move_one_cage(tmp_path) -> None:
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    limbs = (abs(rows - 23.5) < 6.0) | (abs(columns - 47.5) < 6.0)
    cut(filepath=str(file_of(picture("cross.png", limbs), tmp_path)), moved_by="SKELETON")
    rig, obj = bpy.context.object, bpy.data.objects["cross"]
    assert bpy.context.mode == "POSE" and len(rig.pose.bones) >= 3
    rest = evaluated(obj)
    last = max((bone for bone in rig.pose.bones if not bone.children), key=lambda bone: abs(bone.tail.x))
    last.rotation_mode, last.rotation_euler.x = "XYZ", 0.5
    bpy.context.view_layer.update()
    moved = np.linalg.norm(evaluated(obj) - rest, axis=1)
    far, near = (rest[:, 0] * np.sign(last.tail.x) * side for side in (1.0, -1.0))
    assert moved[far.argmax()] > 0.02 and moved[near.argmax()] < 1e-3


@pytest.mark.parametrize("moved_by", ["SKELETON", "HANDLES"])
def test_a_cutout_goes_to_engines_with_its_bones_and_action(tmp_path, moved_by) -> None:
    """Read back, it shows all opaque pixels at rest, its bones move it, and its action is there."""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    limbs = ((abs(rows - 23.5) < 6.0) | (abs(columns - 47.5) < 6.0)).astype(np.float32)
    cut(filepath=str(file_of(picture("cross.png", limbs), tmp_path)), moved_by=moved_by)
    rig, obj = bpy.context.object, bpy.data.objects["cross"]
    bone = rig.pose.bones[-1]
    bone.rotation_mode = "XYZ"
    for frame, angle in ((1, 0.0), (11, 0.5)):
        bone.rotation_euler.z = angle
        bone.keyframe_insert("rotation_euler", frame=frame)
    bpy.ops.object.mode_set(mode="OBJECT")
    choose(obj)
    for kind, name, read in (("SPINE", "cross.json", read_spine), ("GODOT", "cross.tscn", read_godot)):
        assert bpy.ops.object.nested_cages_export(filepath=str(tmp_path / name), kind=kind) == {"FINISHED"}
        found = read(tmp_path / name)
        assert (found.seen((WIDTH, HEIGHT))[..., 3] >= 255 * limbs[::-1]).all()
        assert set(found.names) >= {bone.name for bone in rig.pose.bones} and found.animations
        rest, turned = found.posed({})[0], found.posed({bone.name: -28.65})[0]
        moved = np.abs(turned - rest).max()
        assert moved > 1.0


def test_what_has_no_limbs_gets_no_skeleton_and_nothing_is_made(tmp_path) -> None:
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    path = file_of(picture("disc.png", np.hypot(x - 47.5, y - 23.5) < 20.0), tmp_path)
    with refused():
        bpy.ops.object.nested_cages_cutout(filepath=str(path), moved_by="SKELETON")
    assert not bpy.data.images and not bpy.data.materials


def test_several_files_stand_in_a_row_in_the_colours_of_their_program(tmp_path) -> None:
    for name in ("arm.png", "leg.png"):
        file_of(picture(name), tmp_path)
    cut(directory=str(tmp_path), files=[{"name": "arm.png"}, {"name": "leg.png"}], standard=True)
    arm, leg = (in_world(obj, evaluated(obj)) for obj in (bpy.data.objects["arm"], bpy.data.objects["leg"]))
    assert arm[:, 0].max() < 0.0 < leg[:, 0].min() and np.abs((arm[:, 1], leg[:, 1])).max() < 1e-6
    assert bpy.context.scene.view_settings.view_transform == "Standard"
    for name in ("arm", "leg"):
        assert_follows(bpy.data.objects[name])


@pytest.mark.parametrize(("options", "grown"), [({}, 0.0), ({"padding": 2.0}, 2.0)])
def test_an_opaque_tile_grows_only_if_asked(options: dict[str, float], grown: float) -> None:
    image = bpy.data.images.new("tile.png", 32, 16, alpha=True)
    image.pixels.foreach_set(np.ones(32 * 16 * 4, np.float32))
    image_empty(image).empty_display_size = 32.0
    obj = cut(moved_by="NOTHING", **options)
    points = in_world(obj, evaluated(obj))
    assert np.ptp(points, axis=0)[:2] == pytest.approx((32.0 + 2.0 * grown, 16.0 + 2.0 * grown), abs=1e-2)
    if not grown:
        assert len(obj.data.vertices) == 4 or (np.abs(points[:, :2]) <= (16.0, 8.0)).all()


def test_an_image_empty_is_cut_out_where_it_is() -> None:
    shown = image_empty(picture())
    shown.empty_display_size = 3.0
    shown.location, shown.rotation_euler = (1.0, 2.0, 3.0), (0.5, 0.2, 0.3)
    shown.scale = (1.0, 2.0, 1.0)
    bpy.context.view_layer.update()
    matrix = np.array(shown.matrix_world)
    obj = cut(holes=True)
    assert shown.hide_get() and shown.hide_render
    corners = [loop.uv[:] for loop in obj.data.uv_layers.active.data]
    used = [loop.vertex_index for loop in obj.data.loops]
    points = in_world(obj, evaluated(obj))[used]
    # An image empty of size 3 has its longer side 3 long, and its lower left corner at minus a half.
    local = (np.array(corners) - 0.5) * (3.0, 3.0 * HEIGHT / WIDTH)
    expected = local @ matrix[:3, :2].T + matrix[:3, 3]
    assert np.abs(points - expected).max() < 1e-5
    assert_follows(obj)


def test_an_image_plane_is_cut_out_where_it_is_with_its_hole() -> None:
    shown = plane(picture())
    obj = cut(holes=True, moved_by="NOTHING")
    assert_shows_all_pixels(obj, 4.0 / WIDTH)
    assert len(faces_of(obj, evaluated(obj)[:, :2], None).interiors) == 1
    assert shown.hide_get()


@pytest.mark.parametrize(
    "break_it",
    [
        lambda obj: obj.data.uv_layers.remove(obj.data.uv_layers[0]),
        lambda obj: setattr(obj.data.vertices[0], "co", (-1.0, -1.0, 1.0)),
    ],
    ids=["no texture coordinates", "not flat"],
)
def test_what_is_no_picture_is_told_and_nothing_changes(break_it: Any) -> None:
    shown = plane(picture())
    break_it(shown)
    with refused(f"'{shown.name}'"):
        cut()


def test_a_file_that_is_no_picture_is_told(tmp_path) -> None:
    path = tmp_path / "note.png"
    path.write_text("no picture")
    with refused("note.png", unchanged=False):
        cut(filepath=str(path))


def test_pictures_without_a_cage_are_skipped_and_opaque_ones_told(reports) -> None:
    """A distance in units that is more than the clearance of a small picture, and less than that of a large one."""
    solid = bpy.data.images.new("solid.png", 8, 8, alpha=True)
    solid.pixels.foreach_set(np.ones(8 * 8 * 4, np.float32))
    large, small, rectangle = map(image_empty, (picture("large.png"), picture(), solid))
    large.empty_display_size, small.empty_display_size, rectangle.empty_display_size = 300.0, 1.0, 1.0
    choose(large, small, rectangle)
    cut(levels="1e-4u", moved_by="NOTHING")
    told = reports.read()
    assert "'large'" in told and "'solid.png'" in told and "'part.png'" not in told
    assert {"part", "solid"} <= set(bpy.data.objects.keys()) and "large" not in bpy.data.objects
    assert not large.hide_get() and small.hide_get() and rectangle.hide_get()
