"""Characters: many drawings of many kinds in one cage, and an armature that moves them all."""

import re
from typing import Any

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from support import drawings
from support.blender import new_file, refused
from support.drawings import armature, at_frame, bind, certificate, checked, choose, save, set_of, verify
from support.figure import LIMBS, bone_at, capsule, face, figure, key_turn, points, rigged, turn
from support.marks import slow_after
from support.panels import draw

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def saved(extension: Any, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, list[str], str]:
    """A file with a figure in one cage that suggested bones move; the names of its parts and of its armature."""
    new_file()
    parts = figure()
    armature, _ = rigged(parts)
    return save(tmp_path_factory.mktemp("figure") / "figure.blend"), list(parts), armature.name


@pytest.fixture
def character(saved: tuple[str, list[str], str]) -> tuple[dict[str, Any], Any, Any]:
    """The parts of a figure, its armature and its cage."""
    path, names, armature = saved
    bpy.ops.wm.open_mainfile(filepath=path)
    parts = {name: bpy.data.objects[name] for name in names}
    return parts, bpy.data.objects[armature], set_of(parts["Torso"]).cages[0]


Character = tuple[dict[str, Any], Any, Any]


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


def test_own_keys_of_a_part_play_before_the_bend_and_the_whole_moves(character: Character) -> None:
    parts, armature, _ = character
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
    rig = armature("Away", Up=((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    with refused("'Away'"):
        bpy.ops.object.nested_cages_puppet(source="ONE_CAGE")
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


def test_parts_added_later_and_instances_follow_and_are_verified(character: Character) -> None:
    _, armature, cage = character
    ring = face("Ring", capsule((1.2, 1.1), (1.25, 1.1), 0.04))
    empty = instance()
    rest = {"Ring": points(ring), "Glove": instanced(empty)}
    choose(ring, empty, cage)
    bind()
    np.testing.assert_allclose(instanced(empty), rest["Glove"], atol=1e-5)
    turn(armature, bone_at(armature, 1.3, 1.1), 40.0)
    assert np.abs(points(ring) - rest["Ring"]).max() > 0.1
    assert np.abs(instanced(empty) - rest["Glove"]).max() > 0.3
    choose(cage)
    assert verify(cage), certificate(cage).finding
    ring.location.y += 1.0
    assert not verify(cage) and "'Ring'" in certificate(cage).finding
    assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}
    assert not ring.modifiers and empty.instance_type == "COLLECTION" and not empty.children


def test_an_eye_in_a_head_follows_by_all_in_one_and_by_a_silhouette() -> None:
    head, eye = face("Head", capsule((0.0, 0.0), (0.0, 0.2), 1.0)), face("Eye", capsule((0.3, 0.2), (0.3, 0.3), 0.1))
    choose(eye, head)
    for silhouette in (False, True):
        if silhouette:
            assert bpy.ops.object.nested_cages_import(outlines="SELECTED") == {"FINISHED"}
        drawings.generate("8", together=True)
        bind()
        cage = bpy.context.object
        assert len(cage.data.vertices) == 8  # one loop: the eye is no hole
        bpy.context.scene.frame_set(bpy.context.scene.frame_end)  # no animation plays in place of the drawings
        before = points(eye)
        cage.data.transform(Matrix.Diagonal((1.5, 1.0, 1.0, 1.0)))
        bpy.context.view_layer.update()
        np.testing.assert_allclose(points(eye), before * (1.5, 1.0, 1.0), atol=1e-5)
        assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}
        choose(eye, head)


PARTS = ("Torso", "Hand.L", "Badge")


@pytest.mark.parametrize("name", slow_after(1, PARTS[::-1], thorough_after=1))
def test_what_acts_on_a_part_acts_on_its_character(character: Character, name, reports) -> None:
    """Generating, rigging and following: no other part is let go or left behind."""
    parts, armature, cage = character
    (home,) = drawings.sets().all_of(parts["Leg.R"])
    for again in (False, True):
        choose(parts[name], armature)
        if again:
            assert bpy.ops.object.nested_cages_puppet(source="ONE_CAGE") == {"FINISHED"}
        else:
            drawings.generate("40")
        if bpy.context.mode == "POSE":
            bpy.ops.object.mode_set(mode="OBJECT")
        assert {set_of(part) for part in parts.values()} == {home}
        assert set(home.parts) == set(parts.values()) and home.bound and home.cages == [cage]
    assert str(len(parts) - 1) in reports.read("Info")  # so many others share its cages
    choose(parts[name])
    with refused("'Torso'", unchanged=False):
        bpy.ops.object.nested_cages_follow(frame_start=1, frame_end=3)
    assert not bpy.ops.object.nested_cages_live.poll()
    before = {each: points(obj) for each, obj in parts.items()}
    turn(armature, bone_at(armature, 1.3, 1.1), 40.0)
    assert np.abs(points(parts["Hand.L"]) - before["Hand.L"]).max() > 0.3


@pytest.mark.parametrize("height", slow_after(1, [2.17, 2.1], thorough_after=1))  # a narrow gap above the head, or none
def test_rigging_again_fits_the_cage_to_new_parts(character: Character, height) -> None:
    parts, armature, cage = character
    turn(armature, bone_at(armature, 1.3, 1.1), 10.0)
    hat = face("Hat", capsule((-0.3, height), (0.3, height), 0.1))
    choose(*parts.values(), hat, armature)
    assert bpy.ops.object.nested_cages_puppet(source="ONE_CAGE") == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert cage.name in bpy.data.objects and [m.type for m in cage.modifiers].count("ARMATURE") == 1
    assert [m.name for m in hat.modifiers] == ["Nested Cages Follow"]
    assert all([m.name for m in part.modifiers] == ["Nested Cages Follow"] for part in parts.values())
    choose(cage)
    assert verify(cage), certificate(cage).finding


@pytest.mark.parametrize(
    "chosen", slow_after(1, ["a part and the cage", "two parts", "the cage and a part"], thorough_after=1)
)
def test_verification_of_some_parts_is_that_of_their_character(character: Character, chosen) -> None:
    made, _, cage = character
    parts = list(made.values())
    choose(*{"a part and the cage": (parts[0], cage), "two parts": parts[:2]}.get(chosen, (cage, parts[0])))
    assert verify(cage)


def test_verification_says_where_a_limb_folds_over_itself(character: Character, reports) -> None:
    """An elbow has room for 120 degrees, a neck of a head has not for 170."""
    _, armature, cage = character
    elbow, neck = bone_at(armature, 1.3, 1.1), bone_at(armature, 0.0, 1.5)
    scene = bpy.context.scene
    for frame, bent, nod in ((1, 0.0, 0.0), (3, 120.0, 0.0), (4, 0.0, 0.0), (5, 0.0, 170.0), (6, 0.0, 170.0)):
        key_turn(elbow, frame, bent)
        key_turn(neck, frame, nod)
    choose(cage)
    for first, last, wanted, frames in ((1, 3, True, [1, 3]), (5, 6, False, [5])):
        scene.frame_start, scene.frame_end = first, last
        assert verify(cage, whole=True) is wanted and checked(cage) == frames, certificate(cage).finding
    scene.frame_set(5)
    (told,) = [line for line in reports.read("Warning").splitlines() if f"'{neck.name}'" in line]
    (part,) = map(float, re.findall(r"([\d.]+) %", told))
    assert bpy.ops.object.nested_cages_select_fault(cage=cage.name) == {"FINISHED"}
    assert np.hypot(*(bpy.context.scene.cursor.location - armature.matrix_world @ neck.head)[:2]) < 0.6
    assert 0.1 < part < 20.0


def test_a_limb_that_passes_over_the_body_is_not_judged(character: Character) -> None:
    _, armature, cage = character
    bones = bone_at(armature, 0.6, 1.1), bone_at(armature, 1.3, 1.1)
    choose(cage)

    def verified(*degrees: float) -> tuple[bool, str]:
        for bone in bones:
            bone.matrix_basis = Matrix()
        bpy.context.view_layer.update()
        for bone, angle in zip(bones, degrees, strict=True):
            turn(armature, bone, angle)
        return verify(cage), certificate(cage).finding

    assert verified(0.0, 0.0)[0]
    holds, told = verified(20.0, 20.0)
    over, more = verified(-75.0, -80.0)
    assert holds and not over and "%" in told and "%" not in more
    assert certificate(cage).verdict == "Not judged" and "object.nested_cages_select_fault" not in draw()
    max(cage.data.vertices, key=lambda vertex: vertex.co.x).co.x -= 0.4  # into the drawing
    assert not verified(20.0, 20.0)[0]
    broken = draw()
    assert "object.nested_cages_select_fault" in broken
    for bone in bones:  # in another pose nothing is known, and at rest it was never broken
        bone.matrix_basis = Matrix()
    bpy.context.view_layer.update()
    assert len(draw()) < len(broken)


def test_a_copy_of_a_character_moves_on_its_own(character: Character) -> None:
    parts, armature, cage = character
    turn(armature, bone_at(armature, 1.3, 1.1), 40.0)
    wanted = {name: points(obj) for name, obj in parts.items()}
    choose(*parts.values(), cage, armature)
    assert bpy.ops.object.duplicate() == {"FINISHED"}
    copies = {obj.name.rsplit(".", 1)[0]: obj for obj in bpy.context.selected_objects}
    double = next(obj for obj in bpy.context.selected_objects if obj.type == "ARMATURE")
    turn(double, bone_at(double, 0.0, 1.7), 40.0)
    for name, obj in parts.items():
        np.testing.assert_allclose(points(obj), wanted[name], atol=1e-5)
    assert np.abs(points(copies["Head"]) - wanted["Head"]).max() > 0.1


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


def test_gradients_patterns_uses_and_lines_become_parts_and_the_rest_is_told(tmp_path, reports) -> None:
    file = tmp_path / "odd.svg"
    file.write_text(ODD)
    assert bpy.ops.object.nested_cages_import(filepath=str(file), outlines="PARTS") == {"FINISHED"}
    parts = {obj.name: obj for obj in bpy.context.selected_objects}
    fills = {name: obj.data.materials[0].name.partition("#")[2] for name, obj in parts.items()}
    assert fills == {"Faded": "", "Woven": "808000", "Button 3": "008000", "Line": "800080"}
    (gradient,) = (node.image for node in parts["Faded"].active_material.node_tree.nodes if hasattr(node, "image"))
    red = gradient.pixels[:][::4]
    assert min(red) < 0.1 and max(red) > 0.9 and gradient.packed_file
    assert parts["Button 3"].data.materials[0].diffuse_color[:] == pytest.approx((0.0, 0.21586, 0.0, 1.0), abs=1e-4)
    homes = {name: obj.users_collection[0].name for name, obj in parts.items()}
    assert homes == {"Faded": "Inner", "Woven": "odd", "Button 3": "Button", "Line": "odd"}
    told = reports.read().splitlines()
    assert len([line for line in told if "'odd.svg'" in line]) >= 2  # patterns, a text
    assert bpy.ops.object.nested_cages_puppet(source="BONES") == {"FINISHED"}
    assert bpy.ops.object.nested_cages_puppet(source="ONE_CAGE") == {"FINISHED"}
