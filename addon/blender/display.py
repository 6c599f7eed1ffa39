"""Appearance of output: wires in front in a colour per drawing and level, a thickness for renders; and the node groups
and materials that come with the add-on: appended to a file when first used, so that it works without the add-on from
then on. `packaging/node_groups.py` builds them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from colorsys import hsv_to_rgb
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any

import bpy
from bpy.types import Object
from mathutils import Matrix

FILE = Path(__file__).with_name("nodes.blend")
FOLLOW, FOLLOW_PLAIN = "Nested Cages Follow Cage", "Nested Cages Follow Plain Cage"
POSE = "Nested Cages Pose"
EDGES, FILL, THICKNESS = "Nested Cages Follow as Edges", "Nested Cages Fill", "Nested Cages Thickness"
FLAT, CUTOUT = "Nested Cages Flat", "Nested Cages Cutout"


def group(name: str) -> bpy.types.NodeTree:
    """The node group of that name; the file has one."""
    return bpy.data.node_groups.get(name) or _appended("node_groups", name)


def remove_unused() -> None:
    """Removes the node groups of bindings that nothing uses."""
    ours = (FOLLOW, FOLLOW_PLAIN, POSE, EDGES)
    bpy.data.batch_remove([tree for tree in bpy.data.node_groups if tree.name in ours and not tree.users])


def material(kind: str, name: str) -> bpy.types.Material:
    """A new material of a kind, `FLAT` or `CUTOUT`."""
    made: bpy.types.Material = (bpy.data.materials.get(kind) or _appended("materials", kind)).copy()
    made.name = name
    return made


def _appended(kind: str, name: str) -> Any:
    libraries: Any = bpy.data.libraries
    before = set(libraries)
    with libraries.load(str(FILE), link=False) as (_, here):
        getattr(here, kind).append(name)
    (block,) = getattr(here, kind)
    block.use_fake_user = False
    for library in set(libraries) - before:
        libraries.remove(library)  # what was appended is local
    return block


# The fine mesh is nearly white. The cages' hues go once around the colour circle from yellow to red, without the orange
# of selected objects. Steps between drawings (the golden section, which keeps the first ones apart) and between levels,
# as fractions of that range.
FINE_COLOUR = (0.95, 0.95, 0.95, 1.0)
HUES, FIRST_HUE = (0.16, 0.95), 0.5
DRAWING_STEP, LEVEL_STEP = 0.381966, 0.19
# Saturation and value in turn from level to level: bright enough for lines on a dark background.
TONES = ((0.85, 1.0), (0.5, 1.0), (0.95, 0.8))

# Inputs that are the columns of a matrix.
COLUMNS = ("X", "Y", "Z", "Origin")
# Types of inputs that refer to a data-block.
NAMING = ("NodeSocketObject", "NodeSocketMaterial")
# Prefix of the names of our modifiers and node groups.
OURS = "Nested Cages "
AUTOMATIC_THICKNESS = "Nested Cages Automatic Thickness"
THICKNESSES = (THICKNESS, AUTOMATIC_THICKNESS)
# Automatic thickness as a fraction of the drawing's size: about five pixels if the drawing fills a picture.
AUTOMATIC_PART = 0.005


def colour(level: int, drawing: int = 0) -> tuple[float, float, float, float]:
    """The colour of a level (0: the fine mesh) of a drawing, given by its number."""
    if not level:
        return FINE_COLOUR
    way = (FIRST_HUE + DRAWING_STEP * drawing + LEVEL_STEP * (level - 1)) % 1.0
    saturation, value = TONES[(level - 1) % len(TONES)]
    return (*hsv_to_rgb(HUES[0] + (HUES[1] - HUES[0]) * way, saturation, value), 1.0)


def apply_display(obj: Object, level: int, drawing: int = 0) -> None:
    """Displays a new output object as a wire in front of everything, in its level's colour; of faces, the outline."""
    obj.display_type = "WIRE"
    obj.show_in_front = True
    obj.show_all_edges = False
    obj.color = colour(level, drawing)


def nodes_modifier(obj: Object, name: str) -> bpy.types.NodesModifier | None:
    """The Geometry Nodes modifier of that name."""
    modifier = obj.modifiers.get(name)
    return modifier if isinstance(modifier, bpy.types.NodesModifier) else None


def add_nodes_modifier(
    obj: Object, name: str, tree: bpy.types.NodeTree, inputs: Mapping[str, object] = MappingProxyType({})
) -> bpy.types.NodesModifier:
    """A new Geometry Nodes modifier with values for its inputs, by name."""
    modifier = obj.modifiers.new(name, "NODES")
    assert isinstance(modifier, bpy.types.NodesModifier)
    modifier.node_group = tree
    for key, value in inputs.items():
        set_input(modifier, key, value)
    return modifier


