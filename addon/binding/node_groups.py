"""Node groups stored in the file, so that bound objects follow without the add-on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from .. import keys
from ..scene import display

Tree = bpy.types.NodeTree
# Their properties depend on their types.
Node = Any
Socket = Any


def group(name: str) -> Tree:
    """The node group of that name, one of `BUILDERS`; the file has one."""
    tree = bpy.data.node_groups.get(name)
    if tree is None:
        tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
        display.add_socket(tree, "OUTPUT", "NodeSocketGeometry", "Geometry")
        display.add_socket(tree, "INPUT", "NodeSocketGeometry", "Geometry")
        display.add_socket(tree, "INPUT", "NodeSocketObject", "Object")
        BUILDERS[name](tree)
        for place, node in enumerate(tree.nodes):
            node.location = (200.0 * place, 0.0)
    return tree


def remove_unused() -> None:
    """Removes our node groups that nothing uses."""
    while found := [tree for tree in bpy.data.node_groups if tree.name in BUILDERS and not tree.users]:
        bpy.data.batch_remove(found)


def add(obj: bpy.types.Object, name: str, **inputs: object) -> bpy.types.NodesModifier:
    """Adds the modifier with the node group of that name and its inputs."""
    modifier = display.add_nodes_modifier(obj, name, group(name))
    for key, value in inputs.items():
        display.set_input(modifier, key, value)
    return modifier


def _node(tree: Tree, kind: str, inputs: dict[str, Any] | None = None, **settings: object) -> Node:
    """A new node with settings, and with sockets or values for its inputs, by name."""
    node = display.new_node(tree, kind)
    for name, value in settings.items():
        if hasattr(node, name):  # some are inputs in later versions
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
    start = display.new_node(tree, "NodeGroupInput")
    return start, _node(tree, "GeometryNodeObjectInfo", {"Object": start.outputs["Object"]}, transform_space=space)


def _end(tree: Tree, geometry: Socket) -> None:
    tree.links.new(geometry, display.new_node(tree, "NodeGroupOutput").inputs[0])


def _corner(tree: Tree, source: Node, index: Socket) -> Socket:
    """The position of an object's vertex of that number."""
    place = _out(display.new_node(tree, "GeometryNodeInputPosition"))
    inputs = {"Geometry": source.outputs["Geometry"], "Value": place, "Index": index}
    return _out(_node(tree, "GeometryNodeSampleIndex", inputs, data_type="FLOAT_VECTOR", domain="POINT"))


def _moved(tree: Tree, start: Node, place: Socket) -> None:
    """Stores how far each vertex is from where the object puts it, and leaves it where it is."""
    way = _vector(tree, "SUBTRACT", place, _out(display.new_node(tree, "GeometryNodeInputPosition")))
    inputs = {"Geometry": start.outputs["Geometry"], "Name": keys.MOTION, "Value": way}
    _end(tree, _out(_node(tree, "GeometryNodeStoreNamedAttribute", inputs, data_type="FLOAT_VECTOR", domain="POINT")))


def _weighted(tree: Tree) -> None:
    """Each vertex goes where the sum of the object's vertices, multiplied by its weights, is."""
    start, source = _start(tree, "RELATIVE")
    count = _node(tree, "GeometryNodeAttributeDomainSize", {"Geometry": source.outputs["Geometry"]})
    first, last = display.new_node(tree, "GeometryNodeRepeatInput"), display.new_node(tree, "GeometryNodeRepeatOutput")
    first.pair_with_output(last)
    last.repeat_items.clear()
    last.repeat_items.new("INT", "Number")
    last.repeat_items.new("VECTOR", "Place")
    tree.links.new(count.outputs["Point Count"], first.inputs["Iterations"])
    number = first.outputs["Number"]
    digits = _out(_node(tree, "FunctionNodeValueToString", {"Value": number}))
    text = {"String": f"{keys.WEIGHT}#", "Find": "#", "Replace": digits}
    weight = _attribute(tree, _out(_node(tree, "FunctionNodeReplaceString", text)), "FLOAT")
    corner = _corner(tree, source, number)
    tree.links.new(_vector(tree, "MULTIPLY_ADD", corner, weight, first.outputs["Place"]), last.inputs["Place"])
    onward = _node(tree, "ShaderNodeMath", operation="ADD")
    onward.inputs[1].default_value = 1.0
    tree.links.new(number, onward.inputs[0])
    tree.links.new(onward.outputs[0], last.inputs["Number"])
    _moved(tree, start, last.outputs["Place"])


