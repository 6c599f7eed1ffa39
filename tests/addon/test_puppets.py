"""Layered paintings in Blender: imported as puppets, moved by their bones as engines do, and exported as they are."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
import shapely

from nestedcages_core.exchange.pictures import encode_png, read_png
from support.drawings import evaluated

pytestmark = pytest.mark.slow

SIZE = (420, 300)
LAYERS = {
    "tail": ([(270, 170), (310, 160), (350, 110), (360, 40)], 26),
    "body": ([(140, 170), (260, 170)], 90),
    "arm": ([(150, 180), (110, 230), (40, 240)], 30),
}


@pytest.fixture
def painting(tmp_path: Path) -> Path:
    """An OpenRaster file with three limbs, a hidden one, and colours that differ from pixel to pixel."""
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    entries, path = [], tmp_path / "cat.ora"
    with zipfile.ZipFile(path, "w") as archive:
        for name, (line, width) in {**LAYERS, "note": ([(9, 9), (40, 9)], 6)}.items():
            pixels = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
            away = shapely.distance(shapely.linestrings(line), shapely.points(x, y))
            pixels[..., 3] = 255 * np.clip(0.5 * width - away, 0, 1)
            pixels[..., 0], pixels[..., 1], pixels[..., 2] = x % 256, y % 256, 90
            archive.writestr(f"{name}.png", encode_png(pixels))
            hidden = " visibility='hidden'" * (name == "note")
            entries.insert(0, f"<layer name='{name}' src='{name}.png'{hidden}/>")
        archive.writestr("stack.xml", f"<image w='420' h='300'><stack>{''.join(entries)}</stack></image>")
    return path


def imported(painting: Path, **options: Any) -> tuple[dict[str, Any], Any]:
    assert bpy.ops.object.nested_cages_import(filepath=str(painting), **options) == {"FINISHED"}
    rig = bpy.context.view_layer.objects.active
    assert rig.type == "ARMATURE"
    return {obj.name: obj for obj in rig.children}, rig


def test_a_painting_becomes_a_puppet(painting: Path, core: Any, capfd: pytest.CaptureFixture[str]) -> None:
    parts, rig = imported(painting)
    assert set(parts) == set(LAYERS)
    said = "".join(capfd.readouterr())
    assert "3 parts" in said
    assert "note" in said
    heights = [parts[name].matrix_local.translation.z for name in LAYERS]
    assert heights == sorted(heights)
    assert rig.data.bones["tail.001"].parent.name == "tail"
    for name, obj in parts.items():
        modifier = obj.modifiers["Armature"]
        assert not modifier.use_deform_preserve_volume
        image = obj.active_material.node_tree.nodes["Image Texture"].image
        assert image.packed_file is not None
        assert obj["nested_cages_layer"] == name
    # bones move meshes as the core says that engines do
    picture = core.exchange.layers.read_layers(painting)
    puppet = core.game.game_puppet(core.exchange.layers.parts_of(picture)[0], SIZE)
    turned = {"tail": 30.0, "tail.001": -50.0, "arm": 20.0}
    for name, angle in turned.items():
        rig.pose.bones[name].rotation_euler.z = np.deg2rad(angle)
    bpy.context.view_layer.update()
    for mesh, wanted in zip(puppet.meshes, puppet.posed(turned), strict=True):
        there = evaluated(parts[mesh.name])[:, :2] / 0.01
        np.testing.assert_allclose(there, wanted, atol=0.01)


@pytest.mark.parametrize(("engine", "files"), [
    ("GODOT", {"cat.tscn", "cat.png"}),
    ("SPINE", {"cat.json", "cat.atlas", "cat.png"}),
    ("DRAGONBONES", {"cat_ske.json", "cat_tex.json", "cat.png"}),
    ("SCRIPT", {"cat.puppet.json", "cat.png"}),
])  # fmt: skip
def test_export_asks_for_the_engine(painting: Path, tmp_path: Path, engine: str, files: set[str]) -> None:
    imported(painting, hidden=True)
    out = tmp_path / "out"
    out.mkdir()
    suffix = ".tscn" if engine == "GODOT" else ".json"
    assert bpy.ops.object.nested_cages_export(filepath=str(out / f"cat{suffix}"), engine=engine) == {"FINISHED"}
    assert {path.name for path in out.iterdir()} == files
    assert read_png(out / "cat.png")[..., 3].any()
    if engine == "GODOT":
        scene = (out / "cat.tscn").read_text(encoding="utf-8")
        assert scene.count('type="Polygon2D"') == 4
        assert scene.count("visible = false") == 1
    if engine == "SCRIPT":
        found = json.loads((out / "cat.puppet.json").read_text(encoding="utf-8"))
        assert found["picture"] == "cat.png"
        assert all(len(mesh["uv"]) == len(mesh["points"]) for mesh in found["meshes"])


def test_what_is_exported_is_what_stands_in_the_scene(painting: Path, tmp_path: Path, core: Any) -> None:
    """Bones, weights and textures unchanged are those of the command; actions become keys, with what constraints do."""
    _, rig = imported(painting)
    rig.keyframe_insert("location", frame=1)
    bone = rig.pose.bones["tail.001"]
    for frame, angle in ((1, 0.0), (25, 45.0)):
        bone.rotation_euler.z = np.deg2rad(angle)
        bone.keyframe_insert("rotation_euler", frame=frame)
    rig.animation_data.action.name = "wag"
    follow = rig.pose.bones["arm"].constraints.new("COPY_ROTATION")
    follow.target, follow.subtarget, follow.owner_space, follow.target_space = rig, "tail.001", "LOCAL", "LOCAL"
    bpy.context.scene.frame_set(7)
    path = tmp_path / "cat.json"
    assert bpy.ops.object.nested_cages_export(filepath=str(path), engine="SPINE") == {"FINISHED"}
    assert bpy.context.scene.frame_current == 7
    found = json.loads(path.read_text(encoding="utf-8"))
    picture = core.exchange.layers.read_layers(painting)
    puppet = core.game.game_puppet(core.exchange.layers.parts_of(picture)[0], SIZE, name="cat")
    core.game.write_puppet(tmp_path / "same.json", puppet)
    wanted = json.loads((tmp_path / "same.json").read_text(encoding="utf-8"))
    assert [slot["name"] for slot in found["slots"]] == [slot["name"] for slot in wanted["slots"]]
    at = {bone["name"]: bone for bone in found["bones"]}
    for entry in wanted["bones"][1:]:
        mine = at[entry["name"]]
        assert mine["parent"] == entry["parent"]
        for key in ("x", "y", "rotation", "length", "proved_degrees"):
            assert mine.get(key) == pytest.approx(entry.get(key), abs=0.02)
    for name in LAYERS:
        one, other = (each["skins"][0]["attachments"][name][name] for each in (found, wanted))
        assert one["hull"] == other["hull"]
        assert len(one["triangles"]) == len(other["triangles"])
        assert len(one["vertices"]) == len(other["vertices"])
    keys = found["animations"]["wag"]["bones"]
    assert set(keys) == {"tail.001", "arm"}
    assert keys["tail.001"]["rotate"][-1] == {"time": 1, "value": pytest.approx(45.0, abs=1e-3)}
    assert [key["value"] for key in keys["arm"]["rotate"]] == pytest.approx(
        [key["value"] for key in keys["tail.001"]["rotate"]], abs=1e-3
    )
    np.testing.assert_array_equal(
        read_png(tmp_path / "cat.png")[..., 3].sum(), read_png(tmp_path / "same.png")[..., 3].sum()
    )


def test_painted_weights_and_moved_vertices_are_judged(painting: Path, tmp_path: Path) -> None:
    parts, _ = imported(painting)
    tail = parts["tail"]
    group = tail.vertex_groups.new(name="body")
    group.add([0], 0.5, "REPLACE")
    out = tmp_path / "cat.json"
    assert bpy.ops.object.nested_cages_export(filepath=str(out), engine="SPINE") == {"FINISHED"}
    bones = {bone["name"]: bone for bone in json.loads(out.read_text(encoding="utf-8"))["bones"]}
    assert bones["tail"]["proved_degrees"] == [0, 0]
    tail.data.vertices[1].co.x += 0.3
    with pytest.raises(RuntimeError, match="where it was painted"):
        bpy.ops.object.nested_cages_export(filepath=str(out), engine="SPINE")
    tail.data.vertices[1].co.x -= 0.3
    parts["arm"].vertex_groups.clear()
    with pytest.raises(RuntimeError, match="without weights"):
        bpy.ops.object.nested_cages_export(filepath=str(out), engine="SPINE")


def test_a_repainted_puppet_keeps_what_was_made_with_it(painting: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Objects and bones that were renamed, keys, and weights painted by hand; a layer is new."""
    parts, rig = imported(painting)
    parts["tail"].name = "plume"
    rig.data.bones["tail.001"].name = "tip"
    rig.pose.bones["tip"].rotation_euler.z = 0.3
    rig.pose.bones["tip"].keyframe_insert("rotation_euler", frame=5)
    arm = parts["arm"]
    arm.vertex_groups.new(name="body").add([0], 1.0, "REPLACE")
    for group in arm.vertex_groups[:-1]:
        group.remove([0])
    place, before = arm.data.vertices[0].co.copy(), rig.data.bones["tip"].head_local.copy()
    with zipfile.ZipFile(painting) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    stack = (
        files["stack.xml"]
        .decode()
        .replace(
            "<layer name='body' src='body.png'/>",
            "<layer name='hat' src='hat.png'/>\
<layer name='body' src='body.png'/>",
        )
        .replace("<layer name='note' src='note.png' visibility='hidden'/>", "")
    )
    hat = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    hat[110:150, 200:230] = 255
    with zipfile.ZipFile(painting, "w") as archive:
        for name, data in {**files, "hat.png": encode_png(hat), "stack.xml": stack}.items():
            archive.writestr(name, data)
    capfd.readouterr()
    bpy.ops.object.mode_set(mode="OBJECT")
    with bpy.context.temp_override(selected_objects=[rig], active_object=rig):
        assert bpy.ops.object.nested_cages_import(filepath=str(painting), repaint=True) == {"FINISHED"}
    said = "".join(capfd.readouterr())
    assert "New: hat" in said and "Repainted" not in said
    assert {obj.name for obj in rig.children} == {"plume", "body", "arm", "hat"}
    assert (rig.data.bones["tip"].head_local - before).length < 1e-6
    assert rig.data.bones["tip"].parent.name == "tail"
    assert rig.pose.bones["tip"].rotation_euler.z == pytest.approx(0.3)
    assert rig.animation_data.action is not None
    (moved,) = [vertex for vertex in arm.data.vertices if (vertex.co - place).length < 1e-5]
    weights = {arm.vertex_groups[member.group].name: member.weight for member in moved.groups}
    assert weights == {"body": pytest.approx(1.0, abs=1e-3)}
    assert sum(obj.active_material is not None for obj in rig.children) == 4
    assert {obj.active_material.name for obj in rig.children} == {"tail", "body", "arm", "hat"}


