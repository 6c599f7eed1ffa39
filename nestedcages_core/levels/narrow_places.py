"""Where a mesh is too narrow for a clearance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..errors import Fault
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import BoxTree
from ..geometry.mesh import Mesh
from ..geometry.precision import MOST_ROUNDS, NEGLIGIBLE
from ..geometry.signed_distance import SignedDistance
from ..geometry.vectors import format_point


@dataclass(frozen=True)
class Bound:
    """A place where no cage keeps more than ``clearance``, and why, as parts of a sentence."""

    clearance: float
    where: str
    why: str
    remedy: str
    loops: tuple[int, ...]
    place: tuple[float, float]

    def message(self, wanted: float) -> Fault:
        """The message for a larger clearance."""
        less = f"ask for less than {self.clearance:.6g}, or " if 0.0 < self.clearance < wanted else ""
        return Fault(
            f"No cage {f'keeps the clearance of {wanted:.6g}' if wanted > 0.0 else 'fits'} {self.where}: {self.why}; "
            f"{less}{self.remedy}.",
            "clearance.no_room",
            wanted=wanted,
            largest=self.clearance,
            loops=self.loops,
            place=self.place,
        )


def tightest_place(fine: Mesh) -> Bound | None:
    """The tightest place for cages with the loops of a mesh; None if there is no such place."""
    return min(_bounds_of_regions(fine), key=lambda bound: bound.clearance, default=None)


def too_narrow(fine: Mesh, wanted: float) -> Fault | None:
    """Why no cage with the loops of a mesh can keep a clearance; None if no bound says so."""
    bound = tightest_place(fine)
    return None if bound is None or bound.clearance > (1.0 + NEGLIGIBLE) * wanted else bound.message(wanted)


def _bounds_of_regions(fine: Mesh) -> Iterator[Bound]:
    """For every region outside of the solid: half the distance between two loops around it, or, if one loop encloses
    it alone, the radius of the largest circle in it."""
    region = np.where(fine.loop_signs > 0, fine.parent_of_loop, np.arange(len(fine.loops)))
    for k in np.unique(region).tolist():
        loops = np.flatnonzero(region == k)
        if len(loops) > 1:
            yield _gap_of_loops(fine, loops)
        elif k >= 0:
            yield _widest_circle(fine, k)


def _gap_of_loops(fine: Mesh, loops: IntArray) -> Bound:
    """The bound by the two of several loops (K,) that are closest to each other: a cage of each runs between them."""
    starts = np.concatenate([fine.loops[k] for k in loops])
    owner = fine.loop_of_vertex[starts]
    places: list[tuple[float, int, int, FloatArray]] = []
    for k in loops.tolist():
        others = starts[owner != k]
        points = fine.vertices[fine.loops[k]]
        nearest = BoxTree(fine.vertices[others], fine.vertices[fine.successor[others]]).closest(points)
        closest = int(nearest.distance.argmin())
        begin = others[nearest.edge[closest]]
        met = fine.vertices[begin] + nearest.parameter[closest] * (fine.edge_ends - fine.vertices)[begin]
        middle = 0.5 * (points[closest] + met)
        places.append((float(nearest.distance[closest]), k, int(fine.loop_of_vertex[begin]), middle))
    least, *pair, middle = min(places, key=lambda each: each[0])
    one, other = sorted(pair)
    return Bound(
        0.5 * least,
        f"between loops {one} and {other} of the mesh inside it",
        f"they are {least:.6g} apart near {format_point(middle)}, and a loop of the cage runs along each",
        "move them apart or join them",
        (one, other),
        (float(middle[0]), float(middle[1])),
    )


def _widest_circle(fine: Mesh, hole: int) -> Bound:
    """The bound by a hole without islands: its loop of the cage lies around some point in it."""
    circle = largest_circle(fine, hole)
    return Bound(
        circle.radius,
        f"in loop {hole} of the mesh inside it, a hole",
        f"the largest circle in it, around {format_point(circle.centre)}, has the radius {circle.radius:.6g}",
        "fill the hole",
        (hole,),
        (float(circle.centre[0]), float(circle.centre[1])),
    )


GRID_SIZE, REFINED_POINTS = 32, 8
"""Points along each side of grids that search for the widest place of a hole, and best ones that are refined."""


class Circle(NamedTuple):
    """A circle in a hole."""

    centre: FloatArray
    """(2,)."""
    radius: float


def largest_circle(fine: Mesh, hole: int) -> Circle:
    """The largest circle inside a hole of a mesh, ignoring what lies in the hole, by refined grids."""
    loop = fine.loops[hole]
    distance = SignedDistance(fine.vertices[loop], fine.edge_ends[loop], outside=-1)
    low, high = fine.vertices[loop].min(axis=0), fine.vertices[loop].max(axis=0)
    width, middles = high - low, (0.5 * (low + high))[None]
    steps = np.linspace(-0.5, 0.5, GRID_SIZE)
    grid = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(1, -1, 2)
    for _ in range(MOST_ROUNDS):
        points: FloatArray = np.concatenate((middles, (middles[:, None] + width * grid).reshape(-1, 2)))
        room = distance.at(points).distance
        best = np.argsort(-room)[:REFINED_POINTS]
        middles, width = points[best], 4.0 * width / GRID_SIZE  # two steps on either side
    return Circle(middles[0], float(room[best[0]]))
