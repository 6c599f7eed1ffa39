"""Builds the node groups and materials that the add-on appends: addon/scene/nodes.blend.

Run it in the oldest Blender that is supported, so that all can read the file: `make nodes`.
"""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import bpy

FILE = Path(__file__).resolve().parents[1] / "addon" / "scene" / "nodes.blend"
# Names of attributes in the files of users, as in addon/keys.py, and of the property with the digest of this script.
MOTION, WEIGHT, DIGEST = "nested_cages_motion", "nested_cages_weight_", "nested_cages_digest"
# Corners of the cross-section of thick lines.
TUBE_CORNERS = 8
# Largest number of halvings of edges, as in addon/binding/field.py.
MAX_HALVINGS = 5

Tree = Any
Node = Any
Socket = Any


def digest() -> str:
    """Tells whether the file was built by this script as it is now."""
    return hashlib.blake2b(Path(__file__).read_bytes(), digest_size=8).hexdigest()


def _node(tree: Tree, kind: str, inputs: dict[str, Any] | None = None, **settings: object) -> Node:
    """A new node with settings, and with sockets or values for its inputs, by name."""
    node = tree.nodes.new(kind)
    for name, value in settings.items():
        setattr(node, name, value)
    for name, value in (inputs or {}).items():
        socket = next(socket for socket in node.inputs if socket.enabled and socket.name == name)
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        else:
            socket.default_value = value
    return node


def _out(node: Node, name: str = "") -> Socket:
    """The output of a node by name, or its first one."""
    return next(socket for socket in node.outputs if socket.enabled and name in ("", socket.name))


def _vector(tree: Tree, operation: str, *values: Socket) -> Socket:
    """The result of a vector operation."""
    node = _node(tree, "ShaderNodeVectorMath", operation=operation)
    for value, socket in zip(values, node.inputs, strict=False):
        tree.links.new(value, socket)
    return _out(node)


def _attribute(tree: Tree, name: Socket | str, kind: str) -> Socket:
    """The output of a node that reads an attribute."""
    return _out(_node(tree, "GeometryNodeInputNamedAttribute", {"Name": name}, data_type=kind), "Attribute")


def _start(tree: Tree, space: str) -> tuple[Node, Node]:
    """Group input, and the node that reads the object of its input 'Object'."""
    start = tree.nodes.new("NodeGroupInput")
    return start, _node(tree, "GeometryNodeObjectInfo", {"Object": start.outputs["Object"]}, transform_space=space)


def _end(tree: Tree, geometry: Socket) -> None:
    tree.links.new(geometry, tree.nodes.new("NodeGroupOutput").inputs[0])


def _place(tree: Tree) -> Socket:
    return _out(tree.nodes.new("GeometryNodeInputPosition"))


def _corner(tree: Tree, source: Node, index: Socket) -> Socket:
    """The position of an object's vertex of that number."""
    inputs = {"Geometry": source.outputs["Geometry"], "Value": _place(tree), "Index": index}
    return _out(_node(tree, "GeometryNodeSampleIndex", inputs, data_type="FLOAT_VECTOR", domain="POINT"))


def _moved(tree: Tree, start: Node, place: Socket) -> None:
    """Stores how far each vertex is from where the object puts it, and leaves it where it is."""
    way = _vector(tree, "SUBTRACT", place, _place(tree))
    inputs = {"Geometry": start.outputs["Geometry"], "Name": MOTION, "Value": way}
    _end(tree, _out(_node(tree, "GeometryNodeStoreNamedAttribute", inputs, data_type="FLOAT_VECTOR", domain="POINT")))


def weighted(tree: Tree) -> None:
    """Each vertex goes where the sum of the object's vertices, multiplied by its weights, is."""
    start, source = _start(tree, "RELATIVE")
    count = _node(tree, "GeometryNodeAttributeDomainSize", {"Geometry": source.outputs["Geometry"]})
    first, last = tree.nodes.new("GeometryNodeRepeatInput"), tree.nodes.new("GeometryNodeRepeatOutput")
    first.pair_with_output(last)
    last.repeat_items.clear()
    last.repeat_items.new("INT", "Number")
    last.repeat_items.new("VECTOR", "Place")
    tree.links.new(count.outputs["Point Count"], first.inputs["Iterations"])
    number = first.outputs["Number"]
    digits = _out(_node(tree, "FunctionNodeValueToString", {"Value": number}))
    text = {"String": f"{WEIGHT}#", "Find": "#", "Replace": digits}
    weight = _attribute(tree, _out(_node(tree, "FunctionNodeReplaceString", text)), "FLOAT")
    corner = _corner(tree, source, number)
    tree.links.new(_vector(tree, "MULTIPLY_ADD", corner, weight, first.outputs["Place"]), last.inputs["Place"])
    onward = _node(tree, "ShaderNodeMath", operation="ADD")
    onward.inputs[1].default_value = 1.0
    tree.links.new(number, onward.inputs[0])
    tree.links.new(onward.outputs[0], last.inputs["Number"])
    _moved(tree, start, last.outputs["Place"])


