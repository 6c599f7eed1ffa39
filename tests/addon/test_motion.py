"""Follow Animation and Live: cages that follow drawings which move by any means or are edited, certified as stored."""

from itertools import pairwise
from typing import Any

import bpy
import numpy as np
import pytest

from support import drawings
from support.blender import GOES_ON, new_file, refused, running
from support.drawings import at_frame, base, choose, circle, evaluated, generate, members, set_of, solid, star, wire
from support.marks import slow_after
from support.panels import draw

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
    rig = drawings.armature("Rig", left=((-1.0, 0.0, 0.0), (0.0, 0.0, 0.0)), right=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
    for name, side in (("left", -1.0), ("right", 1.0)):
        drawings.weigh(obj, name, np.clip(0.5 + 2.0 * side * bar[:, 0], 0.0, 1.0))
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    bone = rig.pose.bones["right"]
    bone.rotation_mode = "XYZ"
    key(bone, "rotation_euler", [0.0, 1.0, 0.0], index=2)
    return obj


def keyed_points():
    """A curve whose points are keyed, and whose object turns and moves."""
    obj = drawings.poly_curve("Keyed", [circle(40)])
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
    parent = drawings.add("Parent", None, select=False)
    key(parent, "location", [0.0, 2.0], index=1)
    obj.parent = parent
    return obj


MOTIONS = {f.__name__: f for f in (bent_by_armature, keyed_points, shaped)}


def follow(obj, **values):
    choose(obj)
    values = {"levels": "16, 10", "frame_start": FIRST, "frame_end": LAST, "frame_step": 2} | values
    assert bpy.ops.object.nested_cages_follow(**values) == {"FINISHED"}
    return bpy.data.collections[f"{obj.name} Cages"]


def mesh_of(core, obj, depsgraph=None):
    """An object as it is displayed, as the core's mesh in its own plane."""
    shown = obj.evaluated_get(depsgraph or bpy.context.evaluated_depsgraph_get()).to_mesh()
    points = np.array([vertex.co[:2] for vertex in shown.vertices])
    return core.Mesh(points, np.array([edge.vertices[:] for edge in shown.edges]))


def certified(core, collection, obj, frames) -> None:
    """On each frame, the evaluated cages strictly enclose what is in them, and the drawing itself on its frames."""
    for frame in frames:
        depsgraph = at_frame(frame)
        meshes = [mesh_of(core, each, depsgraph) for each in members(collection)]
        for inner, outer in pairwise(meshes):
            assert core.verify(outer, inner).holds, frame
        if frame == int(frame) and obj.type == "MESH":
            assert core.verify(meshes[1], mesh_of(core, obj, depsgraph)).holds, frame
        for member in members(collection):
            assert np.allclose(member.matrix_world, obj.matrix_world, atol=1e-6)


@pytest.mark.parametrize("motion", slow_after(0, MOTIONS, thorough_after=1))
def test_cages_follow_a_drawing_that_moves_by_any_means(core, motion) -> None:
    obj = MOTIONS[motion]()
    bpy.context.scene.frame_set(4)
    collection = follow(obj, levels="16, 10")
    assert bpy.context.scene.frame_current == 4
    assert [len(o.data.vertices) for o in collection.objects][1:] == [16, 10]
    certified(core, collection, obj, range(FIRST, LAST + 1, 2))
    fine, *cages = members(collection)
    for frame in np.arange(FIRST, LAST, 0.5):
        depsgraph = at_frame(frame)
        for inner, outer in ((fine, cages[0]), (cages[0], cages[1])):
            assert solid(outer, depsgraph).contains(solid(inner, depsgraph)), frame


def test_the_stored_coordinates_are_certified_key_by_key(core) -> None:
    """From the shape keys alone: what Blender stores holds on every key and on the straight way between them."""
    collection = follow(bent_by_armature(), levels="12", frame_step=1)
    fine, cage = members(collection)

    def steps(obj):
        rest = {float(FIRST): base(obj)[:, :2].astype(float)}
        return rest | {f: points[:, :2].astype(float) for f, points in zip(*drawings.keyed_steps(obj), strict=True)}

    keyed, fine_keyed = steps(cage), steps(fine)
    at_rest = [frame for frame in range(FIRST, LAST + 1) if frame not in fine_keyed]
    fine_keyed |= {float(frame): fine_keyed[float(FIRST)] for frame in at_rest}
    frames = sorted(keyed)
    inside = [
        np.stack([np.interp(f, sorted(fine_keyed), [fine_keyed[k].ravel()[i] for k in sorted(fine_keyed)])
                  for i in range(fine_keyed[1.0].size)]).reshape(-1, 2)
        for f in frames
    ]  # fmt: skip
    outer, inner = core.Mesh(keyed[frames[0]], drawings.edges_of(cage)), core.Mesh(inside[0], drawings.edges_of(fine))
    for f, points in zip(frames, inside, strict=True):
        assert core.verify(outer.moved(keyed[f]), inner.moved(points), 0.99e-5 * inner.diagonal).holds
    assert core.verify_motion(outer, inner, np.stack([keyed[f] for f in frames]), np.stack(inside)).free


def test_holes_that_moving_cages_fill_are_told_as_in_the_panel(reports) -> None:
    obj = wire("Ring", [circle(12), circle(6, 0.1)])
    obj.keyframe_insert("location", frame=FIRST)
    follow(obj, levels="5")
    assert reports.read("Warning").startswith("Warning: 1 hole is filled")


def test_a_cyclic_motion_closes(core) -> None:
    collection = follow(bent_by_armature(), cyclic=True, levels="12", frame_end=LAST - 1, frame_step=1)
    _, cage = members(collection)
    first, last = (evaluated(cage, at_frame(frame)) for frame in (FIRST, LAST))
    assert np.allclose(first, last, atol=1e-6)
    assert not np.allclose(first, evaluated(cage, at_frame(5)), atol=0.1)


def test_one_cage_for_all_frames_stands_still(core) -> None:
    obj = bent_by_armature()
    collection = follow(obj, still=True, levels="16, 8")
    _, first, second = members(collection)
    assert all(len(o.data.vertices) == n for o, n in ((first, 16), (second, 8)))
    before = [evaluated(o, at_frame(FIRST)) for o in (first, second)]
    assert all(np.array_equal(b, evaluated(o, at_frame(5))) for b, o in zip(before, (first, second), strict=True))
    certified(core, collection, obj, np.arange(FIRST, LAST, 0.5))  # every frame, whatever the step


def test_the_whole_animation_can_be_verified() -> None:
    obj = shaped()
    collection = follow(obj, frame_step=1)
    bpy.context.scene.frame_end = LAST
    cages = members(collection)[1:]
    assert drawings.verify(*cages, whole=True) and drawings.checked(cages[0]) == [FIRST, LAST]
    assert drawings.certificate(cages[0]).moving


def refuse(obj, *named, **values) -> None:
    choose(obj)
    bpy.context.scene.frame_set(FIRST)
    with refused(f"'{obj.name}'" if named else "", *named):
        bpy.ops.object.nested_cages_follow(**{"levels": "10", "frame_start": FIRST, "frame_end": LAST} | values)


def test_a_topology_that_changes_is_named_with_its_frame() -> None:
    modifier = wire("Solid", [circle(30)]).modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 1
    key(modifier, "show_viewport", [False, True])
    refuse(bpy.data.objects["Solid"], str(LAST), "60", "30")


def test_a_pose_that_crosses_itself_is_named_with_its_frame() -> None:
    obj = wire("Crossing", [np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)])])
    obj.shape_key_add(name="Basis")
    shape = obj.shape_key_add(name="Crossed")
    shape.data[0].co = (3.0, 0.5, 0.0)
    key(shape, "value", [0.0, 1.0])
    refuse(obj, "6", levels="4")


