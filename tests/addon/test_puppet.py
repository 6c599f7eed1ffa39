"""Puppets: parts of a layered drawing that move by themselves, in plain Blender."""

import json
from collections.abc import Sequence
from math import radians
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from bpy.types import Object
from mathutils import Matrix, Vector
from PIL import Image

from support.blender import new_file, refused
from support.drawings import add, choose, curves_of, gathered, grease_pencil, save, world
from support.figure import LIMBS, capsule, face, figure, points
from support.marks import slow_after

pytestmark = pytest.mark.slow

pytest.importorskip("shapely")

FOX = Path(__file__).resolve().parents[2] / "examples" / "fox.svg"


def is_cap(obj: Object) -> bool:
    return "nested_cages_cap" in obj.keys()  # noqa: SIM118


def part_of(bone: Any) -> str:
    """The drawing that a bone bends; empty for controls."""
    return str(bone.get("nested_cages_part", ""))


def proved(bone: Any) -> tuple[float, float]:
    """Degrees that a bone turns by without a fold."""
    low, high, *_ = bone.get("nested_cages_proved", (-180.0, 180.0))
    return low, high


def make(*drawings: Object, **options: Any) -> Any:
    """The puppet of these drawings, or of what is selected."""
    if drawings:
        choose(*drawings)
    assert bpy.ops.object.nested_cages_puppet(**options) == {"FINISHED"}
    return bpy.context.object


def shapes() -> dict[str, np.ndarray]:
    """World points (n, 3) of all that is seen, by name."""
    bpy.context.view_layer.update()
    seen = [obj for obj in bpy.data.objects if obj.type == "MESH" and not obj.hide_render and not is_cap(obj)]
    return {obj.name: world(obj) for obj in seen}


def turn(armature: Object, **degrees: float) -> None:
    for name, angle in degrees.items():
        armature.pose.bones[name.replace("_R", ".R").replace("_L", ".L")].rotation_euler[2] = radians(angle)


def moved(before: dict[str, np.ndarray], after: dict[str, np.ndarray]) -> set[str]:
    """Layers of which something is elsewhere."""
    size = max(np.ptp(points, axis=0).max() for points in before.values())
    far = {name for name in before if np.abs(after[name] - before[name]).max() > 1e-4 * size}
    return {name.rpartition(" ")[0] if name[-1].isdigit() else name for name in far}


def bone(armature: Object, part: str) -> Any:
    """The bone at the joint of a part."""
    return next(each for each in armature.data.bones if part_of(each) == part)


def opened(path: str) -> Any:
    """The puppet in a file, in Pose Mode."""
    bpy.ops.wm.open_mainfile(filepath=path)
    armature = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    choose(armature)
    bpy.ops.object.mode_set(mode="POSE")
    return armature


@pytest.fixture(scope="module")
def foxes(extension: Any, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, dict[str, np.ndarray]]:
    """A file with the puppet of a fox, and what its drawing looked like."""
    new_file()
    assert bpy.ops.object.nested_cages_import(filepath=str(FOX)) == {"FINISHED"}
    before = shapes()
    armature = make()
    assert armature is not None and armature.type == "ARMATURE" and armature.mode == "POSE"
    return save(tmp_path_factory.mktemp("fox") / "fox.blend"), before


@pytest.fixture
def fox(foxes: tuple[str, dict[str, np.ndarray]]) -> tuple[Any, dict[str, np.ndarray]]:
    return opened(foxes[0]), foxes[1]


@pytest.fixture(scope="module")
def men(extension: Any, tmp_path_factory: pytest.TempPathFactory) -> str:
    """A file with the puppet of a figure of faces."""
    new_file()
    make(*figure_of_faces(Matrix()))
    return save(tmp_path_factory.mktemp("man") / "man.blend")


@pytest.fixture
def man(men: str) -> Any:
    """The armature of a figure of faces; its drawings are called as its limbs."""
    return opened(men)


def limbs() -> list[Object]:
    return [bpy.data.objects[name] for name in LIMBS]


def test_a_leg_moves_alone_and_the_drawing_is_as_before(fox: tuple[Any, dict[str, np.ndarray]]) -> None:
    armature, before = fox
    assert moved(before, shapes()) == set()
    limits = [limit for each in armature.pose.bones for limit in each.constraints if limit.type == "LIMIT_ROTATION"]
    assert limits and all(limit.min_z <= -radians(90.0) and limit.max_z >= radians(90.0) for limit in limits)
    on_body = {part_of(each) for each in armature.data.bones if each.parent and part_of(each.parent) == "body"}
    assert on_body - {"body"} == {"tail", "hind-leg-far", "hind-leg-near", "foreleg-far", "foreleg-near", "head"}
    for part, riders in (
        ("foreleg-near", set()),
        ("hind-leg-far", set()),
        ("head", {"nose", "eye", "ear-far", "ear-near"}),
    ):
        posed = armature.pose.bones[bone(armature, part).name]
        posed.rotation_euler[2] = radians(40.0)
        assert moved(before, shapes()) == {part, *riders}
        posed.rotation_euler[2] = 0.0
    tip = armature.pose.bones[[each.name for each in armature.data.bones if part_of(each) == "tail"][-1]]
    tip.rotation_euler[2] = radians(60.0)
    bent = shapes()
    assert moved(before, bent) == {"tail"}
    root = np.abs(bent["tail 1"] - before["tail 1"]).max(axis=1)
    assert root.min() < 1e-4 < root.max()  # its root stays on the body


