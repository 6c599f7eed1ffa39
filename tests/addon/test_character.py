"""Characters: many drawings of many kinds in one cage, and an armature that moves them all."""

from __future__ import annotations

import re

import bpy
import numpy as np
import pytest
from mathutils import Color, Matrix

from support.drawings import (
    add,
    at_frame,
    choose,
    evaluated,
    facts,
    grease_pencil,
    in_world,
    poly_curve,
    set_in,
    text,
    wire,
)
from support.engine_json import character_of
from support.marks import slow_after

# Ends and radius of each limb of a figure.
LIMBS = {
    "Torso": ((0.0, 0.2), (0.0, 1.0), 0.38),
    "Neck": ((0.0, 1.2), (0.0, 1.5), 0.12),
    "Head": ((0.0, 1.62), (0.0, 1.75), 0.3),
    "Arm.L": ((0.3, 1.15), (0.95, 1.12), 0.12),
    "Hand.L": ((0.9, 1.12), (1.6, 1.1), 0.1),
    "Arm.R": ((-0.3, 1.15), (-0.95, 1.12), 0.12),
    "Hand.R": ((-0.9, 1.12), (-1.6, 1.1), 0.1),
    "Leg.L": ((0.22, 0.0), (0.28, -1.3), 0.15),
    "Leg.R": ((-0.22, 0.0), (-0.28, -1.3), 0.15),
}


def capsule(start, end, radius, count=36, sides=8):
    """A loop (count + 2 · sides, 2) around a segment."""
    a, b = np.array(start), np.array(end)
    turn = np.arctan2(*(b - a)[::-1])
    half = np.linspace(-np.pi / 2.0, np.pi / 2.0, count // 2)
    ends = [
        c + radius * np.column_stack([np.cos(t), np.sin(t)]) for c, t in ((b, turn + half), (a, turn + np.pi + half))
    ]
    part = np.linspace(0.0, 1.0, sides + 2)[1:-1, None]
    there, back = ((1.0 - part) * p[-1] + part * q[0] for p, q in (ends, ends[::-1]))
    return np.concatenate([ends[0], there, ends[1], back])


def face(name, loop):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(x, y, 0.0) for x, y in loop], [], [list(range(len(loop)))])
    return add(name, mesh)


def figure():
    """The parts of a figure, of many kinds, in front of each other, all selected."""
    kinds = [face, lambda name, loop: poly_curve(name, [loop]), lambda name, loop: wire(name, [loop])]
    if hasattr(bpy.types, "GreasePencilDrawing"):
        kinds.append(lambda name, loop: grease_pencil(name, [loop]))
    made = {}
    for number, (name, limb) in enumerate(LIMBS.items()):
        made[name] = kinds[number % len(kinds)](name, capsule(*limb))
    made["Badge"] = text("Badge", "B")
    made["Badge"].data.size = 0.3
    made["Badge"].location = (-0.1, 0.5, 0.0)
    for number, obj in enumerate(made.values()):
        obj.location.z += 0.001 * number
    bpy.context.view_layer.update()
    return made


def points(obj):
    """Displayed points (n, 3) in the world."""
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    if obj.type == "GREASEPENCIL":
        strokes = [s for layer in shape.data.layers for s in layer.current_frame().drawing.strokes]
        found = np.array([point.position for stroke in strokes for point in stroke.points], np.float32)
        return in_world(shape, found)
    return in_world(shape, evaluated(obj))


def rigged(parts):
    """The armature and the cage of a figure with suggested bones."""
    assert bpy.ops.object.nested_cages_suggest_bones() == {"FINISHED"}
    armature = bpy.context.object
    assert bpy.ops.object.nested_cages_rig() == {"FINISHED"}
    assert bpy.context.object == armature and bpy.context.mode == "POSE"
    bpy.ops.object.mode_set(mode="OBJECT")
    return armature, next(obj for obj in bpy.data.objects if facts(obj).get("level") == 1)