def test_what_cannot_be_followed_is_refused() -> None:
    obj = shaped()
    refuse(obj, levels="*")
    refuse(obj, frame_end=FIRST)
    choose(obj)
    generate("16")
    drawings.bind(method="AUTO")
    refuse(obj)


def test_follow_and_generate_replace_each_other() -> None:
    obj = shaped()
    choose(obj)
    generate("20, 10")
    follow(obj)
    choose(obj)
    generate("20, 10")
    collection = bpy.data.collections["Shaped Cages"]
    assert not drawings.certificate(members(collection)[1]).moving and len(collection.objects) == 3
    bpy.context.view_layer.update()
    for member in collection.objects:
        assert np.allclose(member.matrix_world, obj.matrix_world, atol=1e-6)
    follow(obj)
    choose(obj)
    assert bpy.ops.object.nested_cages_remove_animation() == {"FINISHED"}
    assert not any(obj.data.shape_keys for obj in members(collection))


def test_the_range_is_the_scenes_if_it_is_not_given() -> None:
    obj = shaped()
    choose(obj)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 2, 6
    bpy.ops.object.nested_cages_follow(levels="12")
    cage = drawings.made("Shaped")[1]
    assert (drawings.certificate(cage).frames[0], drawings.end_of(cage)) == (2, 6)