def test_limbs_reach_for_controls_within_their_ranges(fox: tuple[Any, dict[str, np.ndarray]]) -> None:
    armature, before = fox
    armature.pose.bones["Root"].location[0] = 0.5
    assert len(moved(before, shapes())) == 12
    armature.pose.bones["Root"].location[0] = 0.0
    reaching = [(each, limit) for each in armature.pose.bones for limit in each.constraints if limit.type == "IK"]
    assert len(reaching) == 4 and moved(before, shapes()) == set()
    lower, reach = reaching[-1]
    control = armature.pose.bones[reach.subtarget]
    control.location[1] = -0.3 * lower.length
    assert moved(before, shapes()) == set()
    reach.influence = 1.0
    assert moved(before, shapes()) == {part_of(lower.bone)}
    assert (lower.tail - control.head).length < 1e-3 * lower.length
    low, high = proved(lower.bone)
    for shift in (-3.0, 0.7, 3.0):
        control.location[1] = shift * lower.length
        bpy.context.view_layer.update()
        rest = lower.parent.bone.matrix_local.inverted() @ lower.bone.matrix_local
        turned = (rest.inverted() @ lower.parent.matrix.inverted() @ lower.matrix).to_euler()
        assert low - 0.1 <= np.rad2deg(turned.z) <= high + 0.1


def test_a_walk_repeats_and_folds_nothing(fox: tuple[Any, dict[str, np.ndarray]]) -> None:
    armature, before = fox
    scene = bpy.context.scene
    tip = [each for each in armature.pose.bones if part_of(each.bone) == "tail"][-1]
    tip.keyframe_insert("rotation_euler", frame=1)
    own = armature.animation_data.action
    assert bpy.ops.object.nested_cages_walk() == {"FINISHED"}
    walk = armature.animation_data.action
    assert own.use_fake_user and own not in (walk, None) and len(bpy.data.actions) == 2
    first, last = map(round, walk.frame_range)
    poses = []
    for frame in range(first, last + 1):
        scene.frame_set(frame)
        poses.append(shapes())
        for each in armature.pose.bones:
            low, high = proved(each.bone)
            assert low <= np.rad2deg(each.rotation_euler[2]) <= high
    legs = {"hind-leg-far", "hind-leg-near", "foreleg-far", "foreleg-near"}
    assert moved(poses[0], poses[-1]) == set()
    assert legs < moved(poses[0], poses[9])
    lowest = [min(points[:, 2].min() for points in pose.values()) for pose in poses]
    assert np.ptp(lowest) < 0.02 * np.ptp(before["body 7"][:, 0])  # some leg stands on the ground
    scene.frame_end = last
    assert bpy.ops.object.nested_cages_verify(whole=True) == {"FINISHED"}
    armature.animation_data.action = None
    tip.constraints.remove(tip.constraints["Proved Range"])
    for frame, angle in ((3, 0.0), (5, 3.1), (7, 0.0)):
        tip.rotation_euler[2] = angle
        tip.keyframe_insert("rotation_euler", frame=frame)
    assert bpy.ops.object.nested_cages_verify(whole=True) == {"FINISHED"}
    assert scene.frame_current == 5
    assert bpy.ops.object.nested_cages_select_fault() == {"FINISHED"}