def bone_at(armature, x, y):
    """The bone whose middle is nearest to a place."""
    middles = {bone: armature.matrix_world @ ((bone.head + bone.tail) / 2.0) for bone in armature.pose.bones}
    return min(middles, key=lambda bone: float(np.hypot(*(np.array(middles[bone])[:2] - (x, y)))))


def turn(armature, bone, degrees):
    """Turns a bone in the plane around its head."""
    head = Matrix.Translation(bone.head)
    bone.matrix = head @ Matrix.Rotation(np.deg2rad(degrees), 4, "Z") @ head.inverted() @ bone.matrix
    bpy.context.view_layer.update()


def key_turn(bone, frame, degrees):
    """Keys a turn of a bone in the plane."""
    local = bone.bone.matrix_local.to_3x3()
    turned = local.inverted() @ Matrix.Rotation(np.deg2rad(degrees), 3, "Z") @ local
    bone.rotation_quaternion = turned.to_quaternion()
    bone.keyframe_insert("rotation_quaternion", frame=frame)


@pytest.mark.slow
def test_suggested_bones_move_all_parts_of_a_figure(tmp_path) -> None:
    parts = figure()
    before = {name: points(obj) for name, obj in parts.items()}
    kept = {name: [m.name for m in obj.modifiers] for name, obj in parts.items()}
    armature, cage = rigged(parts)
    assert 7 <= len(armature.data.bones) <= 14
    for name, obj in parts.items():
        np.testing.assert_allclose(points(obj), before[name], atol=2e-5)
        assert [m.name for m in obj.modifiers] == [*kept[name], "Nested Cages Follow"]
        assert not set(obj.keys()) - {"nested_cages_member"}  # Blender 4.2 lists properties that were only read
    groups = {group.name for group in cage.vertex_groups}
    assert groups == {bone.name for bone in armature.data.bones}
    assert any(name.endswith(".L") for name in groups) and any(name.endswith(".R") for name in groups)
    sums = [sum(element.weight for element in vertex.groups) for vertex in cage.data.vertices]
    np.testing.assert_allclose(sums, 1.0, atol=1e-3)
    turn(armature, bone_at(armature, 1.3, 1.1), 40.0)
    after = {name: points(obj) for name, obj in parts.items()}
    moved = {name: np.abs(after[name] - before[name]).max() for name in parts}
    assert moved["Hand.L"] > 0.3 and max(moved[name] for name in ("Hand.R", "Leg.L", "Leg.R", "Head")) < 0.05
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "figure.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "figure.blend"))
    for name in LIMBS:
        np.testing.assert_allclose(points(bpy.data.objects[name]), after[name], atol=1e-6)


@pytest.mark.slow
def test_own_keys_of_a_part_play_before_the_bend_and_the_whole_moves() -> None:
    parts = figure()
    armature, _ = rigged(parts)
    hand = parts["Hand.L"]
    rest = points(hand)
    for frame, x in ((1, 0.0), (11, 0.1)):
        hand.location.x = x
        hand.keyframe_insert("location", frame=frame)
    turn(armature, bone_at(armature, 0.65, 1.1), 90.0)
    at_frame(1)
    here = points(hand)
    at_frame(11)
    way = points(hand) - here
    # Along the arm, which points up now.
    assert way[:, 1].mean() > 0.07 and np.abs(way[:, 0]).mean() < 0.05, way.mean(axis=0)
    assert np.abs(here - rest).max() > 0.3


def test_rigging_needs_bones_in_the_plane() -> None:
    figure()
    armature = bpy.data.armatures.new("Away")
    rig = add("Away", armature)
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.edit_bones.new("Up")
    bone.tail = (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode="OBJECT")
    with pytest.raises(RuntimeError, match="has no bone"):
        bpy.ops.object.nested_cages_rig()
    assert rig.select_get() and not [o for o in bpy.data.objects if "Cage" in o.name]


