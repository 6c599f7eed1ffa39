"""Scenes of Godot 4: Skeleton2D with Bone2D, Polygon2D for each mesh, and an AnimationPlayer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...geometry.arrays import FloatArray
from .animation import Animation
from .atlas import Atlas, page_points
from .puppet import GamePuppet
from .rig import LocalBone, few_decimals, in_parent, local_bones, unique_names
from .textured_mesh import PartMesh

FORBIDDEN = '.:@/"%\\'
"""Characters that names of nodes can't have."""

SKELETON = "Skeleton"

MULTIPLY = """shader_type canvas_item;
render_mode blend_mul;
void fragment() { COLOR = vec4(mix(vec3(1.0), COLOR.rgb, COLOR.a), 1.0); }
"""
"""Draws what is transparent as white, which changes nothing."""


def to_godot(puppet: GamePuppet, atlas: Atlas, picture: str) -> str:
    """The text of a .tscn. picture: path of the atlas, relative to the scene."""
    bones = unique_names((bone.name for bone in puppet.bones), FORBIDDEN)
    nodes = unique_names((mesh.name for mesh in puppet.meshes), FORBIDDEN, (SKELETON, "AnimationPlayer"))
    paths = _bone_paths(puppet, bones)
    resources = [*_materials(puppet), *_animations(puppet, paths)]
    head = f"[gd_scene load_steps={2 + sum(line.startswith('[sub') for line in resources)} format=3]"
    lines = [head, "", f'[ext_resource type="Texture2D" path={_quoted(picture)} id="1"]', "", *resources]
    (root,) = unique_names([puppet.name], FORBIDDEN)
    lines += [f'[node name={_quoted(root)} type="Node2D"]', ""]
    lines += [f'[node name="{SKELETON}" type="Skeleton2D" parent="."]', ""]
    for k, local in enumerate(local_bones(puppet.bones)):
        parent = puppet.bones[k].parent
        above = SKELETON if parent is None else f"{SKELETON}/{paths[parent]}"
        lines += _bone_node(puppet, k, bones[k], above, local)
    for mesh, node, region in zip(puppet.meshes, nodes, atlas.regions, strict=True):
        uv = page_points(mesh.points, region, puppet.place)
        lines += _polygon(mesh, node, paths, uv)
    if puppet.animations:
        lines += ['[node name="AnimationPlayer" type="AnimationPlayer" parent="."]']
        lines += ['libraries = {\n"": SubResource("animations")\n}', ""]
    return "\n".join(lines)


def _bone_paths(puppet: GamePuppet, names: Sequence[str]) -> list[str]:
    """Paths of the bones in the skeleton."""
    paths: list[str] = []
    for bone, name in zip(puppet.bones, names, strict=True):
        paths.append(name if bone.parent is None else f"{paths[bone.parent]}/{name}")
    return paths


def _bone_node(puppet: GamePuppet, number: int, name: str, above: str, local: LocalBone) -> Iterator[str]:
    angle = -np.deg2rad(local.degrees)
    c, s = np.cos(angle), np.sin(angle)
    proved = puppet.ranges[number]
    yield f'[node name={_quoted(name)} type="Bone2D" parent={_quoted(above)}]'
    if proved.low > -180.0 or proved.high < 180.0:  # clockwise on screen, as Godot counts
        said = f"Nothing folds between {-proved.high:.1f}° and {-proved.low:.1f}° from rest (proved)."
        yield f"editor_description = {_quoted(said)}"
    yield f"position = Vector2({_as_text(np.array([local.x, -local.y]))})"
    yield f"rotation = {_as_text(angle)}"
    yield f"rest = Transform2D({_as_text(np.array([c, s, -s, c, local.x, -local.y]))})"
    yield "auto_calculate_length_and_angle = false"
    yield f"length = {_as_text(local.length)}"
    yield "bone_angle = 0.0"
    yield f"metadata/bone = {_quoted(puppet.bones[number].name)}"
    if proved.low > -180.0 or proved.high < 180.0:
        yield f"metadata/proved_degrees = Vector2({_as_text(np.array([-proved.high, -proved.low]))})"
    yield ""


