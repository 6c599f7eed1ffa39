"""Node groups stored in the file, so that bound objects follow without the add-on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from .. import keys
from ..scene import display

# Sums of the vertices of the cage: by weights, and by the slopes of the weights.
SUMS = ("Place", "Along X", "Along Y")
# Shorter edits, as a fraction of the size, are rounding and are not rotated.
SMALLEST_EDIT = 1e-5

Tree = bpy.types.NodeTree
# Their properties depend on their types.
Node = Any
Socket = Any


def group(name: str) -> Tree:
    """The node group of that name, one of `BUILDERS`; the file has one."""
    tree = bpy.data.node_groups.get(name)
    if tree is None:
        tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
        tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
        BUILDERS[name](tree)
        for place, node in enumerate(tree.nodes):
            node.location = (200.0 * place, 0.0)
    return tree


def add(obj: bpy.types.Object, name: str, **inputs: object) -> bpy.types.NodesModifier:
    """Adds the modifier with the node group of that name and its inputs."""
    modifier = display.add_nodes_modifier(obj, name, group(name))
    for key, value in inputs.items():
        display.set_input(modifier, key, value)
    return modifier


def _attribute(tree: Tree, name: str, kind: str) -> Socket:
    """The output of a node that reads an attribute."""
    node = display.new_node(tree, "GeometryNodeInputNamedAttribute")
    node.data_type = kind
    node.inputs["Name"].default_value = name
    return next(socket for socket in node.outputs if socket.enabled and socket.name == "Attribute")


def _remember(tree: Tree) -> None:
    """Stores the offset of each vertex from its position when bound."""
    start, end = display.new_node(tree, "NodeGroupInput"), display.new_node(tree, "NodeGroupOutput")
    place, difference = (
        display.new_node(tree, "GeometryNodeInputPosition"),
        display.new_node(tree, "ShaderNodeVectorMath"),
    )
    store = display.new_node(tree, "GeometryNodeStoreNamedAttribute")
    difference.operation = "SUBTRACT"
    store.data_type, store.domain = "FLOAT_VECTOR", "POINT"
    store.inputs["Name"].default_value = keys.EDIT
    value = next(socket for socket in store.inputs if socket.enabled and socket.name == "Value")
    tree.links.new(place.outputs[0], difference.inputs[0])
    tree.links.new(_attribute(tree, keys.REST, "FLOAT_VECTOR"), difference.inputs[1])
    tree.links.new(start.outputs[0], store.inputs["Geometry"])
    tree.links.new(difference.outputs[0], value)
    tree.links.new(store.outputs[0], end.inputs[0])


def _add_edits(tree: Tree) -> None:
    """Moves each vertex by the offset that `_remember` stored."""
    start, end = display.new_node(tree, "NodeGroupInput"), display.new_node(tree, "NodeGroupOutput")
    move = display.new_node(tree, "GeometryNodeSetPosition")
    tree.links.new(start.outputs[0], move.inputs["Geometry"])
    tree.links.new(_attribute(tree, keys.EDIT, "FLOAT_VECTOR"), move.inputs["Offset"])
    tree.links.new(move.outputs[0], end.inputs[0])


def _object(tree: Tree, space: str) -> tuple[Node, Node, Node]:
    """Group input, group output, and the node that reads the object of the input 'Object'."""
    tree.interface.new_socket("Object", in_out="INPUT", socket_type="NodeSocketObject")
    start, end = display.new_node(tree, "NodeGroupInput"), display.new_node(tree, "NodeGroupOutput")
    source = display.new_node(tree, "GeometryNodeObjectInfo")
    source.transform_space = space
    tree.links.new(start.outputs["Object"], source.inputs["Object"])
    return start, end, source


def _walls(tree: Tree) -> None:
    """Puts the corners of a prism over the vertices of the cage, along the cage's own z."""
    start, end, source = _object(tree, "RELATIVE")
    place, pick = display.new_node(tree, "GeometryNodeInputPosition"), display.new_node(tree, "GeometryNodeSampleIndex")
    raised, move = display.new_node(tree, "ShaderNodeCombineXYZ"), display.new_node(tree, "GeometryNodeSetPosition")
    pick.data_type, pick.domain = "FLOAT_VECTOR", "POINT"
    sockets = {socket.name: socket for socket in pick.inputs if socket.enabled}
    tree.links.new(source.outputs["Geometry"], sockets["Geometry"])
    tree.links.new(place.outputs[0], sockets["Value"])
    tree.links.new(_attribute(tree, keys.CORNER, "INT"), sockets["Index"])
    tree.links.new(_attribute(tree, keys.HEIGHT, "FLOAT"), raised.inputs["Z"])
    tree.links.new(start.outputs["Geometry"], move.inputs["Geometry"])
    tree.links.new(next(s for s in pick.outputs if s.enabled), move.inputs["Position"])
    scale, turn = display.new_node(tree, "ShaderNodeVectorMath"), display.new_node(tree, "FunctionNodeRotateVector")
    scale.operation = "MULTIPLY"
    tree.links.new(raised.outputs[0], scale.inputs[0])
    tree.links.new(source.outputs["Scale"], scale.inputs[1])
    tree.links.new(scale.outputs[0], turn.inputs["Vector"])
    tree.links.new(source.outputs["Rotation"], turn.inputs["Rotation"])
    tree.links.new(turn.outputs[0], move.inputs["Offset"])
    tree.links.new(move.outputs[0], end.inputs[0])