def test_shape_keys_stay_on_layers_that_are_not_redrawn(painting: Path, capfd: pytest.CaptureFixture[str]) -> None:
    parts, rig = imported(painting)
    for name in ("arm", "body"):
        obj = parts[name]
        obj.shape_key_add(name="Basis")
        key = obj.shape_key_add(name="fat")
        key.data[0].co.x += 0.3
        key.value = 0.7
        key.keyframe_insert("value", frame=1)
    with zipfile.ZipFile(painting) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    pixels = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    pixels[120:230, 130:280] = 255
    with zipfile.ZipFile(painting, "w") as archive:
        for name, data in {**files, "body.png": encode_png(pixels)}.items():
            archive.writestr(name, data)
    bpy.ops.object.mode_set(mode="OBJECT")
    before = evaluated(parts["arm"])
    with bpy.context.temp_override(selected_objects=[rig], active_object=rig):
        assert bpy.ops.object.nested_cages_import(filepath=str(painting), repaint=True) == {"FINISHED"}
    np.testing.assert_allclose(evaluated(parts["arm"]), before, atol=1e-4)
    kept = parts["arm"].data.shape_keys
    assert kept.key_blocks["fat"].value == pytest.approx(0.7) and kept.animation_data.action is not None
    assert len(parts["arm"].data.uv_layers) == len(parts["arm"].data.materials) == 1
    said = "".join(capfd.readouterr())
    assert "The shape keys of 'body' are gone" in said and "keys of 'arm'" not in said


