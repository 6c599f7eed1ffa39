"""Objects to test with, what a scene consists of, and the evaluated shape of an object as shapely sees it."""

import re
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import bpy
import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

from .shapes import ring

Loop = NDArray[np.float64]

PACKAGE = "nested_cages_extension"
"""Any name will do: an extension is imported as bl_ext.<repository>.<id>, so nothing may depend on it."""


def circle(count: int = 48, radius: float = 1.0, middle: tuple[float, float] = (0.0, 0.0)) -> Loop:
    """A regular polygon (count, 2)."""
    return ring(count, radius, 0.0, middle)


def star(count: int = 60, depth: float = 0.25, waves: int = 5) -> Loop:
    """A wavy circle (count, 2) that is far from convex."""
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    return np.column_stack([np.cos(angles), np.sin(angles)]) * (1.0 + depth * np.cos(waves * angles))[:, None]


def raised(loop: Loop, z: float = 0.0) -> NDArray[np.float64]:
    """Points (k, 2) as (k, 3), or (k, 3) as they are."""
    return loop if loop.shape[1] == 3 else np.column_stack([loop, np.full(len(loop), z)])


def add(name: str, data: Any, select: bool = True) -> Any:
    """Links a new object into the scene, selects it and makes it active."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    if select:
        obj.select_set(True)
        bpy.context.view_layer.objects.active = obj
    return obj


def gathered(name: str, *objects: Any, home: Any = None) -> Any:
    """A new collection of the scene, or in another one, that these objects move to."""
    made = bpy.data.collections.new(name)
    (home or bpy.context.scene.collection).children.link(made)
    for obj in objects:
        made.objects.link(obj)
        bpy.context.scene.collection.objects.unlink(obj)
    return made


def armature(name: str, **bones: Any) -> Any:
    """An armature with bones from one place (x, y, z) to another."""
    rig = add(name, bpy.data.armatures.new(name))
    bpy.ops.object.mode_set(mode="EDIT")
    for bone, (head, tail) in bones.items():
        made = rig.data.edit_bones.new(bone)
        made.head, made.tail = head, tail
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def silhouette(*objects: Any, **options: Any) -> Any:
    """The outline of these objects, selected too, and of what is selected."""
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.update()
    assert bpy.ops.object.nested_cages_import(outlines="SELECTED", **options) == {"FINISHED"}
    bpy.context.view_layer.update()
    return bpy.context.object


def apart(one: shapely.Geometry, other: shapely.Geometry) -> float:
    """The area that only one of the two has, as a part of the other."""
    return float(one.symmetric_difference(other).area / other.area)


def choose(*objects: Any) -> None:
    """Selects these objects alone, the last of them active."""
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[-1]


def poly_curve(
    name: str, loops: Sequence[Loop], cyclic: bool = True, dimensions: str = "2D", kind: str = "POLY"
) -> Any:
    """A curve object with one spline per loop."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = dimensions
    for loop in loops:
        spline = data.splines.new(kind)
        spline.points.add(len(loop) - 1)
        spline.points.foreach_set("co", np.column_stack([raised(loop), np.ones(len(loop))]).ravel())
        spline.use_cyclic_u = cyclic
    return add(name, data)


def bezier_circle(name: str, radius: float = 1.0, resolution: int = 12) -> Any:
    """A Bezier curve of four points with automatic handles."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "2D"
    data.resolution_u = resolution
    spline = data.splines.new("BEZIER")
    spline.bezier_points.add(3)
    for point, (x, y) in zip(spline.bezier_points, circle(4, radius), strict=True):
        point.co = (x, y, 0.0)
        point.handle_left_type = point.handle_right_type = "AUTO"
    spline.use_cyclic_u = True
    spline.resolution_u = resolution
    return add(name, data)


def text(name: str, body: str) -> Any:
    """A text object in Blender's own font."""
    data = bpy.data.curves.new(name, "FONT")
    data.body = body
    return add(name, data)