def same(tree: Tree) -> None:
    """Each vertex goes where the object's vertex of the same number is."""
    start, source = _start(tree, "RELATIVE")
    _moved(tree, start, _corner(tree, source, _out(tree.nodes.new("GeometryNodeInputIndex"))))


def follow(tree: Tree) -> None:
    """Each point moves as the nearest place of the object, a field, does; whatever made the points comes first.

    'In Place': the field is in the space of the geometry, wherever both are, so that copies elsewhere follow too.
    'Subdivide': how often the edges of a mesh are halved before. Instances become real, and curves lines.
    """
    start, field = _start(tree, "ORIGINAL")
    around = _node(tree, "GeometryNodeObjectInfo", {"Object": start.outputs["Object"]}, transform_space="RELATIVE")
    there = {"Switch": start.outputs["In Place"], "False": around.outputs["Transform"]}
    there = _out(_node(tree, "GeometryNodeSwitch", there, input_type="MATRIX"))
    back = _out(_node(tree, "FunctionNodeInvertMatrix", {"Matrix": there}))
    shown = _node(
        tree, "GeometryNodeCollectionInfo", {"Collection": start.outputs["Collection"]}, transform_space="ORIGINAL"
    )
    both = tree.nodes.new("GeometryNodeJoinGeometry")
    for geometry in (shown.outputs[0], start.outputs["Geometry"]):
        tree.links.new(geometry, both.inputs[0])
    real = _out(_node(tree, "GeometryNodeRealizeInstances", {"Geometry": _out(both)}))
    lines = _node(tree, "GeometryNodeResampleCurve", {"Curve": real}, mode="EVALUATED")
    geometry = _halved(tree, _out(lines), start.outputs["Subdivide"])
    inputs = {
        "Mesh": field.outputs["Geometry"],
        "Value": _attribute(tree, MOTION, "FLOAT_VECTOR"),
        "Sample Position": _out(_node(tree, "FunctionNodeTransformPoint", {"Vector": _place(tree), "Transform": back})),
    }
    way = _out(_node(tree, "GeometryNodeSampleNearestSurface", inputs, data_type="FLOAT_VECTOR"), "Value")
    turned = _out(_node(tree, "FunctionNodeTransformDirection", {"Direction": way, "Transform": there}))
    _end(tree, _out(_node(tree, "GeometryNodeSetPosition", {"Geometry": geometry, "Offset": turned})))


def _halved(tree: Tree, mesh: Socket, times: Socket) -> Socket:
    """A mesh with its edges halved so often, step by step: Blender 5.2 repairs links to a level, and logs it."""
    for number in range(MAX_HALVINGS):
        finer = _out(_node(tree, "GeometryNodeSubdivideMesh", {"Mesh": mesh, "Level": 1}))
        more = _node(tree, "FunctionNodeCompare", {"A": times, "B": number}, data_type="INT", operation="GREATER_THAN")
        step = {"Switch": _out(more), "False": mesh, "True": finer}
        mesh = _out(_node(tree, "GeometryNodeSwitch", step, input_type="GEOMETRY"))
    return mesh


def edges(tree: Tree) -> None:
    """The outline of the object as edges: its own ones with at most one face."""
    _, source = _start(tree, "RELATIVE")
    faces = _out(tree.nodes.new("GeometryNodeInputMeshEdgeNeighbors"))
    few = _out(_node(tree, "FunctionNodeCompare", {"A": faces, "B": 2}, data_type="INT", operation="LESS_THAN"))
    lines = {"Mesh": source.outputs["Geometry"], "Selection": few}
    lines = {"Curve": _out(_node(tree, "GeometryNodeMeshToCurve", lines))}
    _end(tree, _out(_node(tree, "GeometryNodeCurveToMesh", lines)))


