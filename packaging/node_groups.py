"""Builds the node groups and materials that the add-on appends: addon/blender/nodes.blend.

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

FILE = Path(__file__).resolve().parents[1] / "addon" / "blender" / "nodes.blend"
# Names of attributes in the files of users, as in addon/keys.py, and of the property with the digest of this script.
WEIGHT, POSE, SPACE = "nested_cages_weight_", "nested_cages_pose", "nested_cages_space"
DIGEST = "nested_cages_digest"
# Corners of the cross-section of thick lines.
TUBE_CORNERS = 8
# Largest number of halvings of edges, as in addon/bind/field.py.
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


def _corner(tree: Tree, cage: Node, index: Socket) -> Socket:
    """The pose of a cage's vertex of that number."""
    inputs = {"Geometry": cage.outputs["Geometry"], "Value": _attribute(tree, POSE, "FLOAT_VECTOR"), "Index": index}
    return _out(_node(tree, "GeometryNodeSampleIndex", inputs, data_type="FLOAT_VECTOR", domain="POINT"))


def _matrix(tree: Tree, start: Node) -> Socket:
    """The matrix whose columns are inputs of a group."""
    matrix = tree.nodes.new("FunctionNodeCombineMatrix")
    for column, name in enumerate(COLUMNS, 1):
        parts = _node(tree, "ShaderNodeSeparateXYZ", {"Vector": start.outputs[name]})
        for row, part in enumerate(parts.outputs, 1):
            tree.links.new(part, matrix.inputs[f"Column {column} Row {row}"])
    return _out(matrix)


def _of_layer(tree: Tree) -> Socket:
    """The matrix from the space of a layer to that of its object, which points of Grease Pencil need."""
    stored = _attribute(tree, SPACE, "FLOAT4X4")
    known = _node(tree, "FunctionNodeInvertMatrix", {"Matrix": stored}).outputs["Invertible"]
    nothing = _out(tree.nodes.new("FunctionNodeCombineMatrix"))
    choice = {"Switch": known, "False": nothing, "True": stored}
    return _out(_node(tree, "GeometryNodeSwitch", choice, input_type="MATRIX"))


def pose(tree: Tree) -> None:
    """Stores where the vertices of a cage are in the space of its drawing, whose matrix drivers give: to refer to the
    drawing, which follows the cage, would be a circle.
    """
    start, own = tree.nodes.new("NodeGroupInput"), tree.nodes.new("GeometryNodeSelfObject")
    here = _node(tree, "GeometryNodeObjectInfo", {"Object": _out(own)}, transform_space="ORIGINAL")
    inverse = _out(_node(tree, "FunctionNodeInvertMatrix", {"Matrix": _matrix(tree, start)}))
    there = tree.nodes.new("FunctionNodeMatrixMultiply")
    tree.links.new(inverse, there.inputs[0])
    tree.links.new(here.outputs["Transform"], there.inputs[1])
    place = _out(_node(tree, "FunctionNodeTransformPoint", {"Vector": _place(tree), "Transform": _out(there)}))
    inputs = {"Geometry": start.outputs["Geometry"], "Name": POSE, "Value": place}
    _end(tree, _out(_node(tree, "GeometryNodeStoreNamedAttribute", inputs, data_type="FLOAT_VECTOR", domain="POINT")))


def _weighted(tree: Tree, cage: Node) -> Socket:
    """For a vertex of a field: the sum of the cage's vertices, multiplied by its weights."""
    count = _node(tree, "GeometryNodeAttributeDomainSize", {"Geometry": cage.outputs["Geometry"]})
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
    corner = _corner(tree, cage, number)
    tree.links.new(_vector(tree, "MULTIPLY_ADD", corner, weight, first.outputs["Place"]), last.inputs["Place"])
    onward = _node(tree, "ShaderNodeMath", operation="ADD")
    onward.inputs[1].default_value = 1.0
    tree.links.new(number, onward.inputs[0])
    tree.links.new(onward.outputs[0], last.inputs["Number"])
    return last.outputs["Place"]


