"""The objects and places that an error message of the core refers to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core import core, distance
from ..errors import Fault
from .plane import Frame, nearest, size

# Largest distance of edges at fault from the place in a message, as a fraction of the drawing's size: they may be
# rounded.
NEAR = 1e-4
# Maximum number of points of a fault.
MOST_POINTS = 8


class Part(NamedTuple):
    """The loops (k, 2) of one object in a drawing."""

    name: str
    identity: int
    loops: Sequence[NDArray[np.float64]]


def with_names(found: core.Fault, parts: Sequence[Part]) -> str:
    """The message, and which objects its loops belong to, for a drawing of several objects."""
    owners = [(part, number) for part in parts for number in range(len(part.loops))]
    loops = [loop for loop in found.data.get("loops", ()) if loop < len(owners)]
    if len(parts) < 2 or not loops:
        return str(found)
    names = []
    for loop in loops:
        part, own = owners[loop]
        of_it = f"loop {own} of " if len(part.loops) > 1 else ""
        names.append(f"loop {loop} is {of_it}'{part.name}'")
    return f"{found} Here {' and '.join(names)}."


def fault(found: core.Fault, parts: Sequence[Part], frame: Frame) -> Fault | None:
    """The ends of the edges at the place that a message names, of the closest object; None without a place."""
    if found.data.get("place") is None:
        return None
    place = np.array(found.data["place"], dtype=np.float64)
    reach = NEAR * size(np.concatenate([loop for part in parts for loop in part.loops]))
    closest = min(parts, key=lambda part: min(_distances(loop, place).min() for loop in part.loops))
    ends: list[NDArray[np.float64]] = []
    for loop in closest.loops:
        near = np.flatnonzero(_distances(loop, place) <= reach)
        ends += [loop[near], np.roll(loop, -1, axis=0)[near]]
    points = np.concatenate(ends)
    if not len(points):
        every = np.concatenate(list(closest.loops))
        points = every[nearest(place[None], every)]
    closest_first = np.argsort(np.linalg.norm(points - place, axis=1), kind="stable")[:MOST_POINTS]
    world = frame.to_world(points[closest_first]).tolist()
    return Fault(closest.identity, tuple((x, y, z) for x, y, z in world))


def _distances(loop: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distances (k,) of a place from the edges of a loop (k, 2)."""
    found: NDArray[np.float64] = distance.point_edge(place, loop, np.roll(loop, -1, axis=0)).distance
    return found