def _whole(tree: Tree) -> None:
    """Shows the object unchanged, in the space of the object with the modifier."""
    _, end, source = _object(tree, "RELATIVE")
    tree.links.new(source.outputs["Geometry"], end.inputs[0])


def _coordinates(tree: Tree, space: str = "RELATIVE") -> None:
    """Moves each vertex to the weighted sum of the vertices of the object, plus its edit, rotated along.

    The weights are summed vertex by vertex; the sums of their slopes give the local rotation. Without edits nothing is
    rotated, and two thirds of the sums are not evaluated.
    """
    _, end, source = _object(tree, space)
    start = next(node for node in tree.nodes if node.bl_idname == "NodeGroupInput")
    edit = _attribute(tree, keys.EDIT, "FLOAT_VECTOR")
    (place,) = _sums(tree, source, SUMS[:1])
    plain = _placed(tree, start, _vector(tree, "ADD", place, edit))
    # The rotation nearest to the slopes: x + y × n for the normal n, and its perpendicular.
    where, x, y = _sums(tree, source, SUMS)
    normal = _vector(tree, "NORMALIZE", _vector(tree, "CROSS_PRODUCT", x, y))
    right = _vector(tree, "NORMALIZE", _vector(tree, "ADD", x, _vector(tree, "CROSS_PRODUCT", y, normal)))
    up, parts = _vector(tree, "CROSS_PRODUCT", normal, right), display.new_node(tree, "ShaderNodeSeparateXYZ")
    tree.links.new(edit, parts.inputs[0])
    for axis, part in zip((right, up, normal), parts.outputs, strict=True):
        where = _vector(tree, "MULTIPLY_ADD", axis, part, where)
    choice = display.new_node(tree, "GeometryNodeSwitch")
    choice.input_type = "GEOMETRY"
    sockets = {socket.name: socket for socket in choice.inputs if socket.enabled}
    tree.links.new(_is_edited(tree, start, edit), sockets["Switch"])
    tree.links.new(plain, sockets["False"])
    tree.links.new(_placed(tree, start, where), sockets["True"])
    tree.links.new(choice.outputs[0], end.inputs[0])


def _placed(tree: Tree, start: Node, where: Socket) -> Socket:
    """The geometry of the group's input with its vertices at a position."""
    move = display.new_node(tree, "GeometryNodeSetPosition")
    tree.links.new(start.outputs["Geometry"], move.inputs["Geometry"])
    tree.links.new(where, move.inputs["Position"])
    return move.outputs[0]


def _is_edited(tree: Tree, start: Node, edit: Socket) -> Socket:
    """Whether the longest edit exceeds `SMALLEST_EDIT` of the size, hence is not rounding."""
    longest = _statistic(tree, start, "FLOAT", _vector(tree, "LENGTH", edit), "Max")
    place = display.new_node(tree, "GeometryNodeInputPosition").outputs[0]
    extent = _vector(tree, "LENGTH", _statistic(tree, start, "FLOAT_VECTOR", place, "Range"))
    least, compare = display.new_node(tree, "ShaderNodeMath"), display.new_node(tree, "FunctionNodeCompare")
    least.operation = "MULTIPLY"
    least.inputs[1].default_value = SMALLEST_EDIT
    compare.data_type, compare.operation = "FLOAT", "GREATER_THAN"
    first, second = (socket for socket in compare.inputs if socket.enabled)
    tree.links.new(extent, least.inputs[0])
    tree.links.new(longest, first)
    tree.links.new(least.outputs[0], second)
    return compare.outputs[0]