@pytest.mark.parametrize("steps", slow_after(0, [3, 0, 1, 12, 24], thorough_after=1))
def test_cancelling_leaves_the_scene(window, hasty, steps) -> None:
    obj = shaped()
    choose(obj)
    bpy.context.scene.frame_set(3)
    bpy.context.view_layer.update()
    before = drawings.snapshot()
    operator = window.operator("follow", levels="16, 10", frame_start=1, frame_end=9, frame_step=1)
    assert window.invoke(operator) == {"RUNNING_MODAL"}
    for _ in range(steps):
        window.tick(operator)
    assert running()
    operator.cancel(window.context)
    bpy.context.view_layer.update()
    assert drawings.snapshot() == before and not running()


@pytest.mark.thorough
def test_a_motion_too_fast_for_its_step_names_the_step() -> None:
    obj = wire("Turned", [star(30)])
    obj.shape_key_add(name="Basis")
    shape = obj.shape_key_add(name="Round")
    for point in shape.data:
        point.co.xy = -point.co.xy
    key(shape, "value", [0.0, 1.0])
    refuse(obj, "1", levels="12", frame_start=1, frame_end=6, frame_step=5)


@pytest.mark.parametrize("levels", slow_after(1, ["14, 9", "14, +60%"], thorough_after=1))
def test_a_user_s_following_begins_with_the_settings_of_the_cages(window, levels) -> None:
    obj = keyed_points()
    generate(levels, clearance=0.02, energy="SHAPE_KEEPING")
    counts = [len(each.data.vertices) for each in drawings.made("Keyed")][1:]
    bpy.context.scene.nested_cages.levels, bpy.context.scene.nested_cages.clearance = "33", 0.5
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = FIRST, LAST
    choose(obj)
    operator = window.operator("follow", frame_step=2)
    assert window.invoke(operator) in GOES_ON and window.finish(operator) == {"FINISHED"}
    found = set_of(obj)
    assert [len(cage.data.vertices) for cage in found] == counts
    assert found.settings.clearance == pytest.approx(0.02) and found.settings.energy == "SHAPE_KEEPING"
    assert all(each.moving and each.clearance >= 0.02 * (1 - 1e-6) for each in found.certificates)


# Live


def switched_on(make: Any, levels: str = "24, 12", **settings: Any) -> Any:
    """A drawing with cages, and Live switched on."""
    obj = make()
    generate(levels, **settings)
    obj.hide_viewport = False
    choose(obj)
    assert bpy.ops.object.nested_cages_live() == {"FINISHED"}
    return obj


@pytest.fixture
def followed(core, timers, hasty) -> Any:
    """Waits until the cages enclose the drawing as it is now; whether they do."""

    def encloses(obj: Any) -> bool:
        meshes = [mesh_of(core, obj), *(mesh_of(core, cage) for cage in members(obj)[1:])]
        return all(core.verify(outer, inner).holds for inner, outer in pairwise(meshes))

    def follow(obj: Any, most: int = 600) -> bool:
        bpy.context.view_layer.update()
        for _ in range(most):
            timers.run()
            fine = members(obj)[0]
            same = len(base(fine)) == len(evaluated(obj)) and np.allclose(base(fine), evaluated(obj), atol=1e-6)
            if same and not running() and encloses(obj):
                return True
        return False

    return follow


