"""What artists make on cages outlives new cages, binding and unbinding; cages go where their drawing goes."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from support import drawings
from support.blender import refused
from support.drawings import add, base, choose, evaluated, members, poly_curve, snapshot, star, verify, wire, world
from support.marks import slow_after

pytestmark = pytest.mark.slow

GROUP = "Right"


def generate(source, levels="24, 12", **values):
    """Generates from an object alone; returns its fine mesh and cages."""
    choose(source)
    assert bpy.ops.object.nested_cages_generate(levels=levels, **values) == {"FINISHED"}
    bpy.context.view_layer.update()
    return members(source)


def ramp(points):
    """From 0 on the left to 1 on the right."""
    return np.clip(0.5 + points[:, 0] / 6.0, 0.0, 1.0)


def weights(obj):
    index = obj.vertex_groups[GROUP].index
    return np.array([next((e.weight for e in v.groups if e.group == index), 0.0) for v in obj.data.vertices])


def add_key(obj, name, stretch):
    """A shape key that stretches along x, keyed from 0 on frame 1 to 1 on frame 11."""
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name=name, from_mix=False)
    key.points.foreach_set("co", (base(obj) * (stretch, 1.0, 1.0)).astype(np.float32).ravel())
    for frame, value in ((1, 0.0), (11, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    return key


def offsets(obj, name):
    key = obj.data.shape_keys.key_blocks[name]
    points = np.empty((len(key.points), 3), np.float32)
    key.points.foreach_get("co", points.ravel())
    return points - base(obj)


def keyed(obj, name):
    """The value of a shape key on frames 1, 6 and 11."""
    found = []
    for frame in (1, 6, 11):
        bpy.context.scene.frame_set(frame)
        found.append(obj.data.shape_keys.key_blocks[name].value)
    return found


def rigged(obj):
    """An object with something of everything that an artist may put on it."""
    drawings.weigh(obj, GROUP, ramp(base(obj)))
    obj.vertex_groups.new(name="Locked").lock_weight = True
    add_key(obj, "Wide", 1.5)
    bone = bpy.data.armatures.new("Bones")
    rig = bpy.data.objects.new("Armature", bone)
    bpy.context.scene.collection.objects.link(rig)
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    obj.data.materials.append(bpy.data.materials.new("Ink"))
    obj["mood"], obj.data["tone"] = "calm", 3
    obj.constraints.new("LIMIT_SCALE").name = "Limit"
    driver = obj.driver_add("color", 0).driver
    driver.expression = "0.25"
    tint = obj.data.attributes.new("tint", "FLOAT", "POINT")
    tint.data.foreach_set("value", ramp(base(obj)))
    return obj


def assert_rigged(obj, exact=False):
    error = 1e-6 if exact else 0.12
    assert [group.name for group in obj.vertex_groups] == [GROUP, "Locked"]
    assert obj.vertex_groups["Locked"].lock_weight
    assert np.abs(weights(obj) - ramp(base(obj))).max() < error
    assert np.abs(offsets(obj, "Wide") - base(obj) * (0.5, 0.0, 0.0)).max() < 4 * error
    assert keyed(obj, "Wide") == [0.0, 0.5, 1.0]
    assert obj.modifiers["Armature"].object.name == "Armature"
    assert [slot.material.name for slot in obj.material_slots] == ["Ink"]
    assert obj["mood"] == "calm" and obj.data["tone"] == 3
    assert "Limit" in obj.constraints
    drivers = [curve.data_path for curve in obj.animation_data.drivers]
    assert [path for path in drivers if "Nested Cages Pose" not in path] == ["color"]
    tint = np.empty(len(obj.data.vertices), np.float32)
    obj.data.attributes["tint"].data.foreach_get("value", tint)
    assert np.abs(tint - ramp(base(obj))).max() < error


def test_work_on_a_cage_outlives_new_cages_binding_and_unbinding() -> None:
    source = poly_curve("Drawing", [star() * 2.0])
    cage = rigged(generate(source)[-1])
    assert_rigged(cage, exact=True)
    bpy.ops.object.nested_cages_bind()
    assert_rigged(cage, exact=True)
    bpy.ops.object.nested_cages_bind(action="REST_FROM_POSE")
    assert_rigged(cage, exact=True)
    assert generate(source, "24, 16")[-1] == cage and len(cage.data.vertices) == 16
    assert_rigged(cage)
    bpy.ops.object.nested_cages_bind(action="UNBIND")
    assert_rigged(cage)
    assert generate(source, "30, 14")[-1] == cage
    assert_rigged(cage)
    steps = [key.name for key in cage.data.shape_keys.key_blocks if key.name.startswith("Level")]
    assert steps, "the new cage plays too"
    bpy.ops.object.nested_cages_remove_animation()
    assert_rigged(cage)
    assert [key.name for key in cage.data.shape_keys.key_blocks] == ["Basis", "Wide"]


def test_weights_stay_on_their_side_of_a_thin_wall() -> None:
    source = poly_curve("Drawing", [drawings.circle(60), drawings.circle(60, 0.95)])
    _, cage = generate(source, "16")
    cage.vertex_groups.new(name=GROUP).add(np.flatnonzero(np.hypot(*base(cage).T[:2]) < 0.97).tolist(), 1.0, "REPLACE")
    for size, levels in ((1.0, "80"), (3.0, "60")):  # of what is drawn anew too
        for point in [point for spline in source.data.splines for point in spline.points]:
            point.co = (size * point.co[0], size * point.co[1], 0.0, 1.0)
        _, cage = generate(source, levels)
        np.testing.assert_allclose(weights(cage), np.hypot(*base(cage).T[:2]) < 0.97 * size, atol=1e-6)


def test_what_was_made_while_bound_stays_when_unbound() -> None:
    source = poly_curve("Drawing", [star() * 2.0])
    cage = generate(source)[-1]
    bpy.ops.object.nested_cages_bind()
    rigged(cage)
    cage.keyframe_insert("location", frame=3)
    bpy.ops.object.nested_cages_bind(action="UNBIND")
    assert_rigged(cage, exact=True)
    assert {"location", "hide_viewport"} <= {curve.data_path for curve in drawings.curves_of(cage) if not curve.mute}


def test_a_posed_drawing_is_still_posed_with_new_cages() -> None:
    source = poly_curve("Drawing", [star() * 2.0])
    cage = generate(source, "12")[-1]
    bpy.ops.object.nested_cages_bind()
    rest = evaluated(source)
    bent = base(cage)
    bent[:, 1] += 0.2 * bent[:, 0]
    drawings.put(cage, bent)
    cage.location.x = 0.7
    posed = evaluated(source)
    assert np.abs(posed - rest).max() > 0.5
    generate(source, "16")
    assert drawings.set_of(cage).bound
    assert cage.location.x == pytest.approx(0.7)
    assert np.abs(evaluated(source) - posed).max() < 0.12
    generate(source, "16")
    again, everything = evaluated(source), snapshot()
    generate(source, "16")
    assert np.abs(evaluated(source) - again).max() < 1e-5
    for kind in ("objects", "meshes", "actions", "node_groups"):  # nothing is left over
        assert [users for _, users in snapshot()[kind]] == [users for _, users in everything[kind]], kind


def test_a_level_that_is_no_more_is_kept_if_an_artist_worked_on_it() -> None:
    source = poly_curve("Drawing", [star() * 2.0])
    _, _, cage = generate(source)
    drawings.weigh(cage, GROUP, ramp(base(cage)))
    assert len(generate(source, "16")) == 2
    assert cage.name in bpy.data.objects and not [key for key in cage.keys() if key.startswith("nested_cages")]  # noqa: SIM118
    assert np.abs(weights(cage) - ramp(base(cage))).max() < 1e-6
    generate(source, "24, 12")
    generate(source, "16")
    assert len(members(source)) == 2


def test_hooks_and_vertex_parents_name_the_nearest_new_vertices() -> None:
    source = poly_curve("Drawing", [drawings.circle(60) * 2.0])
    cage = generate(source, "12")[-1]
    right = int(np.argmax(base(cage)[:, 0]))
    place = base(cage)[right].copy()
    cage.modifiers.new("Handle", "HOOK").vertex_indices_set([right])
    child = add("Bead", None, select=False)
    child.parent, child.parent_type, child.parent_vertices = cage, "VERTEX", (right, 0, 0)
    generate(source, "30")
    (index,) = cage.modifiers["Handle"].vertex_indices
    assert index == child.parent_vertices[0]
    assert np.linalg.norm(base(cage)[index] - place) < 0.3


def test_what_cannot_be_carried_over_is_named(reports) -> None:
    cage = generate(poly_curve("Drawing", [star() * 2.0]), "12")[-1]
    cage.data.attributes.new("crease", "FLOAT", "EDGE")
    reports.read()
    generate(bpy.data.objects["Drawing"], "14")
    (said,) = [line for line in reports.read("Warning").splitlines() if "'crease'" in line]
    assert f"'{cage.name}'" in said


DRAWINGS = {
    "curve": lambda: poly_curve("Drawing", [star() * 2.0]),
    "mesh": lambda: wire("Drawing", [star() * 2.0]),
    "text": lambda: drawings.text("Drawing", "o"),
    "stretched": lambda: stretched(),
}


def stretched():
    """A drawing whose own space cannot be the cages'."""
    source = poly_curve("Drawing", [star() * 2.0])
    source.scale = (1.5, 0.75, 1.0)
    return source


