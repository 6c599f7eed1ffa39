"""Greedy outer hull of a symmetric outline: every move is made together with its images, or not at all.

The images of a move have the same cost and are made right after it, each with its own exact tests. If one of them is
blocked, the previous ones are undone and the move is discarded. A move that is its own image, at a mirror's axis, is
made alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.group import Symmetry
from ...geometry.orbits import Orbits
from ...geometry.vectors import norm
from ...tasks import Stage
from ..asymmetry import SYMMETRY_TOLERANCE, AsymmetricError
from ..outline import Outline
from .hull_moves import Weights
from .importance import Importance
from .move_queue import Place
from .progressive_hull import MAX_REACH_ROUNDS, PAUSE, REACH_GROWTH, ProgressiveHull

AXIS_TOLERANCE = 1e-9
"""The same for new vertices of a move that is its own image."""


def orbits_of(outline: Outline, symmetry: Symmetry) -> Orbits:
    """The orbits of an outline. Raises AsymmetricError."""
    orbits = Orbits.of(outline.vertices, outline.successor, symmetry, SYMMETRY_TOLERANCE * outline.diameter)
    if orbits is None:
        raise AsymmetricError(
            f"No symmetric hull was found: where gaps are narrow, an offset of the outline does not have {symmetry}; "
            "leave out the symmetry, or widen the gaps.",
            code="symmetry.not_found",
        )
    return orbits


def symmetrised(outline: Outline, symmetry: Symmetry) -> Outline:
    """An outline that is symmetric up to a tolerance, made exactly symmetric. Raises AsymmetricError."""
    return outline.moved(orbits_of(outline, symmetry).symmetrised(outline.vertices))


def padded_alike(outline: Outline, total: int, symmetry: Symmetry) -> list[FloatArray]:
    """The loops (k, 2) of a symmetric outline with edges divided evenly, images alike, up to `total` vertices.

    May have fewer vertices where edges come in orbits. Raises AsymmetricError.
    """
    successor = outline.successor
    steps = outline.vertices[successor] - outline.vertices
    _, orbit, sizes = np.unique(
        orbits_of(outline, symmetry).edge_orbit(successor), return_inverse=True, return_counts=True
    )
    lengths = np.zeros(len(sizes))
    lengths[orbit] = norm(steps)
    pieces, missing = np.ones(len(sizes), np.int64), total - len(outline.vertices)
    while (sizes <= missing).any():
        spacing = np.where((sizes <= missing) & ((sizes > 1) | (missing % symmetry.order > 0)), lengths / pieces, -1.0)
        chosen = int(np.argmax(spacing))
        if spacing[chosen] < 0.0:
            chosen = int(np.argmax(np.where(sizes <= missing, lengths / pieces, -1.0)))
        pieces[chosen] += 1
        missing -= int(sizes[chosen])
    of_edge = pieces[orbit]
    begin = np.cumsum(of_edge) - of_edge
    fraction = (np.arange(of_edge.sum()) - np.repeat(begin, of_edge)) / np.repeat(of_edge, of_edge)
    vertices = np.repeat(outline.vertices, of_edge, axis=0) + fraction[:, None] * np.repeat(steps, of_edge, axis=0)
    grown = tuple(np.add.reduceat(of_edge, outline.begins).tolist())
    padded = Outline(vertices, grown, np.zeros((len(vertices), 2), np.int64))
    return symmetrised(padded, symmetry).loops


class SymmetricHull(ProgressiveHull):
    """State of the greedy with the image of each vertex under the generator; see `ProgressiveHull`."""

    def __init__(
        self,
        outline: Outline,
        weights: Weights,
        minimum: Sequence[int],
        importance: Importance | None = None,
        *,
        symmetry: Symmetry,
    ) -> None:
        """Raises AsymmetricError."""
        self.symmetry = symmetry
        self.partner: list[int] = orbits_of(outline, symmetry).partner.tolist()
        self._count = 0
        self._undone: set[tuple[float, ...]] = set()
        super().__init__(outline, weights, minimum, importance)

    def steps(self, count: int, max_cost: float = inf) -> Stage[float, Outline]:
        """Remove vertices until `count` are left, or a few less where moves remove several at a time."""
        loops = self.loops
        self._count, first, moves = count, loops.total, 0
        for rounds in range(MAX_REACH_ROUNDS + 1):
            while loops.total > count:
                moves += 1
                if moves % PAUSE == 0:
                    yield (first - loops.total) / (first - count)
                move = self.queue.pop(max_cost)
                if move is None:
                    break
                self._make(*move)
            if loops.total <= count or max_cost < inf:
                break
            if loops.total - count < self.symmetry.order:
                self._count = count - self.symmetry.order  # missing vertices can be added to edges
                self._consider_all()
            elif rounds < MAX_REACH_ROUNDS:
                self.reach *= REACH_GROWTH
                self._consider_all()
        return symmetrised(loops.outline(), self.symmetry)

    def _make(self, slot: int, ratio: Place) -> None:
        b, loops = slot // 2, self.loops
        make, place = self._prepared(slot, ratio)
        if place is None:
            return
        touched = [b, loops.next[b]] if slot % 2 else [loops.previous[b], b, loops.next[b]] if ratio else [b]
        self._together(b, place, make, touched)

    def _together(self, b: int, place: tuple[float, ...], make: Callable[..., None], touched: Sequence[int]) -> None:
        """Make a move, which touches the vertices `touched` in loop order, with all its images."""
        loops, symmetry, partner = self.loops, self.symmetry, self.partner
        images = [list(touched)]
        for _ in range(1, symmetry.order):
            image = [partner[v] for v in images[-1]]
            images.append(image[::-1] if symmetry.reverses else image)
        is_own = images[1] == images[0]
        if is_own:
            images = images[:1]
            on_axis = self._on_axis(place)
            if on_axis is None:
                return
            place = on_axis
        together = [v for image in images for v in image]
        removed: dict[int, int] = {}
        for image in images:
            removed[loops.loop_of[image[0]]] = removed.get(loops.loop_of[image[0]], 0) + 1
        fits = loops.total - len(images) >= self._count
        fits = fits and all(loops.sizes[k] - number >= self.minimum[k] for k, number in removed.items())
        key = (b, loops.previous[b], loops.next[b], *place)
        if not fits or len(set(together)) < len(together) or key in self._undone:
            return
        snapshots: list[_Snapshot] = []
        points = np.array(place).reshape(-1, 2)
        made = []
        for k, image in enumerate(images):
            window = [loops.previous[loops.previous[image[0]]], loops.previous[image[0]], *image]
            window += [loops.next[image[-1]], loops.next[loops.next[image[-1]]]]
            snapshots.append(_Snapshot(self, window))
            target = symmetry.image(points, k)
            if symmetry.reverses and k % 2:
                target = target[::-1]
            before = loops.total
            make(image[len(image) // 2] if len(image) == 3 else image[0], *target.ravel().tolist())
            if loops.total == before:
                self._undone.add(key)
                for snapshot in reversed(snapshots):
                    snapshot.restore()
                return
            made.append(image)
        self._match(made)

    def _match(self, made: Sequence[Sequence[int]]) -> None:
        """Update the partners after a move and its images: new vertices are images of new vertices, in loop order."""
        if len(made[0]) == 1:
            return
        kept = [image[:-1] for image in made]  # the last of those touched was removed
        for k, image in enumerate(kept):
            following = kept[(k + 1) % len(kept)]
            for v, partner in zip(image, following[::-1] if self.symmetry.reverses else following, strict=True):
                self.partner[v] = partner

    def _on_axis(self, place: tuple[float, ...]) -> tuple[float, ...] | None:
        """The new vertices of a move that is its own image, made symmetric; None if they are not nearly so."""
        if not place:
            return place
        points = np.array(place).reshape(-1, 2)
        image = self.symmetry.image(points)[::-1]
        if float(np.abs(image - points).max()) > AXIS_TOLERANCE * self.loops.diameter:
            return None
        exact: FloatArray = self.symmetry.fixed(points) if len(points) == 1 else 0.5 * (points + image)
        return tuple(exact.ravel().tolist())


class _Snapshot:
    """The state of a few vertices before a move."""

    def __init__(self, hull: SymmetricHull, window: Sequence[int]) -> None:
        loops = hull.loops
        self.hull, self.window = hull, list(dict.fromkeys(window))
        self.loop = loops.loop_of[window[0]]
        self.whole = loops.total, loops.sizes[self.loop], loops.entrance[self.loop]
        self.vertices = [
            (v, loops.x[v], loops.y[v], loops.next[v], loops.previous[v], loops.first[v], loops.last[v])
            for v in self.window
        ]
        self.pinned = [hull.pinned[v] for v in self.window]

    def restore(self) -> None:
        """Undo the move."""
        loops = self.hull.loops
        for v in self.window:
            if loops.alive[v]:
                loops.boxes.remove(v)
        for v, x, y, after, before, first, last in self.vertices:
            loops.x[v], loops.y[v], loops.next[v], loops.previous[v] = x, y, after, before
            loops.first[v], loops.last[v], loops.alive[v] = first, last, True
        loops.total, loops.sizes[self.loop], loops.entrance[self.loop] = self.whole
        for v, held in zip(self.window, self.pinned, strict=True):
            self.hull.pinned[v] = held
        for v in self.window:
            loops.boxes.insert(v, loops.x[v], loops.y[v], loops.x[loops.next[v]], loops.y[loops.next[v]])
        self.hull._consider_around(self.window[0], self.window[-1])
