"""Sets of cages: found from each of their objects, copied, appended, deleted, saved, undone, and true to edits."""

from typing import Any

import bpy
import numpy as np
import pytest

from support import drawings
from support.drawings import base, bind, certificate, evaluated, generate, made, members, save, set_of, sets, world
from support.flock import PARTS, copied, flock
from support.marks import slow_after
from support.panels import draw

pytestmark = pytest.mark.slow

MAKE = {
    "curve": lambda: drawings.poly_curve("Drawing", [drawings.star()]),
    "mesh": lambda: drawings.grid_face("Drawing"),
    "text": lambda: drawings.text("Drawing", "Hi"),
}


def show(*objects: Any) -> None:
    """Selects these objects alone, the last of them active, whatever hides them."""
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.hide_viewport = False
        obj.hide_set(False)
    drawings.choose(*objects)


def caged(kind: str = "curve", *, bound: bool = False) -> tuple[Any, Any]:
    """A drawing with two cages, bound or not, and its collection."""
    source = MAKE[kind]()
    generate("24, 12")
    if bound:
        bind()
    return source, bpy.data.collections["Drawing Cages"]


def moved_by(source: Any, cage: Any) -> float:
    """How far a drawing moves when the vertices of a cage move apart."""
    before = evaluated(source).copy()
    drawings.put(cage, 1.5 * base(cage))
    return float(np.abs(evaluated(source) - before).max())


def test_a_set_is_found_from_each_of_its_objects_and_knows_all_of_them() -> None:
    found = flock()
    assert all(sets().of(obj) == found for obj in (*found.parts, *members(found)))
    assert [obj.name for obj in found.parts] == list(PARTS) and found.fine.name == "Body Fine"
    assert list(found) == found.cages and [len(cage.data.vertices) for cage in found] == [24, 12] and len(found) == 2
    assert found.settings.levels == "24, 12" and found.bound == "HARMONIC" and not found.inside and not found.missing
    assert all(each.clearance > 0.0 and each.excess > 0.0 and not each.edited for each in found.certificates)
    assert sets().of(drawings.poly_curve("Other", [drawings.star()])) is None
    assert sets().everywhere() == [found]


@pytest.mark.parametrize("linked", slow_after(1, [False, True]))
def test_a_copy_of_what_is_seen_is_a_character_at_once_and_gets_its_own_when_it_is_changed(linked: bool) -> None:
    found = flock()
    before = {part.name: world(part) for part in found.parts}
    copies = copied(*found.parts, *found.cages, linked=linked)
    own = set_of(copies["Hat"])
    assert own.parts == [copies[name] for name in PARTS] and own.cages == [copies[cage.name] for cage in found]
    assert len(own.missing) == 1 and "'Body Fine'" in own.missing[0] and not found.missing  # shared with the original
    own.cages[-1].location.x += 1.0  # as an object, which needs no mesh of its own
    for name in PARTS:
        np.testing.assert_allclose(world(copies[name]), before[name] + (1.0, 0.0, 0.0), atol=1e-5)
        np.testing.assert_allclose(world(bpy.data.objects[name]), before[name], atol=1e-6)
    for obj in (*own.parts, *(each for each in members(own) if each.parent is None)):
        obj.location.y += 5.0
    np.testing.assert_allclose(world(copies["Body"]), before["Body"] + (1.0, 5.0, 0.0), atol=1e-5)
    drawings.choose(copies["Hat"])
    assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}
    assert not own.missing and not own.bound and found.bound and not {*members(own)} & {*members(found)}
    assert not {obj.data for obj in members(own)} & {obj.data for obj in members(found)}
    for name in PARTS:
        np.testing.assert_allclose(world(bpy.data.objects[name]), before[name], atol=1e-6)


def test_partial_copies_are_no_more_than_what_was_copied() -> None:
    found = flock()
    found.cages[-1].location.x += 0.5
    pose = world(found.parts[1])
    one = set_of(copied(found.parts[0], *found.cages)["Body"])
    assert len(one.parts) == 1 and any("'Head'" in each for each in one.missing)
    assert len(found.parts) == 3 and not found.missing
    alone = copied(found.parts[1])["Head"]
    assert set_of(alone) is None
    alone.location.y += 9.0
    np.testing.assert_allclose(world(alone), pose + np.array([0.0, 9.0, 0.0]), atol=1e-5)
    assert set_of(copied(found.cages[0])["Body Cage 1"]) is None
    finest = copied(found.parts[0], found.cages[0])
    few = set_of(finest["Body"])
    assert "'Body Fine'" in few.missing[0] and len(few) == 1
    drawings.choose(finest["Body"])
    assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}
    assert len(few) == 2 and not few.missing and len(found.parts) == 3 and not found.missing