def instance():
    """An empty that shows a collection of one face, at the left hand."""
    home = bpy.data.collections.new("Glove")
    glove = face("Glove Face", capsule((0.0, 0.0), (0.1, 0.0), 0.05))
    bpy.context.scene.collection.objects.unlink(glove)
    home.objects.link(glove)
    home.instance_offset = (0.02, 0.0, 0.0)
    bpy.ops.object.collection_instance_add(collection="Glove", location=(1.5, 1.1, 0.02))
    return bpy.context.object


def instanced(empty):
    """Displayed points (n, 3) of what an empty instances, or of the object that shows it."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shown = [o for o in empty.children if o.type == "MESH"]
    if shown:
        return points(shown[0])
    return np.concatenate(
        [
            [o.matrix_world @ v.co for v in o.object.data.vertices]
            for o in depsgraph.object_instances
            if o.is_instance and o.parent.original == empty
        ]
    )


@pytest.mark.slow
def test_parts_added_later_and_instances_follow_and_are_verified() -> None:
    parts = figure()
    armature, cage = rigged(parts)
    ring = face("Ring", capsule((1.2, 1.1), (1.25, 1.1), 0.04))
    empty = instance()
    rest = {"Ring": points(ring), "Glove": instanced(empty)}
    choose(ring, empty, cage)
    assert bpy.ops.object.nested_cages_bind() == {"FINISHED"}
    np.testing.assert_allclose(instanced(empty), rest["Glove"], atol=1e-5)
    turn(armature, bone_at(armature, 1.3, 1.1), 40.0)
    assert np.abs(points(ring) - rest["Ring"]).max() > 0.1
    assert np.abs(instanced(empty) - rest["Glove"]).max() > 0.3
    choose(cage)
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert facts(cage)["check"].startswith("Holds"), facts(cage)["finding"]
    ring.location.y += 1.0
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert "does not enclose 'Ring'" in facts(cage)["finding"]
    assert bpy.ops.object.nested_cages_unbind() == {"FINISHED"}
    assert not ring.modifiers and empty.instance_type == "COLLECTION" and not empty.children


@pytest.mark.slow
def test_an_eye_in_a_head_follows_by_all_in_one_and_by_a_silhouette() -> None:
    head, eye = face("Head", capsule((0.0, 0.0), (0.0, 0.2), 1.0)), face("Eye", capsule((0.3, 0.2), (0.3, 0.3), 0.1))
    choose(eye, head)
    for silhouette in (False, True):
        if silhouette:
            assert bpy.ops.object.nested_cages_silhouette() == {"FINISHED"}
        assert bpy.ops.object.nested_cages_generate(levels="8", together=True) == {"FINISHED"}
        assert bpy.ops.object.nested_cages_bind() == {"FINISHED"}
        cage = bpy.context.object
        assert len(cage.data.vertices) == 8  # one loop: the eye is no hole
        before = points(eye)
        cage.data.transform(Matrix.Diagonal((1.5, 1.0, 1.0, 1.0)))
        bpy.context.view_layer.update()
        np.testing.assert_allclose(points(eye), before * (1.5, 1.0, 1.0), atol=1e-5)
        assert bpy.ops.object.nested_cages_unbind() == {"FINISHED"}
        choose(eye, head)


PARTS = ("Torso", "Hand.L", "Badge")


@pytest.mark.slow
@pytest.mark.parametrize("name", slow_after(1, PARTS, thorough_after=2))
def test_what_acts_on_a_part_acts_on_its_character(addon, name, capfd) -> None:
    """Generating, rigging and following: no other part is let go or left behind."""
    parts = figure()
    armature, cage = rigged(parts)
    (home,) = addon.record.CageSet.all_of(parts["Leg.R"])
    for again in (False, True):
        choose(parts[name], armature)
        work = bpy.ops.object.nested_cages_rig if again else bpy.ops.object.nested_cages_generate
        assert work(**({} if again else {"levels": "40"})) == {"FINISHED"}
        if bpy.context.mode == "POSE":
            bpy.ops.object.mode_set(mode="OBJECT")
        assert {addon.record.CageSet.all_of(part)[0] for part in parts.values()} == {home}
        assert set(set_in(home).originals) == set(parts.values()) and bool(set_in(home).bound)
        assert set_in(home).members[1] == cage
    assert f"shares its cages with {len(parts) - 1} drawings" in capfd.readouterr().out
    choose(parts[name])
    with pytest.raises(RuntimeError, match=f"shares its cages with {len(parts) - 1} drawings"):
        bpy.ops.object.nested_cages_follow(frame_start=1, frame_end=3)
    assert not bpy.ops.object.nested_cages_live.poll()
    before = {each: points(obj) for each, obj in parts.items()}
    turn(armature, bone_at(armature, 1.3, 1.1), 40.0)
    assert np.abs(points(parts["Hand.L"]) - before["Hand.L"]).max() > 0.3


@pytest.mark.slow
def test_a_part_of_a_copy_stands_for_the_copied_character(addon) -> None:
    parts = [face(name, capsule(*LIMBS[name])) for name in ("Torso", "Arm.L", "Hand.L")]
    choose(*parts)
    assert bpy.ops.object.nested_cages_generate(levels="30", together=True) == {"FINISHED"}
    bpy.context.scene.frame_set(9000)
    choose(*parts, bpy.data.objects["Hand.L Cage 1"])
    bpy.ops.object.duplicate()
    copies = [obj for obj in bpy.context.selected_objects if "Cage" not in obj.name]
    choose(copies[1])
    assert bpy.ops.object.nested_cages_generate(levels="20") == {"FINISHED"}
    for mine, count in ((parts, 30), (copies, 20)):
        (home,) = {home for part in mine for home in addon.record.CageSet.all_of(part)}
        assert set(set_in(home).originals) == set(mine)
        assert len(set_in(home).members[-1].data.vertices) == count


@pytest.mark.slow
@pytest.mark.parametrize("height", [2.1, 2.17], ids=["on the head", "a gap above it narrower than the usual clearance"])
def test_rigging_again_fits_the_cage_to_new_parts(height) -> None:
    parts = figure()
    armature, cage = rigged(parts)
    turn(armature, bone_at(armature, 1.3, 1.1), 10.0)
    hat = face("Hat", capsule((-0.3, height), (0.3, height), 0.1))
    choose(*parts.values(), hat, armature)
    assert bpy.ops.object.nested_cages_rig() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert cage.name in bpy.data.objects and [m.type for m in cage.modifiers].count("ARMATURE") == 1
    assert [m.name for m in hat.modifiers] == ["Nested Cages Follow"]
    assert all([m.name for m in part.modifiers] == ["Nested Cages Follow"] for part in parts.values())
    choose(cage)
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert facts(cage)["check"].startswith("Holds"), facts(cage)["finding"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "chosen", slow_after(1, ["a part and the cage", "two parts", "the cage and a part"], thorough_after=1)
)
def test_verification_of_some_parts_is_that_of_their_character(chosen) -> None:
    made = figure()
    parts, (_, cage) = list(made.values()), rigged(made)
    choose(*{"a part and the cage": (parts[0], cage), "two parts": parts[:2]}.get(chosen, (cage, parts[0])))
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert facts(cage)["check"].startswith("Holds")


@pytest.mark.slow
def test_verification_says_where_a_limb_folds_over_itself(capfd) -> None:
    """An elbow has room for 120 degrees, a neck of a head has not for 170."""
    armature, cage = rigged(figure())
    elbow, neck = bone_at(armature, 1.3, 1.1), bone_at(armature, 0.0, 1.5)
    scene = bpy.context.scene
    for frame, bent, nod in ((1, 0.0, 0.0), (3, 120.0, 0.0), (4, 0.0, 0.0), (5, 0.0, 170.0), (6, 0.0, 170.0)):
        key_turn(elbow, frame, bent)
        key_turn(neck, frame, nod)
    choose(cage)
    for first, last, verdict in ((1, 3, "Holds on 1 – 3"), (5, 6, "Broken on frame 5")):
        scene.frame_start, scene.frame_end = first, last
        assert bpy.ops.object.nested_cages_verify(whole=True) == {"FINISHED"}
        assert facts(cage)["check"] == verdict, facts(cage)["finding"]
    scene.frame_set(5)
    pattern = rf"Frame 5: 'Torso Fine' bends '{neck.name}' over itself: (.*) % of its area"
    told = capfd.readouterr().out
    found = re.search(pattern, told)
    assert found, told
    assert bpy.ops.object.nested_cages_select_fault(cage=cage.name) == {"FINISHED"}
    assert np.hypot(*(bpy.context.scene.cursor.location - armature.matrix_world @ neck.head)[:2]) < 0.6
    assert 0.1 < float(found[1]) < 20.0


@pytest.mark.slow
def test_a_limb_that_passes_over_the_body_is_not_broken(addon) -> None:
    armature, cage = rigged(figure())
    record, results = addon.record, addon.ui.results
    bones = bone_at(armature, 0.6, 1.1), bone_at(armature, 1.3, 1.1)
    choose(cage)

    def verified(*degrees: float) -> tuple[str, str]:
        for bone in bones:
            bone.matrix_basis = Matrix()
        bpy.context.view_layer.update()
        for bone, angle in zip(bones, degrees, strict=True):
            turn(armature, bone, angle)
        assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
        node = record.node_of(cage)
        return node.check, " ".join(record.sentences(node, checks=True, others=False))

    assert verified(0.0, 0.0)[0] == record.HOLDS and "passes" not in verified(20.0, 20.0)[1]
    check, told = verified(-75.0, -80.0)
    assert check == record.HOLDS and "passes over itself" in told
    fine = bpy.data.objects["Torso Fine"]
    max(fine.data.vertices, key=lambda vertex: vertex.co.x).co.x += 0.4  # out of the cage
    assert verified(-75.0, -80.0)[0] == record.FAULT
    assert results.health(bpy.context, cage)[0] == results.BROKEN
    for bone in bones:  # in another pose nothing is known, and at rest it was never broken
        bone.matrix_basis = Matrix()
    bpy.context.view_layer.update()
    assert results.health(bpy.context, cage) == (results.MADE, "")


@pytest.mark.slow
def test_a_character_is_written_and_posed_without_blender(core, tmp_path) -> None:
    parts = figure()
    armature, cage = rigged(parts)
    choose(cage)
    path = tmp_path / "figure.json"
    assert bpy.ops.object.nested_cages_export(filepath=str(path), kind="CHARACTER", flip_y=False) == {"FINISHED"}
    found = character_of(path.read_text())
    assert {bone.name for bone in found.bones} == {bone.name for bone in armature.data.bones}
    bone = bone_at(armature, 1.3, 1.1)
    turn(armature, bone, 40.0)
    shape, around = found.posed({bone.name: 40.0})
    np.testing.assert_allclose(evaluated(cage)[:, :2], around, atol=1e-5)
    fine = bpy.data.objects["Torso Fine"]
    error = np.abs(evaluated(fine)[:, :2] - shape)
    assert error.max() < 0.02 and np.abs(shape - found.shape.vertices).max() > 0.3, error.max()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.render.fps = 1, 3, 10
    for frame, degrees in ((1, 0.0), (3, 40.0)):
        key_turn(bone, frame, degrees)
    options = {"filepath": str(path), "kind": "CHARACTER", "flip_y": True, "frames": True}
    assert bpy.ops.object.nested_cages_export(**options) == {"FINISHED"}
    frames = character_of(path.read_text(), flip_y=0.0).frames
    assert [round(frame.time, 6) for frame in frames] == [0.0, 0.1, 0.2]
    np.testing.assert_allclose(frames[0].shape, found.shape.vertices, atol=1e-4)
    for frame, (_, shape, posed) in enumerate(frames, 1):
        scene.frame_set(frame)
        np.testing.assert_allclose(evaluated(fine)[:, :2], shape, atol=1e-6)
        np.testing.assert_allclose(evaluated(cage)[:, :2], posed, atol=1e-6)
    np.testing.assert_allclose(frames[2].cage, around, atol=1e-4)
    bpy.ops.object.nested_cages_unbind()
    cage.modifiers.clear()
    with pytest.raises(RuntimeError, match="follows no armature"):
        bpy.ops.object.nested_cages_export(filepath=str(path), kind="CHARACTER")


@pytest.mark.slow
def test_parts_are_swapped_on_frames_and_by_one_control_and_change_their_order() -> None:
    """The steps of the guide."""
    parts = figure()
    parts |= {name: face(name, capsule((-0.08, y), (0.08, y), 0.04)) for name, y in (("Smile", 1.6), ("Grin", 1.62))}
    armature, _ = rigged(parts)
    smile, grin, badge, torso = (parts[name] for name in ("Smile", "Grin", "Badge", "Torso"))
    for obj, first in ((smile, False), (grin, True)):
        for frame, hidden in ((1, first), (5, not first)):
            obj.hide_viewport = obj.hide_render = hidden
            obj.keyframe_insert("hide_viewport", frame=frame)
            obj.keyframe_insert("hide_render", frame=frame)
    armature["shown"] = 1
    for number, name in enumerate(("Hand.L", "Hand.R"), 1):
        for switch in ("hide_viewport", "hide_render"):
            driver = parts[name].driver_add(switch).driver
            variable = driver.variables.new()
            variable.targets[0].id, variable.targets[0].data_path = armature, '["shown"]'
            driver.expression = f"var != {number}"
    for frame, height in ((1, 0.02), (5, -0.02)):
        badge.location.z = height
        badge.keyframe_insert("location", index=2, frame=frame)
    key_turn(bone_at(armature, 0.0, 1.5), 1, 30.0)
    for frame, swapped in ((1, False), (5, True)):
        armature["shown"] = 1 + swapped
        armature.update_tag()
        at_frame(frame)
        assert (smile.visible_get(), grin.visible_get()) == (not swapped, swapped)
        assert (parts["Hand.L"].visible_get(), parts["Hand.R"].visible_get()) == (not swapped, swapped)
        assert (points(badge)[:, 2].mean() > points(torso)[:, 2].mean()) != swapped
        shown = points(grin if swapped else smile)
        assert shown[:, 0].mean() < -0.05  # nods with the head


@pytest.mark.slow
def test_a_character_is_copied_appended_and_redrawn(tmp_path) -> None:
    parts = figure()
    armature, cage = rigged(parts)
    turn(armature, bone_at(armature, 1.3, 1.1), 40.0)
    wanted = {name: points(obj) for name, obj in parts.items()}
    # A part is redrawn: pressing Rig again keeps the armature, its pose and the cage.
    hand = parts["Hand.R"]
    hand.data = face("Drawn", capsule((-0.9, 1.12), (-1.75, 1.2), 0.13)).data
    bpy.data.objects.remove(bpy.data.objects["Drawn"])
    wanted["Hand.R"] = None
    choose(*parts.values(), armature)
    assert bpy.ops.object.nested_cages_rig() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert np.linalg.norm(points(parts["Hand.L"]) - wanted["Hand.L"], axis=1).max() < 0.1
    choose(cage)
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert facts(cage)["check"].startswith("Holds"), facts(cage)["finding"]
    wanted = {name: points(obj) for name, obj in parts.items()}
    # A copy of everything that is seen moves on its own.
    choose(*parts.values(), cage, armature)
    assert bpy.ops.object.duplicate() == {"FINISHED"}
    copies = {obj.name.rsplit(".", 1)[0]: obj for obj in bpy.context.selected_objects}
    double = next(obj for obj in bpy.context.selected_objects if obj.type == "ARMATURE")
    turn(double, bone_at(double, 0.0, 1.7), 40.0)
    for name, obj in parts.items():
        np.testing.assert_allclose(points(obj), wanted[name], atol=1e-5)
    assert np.abs(points(copies["Head"]) - wanted["Head"]).max() > 0.1
    # Appended into another file, it shows the same and can be posed.
    path = str(tmp_path / "figure.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    names = list(parts)
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(path) as (source, target):
        target.objects = [name for name in source.objects if name in {*names, armature_name(source.objects)}]
    for obj in target.objects:
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    for name in names:
        np.testing.assert_allclose(points(bpy.data.objects[name]), wanted[name], atol=1e-5)
    again = next(obj for obj in target.objects if obj.type == "ARMATURE")
    turn(again, bone_at(again, 0.0, 1.7), 40.0)
    assert np.abs(points(bpy.data.objects["Head"]) - wanted["Head"]).max() > 0.1


def armature_name(names):
    return next(name for name in names if name.endswith("Bones"))


# Fill and stroke of each part of a layered drawing, as a style sheet names them, and the width of its stroke.
PAINTS = {"skin": ("#cc8844", "#221100", 3.0), "cloth": ("teal", "none", 0.0), "ink": ("rgb(20 30 40)", "#fff", 1.5)}
LAYERS = {
    "Body": {"Torso": "cloth", "Neck": "skin", "Head": "skin", "Badge": "ink"},
    "Left": {"Arm.L": "cloth", "Hand.L": "skin", "Leg.L": "cloth", "Shoe.L": "ink"},
    "Right": {"Arm.R": "cloth", "Hand.R": "skin", "Leg.R": "cloth", "Shoe.R": "ink"},
}
MORE = {
    "Badge": ((-0.05, 0.7), (0.05, 0.7), 0.08),
    "Shoe.L": ((0.28, -1.35), (0.45, -1.38), 0.1),
    "Shoe.R": ((-0.28, -1.35), (-0.45, -1.38), 0.1),
}


def layered_svg():
    def path(name, kind):
        loop = capsule(*{**LIMBS, **MORE}[name])
        return f'<path id="{name}" class="{kind}" d="M{" L".join(f"{100 * x:.2f},{-100 * y:.2f}" for x, y in loop)}Z"/>'

    styles = "".join(f".{k}{{fill:{f};stroke:{s};stroke-width:{w}px}}" for k, (f, s, w) in PAINTS.items())
    layers = "".join(
        f'<g id="{group}">{"".join(path(name, kind) for name, kind in parts.items())}</g>'
        for group, parts in LAYERS.items()
    )
    head = 'xmlns="http://www.w3.org/2000/svg" viewBox="-200 -250 400 450"'
    return f"<svg {head}><style>{styles}</style>{layers}</svg>"


ODD = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 200"><defs>
<linearGradient id="g"><stop offset="0" stop-color="red"/><stop offset="1" stop-color="blue"/></linearGradient>
<pattern id="p" width="4" height="4"><rect width="4" height="4" fill="#f00"/><path d="M0,0H2" fill="#0f0"/></pattern>
<symbol id="s"><circle cx="10" cy="10" r="8"/></symbol></defs>
<g id="Outer" transform="translate(10 10)"><g id="Inner" transform="rotate(20) scale(2)">
<rect id="Faded" x="20" width="20" height="30" fill="url(#g)"/></g></g>
<rect id="Woven" x="120" y="20" width="40" height="60" fill="url(#p)"/>
<use id="Button" href="#s" x="100" y="100" fill="green"/>
<path id="Line" d="M10,150 C50,120 90,190 140,150" fill="none" stroke="purple" stroke-width="6"/>
<text x="20" y="190">Hello</text></svg>"""


