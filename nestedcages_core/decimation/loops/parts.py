"""A drawing as parts with holes with parts: what may be filled, and what may be joined."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from ...geometry.vectors import cross


@dataclass(eq=False)
class LoopOutline:
    """A loop that a cage may keep."""

    ring: FloatArray
    """(k, 2) with the solid on its left."""
    table: FloatArray = field(default_factory=lambda: np.array([np.inf]), init=False)
    """(K,) least area that a cage with 0, 1, … vertices here adds; infinite if not known."""

    @cached_property
    def area(self) -> float:
        """Area inside the outline."""
        here = self.ring - self.ring[0]
        return abs(0.5 * float(cross(here, np.roll(here, -1, axis=0)).sum()))

    @cached_property
    def own_area(self) -> float:
        """That inside the outlines of the drawing that it stands for."""
        return self.area


@dataclass(eq=False)
class Part(LoopOutline):
    """What lies in one outer outline: a component of the drawing, or several that share one."""

    holes: list[Hole]
    """Those of all components in it."""
    joined: tuple[Part, ...] = ()
    """The parts that share the outline; none for a component of the drawing."""

    @cached_property
    def own_area(self) -> float:
        return sum(part.own_area for part in self.joined) if self.joined else self.area

    @cached_property
    def added(self) -> float:
        """Area that the outline adds to those of the components in it."""
        return self.area - self.own_area

    @property
    def solid(self) -> float:
        """Area of the drawing in it."""
        area, parts = 0.0, [self]
        while parts:  # parts may lie in each other deeper than Python calls functions
            part = parts.pop()
            drawn = [hole.drawn for hole in part.holes]
            area += part.own_area - sum(hole.area for hole in drawn)
            parts += [inner for hole in drawn for inner in hole.parts]
        return area

    @property
    def size(self) -> int:
        """The number of loops in it."""
        return sum(1 for _ in outlines([self]))


@dataclass(eq=False)
class Hole(LoopOutline):
    """A hole of a component, and the parts in it."""

    parts: list[Part]
    before: Hole | None = None
    """The hole without the last part that is joined to its outline; None for a hole of the drawing."""
    joined: tuple[Part, ...] = ()
    """The parts that were joined to the outline of that."""
    inner: list[Hole] = field(default_factory=list)
    """The holes of all parts joined to its outline."""

    @cached_property
    def own_area(self) -> float:
        return self.area if self.before is None else self.before.own_area - sum(part.own_area for part in self.joined)

    @cached_property
    def added(self) -> float:
        """Area that joined parts and bridges to them take from it."""
        return self.own_area - self.area

    @property
    def open_area(self) -> float:
        """Area that the drawing gains when the hole is filled, and the parts in it vanish."""
        return self.drawn.area - sum(part.solid for part in self.drawn.parts)

    @property
    def drawn(self) -> Hole:
        """The hole of the drawing that it stands for."""
        hole = self
        while hole.before is not None:
            hole = hole.before
        return hole

    @property
    def size(self) -> int:
        """The number of loops that filling it saves."""
        return 1 + sum(1 for _ in outlines(self.parts)) + sum(hole.size for hole in self.inner)


Kind: TypeAlias = Part | Hole


class OpenRegion(NamedTuple):
    """A region that the drawing leaves open: what is around it, or a hole."""

    parts: list[Part]
    """The parts in it."""
    hole: Hole | None
    siblings: list[Hole]
    """The list that the hole is in."""


def outermost_parts(mesh: Mesh) -> list[Part]:
    """The outermost parts of a mesh."""
    rings, parent, outer = mesh.rings, mesh.parent_of_loop, mesh.loop_signs > 0
    parts = {int(k): Part(rings[k], []) for k in np.flatnonzero(outer)}
    holes = {int(k): Hole(rings[k], []) for k in np.flatnonzero(~outer)}
    for k, hole in holes.items():
        parts[int(parent[k])].holes.append(hole)
    for k, part in parts.items():
        if parent[k] >= 0:
            holes[int(parent[k])].parts.append(part)
    return [part for k, part in parts.items() if parent[k] < 0]


def open_regions(parts: list[Part]) -> Iterator[OpenRegion]:
    """What parts leave open, from outside inwards."""
    yield OpenRegion(parts, None, [])
    lists = [part.holes for part in parts]
    while lists:
        holes = lists.pop(0)
        for hole in holes:
            yield OpenRegion(hole.parts, hole, holes)
            lists += [part.holes for part in hole.parts]
            lists.append(hole.inner)


def outlines(parts: list[Part]) -> Iterator[Kind]:
    """All outlines, as they are now."""
    for region in open_regions(parts):
        yield from region.parts
        if region.hole is not None:
            yield region.hole