def test_weights_of_own_bones_are_told_when_a_painting_is_read_again(
    painting: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    parts, rig = imported(painting)
    bpy.ops.object.mode_set(mode="EDIT")
    for name in ("own", "unused"):
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    bpy.ops.object.mode_set(mode="OBJECT")
    parts["arm"].vertex_groups.new(name="own").add([0], 1.0, "REPLACE")
    with bpy.context.temp_override(selected_objects=[rig], active_object=rig):
        assert bpy.ops.object.nested_cages_import(filepath=str(painting), repaint=True) == {"FINISHED"}
    said = "".join(capfd.readouterr())
    assert "The weights of 'own' are gone" in said and "'unused'" not in said


def test_pictures_of_a_folder_are_a_painting(tmp_path: Path) -> None:
    for number in range(3):
        pixels = np.zeros((40, 60, 4), np.uint8)
        pixels[5:30, 8 * number : 30 + 8 * number] = 255
        (tmp_path / f"{number} part{number}.png").write_bytes(encode_png(pixels))
    assert set(imported(tmp_path)[0]) == {"part0", "part1", "part2"}
    bpy.ops.object.mode_set(mode="OBJECT")
    names = [{"name": f"{number} part{number}.png"} for number in (2, 0)]
    bpy.ops.object.nested_cages_import(directory=str(tmp_path), files=names)
    chosen = bpy.context.view_layer.objects.active.children
    assert {obj.name.partition(".")[0] for obj in chosen} == {"part0", "part2"}


def test_a_damaged_painting_is_told(tmp_path: Path) -> None:
    (tmp_path / "a.psd").write_bytes(b"8BPS" + bytes(40))
    data = io.BytesIO()
    zipfile.ZipFile(data, "w").close()
    (tmp_path / "b.kra").write_bytes(data.getvalue())
    for name in ("a.psd", "b.kra"):
        with pytest.raises(RuntimeError, match=f"'{name}' cannot be read"):
            bpy.ops.object.nested_cages_import(filepath=str(tmp_path / name))
