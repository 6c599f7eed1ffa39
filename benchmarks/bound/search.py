"""Branch and bound: cells that cheap walks use are halved until all walks cost as much as the target."""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np

from nestedcages_core import Mesh

from .chords import ALLOWED, along_chords
from .corners import Moves, onto_outline, over_corners
from .nodes import EDGE, Nodes, first_nodes
from .outline import LOWER, Outline, ranges
from .walks import cheap_walks

PER_HALF_TURN = 8
"""First cells in half a turn."""
FEW_VERTICES = 200
"""Vertices of an outline below which its edges get two pieces each, on average."""
FEW_NODES = 1000
"""Nodes below which a larger part of them is halved in a round."""
HALVED_OF_FEW, HALVED_OF_MANY = 0.6, 0.1
"""Nodes are halved whose cheapest walk lies within this part of the way from the bound to the target."""
SMALLEST_CELL = 1e-7
"""Radians or part of an edge; cells that are smaller are not halved."""
CHUNK = 300_000
"""Pairs of nodes that are looked at in one go."""
MOST_MOVES, MOST_ROUNDS = 1_200_000, 40
"""Caps."""


class Bound(NamedTuple):
    """A lower bound, and what it took."""

    area: float
    """No simple polygon of at most m vertices whose solid holds the shape has less."""
    proven: bool
    """Whether the target was reached."""
    rounds: int
    nodes: int
    seconds: float
    """CPU time."""


def lower_bound(shape: Mesh, most: int, cage_area: float, *, target: float = 0.01, seconds: float = 30.0) -> Bound:
    """Bound the area of all polygons of at most ``most`` vertices around a shape of one loop, holes left out.

    cage_area: that of a known cage; the search ends once it is at most the part ``target`` above the bound.
    """
    began = time.process_time()
    loop = next(loop for loop, sign in zip(shape.loops, shape.loop_signs, strict=True) if sign > 0)
    outline = Outline(shape.vertices[loop])
    below = cage_area / outline.size**2 / (1.0 + target) - outline.area
    if below <= 0.0:
        return Bound(outline.area * outline.size**2, True, 0, 0, time.process_time() - began)
    nodes = first_nodes(outline, PER_HALF_TURN, (2 if len(outline) < FEW_VERTICES else 1) * len(outline))
    moves = _first_moves(nodes, below)
    best, rounds = 0.0, 0
    while True:
        rounds += 1
        every = Moves.joined([moves, onto_outline(nodes, below)])
        cheap = cheap_walks(nodes, every._replace(area=np.maximum(every.area - LOWER, 0.0)), most, below)
        best = max(best, min(cheap.least, below))
        if cheap.least >= below or rounds == MOST_ROUNDS or time.process_time() - began > seconds:
            break
        alive = cheap.through < below
        part = HALVED_OF_FEW if alive.sum() < FEW_NODES else HALVED_OF_MANY
        split = alive & (cheap.through <= cheap.least + part * (below - cheap.least))
        split &= nodes.high - nodes.low > SMALLEST_CELL
        kept = moves.take(cheap.moves[: len(moves.source)])
        kept = kept.take(alive[kept.source] & alive[kept.target])
        finer = _halved(nodes, kept, alive, split, below)
        if not split.any() or finer is None:
            break
        nodes, moves = finer
    area = (outline.area + best) * outline.size**2
    return Bound(area, bool(cheap.least >= below), rounds, len(nodes.kind), time.process_time() - began)


def _first_moves(nodes: Nodes, below: float) -> Moves:
    """All moves of less area than something, but those to and from an edge and the outline."""
    found = []
    for kinds in ((EDGE, EDGE), *ALLOWED):
        sources, targets = (np.flatnonzero(nodes.kind == kind) for kind in kinds)
        step = 1 + CHUNK // max(len(targets), 1)
        for begin in range(0, len(sources), step):
            part = sources[begin : begin + step]
            source, target = np.repeat(part, len(targets)), np.tile(targets, len(part))
            other = source != target
            found.append(_areas(nodes, source[other], target[other], below))
    return Moves.joined(found)


def _areas(nodes: Nodes, source: np.ndarray, target: np.ndarray, below: float) -> Moves:
    """The moves between pairs of nodes that have less area than something."""
    area = np.full(len(source), np.inf)
    edges = nodes.kind[source] == EDGE
    area[edges] = over_corners(nodes, source[edges], target[edges])
    area[~edges] = along_chords(nodes, source[~edges], target[~edges], below)
    return Moves(source, target, area).take(area < below)


def _halved(
    nodes: Nodes, moves: Moves, alive: np.ndarray, split: np.ndarray, below: float
) -> tuple[Nodes, Moves] | None:
    """Nodes with some in two, and the moves between them; None if they would be too many."""
    finer, first, count = nodes.halved(alive, split)
    parent, source = ranges(first[moves.source], (first + count)[moves.source])
    again, target = ranges(first[moves.target][parent], (first + count)[moves.target][parent])
    source, parent = source[again], parent[again]
    if len(source) > MOST_MOVES:
        return None
    same = ~split[moves.source[parent]] & ~split[moves.target[parent]]
    stay = Moves(source[same], target[same], moves.area[parent[same]])
    parts = [stay]
    source, target = source[~same], target[~same]
    parts += [_areas(finer, source[k : k + CHUNK], target[k : k + CHUNK], below) for k in range(0, len(source), CHUNK)]
    return finer, Moves.joined(parts)
