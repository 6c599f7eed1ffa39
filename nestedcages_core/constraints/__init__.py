"""What cages keep in addition to nesting: a box, a clearance of each loop, …; one file each, none imports another.

`base` is the protocol: anyone can write a constraint, see docs/needs/constraints.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..solver.banded import Rows
from .base import Bound, Constraint, Terms, Units

if TYPE_CHECKING:
    from .axis_aligned import AxisAligned
    from .box import Box
    from .least_angle import LeastAngle
    from .least_edge import LeastEdge
    from .loop_clearance import LoopClearance
    from .outside import Outside

__all__ = [
    "AxisAligned",  # edges along the axes, or along other directions
    "Bound",  # a constraint on one topology, for the solvers
    "Box",  # no vertex outside of a rectangle
    "Constraint",  # what cages keep; the base class of all
    "LeastAngle",  # no sharper angle
    "LeastEdge",  # no shorter edge
    "LoopClearance",  # a clearance of each loop, or of outer loops and holes
    "Outside",  # clear of a second shape
    "Rows",  # gradients of inequalities with respect to the cage
    "Terms",  # inequalities: rows, and how far each is from its limit
    "Units",  # between the units of the input and those of the solvers
]


def __getattr__(name: str) -> Any:
    """Constraints are imported when one is asked for: most runs have none."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import axis_aligned, box, least_angle, least_edge, loop_clearance, outside

    files = axis_aligned, box, least_angle, least_edge, loop_clearance, outside
    return next(getattr(file, name) for file in files if hasattr(file, name))
