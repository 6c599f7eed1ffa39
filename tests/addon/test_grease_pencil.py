"""Grease Pencil: what it paints, on each frame, is what is caged, cut out and rigged, and it follows."""

import re
from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import bpy
import numpy as np
import pytest
import shapely

from support.blender import refused
from support.drawings import (
    Loop,
    add,
    apart,
    base,
    bind,
    certificate,
    choose,
    circle,
    faces_of,
    generate,
    in_world,
    silhouette,
    solid,
    verify,
)
from support.marks import slow_after

pytestmark = pytest.mark.skipif(bpy.app.version < (4, 3), reason="another Grease Pencil")
# Whether each stroke says what shows of it; else its material does.
PER_STROKE = bpy.app.version >= (5, 2)
RADIUS = 0.05
Shape = shapely.Geometry


def drawn(kind: str) -> Any:
    bpy.ops.object.grease_pencil_add(type=kind)
    return bpy.context.object


def fine_of(source: Any) -> Any:
    return bpy.data.objects[f"{source.name} Fine"]


def cages_of(source: Any) -> list[Any]:
    """The cages of a drawing, the innermost first."""
    names = [f"{source.name} Cage {number}" for number in (1, 2)]
    return [bpy.data.objects[name] for name in names if name in bpy.data.objects]


def square(half: float, x: float = 0.0, z: float = 0.0) -> Loop:
    return half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) + (x, z)


def box(half: float, x: float = 0.0, z: float = 0.0) -> Shape:
    return shapely.Polygon(square(half, x, z))


def pen() -> Any:
    """An object with an empty layer and materials for lines, for fills, and for holes."""
    made = drawn("EMPTY")
    made.data.materials.clear()
    for name in ("Line", "Fill", "Hole"):
        material = bpy.data.materials.new(name)
        bpy.data.materials.create_gpencil_data(material)
        style = material.grease_pencil
        style.color = style.fill_color = (0.1, 0.2, 0.3, 1.0)
        if not PER_STROKE:
            style.show_stroke, style.show_fill = name == "Line", name != "Line"
        style.use_fill_holdout = name == "Hole"
        made.data.materials.append(material)
    return made


def strokes(target: Any, *loops: Loop, fill: int = 0, cyclic: bool = True, radius: float = RADIUS, material: int = -1):
    """New strokes in the plane of x and z on a drawing, or on the first layer's: lines, or without them one fill."""
    drawing = target.data.layers[0].current_frame().drawing if hasattr(target, "data") else target
    drawing.add_strokes([len(loop) for loop in loops])
    added = list(drawing.strokes)[-len(loops) :]
    for stroke, loop in zip(added, loops, strict=True):
        stroke.cyclic, stroke.material_index = cyclic, material if material >= 0 else int(fill > 0)
        for point, (x, z) in zip(stroke.points, loop, strict=True):
            point.position, point.radius, point.opacity = (x, 0.0, z), radius, 1.0
        stroke.fill_opacity = 1.0
        if PER_STROKE:
            stroke.fill_id, stroke.hide_stroke = fill, fill > 0
    return added


def seen(obj: Any) -> Shape:
    """What an object paints, seen from the front: its silhouette."""
    chosen = list(bpy.context.selected_objects)
    choose(obj)
    found = silhouette(plane="FRONT")
    area = faces_of(found, in_world(found, base(found))[:, [0, 2]])
    bpy.data.objects.remove(found)
    choose(*chosen, obj)
    return area


def upright(obj: Any) -> Shape:
    """The inside of an object's outline, seen from the front."""
    lines = [[np.array(obj.matrix_world @ obj.data.vertices[i].co)[[0, 2]] for i in e.vertices] for e in obj.data.edges]
    faces = list(shapely.get_parts(shapely.polygonize([shapely.union_all([shapely.LineString(x) for x in lines])])))
    return max(faces, key=lambda face: shapely.Polygon(face.exterior).area)