def _polygon(mesh: PartMesh, node: str, paths: Sequence[str], uv: FloatArray) -> Iterator[str]:
    used = np.flatnonzero(mesh.weights.any(axis=0)).tolist()
    weights = ", ".join(
        f"NodePath({_quoted(paths[bone])}), PackedFloat32Array({_as_text(mesh.weights[:, bone])})" for bone in used
    )
    triangles = ", ".join(f"PackedInt32Array({_as_text(corners)})" for corners in mesh.triangles[:, ::-1])
    yield f'[node name={_quoted(node)} type="Polygon2D" parent="."]'
    if not mesh.is_visible:
        yield "visible = false"
    if mesh.blend in ("multiply", "add"):
        yield f'material = SubResource("{mesh.blend}")'
    yield 'texture = ExtResource("1")'
    yield f'skeleton = NodePath("../{SKELETON}")'
    yield f"polygon = PackedVector2Array({_as_text(mesh.points * (1.0, -1.0))})"
    yield f"uv = PackedVector2Array({_as_text(uv)})"
    yield f"polygons = [{triangles}]"
    yield f"bones = [{weights}]"
    yield f"internal_vertex_count = {len(mesh.points) - mesh.hull}"
    yield f"metadata/layer = {_quoted(mesh.part)}"
    yield ""


def _materials(puppet: GamePuppet) -> Iterator[str]:
    used = {mesh.blend for mesh in puppet.meshes}
    if "add" in used:
        yield '[sub_resource type="CanvasItemMaterial" id="add"]'
        yield "blend_mode = 1\n"
    if "multiply" in used:
        yield '[sub_resource type="Shader" id="multiply_shader"]'
        yield f"code = {_quoted(MULTIPLY)}\n"
        yield '[sub_resource type="ShaderMaterial" id="multiply"]'
        yield 'shader = SubResource("multiply_shader")\n'


def _animations(puppet: GamePuppet, paths: Sequence[str]) -> Iterator[str]:
    names = unique_names((animation.name for animation in puppet.animations), "/:,[")
    for number, animation in enumerate(puppet.animations):
        yield f'[sub_resource type="Animation" id="animation_{number}"]'
        yield f"resource_name = {_quoted(names[number])}"
        yield f"length = {_as_text(max(float(animation.times[-1]), 1e-3))}"
        yield f"loop_mode = {int(animation.loops)}"
        for track, (path, values) in enumerate(_tracks(puppet, animation, paths)):
            yield f'tracks/{track}/type = "value"'
            yield f"tracks/{track}/imported = false"
            yield f"tracks/{track}/enabled = true"
            yield f"tracks/{track}/path = NodePath({_quoted(path)})"
            yield f"tracks/{track}/interp = 1"
            yield f"tracks/{track}/loop_wrap = true"
            yield f"tracks/{track}/keys = {{"
            yield f'"times": PackedFloat32Array({_as_text(animation.times)}),'
            yield f'"transitions": PackedFloat32Array({_as_text(np.ones(len(animation.times)))}),'
            yield f'"update": 0,\n"values": [{", ".join(values)}]\n}}'
        yield ""
    if puppet.animations:
        yield '[sub_resource type="AnimationLibrary" id="animations"]'
        entries = ",\n".join(f'{_quoted(name)}: SubResource("animation_{k}")' for k, name in enumerate(names))
        yield f"_data = {{\n{entries}\n}}\n"


def _tracks(puppet: GamePuppet, animation: Animation, paths: Sequence[str]) -> Iterator[tuple[str, list[str]]]:
    """The property of each track, and its values."""
    local, number = local_bones(puppet.bones), {bone.name: k for k, bone in enumerate(puppet.bones)}
    for name, degrees in animation.turned.items():
        k = number[name]
        angles = -np.deg2rad(local[k].degrees + degrees)
        yield f"{SKELETON}/{paths[k]}:rotation", [f"{value}" for value in few_decimals(angles)]
    for name, shifts in animation.shifted.items():
        k = number[name]
        places = (in_parent(puppet.bones, k, shifts) + np.array([local[k].x, local[k].y])) * (1.0, -1.0)
        yield f"{SKELETON}/{paths[k]}:position", [f"Vector2({_as_text(row)})" for row in places]


def _as_text(values: FloatArray | float) -> str:
    return ", ".join(map(str, few_decimals(values)))


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