@pytest.mark.parametrize("kind", slow_after(2, DRAWINGS))
def test_a_bound_drawing_goes_with_its_cages(kind) -> None:
    source = DRAWINGS[kind]()
    bpy.context.view_layer.update()
    *_, cage = generate(source, "12")
    bpy.ops.object.nested_cages_bind()
    moved = base(cage)
    moved[:, 0] += 0.1 * moved[:, 1]
    drawings.put(cage, moved)
    before, around = world(source), world(cage)
    source.location.y += 4.0
    bpy.context.view_layer.update()
    for obj, places in ((source, before), (cage, around)):
        assert np.abs(world(obj) - places - (0.0, 4.0, 0.0)).max() < 1e-5
    root = add("Root", None, select=False)
    source.parent = root
    root.matrix_world = Matrix.Translation((1.0, 0.0, 2.0)) @ Matrix.Rotation(0.5, 4, "Z")
    bpy.context.view_layer.update()
    turn = np.array(root.matrix_world)
    for obj, places in ((source, before), (cage, around)):
        expected = (places + np.array((0.0, 4.0, 0.0))) @ turn[:3, :3].T + turn[:3, 3]
        assert np.abs(world(obj) - expected).max() < 2e-5
    assert verify(cage)


def test_cages_are_in_the_collection_of_their_drawing() -> None:
    source = poly_curve("Drawing", [star()])
    character = drawings.gathered("Character", source)
    generate(source, "12")
    assert [child.name for child in character.children] == ["Drawing Cages"]


