"""How the output looks: wires in front in a colour per level, and a thickness for renders, where wires do not show."""

from __future__ import annotations

from typing import Any, Literal

import bpy

# The fine mesh nearly white, the cages in colours that are easy to tell apart, also for the colour-blind (after Okabe
# and Ito), bright enough for thin lines on a dark background.
FINE_COLOUR = (0.95, 0.95, 0.95, 1.0)
CAGE_COLOURS = (
    (1.00, 0.45, 0.00, 1.0),
    (0.25, 0.75, 1.00, 1.0),
    (0.00, 0.80, 0.45, 1.0),
    (0.95, 0.50, 0.80, 1.0),
    (1.00, 0.90, 0.15, 1.0),
)

# Kinds of inputs that name a data-block.
NAMING = ("NodeSocketObject", "NodeSocketMaterial")
THICKNESS = "Nested Cages Thickness"
# Corners of the tube's cross-section.
TUBE_CORNERS = 8


def colour(level: int) -> tuple[float, float, float, float]:
    """The colour of a level, of which 0 is the fine mesh."""
    return CAGE_COLOURS[(level - 1) % len(CAGE_COLOURS)] if level else FINE_COLOUR


def apply_display(obj: bpy.types.Object, level: int) -> None:
    """Makes a new output object a wire in front of everything, in the colour of its level."""
    obj.display_type = "WIRE"
    obj.show_in_front = True
    obj.color = colour(level)


def new_node(tree: bpy.types.NodeTree | None, kind: str) -> Any:
    """A new node; its properties depend on its kind."""
    return tree.nodes.new(kind)


def add_socket(tree: bpy.types.NodeTree, way: Literal["INPUT", "OUTPUT"], kind: str, name: str) -> None:
    """A new input or output of a node group."""
    tree.interface.new_socket(name, in_out=way, socket_type=kind)


def nodes_modifier(obj: bpy.types.Object, name: str) -> bpy.types.NodesModifier | None:
    """The Geometry Nodes modifier of that name."""
    modifier = obj.modifiers.get(name)
    return modifier if isinstance(modifier, bpy.types.NodesModifier) else None


def add_nodes_modifier(obj: bpy.types.Object, name: str, tree: bpy.types.NodeTree) -> bpy.types.NodesModifier:
    """A new Geometry Nodes modifier."""
    modifier = obj.modifiers.new(name, "NODES")
    assert isinstance(modifier, bpy.types.NodesModifier)
    modifier.node_group = tree
    return modifier


def set_thickness(obj: bpy.types.Object, level: int, thickness: float) -> None:
    """Gives the object's edges a thickness in its own unit, in renders only; 0 takes it away.

    In the viewport the object stays the wire that was certified.
    """
    modifier = nodes_modifier(obj, THICKNESS)
    if thickness <= 0.0:
        if modifier is not None:
            remove_modifier(obj, modifier)
        return
    if modifier is None:
        modifier = add_nodes_modifier(obj, THICKNESS, _thickness_nodes())
        modifier.show_viewport = False
    set_input(modifier, "Radius", 0.5 * thickness)
    set_input(modifier, "Material", _material(level))


def remove_modifier(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    """Removes a modifier and lets go of what its inputs name, which Blender 5.2 would go on counting as used."""
    if isinstance(modifier, bpy.types.NodesModifier) and hasattr(modifier, "properties") and modifier.node_group:
        for socket in _inputs(modifier):
            if socket.socket_type in NAMING:
                set_input(modifier, socket.name, None)
    obj.modifiers.remove(modifier)


def set_input(modifier: bpy.types.NodesModifier, name: str, value: object) -> None:
    """Sets an input of a Geometry Nodes modifier by the name of its socket."""
    identifier = _identifier(modifier, name)
    # Blender 5.2 made properties of what were custom properties of the modifier.
    if hasattr(modifier, "properties"):
        getattr(modifier.properties.inputs, identifier).value = value
    else:
        modifier[identifier] = value


def get_input(modifier: bpy.types.NodesModifier, name: str) -> Any:
    """An input of a Geometry Nodes modifier by the name of its socket."""
    identifier = _identifier(modifier, name)
    if hasattr(modifier, "properties"):
        return getattr(modifier.properties.inputs, identifier).value
    return modifier[identifier]


def thickness_of(obj: bpy.types.Object) -> float:
    """The thickness that `set_thickness` gave, 0 for none."""
    modifier = nodes_modifier(obj, THICKNESS)
    return 0.0 if modifier is None else 2.0 * float(get_input(modifier, "Radius"))


def _inputs(modifier: bpy.types.NodesModifier) -> list[Any]:
    """The input sockets of a modifier."""
    sockets: Any = modifier.node_group.interface.items_tree
    return [socket for socket in sockets if socket.item_type == "SOCKET" and socket.in_out == "INPUT"]


def _identifier(modifier: bpy.types.NodesModifier, name: str) -> str:
    """What Blender calls the input of that name."""
    return next(str(socket.identifier) for socket in _inputs(modifier) if socket.name == name)


def _thickness_nodes() -> bpy.types.NodeTree:
    """The node group that makes tubes of edges; the file has one."""
    tree = bpy.data.node_groups.get(THICKNESS)
    if tree is not None:
        return tree
    tree = bpy.data.node_groups.new(THICKNESS, "GeometryNodeTree")
    add_socket(tree, "OUTPUT", "NodeSocketGeometry", "Geometry")
    add_socket(tree, "INPUT", "NodeSocketGeometry", "Geometry")
    add_socket(tree, "INPUT", "NodeSocketFloat", "Radius")
    add_socket(tree, "INPUT", "NodeSocketMaterial", "Material")
    start, end, circle, curve, tube, paint = (
        new_node(tree, kind)
        for kind in (
            "NodeGroupInput",
            "NodeGroupOutput",
            "GeometryNodeCurvePrimitiveCircle",
            "GeometryNodeMeshToCurve",
            "GeometryNodeCurveToMesh",
            "GeometryNodeSetMaterial",
        )
    )
    circle.inputs["Resolution"].default_value = TUBE_CORNERS
    for source, target in (
        (start.outputs["Geometry"], curve.inputs["Mesh"]),
        (start.outputs["Radius"], circle.inputs["Radius"]),
        (curve.outputs["Curve"], tube.inputs["Curve"]),
        (circle.outputs["Curve"], tube.inputs["Profile Curve"]),
        (tube.outputs["Mesh"], paint.inputs["Geometry"]),
        (start.outputs["Material"], paint.inputs["Material"]),
        (paint.outputs["Geometry"], end.inputs["Geometry"]),
    ):
        tree.links.new(source, target)
    for place, node in enumerate((start, circle, curve, tube, paint, end)):
        node.location = (200.0 * place, 0.0)
    return tree


def _material(level: int) -> bpy.types.Material:
    """A material that shines in the colour of a level, so that lines look the same in any light; the file has one."""
    name = f"Nested Cages Level {level}"
    material = bpy.data.materials.get(name)
    if material is not None:
        return material
    material = bpy.data.materials.new(name)
    material.diffuse_color = colour(level)
    if material.node_tree is None:  # Blender 5.0 always has one
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    glow, end = new_node(tree, "ShaderNodeEmission"), new_node(tree, "ShaderNodeOutputMaterial")
    glow.inputs["Color"].default_value = colour(level)
    tree.links.new(glow.outputs["Emission"], end.inputs["Surface"])
    end.location = (200.0, 0.0)
    return material
