"""Priorities: weights and pins of the settings, as costs of decimation and energies of a cage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ...decimation.importance import Importance
from ...decimation.line_cycles.turns import PIN_REACH
from ...energies import CageEnergy
from ...energies.weighted_area import Springs, WeightedArea
from ...energies.weighted_sum import BoundSum
from ...errors import Fault, NestingError, note
from ...geometry.arrays import TINY, FloatArray, IntArray
from ...geometry.group import HAND_DRAWN, Symmetry
from ...geometry.mesh import Mesh
from ...geometry.predicates import winding_number
from ...geometry.signed_distance import EdgeSearch
from ...geometry.vectors import cross, norm, rotated_right
from ...level.plan import Need, Plan
from ...level.settings import LevelSettings
from ...level.units import SolverUnits

Chosen = TypeVar("Chosen", bound=LevelSettings)
Places: TypeAlias = Sequence[Sequence[float]]
Pins: TypeAlias = Sequence[int | Sequence[float]]

PIN_STIFFNESS = 1e4
"""Stiffness of a pin's spring, without unit: the pull of the area, half an edge, moves a vertex by 1e-5 of that."""

MAX_MITRE = 4.0
"""Largest distance of a pinned vertex from its corner, in clearances; used at sharper corners."""

KEPT = 2.0
"""Distance of a cage vertex from its pin, relative to the distance that the clearance needs, up to which the pin counts
as kept."""


@dataclass(frozen=True, eq=False)
class Priorities(Importance, Need):
    """The priorities of the settings for one drawing; lengths in input units."""

    @classmethod
    def of(
        cls,
        fine: Mesh,
        symmetry: Symmetry | None,
        weights: ArrayLike | None,
        places: tuple[Pins, Places],
    ) -> Priorities:
        """The priorities around a drawing. Raises NestingError if they do not fit it.

        weights: (n,); places: pins and joints.
        """
        weights = None if weights is None else np.asarray(weights, np.float64)
        if weights is not None and len(weights) != len(fine.vertices):
            raise NestingError(
                f"There are {len(weights)} weights, but the mesh has {len(fine.vertices)} vertices.",
                code="priorities.mismatch",
                given=len(weights),
                available=len(fine.vertices),
            )
        return cls(fine, weights, _places(*places, fine, symmetry), symmetry)

    @property
    def places(self) -> FloatArray:
        """(P, 2) pins."""
        return self.pins

    def applied(self, settings: Chosen) -> Chosen:
        """The settings with line cycles that respect the priorities."""
        respecting = getattr(settings.decimation, "respecting", None)
        return settings if respecting is None else replace(settings, decimation=respecting(self))

    def energy(self, plan: Plan, energy: CageEnergy, coarse: Mesh, units: SolverUnits, clearance: float) -> CageEnergy:
        """An energy of a cage with the priorities; see `Need.energy`."""
        inner = units.from_input(plan.outline)
        if self.weights is not None:
            at, outline = self.at, (coarse.vertices, coarse.successor, inner)
            weighted = WeightedArea.of(*outline, lambda points: at(units.to_input(points)), side=plan.side)
            energy = energy.with_area(weighted)
        terms: list[tuple[float, CageEnergy]] = [(1.0, energy)]
        if len(self.pins):
            target, _ = self._targets(inner, units.points(self.pins), plan.side * clearance)
            pin, vertex = _assigned(target, coarse.vertices)
            terms.append((1.0, Springs(vertex, target[pin], PIN_STIFFNESS)))
        return BoundSum(tuple(terms)) if len(terms) > 1 else energy

    def _targets(self, inner: Mesh, pins: FloatArray, clearance: float) -> tuple[FloatArray, FloatArray]:
        """(P, 2) targets of pins, and (P,) their distances from the mesh; inside it for clearances below 0."""
        reach = PIN_REACH * inner.diagonal + MAX_MITRE * abs(clearance)
        ahead = inner.edge_ends - inner.vertices
        normal = rotated_right(ahead) / np.maximum(np.hypot(*ahead.T), TINY)[:, None]
        before = normal[inner.predecessor]
        # the corner of two edges that both move outwards by 1
        mitre = (normal + before) / np.maximum(1.0 + (normal * before).sum(axis=1), 1.0 / MAX_MITRE**2)[:, None]
        length = norm(mitre)
        mitre *= np.minimum(1.0, MAX_MITRE / np.maximum(length, TINY))[:, None]
        close = EdgeSearch.of(inner).closest(pins)
        on_edge = close.between(inner.vertices, inner.edge_ends)
        target, away = np.empty_like(pins), np.empty(len(pins))
        for k, pin in enumerate(pins):
            distance = norm(inner.vertices - pin)
            vertex = int(np.argmin(distance))
            if distance[vertex] <= reach:
                start, step = inner.vertices[vertex], mitre[vertex]
            else:
                start, step = on_edge[k], normal[close.edge[k]]
            target[k] = start + clearance * step
            away[k] = abs(clearance) * float(norm(step[None])[0])
        return target, away

    def notes(self, plan: Plan, cage: Mesh, clearance: float) -> tuple[Fault, ...]:
        """A sentence for each pin that the cage misses."""
        inner, notes = plan.outline, []
        if len(self.pins):
            target, away = self._targets(inner, self.pins, plan.side * clearance)
            for pin, aim, far in zip(self.pins, target, away, strict=True):
                missed = float(norm(cage.vertices - aim).min())
                if missed > KEPT * far + PIN_REACH * inner.diagonal:
                    notes.append(note("note.pin", place=pin, distance=missed))
        return tuple(notes)


def _assigned(places: FloatArray, vertices: FloatArray) -> tuple[IntArray, IntArray]:
    """Pairs of a place and a vertex, each used once, with the least total distance."""
    distance = norm((places[:, None] - vertices[None]).reshape(-1, 2)).reshape(len(places), len(vertices))
    chosen, vertex = scipy.optimize.linear_sum_assignment(distance)
    return chosen.astype(np.int64), vertex.astype(np.int64)


def _places(pins: Pins, joints: Places, fine: Mesh, symmetry: Symmetry | None) -> FloatArray:
    """(P, 2) places of all pins and joints on the outline, with their images. Raises NestingError."""
    edges = EdgeSearch.of(fine)
    places: list[FloatArray] = []
    for pin in pins:
        if isinstance(pin, int):
            if not -len(fine.vertices) <= pin < len(fine.vertices):
                raise NestingError(
                    f"There is no vertex {pin} to pin; the mesh has {len(fine.vertices)} vertices.",
                    code="priorities.mismatch",
                    given=pin,
                    available=len(fine.vertices),
                )
            places.append(fine.vertices[pin])
        else:
            places.append(edges.nearest(np.asarray([pin], np.float64))[0])
    for joint in joints:
        places += _across(fine, edges, np.asarray(joint, np.float64))
    apart: list[FloatArray] = []
    near = (PIN_REACH if symmetry is None else HAND_DRAWN) * fine.diagonal
    for each in places:
        if all(np.hypot(*(each - other)) > near for other in apart):
            if symmetry is not None and symmetry.reverses and np.hypot(*(symmetry.image(each) - each)) <= near:
                each = symmetry.fixed(each)
            apart.append(each)
            for k in range(1, symmetry.order if symmetry is not None else 1):
                assert symmetry is not None
                image = symmetry.image(each, k)
                if np.hypot(*(image - each)) > near:
                    apart.append(image)
    return np.array(apart).reshape(-1, 2)


def _across(fine: Mesh, edges: EdgeSearch, joint: FloatArray) -> list[FloatArray]:
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
