"""The fields of `Settings` as typed keywords."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike

    from ..constraints.base import Constraint
    from ..contact import Contact
    from ..decimation import Decimation
    from ..energies import Energy
    from ..flow import FlowMethod
    from ..geometry.group import Symmetry
    from ..geometry.mesh import Mesh
    from ..geometry.symmetry import DetectSymmetry
    from ..tightening import Tightening


class SettingsKeywords(TypedDict, total=False):
    """What `nested_cages` and the like take as keywords: the fields of `Settings`, which says what they mean."""

    clearance: float | None
    decimation: Decimation
    fallback: Decimation | None
    flow: FlowMethod
    energy: Energy
    contact: Contact | Sequence[Contact] | None
    tightening: Tightening
    steps: bool
    grid: float | None
    stored: DTypeLike | None
    loops: Literal["auto", "keep", "one"]
    convex: bool
    symmetry: Symmetry | DetectSymmetry | None
    weights: ArrayLike | None
    pins: Sequence[int | Sequence[float]]
    joints: Sequence[Sequence[float]]
    min_edge: float | None
    min_angle: float | None
    constraints: Sequence[Constraint]
    seconds: float | None
    about: Mesh | None