def handlers() -> int:
    found = [getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)]
    return sum(len(kind) for kind in found if isinstance(kind, list))


def star_curve() -> Any:
    return flat(drawings.poly_curve("Drawing", [star()]))


def flat(obj: Any) -> Any:
    """A curve without a fill, whose displayed vertices are those of its outline."""
    obj.data.dimensions = "3D"
    return obj


def star_mesh() -> Any:
    return wire("Drawing", [star()])


def move_points(obj: Any, factor: float) -> None:
    if obj.type == "CURVE":
        for point in list(obj.data.splines[0].points)[:8]:
            point.co = (factor * point.co[0], factor * point.co[1], 0.0, 1.0)
    else:
        for vertex in list(obj.data.vertices)[:8]:
            vertex.co = factor * vertex.co
        obj.data.update()
    obj.data.update_tag()


@pytest.mark.parametrize("make", slow_after(1, [star_curve, star_mesh]))
def test_an_edit_is_followed_by_a_step(followed, make) -> None:
    obj = switched_on(make)
    assert followed(obj)
    cages = members(obj)[1:]
    meshes = [cage.data for cage in cages]
    for factor in (1.1, 1.05, 0.9):
        move_points(obj, factor)
        assert followed(obj)
        assert all(np.array_equal(base(cage), base(cage).astype(np.float32)) for cage in cages)
    assert [cage.data for cage in cages] == meshes  # by steps: these are the same meshes
    assert not any(each.edited for each in set_of(obj).certificates)