def _statistic(tree: Tree, start: Node, kind: str, values: Socket, name: str) -> Socket:
    """A statistic of values of all vertices of the group's input."""
    node = display.new_node(tree, "GeometryNodeAttributeStatistic")
    node.data_type, node.domain = kind, "POINT"
    sockets = {socket.name: socket for socket in node.inputs if socket.enabled}
    tree.links.new(start.outputs["Geometry"], sockets["Geometry"])
    tree.links.new(values, sockets["Attribute"])
    return next(socket for socket in node.outputs if socket.enabled and socket.name == name)


def _sums(tree: Tree, source: Node, names: tuple[str, ...]) -> tuple[Socket, ...]:
    """Sums of the positions of an object's vertices, multiplied by the weights, and by their slopes if named."""
    count = display.new_node(tree, "GeometryNodeAttributeDomainSize")
    first, last = display.new_node(tree, "GeometryNodeRepeatInput"), display.new_node(tree, "GeometryNodeRepeatOutput")
    first.pair_with_output(last)
    last.repeat_items.clear()
    last.repeat_items.new("INT", "Number")
    for name in names:
        last.repeat_items.new("VECTOR", name)
    tree.links.new(source.outputs["Geometry"], count.inputs["Geometry"])
    tree.links.new(count.outputs["Point Count"], first.inputs["Iterations"])
    # The vertex of this number, and its weight with the slopes.
    place, pick = display.new_node(tree, "GeometryNodeInputPosition"), display.new_node(tree, "GeometryNodeSampleIndex")
    pick.data_type, pick.domain = "FLOAT_VECTOR", "POINT"
    sockets = {socket.name: socket for socket in pick.inputs if socket.enabled}
    tree.links.new(source.outputs["Geometry"], sockets["Geometry"])
    tree.links.new(place.outputs[0], sockets["Value"])
    tree.links.new(first.outputs["Number"], sockets["Index"])
    digits, name_of = (
        display.new_node(tree, "FunctionNodeValueToString"),
        display.new_node(tree, "FunctionNodeReplaceString"),
    )
    name_of.inputs["String"].default_value, name_of.inputs["Find"].default_value = f"{keys.WEIGHT}#", "#"
    tree.links.new(first.outputs["Number"], digits.inputs["Value"])
    tree.links.new(digits.outputs[0], name_of.inputs["Replace"])
    weight, parts = _attribute(tree, "", "FLOAT_VECTOR"), display.new_node(tree, "ShaderNodeSeparateXYZ")
    tree.links.new(name_of.outputs[0], weight.node.inputs["Name"])
    tree.links.new(weight, parts.inputs[0])
    # Added to the sums.
    corner = next(socket for socket in pick.outputs if socket.enabled)
    for name, part in zip(names, parts.outputs, strict=False):
        tree.links.new(_vector(tree, "MULTIPLY_ADD", corner, part, first.outputs[name]), last.inputs[name])
    onward = display.new_node(tree, "ShaderNodeMath")
    onward.operation = "ADD"
    onward.inputs[1].default_value = 1.0
    tree.links.new(first.outputs["Number"], onward.inputs[0])
    tree.links.new(onward.outputs[0], last.inputs["Number"])
    return tuple(last.outputs[name] for name in names)


def _vector(tree: Tree, operation: str, *values: Socket) -> Socket:
    """The result of a vector operation."""
    node = display.new_node(tree, "ShaderNodeVectorMath")
    node.operation = operation
    for value, socket in zip(values, node.inputs, strict=False):
        tree.links.new(value, socket)
    return next(socket for socket in node.outputs if socket.enabled)