def expected(obj: Any) -> Shape:
    """What one of Blender's own drawings paints, by the properties of its strokes."""
    shapes = []
    for layer in obj.data.layers:
        for stroke in layer.current_frame().drawing.strokes:
            points = [(*point.position, point.radius) for point in stroke.points]
            style = obj.material_slots[stroke.material_index].material.grease_pencil
            filled, lined = (
                (stroke.fill_id > 0, not stroke.hide_stroke) if PER_STROKE else (style.show_fill, style.show_stroke)
            )
            if filled:
                shapes.append(shapely.Polygon([(x, z) for x, _, z, _ in points]).buffer(0.0))
            ends = [shapely.Point(x, z).buffer(r, 32) for x, _, z, r in points]
            shapes += [(a | b).convex_hull for a, b in pairwise(ends)] if lined else []
    return shapely.union_all(shapes)


@pytest.mark.slow
@pytest.mark.parametrize("kind", slow_after(1, ["STROKE", "MONKEY"], thorough_after=1))
def test_blenders_own_drawings_are_caged_as_they_are_painted(kind: str) -> None:
    source = drawn(kind)
    paint = expected(source)
    generate("64, 24")
    fine, cages = fine_of(source), cages_of(source)
    assert len(cages) == 2
    assert apart(upright(fine), paint) < 0.02
    assert (paint - upright(fine)).area < 1e-5 * paint.area
    for cage in cages:
        assert upright(cage).contains(paint)
    choose(source)
    assert bpy.ops.object.nested_cages_import(outlines="SELECTED") == {"FINISHED"}
    assert solid(bpy.context.object).area == pytest.approx(paint.area, rel=0.02)


def test_fills_have_their_holes() -> None:
    obj = pen()
    if PER_STROKE:
        strokes(obj, square(1.0), square(0.5), fill=1)
    else:
        strokes(obj, square(1.0), fill=1)
        strokes(obj, square(0.5), fill=2, material=2)
    strokes(obj, square(0.2), fill=3)
    ring = (box(1.0) - box(0.5)) | box(0.2)
    assert apart(seen(obj), ring) < 1e-6
    choose(obj)
    generate("24")
    assert len(fine_of(obj).data.vertices) == 12


def test_a_stroke_fills_all_that_it_winds_around() -> None:
    obj, pentagram = pen(), circle(5)[[0, 2, 4, 1, 3]]
    strokes(obj, pentagram, fill=1)
    inner = shapely.Polygon(circle(5, 0.3))
    assert seen(obj).contains(inner)


@pytest.mark.parametrize("cyclic", [False, True])
def test_lines_count_with_their_width_and_closed_ones_with_their_inside(cyclic: bool) -> None:
    obj = pen()
    strokes(obj, square(1.0), cyclic=cyclic)
    line = shapely.LineString(np.concatenate([square(1.0), square(1.0)[:cyclic]])).buffer(RADIUS, 32)
    assert apart(seen(obj), line) < 0.01
    choose(obj)
    generate("16", close_open=False)
    fine = upright(fine_of(obj))
    assert apart(fine, line | box(1.0) if cyclic else line) < 0.01
    generate("16", close_open=True)
    assert apart(upright(fine_of(obj)), line | box(1.0)) < 0.01


@pytest.mark.skipif(not PER_STROKE, reason="round corners only")
@pytest.mark.parametrize("cyclic", [False, True])
def test_sharp_corners_are_inside(cyclic: bool) -> None:
    obj, zigzag = pen(), np.array([[-0.8, -0.5], [0.5, 0.6], [-0.5, 0.6], [0.8, -0.6]])
    strokes(obj, zigzag, cyclic=cyclic, radius=0.15)
    drawing = obj.data.layers[0].current_frame().drawing
    limits = drawing.attributes.new("miter_angle", "FLOAT", "POINT")
    limits.data.foreach_set("value", np.full(4, 0.3, np.float32))
    line = shapely.LineString(zigzag[[0, 1, 2, 3, 0, 1] if cyclic else [0, 1, 2, 3]])
    sharp = line.buffer(0.15, join_style="mitre", mitre_limit=1.0 / np.sin(0.15), cap_style="flat")
    found = seen(obj)
    assert (sharp - found).area < 1e-5
    assert (found - (sharp | line.buffer(0.15, 32))).area < 0.01 * sharp.area
    limits.data.foreach_set("value", np.full(4, 1.5, np.float32))
    obj.data.update_tag()
    assert apart(seen(obj), line.buffer(0.15, 32)) < 0.01


