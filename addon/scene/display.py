"""How the output looks: wires in front in a colour per level, and a thickness for renders, where wires do not show."""

from __future__ import annotations

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


def set_thickness(obj: bpy.types.Object, level: int, thickness: float) -> None:
    """Gives the object's edges a thickness in its own unit, in renders only; 0 takes it away.

    In the viewport the object stays the wire that was certified.
    """
    modifier = obj.modifiers.get(THICKNESS)
    if thickness <= 0.0:
        if modifier is not None:
            remove_modifier(obj, modifier)
        return
    if modifier is None:
        modifier = obj.modifiers.new(THICKNESS, "NODES")
        modifier.show_viewport = False
    modifier.node_group = _thickness_nodes()
    set_input(modifier, "Radius", 0.5 * thickness)
    set_input(modifier, "Material", _material(level))


def remove_modifier(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    """Removes a modifier and lets go of what its inputs name, which Blender 5.2 would go on counting as used."""
    tree = modifier.node_group if hasattr(modifier, "properties") else None
    for socket in tree.interface.items_tree if tree is not None else ():
        if socket.item_type == "SOCKET" and socket.in_out == "INPUT" and socket.socket_type in NAMING:
            set_input(modifier, socket.name, None)
    obj.modifiers.remove(modifier)


def set_input(modifier: bpy.types.Modifier, name: str, value: object) -> None:
    """Sets an input of a Geometry Nodes modifier by the name of its socket."""
    identifier = _identifier(modifier, name)
    # Blender 5.2 made properties of what were custom properties of the modifier.
    if hasattr(modifier, "properties"):
        getattr(modifier.properties.inputs, identifier).value = value
    else:
        modifier[identifier] = value


def get_input(modifier: bpy.types.Modifier, name: str) -> object:
    """An input of a Geometry Nodes modifier by the name of its socket."""
    identifier = _identifier(modifier, name)
    if hasattr(modifier, "properties"):
        return getattr(modifier.properties.inputs, identifier).value
    return modifier[identifier]


def _identifier(modifier: bpy.types.Modifier, name: str) -> str:
    """What Blender calls the input of that name."""
    sockets = modifier.node_group.interface.items_tree
    return next(s.identifier for s in sockets if s.item_type == "SOCKET" and s.in_out == "INPUT" and s.name == name)


def _thickness_nodes() -> bpy.types.NodeTree:
    """The node group that makes tubes of edges; the file has one."""
    tree = bpy.data.node_groups.get(THICKNESS)
    if tree is not None:
        return tree
    tree = bpy.data.node_groups.new(THICKNESS, "GeometryNodeTree")
    for name, way, kind in (
        ("Geometry", "OUTPUT", "NodeSocketGeometry"),
        ("Geometry", "INPUT", "NodeSocketGeometry"),
        ("Radius", "INPUT", "NodeSocketFloat"),
        ("Material", "INPUT", "NodeSocketMaterial"),
    ):
        tree.interface.new_socket(name, in_out=way, socket_type=kind)
    start, end, circle, curve, tube, paint = (
        tree.nodes.new(kind)
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
    nodes = material.node_tree.nodes
    nodes.clear()
    glow, end = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    glow.inputs["Color"].default_value = colour(level)
    material.node_tree.links.new(glow.outputs["Emission"], end.inputs["Surface"])
    end.location = (200.0, 0.0)
    return material