@pytest.mark.parametrize("make", slow_after(1, [star_curve, star_mesh]))
def test_edit_mode_is_followed(followed, make) -> None:
    obj = switched_on(make)
    assert followed(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    select = bpy.ops.curve.select_all if obj.type == "CURVE" else bpy.ops.mesh.select_all
    select(action="SELECT")
    bpy.ops.transform.resize(value=(1.2, 1.0, 1.0))
    assert followed(obj) and obj.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    fine, cage, _ = members(obj)
    assert solid(cage).contains(solid(fine)) and np.ptp(base(fine)[:, 0]) == pytest.approx(
        1.2 * np.ptp(star().astype(np.float32)[:, 0]), rel=1e-5
    )


def test_another_topology_is_made_anew_and_can_be_cancelled(followed, timers) -> None:
    obj = switched_on(star_curve)
    assert followed(obj)
    before = [evaluated(each) for each in members(obj)]
    spline = obj.data.splines.new("POLY")
    spline.points.add(19)
    loop = circle(20, 0.4, (4.0, 0.0))
    spline.points.foreach_set("co", np.column_stack([loop, np.zeros(20), np.ones(20)]).ravel())
    spline.use_cyclic_u = True
    obj.data.update_tag()
    bpy.context.view_layer.update()
    for _ in range(600):
        timers.run()
        if running():
            break
    assert bpy.ops.object.nested_cages_cancel() == {"FINISHED"}
    assert not followed(obj, 50)
    assert all(np.array_equal(points, evaluated(each)) for points, each in zip(before, members(obj), strict=True))
    move_points(obj, 1.0)
    assert followed(obj)
    assert [len(each.data.vertices) for each in members(obj)] == [80, 24, 12]
    move_points(obj, 1.1)
    assert followed(obj)


def test_what_cannot_be_caged_is_said_and_nothing_changes(followed, timers) -> None:
    obj = switched_on(star_curve)
    assert followed(obj)
    before, quiet = [evaluated(each) for each in members(obj)], draw()
    obj.data.splines[0].use_cyclic_u = False
    obj.data.update_tag()
    bpy.context.view_layer.update()
    for _ in range(50):
        timers.run()
    assert len(draw()) > len(quiet)  # why they cannot follow
    assert all(np.array_equal(points, evaluated(each)) for points, each in zip(before, members(obj), strict=True))
    obj.data.splines[0].use_cyclic_u = True
    move_points(obj, 1.1)
    assert followed(obj) and len(draw()) == len(quiet)


def test_the_panel_says_whether_the_cages_are_behind(followed) -> None:
    obj = switched_on(star_curve)
    assert followed(obj)
    now = draw()
    other = drawings.poly_curve("Other", [circle()])
    choose(obj)
    bpy.context.view_layer.update()
    followed(obj, 20)
    move_points(other, 1.2)
    bpy.context.view_layer.update()
    assert draw() == now  # other objects do not make it look
    move_points(obj, 1.1)
    bpy.context.view_layer.update()
    behind = draw()
    (place,) = [k for k, (one, other) in enumerate(zip(now, behind, strict=True)) if one != other]
    assert followed(obj) and draw()[place] == now[place]


def test_nothing_is_left_behind(extension, followed, timers, tmp_path) -> None:
    """When it is switched off, another file is opened, its drawing is removed, or the add-on is disabled."""
    before = handlers()
    for end in (
        bpy.ops.object.nested_cages_live,
        lambda: bpy.ops.wm.open_mainfile(filepath=drawings.save(tmp_path / "live.blend")),
        lambda: bpy.data.objects.remove(bpy.data.objects["Drawing"]),
    ):
        switched_on(star_curve)
        assert handlers() == before and timers.functions
        end()
        for _ in range(50):
            timers.run()
        assert handlers() == before and not timers.functions
        new_file()
    switched_on(star_curve)
    extension.unregister()
    assert handlers() < before and not timers.functions
    extension.register()
    assert handlers() == before


def test_undo_is_followed(followed) -> None:
    """Blender notes an edit before the cages follow it."""
    obj = switched_on(star_curve)
    assert followed(obj)
    bpy.ops.ed.undo_push(message="before")
    move_points(obj, 1.3)
    bpy.ops.ed.undo_push(message="edited")
    assert followed(obj)
    for step in (bpy.ops.ed.undo, bpy.ops.ed.redo):
        step()
        assert followed(bpy.data.objects["Drawing"])
    move_points(bpy.data.objects["Drawing"], 1.05)
    assert followed(bpy.data.objects["Drawing"])


def test_a_drawing_gets_cages_while_those_of_another_follow_it(window, hasty) -> None:
    switched_on(star_curve)
    choose(other := wire("Other", [circle(20, 0.4, (4.0, 0.0))]))
    operator = window.operator("generate", levels="8")
    window.invoke(operator)
    assert any(window.tick(operator) == {"FINISHED"} for _ in range(600)) and len(members(other)) == 2


def test_bound_cages_do_not_follow_edits() -> None:
    wire("Drawing", [star()])
    generate("20")
    drawings.bind()
    assert not bpy.ops.object.nested_cages_live.poll()


PROMISES = [("0.05u", {}), ("24, +20%", {}), ("24, 12", {"clearance": 0.05})]


@pytest.mark.parametrize(("levels", "settings"), PROMISES)
def test_a_cage_keeps_the_promises_that_it_was_made_with(core, followed, levels, settings) -> None:
    """Whatever the panel shows; a step that would break one makes the cages again."""
    bpy.context.scene.nested_cages.clearance = 0.0
    obj = switched_on(star_curve, levels, **settings)
    for factor in (1.3, 1.2, 0.8):
        move_points(obj, factor)
        assert followed(obj)
        fine, *cages = (mesh_of(core, each) for each in members(obj))
        if levels == "0.05u":
            assert core.Within(distance=0.05).is_met(cages[0], fine)
        elif settings:
            found = [core.verify(outer, inner) for inner, outer in pairwise([fine, *cages])]
            assert min(each.clearance for each in found) >= 0.05 * (1.0 - 1e-6)
        else:
            assert core.Within(excess=0.2).is_met(cages[1], fine)
        assert set_of(obj).settings.levels == levels
        said = set_of(obj).certificates[-1].need  # how a tolerance is met
        assert not said if settings else str(len(members(obj)[-1].data.vertices)) in said.split()