def hide_by_material(obj: Any, colour: Any = None) -> None:
    material = obj.data.materials[0].copy()
    obj.data.materials.append(material)
    second(obj).material_index = 3
    if colour:
        material.grease_pencil.color = material.grease_pencil.fill_color = colour
    else:
        material.grease_pencil.hide = True


def hide_by_opacity(obj: Any) -> None:
    for point in second(obj).points:
        point.opacity = 0.0


def second(obj: Any) -> Any:
    """The second stroke."""
    return obj.data.layers[0].current_frame().drawing.strokes[1]


STROKE = {
    "material": hide_by_material,
    "colour": lambda obj: hide_by_material(obj, (1.0, 1.0, 1.0, 0.0)),
    "opacity": hide_by_opacity,
    **({"stroke": lambda obj: setattr(second(obj), "hide_stroke", True)} if PER_STROKE else {}),
}
LAYER = {
    "opacity": lambda layer: setattr(layer, "opacity", 0.0),
    "eye": lambda layer: setattr(layer, "hide", True),
    "group": lambda layer: setattr(layer.parent_group, "hide", True),
}


@pytest.mark.parametrize("layer", LAYER)
@pytest.mark.parametrize("stroke", STROKE)
def test_strokes_and_layers_that_do_not_show_are_left_out(stroke, layer, reports) -> None:
    obj = pen()
    strokes(obj, square(1.0), fill=1)
    strokes(obj, square(1.0, 5.0))
    hidden = obj.data.layers.new("Hidden")
    strokes(hidden.frames.new(1).drawing, square(1.0, -5.0))
    obj.data.layers.move_to_layer_group(hidden, obj.data.layer_groups.new("Group"))
    LAYER[layer](hidden)
    STROKE[stroke](obj)
    assert apart(seen(obj), box(1.0)) < 1e-6
    generate("4")
    (told,) = {line for line in reports.read("Info").splitlines() if f"'{obj.name}'" in line}
    assert re.findall(r"\d+", told) == ["1"] * (1 + (layer == "opacity"))  # a stroke, and a layer with an open eye


def test_a_fill_without_opacity_leaves_the_line() -> None:
    obj = pen()
    (stroke,) = strokes(obj, square(1.0), fill=1)
    if PER_STROKE:
        stroke.hide_stroke = False
    else:
        obj.data.materials[1].grease_pencil.show_stroke = True
    stroke.fill_opacity = 0.0
    assert seen(obj).area == pytest.approx(8 * 2 * RADIUS, rel=0.05)


@pytest.mark.parametrize("hides", [False, True])
def test_masks_count(hides: bool) -> None:
    obj = pen()
    strokes(obj, square(1.0), fill=1)
    for name, x in (("One", 0.8), ("Two", -0.8), ("Hidden", 0.0)):
        layer = obj.data.layers.new(name, set_active=False)
        strokes(layer.frames.new(1).drawing, square(0.5, x, 0.8), fill=1)
        layer.opacity, layer.hide = 0.0, name == "Hidden"
        bpy.ops.grease_pencil.layer_mask_add(name=name)
    masked = obj.data.layers[0]
    masked.use_masks = True
    for mask in masked.mask_layers:
        mask.invert = hides
    both = box(0.5, 0.8, 0.8) | box(0.5, -0.8, 0.8)
    assert apart(seen(obj), box(1.0) - both if hides else box(1.0) & both) < 1e-6
    masked.mask_layers[0].hide = True
    one = box(0.5, -0.8, 0.8)
    assert apart(seen(obj), box(1.0) - one if hides else box(1.0) & one) < 1e-6


