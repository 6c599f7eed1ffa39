"""Layered paintings in Blender: imported as puppets, moved by their bones as engines do, and exported as they are."""

import json
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
import shapely
from PIL import Image

from support.blender import new_file, refused
from support.command import run
from support.documents import archive, png_of
from support.drawings import evaluated, save

pytestmark = pytest.mark.slow

SIZE = (420, 300)
LAYERS = {
    "tail": ([(270, 170), (310, 160), (350, 110), (360, 40)], 26),
    "body": ([(140, 170), (260, 170)], 90),
    "arm": ([(150, 180), (110, 230), (40, 240)], 30),
}
Files = dict[str, bytes]


def pixels_of(path: Path) -> np.ndarray:
    return np.array(Image.open(path).convert("RGBA"))


def written(path: Path, files: Files) -> Path:
    path.write_bytes(archive(files))
    return path


def posed_meshes(text: str, turned: dict[str, float]) -> dict[str, np.ndarray]:
    """Points (n, 2) of each mesh of a puppet as scripts read it, bones turned by degrees: linear blend skinning."""
    document = json.loads(text)
    assert document["format"] == "nested-cages puppet" and document["version"] == 1
    motions: list[np.ndarray] = []
    for bone in document["bones"]:
        angle, (x, y) = np.deg2rad(turned.get(bone["name"], 0.0)), bone["head"]
        c, s = np.cos(angle), np.sin(angle)
        own = np.array([[c, -s, x - c * x + s * y], [s, c, y - s * x - c * y], [0.0, 0.0, 1.0]])
        motions.append(own if bone["parent"] is None else motions[bone["parent"]] @ own)
    found = {}
    for mesh in document["meshes"]:
        points = np.column_stack([mesh["points"], np.ones(len(mesh["points"]))])
        weights = np.zeros((len(points), len(motions)))
        for row, entries in zip(weights, mesh["weights"], strict=True):
            for column, weight in entries:
                row[column] = weight
        found[mesh["name"]] = np.einsum("nb,bij,nj->ni", weights, np.array(motions), points)[:, :2]
    return found


@pytest.fixture(scope="module")
def files() -> Files:
    """An OpenRaster file with three limbs, a hidden one, and colours that differ from pixel to pixel."""
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    entries: list[str] = []
    found: Files = {}
    for name, (line, width) in {**LAYERS, "note": ([(9, 9), (40, 9)], 6)}.items():
        pixels = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
        away = shapely.distance(shapely.linestrings(line), shapely.points(x, y))
        pixels[..., 3] = 255 * np.clip(0.5 * width - away, 0, 1)
        pixels[..., 0], pixels[..., 1], pixels[..., 2] = x % 256, y % 256, 90
        found[f"{name}.png"] = png_of(pixels)
        hidden = " visibility='hidden'" * (name == "note")
        entries.insert(0, f"<layer name='{name}' src='{name}.png'{hidden}/>")
    return {**found, "stack.xml": f"<image w='420' h='300'><stack>{''.join(entries)}</stack></image>".encode()}


@pytest.fixture(scope="module")
def painting(files: Files, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("painting") / "cat.ora", files)


def imported(painting: Path, **options: Any) -> tuple[dict[str, Any], Any]:
    assert bpy.ops.object.nested_cages_import(filepath=str(painting), **options) == {"FINISHED"}
    rig = bpy.context.view_layer.objects.active
    assert rig.type == "ARMATURE"
    return {obj.name: obj for obj in rig.children}, rig


@pytest.fixture(scope="module")
def saved(extension: Any, painting: Path) -> str:
    """A file with the painting imported."""
    new_file()
    imported(painting)
    bpy.ops.object.mode_set(mode="OBJECT")
    return save(painting.with_suffix(".blend"))


@pytest.fixture
def puppet(saved: str) -> tuple[dict[str, Any], Any]:
    """The parts and the armature of the painting."""
    bpy.ops.wm.open_mainfile(filepath=saved)
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    return {obj.name: obj for obj in rig.children}, rig


def repainted(rig: Any, path: Path, **options: Any) -> None:
    """Reads a painting again for a puppet."""
    with bpy.context.temp_override(selected_objects=[rig], active_object=rig):
        assert bpy.ops.object.nested_cages_import(filepath=str(path), repaint=True, **options) == {"FINISHED"}


