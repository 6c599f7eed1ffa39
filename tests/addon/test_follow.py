"""Follow Animation: drawings that move by any means, and cages that are certified as they are stored."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from support.drawings import (
    add,
    at_frame,
    choose,
    circle,
    edges_of,
    evaluated,
    facts,
    poly_curve,
    set_in,
    snapshot,
    solid,
    star,
    text,
    wire,
)
from support.marks import slow_after

pytestmark = pytest.mark.slow

FIRST, LAST = 1, 9


def key(owner, path, values, index=-1) -> None:
    """Keys a property on the first and last frame, and between them if there are three values."""
    for frame, value in zip(np.linspace(FIRST, LAST, len(values)), values, strict=True):
        if index >= 0:
            getattr(owner, path)[index] = value
        else:
            setattr(owner, path, value)
        owner.keyframe_insert(path, index=index, frame=float(frame))


def bent_by_armature():
    """A bar in a mesh that an armature of two bones bends."""
    x, count = np.linspace(-1.0, 1.0, 21), 21
    bar = np.concatenate([np.column_stack([x, np.full(count, -0.2)]), np.column_stack([x, np.full(count, 0.2)])[::-1]])
    obj = wire("Bar", [bar])
    armature = bpy.data.armatures.new("Rig")
    rig = add("Rig", armature)
    bpy.ops.object.mode_set(mode="EDIT")
    for name, head, tail in (("left", (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0)), ("right", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))):
        bone = armature.edit_bones.new(name)
        bone.head, bone.tail = head, tail
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, side in (("left", -1.0), ("right", 1.0)):
        group = obj.vertex_groups.new(name=name)
        for number, point in enumerate(bar):
            group.add([number], float(np.clip(0.5 + 2.0 * side * point[0], 0.0, 1.0)), "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    bone = rig.pose.bones["right"]
    bone.rotation_mode = "XYZ"
    key(bone, "rotation_euler", [0.0, 1.0, 0.0], index=2)
    return obj


def keyed_points():
    """A curve whose points are keyed, and whose object turns and moves."""
    obj = poly_curve("Keyed", [circle(40)])
    for number, point in enumerate(obj.data.splines[0].points):
        x, y = point.co[:2]
        if number % 3 == 0:
            for frame, size in ((FIRST, 1.0), (5, 1.3), (LAST, 0.8)):
                point.co = (size * x, size * y, 0.0, 1.0)
                point.keyframe_insert("co", frame=frame)
    key(obj, "rotation_euler", [0.0, 1.0], index=2)
    key(obj, "location", [0.0, 3.0], index=0)
    return obj


def shaped():
    """A mesh with a keyed shape key and a parent that moves."""
    obj = wire("Shaped", [star()])
    obj.shape_key_add(name="Basis")
    shape = obj.shape_key_add(name="Calm")
    for point, place in zip(shape.data, circle(60), strict=True):
        point.co = (*place, 0.0)
    key(shape, "value", [0.0, 1.0, 0.0])
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    key(parent, "location", [0.0, 2.0], index=1)
    obj.parent = parent
    return obj


def in_lattice():
    """A mesh in a lattice whose modifier is driven up."""
    obj = wire("Latticed", [star()])
    lattice = bpy.data.lattices.new("Lattice")
    cage = add("Lattice", lattice, select=False)
    cage.scale = (3.0, 3.0, 1.0)
    for point in lattice.points:
        point.co_deform.x += 0.3 * point.co_deform.y
    modifier = obj.modifiers.new("Lattice", "LATTICE")
    modifier.object = cage
    key(modifier, "strength", [0.0, 1.0])
    return obj


def spaced_text():
    """A text whose letters move apart."""
    obj = text("Word", "ab")
    obj.data.resolution_u = 3
    key(obj.data, "space_character", [1.2, 1.6])
    return obj


MOTIONS = {f.__name__: f for f in (bent_by_armature, keyed_points, shaped, in_lattice, spaced_text)}


def follow(obj, **values):
    choose(obj)
    values = {"levels": "16, 10", "frame_start": FIRST, "frame_end": LAST, "frame_step": 2} | values
    assert bpy.ops.object.nested_cages_follow(**values) == {"FINISHED"}
    return bpy.data.collections[f"{obj.name} Cages"]


def certified(core, addon, collection, obj, frames) -> None:
    """On each frame, the evaluated cages strictly enclose what is in them, and the drawing itself on its frames."""
    for frame in frames:
        depsgraph = at_frame(frame)
        members = set_in(collection).members
        meshes = [core.Mesh(evaluated(o, depsgraph)[:, :2].astype(float), edges_of(o)) for o in members]
        for inner, outer in pairwise(meshes):
            assert core.verify(outer, inner).holds, frame
        if frame == int(frame):
            outline = addon.scene.convert.read(bpy.context, obj)
            drawn = core.Mesh.from_loops([loop[:, :2].astype(float) for loop in outline.loops])
            assert core.verify(meshes[1], drawn).holds, frame
        for member in members:
            assert np.allclose(member.matrix_world, obj.matrix_world, atol=1e-6)


@pytest.mark.parametrize("motion", slow_after(0, MOTIONS, thorough_after=1))
def test_cages_follow_a_drawing_that_moves_by_any_means(addon, core, motion) -> None:
    obj = MOTIONS[motion]()
    bpy.context.scene.frame_set(4)
    levels = "16, 10" if motion != "spaced_text" else "24, 14"
    collection = follow(obj, levels=levels)
    assert bpy.context.scene.frame_current == 4
    assert [len(o.data.vertices) for o in collection.objects][1:] == [int(n) for n in levels.split(",")]
    certified(core, addon, collection, obj, range(FIRST, LAST + 1, 2))
    fine, *cages = set_in(collection).members
    for frame in np.arange(FIRST, LAST, 0.5):
        depsgraph = at_frame(frame)
        for inner, outer in ((fine, cages[0]), (cages[0], cages[1])):
            assert solid(outer, depsgraph).contains(solid(inner, depsgraph)), frame


def test_the_stored_coordinates_are_certified_key_by_key(addon, core) -> None:
    """From the shape keys alone: what Blender stores holds on every key and on the straight way between them."""
    collection = follow(bent_by_armature(), levels="12", frame_step=1)
    fine, cage = set_in(collection).members

    def steps(obj):
        found = {}
        for curve in addon.animation.shape_keys.curves_of(obj.data.shape_keys):
            points = np.empty((len(obj.data.vertices), 3), np.float32)
            obj.data.shape_keys.path_resolve(curve.data_path.removesuffix(".value")).points.foreach_get(
                "co", points.ravel()
            )
            frame = next(point.co[0] for point in curve.keyframe_points if point.co[1] == 1.0)
            found[frame] = points[:, :2].astype(float)
        basis = np.empty((len(obj.data.vertices), 3), np.float32)
        obj.data.shape_keys.reference_key.points.foreach_get("co", basis.ravel())
        return {float(FIRST): basis[:, :2].astype(float)} | found

    keyed, fine_keyed = steps(cage), steps(fine)
    at_rest = [frame for frame in range(FIRST, LAST + 1) if frame not in fine_keyed]
    fine_keyed |= {float(frame): fine_keyed[float(FIRST)] for frame in at_rest}
    frames = sorted(keyed)
    inside = [
        np.stack([np.interp(f, sorted(fine_keyed), [fine_keyed[k].ravel()[i] for k in sorted(fine_keyed)])
                  for i in range(fine_keyed[1.0].size)]).reshape(-1, 2)
        for f in frames
    ]  # fmt: skip
    outer, inner = core.Mesh(keyed[frames[0]], edges_of(cage)), core.Mesh(inside[0], edges_of(fine))
    for f, points in zip(frames, inside, strict=True):
        assert core.verify(outer.moved(keyed[f]), inner.moved(points), 0.99e-5 * inner.diagonal).holds
    assert core.verify_motion(outer, inner, np.stack([keyed[f] for f in frames]), np.stack(inside)).free


def test_a_cyclic_motion_closes(addon, core) -> None:
    collection = follow(bent_by_armature(), cyclic=True, levels="12", frame_end=LAST - 1, frame_step=1)
    _, cage = set_in(collection).members
    first, last = (evaluated(cage, at_frame(frame)) for frame in (FIRST, LAST))
    assert np.allclose(first, last, atol=1e-6)
    assert not np.allclose(first, evaluated(cage, at_frame(5)), atol=0.1)


def test_one_cage_for_all_frames_stands_still(addon, core) -> None:
    obj = bent_by_armature()
    collection = follow(obj, still=True, levels="16, 8")
    _, first, second = set_in(collection).members
    assert all(len(o.data.vertices) == n for o, n in ((first, 16), (second, 8)))
    before = [evaluated(o, at_frame(FIRST)) for o in (first, second)]
    assert all(np.array_equal(b, evaluated(o, at_frame(5))) for b, o in zip(before, (first, second), strict=True))
    certified(core, addon, collection, obj, np.arange(FIRST, LAST, 0.5))  # every frame, whatever the step


def test_the_whole_animation_can_be_verified(addon) -> None:
    obj = shaped()
    collection = follow(obj, frame_step=1)
    bpy.context.scene.frame_end = LAST
    assert bpy.ops.object.nested_cages_verify(whole=True) == {"FINISHED"}
    assert facts(collection.objects[1])["check"] == f"Holds on {FIRST} – {LAST}"
    assert "at all instants between" in facts(collection.objects[1])["certificate"]


def refused(obj, **values) -> str:
    choose(obj)
    bpy.context.scene.frame_set(FIRST)
    before = snapshot()
    with pytest.raises(RuntimeError) as error:
        bpy.ops.object.nested_cages_follow(**{"levels": "10", "frame_start": FIRST, "frame_end": LAST} | values)
    bpy.context.view_layer.update()
    assert snapshot() == before
    return str(error.value)


def test_a_topology_that_changes_is_named_with_its_frame() -> None:
    modifier = wire("Solid", [circle(30)]).modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 1
    key(modifier, "show_viewport", [False, True])
    message = refused(bpy.data.objects["Solid"])
    assert f"Frame {LAST}: 'Solid' has 1 loop of 60 vertices instead of 1 loop of 30" in message


def test_a_pose_that_crosses_itself_is_named_with_its_frame() -> None:
    obj = wire("Crossing", [np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)])])
    obj.shape_key_add(name="Basis")
    shape = obj.shape_key_add(name="Crossed")
    shape.data[0].co = (3.0, 0.5, 0.0)
    key(shape, "value", [0.0, 1.0])
    assert "Frame 6: 'Crossing'" in refused(obj, levels="4")


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"levels": "*"}, "leave own objects"),
        ({"frame_end": FIRST}, "at least two frames"),
    ],
)
def test_what_cannot_be_followed_is_refused(values, words) -> None:
    assert words in refused(shaped(), **values)


def test_bound_drawings_are_not_followed() -> None:
    obj = shaped()
    choose(obj)
    bpy.ops.object.nested_cages_generate(levels="16")
    bpy.ops.object.nested_cages_bind(method="AUTO")
    choose(obj)
    assert "unbind" in refused(obj)


def test_follow_and_generate_replace_each_other(addon) -> None:
    obj = shaped()
    choose(obj)
    bpy.ops.object.nested_cages_generate(levels="20, 10")
    follow(obj)
    choose(obj)
    bpy.ops.object.nested_cages_generate(levels="20, 10")
    collection = bpy.data.collections["Shaped Cages"]
    assert not set_in(collection).record.moving and len(collection.objects) == 3
    bpy.context.view_layer.update()
    for member in collection.objects:
        assert np.allclose(member.matrix_world, obj.matrix_world, atol=1e-6)
    follow(obj)
    choose(obj)
    assert bpy.ops.object.nested_cages_remove_animation() == {"FINISHED"}
    assert not set_in(collection).record.moving


def test_the_range_is_the_scenes_if_it_is_not_given(addon) -> None:
    obj = shaped()
    choose(obj)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 2, 6
    bpy.ops.object.nested_cages_follow(levels="12")
    cage = bpy.data.collections["Shaped Cages"].objects[1]
    assert (facts(cage)["flow_start"], facts(cage)["end"]) == (2, 6)


def follower(addon, **values):
    """The class of the operator, and what stands for one with the panel's settings and these."""
    kind = next(c for c in addon.operators.CLASSES if c.bl_idname == "object.nested_cages_follow")
    panel = {name: getattr(bpy.context.scene.nested_cages, name) for name in addon.properties.settings.NAMES}
    given = {"frame_start": 1, "frame_end": 9, "frame_step": 1, "cyclic": False, "still": False} | values
    operator = SimpleNamespace(**panel | given, _set_range=lambda _scene: None)
    operator.properties = SimpleNamespace(is_property_set=given.__contains__)
    operator.take_from_panel = partial(kind.take_from_panel, operator)
    return kind, operator