def wire(name: str, loops: Sequence[Loop], cyclic: bool = True) -> Any:
    """A mesh object made of edge loops."""
    mesh = bpy.data.meshes.new(name)
    vertices, edges, offset = [], [], 0
    for loop in loops:
        vertices += raised(loop).tolist()
        count = len(loop)
        edges += [(offset + i, offset + (i + 1) % count) for i in range(count if cyclic else count - 1)]
        offset += count
    mesh.from_pydata(vertices, edges, [])
    return add(name, mesh)


def grid_face(name: str, cells: int = 4) -> Any:
    """A mesh object of square faces, `cells` by `cells`, over the unit square."""
    mesh = bpy.data.meshes.new(name)
    side = cells + 1
    vertices = [(x / cells, y / cells, 0.0) for y in range(side) for x in range(side)]
    corners = [y * side + x for y in range(cells) for x in range(cells)]
    mesh.from_pydata(vertices, [], [(c, c + 1, c + side + 1, c + side) for c in corners])
    return add(name, mesh)


def hair(name: str, loops: Sequence[Loop], cyclic: bool = True, kind: str = "POLY") -> Any:
    """A Curves object with one curve per loop."""
    data = bpy.data.hair_curves.new(name)
    data.add_curves([len(loop) for loop in loops])
    points = np.concatenate([raised(loop) for loop in loops]).astype(np.float32)
    data.attributes["position"].data.foreach_set("vector", points.ravel())
    data.attributes.new("cyclic", "BOOLEAN", "CURVE").data.foreach_set("value", [cyclic] * len(loops))
    if hasattr(data, "set_types"):
        data.set_types(type=kind)
    elif kind != "CATMULL_ROM":
        pytest.skip("before Blender 4.4, scripts cannot set the type of curves")
    return add(name, data)


def grease_pencil(name: str, loops: Sequence[Loop], cyclic: bool = True, radius: float = 0.0) -> Any:
    """A Grease Pencil object of version 3 with one stroke per loop; without a radius its points are the outline."""
    data = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new(name)
    if not hasattr(bpy.types, "GreasePencilDrawing"):
        pytest.skip("Blender 4.2 has no Grease Pencil of version 3")
    drawing = data.layers.new("Lines").frames.new(1).drawing
    drawing.add_strokes([len(loop) for loop in loops])
    for stroke, loop in zip(drawing.strokes, loops, strict=True):
        stroke.cyclic = cyclic
        for point, place in zip(stroke.points, raised(loop), strict=True):
            point.position, point.radius = place, radius
    return add(name, data)


def sets() -> Any:
    """The add-on's public class of sets of cages."""
    return import_module(PACKAGE).CageSet


def set_of(home: Any) -> Any:
    """The set of an object, or whose cages are in a collection; a set itself; None if there is none."""
    if isinstance(home, bpy.types.Object):
        return sets().of(home)
    if not isinstance(home, bpy.types.Collection):
        return home
    return next((each for each in sets().everywhere() if set(each.cages) & set(home.objects)), None)


def members(home: Any) -> list[Any]:
    """The fine mesh and the cages of a set, or of that of an object or a collection, from the inside out."""
    found = set_of(home)
    return [*filter(None, (found.fine,)), *found.cages]


def made(name: str = "Drawing", inside: bool = False) -> list[Any]:
    """The fine mesh and the cages around a drawing, or those inside it."""
    (found,) = [each for each in sets().all_of(bpy.data.objects[name]) if each.inside == inside]
    return members(found)


def certificate(cage: Any) -> Any:
    """What is certified of a cage and was found of it since."""
    found = sets().of(cage)
    return found.certificates[found.cages.index(cage)]


def end_of(home: Any) -> int:
    """The first frame with the result: of a cage, or of the last one of a drawing or a collection."""
    found = set_of(home)
    cage = home if home in found.cages else found.cages[-1]
    return int(certificate(cage).frames[3])


def holds(cage: Any) -> bool | None:
    """What Verify Cages found of a cage as it is; None if it was not looked at. The only place that knows its word."""
    verdict = certificate(cage).verdict
    return verdict.startswith("Holds") if verdict else None