def test_a_painting_becomes_a_puppet_that_bends_as_in_engines(painting: Path, tmp_path: Path, reports: Any) -> None:
    parts, rig = imported(painting)
    assert set(parts) == set(LAYERS)
    assert "note" in reports.read()  # which is hidden
    heights = [parts[name].matrix_local.translation.z for name in LAYERS]
    assert heights == sorted(heights)
    assert rig.data.bones["tail.001"].parent.name == "tail"
    for obj in parts.values():
        assert not obj.modifiers["Armature"].use_deform_preserve_volume
        assert obj.active_material.node_tree.nodes["Image Texture"].image.packed_file is not None
    # by the file that the command writes for scripts, and linear blend skinning
    path = tmp_path / "cat.puppet.json"
    assert run("puppet", painting, "-o", path, "--engine", "script").status == 0
    turned = {"tail": 30.0, "tail.001": -50.0, "arm": 20.0}
    for name, angle in turned.items():
        rig.pose.bones[name].rotation_euler.z = np.deg2rad(angle)
    bpy.context.view_layer.update()
    for name, wanted in posed_meshes(path.read_text(encoding="utf-8"), turned).items():
        np.testing.assert_allclose(evaluated(parts[name])[:, :2] / 0.01, wanted, atol=0.01)


FILES = {
    "GODOT": ("cat.tscn", {"cat.tscn", "cat.png"}),
    "SPINE": ("cat.json", {"cat.json", "cat.atlas", "cat.png"}),
    "SCRIPT": ("cat.json", {"cat.puppet.json", "cat.png"}),
}


def test_export_asks_for_the_engine(painting: Path, tmp_path: Path) -> None:
    imported(painting, hidden=True)
    for engine, (name, files) in FILES.items():
        out = tmp_path / engine
        out.mkdir()
        assert bpy.ops.object.nested_cages_export(filepath=str(out / name), kind=engine) == {"FINISHED"}
        assert {path.name for path in out.iterdir()} == files
        assert pixels_of(out / "cat.png")[..., 3].any()
    scene = (tmp_path / "GODOT" / "cat.tscn").read_text(encoding="utf-8")
    assert scene.count('type="Polygon2D"') == 4
    assert scene.count("visible = false") == 1
    found = json.loads((tmp_path / "SCRIPT" / "cat.puppet.json").read_text(encoding="utf-8"))
    assert found["picture"] == "cat.png"
    assert all(len(mesh["uv"]) == len(mesh["points"]) for mesh in found["meshes"])


Puppet = tuple[dict[str, Any], Any]


def test_what_is_exported_is_what_stands_in_the_scene(puppet: Puppet, painting: Path, tmp_path: Path) -> None:
    """Bones, weights and textures unchanged are those of the command; actions become keys, with what constraints do."""
    _, rig = puppet
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
    assert bpy.ops.object.nested_cages_export(filepath=str(path), kind="SPINE") == {"FINISHED"}
    assert bpy.context.scene.frame_current == 7
    found = json.loads(path.read_text(encoding="utf-8"))
    (tmp_path / "same").mkdir()
    assert run("puppet", painting, "-o", tmp_path / "same" / "cat.json").status == 0
    wanted = json.loads((tmp_path / "same" / "cat.json").read_text(encoding="utf-8"))
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
        pixels_of(tmp_path / "cat.png")[..., 3].sum(), pixels_of(tmp_path / "same" / "cat.png")[..., 3].sum()
    )


def test_painted_weights_and_moved_vertices_are_judged(puppet: Puppet, tmp_path: Path) -> None:
    parts, _ = puppet
    tail = parts["tail"]
    group = tail.vertex_groups.new(name="body")
    group.add([0], 0.5, "REPLACE")
    out = tmp_path / "cat.json"
    assert bpy.ops.object.nested_cages_export(filepath=str(out), kind="SPINE") == {"FINISHED"}
    bones = {bone["name"]: bone for bone in json.loads(out.read_text(encoding="utf-8"))["bones"]}
    assert bones["tail"]["proved_degrees"] == [0, 0]
    tail.data.vertices[1].co.x += 0.3
    with refused("'tail'"):
        bpy.ops.object.nested_cages_export(filepath=str(out), kind="SPINE")
    tail.data.vertices[1].co.x -= 0.3
    parts["arm"].vertex_groups.clear()
    with refused("'arm'"):
        bpy.ops.object.nested_cages_export(filepath=str(out), kind="SPINE")


