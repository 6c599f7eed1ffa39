"""Pins: corners of a drawing that keep a vertex of the cage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import scipy

from ..decimation.turns import PIN_REACH
from ..energies import CageEnergy
from ..energies.springs import Springs
from ..errors import Fault, NestingError, note
from ..geometry.arrays import TINY, FloatArray
from ..geometry.broad_phase import BoxTree
from ..geometry.group import HAND_DRAWN, Symmetry
from ..geometry.mesh import Mesh
from ..geometry.predicates import winding_number
from ..geometry.vectors import cross, norm, rotated_right
from .base import Constraint, Units

Places: TypeAlias = Sequence[Sequence[float]]
PinList: TypeAlias = Sequence[int | Sequence[float]]

PIN_STIFFNESS = 1e4
"""Stiffness of a pin's spring, without unit: the pull of the area, half an edge, moves a vertex by 1e-5 of that."""

OUT_OF_REACH = 0.5
"""Distance of a vertex from a pin, in diagonals, from which none is pulled there: it would cost area and not arrive."""

MAX_MITRE = 4.0
"""Largest distance of a pinned vertex from its corner, in clearances; used at sharper corners."""

KEPT = 2.0
"""Distance of a cage vertex from its pin, relative to the distance that the clearance needs, up to which the pin counts
as kept."""


@dataclass(frozen=True, eq=False)
class Pins(Constraint):
    """Places on the outline each keep a vertex of the cage next to them, where there is room."""

    must = False
    is_rule = False
    places: FloatArray
    """(P, 2) in the input's units."""
    clearance: float
    """That of the cages."""
    side: int = 1
    level: Mesh | None = None
    """The outline of a level."""

    def around(self, outline: Mesh) -> Pins:
        """The pins of a level."""
        return replace(self, level=outline)

    def term(self, coarse: Mesh, units: Units) -> CageEnergy | None:
        """Springs between pins and vertices."""
        assert self.level is not None
        inner, clearance = self.level.moved(units.points(self.level.vertices)), units.clearance(self.clearance)
        target, _ = self._targets(inner, units.points(self.places), clearance)
        distance = norm(target[:, None] - coarse.vertices)
        pin, vertex = scipy.optimize.linear_sum_assignment(distance)  # each once, of the least total
        near = distance[pin, vertex] < OUT_OF_REACH
        return Springs(vertex[near], target[pin[near]], np.full(int(near.sum()), PIN_STIFFNESS))

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """A sentence on the pins that the cage misses."""
        inner = fine if self.level is None else self.level
        target, away = self._targets(inner, self.places, self.clearance)
        distances = norm(target[:, None] - cage.vertices).min(axis=1)
        missed = distances > KEPT * away + PIN_REACH * inner.diagonal
        if not missed.any():
            return None
        k = int(np.argmax(distances * missed))
        facts = {"place": self.places[k], "distance": float(distances[k])}
        return note("note.pin", **facts, count=int(missed.sum()), pins=len(missed))

    def _targets(self, inner: Mesh, pins: FloatArray, clearance: float) -> tuple[FloatArray, FloatArray]:
        """(P, 2) targets of pins at a clearance from a mesh, and (P,) their distances from it."""
        clearance *= self.side
        reach = PIN_REACH * inner.diagonal + MAX_MITRE * abs(clearance)
        ahead = inner.edge_ends - inner.vertices
        normal = rotated_right(ahead) / np.maximum(np.hypot(*ahead.T), TINY)[:, None]
        before = normal[inner.predecessor]
        # the corner of two edges that both move outwards by 1
        mitre = (normal + before) / np.maximum(1.0 + (normal * before).sum(axis=1), 1.0 / MAX_MITRE**2)[:, None]
        length = norm(mitre)
        mitre *= np.minimum(1.0, MAX_MITRE / np.maximum(length, TINY))[:, None]
        close = inner.edge_search.closest(pins)
        distance = norm(pins[:, None] - inner.vertices)
        vertex, at_corner = distance.argmin(axis=1), (distance.min(axis=1) <= reach)[:, None]
        place = np.where(at_corner, inner.vertices[vertex], close.between(inner.vertices, inner.edge_ends))
        step = np.where(at_corner, mitre[vertex], normal[close.edge])
        return place + clearance * step, abs(clearance) * norm(step)


def pinned_places(pins: PinList, joints: Places, fine: Mesh, symmetry: Symmetry | None) -> FloatArray:
    """(P, 2) places of all pins and joints on the outline, with their images. Raises NestingError."""
    edges, count = fine.edge_search, len(fine.vertices)
    places: list[FloatArray] = []
    for pin in pins:
        if isinstance(pin, int) and not -count <= pin < count:
            raise NestingError(
                f"There is no vertex {pin} to pin; the mesh has {count} vertices.",
                code="priorities.mismatch",
                given=pin,
                available=count,
            )
        places.append(fine.vertices[pin] if isinstance(pin, int) else edges.nearest(np.array([pin], np.float64))[0])
    for joint in joints:
        places += _across(fine, edges, np.asarray(joint, np.float64))
    near = (PIN_REACH if symmetry is None else HAND_DRAWN) * fine.diagonal
    apart: list[FloatArray] = []
    for each in places:
        if any(np.hypot(*(each - other)) <= near for other in apart):
            continue
        if symmetry is not None and symmetry.reverses and np.hypot(*(symmetry.image(each) - each)) <= near:
            each = symmetry.fixed(each)
        images = [] if symmetry is None else [symmetry.image(each, k) for k in range(1, symmetry.order)]
        apart += [each, *(image for image in images if np.hypot(*(image - each)) > near)]
    return np.array(apart).reshape(-1, 2)


def _across(fine: Mesh, edges: BoxTree, joint: FloatArray) -> list[FloatArray]:
    """The closest place on the outline to a joint and, for a joint inside, the place straight across from it."""
    near: FloatArray = edges.nearest(joint[None])[0]
    away = joint - near
    if winding_number(joint[None], edges.starts, edges.ends)[0] != 1 or not away.any():
        return [near]
    start, along = edges.starts, edges.ends - edges.starts
    denominator = cross(np.broadcast_to(away, along.shape), along)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = cross(start - joint, along) / denominator
        u = cross(start - joint, np.broadcast_to(away, along.shape)) / denominator
    hit = (t > 0.0) & (u >= 0.0) & (u <= 1.0)
    return [near, joint + float(t[hit].min()) * away] if hit.any() else [near]