@pytest.mark.slow
def test_gradients_patterns_uses_and_lines_become_parts_and_the_rest_is_told(tmp_path, capfd) -> None:
    file = tmp_path / "odd.svg"
    file.write_text(ODD)
    assert bpy.ops.object.nested_cages_import(filepath=str(file), outlines="PARTS") == {"FINISHED"}
    parts = {obj.name: obj for obj in bpy.context.selected_objects}
    fills = {name: obj.data.materials[0].name.partition("#")[2] for name, obj in parts.items()}
    assert fills == {"Faded": "800080", "Woven": "808000", "Button 3": "008000", "Line": "800080"}
    homes = {name: obj.users_collection[0].name for name, obj in parts.items()}
    assert homes == {"Faded": "Inner", "Woven": "odd", "Button 3": "Button", "Line": "odd"}
    told = capfd.readouterr().out
    for sentence in ("Gradients become their mean colour", "Patterns become their mean colour", "1 text"):
        assert f"'odd.svg': {sentence}" in told or sentence in told, told
    assert bpy.ops.object.nested_cages_suggest_bones() == {"FINISHED"}
    assert bpy.ops.object.nested_cages_rig() == {"FINISHED"}


@pytest.mark.slow
def test_a_layered_svg_of_twelve_parts_is_posed_after_four_actions(tmp_path) -> None:
    file = tmp_path / "figure.svg"
    file.write_text(layered_svg())
    actions = [lambda: bpy.ops.object.nested_cages_import(filepath=str(file), plane="XY", centre=False)]
    assert actions[0]() == {"FINISHED"}
    parts = {obj.name: obj for obj in bpy.context.selected_objects}
    wanted = {name: (group, kind) for group, layer in LAYERS.items() for name, kind in layer.items()}
    assert sorted(parts, key=lambda name: parts[name].location.z) == list(wanted) and len(parts) == 12
    codes = {"teal": "008080", "rgb(20 30 40)": "141E28", "#fff": "FFFFFF"}
    for name, (group, kind) in wanted.items():
        obj = parts[name]
        assert [home.name for home in obj.users_collection] == [group]
        paints = [paint for paint in PAINTS[kind][:2] if paint != "none"]
        code = [codes.get(paint, paint.lstrip("#").upper()) for paint in paints]
        words = [f"{word} #{each}" for word, each in zip(("Fill", "Stroke"), code, strict=False)]
        assert [material.name for material in obj.data.materials] == words
        linear = Color([int(code[0][k : k + 2], 16) / 255.0 for k in (0, 2, 4)]).from_srgb_to_scene_linear()
        np.testing.assert_allclose(obj.data.materials[0].diffuse_color, (*linear, 1.0), atol=1e-6)
        # The stroke is centred on the outline: its area is that of its width along it.
        loop = np.array(capsule(*{**LIMBS, **MORE}[name]))
        length = np.linalg.norm(loop - np.roll(loop, -1, axis=0), axis=1).sum()
        areas = np.zeros(2)
        for face in obj.data.polygons:
            areas[face.material_index] += face.area
        assert areas[1] == pytest.approx(0.01 * PAINTS[kind][2] * length, rel=0.02)
    assert bpy.data.collections["figure"].children.keys() == list(LAYERS)
    before = {name: points(obj) for name, obj in parts.items()}
    actions += [bpy.ops.object.nested_cages_suggest_bones, bpy.ops.object.nested_cages_rig]
    for action in actions[1:]:
        assert action() == {"FINISHED"}
    armature, cage = bpy.context.object, next(obj for obj in bpy.data.objects if facts(obj).get("level") == 1)
    hand = before["Hand.L"].mean(axis=0)
    actions.append(lambda: turn(armature, bone_at(armature, hand[0], hand[1]), 40.0))
    actions[-1]()
    assert len(actions) <= 5
    moved = {name: np.abs(points(obj) - before[name]).max() for name, obj in parts.items()}
    assert moved["Hand.L"] > 0.3 > 6.0 * max(moved[name] for name in ("Hand.R", "Leg.L", "Shoe.R", "Badge"))
    bpy.ops.object.mode_set(mode="OBJECT")
    choose(cage)
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert facts(cage)["check"].startswith("Holds"), facts(cage)["finding"]
