"""The choices of a run, each an object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, Unpack

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..contact import Contact
from ..decimation import Decimation, LineCycles
from ..energies import Area, Energy
from ..errors import NestedCagesError, NestingError, invalid_setting
from ..flow import FlowMethod, TwoSidedFlow
from ..geometry.arrays import FloatArray
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh
from ..parameters import check_flag, check_not_negative, check_part, check_positive, has_method
from ..tightening import Tightening
from .targets import is_count

if TYPE_CHECKING:
    from ..constraints.base import Constraint
    from ..geometry.symmetry import DetectSymmetry
    from .keywords import SettingsKeywords

DEFAULT_CLEARANCE = 1e-5
"""Clearance when none is given, as a fraction of the bounding-box diagonal of the fine mesh."""

METHODS = {
    "decimation": ("decimate", "LineCycles()"),
    "fallback": ("decimate", "LineCycles()"),
    "flow": ("run", "TwoSidedFlow()"),
    "energy": ("at", "Area()"),
    "tightening": ("run", "Tightening()"),
}
"""The method that each choice must have, and an example."""

LOOPS = ("auto", "keep", "one")
"""What may be said of loops."""

STORED_TYPES = ("float32", "float16")
"""Types that can hold coordinates, other than doubles."""


@dataclass(frozen=True)
class Settings:
    """How nested cages are made. Nothing here needs tuning per shape; lengths are in the input's units.

    Attributes:
        clearance: Smallest distance between cage and fine mesh, a length. Default: 1e-5 of the fine mesh's diagonal,
            less where its gaps are too narrow.
        steps: Whether cages grow out of a mesh on the curve, as in the paper, for an animation. False: they are
            tightened at rest, in half the time; the fine mesh moves only into a coarse mesh that does not enclose it.
            Default: True.
        grid: Cage vertices are multiples of this length, certified as the doubles that their decimals read as: 0.01 for
            two decimals. Default: any number.
        stored: Type that will hold the coordinates, such as np.float32: cage and motion are certified on its numbers,
            which all steps have but for the fine mesh. Default: doubles.
        loops: Which loops cages keep. "auto": those worth their vertices; holes are filled and parts share a loop where
            that is tighter (joining needs shapely). "keep": all; counts below three for each are an error. "one": one
            around all. Cages inside and by a tolerance keep all, one's own meshes what they have. Default: "auto".
        convex: Around each part the convex polygon of least area found, with holes filled. Not with pins,
            joints and limits; `energy` and `fallback` do not matter then. Default: False.
        symmetry: A symmetry that cages have exactly: `Mirror`, `Rotation`, or `DetectSymmetry` for that of the drawing.
            Needs shapely where the drawing does not have it. Default: None.
        weights: (n,) how much each fine vertex matters, at least 0: less excess where weights are high. Default: alike.
        pins: Corners that keep a cage vertex: fine vertices by number, or places (x, y) on the outline. Default: none.
        joints: Places (x, y) of bones' ends: the outline keeps a cage vertex on both sides of each. Default: none.
        min_edge: No cage edge is shorter than this length, where there is room. Default: None.
        min_angle: No angle between cage edges is sharper than this, in degrees below 60, where there is room. Default:
            None.
        constraints: What cages keep in addition, such as `Box` or `LoopClearance`; anyone can write others, see
            `nestedcages_core.constraints`. Default: none.
        seconds: Wall-clock time in seconds for all levels; then the best certified cage is taken, or an error has the
            finished levels as its `partial`. Of moving cages, for the first cage of each level. Default: no limit.
        about: The mesh that distances, excesses, weights, pins and a symmetry are about when levels are made one by
            one: a drawing inside the fine mesh, or around it for inner cages. Default: the fine mesh.
        decimation: Turns a vertex count into a coarse mesh. Default: `LineCycles()`.
        fallback: Decimation to start from where a user's own mesh or another `decimation` fails (docs/numbers.md: the
            hull as fallback). None: nothing but the first start, the paper's way, is tried. Default:
            `LineCycles(on_curve=False)`.
        flow: Brings the fine mesh inside the coarse one. Default: `TwoSidedFlow()`.
        energy: What the cage minimises during tightening. Default: `Area()`.
        contact: Resolves contact during reinflation; of several, each starts over where the one before is blocked.
            Default: sequential QPs, then IPC from a coarse mesh of one's own.
        tightening: Brings the cage to its optimum once the fine mesh is back. Default: `Tightening()`.
    """

    clearance: float | None = None
    decimation: Decimation = field(default_factory=LineCycles)
    fallback: Decimation | None = field(default_factory=lambda: LineCycles(on_curve=False))
    flow: FlowMethod = field(default_factory=TwoSidedFlow)
    energy: Energy = field(default_factory=Area)
    contact: Contact | Sequence[Contact] | None = None
    tightening: Tightening = field(default_factory=Tightening)
    steps: bool = True
    grid: float | None = None
    stored: DTypeLike | None = None
    loops: Literal["auto", "keep", "one"] = "auto"
    convex: bool = False
    symmetry: Symmetry | DetectSymmetry | None = None
    weights: ArrayLike | None = field(default=None, repr=False)
    pins: Sequence[int | Sequence[float]] = ()
    joints: Sequence[Sequence[float]] = ()
    min_edge: float | None = None
    min_angle: float | None = None
    constraints: Sequence[Constraint] = ()
    seconds: float | None = None
    about: Mesh | None = None

    @classmethod
    def of(cls, settings: Settings | None, **options: Unpack[SettingsKeywords]) -> Settings:
        """Settings with fields replaced; the default ones for None. Raises NestedCagesError."""
        if not isinstance(settings, Settings | None):
            raise NestingError(
                f"The settings must be Settings(…), not {type(settings).__name__}.", code="setting.invalid"
            )
        return replace(settings, **options) if settings is not None else cls(**options)

    def __post_init__(self) -> None:
        check_not_negative(self, *(["clearance"] if self.clearance is not None else []))
        check_positive(self, *(name for name in ("grid", "seconds", "min_edge") if getattr(self, name) is not None))
        check_flag(self, "convex", "steps")
        for name, (method, example) in METHODS.items():
            if name != "fallback" or self.fallback is not None:
                check_part(self, name, method, example)
        contacts = self.contact if isinstance(self.contact, Sequence) else [self.contact]
        if self.contact is not None and not (contacts and all(has_method(each, "reinflate") for each in contacts)):
            raise invalid_setting(
                f"The contact must be an object such as IPC(), or several of them in a list, not {self.contact!r}; "
                "leave it out for the default."
            )
        if self.loops not in LOOPS:
            raise invalid_setting(f"loops must be one of {', '.join(map(repr, LOOPS))}, not {self.loops!r}.")
        stored = type_name(self.stored)
        if stored not in (*STORED_TYPES, None):
            raise invalid_setting(f"stored must be float64, {' or '.join(STORED_TYPES)}, not {self.stored!r}.")
        if not isinstance(self.about, Mesh | None):
            raise invalid_setting(f"about must be a Mesh, not {type(self.about).__name__}.")
        if not (self.symmetry is None or has_method(self.symmetry, "of") or has_method(self.symmetry, "image")):
            raise invalid_setting(
                "The symmetry must be an object such as Mirror(point, direction), Rotation(centre, order) or "
                f"DetectSymmetry(), not {self.symmetry!r}."
            )
        if self.min_angle is not None:
            from ..constraints.edges_and_angles import LeastAngle

            LeastAngle(self.min_angle)  # checks it
        as_tuples = {
            "stored": stored,  # a name: settings are told apart by value
            "weights": _weights(self.weights),
            "pins": tuple(
                int(pin) if is_count(pin) else _place(pin, "A pin must be the number of a vertex or a place (x, y)")
                for pin in _listed(self.pins, "pins")
            ),
            "joints": tuple(
                _place(joint, "A joint must be a place (x, y)") for joint in _listed(self.joints, "joints")
            ),
            "constraints": tuple(map(_constraint, _listed(self.constraints, "constraints"))),
        }
        for name, value in as_tuples.items():
            object.__setattr__(self, name, value)
        has_limits = self.min_edge is not None or self.min_angle is not None
        if self.loops == "one" and (self.has_priorities or has_limits or self.symmetry is not None or self.convex):
            raise NestedCagesError(
                'loops="one" does not go with convex, symmetry, weights, pins, joints or limits; leave out one.',
                code="setting.conflict",
                names=("loops",),
            )
        if self.convex and (self.pins or self.joints or has_limits):
            raise NestedCagesError(
                "Convex cages have no pins, joints or limits; leave these out or convex.", code="setting.conflict"
            )

    @property
    def has_priorities(self) -> bool:
        """Whether weights, pins or joints are given."""
        return self.weights is not None or bool(self.pins or self.joints)


def type_name(value: object) -> str | None:
    """The name of a type of numpy; None for none and for doubles, empty for what is no type."""
    try:
        name: str = "float64" if value is None else np.dtype(value).name  # type: ignore[call-overload]
    except TypeError:
        return ""
    return None if name == "float64" else name


def _weights(weights: ArrayLike | None) -> tuple[float, ...] | None:
    """Weights as a tuple. Raises NestedCagesError."""
    if weights is None:
        return None
    numbers = _numbers(weights, "The weights must be a list of finite numbers, one per fine vertex")
    if (numbers < 0.0).any() or not (numbers > 0.0).any():
        raise invalid_setting("The weights must be numbers of at least 0, and some of them above 0.")
    return tuple(numbers.tolist())


def _place(place: object, rule: str) -> tuple[float, ...]:
    """A place (x, y). Raises NestedCagesError with the rule."""
    numbers = _numbers(place, rule)
    if len(numbers) != 2:
        raise invalid_setting(f"{rule}, not {place!r}.")
    return tuple(numbers.tolist())


def _numbers(values: object, rule: str) -> FloatArray:
    """(K,) finite numbers. Raises NestedCagesError with the rule."""
    try:
        numbers = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        numbers = np.array(np.nan)
    if numbers.ndim != 1 or not np.isfinite(numbers).all():
        raise invalid_setting(f"{rule}, not {values!r}.")
    return numbers


def _listed(values: object, name: str) -> list[Any]:
    try:
        return list(values)  # type: ignore[call-overload, no-any-return]
    except TypeError:
        raise invalid_setting(f"The {name} must be a list, not {values!r}.") from None


def _constraint(constraint: object) -> object:
    """What was given, if it is a constraint. Raises NestedCagesError."""
    from ..constraints.base import Constraint

    if isinstance(constraint, Constraint):
        return constraint
    raise invalid_setting(
        "A constraint must be an object such as Box(low, high), of a class derived from Constraint, not "
        f"{constraint!r}."
    )
