"""The objects and places that an error message of the core refers to."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import Fault
from .plane import Frame, size

# Largest distance of edges at fault from the place in a message, as a fraction of the drawing's size: messages round
# places to six digits.
NEAR = 1e-4
# Maximum number of points of a fault.
MOST_POINTS = 8

PLACE = re.compile(r"\((-?\d[\d.]*(?:e[+-]?\d+)?), (-?\d[\d.]*(?:e[+-]?\d+)?)\)")
LOOP = re.compile(r"\b([Ll]oops?) (\d+)(?: and (\d+))?")


class Part(NamedTuple):
    """The loops (k, 2) of one object in a drawing."""

    name: str
    identity: int
    loops: Sequence[NDArray[np.float64]]


def with_names(message: str, parts: Sequence[Part]) -> str:
    """The message with loops numbered per object, for a drawing of several objects."""
    if len(parts) < 2:
        return message
    owners = [(part, number) for part in parts for number in range(len(part.loops))]

    def name(number: int) -> str:
        part, own = owners[number]
        return f"'{part.name}'" if len(part.loops) == 1 else f"loop {own} of '{part.name}'"

    def named(match: re.Match[str]) -> str:
        numbers = [int(found) for found in match.groups()[1:] if found is not None]
        if max(numbers) >= len(owners):
            return match[0]
        return " and ".join(map(name, numbers))

    return LOOP.sub(named, message)


def fault(message: str, parts: Sequence[Part], frame: Frame) -> Fault | None:
    """The ends of the edges at the first place in a message, of the closest object; None without a place."""
    found = PLACE.search(message)
    if found is None:
        return None
    place = np.array([float(found[1]), float(found[2])])
    reach = NEAR * size(np.concatenate([loop for part in parts for loop in part.loops]))
    closest = min(parts, key=lambda part: min(_distances(loop, place).min() for loop in part.loops))
    ends: list[NDArray[np.float64]] = []
    for loop in closest.loops:
        near = np.flatnonzero(_distances(loop, place) <= reach)
        ends += [loop[near], np.roll(loop, -1, axis=0)[near]]
    points = np.concatenate(ends)
    if not len(points):
        every = np.concatenate(list(closest.loops))
        points = every[[np.linalg.norm(every - place, axis=1).argmin()]]
    nearest = np.argsort(np.linalg.norm(points - place, axis=1), kind="stable")[:MOST_POINTS]
    world = frame.to_world(points[nearest]).tolist()
    return Fault(closest.identity, tuple((x, y, z) for x, y, z in world))


def _distances(loop: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distances (k,) of a place from the edges of a loop (k, 2)."""
    along = np.roll(loop, -1, axis=0) - loop
    length = np.maximum((along * along).sum(axis=1), np.finfo(float).tiny)
    part = np.clip(((place - loop) * along).sum(axis=1) / length, 0.0, 1.0)
    found: NDArray[np.float64] = np.linalg.norm(loop + part[:, None] * along - place, axis=1)
    return found
