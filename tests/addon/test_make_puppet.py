"""Puppets: parts of a layered drawing that move by themselves, in plain Blender."""

from __future__ import annotations

from math import radians
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from bpy.types import Object

pytest.importorskip("shapely")

ROOT = Path(__file__).resolve().parents[2]
FOX = ROOT / "examples" / "fox.svg"


def shape(obj: Object) -> np.ndarray:
    """(n, 3) points of an object as it is displayed, in the world."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    seen = obj.evaluated_get(depsgraph)
    points = np.array([vertex.co[:] for vertex in seen.to_mesh().vertices])
    matrix = np.array(seen.matrix_world)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def shapes() -> dict[str, np.ndarray]:
    bpy.context.view_layer.update()
    return {obj.name: shape(obj) for obj in bpy.data.objects if obj.type == "MESH" and not obj.hide_render}


def turn(armature: Object, **degrees: float) -> None:
    for name, angle in degrees.items():
        armature.pose.bones[name.replace("_R", ".R").replace("_L", ".L")].rotation_euler[2] = radians(angle)


def moved(before: dict[str, np.ndarray], after: dict[str, np.ndarray]) -> set[str]:
    """Layers of which something is elsewhere."""
    size = max(np.ptp(points, axis=0).max() for points in before.values())
    far = {name for name in before if np.abs(after[name] - before[name]).max() > 1e-4 * size}
    return {name.rpartition(" ")[0] if name[-1].isdigit() else name for name in far}


@pytest.fixture
def fox() -> tuple[Object, dict[str, np.ndarray]]:
    assert bpy.ops.object.nested_cages_import(filepath=str(FOX)) == {"FINISHED"}
    before = shapes()
    assert bpy.ops.object.nested_cages_puppet() == {"FINISHED"}
    armature = bpy.context.object
    assert armature is not None and armature.type == "ARMATURE" and armature.mode == "POSE"
    return armature, before


def bone(armature: Object, part: str) -> Any:
    """The bone at the joint of a part."""
    return next(each for each in armature.data.bones if each["nested_cages_part"] == part)


@pytest.mark.slow
def test_a_leg_moves_alone_and_the_drawing_is_as_before(fox: tuple[Object, dict[str, np.ndarray]]) -> None:
    armature, before = fox
    assert moved(before, shapes()) == set()
    for part, riders in (
        ("foreleg-near", set()),
        ("hind-leg-far", set()),
        ("head", {"nose", "eye", "ear-far", "ear-near"}),
    ):
        posed = armature.pose.bones[bone(armature, part).name]
        posed.rotation_euler[2] = radians(40.0)
        assert moved(before, shapes()) == {part, *riders}
        posed.rotation_euler[2] = 0.0
    tip = armature.pose.bones[[each.name for each in armature.data.bones if each["nested_cages_part"] == "tail"][-1]]
    tip.rotation_euler[2] = radians(60.0)
    bent = shapes()
    assert moved(before, bent) == {"tail"}
    root = np.abs(bent["tail 1"] - before["tail 1"]).max(axis=1)
    assert root.min() < 1e-4 < root.max()  # its root stays on the body


@pytest.mark.slow
def test_turns_are_limited_to_what_is_proved(fox: tuple[Object, dict[str, np.ndarray]]) -> None:
    armature, _ = fox
    limits = [limit for each in armature.pose.bones for limit in each.constraints]
    assert limits and all(limit.min_z <= -radians(90.0) and limit.max_z >= radians(90.0) for limit in limits)
    pairs = [
        (each["nested_cages_part"], each.parent and each.parent["nested_cages_part"]) for each in armature.data.bones
    ]
    hanging = {part: parent for part, parent in pairs if part != parent}
    assert hanging["body"] is None
    assert {part for part, parent in hanging.items() if parent == "body"} == {
        "tail", "hind-leg-far", "hind-leg-near", "foreleg-far", "foreleg-near", "head"
    }  # fmt: skip


@pytest.mark.slow
def test_a_bone_hung_elsewhere_takes_its_part_along(fox: tuple[Object, dict[str, np.ndarray]]) -> None:
    armature, before = fox
    bpy.ops.object.mode_set(mode="EDIT")
    bones = armature.data.edit_bones
    bones[bone(armature, "ear-near").name].parent = bones[bone(armature, "body").name]
    bpy.ops.object.mode_set(mode="POSE")
    armature.pose.bones[bone(armature, "head").name].rotation_euler[2] = radians(30.0)
    name = armature.name
    assert bpy.ops.object.nested_cages_puppet() == {"FINISHED"}
    again = bpy.context.object
    assert again is not None and again.name == name
    assert moved(before, shapes()) == {"head", "nose", "eye", "ear-far"}
    assert len([obj for obj in bpy.data.objects if obj.type == "ARMATURE"]) == 1


@pytest.mark.slow
def test_the_file_moves_without_the_extension(fox: tuple[Object, dict[str, np.ndarray]], tmp_path: Path) -> None:
    armature, before = fox
    path, part = str(tmp_path / "fox.blend"), bone(armature, "tail").name
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    armature = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    armature.pose.bones[part].rotation_euler[2] = radians(25.0)
    assert moved(before, shapes()) == {"tail"}
    armature.location.x += 3.0
    assert len(moved(before, shapes())) > 10
    assert shapes()["body 7"] == pytest.approx(before["body 7"] + np.array([3.0, 0.0, 0.0]), abs=1e-4)


def test_nothing_selected_is_told() -> None:
    with pytest.raises(RuntimeError, match="Select the parts of a drawing"):
        bpy.ops.object.nested_cages_puppet()
