"""The record of a set of cages: saved files, and sets that are moved, renamed, copied or lose a collection."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest

from support.drawings import circle, evaluated, facts, grid_face, poly_curve, set_in, star, text, wire
from support.marks import slow_after

MAKE = {
    "curve": lambda: poly_curve("Drawing", [star()]),
    "mesh": lambda: grid_face("Drawing"),
    "text": lambda: text("Drawing", "Hi"),
}


def choose(*objects) -> None:
    """Selects these objects alone, the last of them active, whatever hides them."""
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.hide_viewport = False
        obj.hide_set(False)
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[-1]


def caged(kind: str = "curve", *, bind: bool = False, **settings):
    """A drawing with two cages, bound or not, and its collection."""
    source = MAKE[kind]()
    bpy.ops.object.nested_cages_generate(levels="24, 12", **settings)
    if bind:
        bpy.ops.object.nested_cages_bind()
    return source, bpy.data.collections["Drawing Cages"]


def stretch(cage) -> None:
    """Moves the corners of a cage apart."""
    for vertex in cage.data.vertices:
        vertex.co *= 1.5
    cage.data.update()
    bpy.context.view_layer.update()


def moved_by(source, cage) -> float:
    """How far a drawing moves with a cage."""
    before = evaluated(source).copy()
    stretch(cage)
    return float(np.abs(evaluated(source) - before).max())


@pytest.mark.slow
@pytest.mark.parametrize("bound", slow_after(1, [False, True]), ids=["free", "bound"])
def test_a_saved_file_works_as_before(addon, bound, tmp_path) -> None:
    record = addon.record
    bpy.context.scene.frame_end = 20
    parts = [wire(name, [circle(8, 0.1, (x, 0.0))]) for name, x in (("Left", -9.0), ("Right", 9.0))]
    choose(*parts)
    bpy.ops.object.nested_cages_silhouette()
    bpy.context.object.name = "Both"
    bpy.ops.object.select_all(action="DESELECT")
    caged(bind=bound)
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene, source = bpy.context.scene, bpy.data.objects["Drawing"]
    collection = bpy.data.collections["Drawing Cages"]
    choose(source)
    assert [obj.name for obj in record.shown_in(bpy.data.objects["Both"])] == ["Right", "Left"]
    assert record.range_of(scene) == (1, 20, 1, scene.frame_end) and scene.frame_end > 20
    members = set_in(collection).members
    assert [record.level_of(obj) for obj in members] == [0, 1, 2]
    assert record.CageSet.all_of(source) == [set_in(collection)] and bool(set_in(collection).bound) is bound
    assert addon.generation.output.duration(set_in(collection), addon.animation.timeline.Timing()) is not None
    assert bpy.ops.object.nested_cages_report() == {"FINISHED"}
    assert "Certified as stored" in bpy.data.texts["Nested Cages Report"].as_string()
    if bound:
        assert bpy.ops.object.nested_cages_rebind() == {"FINISHED"}
        assert bpy.ops.object.nested_cages_unbind() == {"FINISHED"}
    choose(source)
    scene.frame_set(1)
    assert source.hide_viewport  # its moving copy plays
    scene.frame_set(facts(collection)["end"])
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert record.node_of(members[1]).check == record.HOLDS
    markers = len(scene.timeline_markers)
    assert bpy.ops.object.nested_cages_generate(levels="16") == {"FINISHED"}
    assert len(set_in(collection).members) == 2 and len(scene.timeline_markers) == markers
    assert set_in(collection).record.known and set_in(collection).record.settings.levels == "16"
    assert bpy.ops.object.nested_cages_remove_animation() == {"FINISHED"}
    assert scene.frame_end == 20 and record.range_of(scene) is None


@pytest.mark.slow
def test_a_set_is_known_by_its_objects_wherever_they_are(addon) -> None:
    """Moved to other collections and scenes, renamed, with another parent, and with the collection removed."""
    source, collection = caged(bind=True)
    scene = bpy.context.scene
    fine, finer, coarsest = set_in(collection).members
    choose(source)
    bpy.ops.object.nested_cages_add_handles()
    bpy.ops.object.mode_set(mode="OBJECT")
    rig = bpy.context.view_layer.objects.active
    controls, parent = bpy.data.collections.new("Controls"), bpy.data.objects.new("Root", None)
    scene.collection.children.link(controls)
    controls.objects.link(parent)
    for obj in (coarsest, rig):
        collection.objects.unlink(obj)
        controls.objects.link(obj)
    coarsest.name = source.name = "Renamed"
    assert set_in(collection).members == [fine, finer, coarsest]
    bpy.context.view_layer.update()
    assert moved_by(fine, coarsest) > 0.1
    for vertex in coarsest.data.vertices:
        vertex.co /= 1.5
    choose(source)
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert all(addon.record.node_of(cage).check == addon.record.HOLDS for cage in (finer, coarsest))
    bpy.ops.object.nested_cages_generate(levels="20, 10")
    assert set_in(collection).members == [fine, finer, coarsest] and len(coarsest.data.vertices) == 10
    assert len(bpy.data.collections) == 2
    for obj in (fine, finer):
        controls.objects.link(obj)
    bpy.data.collections.remove(collection)
    choose(source)
    assert bpy.ops.object.nested_cages_unbind() == {"FINISHED"}
    (found,) = addon.record.CageSet.all_of(source)
    assert set_in(found).members == [fine, finer, coarsest] and not bool(set_in(found).bound)
    assert set_in(found).record.settings.levels == "20, 10" and set(controls.objects) >= {fine, finer, coarsest}


@pytest.mark.parametrize("kind", slow_after(0, MAKE, thorough_after=1))
@pytest.mark.parametrize("how", ["duplicated", "instanced", "scene copied", "appended"])
def test_a_copy_is_a_character_of_its_own(addon, kind, how, tmp_path) -> None:
    source, collection = caged(kind, bind=True)
    objects = [source, *set_in(collection).members]
    before = set(bpy.data.objects)
    if how == "duplicated":
        choose(*objects)
        bpy.ops.object.duplicate()
    elif how == "scene copied":
        bpy.ops.scene.new(type="FULL_COPY")
    elif how == "appended":
        path = str(tmp_path / "character.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
        bpy.ops.wm.append(directory=path + "/Object/", filename=source.name)
    else:
        home, instance = bpy.data.collections.new("Character"), bpy.data.objects.new("Instance", None)
        home.objects.link(source)
        home.children.link(collection)
        bpy.context.scene.collection.objects.unlink(source)
        bpy.context.scene.collection.children.unlink(collection)
        instance.instance_type, instance.instance_collection = "COLLECTION", home
        bpy.context.scene.collection.objects.link(instance)
        bpy.context.view_layer.update()
        choose(instance)
        bpy.ops.object.duplicates_make_real(use_base_parent=True, use_hierarchy=True)
        bpy.context.scene.collection.children.link(home)
    new = set(bpy.data.objects) - before
    (own,) = {found for obj in new for found in addon.record.CageSet.all_of(obj)} - {set_in(objects[1])}
    copy, original = own.source, set_in(objects[1])
    assert copy in new and set(own.cages) <= new and original.members == objects[1:]
    if how == "instanced":  # Blender lets them share their meshes, as with a linked duplicate
        own.cages[-1].data = own.cages[-1].data.copy()
    assert moved_by(objects[1], own.cages[-1]) == 0.0
    assert moved_by(copy, original.cages[-1]) == 0.0
    assert moved_by(copy, own.cages[-1]) > 0.1
    choose(copy)
    assert bpy.ops.object.nested_cages_unbind() == {"FINISHED"}
    assert original.bound and not own.bound
    assert bpy.ops.object.nested_cages_generate(levels="16") == {"FINISHED"}
    assert [len(set_in(found).members) for found in (collection, own)] == [3, 2]
    meshes = [obj.data for found in (collection, own) for obj in set_in(found).members]
    assert len(set(meshes)) == len(meshes)


@pytest.mark.slow
@pytest.mark.skipif(bpy.app.version < (4, 3), reason="Blender 4.2 tells nothing of imports")
def test_append_makes_no_objects_of_kept_meshes_and_removes_none_of_before(addon, tmp_path) -> None:
    _, collection = caged(bind=True)
    kept = addon.record.before(set_in(collection).members[0]).mesh
    names, path = sorted(obj.name for obj in bpy.data.objects), str(tmp_path / "character.blend")
    mine = bpy.data.objects.new("Mine", kept)
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    for new in (False, True):
        if new:
            bpy.ops.wm.read_factory_settings(use_empty=True)
        folder = path + "/Object/"
        files = [{"name": name} for name in names]
        bpy.ops.wm.append(filepath=folder + names[0], directory=folder, files=files, instance_object_data=True)
        if not new:
            assert mine.name == "Mine"
    assert sorted(obj.name for obj in bpy.data.objects) == names


@pytest.mark.slow
@pytest.mark.parametrize("bound", [False, True])
def test_buttons_look_at_what_is_chosen_alone(addon, monkeypatch, bound) -> None:
    """Of 300 objects; a pass over all takes milliseconds, for each button, each time the panel is drawn."""
    for k in range(300):
        poly_curve(f"Other {k}", [circle(3)])
    bpy.ops.object.select_all(action="DESELECT")
    if bound:
        caged(bind=True)
    choose(bpy.data.objects["Drawing" if bound else "Other 7"])
    asked, has_node = [], addon.record.helpers.has_node
    monkeypatch.setattr(addon.record.helpers, "has_node", lambda obj: (asked.append(obj), has_node(obj))[1])
    for name in dir(bpy.ops.object):
        if name.startswith("nested_cages_"):
            getattr(bpy.ops.object, name).poll()
    assert len({obj.name for obj in asked if obj.name.startswith("Other")}) <= (not bound)
    assert len(asked) < 1000


@pytest.mark.slow
def test_many_drawings_are_bound_in_as_many_passes_over_the_scene_as_one(addon) -> None:
    binding, counts = addon.binding.binding, []
    for many in (1, 4):
        parts = [poly_curve(f"Part {many} {k}", [circle(24, 0.5, (2.0 * k, 0.0))]) for k in range(many)]
        choose(*parts)
        bpy.ops.object.nested_cages_generate(levels="12, 8")
        outputs = [addon.record.CageSet.of(part) for part in parts]
        steps = binding.in_step(bpy.context, [binding.steps(bpy.context, output, "AUTO") for output in outputs])
        counts.append(sum(1 for _ in steps))
        assert all(output.bound for output in outputs)
    assert counts[0] == counts[1]


@pytest.mark.slow
def test_several_drawings_are_rigged_in_three_actions(addon) -> None:
    for k in range(4):
        poly_curve(f"Part {k}", [circle(24, 0.5, (2.0 * k, 0.0))])
    choose(*bpy.data.objects)
    parts = list(bpy.data.objects)
    bpy.ops.object.nested_cages_generate(levels="8")
    choose(*parts)
    assert bpy.ops.object.nested_cages_bind() == {"FINISHED"}
    outputs = [addon.record.CageSet.of(part) for part in parts]
    assert all(output.bound for output in outputs)
    choose(*parts)
    assert bpy.ops.object.nested_cages_add_handles() == {"FINISHED"}
    rig = bpy.context.view_layer.objects.active
    assert bpy.context.mode == "POSE" and len(rig.data.bones) == 32
    cage = set_in(outputs[2]).members[-1]
    before = [evaluated(set_in(output).members[0]).copy() for output in outputs]
    for k, bone in enumerate(sorted(rig.pose.bones, key=lambda bone: bone.name)):
        bone.location.y = 0.2 * (cage.name in bone.name)
        assert k < 32
    bpy.context.view_layer.update()
    change = [np.abs(evaluated(set_in(o).members[0]) - b).max() for o, b in zip(outputs, before, strict=True)]
    assert [value > 0.1 for value in change] == [False, False, True, False]
    # A pose is checked where it is made.
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"} and bpy.context.mode == "POSE"
    assert all(addon.record.node_of(set_in(output).members[1]).check == "HOLDS" for output in outputs)
    assert bpy.ops.object.nested_cages_report() == {"FINISHED"}
    said = bpy.data.texts["Nested Cages Report"].as_string()
    assert all(f"Part {k} Cages" in said for k in range(4))
    bpy.ops.object.mode_set(mode="OBJECT")
    choose(*parts)
    for action in ("rebind", "unbind", "remove_animation"):
        assert getattr(bpy.ops.object, f"nested_cages_{action}")() == {"FINISHED"}
    assert not any(output.bound for output in outputs) and not any(map(addon.animation.visibility.is_animated, outputs))


@pytest.mark.slow
def test_files_of_several_drawings_hold_their_cages(tmp_path) -> None:
    for k in range(3):
        poly_curve(f"Part {k}", [circle(40, 0.5, (2.0 * k, 0.0))])
    choose(*bpy.data.objects)
    parts = list(bpy.data.objects)
    bpy.ops.object.nested_cages_generate(levels="12, 6")
    path = tmp_path / "cages.json"
    for frame in (bpy.context.scene.frame_current, 1):  # before the result too
        bpy.context.scene.frame_set(frame)
        choose(*parts)
        options = {"kind": "ENGINE", "triangles": True, "pieces": 4}
        assert bpy.ops.object.nested_cages_export(filepath=str(path), **options) == {"FINISHED"}
        found = json.loads(path.read_text())
        assert [len(polygon["outer"]) for polygon in found["polygons"]] == [6, 6, 6]
        assert len(found["points"]) == 18 and {i for corners in found["triangles"] for i in corners} == set(range(18))
        assert {i for corners in found["pieces"] for i in corners} == set(range(18))
    bpy.context.scene.frame_set(9000)
    choose(*parts)
    assert bpy.ops.object.nested_cages_export(filepath=str(tmp_path / "cages.svg")) == {"FINISHED"}
    assert (tmp_path / "cages.svg").read_text().count("<path") == 9
    assert bpy.ops.object.nested_cages_pieces(most=8) == {"FINISHED"}
    assert sum(obj.name.startswith("Part") and "Piece" in obj.name for obj in bpy.data.objects) == 3


@pytest.mark.slow
def test_what_an_edit_makes_untrue_is_not_said(addon) -> None:
    source = MAKE["curve"]()
    bpy.ops.object.nested_cages_generate(levels="0.05u")
    collection, record, health = bpy.data.collections["Drawing Cages"], addon.record, addon.ui.results.health
    cage = set_in(collection).cages[0]
    assert not record.is_edited(cage) and "0.05" in health(bpy.context, cage)[1]
    stretch(cage)
    assert health(bpy.context, cage) == (addon.ui.results.EDITED, record.EDITED)
    choose(source)
    bpy.ops.object.nested_cages_report()
    assert record.EDITED in bpy.data.texts["Nested Cages Report"].as_string()
    bpy.context.scene.frame_set(bpy.context.scene.frame_end)
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    state, said = health(bpy.context, cage)
    assert state in ("CHECKMARK", "ERROR") and record.EDITED not in said and "0.05" not in said
    stretch(cage)
    assert health(bpy.context, cage)[1] == record.EDITED
    assert bpy.ops.object.nested_cages_bind(method="LINEAR") == {"FINISHED"}
    member = record.node_of(cage)
    assert not record.notes(member) and member.excess > 0.3 and not record.is_edited(cage)
    assert facts(cage)["excess"] == pytest.approx(member.excess) and not facts(cage)["need"]
    assert bpy.ops.object.nested_cages_rebind() == {"FINISHED"}
    assert set_in(collection).record.bound == "LINEAR"


@pytest.mark.slow
def test_generate_after_bind_makes_the_drawings_cages_again(addon) -> None:
    _source, collection = caged(bind=True)
    coarsest = set_in(collection).members[-1]
    assert bpy.context.view_layer.objects.active == coarsest and bpy.context.selected_objects == [coarsest]
    assert bpy.ops.object.nested_cages_generate(levels="20, 10") == {"FINISHED"}
    assert [len(obj.data.vertices) for obj in set_in(collection).members] == [60, 20, 10]
    assert len(bpy.data.collections) == 1 and bool(set_in(collection).bound)


@pytest.mark.slow
@pytest.mark.parametrize("how", slow_after(1, ["driven", "keyed"]))
def test_a_pose_by_animation_is_there_after_generate(addon, how) -> None:
    source, collection = caged(bind=True)
    rest, cage = evaluated(source).copy(), set_in(collection).members[-1]
    if how == "driven":
        cage.driver_add("location", 0).driver.expression = "1.0"
    else:
        cage.location.x = 1.0
        cage.keyframe_insert("location", index=0)
    choose(source)
    assert bpy.ops.object.nested_cages_generate(levels="20, 10") == {"FINISHED"}
    bpy.context.scene.frame_set(2)
    bpy.context.view_layer.update()
    assert bool(set_in(collection).bound)
    np.testing.assert_allclose(evaluated(source) - rest, np.tile((1.0, 0.0, 0.0), (len(rest), 1)), atol=1e-5)


def test_a_shortcut_uses_the_values_of_the_panel(addon) -> None:
    """Nothing is remembered from the last time; what a shortcut gives itself counts."""
    names, settings = addon.properties.settings.NAMES, bpy.context.scene.nested_cages
    known = bpy.ops.object.nested_cages_generate.get_rna_type().properties
    assert all(known[name].is_skip_save for name in names)
    settings.levels, settings.clearance, settings.inside = "18", 0.25, True

    class Operator(addon.properties.settings.OperatorProperties):
        properties = type("Given", (), {"is_property_set": staticmethod(lambda name: name == "clearance")})

    operator = Operator()
    operator.clearance, operator.inside = 0.5, False
    operator.take_from_panel(bpy.context, leave=("inside",))
    assert (operator.levels, operator.clearance, operator.inside) == ("18", 0.5, False)


@pytest.mark.slow
@pytest.mark.parametrize("bound", [False, True])
def test_what_was_deleted_is_not_saved(bound, tmp_path) -> None:
    """Hidden objects and pointers keep nothing in the file, and what is left or was copied stays as it is."""
    source, collection = caged(bind=bound)
    cages = [obj for obj in collection.objects if "Cage" in obj.name and obj.visible_get()]
    choose(source, *cages)
    bpy.ops.object.duplicate()
    copies = list(bpy.context.selected_objects)
    for gone in ([cages[0]], [source, *cages[1:]], copies):
        shown = None if gone == copies else evaluated(copies[0]).copy()
        choose(*gone)
        bpy.ops.object.delete()
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
        bpy.context.view_layer.update()
        if shown is not None:
            np.testing.assert_array_equal(evaluated(copies[0]), shown)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    assert not [obj.name for obj in bpy.data.objects] and not bpy.context.scene.timeline_markers
    assert not [home.name for home in bpy.data.collections]