def test_what_was_made_by_hand_stays(fox: tuple[Any, dict[str, np.ndarray]]) -> None:
    """A part is redrawn and another one added: names, poses, own bones, constraints and painted weights stay."""
    armature, _ = fox
    carrier = bpy.data.objects["tail Bend"]
    tip = carrier.vertex_groups[-1]
    vertex = next(each.index for each in carrier.data.vertices if [on.group for on in each.groups] == [tip.index])
    tip.add([vertex], 0.5, "REPLACE")
    carrier.vertex_groups[0].add([vertex], 0.5, "REPLACE")
    armature.pose.bones["head"].name = "skull"
    posed = armature.pose.bones["skull"]
    posed.rotation_euler[2] = 0.4
    posed.constraints.new("COPY_SCALE").name = "Mine"
    posed.keyframe_insert("rotation_euler", frame=1)
    bpy.ops.object.mode_set(mode="EDIT")
    own = armature.data.edit_bones.new("Own")
    own.tail = (0.0, 1.0, 0.0)
    own.parent = armature.data.edit_bones["skull"]
    ear, body = bone(armature, "ear-near").name, bone(armature, "body").name
    armature.data.edit_bones[ear].parent = armature.data.edit_bones[body]
    bpy.ops.object.mode_set(mode="OBJECT")
    posed_shapes = shapes()
    head = next(obj for obj in bpy.data.objects if obj.name.startswith("head "))
    hat = bpy.data.objects.new("hat", head.data.copy())
    head.users_collection[0].objects.link(hat)
    hat.matrix_world = head.matrix_world
    drawn = bpy.data.objects["body 7"].data
    drawn.vertices.foreach_set("co", 1.02 * np.array([each.co[:] for each in drawn.vertices]).ravel())
    hat.select_set(True)
    make()
    assert bpy.context.object == armature and armature.animation_data.action is not None
    assert armature.pose.bones["skull"].rotation_euler[2] == pytest.approx(0.4)
    assert "Mine" in armature.pose.bones["skull"].constraints
    assert armature.data.bones["Own"].parent.name == "skull"
    assert armature.data.bones[ear].parent.name == body
    assert hat.parent == armature
    again = bpy.data.objects["tail Bend"]
    weights = [group.weight(vertex) for group in again.vertex_groups]
    assert weights == pytest.approx([0.5, 0.5], abs=1e-3)
    assert "tail" not in moved(posed_shapes, shapes()) and "head" not in moved(posed_shapes, shapes())


def test_puppets_made_again_elsewhere_are_copied_and_lose_their_body(fox: tuple[Any, Any], tmp_path: Path) -> None:
    armature, _ = fox
    armature.location = (3.0, 1.0, 0.5)
    make()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.select_all(action="SELECT")
    assert bpy.ops.object.duplicate() == {"FINISHED"}
    copied = list(bpy.context.selected_objects)
    bpy.context.view_layer.objects.active = rig = next(obj for obj in copied if obj.type == "ARMATURE")
    save(tmp_path / "copied.blend")  # complete by now
    bend = bpy.data.objects["tail Bend"]
    assert [obj.name for obj in bpy.data.objects if obj.name.startswith("tail Bend.")] == ["tail Bend.001"]
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    for made in (bend, bpy.data.objects["tail Bend.001"]):
        np.testing.assert_allclose(np.array(made.matrix_world), np.array(made.parent.matrix_world), atol=1e-6)
    bodies = [obj for obj in copied if obj.name.startswith("body")]
    bpy.data.batch_remove(bodies)
    own = [bone for bone in rig.data.bones if part_of(bone) not in ("", "body")]
    heads = {bone.name: bone.head_local.copy() for bone in own}
    make()
    for name, head in heads.items():
        np.testing.assert_allclose(rig.data.bones[name].head_local, head, atol=1e-5, err_msg=name)
    before = shapes()
    rig.location.x += 1.0
    after = shapes()
    for obj in [each for each in rig.children if each.name in after]:
        np.testing.assert_allclose(after[obj.name], before[obj.name] + (1.0, 0.0, 0.0), atol=1e-3, err_msg=obj.name)


ARM = """<svg xmlns="http://www.w3.org/2000/svg">
<rect id="body" x="100" y="100" width="90" height="140" fill="#00f" stroke="#f00" stroke-width="6"/>
<rect id="arm" x="10" y="120" width="130" height="24" rx="12" fill="#0f0"/>
<circle id="eye" cx="150" cy="150" r="8"/></svg>"""


def test_vector_puppets_are_exported_as_pictures(tmp_path: Path) -> None:
    """With the bones and keys of the armature, parts in their colours, and weights of engines, also while posed."""
    (tmp_path / "arm.svg").write_text(ARM, encoding="utf-8")
    bpy.ops.object.nested_cages_import(filepath=str(tmp_path / "arm.svg"))
    bpy.ops.object.nested_cages_puppet()
    rig = bpy.context.object
    last = rig.pose.bones[[each.name for each in rig.data.bones if part_of(each) == "arm"][-1]]
    for frame, angle in ((1, 0.0), (25, radians(45.0))):
        last.rotation_euler.z = angle
        last.keyframe_insert("rotation_euler", frame=frame)
    bpy.context.scene.frame_set(25)
    assert bpy.ops.object.nested_cages_export(filepath=str(tmp_path / "arm.json"), kind="SPINE") == {"FINISHED"}
    assert rig.data.pose_position == "POSE" and last.rotation_euler.z == pytest.approx(radians(45.0))
    found = json.loads((tmp_path / "arm.json").read_text(encoding="utf-8"))
    parents = {each["name"]: each["parent"] for each in found["bones"][1:]}
    assert parents == {"body": "root", "arm": "body", "arm.001": "arm"}  # without controls
    assert [slot["name"] for slot in found["slots"]] == ["body", "arm", "eye"]
    assert found["slots"][2]["bone"] == "body"
    (turns,) = (each["rotate"] for each in found["animations"].popitem()[1]["bones"].values())
    assert turns[-1]["value"] == pytest.approx(45.0, abs=0.01)
    bent = next(each for each in found["bones"] if each["name"] == last.name)
    assert bent["proved_degrees"][0] <= -90.0 and bent["proved_degrees"][1] >= 90.0
    pixels = np.array(Image.open(tmp_path / "arm.png").convert("RGBA"))
    colours = {tuple(row) for row in pixels[pixels[..., 3] == 255].tolist()}
    assert {(0, 0, 255, 255), (255, 0, 0, 255), (0, 255, 0, 255), (0, 0, 0, 255)} <= colours


