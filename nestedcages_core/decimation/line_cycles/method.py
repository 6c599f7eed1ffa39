"""Line cycles: the lines around the loops that enclose them with the least area.

A cage is a cycle of directed lines with the solid on their left. The area between it and the outline is a sum over
pairs of consecutive lines: of the region between the path from the contact of one line, by their vertex, to the contact
of the next, and the outline between these contacts. So dynamic programming finds the best cycles of 3, 4, … lines among
candidates, and the best number of lines for each loop. Where edges that are not neighbours cross, one of them gives
way, and the search is repeated.

See docs/ablation.md: line cycles; the curve.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ...errors import NestingError
from ...geometry.arrays import FloatArray
from ...geometry.loops import Loops
from ...geometry.mesh import Mesh
from ...geometry.precision import ROUND_OFF
from ...parameters import check_flag, check_side
from ...tasks import Stage, drain, mapped
from ..alike import AsymmetricError, symmetrised
from ..base import NOTHING_KEPT, Count, Kept, Start
from ..hull.narrow_gaps import HULL_OFFSET, is_narrow, without_gaps
from ..hull.outer_hull import OuterHull, source_of
from ..on_curve import closest_on_curve
from ..request import Request
from .around import PLACES_PER_VERTEX, Around
from .loop_search import BAND, NoCyclesError
from .places import ALL_VERTICES

SOURCE = "line cycles"
"""Name of its meshes in reports."""

EXACT_SHIFT = 1e-7
"""Distance, in diameters, of lines from the strict offset, to which they belong in narrow gaps."""

MOST_LINES = 320
"""Vertices of the largest loop's cage up to which cycles are sought: the hull is looser by about a twentieth there, and
around 2,000 vertices takes half the time."""

MOST_LOOPS = 96
"""Number of loops up to which cycles are sought, some 6 ms each; for more the hull takes an eighth of the time, and its
excess is larger by a twentieth."""

BIASES = (1.0, 1e9, 0.3)
"""Rules for which of two crossing edges is shortened; the best result is kept (docs/ablation.md: line cycles: ways to
clear crossings)."""

MAX_EXCESS_OF_SYMMETRY = 0.008
"""Fraction of the area beyond the outline that a preferred symmetry may cost."""

MAX_EXCESS_ON_CURVE = 1.0
"""Excess above which a mesh on the curve would cut most of the shape off, so that no flow gets it inside."""


@dataclass(frozen=True)
class LineCycles:
    """The lines of least area around each loop, with the vertices distributed over the loops in the best way."""

    on_curve: bool = True
    """Whether the start comes with a mesh on the fine one, from which the flow leads to a cage."""
    side: int = 1
    """1 for meshes around the fine one, -1 for meshes inside it."""

    def __post_init__(self) -> None:
        check_flag(self, "on_curve")
        check_side(self)

    @property
    def outside(self) -> LineCycles:
        """The same without meshes on the curve."""
        return replace(self, on_curve=False)

    @property
    def inside(self) -> LineCycles:
        """The same for meshes inside the fine one."""
        return replace(self, on_curve=False, side=-1)

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A mesh that strictly encloses the fine one, by exact predicates; see `starts`."""
        return drain(self.starts(fine, count, clearance=clearance))[0].coarse

    def starts(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Stage[float, list[Start]]:
        """See `starts_keeping`."""
        return (yield from self.starts_keeping(fine, count, NOTHING_KEPT, clearance=clearance))

    def starts_keeping(
        self, fine: Mesh, count: Count, kept: Kept, *, clearance: float = 0.0
    ) -> Stage[float, list[Start]]:
        """One mesh that strictly encloses the fine one, by exact predicates; or some inside it, the last one a hull.

        count: total number of vertices, or one per loop of the fine mesh. clearance: distance to keep from the fine
        mesh where there is space, in input units. Loop k of the mesh belongs to loop k of the fine mesh.

        A generator: yields the fraction done and returns the list. Raises NestingError where no cycles are found;
        then there may be an outer hull.
        """
        request = Request.of(fine, count, self.side, kept)
        if self.side < 0:
            return (yield from _inside(request, count, clearance))
        mesh, source = yield from _found(request, clearance)
        near = self.on_curve and mesh.area <= (1.0 + MAX_EXCESS_ON_CURVE) * fine.area
        return [Start(mesh, source, closest_on_curve(mesh, fine, kept.symmetry or kept.preferred) if near else None)]

    def fewest(self, fine: Mesh, most: int, area: float) -> Stage[float, int | None]:
        """About how many vertices a mesh of at most an area around the fine one needs; None if more than so many."""
        request = Request.of(fine, most)
        outline = without_gaps(request.outline, ROUND_OFF * request.outline.diameter)
        try:
            return (yield from Around(request, outline, HULL_OFFSET).fewest(area))
        except NoCyclesError:
            return None


def _inside(request: Request, count: Count, clearance: float) -> Stage[float, list[Start]]:
    """Meshes strictly inside the fine one: of cycles in what surrounds them, and a hull."""
    starts: list[Start] = []
    with suppress(NoCyclesError):
        starts = [Start(*(yield from _found(request, clearance)))]
    try:
        starts += yield from OuterHull(side=-1).starts(request.fine, count, clearance=clearance)
    except NestingError:
        if not starts:
            raise
    return starts


def _found(request: Request, clearance: float) -> Stage[float, tuple[Mesh, str]]:
    """The mesh of the best cycles and its source; of the hull where it is smaller, or counts are large."""
    kept = request.kept
    largest = request.target * max(request.outline.sizes) / sum(request.outline.sizes)
    if kept.is_free and (largest > MOST_LINES or len(request.outline.sizes) > MOST_LOOPS):
        return (yield from OuterHull().hull(request, clearance)), source_of(request.side)
    try:
        mesh, rounds = yield from cycles_around(request, clearance)
    except NoCyclesError:
        if not kept.rules:
            raise
        loose = replace(request, kept=replace(kept, rules=()))  # to be moved later
        mesh, rounds = yield from cycles_around(loose, clearance)
    # where each vertex is a place, the hull leaves as few out and takes little time; small searches leave nothing out
    all_places = len(request.outline.vertices) <= ALL_VERTICES * PLACES_PER_VERTEX * request.target
    if kept.is_free and (rounds or (all_places and request.target > 2 * BAND)):
        with suppress(NestingError):
            hull = yield from OuterHull().hull(request, clearance)
            if request.side * hull.area < request.side * mesh.area:
                return hull, source_of(request.side)
    return mesh, SOURCE


def cycles_around(request: Request, clearance: float) -> Stage[float, tuple[Mesh, int]]:
    """The mesh of the best cycles, and how often crossings were cleared. Raises NestingError."""
    kept = request.kept
    outline = symmetrised(without_gaps(request.outline, ROUND_OFF * request.outline.diameter), kept.symmetry)
    if kept.importance is not None:
        with suppress(AsymmetricError):  # pins next to an axis hold the closest vertices that are there
            outline = symmetrised(kept.importance.with_vertices(outline), kept.symmetry)
    # lines next to the outline itself, all of a loop moved away by the same distance
    wanted = clearance / outline.diameter
    shift = np.full(len(outline.sizes), max(HULL_OFFSET, wanted))
    for rule in kept.rules:
        of_loops = rule.distances(request.fine)
        if of_loops is not None:
            shift = np.maximum(shift, of_loops[request.loop_order] / outline.diameter)
    while True:
        far = np.flatnonzero(shift > HULL_OFFSET)
        try:
            if len(far) == 0 and is_narrow(outline, request.regions, 2.0 * HULL_OFFSET * outline.diameter):
                raise NoCyclesError("Gaps are too narrow for such lines.", code="count.too_small")
            mesh, rounds = yield from _best(request, outline, shift)
            break
        except NoCyclesError as error:
            if len(far):  # the tightening may find the room
                blocked = np.intersect1d(error.blocked, far)
                shift[blocked if len(blocked) else far] = HULL_OFFSET
                continue
            if "total" in error.data:  # more lines are needed, whatever they are next to
                raise
            mesh, rounds = yield from _next_to_offset(request, outline, clearance)
            break
    if wanted > HULL_OFFSET and not kept.symmetry:
        mesh = request.with_room(mesh, clearance)
    return mesh, rounds


def _next_to_offset(request: Request, outline: Loops, clearance: float) -> Stage[float, tuple[Mesh, int]]:
    """`cycles_around` with lines next to the strict offset, in which gaps are narrow or filled."""
    from ..hull.offset import (
        cleared,  # few outlines need an offset
        offsetting,
    )

    symmetry = request.kept.symmetry
    distance, tree = HULL_OFFSET * outline.diameter, request.fine.edge_tree
    offset, stuck = yield from mapped(offsetting(outline, distance, tree), lambda _: 0.0)
    if len(stuck):
        raise NoCyclesError("Gaps are too narrow for an offset.", code="count.too_small")
    outline = symmetrised(cleared(symmetrised(offset, symmetry), request.fine, clearance), symmetry)
    return (yield from _best(request, outline, EXACT_SHIFT))


def _best(request: Request, outline: Loops, shift: FloatArray | float) -> Stage[float, tuple[Mesh, int]]:
    """The mesh of least area of several ways to clear crossings, and how often. Raises NoCyclesError."""
    best: tuple[float, Mesh] | None = None
    error: NoCyclesError | None = None
    around = Around(request, outline, shift)
    for bias in BIASES:
        try:
            area, mesh = yield from around.run(bias)
        except NoCyclesError as failure:
            error = failure
        else:
            if best is None or area < best[0]:
                best = area, mesh
        if around.rounds == 0:
            break
    if best is None:
        assert error is not None
        raise error
    if request.kept.preferred is not None and request.per_loop is None:
        from .preferred import symmetric_mesh

        most = outline.area + (1.0 + MAX_EXCESS_OF_SYMMETRY) * (best[0] - outline.area)
        alike = yield from symmetric_mesh(request, outline, shift, most)
        if alike is not None:
            return alike, 0
    return best[1], around.rounds