def test_a_repainted_puppet_keeps_what_was_made_with_it(puppet: Puppet, files: Files, tmp_path: Path) -> None:
    """Objects and bones that were renamed, and keys; a layer is new. Weights painted by hand are named first."""
    parts, rig = puppet
    parts["tail"].name = "plume"
    rig.data.bones["tail.001"].name = "tip"
    rig.pose.bones["tip"].rotation_euler.z = 0.3
    rig.pose.bones["tip"].keyframe_insert("rotation_euler", frame=5)
    arm = parts["arm"]
    arm.vertex_groups.new(name="body").add([0], 1.0, "REPLACE")
    for group in arm.vertex_groups[:-1]:
        group.remove([0])
    before = rig.data.bones["tip"].head_local.copy()
    body = "<layer name='body' src='body.png'/>"
    stack = files["stack.xml"].decode().replace(body, "<layer name='hat' src='hat.png'/>" + body)
    stack = stack.replace("<layer name='note' src='note.png' visibility='hidden'/>", "")
    hat = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    hat[110:150, 200:230] = 255
    changed = written(tmp_path / "cat.ora", {**files, "hat.png": png_of(hat), "stack.xml": stack.encode()})
    with refused("'arm'"):
        repainted(rig, changed)
    repainted(rig, changed, replace_weights=True)
    assert {obj.name for obj in rig.children} == {"plume", "body", "arm", "hat"}
    assert (rig.data.bones["tip"].head_local - before).length < 1e-6
    assert rig.data.bones["tip"].parent.name == "tail"
    assert rig.pose.bones["tip"].rotation_euler.z == pytest.approx(0.3)
    assert rig.animation_data.action is not None
    weights = {arm.vertex_groups[member.group].name for vertex in arm.data.vertices for member in vertex.groups}
    assert weights and "body" not in weights
    assert sum(obj.active_material is not None for obj in rig.children) == 4
    assert {obj.active_material.name for obj in rig.children} == {"tail", "body", "arm", "hat"}


def test_shape_keys_stay_on_layers_that_are_not_redrawn(
    puppet: Puppet, files: Files, tmp_path: Path, reports: Any
) -> None:
    parts, rig = puppet
    for name in ("arm", "body"):
        obj = parts[name]
        obj.shape_key_add(name="Basis")
        key = obj.shape_key_add(name="fat")
        key.data[0].co.x += 0.3
        key.value = 0.7
        key.keyframe_insert("value", frame=1)
    pixels = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    pixels[120:230, 130:280] = 255
    changed = written(tmp_path / "cat.ora", {**files, "body.png": png_of(pixels)})
    before = evaluated(parts["arm"])
    repainted(rig, changed)
    np.testing.assert_allclose(evaluated(parts["arm"]), before, atol=1e-4)
    kept = parts["arm"].data.shape_keys
    assert kept.key_blocks["fat"].value == pytest.approx(0.7) and kept.animation_data.action is not None
    assert len(parts["arm"].data.uv_layers) == len(parts["arm"].data.materials) == 1
    said = reports.read("Warning")
    assert "'body'" in said and "'arm'" not in said


def test_pictures_of_a_folder_are_a_painting(tmp_path: Path) -> None:
    for number in range(3):
        pixels = np.zeros((40, 60, 4), np.uint8)
        pixels[5:30, 8 * number : 30 + 8 * number] = 255
        (tmp_path / f"{number} part{number}.png").write_bytes(png_of(pixels))
    assert set(imported(tmp_path)[0]) == {"part0", "part1", "part2"}
    bpy.ops.object.mode_set(mode="OBJECT")
    names = [{"name": f"{number} part{number}.png"} for number in (2, 0)]
    bpy.ops.object.nested_cages_import(directory=str(tmp_path), files=names)
    chosen = bpy.context.view_layer.objects.active.children
    assert {obj.name.partition(".")[0] for obj in chosen} == {"part0", "part2"}


def test_a_damaged_painting_is_told(tmp_path: Path) -> None:
    (tmp_path / "a.psd").write_bytes(b"8BPS" + bytes(40))
    (tmp_path / "b.kra").write_bytes(archive({}))
    for name in ("a.psd", "b.kra"):
        with refused(name):
            bpy.ops.object.nested_cages_import(filepath=str(tmp_path / name))
