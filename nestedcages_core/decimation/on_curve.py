"""On the curve: an outer hull with each vertex put back onto the part of the fine mesh that it replaces.

See docs/ablation.md: places on the curve by the hull; the curve.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..errors import InvalidMeshError, NestingError
from ..geometry.broad_phase import position_in_group
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh
from ..geometry.orbits import Orbits
from ..geometry.signed_distance import EdgeSearch
from ..tasks import Stage, drain
from .asymmetry import SYMMETRY_TOLERANCE, AsymmetricError
from .base import Count, Start
from .hull.outer_hull import SOURCE, OuterHull
from .outline import Outline
from .request import Request


@dataclass(frozen=True)
class OnCurve:
    """Vertices on the fine mesh, distributed over its loops like those of the outer hull: more at features."""

    hull: OuterHull = field(default_factory=OuterHull)
    """The search whose best hull is used."""

    def __post_init__(self) -> None:
        if not isinstance(self.hull, OuterHull):
            raise NestingError(f"OnCurve: hull must be an OuterHull, not {self.hull!r}.", code="setting.invalid")

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh whose vertices lie on the fine one, whatever the clearance; loop k on loop k.

        Where its loops would cross, they are resampled by `ArcLength` instead. Raises NestingError as that does.
        """
        start = drain(self.starts(fine, count, clearance=clearance, most=1))[0]
        if start.makeshift_for is not None:
            return start.coarse
        from .choices.arc_length import ArcLength

        return start.on_curve or ArcLength().decimate(fine, count, clearance=clearance)

    def starts(self, fine: Mesh, count: Count, *, clearance: float = 0.0, most: int = 3) -> Stage[float, list[Start]]:
        """Up to `most` outer hulls, least area first, the first one with its mesh on the curve.

        A generator: yields the fraction done and returns the list; without any hull, one mesh by arc length.
        """
        request = Request.of(fine, count)
        try:
            hulls = yield from self.hull.hulls(request, clearance, most)
        except NestingError as error:
            try:
                from .choices.arc_length import ArcLength

                coarse = ArcLength().decimate(fine, count, clearance=clearance)
            except NestingError:
                raise error from None
            return [Start(coarse, "arc length", makeshift_for=error)]
        symmetry = self.hull.symmetry
        (best, hull), *others = hulls
        return [
            Start(best, SOURCE, _put_on_curve(hull, request, symmetry)),
            *(Start(mesh, SOURCE) for mesh, _ in others),
        ]


def closest_on_curve(cage: Mesh, fine: Mesh, symmetry: Symmetry | None = None) -> Mesh | None:
    """The cage with its vertices moved to the closest points of the fine mesh, loop k to loop k.

    symmetry: of both meshes. None where the result crosses itself. Flow and reinflation lead from it to nearly the same
    cage.
    """
    places = np.empty_like(cage.vertices)
    for own, other in zip(cage.loops, fine.loops, strict=True):
        starts, ends = fine.vertices[other], fine.vertices[fine.successor[other]]
        found = EdgeSearch(starts, ends).closest(cage.vertices[own])
        start = starts[found.edge]
        places[own] = start + found.parameter[:, None] * (ends[found.edge] - start)
    if symmetry is not None:
        orbits = Orbits.of(cage.vertices, cage.successor, symmetry, SYMMETRY_TOLERANCE * cage.diagonal)
        if orbits is None:
            return None
        places = orbits.symmetrised(places)
    try:
        coarse = Mesh.from_loops([places[own] for own in cage.loops])
    except InvalidMeshError:
        return None
    same = (coarse.loop_signs == fine.loop_signs).all() and (coarse.component_of_loop == fine.component_of_loop).all()
    return coarse if same else None


def _put_on_curve(hull: Outline, request: Request, symmetry: Symmetry | None) -> Mesh | None:
    """The coarse mesh of a hull with its vertices on the fine mesh; None where that crosses itself."""
    snapped = _snapped(hull, request.outline)
    try:
        if symmetry is None:
            return request.same_roles(request.coarse(snapped))
        from .hull.symmetric_hull import orbits_of, padded_alike

        snapped = hull.moved(orbits_of(hull, symmetry).symmetrised(snapped.vertices))
        return request.same_roles(request.mesh(padded_alike(snapped, request.total, symmetry)))
    except (InvalidMeshError, AsymmetricError):
        return None


def _snapped(hull: Outline, outline: Outline) -> Outline:
    """A hull with each vertex at the closest point of the stretch of the outline that it replaces.

    Stretches are disjoint and in order, so the points are.
    """
    of_loop = np.repeat(np.arange(len(hull.sizes)), hull.sizes)
    begin, size = outline.begins[of_loop], np.array(outline.sizes)[of_loop]
    first, last = hull.spans.T
    edges = (last - first) % size
    candidates = np.maximum(edges, 1)
    vertex = np.repeat(np.arange(len(edges)), candidates)
    edge = begin[vertex] + (first[vertex] + position_in_group(candidates)) % size[vertex]
    search = EdgeSearch(outline.vertices, outline.vertices.take(outline.successor, axis=0))
    nearest = search.among(hull.vertices, vertex, edge)
    parameter = np.where(edges > 0, nearest.parameter, 0.0)[:, None]
    starts, ends = search.starts.take(nearest.edge, axis=0), search.ends.take(nearest.edge, axis=0)
    return hull.moved(starts + parameter * (ends - starts))