def _same(tree: Tree) -> None:
    """Each vertex goes where the object's vertex of the same number is."""
    start, source = _start(tree, "RELATIVE")
    _moved(tree, start, _corner(tree, source, _out(display.new_node(tree, "GeometryNodeInputIndex"))))


def _follow(tree: Tree) -> None:
    """Each point moves as the nearest place of the object, a field, does; whatever made the points comes first.

    'In Place': the field is in the space of the geometry, wherever both are, so that copies elsewhere follow too.
    'Subdivide': how often the edges of a mesh are halved before. Instances become real, and curves lines.
    """
    display.add_socket(tree, "INPUT", "NodeSocketBool", "In Place")
    display.add_socket(tree, "INPUT", "NodeSocketInt", "Subdivide")
    display.add_socket(tree, "INPUT", "NodeSocketCollection", "Collection")
    start, field = _start(tree, "ORIGINAL")
    around = _node(tree, "GeometryNodeObjectInfo", {"Object": start.outputs["Object"]}, transform_space="RELATIVE")
    there = {"Switch": start.outputs["In Place"], "False": around.outputs["Transform"]}
    there = _out(_node(tree, "GeometryNodeSwitch", there, input_type="MATRIX"))
    back = _out(_node(tree, "FunctionNodeInvertMatrix", {"Matrix": there}))
    shown = _node(
        tree, "GeometryNodeCollectionInfo", {"Collection": start.outputs["Collection"]}, transform_space="ORIGINAL"
    )
    both = display.new_node(tree, "GeometryNodeJoinGeometry")
    for geometry in (shown.outputs[0], start.outputs["Geometry"]):
        tree.links.new(geometry, both.inputs[0])
    real = _out(_node(tree, "GeometryNodeRealizeInstances", {"Geometry": _out(both)}))
    lines = _node(tree, "GeometryNodeResampleCurve", {"Curve": real}, mode="EVALUATED")
    if "Mode" in lines.inputs:
        lines.inputs["Mode"].default_value = "Evaluated"
    cut = {"Mesh": _out(lines), "Level": start.outputs["Subdivide"]}
    geometry = _out(_node(tree, "GeometryNodeSubdivideMesh", cut))
    place = _out(display.new_node(tree, "GeometryNodeInputPosition"))
    inputs = {
        "Mesh": field.outputs["Geometry"],
        "Value": _attribute(tree, keys.MOTION, "FLOAT_VECTOR"),
        "Sample Position": _out(_node(tree, "FunctionNodeTransformPoint", {"Vector": place, "Transform": back})),
    }
    way = _out(_node(tree, "GeometryNodeSampleNearestSurface", inputs, data_type="FLOAT_VECTOR"), "Value")
    turned = _out(_node(tree, "FunctionNodeTransformDirection", {"Direction": way, "Transform": there}))
    _end(tree, _out(_node(tree, "GeometryNodeSetPosition", {"Geometry": geometry, "Offset": turned})))


def _edges(tree: Tree) -> None:
    """The outline of the object as edges: its own ones with at most one face."""
    _, source = _start(tree, "RELATIVE")
    faces = _out(display.new_node(tree, "GeometryNodeInputMeshEdgeNeighbors"))
    few = _out(_node(tree, "FunctionNodeCompare", {"A": faces, "B": 2}, data_type="INT", operation="LESS_THAN"))
    lines = {"Mesh": source.outputs["Geometry"], "Selection": few}
    lines = {"Curve": _out(_node(tree, "GeometryNodeMeshToCurve", lines))}
    _end(tree, _out(_node(tree, "GeometryNodeCurveToMesh", lines)))


WEIGHTED, SAME, FOLLOW = "Nested Cages Field", "Nested Cages Plain Field", "Nested Cages Follow Field"
EDGES = "Nested Cages Follow as Edges"
BUILDERS: dict[str, Callable[[Tree], None]] = {WEIGHTED: _weighted, SAME: _same, FOLLOW: _follow, EDGES: _edges}