def bars(insets: Sequence[float], materials: Sequence[Any]) -> list[Object]:
    """Two bars with square ends that overlap; of each material a rectangle so far inside of the edge."""
    found = []
    for name, left, z in (("upper", 0.0, 0.0), ("lower", 4.6, 0.1)):
        data = bpy.data.meshes.new(name)
        sides = [(left + d, left + 5.0 - d, d, 2.0 - d) for d in insets]
        corners = [(x, y, 0.0) for a, b, low, high in sides for x, y in ((a, low), (b, low), (b, high), (a, high))]
        data.from_pydata(corners, [], np.arange(len(corners)).reshape(-1, 4).tolist())
        for material in materials:
            data.materials.append(material)
        data.polygons.foreach_set("material_index", list(range(len(insets))))
        found.append(add(name, data))
        found[-1].location.z = z
    return found


def test_caps_keep_joints_painted_behind_their_drawings() -> None:
    """A bar with square ends leaves paint on the one that it turns on: what the bar shows there, with its texture."""
    material = bpy.data.materials.new("Paint")
    both = bars([0.0], [material])
    for bar in both:
        bar.data.uv_layers.new().data.foreach_set("uv", [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0])
    make(*both)
    (cap,) = [obj for obj in bpy.data.objects if is_cap(obj)]
    child = next(obj for obj in both if obj.name == cap.name.removesuffix(" Cap"))
    assert cap.parent_bone == next(obj.name for obj in both if obj != child)
    points = world(cap)
    assert (
        (points >= world(child).min(axis=0) - (1e-6, 1e-6, 1.0)) & (points <= world(child).max(axis=0) + 1e-6)
    ).all()
    assert (np.abs(points[:, 2] - child.matrix_world.translation.z) > 1e-3).all()
    assert (points[:, 2] < child.matrix_world.translation.z).all()
    uv = np.array([corner.uv[:] for corner in cap.data.uv_layers[0].data])
    used = [corner.vertex_index for corner in cap.data.loops]
    wide = world(child)[:, 0]
    np.testing.assert_allclose(uv[:, 0], (points[used, 0] - wide.min()) / np.ptp(wide), atol=1e-6)
    np.testing.assert_allclose(uv[:, 1], points[used, 1] / 2.0, atol=1e-6)
    assert cap.data.materials[0] == material
    turn(bpy.context.object, **{child.name: 90.0})
    bpy.context.view_layer.update()
    np.testing.assert_allclose(world(cap), points, atol=1e-6)
    for frame, hidden in ((2, False), (3, True)):
        child.hide_viewport = child.hide_render = hidden
        child.keyframe_insert("hide_viewport", frame=frame)
        child.keyframe_insert("hide_render", frame=frame)
    for frame, hidden in ((3, True), (2, False)):
        bpy.context.scene.frame_set(frame)
        assert cap.hide_viewport == cap.hide_render == hidden
    bpy.ops.object.nested_cages_puppet(caps=False)
    assert not [obj for obj in bpy.data.objects if is_cap(obj)]


def test_caps_have_the_ink_of_their_drawings() -> None:
    """Bars with a line around them: the edge of the cap, where paint was cut, has it too."""
    make(*bars([0.0, 0.1], [bpy.data.materials.new(name) for name in ("Ink", "Fill")]))
    (cap,) = [obj for obj in bpy.data.objects if is_cap(obj)]
    points = world(cap)
    above = [(points[list(each.vertices), 2] > points[:, 2].max() - 1e-6).all() for each in cap.data.polygons]
    painted = [cap.data.materials[each.material_index].name for each in cap.data.polygons]
    assert {name for name, edge in zip(painted, above, strict=True) if edge} == {"Ink"}
    assert {name for name, edge in zip(painted, above, strict=True) if not edge} == {"Ink", "Fill"}