@pytest.mark.parametrize("draw", [lambda: poly_curve("Drawing", [star()]), lambda: drawings.bezier_circle("Drawing")])
def test_cages_of_a_keyed_drawing_stand_where_it_is(draw) -> None:
    source = draw()
    for frame, x in ((1, 0.0), (101, 3.0)):
        source.location.x = x
        source.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    fine, cage = generate(source, "12")
    assert bpy.context.scene.frame_current > 1
    for frame in (bpy.context.scene.frame_current, 60, 101):
        bpy.context.scene.frame_set(frame)
        assert cage.matrix_world == source.matrix_world == fine.matrix_world


def test_verify_looks_at_the_drawing_as_it_is_seen() -> None:
    source = wire("Drawing", [star()])
    _, cage = generate(source, "12")
    choose(source)
    assert verify(cage)
    source.data.vertices[0].co.x += 2.0
    verify()
    assert drawings.holds(cage) is False and "'Drawing'" in drawings.certificate(cage).finding
    assert source.data.vertices[0].select


@pytest.fixture
def saved(tmp_path):
    """A file with a bound and posed drawing in a collection of its own, and how the drawing is seen."""
    source = wire("Drawing", [star() * 2.0])
    drawings.gathered("Character", source)
    *_, cage = generate(source, "12")
    bpy.ops.object.nested_cages_bind()
    rigged(cage)
    bpy.context.scene.frame_set(1)
    cage.data.vertices[3].co.x += 0.25
    cage.data.update()
    return drawings.save(tmp_path / "character.blend"), evaluated(source)