def _strokes(tree: Tree) -> None:
    """Moves each point of a stroke to the object's vertex that it follows."""
    start, end, source = _object(tree, "ORIGINAL")
    place, pick = display.new_node(tree, "GeometryNodeInputPosition"), display.new_node(tree, "GeometryNodeSampleIndex")
    before, move = display.new_node(tree, "ShaderNodeMath"), display.new_node(tree, "GeometryNodeSetPosition")
    pick.data_type, pick.domain = "FLOAT_VECTOR", "POINT"
    before.operation = "SUBTRACT"
    before.inputs[1].default_value = 1.0
    followed = _attribute(tree, keys.FOLLOWED, "INT")
    sockets = {socket.name: socket for socket in pick.inputs if socket.enabled}
    tree.links.new(source.outputs["Geometry"], sockets["Geometry"])
    tree.links.new(place.outputs[0], sockets["Value"])
    tree.links.new(followed, before.inputs[0])
    tree.links.new(before.outputs[0], sockets["Index"])
    tree.links.new(start.outputs["Geometry"], move.inputs["Geometry"])
    tree.links.new(followed, move.inputs["Selection"])
    tree.links.new(next(s for s in pick.outputs if s.enabled), move.inputs["Position"])
    tree.links.new(_attribute(tree, keys.OFFSET, "FLOAT_VECTOR"), move.inputs["Offset"])
    tree.links.new(move.outputs[0], end.inputs[0])


def _outline(tree: Tree, space: str) -> tuple[Node, Socket]:
    """Group output, and the outline of the object as curves: its edges with at most one face."""
    _, end, source = _object(tree, space)
    neighbours, inner = (
        display.new_node(tree, "GeometryNodeInputMeshEdgeNeighbors"),
        display.new_node(tree, "FunctionNodeCompare"),
    )
    lines = display.new_node(tree, "GeometryNodeMeshToCurve")
    inner.data_type, inner.operation = "INT", "LESS_THAN"
    first, second = (socket for socket in inner.inputs if socket.enabled)
    second.default_value = 2
    tree.links.new(neighbours.outputs[0], first)
    tree.links.new(source.outputs["Geometry"], lines.inputs["Mesh"])
    tree.links.new(inner.outputs[0], lines.inputs["Selection"])
    return end, lines.outputs[0]


def _curves(tree: Tree) -> None:
    end, lines = _outline(tree, "ORIGINAL")
    tree.links.new(lines, end.inputs[0])


def _edges(tree: Tree) -> None:
    end, lines = _outline(tree, "RELATIVE")
    mesh = display.new_node(tree, "GeometryNodeCurveToMesh")
    tree.links.new(lines, mesh.inputs["Curve"])
    tree.links.new(mesh.outputs[0], end.inputs[0])


def _area(tree: Tree) -> None:
    end, lines = _outline(tree, "ORIGINAL")
    tree.interface.new_socket("Material", in_out="INPUT", socket_type="NodeSocketMaterial")
    fill, paint = display.new_node(tree, "GeometryNodeFillCurve"), display.new_node(tree, "GeometryNodeSetMaterial")
    start = next(node for node in tree.nodes if node.bl_idname == "NodeGroupInput")
    tree.links.new(lines, fill.inputs[0])
    tree.links.new(fill.outputs[0], paint.inputs["Geometry"])
    tree.links.new(start.outputs["Material"], paint.inputs["Material"])
    tree.links.new(paint.outputs[0], end.inputs[0])


REMEMBER, ADD_EDITS, WALLS = "Nested Cages Remember Edits", "Nested Cages Add Edits", "Nested Cages Prism"
WHOLE, COORDINATES = "Nested Cages Surface", "Nested Cages Coordinates"
# The same in the object's own space, independent of both transforms.
COORDINATES_IN_PLACE = "Nested Cages Coordinates in Place"
CURVES, EDGES, AREA = "Nested Cages Follow as Curves", "Nested Cages Follow as Edges", "Nested Cages Follow Filled"
STROKES = "Nested Cages Follow as Strokes"
BUILDERS: dict[str, Callable[[Tree], None]] = {
    REMEMBER: _remember,
    ADD_EDITS: _add_edits,
    WALLS: _walls,
    WHOLE: _whole,
    COORDINATES: _coordinates,
    COORDINATES_IN_PLACE: lambda tree: _coordinates(tree, "ORIGINAL"),
    CURVES: _curves,
    EDGES: _edges,
    AREA: _area,
    STROKES: _strokes,
}


def following() -> list[Tree]:
    """The node groups of the file by which originals follow."""
    names = (CURVES, AREA, STROKES, COORDINATES_IN_PLACE)
    return [tree for tree in bpy.data.node_groups if tree.name in names]