def test_deleted_objects_are_named_and_swept(tmp_path) -> None:
    found = flock(bound=False)
    drawings.choose(bpy.data.objects["Head"], found.cages[0])
    bpy.ops.object.delete()
    found = set_of(bpy.data.objects["Body"])
    assert len(found.missing) == 2 and "'Body Cage 1'" in found.missing[0] and "'Head'" in found.missing[1]
    assert [len(cage.data.vertices) for cage in found] == [12] and len(found.parts) == 2
    save(tmp_path / "swept.blend", again=True)
    found = set_of(bpy.data.objects["Hat"])
    assert not found.missing and [cage.name for cage in found] == ["Body Cage 2"] and len(found.parts) == 2
    assert found.settings.levels == "24, 12" and "Head" not in bpy.data.objects and found.parts[0].name == "Body"
    bpy.data.objects.remove(bpy.data.objects["Body"])
    assert [each.name for each in found.parts] == ["Hat"]


@pytest.mark.parametrize("bound", slow_after(1, [True, False]), ids=["bound", "free"])
def test_a_saved_file_works_as_before(bound: bool, tmp_path) -> None:
    scene = bpy.context.scene
    scene.frame_end = 20
    caged(bound=bound)
    save(tmp_path / "saved.blend", again=True)
    scene, source = bpy.context.scene, bpy.data.objects["Drawing"]
    show(source)
    found = set_of(source)
    assert scene.frame_end > 20 and [len(obj.data.vertices) for obj in members(found)] == [60, 24, 12]
    assert sets().all_of(source) == [found] and bool(found.bound) is bound
    assert not any(each.edited for each in found.certificates)
    for action in ("REST_FROM_POSE", "UNBIND") if bound else ():
        bind(action=action)
    show(source)
    scene.frame_set(1)
    assert source.hide_viewport  # its moving copy plays
    scene.frame_set(drawings.end_of(found))
    assert drawings.verify(*found)
    markers = len(scene.timeline_markers)
    generate("16")
    assert len(found) == 1 and len(scene.timeline_markers) == markers and found.settings.levels == "16"
    assert bpy.ops.object.nested_cages_remove_animation() == {"FINISHED"}
    assert scene.frame_end == 20


def test_a_set_is_known_by_its_objects_wherever_they_are() -> None:
    """Moved to other collections, renamed, and with the collection removed."""
    source, collection = caged(bound=True)
    fine, finer, coarsest = made()
    show(source)
    bpy.ops.object.nested_cages_puppet(source="HANDLES")
    bpy.ops.object.mode_set(mode="OBJECT")
    controls = bpy.data.collections.new("Controls")
    bpy.context.scene.collection.children.link(controls)
    for obj in (coarsest, bpy.context.view_layer.objects.active):
        collection.objects.unlink(obj)
        controls.objects.link(obj)
    coarsest.name = source.name = "Renamed"
    assert members(source) == [fine, finer, coarsest]
    assert moved_by(fine, coarsest) > 0.1
    drawings.put(coarsest, base(coarsest) / 1.5)
    show(source)
    assert drawings.verify(finer, coarsest)
    generate("20, 10")
    assert members(source) == [fine, finer, coarsest] and len(coarsest.data.vertices) == 10
    assert len(bpy.data.collections) == 2
    for obj in (fine, finer):
        controls.objects.link(obj)
    bpy.data.collections.remove(collection)
    show(source)
    assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}
    (found,) = sets().all_of(source)
    assert members(found) == [fine, finer, coarsest] and not found.bound
    assert found.settings.levels == "20, 10" and set(controls.objects) >= {fine, finer, coarsest}


@pytest.mark.parametrize("kind", slow_after(0, MAKE, thorough_after=1))
@pytest.mark.parametrize("how", ["duplicated", "instanced", "scene copied", "appended"])
def test_a_copy_is_a_character_of_its_own(kind: str, how: str, tmp_path) -> None:
    source, collection = caged(kind, bound=True)
    original = set_of(source)
    objects, before = [source, *members(original)], set(bpy.data.objects)
    if how == "duplicated":
        show(*objects)
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
        show(instance)
        bpy.ops.object.duplicates_make_real(use_base_parent=True, use_hierarchy=True)
        bpy.context.scene.collection.children.link(home)
    new = set(bpy.data.objects) - before
    (own,) = {found for obj in new for found in sets().all_of(obj)} - {original}
    copy = own.parts[0]
    assert copy in new and set(own.cages) <= new and members(original) == objects[1:]
    if how == "instanced":  # Blender lets them share their meshes, as with a linked duplicate
        own.cages[-1].data = own.cages[-1].data.copy()
    assert moved_by(objects[1], own.cages[-1]) == 0.0
    assert moved_by(copy, original.cages[-1]) == 0.0
    assert moved_by(copy, own.cages[-1]) > 0.1
    show(copy)
    assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}
    assert original.bound and not own.bound
    generate("16")
    assert [len(members(found)) for found in (original, own)] == [3, 2]
    meshes = [obj.data for found in (original, own) for obj in members(found)]
    assert len(set(meshes)) == len(meshes)
    assert not {*original.cages[0].users_collection} & {*own.cages[0].users_collection}