def test_layers_of_one_grease_pencil_drawing_are_parts() -> None:
    """The drawing itself is hidden; a second press finds the parts that were made of it."""
    hero = grease_pencil("Hero", [capsule(*LIMBS["Torso"])])
    hero.data.layers.remove(hero.data.layers[0])
    for part, limb in LIMBS.items():
        x, z = capsule(*limb).T
        drawing = hero.data.layers.new(part).frames.new(1).drawing
        drawing.add_strokes([len(x)])
        drawing.strokes[0].cyclic = True
        for point, place in zip(drawing.strokes[0].points, zip(x, 0.0 * x, z, strict=True), strict=True):
            point.position = place
    hero.location = (3.0, 1.0, 0.0)
    hero.keyframe_insert("location", frame=1)
    bpy.context.view_layer.update()
    before = points(hero)
    make()
    armature: Any = bpy.context.object
    assert armature.name == "Hero Puppet"
    assert {part_of(each) for each in armature.data.bones} == {*LIMBS, ""}
    parts = [bpy.data.objects[name] for name in LIMBS]
    assert [obj.parent for obj in parts] == [armature] * len(LIMBS)
    assert not hero.visible_get() and hero.hide_render
    shown = np.concatenate([points(obj) for obj in parts])
    np.testing.assert_allclose(shown[:, [0, 2]], before[:, [0, 2]], atol=1e-5)
    depths = [points(obj)[:, 1].mean() for obj in parts]
    assert depths == sorted(depths, reverse=True) and len(set(depths)) == len(depths)
    make()
    assert {part_of(each) for each in armature.data.bones} == {*LIMBS, ""}


def test_joints_of_grease_pencil_are_told(reports: Any) -> None:
    for name, left in (("upper", 0.0), ("lower", 4.6)):
        bar = grease_pencil(name, [np.array([[left, 0.0], [left + 5.0, 0.0], [left + 5.0, 2.0], [left, 2.0]])])
        bar.select_set(True)
    bpy.context.view_layer.objects.active = bar
    told = []
    for options in ({}, {"caps": False}):
        make(**options)
        told.append(set(reports.read().splitlines()))
    assert told[0] - told[1]


def bones_of(armature: Object) -> dict[str, tuple[str, str, tuple[float, ...]]]:
    """The part, the parent and the place of each bone."""
    matrix, found = armature.matrix_world, {}
    for each in armature.data.bones:
        place = tuple(round(value, 3) for value in matrix @ each.head_local)
        found[each.name] = (part_of(each), each.parent.name if each.parent else "", place)
    return found


FEW = ("Torso", "Neck", "Head", "Arm.L")
"""Parts that make a small figure."""


def figure_of_faces(own: Matrix = Matrix(), parts: Sequence[str] = tuple(LIMBS)) -> list[Object]:  # noqa: B008
    """Parts of a figure, the first of which has a transform of its own, and looks as without."""
    drawings = []
    for number, part in enumerate(parts):
        obj = face(part, capsule(*LIMBS[part]))
        obj.location.z = 0.001 * number
        if part == parts[0]:
            obj.data.transform(own.inverted())
            obj.matrix_world = obj.matrix_basis @ own
        drawings.append(obj)
    return drawings


TURNS = [
    Matrix.Rotation(radians(90.0), 4, "Z"),
    Matrix.Rotation(radians(180.0), 4, "Y"),
    Matrix.Diagonal((-1, 1, 1, 1)),
]


@pytest.mark.parametrize("own", slow_after(1, TURNS[::-1], thorough_after=1))
def test_a_part_that_was_turned_or_mirrored_turns_no_puppet(man: Any, own: Matrix) -> None:
    wanted = bones_of(man)
    new_file()
    found = make(*figure_of_faces(own))
    assert bones_of(found) == wanted
    assert bpy.ops.object.nested_cages_walk() == {"FINISHED"}


@pytest.mark.parametrize("side", slow_after(1, ["RIGHT", "FRONT"], thorough_after=1))
def test_strokes_that_stand_upright_are_seen_from_the_front_or_the_right(side: str) -> None:
    """Grease Pencil stores them upright, in an object that is not turned."""
    for number, (part, limb) in enumerate(LIMBS.items()):
        x, z = capsule(*limb).T
        away = np.full(len(x), 0.01 * number)
        points = np.column_stack([x, -away, z] if side == "FRONT" else [away, x, z])
        grease_pencil(part, [points])
    choose(*bpy.data.objects)
    make()
    armature = bpy.context.object
    right = (1.0, 0.0, 0.0) if side == "FRONT" else (0.0, 1.0, 0.0)
    np.testing.assert_allclose(np.array(armature.matrix_world)[:3, 0], right, atol=1e-4)
    np.testing.assert_allclose(np.array(armature.matrix_world)[:3, 1], (0.0, 0.0, 1.0), atol=1e-4)
    assert bpy.ops.object.nested_cages_walk() == {"FINISHED"}