def test_layers_count_where_they_are_and_scale_no_width() -> None:
    obj, carrier = pen(), add("Carrier", None, select=False)
    strokes(obj, square(1.0), radius=0.1)
    layer = obj.data.layers[0]
    layer.translation, layer.scale, layer.parent = (1.0, 0.0, 0.0), (0.5, 0.5, 0.5), carrier
    obj.location, carrier.location = (0.0, 0.0, 3.0), (0.0, 0.0, -2.0)
    line = shapely.LinearRing(square(0.5, 1.0, -2.0)).buffer(0.1, 32)
    assert apart(seen(obj), line) < 0.01
    obj.scale = (1.0, 1.0, 8.0)  # the width is that of the object's mean scale
    assert apart(seen(obj), shapely.LinearRing(square(0.5, 1.0, -2.0)).buffer(0.2, 32)) < 0.01


def test_layers_at_other_depths_are_one_drawing_and_leaning_strokes_are_told() -> None:
    obj = pen()
    strokes(obj, square(1.0), fill=1)
    behind = obj.data.layers.new("Behind")
    strokes(behind.frames.new(1).drawing, square(1.0, 1.0), fill=1)
    behind.translation = (0.0, 0.7, 0.0)
    choose(obj)
    generate("8")
    assert apart(upright(fine_of(obj)), box(1.0) | box(1.0, 1.0)) < 1e-5
    obj.data.layers[0].current_frame().drawing.strokes[0].points[0].position = (-1.0, 0.5, -1.0)
    with refused(f"'{obj.name}'", unchanged=False):
        generate("8")


@pytest.mark.parametrize("cyclic", [False, True])
@pytest.mark.parametrize("kind, knots", [("CATMULL_ROM", 0), ("BEZIER", 0), ("NURBS", 0), ("NURBS", 1)])
def test_curves_go_where_blender_draws_them(kind: str, knots: int, cyclic: bool) -> None:
    obj = pen()
    drawing = obj.data.layers[0].current_frame().drawing
    if not hasattr(drawing, "set_types"):
        pytest.skip("before Blender 5.0, scripts cannot set the type of strokes")
    added = strokes(obj, circle(7)[::-1] * (1.0, 0.4), cyclic=cyclic)
    for point in added[0].points:
        point.radius = 0.02
    drawing.set_types(type=kind)
    for name, turn in (("handle_left", 0.3), ("handle_right", -0.2)) if kind == "BEZIER" else ():
        handles = drawing.attributes.get(name) or drawing.attributes.new(name, "FLOAT_VECTOR", "POINT")
        for handle, point in zip(handles.data, added[0].points, strict=True):
            handle.vector = (point.position[0] + turn * point.position[2], 0.0, point.position[2] + turn)
    if knots and cyclic:
        pytest.skip("told, and made by no operator of Blender's")
    if knots:
        modes = drawing.attributes.get("knots_mode") or drawing.attributes.new("knots_mode", "INT8", "CURVE")
        modes.data[0].value = knots
    points = converted(obj)[:, [0, 2]]
    assert len(points) > 40
    line = shapely.LineString(np.concatenate([points, points[:cyclic]])).buffer(0.02, 32)
    assert apart(seen(obj), line) < 0.01