@pytest.mark.parametrize("steps", slow_after(0, [3, 0, 1, 12, 24], thorough_after=2))
def test_cancelling_leaves_the_scene(addon, steps) -> None:
    obj = shaped()
    choose(obj)
    bpy.context.scene.frame_set(3)
    bpy.context.view_layer.update()
    before = snapshot()
    kind, operator = follower(addon, levels="16, 10")
    work = addon.generation.job.Job(kind.work(operator, bpy.context))
    for _ in range(steps + 1):
        assert not work.advance(0.0)
    work.stop()
    assert snapshot() == before


@pytest.mark.thorough
def test_a_motion_too_fast_for_its_step_names_the_step() -> None:
    obj = wire("Turned", [star(30)])
    obj.shape_key_add(name="Basis")
    shape = obj.shape_key_add(name="Round")
    for point in shape.data:
        point.co.xy = -point.co.xy
    key(shape, "value", [0.0, 1.0])
    sentence = refused(obj, levels="12", frame_start=1, frame_end=6, frame_step=5)
    assert "frame 1: the cage cannot follow the drawing here; lower Step, or use more vertices" in sentence


@pytest.mark.parametrize("levels", ["14, 9", "14, +60%"])
def test_a_user_s_following_begins_with_the_settings_of_the_cages(addon, levels) -> None:
    obj = keyed_points()
    bpy.ops.object.nested_cages_generate(levels=levels, clearance=0.02, energy="SHAPE_KEEPING")
    found = bpy.data.collections["Keyed Cages"]
    counts = [len(each.data.vertices) for each in found.objects][1:]
    bpy.context.scene.nested_cages.levels, bpy.context.scene.nested_cages.clearance = "33", 0.5
    choose(obj)
    kind, operator = follower(addon)
    kind.prepare(operator, bpy.context)
    assert operator.levels in (levels, ", ".join(map(str, counts)))
    assert (operator.clearance, operator.energy) == (pytest.approx(0.02), "SHAPE_KEEPING")
    follow(obj, levels=operator.levels)
    poly_curve("Uncaged", [circle(40)])
    kind.prepare(operator, bpy.context)
    assert (operator.levels, operator.clearance) == ("33", 0.5)