def test_parts_are_stacked_by_where_their_vertices_are() -> None:
    """Also if their transforms were applied."""
    drawings = figure_of_faces(parts=FEW)
    bpy.context.view_layer.update()
    heights = {obj: obj.location.z for obj in drawings}
    for obj in drawings:
        obj.data.transform(obj.matrix_world)
        obj.matrix_world = Matrix()
    make(*drawings)
    caps = [obj for obj in bpy.data.objects if is_cap(obj)]
    assert caps
    for cap in caps:
        own = next(heights[obj] for obj in drawings if cap.name.startswith(f"{obj.name} Cap"))
        below = max((each for each in heights.values() if each < own - 1e-6), default=-1.0)
        inside = world(cap)[:, 2]
        assert ((inside < own) & (inside > below)).all()


def test_pictures_on_planes_are_told(reports: Any) -> None:
    drawings = figure_of_faces(parts=FEW)
    material = bpy.data.materials.new("Picture")
    material.use_nodes = True
    shown: Any = material.node_tree.nodes.new("ShaderNodeTexImage")
    shown.image = bpy.data.images.new("Picture", 8, 8, alpha=True)
    drawings[0].data.materials.append(material)
    make(*drawings)
    (said,) = [line for line in reports.read("Warning").splitlines() if drawings[0].name in line]
    assert drawings[1].name not in said


def test_an_armature_that_was_deleted_leaves_nothing_behind(man: Any) -> None:
    drawings = limbs()
    before = {obj.name for obj in bpy.data.objects}
    bpy.ops.object.mode_set(mode="OBJECT")
    choose(bpy.context.object)
    assert bpy.ops.object.delete() == {"FINISHED"}
    make(*drawings)
    assert {obj.name for obj in bpy.data.objects} == before


def test_a_copy_of_a_part_is_a_part_of_its_own(man: Any) -> None:
    """It hangs where it lies now, and not on the part that it is a copy of."""
    rig, drawings = man, {obj.name: obj for obj in limbs()}
    bpy.ops.object.mode_set(mode="OBJECT")
    for name in ("Arm.L", "Hand.L"):
        choose(drawings[name])
        assert bpy.ops.object.duplicate() == {"FINISHED"}
        bpy.context.object.location.y -= 0.6
        bpy.context.object.select_set(True)
        drawings[f"Second {name}"] = bpy.context.object
    make(*drawings.values(), rig)
    parents = {part: part_of(rig.data.bones[parent]) for part, parent, _ in bones_of(rig).values() if parent}
    assert parents["Arm.L.001"] == "Torso" and {"Hand.L.001", "Hand.L"} <= {*parents}
    before = shapes()
    turn(rig, **{bone(rig, "Arm.L.001").name: 30.0})
    after = shapes()
    far = {name for name, points in before.items() if np.abs(after[name] - points).max() > 1e-3}
    assert far == {"Arm.L.001", "Hand.L.001"}


@pytest.mark.parametrize("cuts", slow_after(1, [2, 1], thorough_after=1))
def test_a_subdivided_bone_bends_its_part(man: Any, cuts: int) -> None:
    rig = man
    (first,) = [each.name for each in rig.data.bones if part_of(each) == "Arm.L"]
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.armature.select_all(action="DESELECT")
    bone = rig.data.edit_bones.active = rig.data.edit_bones[first]
    bone.select = bone.select_head = bone.select_tail = True
    assert bpy.ops.armature.subdivide(number_cuts=cuts) == {"FINISHED"}
    bone_before = next(each.parent.name for each in rig.data.edit_bones if part_of(each) == "Hand.L")
    own = rig.data.edit_bones.new(f"{first}.009")
    own.parent = rig.data.edit_bones[bone_before]
    own.head, own.tail, own.use_connect = own.parent.tail, own.parent.tail + own.parent.vector, True  # extruded
    bpy.ops.object.mode_set(mode="POSE")
    make()
    chain = [each.name for each in rig.data.bones if part_of(each) == "Arm.L"]
    assert len(chain) == cuts + 1 and f"{first}.009" not in chain
    before = shapes()
    rig.pose.bones[chain[-1]].rotation_euler[2] = 0.5
    assert "Arm.L" in moved(before, shapes()) <= {"Arm.L", "Hand.L"}
    assert bpy.ops.object.nested_cages_walk() == {"FINISHED"}