def _same(tree: Tree, cage: Node) -> Socket:
    """For a vertex of a field: the cage's vertex of the same number."""
    return _corner(tree, cage, _out(tree.nodes.new("GeometryNodeInputIndex")))


def _follow(tree: Tree, place_of: Callable[[Tree, Node], Socket]) -> None:
    """Each point moves as the nearest place of a field does that the cage moves by its pose; the field itself stays.

    The columns are of the matrix from the space of what follows to that of the field, or of 'Space', another object
    whose space is the field's. 'Subdivide': how often the edges of a mesh are halved before. Instances become real, and
    curves lines.
    """
    start = tree.nodes.new("NodeGroupInput")
    cage, field = (
        _node(tree, "GeometryNodeObjectInfo", {"Object": start.outputs[name]}, transform_space="ORIGINAL")
        for name in ("Cage", "Field")
    )
    around = _node(tree, "GeometryNodeObjectInfo", {"Object": start.outputs["Space"]}, transform_space="RELATIVE")
    away = tree.nodes.new("FunctionNodeMatrixMultiply")
    tree.links.new(_matrix(tree, start), away.inputs[0])
    into = _out(_node(tree, "FunctionNodeInvertMatrix", {"Matrix": around.outputs["Transform"]}))
    tree.links.new(into, away.inputs[1])
    whole = tree.nodes.new("FunctionNodeMatrixMultiply")
    tree.links.new(_out(away), whole.inputs[0])
    tree.links.new(_of_layer(tree), whole.inputs[1])
    back, there = _out(whole), _out(_node(tree, "FunctionNodeInvertMatrix", {"Matrix": _out(whole)}))
    shown = _node(
        tree, "GeometryNodeCollectionInfo", {"Collection": start.outputs["Collection"]}, transform_space="ORIGINAL"
    )
    both = tree.nodes.new("GeometryNodeJoinGeometry")
    for geometry in (shown.outputs[0], start.outputs["Geometry"]):
        tree.links.new(geometry, both.inputs[0])
    real = _out(_node(tree, "GeometryNodeRealizeInstances", {"Geometry": _out(both)}))
    lines = _node(tree, "GeometryNodeResampleCurve", {"Curve": real}, mode="EVALUATED")
    geometry = _halved(tree, _out(lines), start.outputs["Subdivide"])
    # Once for each vertex: faces are sampled by their corners.
    way = {"Value": _vector(tree, "SUBTRACT", place_of(tree, cage), _place(tree))}
    inputs = {
        "Mesh": field.outputs["Geometry"],
        "Value": _out(_node(tree, "GeometryNodeFieldOnDomain", way, data_type="FLOAT_VECTOR", domain="POINT")),
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


def follow(tree: Tree) -> None:
    """Follows a cage by the weights of a field."""
    _follow(tree, _weighted)


def follow_plain(tree: Tree) -> None:
    """Follows a cage by a field of its own triangles."""
    _follow(tree, _same)


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
COLUMNS = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0), "Origin": (0.0, 0.0, 0.0)}
MATRIX = dict.fromkeys(COLUMNS, "Vector")
FOLLOWER = (
    dict.fromkeys(("Cage", "Field", "Space"), "Object") | MATRIX | {"Subdivide": "Int", "Collection": "Collection"}
)
GROUPS: dict[str, tuple[dict[str, str], Callable[[Tree], None]]] = {
    "Nested Cages Pose": (MATRIX, pose),
    "Nested Cages Follow Cage": (FOLLOWER, follow),
    "Nested Cages Follow Plain Cage": (FOLLOWER, follow_plain),
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
            socket = tree.interface.new_socket(key, in_out="INPUT", socket_type=f"NodeSocket{kind}")
            if key in COLUMNS:
                socket.default_value = COLUMNS[key]
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