def fill(tree: Tree) -> None:
    """Fills the outline of the object."""
    start, source = _start(tree, "RELATIVE")
    lines = _out(_node(tree, "GeometryNodeMeshToCurve", {"Mesh": source.outputs["Geometry"]}))
    inputs = {"Geometry": _out(_node(tree, "GeometryNodeFillCurve", {"Curve": lines}))}
    _end(tree, _out(_node(tree, "GeometryNodeSetMaterial", inputs | {"Material": start.outputs["Material"]})))


def thickness(tree: Tree) -> None:
    """Turns edges into tubes."""
    start = tree.nodes.new("NodeGroupInput")
    lines = _out(_node(tree, "GeometryNodeMeshToCurve", {"Mesh": start.outputs["Geometry"]}))
    circle = {"Resolution": TUBE_CORNERS, "Radius": start.outputs["Radius"]}
    inputs = {"Curve": lines, "Profile Curve": _out(_node(tree, "GeometryNodeCurvePrimitiveCircle", circle))}
    inputs = {"Geometry": _out(_node(tree, "GeometryNodeCurveToMesh", inputs))}
    _end(tree, _out(_node(tree, "GeometryNodeSetMaterial", inputs | {"Material": start.outputs["Material"]})))


def flat(tree: Tree) -> None:
    """Emits a colour; the factor of the mixture is its opacity."""
    _mixed(tree, tree.nodes.new("ShaderNodeEmission"))


def cutout(tree: Tree) -> None:
    """Shows a picture with its transparency."""
    picture = _node(tree, "ShaderNodeTexImage", extension="CLIP")
    glow = _node(tree, "ShaderNodeEmission", {"Color": picture.outputs["Color"]})
    tree.links.new(picture.outputs["Alpha"], _mixed(tree, glow).inputs[0])
    tree.nodes.active = picture  # the texture of solid views


def _mixed(tree: Tree, glow: Node) -> Node:
    clear, mix = tree.nodes.new("ShaderNodeBsdfTransparent"), tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(glow.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return mix


# By name: the inputs after the geometry with their types, and what builds the nodes.
OBJECT = {"Object": "Object"}
GROUPS: dict[str, tuple[dict[str, str], Callable[[Tree], None]]] = {
    "Nested Cages Field": (OBJECT, weighted),
    "Nested Cages Plain Field": (OBJECT, same),
    "Nested Cages Follow Field": (
        OBJECT | {"In Place": "Bool", "Subdivide": "Int", "Collection": "Collection"},
        follow,
    ),
    "Nested Cages Follow as Edges": (OBJECT, edges),
    "Nested Cages Fill": (OBJECT | {"Material": "Material"}, fill),
    "Nested Cages Thickness": ({"Radius": "Float", "Material": "Material"}, thickness),
}
MATERIALS = {"Nested Cages Flat": flat, "Nested Cages Cutout": cutout}


def build(path: Path) -> None:
    """Writes the file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    blocks: set[Any] = set()
    for name, (inputs, make) in GROUPS.items():
        tree: Any = bpy.data.node_groups.new(name, "GeometryNodeTree")
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
        for key, kind in ({"Geometry": "Geometry"} | inputs).items():
            tree.interface.new_socket(key, in_out="INPUT", socket_type=f"NodeSocket{kind}")
        make(tree)
        blocks.add(tree)
    for name, shade in MATERIALS.items():
        material: Any = bpy.data.materials.new(name)
        material.use_nodes = True
        material.node_tree.nodes.clear()
        material.surface_render_method = "BLENDED" if shade is cutout else "DITHERED"
        shade(material.node_tree)
        blocks.add(material)
    for block in blocks:
        for place, node in enumerate((block.node_tree if isinstance(block, bpy.types.Material) else block).nodes):
            node.location = (200.0 * place, 0.0)
        block[DIGEST], block.use_fake_user = digest(), True
    with TemporaryDirectory() as folder:  # a file names its own path
        made = Path(folder) / path.name
        bpy.ops.wm.save_as_mainfile(filepath=str(made), compress=True)
        shutil.copy(made, path)


if __name__ == "__main__":
    build(FILE)
    print(f"{FILE.name}: {FILE.stat().st_size} bytes, built in Blender {bpy.app.version_string}", flush=True)