def converted(obj: Any) -> Loop:
    """Points (n, 3) of the curves of an object, as Blender evaluates them."""
    tree = bpy.data.node_groups.new("Curves", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    before = tree.nodes.new("GeometryNodeObjectInfo")
    before.inputs["Object"].default_value = obj
    socket = before.outputs["Geometry"]
    for kind in ("GreasePencilToCurves", "RealizeInstances", "CurveToMesh"):
        node = tree.nodes.new(f"GeometryNode{kind}")
        tree.links.new(socket, node.inputs[0])
        socket = node.outputs[0]
    tree.links.new(socket, tree.nodes.new("NodeGroupOutput").inputs[0])
    helper = bpy.data.objects.new("Helper", bpy.data.meshes.new("Helper"))
    bpy.context.scene.collection.objects.link(helper)
    helper.modifiers.new("Curves", "NODES").node_group = tree
    mesh = helper.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    return np.array([tuple(vertex.co) for vertex in mesh.vertices])


@pytest.mark.slow
def test_a_straight_stroke_and_a_dot_stand_upright() -> None:
    for loop in (np.array([[-1.0, 0.0], [1.0, 0.0]]), np.array([[0.0, -1.0], [0.0, 1.0]]), np.zeros((1, 2))):
        obj = pen()
        strokes(obj, loop, cyclic=False)
        choose(obj)
        generate("8")
        line = shapely.LineString(loop) if len(loop) > 1 else shapely.Point(0.0, 0.0)
        assert upright(cages_of(obj)[0]).contains(line.buffer(RADIUS))


def keyed() -> Any:
    """A square on frame 1, another one further right on frame 10."""
    obj = pen()
    strokes(obj, square(1.0), fill=1)
    strokes(obj.data.layers[0].frames.new(10).drawing, square(1.0, 0.5), square(0.2, 0.3, 1.2), fill=1)
    return obj


def encloses_all_frames(obj: Any, frames: Any) -> list[Shape]:
    """The finest cage on some frames, which is around what is painted there."""
    found = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        paint, cage = expected(obj), solid_now(cages_of(obj)[0])
        assert cage.contains(paint), frame
        found.append(cage)
    return found


def solid_now(obj: Any) -> Shape:
    """The inside of an object's displayed outline, seen from the front."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    lines = [[np.array(obj.matrix_world @ mesh.vertices[i].co)[[0, 2]] for i in e.vertices] for e in mesh.edges]
    return shapely.union_all(list(shapely.polygonize(shapely.linestrings(lines)).geoms))


def redrawn() -> Any:
    """Frames 1, 4, 7: a fill, two fills far apart, an open stroke with its width; frame 9 as frame 1."""
    obj = pen()
    strokes(obj, square(1.0), fill=1)
    frames = obj.data.layers[0].frames
    strokes(frames.new(4).drawing, square(0.5, 1.0), square(0.3, -1.5, 0.5), fill=2)
    strokes(frames.new(7).drawing, circle(7)[:5] * 0.8, cyclic=False, radius=0.2)
    frames.copy(1, 9)
    choose(obj)
    return obj


@pytest.mark.slow
def test_cages_follow_a_drawing_that_is_drawn_anew_and_are_held() -> None:
    obj = redrawn()
    keys = {"levels": "12, 8", "frame_start": 1, "frame_end": 10}
    assert bpy.ops.object.nested_cages_follow(**keys) == {"FINISHED"}
    cages = encloses_all_frames(obj, range(1, 11))
    assert [len(cage.data.vertices) for cage in cages_of(obj)] == [12, 8]
    same = [one.equals(other) for one, other in pairwise(cages)]
    assert same == [frame + 1 not in (4, 7, 9) for frame in range(1, 10)]
    assert apart(cages[0], box(1.0)) < 0.05 and cages[-1].equals(cages[0])
    choose(obj)
    bpy.context.scene.frame_end = 10
    assert verify(*cages_of(obj), whole=True), certificate(cages_of(obj)[0]).finding
    with refused(unchanged=False):
        bpy.ops.object.nested_cages_follow(**keys, frame_step=2)


def test_one_cage_around_all_keys_bends_each_of_them() -> None:
    obj = redrawn()
    assert bpy.ops.object.nested_cages_follow(levels="16", frame_start=1, frame_end=10, still=True) == {"FINISHED"}
    cages = encloses_all_frames(obj, (1, 4, 7, 9))
    assert all(cage.equals(cages[0]) for cage in cages)
    choose(obj)
    bind()
    still = on_frames(obj, (1, 4, 7, 9))
    for vertex in cages_of(obj)[0].data.vertices:
        vertex.co.x += 0.5 * vertex.co.y
    for frame, points in on_frames(obj, still).items():
        bent = still[frame] + np.column_stack([0.5 * still[frame][:, 2], np.zeros((len(points), 2))])
        np.testing.assert_allclose(points, bent, atol=1e-4)


def shown(obj: Any) -> Loop:
    """World points (n, 3) of all layers as they are displayed."""
    bpy.context.view_layer.update()
    seen = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    found = []
    for layer in seen.data.layers:
        above = layer.parent.matrix_world @ layer.matrix_parent_inverse if layer.parent else seen.matrix_world
        drawing = layer.current_frame().drawing
        found += [above @ layer.matrix_local @ p.position for stroke in drawing.strokes for p in stroke.points]
    return np.array(found)


def on_frames(obj: Any, frames: Iterable[int]) -> dict[int, Loop]:
    """The same, on some frames."""
    found = {}
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        found[frame] = shown(obj)
    return found


def test_layers_with_transforms_of_their_own_bend_where_they_are() -> None:
    obj, carrier = pen(), add("Carrier", None, select=False)
    strokes(obj, square(1.0), fill=1)
    for name, x in (("Moved", 0.3), ("Carried", -0.2)):
        layer = obj.data.layers.new(name)
        strokes(layer.frames.new(1).drawing, square(0.5, x, 1.0), cyclic=False)
        layer.rotation = (0.0, 0.5, 0.0)
        layer.translation, layer.scale = (x, 0.0, 0.2), (1.5, 1.0, 0.5)
    layer.parent, carrier.location, carrier.rotation_euler.y = carrier, (0.1, 0.0, 0.3), 0.4
    obj.rotation_euler.y, obj.scale = 0.7, (2.0, 2.0, 2.0)
    choose(obj)
    generate("8")
    still, (cage,) = shown(obj), cages_of(obj)
    bind()
    np.testing.assert_allclose(shown(obj), still, atol=1e-5)
    for vertex in cage.data.vertices:
        vertex.co.x += 2.0
    across = np.array(cage.matrix_world)[:3, 0] * 2.0
    np.testing.assert_allclose(shown(obj), still + across, atol=1e-5)
    count, added = len(still), obj.data.layers.new("Later")
    strokes(added.frames.new(1).drawing, square(0.2, 0.0, 0.0), fill=1)
    np.testing.assert_allclose(shown(obj)[:count], still + across, atol=1e-5)
    assert np.ptp(shown(obj)[count:], axis=0).max() > 0.3
    choose(obj)
    assert bpy.ops.object.nested_cages_bind(action="UNBIND") == {"FINISHED"}
    np.testing.assert_allclose(shown(obj)[:count], still, atol=1e-5)
    assert not len(obj.data.attributes)


@pytest.mark.slow
def test_a_cutout_makes_each_layer_a_part_to_pose() -> None:
    obj = keyed()
    head, mask = obj.data.layers.new("Head"), obj.data.layers.new("Mask")
    strokes(head.frames.new(1).drawing, square(0.5, 0.0, 2.0), fill=1)
    strokes(mask.frames.new(1).drawing, square(0.5, 0.2, 2.0), fill=1)
    mask.opacity = 0.0
    obj.data.layers.active = head
    bpy.ops.grease_pencil.layer_mask_add(name="Mask")
    head.use_masks = True
    obj.data.layers.new("Empty").frames.new(1)
    name = obj.data.layers[0].name
    choose(obj)
    assert bpy.ops.object.nested_cages_cutout(levels="8") == {"FINISHED"}
    body, top = bpy.data.objects[f"{obj.name} {name}"], bpy.data.objects[f"{obj.name} Head"]
    assert [len(layer.frames) for layer in body.data.layers] == [2]
    assert top.data.layers.keys() == ["Head", "Mask"]
    assert apart(upright(fine_of(top)), box(0.5, 0.0, 2.0) & box(0.5, 0.2, 2.0)) < 1e-5
    assert obj.hide_get() and obj.hide_render and len(obj.data.layers) == 4
    rig = bpy.context.object
    assert rig.type == "ARMATURE"
    still, before = shown(top), on_frames(body, (1, 10))
    for bone in rig.pose.bones:
        if bone.name.startswith(body.name):
            bone.location.x = 1.0
    for frame, points in on_frames(body, (1, 10)).items():
        assert np.abs(points - before[frame]).max() > 0.1
    assert np.abs(shown(top) - still).max() < 1e-6


def test_a_cutout_that_fails_leaves_nothing() -> None:
    obj = pen()
    strokes(obj, square(1.0), fill=1)
    obj.data.layers[0].current_frame().drawing.strokes[0].points[0].position = (-1.0, 0.5, -1.0)
    choose(obj)
    before = len(bpy.data.objects), len(bpy.data.collections)
    with refused(unchanged=False):
        bpy.ops.object.nested_cages_cutout(levels="8")
    assert (len(bpy.data.objects), len(bpy.data.collections)) == before and not obj.hide_get()


@pytest.mark.slow
def test_live_goes_along_from_frame_to_frame(timers, hasty) -> None:
    obj = redrawn()
    generate("12")
    choose(obj)
    assert bpy.ops.object.nested_cages_live() == {"FINISHED"}

    def followed(shape: Shape) -> bool:
        """Whether the cage is around what is painted, after some time."""
        bpy.context.view_layer.update()
        for _ in range(1000):
            if solid_now(cages_of(obj)[0]).contains(shape):
                return True
            timers.run()
        return False

    for frame in (4, 5, 7, 9):
        bpy.context.scene.frame_set(frame)
        assert followed(expected(obj)), frame
    strokes(obj.data.layers[0].current_frame().drawing, square(0.4, 2.0), fill=3)
    obj.data.update_tag()
    assert followed(box(0.4, 2.0))


@pytest.mark.slow
@pytest.mark.parametrize("frame", slow_after(1, [7, 4], thorough_after=1))
def test_what_is_painted_on_a_later_frame_is_silhouetted_cut_out_and_rigged(frame: int) -> None:
    obj = redrawn()
    strokes(obj.data.layers[0].frames[1].drawing, np.array([[-1.5, 0.5], [1.0, 0.0]]), cyclic=False)
    bpy.context.scene.frame_set(frame)
    paint = seen(obj)
    assert bpy.ops.object.nested_cages_import(outlines="SELECTED") == {"FINISHED"}
    assert apart(solid_now(bpy.context.object), paint) < 1e-4
    bpy.data.objects.remove(bpy.context.object)
    choose(obj)
    assert bpy.ops.object.nested_cages_puppet(source="BONES") == {"FINISHED"}
    rig = bpy.context.object
    assert bpy.ops.object.nested_cages_puppet(source="ONE_CAGE") == {"FINISHED"}
    assert solid_now(cages_of(obj)[0]).contains(paint)
    before = shown(obj)
    rig.pose.bones[0].rotation_mode, rig.pose.bones[0].rotation_euler.z = "XYZ", 0.5
    assert np.abs(shown(obj) - before).max() > 0.1 and np.abs(shown(obj)[:, 1]).max() < 1e-4
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.scene.frame_set(1)
    other = redrawn()
    bpy.context.scene.frame_set(frame)
    assert bpy.ops.object.nested_cages_cutout(levels="12") == {"FINISHED"}
    part = bpy.data.objects[f"{other.name} {other.data.layers[0].name}"]
    assert solid_now(cages_of(part)[0]).contains(seen(part))