def test_a_joint_moved_off_its_part_comes_back(man: Any) -> None:
    rig = man
    before = bones_of(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones["Leg.L"].tail += Vector((1.0, 0.0, 0.0))
    bpy.ops.object.mode_set(mode="POSE")
    make()
    np.testing.assert_allclose(bones_of(rig)["Leg.001.L"][2], before["Leg.001.L"][2], atol=0.1)


def test_parents_of_drawings_say_what_hangs_on_what() -> None:
    """Unless all hang on one, which moves them; what is the parent of all is that of the puppet."""
    own = {"Head": "Torso", "Arm.L": "Neck", "Neck": "Torso"}
    for parents in (own, dict.fromkeys(("Head", "Arm.L", "Neck"), "Torso")):
        new_file()
        drawings = {obj.name: obj for obj in figure_of_faces()}
        for child, parent in parents.items():
            drawings[child].parent = drawings[parent]
        make(*drawings.values())
        found = {part: parent for part, parent, _ in bones_of(bpy.context.object).values()}
        assert (found["Head"], found["Arm.L"]) == (("Torso", "Neck") if parents == own else ("Neck", "Torso"))


def test_what_moves_all_drawings_moves_their_puppet() -> None:
    drawings = figure_of_faces(parts=FEW)
    empty = add("Stage", None, select=False)
    empty.location, empty.rotation_euler, empty.scale = (2.0, 1.0, 0.0), (0.0, 0.0, 0.3), (1.5, 1.5, 1.5)
    for obj in drawings:
        obj.parent = empty
    before = shapes()
    rig = make(*drawings)
    assert rig.parent == empty and moved(before, shapes()) == set()
    empty.location.x += 5.0
    after = shapes()
    for name, there in before.items():
        np.testing.assert_allclose(after[name], there + np.array([5.0, 0.0, 0.0]), atol=1e-4)


def test_each_file_is_a_puppet(tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / f"{name}.svg").write_text(ARM, encoding="utf-8")
    files = [{"name": "one.svg"}, {"name": "two.svg"}]
    bpy.ops.object.nested_cages_import(directory=str(tmp_path), files=files, outlines="PUPPET")
    assert {obj.name for obj in bpy.data.objects if obj.type == "ARMATURE"} == {"one Puppet", "two Puppet"}


def test_poses_are_mirrored_as_pictures() -> None:
    """What Blender pastes flipped by .L and .R is the mirrored picture, controls of limbs included."""
    drawings = figure()
    rig = make(*drawings.values(), reach=True)

    def picture() -> dict[str, np.ndarray]:
        bpy.context.view_layer.update()
        return {name: points(obj) for name, obj in drawings.items() if name != "Badge"}

    turn(rig, Arm_L=25.0, Hand_L=-20.0, Leg_L=15.0, Neck=10.0)
    rig.pose.bones["Leg.001 IK.L"].location = (0.1, 0.2, 0.0)
    posed = picture()
    bpy.ops.pose.select_all(action="SELECT")
    bpy.ops.pose.copy()
    for each in rig.pose.bones:
        each.rotation_euler, each.location = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    bpy.ops.pose.paste(flipped=True)
    for name, flipped in picture().items():
        other = name[:-1] + {"L": "R", "R": "L"}[name[-1]] if name[-2] == "." else name
        mirrored = posed[other] * (-1.0, 1.0, 1.0)
        far = np.linalg.norm(mirrored[:, None, :2] - flipped[None, :, :2], axis=2).min(axis=1)
        assert far.max() < 0.02, name


def test_an_override_is_posed_and_walks_and_says_what_it_cannot(tmp_path: Path) -> None:
    drawings = figure()
    gathered("Character", *drawings.values())
    make(*drawings.values(), reach=True)
    bpy.ops.object.mode_set(mode="OBJECT")
    library = save(tmp_path / "character.blend")

    def own(name: str) -> Any:
        """The object of this file: its own one, or an override."""
        return next(obj for obj in bpy.data.objects if obj.name == name and obj.library is None)

    def picture(pose: bool = False) -> np.ndarray:
        if pose:
            bones: Any = own("Character Puppet").pose.bones
            bones["Leg.001 IK.L"].location, bones["Neck"].rotation_euler[2] = (0.1, 0.2, 0.0), 0.3
        bpy.context.view_layer.update()
        return np.concatenate([points(own(name)) for name in LIMBS])

    rest, posed = picture(), picture(pose=True)
    assert np.abs(posed - rest).max() > 0.1
    new_file()
    with bpy.data.libraries.load(library, link=True) as (_, wanted):
        wanted.collections = ["Character"]
    bpy.context.scene.collection.children.link(wanted.collections[0])
    wanted.collections[0].override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    np.testing.assert_allclose(picture(), rest, atol=1e-5)
    np.testing.assert_allclose(picture(pose=True), posed, atol=1e-5)
    choose(own("Character Puppet"))
    with refused("'Character Puppet'", unchanged=False):
        bpy.ops.object.nested_cages_puppet()
    np.testing.assert_allclose(picture(), posed, atol=1e-5)
    assert bpy.ops.object.nested_cages_walk() == {"FINISHED"}
    bpy.context.scene.frame_set(7)
    walking = picture()
    assert np.abs(walking - posed).max() > 0.05
    save(tmp_path / "shot.blend", again=True)
    np.testing.assert_allclose(picture(), walking, atol=1e-5)
    assert bpy.ops.object.nested_cages_verify(whole=True) == {"FINISHED"}


def test_limbs_snap_between_their_controls_and_their_bones() -> None:
    armature = make(*figure().values())
    bones = armature.pose.bones
    leg = [bones["Leg.L"], bones["Leg.001.L"]]
    control, reach = bones["Leg.001 IK.L"], leg[1].constraints["IK"]

    def ends() -> np.ndarray:
        bpy.context.view_layer.update()
        return np.array([each.tail[:2] for each in bones if "IK" not in each.name])

    def snap(**options: str) -> set[str]:
        return bpy.ops.object.nested_cages_snap(**options)

    bones["Root"].location[0], bones["Torso"].rotation_euler[2] = 0.3, 0.2
    for turns in ((0.5, -0.7), (-0.4, 0.9)):  # the knee to both sides
        for each, turn in zip(leg, turns, strict=True):
            each.rotation_euler[2] = turn
        shown = ends()
        assert snap(control=control.name) == {"FINISHED"} and reach.influence == 1.0
        np.testing.assert_allclose(ends(), shown, atol=1e-3)
        control.location += type(control.location)((0.1, 0.2, 0.0))
        shown = ends()
        assert snap(control=control.name) == {"FINISHED"} and reach.influence == 0.0
        np.testing.assert_allclose(ends(), shown, atol=1e-5)
    control.location[1] -= 9.0  # out of reach
    reach.influence = 0.5
    shown = ends()
    assert snap(control=control.name) == snap(control=control.name) == {"FINISHED"} and reach.influence == 1.0
    np.testing.assert_allclose(ends(), shown, atol=1e-3)
    assert armature.animation_data is None
    bpy.ops.pose.select_all(action="DESELECT")
    with refused():
        snap()
    leg[0].keyframe_insert("rotation_euler", frame=1)
    reach.keyframe_insert("influence", frame=1)
    bpy.context.scene.frame_set(9)
    bpy.ops.pose.select_all(action="SELECT")
    others = [each for each in bones if (each.constraints.get("IK") or reach) != reach]
    assert snap() == {"FINISHED"} and reach.influence == 0.0
    assert len(others) == 3 and all(each.constraints["IK"].influence == 1.0 for each in others)

    def keyed() -> dict[str, int]:
        return {curve.data_path: len(curve.keyframe_points) for curve in curves_of(armature)}

    first = {f"{leg[0].path_from_id()}.rotation_euler": 2, f"{reach.path_from_id()}.influence": 2}
    assert keyed() == first
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    assert snap(control=control.name) == {"FINISHED"}
    own = {f"{leg[1].path_from_id()}.rotation_euler": 1, f"{control.path_from_id()}.location": 1}
    assert keyed() == first | own


def test_swapped_mouths_and_hands_stay_when_the_puppet_is_made_again() -> None:
    """Hidden ones too, though Blender doesn't move what is hidden."""
    drawings = figure()
    pairs = (("Hand.L", "Open Hand.L"), ("Smile", "Frown"))
    for name, loop, height in (
        ("Open Hand.L", capsule(LIMBS["Hand.L"][0], (1.55, 1.3), 0.13), 0.0055),
        ("Smile", capsule((-0.05, 1.6), (0.05, 1.6), 0.03), 0.02),
        ("Frown", capsule((-0.05, 1.6), (0.05, 1.6), 0.04), 0.021),
    ):
        drawings[name] = face(name, loop)
        drawings[name].location.z = height
    make(*drawings.values())
    armature: Any = bpy.context.object

    for pair in pairs:
        for frame, shown in zip((1, 5), pair, strict=True):
            for obj in (drawings[name] for name in pair):
                obj.hide_viewport = obj.hide_render = obj.name != shown
                obj.keyframe_insert("hide_viewport", frame=frame)
                obj.keyframe_insert("hide_render", frame=frame)

    def seen() -> dict[str, np.ndarray]:
        found: dict[str, np.ndarray] = {}
        for frame in (5, 1):
            bpy.context.scene.frame_set(frame)
            found |= {name: points(obj) for name, obj in drawings.items() if obj.visible_get() and name != "Badge"}
        return found

    turn(armature, Arm_L=30.0, Neck=25.0)
    armature.keyframe_insert("location")
    before = seen()
    heads = {each.name: each.head_local.copy() for each in armature.data.bones}
    make()
    assert [drawings[name].visible_get() for pair in pairs for name in pair] == [True, False] * 2
    assert set(before) == set(drawings) - {"Badge"}
    for name, wanted in seen().items():
        np.testing.assert_allclose(wanted, before[name], atol=1e-4, err_msg=name)
    for each in armature.data.bones:
        np.testing.assert_allclose(each.head_local, heads[each.name], atol=1e-5, err_msg=each.name)
