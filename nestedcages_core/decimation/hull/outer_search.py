"""The search for outer hulls: greedy hulls of an offset outline, certified."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import islice
from typing import Protocol

import numpy as np

from ...errors import Fault, InvalidMeshError, NestingError
from ...geometry.arrays import FloatArray
from ...geometry.broad_phase import near_pairs
from ...geometry.distance import point_edge
from ...geometry.group import Symmetry
from ...geometry.mesh import Mesh
from ...geometry.mesh.validation import place as in_words
from ...tasks import Stage, mapped
from ..asymmetry import AsymmetricError
from ..outline import Outline
from ..request import Request
from .clearing import CLEARANCE_RESERVE, CLOSED_GAP_WIDTH, HULL_OFFSET, cleared, without_gaps, without_small_details
from .hull_moves import Weights
from .hull_search import ROUGH_WEIGHTS, search_hulls
from .importance import Importance
from .offset import offsetting
from .progressive_hull import ProgressiveHull
from .remembered import remembered_hull
from .symmetric_hull import SymmetricHull, padded_alike, symmetrised
from .thinning import thinning_rounds

SAME_AREA_TOLERANCE = 1e-9
"""Relative difference of area below which two hulls count as equal."""

MAX_LOOPS_LISTED = 8
"""Number of loops up to which a message lists what was found for each."""


class HullOptions(Protocol):
    """What the search reads of `OuterHull`."""

    @property
    def restarts(self) -> int: ...
    @property
    def seed(self) -> int: ...
    @property
    def symmetry(self) -> Symmetry | None: ...
    @property
    def importance(self) -> Importance | None: ...


def best_hulls(
    method: HullOptions, request: Request, clearance: float, most: int
) -> Stage[float, list[tuple[Mesh, Outline]]]:
    """Up to `most` meshes of one request, least area first. Raises NestingError."""
    search = _Search(method, request, clearance)
    yield from search.begin()
    too_large: list[Outline] = []
    asymmetric: AsymmetricError | None = None
    for hulls in (search.with_clearance, search.without_small_details):
        try:
            found = yield from hulls()
        except AsymmetricError as error:
            asymmetric = error
            continue
        if certified := list(islice(search.certified(found), most)):
            return certified
        too_large += [hull for hull in found[:1] if len(hull.vertices) > search.target]
    if too_large:
        raise NestingError(search.unreachable(min(too_large, key=search.rank)))
    if asymmetric is not None:
        raise asymmetric
    tightest = search.tightest()
    raise NestingError(
        f"There is no room for a cage near {in_words(tightest)}: a gap there is as small as "
        "floating-point numbers can tell at these coordinates; widen it, or move the shape closer to the origin.",
        code="clearance.no_room",
        place=tightest,
    )


class _Search:
    """The search for hulls of one mesh."""

    def __init__(self, method: HullOptions, request: Request, clearance: float) -> None:
        self.method = method
        self.request = request
        self.fine = request.fine
        self.target = request.target
        self.clearance = clearance
        self.symmetry = method.symmetry
        self.importance = method.importance
        self.start = request.outline
        self.distance = HULL_OFFSET * request.outline.diameter
        self.stuck = np.zeros(0, dtype=np.int64)

    def begin(self) -> Stage[float, None]:
        """Prepare the outline that hulls are made of."""
        start, diameter = self.start, self.start.diameter
        if self.symmetry is None and self.importance is None:
            thinning = thinning_rounds(start, self.target, self.request.minimum, ROUGH_WEIGHTS)
            start = yield from mapped(thinning, lambda _: 0.0)
        start = without_gaps(start, CLOSED_GAP_WIDTH * diameter)
        self.start = self._alike(start)
        if self.importance is not None:
            with suppress(AsymmetricError):  # pins next to an axis hold the closest vertices that are there
                self.start = self._alike(self.importance.with_vertices(self.start))
        yield 0.0

    def with_clearance(self) -> Stage[float, list[Outline]]:
        """Hulls of an offset of the fine mesh that keeps the clearance; none if gaps are too narrow for an offset."""
        distance = max(self.distance, CLEARANCE_RESERVE * self.clearance)
        offset = offsetting(self.start, distance, self.fine.edge_tree)
        start, self.stuck = yield from mapped(offset, lambda _: 0.0)
        if len(self.stuck):
            return []
        yield 0.0
        search = search_hulls(
            self._alike(start),
            self.target,
            self.request.minimum,
            restarts=self.method.restarts,
            seed=self.method.seed,
            prepare=self._prepared,
            greedy=self._greedy,
        )
        return (yield from search)

    def without_small_details(self) -> Stage[float, list[Outline]]:
        """Hulls of the outline without features at round-off scale; none if there are none.

        See docs/ablation.md: details like round-off built over.
        """
        start = without_small_details(self.start, 0.0)
        if len(start.vertices) == len(self.start.vertices):
            return []
        self.start = start
        return (yield from self.with_clearance())

    def certified(self, hulls: Sequence[Outline]) -> Iterator[tuple[Mesh, Outline]]:
        """Meshes of the hulls that are small enough, distinct, and strictly enclose the fine mesh."""
        area = 0.0
        for hull in hulls:
            if len(hull.vertices) <= self.target and abs(hull.area - area) > SAME_AREA_TOLERANCE * abs(hull.area):
                area = hull.area
                try:
                    mesh = self._coarse(hull)
                except (InvalidMeshError, AsymmetricError):
                    continue
                if CLEARANCE_RESERVE * self.clearance > self.distance and self.symmetry is None:
                    mesh = self.request.with_room(mesh, self.clearance)
                if self.request.nests(mesh):
                    yield mesh, hull

    def rank(self, hull: Outline) -> tuple[int, float]:
        """Sort key: small enough first, then by area."""
        return max(self.target, len(hull.vertices)), hull.area

    def tightest(self) -> FloatArray:
        """The vertex closest to an edge that does not end in it."""
        starts, successor = self.start.vertices, self.start.successor
        vertex, edge = near_pairs(starts, starts, starts[successor], self.distance)
        apart = (vertex != edge) & (vertex != successor[edge])
        vertex, edge = vertex[apart], edge[apart]
        distance = point_edge(starts[vertex], starts[edge], starts[successor[edge]]).distance
        place: FloatArray = starts[vertex[distance.argmin()] if len(vertex) else 0]
        return place

    def unreachable(self, best: Outline) -> Fault:
        """The message for a count that even the smallest hull exceeds."""
        sizes = [best.sizes[k] for k in np.argsort(self.request.loop_order)]
        per_loop = f" ({', '.join(map(str, sizes))} for its loops)" if 1 < len(sizes) <= MAX_LOOPS_LISTED else ""
        smallest = len(best.vertices)
        return Fault(
            f"A level of {self.request.total} vertices is too small for this shape, whose loops block each other: "
            f"the smallest that was found has {smallest}{per_loop}; ask for at least {smallest}.",
            "count.too_small",
            total=self.request.total,
            least=smallest,
        )

    def _greedy(self, outline: Outline, weights: Weights, minimum: Sequence[int]) -> ProgressiveHull:
        if self.symmetry is None:
            if self.importance is None:
                return remembered_hull(outline, weights, minimum)
            return ProgressiveHull(outline, weights, minimum, self.importance)
        return SymmetricHull(outline, weights, minimum, self.importance, symmetry=self.symmetry)

    def _prepared(self, outline: Outline) -> Outline:
        """The outline at the clearance, where that leaves it symmetric; the tightening keeps the clearance anyway."""
        try:
            return self._alike(cleared(outline, self.fine, self.clearance))
        except AsymmetricError:
            return outline

    def _alike(self, outline: Outline) -> Outline:
        """The outline with the symmetry, if there is one. Raises AsymmetricError."""
        return outline if self.symmetry is None else symmetrised(outline, self.symmetry)

    def _coarse(self, hull: Outline) -> Mesh:
        if self.symmetry is None:
            return self.request.coarse(hull)
        return self.request.mesh(padded_alike(hull, self.request.total, self.symmetry))