def test_several_drawings_are_rigged_in_three_actions() -> None:
    parts = [drawings.poly_curve(f"Part {k}", [drawings.circle(24, 0.5, (2.0 * k, 0.0))]) for k in range(4)]
    show(*parts)
    generate("8")
    show(*parts)
    bind()
    found = [set_of(part) for part in parts]
    assert all(each.bound for each in found)
    show(*parts)
    assert bpy.ops.object.nested_cages_puppet(source="HANDLES") == {"FINISHED"}
    rig = bpy.context.view_layer.objects.active
    assert bpy.context.mode == "POSE" and len(rig.data.bones) == 32
    before = [evaluated(each.fine).copy() for each in found]
    for bone in rig.pose.bones:
        bone.location.y = 0.2 * (found[2].cages[-1].name in bone.name)
    bpy.context.view_layer.update()
    change = [np.abs(evaluated(each.fine) - points).max() for each, points in zip(found, before, strict=True)]
    assert [value > 0.1 for value in change] == [False, False, True, False]
    assert drawings.verify(*(each.cages[0] for each in found))
    assert bpy.context.mode == "POSE"  # a pose is checked where it is
    bpy.ops.object.mode_set(mode="OBJECT")
    show(*parts)
    bind(action="REST_FROM_POSE")
    binding, *others = found
    show(binding.source)
    bind()  # one alone is unbound; of all, the rest stays bound until all are
    assert [bool(each.bound) for each in found] == [False, True, True, True]
    for bound in (True, False):
        show(*parts)
        bind()
        assert all(bool(each.bound) is bound for each in (binding, *others))
    assert bpy.ops.object.nested_cages_remove_animation() == {"FINISHED"}
    assert not any(each.bound or each.cages[0].data.shape_keys for each in found)


def test_what_an_edit_makes_untrue_is_not_said() -> None:
    source = MAKE["curve"]()
    generate("0.05u")
    (cage,) = made()[1:]
    assert not certificate(cage).edited and certificate(cage).need
    drawings.put(cage, 1.5 * base(cage))
    assert certificate(cage).edited
    before = draw()
    show(source)
    bpy.context.scene.frame_set(bpy.context.scene.frame_end)
    drawings.verify()
    assert drawings.holds(cage) is not None and draw() != before
    drawings.put(cage, 1.5 * base(cage))
    assert certificate(cage).edited
    bind(method="LINEAR")  # measures the cage as it is
    said = certificate(cage)
    assert said.excess > 0.3 and not said.edited and not said.need
    assert bpy.ops.object.nested_cages_bind(action="REST_FROM_POSE") == {"FINISHED"}
    assert set_of(source).bound == "LINEAR"


@pytest.mark.parametrize("how", slow_after(1, ["driven", "keyed"], thorough_after=1))
def test_a_pose_by_animation_is_there_after_generate(how: str) -> None:
    source, _ = caged(bound=True)
    rest, cage = evaluated(source).copy(), made()[-1]
    if how == "driven":
        cage.driver_add("location", 0).driver.expression = "1.0"
    else:
        cage.location.x = 1.0
        cage.keyframe_insert("location", index=0)
    show(source)
    generate("20, 10")
    bpy.context.scene.frame_set(2)
    assert set_of(source).bound
    np.testing.assert_allclose(evaluated(source) - rest, np.tile((1.0, 0.0, 0.0), (len(rest), 1)), atol=1e-5)


@pytest.mark.parametrize("bound", slow_after(1, [True, False], thorough_after=1))
def test_what_was_deleted_is_not_saved(bound: bool, tmp_path) -> None:
    """Hidden objects and pointers keep nothing in the file, and what is left or was copied stays as it is."""
    source, collection = caged(bound=bound)
    cages = [obj for obj in collection.objects if "Cage" in obj.name and obj.visible_get()]
    show(source, *cages)
    bpy.ops.object.duplicate()
    copies = list(bpy.context.selected_objects)
    for gone in ([cages[0]], [source, *cages[1:]], copies):
        shown = None if gone == copies else evaluated(copies[0]).copy()
        show(*gone)
        bpy.ops.object.delete()
        save(tmp_path / "saved.blend")
        bpy.context.view_layer.update()
        if shown is not None:
            np.testing.assert_array_equal(evaluated(copies[0]), shown)
    save(tmp_path / "saved.blend")
    save(tmp_path / "saved.blend", again=True)
    assert not bpy.data.objects[:] and not bpy.context.scene.timeline_markers and not bpy.data.collections[:]
