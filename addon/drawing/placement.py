"""Where output objects stand: in the space of their drawing, wherever Blender displays that."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.types import Object
from mathutils import Matrix

from .plane import Frame

# Properties of a transform that have a delta too, and all of them; copying these is exact, while a matrix would round.
WITH_DELTA = ("location", "rotation_euler", "rotation_quaternion", "scale")
TRANSFORM = ("rotation_mode", "rotation_axis_angle", *WITH_DELTA, *(f"delta_{name}" for name in WITH_DELTA))
# The properties of parenting, in the order in which they are set.
PARENTING = ("parent", "parent_type", "parent_bone", "parent_vertices", "matrix_parent_inverse")
# The constraint that takes the place of a parent.
CARRIED = "Nested Cages Drawing"


def place(obj: Object, source: Object | None, frame: Frame) -> None:
    """Makes a drawing carry an object, in the drawing's plane; nothing carries it if the drawing is gone.

    In the drawing's own space nothing is rounded: both have the same matrix, wherever the drawing moves. A drawing that
    is scaled to nothing along an axis has no such space for other frames than its own.
    """
    inverse = _inverse(source.matrix_world) if source is not None else None
    if source is None or obj in _line_of(source) or (inverse is None and not frame.own):
        carry(obj, None)
        obj.matrix_world = Matrix(frame.matrix.tolist())
        return
    carry(obj, source, Matrix() if frame.own or inverse is None else inverse @ Matrix(frame.matrix.tolist()))
    for name in ("location", "delta_location", "rotation_euler", "delta_rotation_euler"):
        setattr(obj, name, (0.0, 0.0, 0.0))
    obj.rotation_quaternion = obj.delta_rotation_quaternion = (1.0, 0.0, 0.0, 0.0)
    obj.rotation_axis_angle = (0.0, 0.0, 1.0, 0.0)
    obj.scale = obj.delta_scale = (1.0, 1.0, 1.0)


def carry(obj: Object, carrier: Object | None, inverse: Matrix | None = None) -> None:
    """Makes `carrier` move an object, whose own transform then starts at `inverse` in the carrier's space.

    A parent does that, unless its children stand elsewhere than in its space: those of a curve may follow its path,
    and those of an object that instances on its vertices or faces are repeated there.
    """
    constraint = constraint_of(obj)
    if constraint is not None:
        obj.constraints.remove(constraint)
    elsewhere = carrier is not None and _displaces(carrier)
    obj.parent = None if elsewhere else carrier
    if carrier is None:
        return
    if elsewhere:
        made: Any = obj.constraints.new("CHILD_OF")
        made.name, made.target = CARRIED, carrier
        made.inverse_matrix = inverse or Matrix()
        made.show_expanded = False
    else:
        obj.parent_type = "OBJECT"
        obj.matrix_parent_inverse = inverse or Matrix()


def keep_carried(obj: Object, source: Object) -> None:
    """Lets a drawing carry an object by a constraint once its children stand elsewhere than in its space."""
    if obj.parent == source and obj.parent_type == "OBJECT" and _displaces(source):
        carry(obj, *carrier_of(obj))


def attach(obj: Object, carrier: Object) -> None:
    """Makes an object that nothing carries a child of another one, where it stands."""
    if obj.parent is None and obj not in _line_of(carrier):
        obj.parent, obj.matrix_parent_inverse = carrier, carrier.matrix_world.inverted_safe()


def rebase(obj: Object, source: Object, back: Matrix) -> None:
    """Leaves an object where it is while the space of the drawing that carries it by a constraint changes, as Blender
    leaves children; back: from the space of before to that of now.
    """
    constraint = constraint_of(obj)
    if constraint is not None and constraint.target == source:
        constraint.inverse_matrix = back @ constraint.inverse_matrix


def accompany(obj: Object, other: Object) -> None:
    """Puts an object into the space of another one, and lets the same drawing carry both."""
    carry(obj, *carrier_of(other))
    if constraint_of(obj) is not None:
        obj.matrix_basis = other.matrix_basis
    else:
        obj.matrix_world = other.matrix_world


def _displaces(parent: Object) -> bool:
    """Whether children of an object may be displayed elsewhere than in its space."""
    return (parent.type == "CURVE" and parent.data.use_path) or parent.instance_type in {"VERTS", "FACES"}


def constraint_of(obj: Object) -> bpy.types.ChildOfConstraint | None:
    """The constraint by which a drawing carries an object, if a parent does not."""
    constraint = obj.constraints.get(CARRIED)
    return constraint if isinstance(constraint, bpy.types.ChildOfConstraint) else None


def carrier_of(obj: Object) -> tuple[Object | None, Matrix]:
    """What carries an object, a parent or the target of our constraint, and where its own transform starts there."""
    constraint = constraint_of(obj)
    if constraint is not None:
        return constraint.target, constraint.inverse_matrix.copy()
    return obj.parent, obj.matrix_parent_inverse.copy()


def standing(obj: Object) -> Object | None:
    """The one object whose transform places this one: itself, or one in whose space it is; None if several do."""
    carrier, inverse = carrier_of(obj)
    if len(obj.constraints) > (constraint_of(obj) is not None):
        return None
    if carrier is None:
        return obj
    plain = constraint_of(obj) is not None or (obj.parent_type == "OBJECT" and not _displaces(carrier))
    return standing(carrier) if plain and inverse == Matrix() and obj.matrix_basis == Matrix() else None


def _inverse(matrix: Matrix) -> Matrix | None:
    """The inverse; None if there is none, which Blender 5.2 tells by an exception whatever the fallback."""
    try:
        return matrix.inverted()
    except ValueError:
        return None


def _line_of(obj: Object) -> list[Object]:
    """An object and what carries it."""
    line = [obj]
    while (carrier := carrier_of(line[-1])[0]) is not None and carrier not in line:
        line.append(carrier)
    return line