def set_thickness(obj: Object, thickness: float, name: str = THICKNESS) -> None:
    """Gives the object's edges a thickness in its own unit and its colour, in renders only; 0 removes it.

    In the viewport the object stays the certified wire. `name`: `THICKNESS` for one chosen by the user, or
    `AUTOMATIC_THICKNESS`.
    """
    for other in THICKNESSES:
        modifier = nodes_modifier(obj, other)
        if modifier is not None and (other != name or thickness <= 0.0):
            remove_modifier(obj, modifier)
    if thickness <= 0.0:
        return
    modifier = nodes_modifier(obj, name)
    if modifier is None:
        modifier = add_nodes_modifier(obj, name, group(THICKNESS))
        modifier.show_viewport = False
    set_input(modifier, "Radius", 0.5 * thickness)
    shade = obj.color[:]  # one material per colour and file, which emits it: lines look the same in any light
    name = "Nested Cages #" + "".join(f"{round(255.0 * part):02X}" for part in shade[:3])
    set_input(modifier, "Material", bpy.data.materials.get(name) or flat_material(name, shade))


def render_lines(obj: Object, shown: bool) -> None:
    """Switches rendering of lines of automatic thickness: followers of an object need its plain shape."""
    modifier = nodes_modifier(obj, AUTOMATIC_THICKNESS)
    if modifier is not None:
        modifier.show_render = shown


def is_ours(modifier: bpy.types.Modifier) -> bool:
    """Whether a modifier is ours, hence made again with its output; those of handles belong to the artist."""
    return modifier.name.startswith(OURS) and modifier.type == "NODES"


def remove_modifier(obj: Object, modifier: bpy.types.Modifier) -> None:
    """Removes a modifier and clears its inputs first, whose data Blender 5.2 would still count as used."""
    if isinstance(modifier, bpy.types.NodesModifier) and hasattr(modifier, "properties") and modifier.node_group:
        for socket in _inputs(modifier):
            if socket.socket_type in NAMING:
                set_input(modifier, socket.name, None)
    obj.modifiers.remove(modifier)


@contextmanager
def unmodified(objects: Iterable[Object], name: str = "") -> Iterator[None]:
    """Temporarily hides the modifiers of objects in viewports, or those of a name.

    They are found again by name: one that was removed meanwhile is memory that must not be written to.
    """
    shown = [(obj, m.name) for obj in objects for m in obj.modifiers if m.show_viewport and name in {"", m.name}]
    for obj, each in shown:
        obj.modifiers[each].show_viewport = False
    try:
        yield
    finally:
        for obj, each in shown:
            if each in obj.modifiers:
                obj.modifiers[each].show_viewport = True


def set_input(modifier: bpy.types.NodesModifier, name: str, value: object) -> None:
    """Sets an input of a Geometry Nodes modifier by the name of its socket."""
    identifier = _identifier(modifier, name)
    # Custom properties of the modifier before Blender 5.2.
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


def path_of(modifier: bpy.types.NodesModifier, name: str) -> str:
    """The data path of an input from its object, by the name of its socket."""
    identifier, start = _identifier(modifier, name), f'modifiers["{modifier.name}"]'
    return (
        f"{start}.properties.inputs.{identifier}.value"
        if hasattr(modifier, "properties")
        else f'{start}["{identifier}"]'
    )


def set_matrix(modifier: bpy.types.NodesModifier, matrix: Matrix) -> None:
    """Sets the inputs that are the columns of a matrix."""
    for name, column in zip(COLUMNS, matrix.col, strict=True):
        set_input(modifier, name, tuple(column[:3]))


def matrix_in(modifier: bpy.types.NodesModifier) -> Matrix:
    """The matrix whose columns are inputs."""
    columns = [(*get_input(modifier, name), float(name == COLUMNS[-1])) for name in COLUMNS]
    return Matrix(columns).transposed()


def thickness_of(obj: Object, name: str = THICKNESS) -> float:
    """The thickness that `set_thickness` set under a name, 0 for none."""
    modifier = nodes_modifier(obj, name)
    return 0.0 if modifier is None else 2.0 * float(get_input(modifier, "Radius"))


def _inputs(modifier: bpy.types.NodesModifier) -> list[Any]:
    """The input sockets of a modifier."""
    sockets: Any = modifier.node_group.interface.items_tree
    return [socket for socket in sockets if socket.item_type == "SOCKET" and socket.in_out == "INPUT"]


def _identifier(modifier: bpy.types.NodesModifier, name: str) -> str:
    """Blender's identifier of the input of that name."""
    return next(str(socket.identifier) for socket in _inputs(modifier) if socket.name == name)


def flat_material(name: str, shade: Sequence[float]) -> bpy.types.Material:
    """A new material that emits a colour (4,), scene linear, and is as opaque as its last number."""
    made = material(FLAT, name)
    made.diffuse_color = tuple(shade)
    known: Any = made.node_tree.nodes
    known["Emission"].inputs["Color"].default_value = tuple(shade)
    known["Mix Shader"].inputs[0].default_value = shade[3]
    made.surface_render_method = "DITHERED" if shade[3] >= 1.0 else "BLENDED"
    return made