def brought(path, link):
    """The collection of the saved file in a new one."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path, link=link) as (_, wanted):
        wanted.collections = ["Character"]
    bpy.context.scene.collection.children.link(wanted.collections[0])
    bpy.context.view_layer.update()
    return wanted.collections[0]


def test_an_appended_rig_can_be_worked_on(saved) -> None:
    path, shown = saved
    brought(path, link=False)
    source = bpy.data.objects["Drawing"]
    np.testing.assert_array_equal(evaluated(source), shown)
    *_, cage = generate(source, "16")
    assert len(cage.data.vertices) == 16
    assert_rigged(cage)
    assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}


@pytest.mark.parametrize("reloaded", slow_after(1, [True, False]))
def test_an_override_is_posed_and_moved_and_says_what_it_cannot(saved, reloaded) -> None:
    path, shown = saved
    collection = brought(path, link=True)
    np.testing.assert_array_equal(evaluated(bpy.data.objects["Drawing"]), shown)
    collection.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    bpy.context.view_layer.update()
    own = {obj.name: obj for obj in bpy.data.objects if obj.override_library is not None}
    source, cage = own["Drawing"], own["Drawing Cage 1"]
    cage.location.x = 1.0
    bpy.context.view_layer.update()
    assert np.abs(evaluated(source) - shown - (1.0, 0.0, 0.0)).max() < 1e-5
    source.location.y += 4.0
    bpy.context.view_layer.update()
    assert cage.matrix_world.translation.y == pytest.approx(4.0)
    before = snapshot()
    if reloaded:
        drawings.save(path.replace("character", "shot"), again=True)
        own = {obj.name: obj for obj in bpy.data.objects if obj.override_library is not None}
        source, cage = own["Drawing"], own["Drawing Cage 1"]
        before = snapshot()
    (home,) = drawings.sets().all_of(source)
    assert home.cages[-1] == cage and all(obj.override_library for obj in (*members(home), *home.parts))
    for action in ("REST_FROM_POSE", "UNBIND"):
        choose(source)
        with refused("'Drawing", unchanged=False):
            bpy.ops.object.nested_cages_bind(action=action)
    choose(source)
    with refused("'Drawing", unchanged=False):
        bpy.ops.object.nested_cages_generate(levels="10")
    assert snapshot()["meshes"] == before["meshes"]


def test_handles_move_the_drawing_with_new_cages_too() -> None:
    source = wire("Drawing", [star() * 2.0])
    *_, cage = generate(source, "12")
    bpy.ops.object.nested_cages_bind()
    choose(cage)
    assert bpy.ops.object.nested_cages_puppet(source="HANDLES") == {"FINISHED"}
    generate(source, "16")
    rest = evaluated(source)
    modifier = next(modifier for modifier in cage.modifiers if modifier.type == "ARMATURE")
    modifier.object.pose.bones[0].location = (0.0, 0.3, 0.0)
    bpy.context.view_layer.update()
    assert 0.02 < np.abs(evaluated(source) - rest).max() < 0.35