def checked(cage: Any) -> list[int]:
    """The frames that Verify Cages names in its verdict: the range that it looked at, or where it found a fault."""
    return [int(number) for number in re.findall(r"\d+", certificate(cage).verdict)]


def generate(levels: str = "20, 10", **settings: Any) -> None:
    assert bpy.ops.object.nested_cages_generate(levels=levels, **settings) == {"FINISHED"}


def bind(**settings: Any) -> None:
    assert bpy.ops.object.nested_cages_bind(**settings) == {"FINISHED"}


def verify(*cages: Any, **settings: Any) -> bool:
    """Whether the selected cages hold, by Verify Cages; of these, if there are any."""
    assert bpy.ops.object.nested_cages_verify(**settings) == {"FINISHED"}
    return all(holds(cage) for cage in cages)


def save(path: Any, *, again: bool = False) -> str:
    """Saves the file, and opens it again."""
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    if again:
        bpy.ops.wm.open_mainfile(filepath=str(path))
    return str(path)


def base(obj: Any) -> NDArray[np.float32]:
    """Vertices (n, 3) of a mesh object without its shape keys and modifiers."""
    points = np.empty((len(obj.data.vertices), 3), np.float32)
    keys = obj.data.shape_keys
    (keys.reference_key.points if keys else obj.data.vertices).foreach_get("co", points.ravel())
    return points


def put(obj: Any, points: NDArray[Any]) -> None:
    """Moves the vertices of a mesh object."""
    obj.data.vertices.foreach_set("co", points.astype(np.float32).ravel())
    obj.data.update()
    bpy.context.view_layer.update()


def image_empty(image: Any, name: str = "Empty") -> Any:
    """An empty that shows an image."""
    obj = add(name, None)
    obj.empty_display_type, obj.data = "IMAGE", image
    return obj


def weigh(obj: Any, name: str, weights: Sequence[float]) -> None:
    """Adds a vertex group with a weight of each vertex."""
    group = obj.vertex_groups.new(name=name)
    for k, weight in enumerate(weights):
        group.add([k], float(weight), "REPLACE")


def snapshot() -> dict[str, Any]:
    """Everything that a refused operator must leave as it was."""
    data = {
        name: sorted((item.name_full, item.users) for item in collection)
        for name in dir(bpy.data)
        # Since Blender 5.2 there is one collection of everything that is in the others.
        if name != "all_ids" and isinstance(collection := getattr(bpy.data, name), bpy.types.bpy_prop_collection)
    }
    scene, active = bpy.context.scene, bpy.context.view_layer.objects.active
    return data | {
        "selected": sorted(obj.name for obj in bpy.context.selected_objects),
        "active": active.name if active else None,
        "frames": (scene.frame_current, scene.frame_subframe, scene.frame_start, scene.frame_end),
        "markers": [(marker.name, marker.frame) for marker in scene.timeline_markers],
        "children": sorted(collection.name for collection in scene.collection.children_recursive),
        "matrices": {obj.name: tuple(map(tuple, obj.matrix_world)) for obj in bpy.data.objects},
        "hidden": sorted(obj.name for obj in bpy.data.objects if obj.hide_viewport or obj.hide_get()),
        "properties": sorted((obj.name, _properties(obj)) for obj in bpy.data.objects),
    }


def _properties(obj: Any) -> tuple[str, ...]:
    """The names of custom properties. Before 5.0, to read a group of an add-on leaves an empty one on the object."""
    return tuple(name for name, value in obj.items() if not hasattr(value, "to_dict") or _holds(value.to_dict()))


def _holds(group: dict[str, Any]) -> bool:
    """Whether anything has been set in a group or in the groups in it."""
    return any(_holds(value) if isinstance(value, dict) else True for value in group.values())


def at_frame(frame: float) -> Any:
    """The dependency graph on a frame, which may be a fraction."""
    bpy.context.scene.frame_set(int(frame // 1), subframe=frame % 1)
    return bpy.context.evaluated_depsgraph_get()


def evaluated(obj: Any, depsgraph: Any = None) -> NDArray[np.float32]:
    """Vertices (n, 3) of the evaluated object in its own space."""
    depsgraph = depsgraph or bpy.context.evaluated_depsgraph_get()
    shape = obj.evaluated_get(depsgraph)
    mesh = shape.to_mesh()
    vertices = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", vertices.ravel())
    shape.to_mesh_clear()
    return vertices


def world(obj: Any, depsgraph: Any = None) -> NDArray[np.float64]:
    """Vertices (n, 3) of the evaluated object where they are displayed."""
    bpy.context.view_layer.update()
    return in_world(obj, evaluated(obj, depsgraph))


def in_world(obj: Any, points: NDArray[np.float32]) -> NDArray[np.float64]:
    """Points (n, 3) of an object's own space in the world."""
    matrix = np.array(obj.matrix_world, dtype=float)
    return points.astype(float) @ matrix[:3, :3].T + matrix[:3, 3]


def faces_of(obj: Any, points: NDArray[Any], grid: float | None = 1e-9) -> Any:
    """The faces of a mesh object whose vertices are at points (n, 2), united, on a grid or as they are."""
    faces = [shapely.Polygon(points[list(face.vertices)].astype(float)) for face in obj.data.polygons]
    return shapely.union_all(faces, grid_size=grid)


def edges_of(obj: Any) -> NDArray[np.int32]:
    """Edges (m, 2) of a mesh object."""
    edges = np.empty((len(obj.data.edges), 2), np.int32)
    obj.data.edges.foreach_get("vertices", edges.ravel())
    return edges


def curves_of(owner: Any) -> list[Any]:
    """The f-curves of an object or of shape keys."""
    animation = owner.animation_data
    if animation is None or animation.action is None:
        return []
    if not hasattr(animation, "action_slot"):
        return list(animation.action.fcurves)
    bags = [strip.channelbag(animation.action_slot) for layer in animation.action.layers for strip in layer.strips]
    return [curve for bag in bags if bag is not None for curve in bag.fcurves]


def keyed_steps(obj: Any) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    """Frames (k,) on which an object has a step of its own, and the steps (k, n, 3) themselves."""
    keys = obj.data.shape_keys
    found = {}
    for curve in curves_of(keys):
        points = np.empty((len(obj.data.vertices), 3), np.float32)
        keys.path_resolve(curve.data_path.removesuffix(".value")).points.foreach_get("co", points.ravel())
        for point in curve.keyframe_points:
            assert point.interpolation == "LINEAR"
            if point.co[1] == 1.0:
                found[float(point.co[0])] = points
    frames = sorted(found)
    return np.array(frames), np.array([found[frame] for frame in frames])


def lines(obj: Any, depsgraph: Any = None) -> Any:
    """The evaluated edges of a mesh object as a shapely MultiLineString in the object's x and y."""
    points = evaluated(obj, depsgraph)[:, :2].astype(float)
    return shapely.multilinestrings(shapely.linestrings(points[edges_of(obj)]))


def solid(obj: Any, depsgraph: Any = None) -> Any:
    """The area that the evaluated edges of a mesh object bound, by shapely: loops in loops are holes."""
    faces = shapely.polygonize(shapely.get_parts(lines(obj, depsgraph)))
    area = shapely.Polygon()
    for part in sorted((shapely.Polygon(face.exterior) for face in faces.geoms), key=lambda p: -p.area):
        area = area.symmetric_difference(part)
    return area


def outlive(subject: Any, count: int, seed: int) -> None:
    """So many random edits of a subject, which is checked after each of them."""
    done = []
    for _ in range(count):
        edit = subject.random.choice(subject.EDITS)
        done.append(edit.__name__)
        try:
            edit(subject)
            subject.check()
        except (AssertionError, KeyError, RuntimeError, StopIteration, ValueError) as error:
            raise AssertionError(f"seed {seed}, after {', '.join(done)}") from error


def try_operator(operator: Any, **values: Any) -> Any:
    """Call an operator, which may refuse with an error of its own, but not fail in Python."""
    try:
        return operator(**values)
    except RuntimeError as error:
        assert "Traceback" not in str(error) and "Python" not in str(error), error
        return {"CANCELLED"}
