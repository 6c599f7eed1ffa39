"""Cages of regions that share borders: cut at the borders, so that they overlap as little as possible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import Fault, InvalidMeshError, NestedCagesError, invalid_file, note
from ..geometry.mesh import Mesh
from ..hierarchy import Settings, Within, nested_cages
from ..level.settings import DEFAULT_CLEARANCE
from ..libraries import load_shapely
from ..verification import verify
from .fill import united

NEEDED_FOR = "Reading regions that share borders"

STRIP = 1.0 + 1e-6
"""Width of the strips beyond borders, in clearances, with a margin for rounding."""

STRIP_MITRE_LIMIT = 4.0
"""Mitre limit of the strips' corners, in their widths."""

SHORE = 0.9
"""Tolerance of the simplified outlines of neighbours over what is added to them before, so that they stay inside."""


@dataclass(frozen=True, eq=False)
class Cut:
    """A cage after cutting."""

    cage: Mesh
    certified: bool
    """Whether it was cut and certified; False for a cage that is returned unchanged."""
    clearance: float
    """Measured smallest distance between the cage and what it encloses."""
    overlap_before: float
    """Area of the neighbours that the cage covered before."""
    overlap: float
    """Area of the neighbours that it covers now."""
    points_before: int = 0
    """Vertices of the cage before."""

    @property
    def note(self) -> Fault:
        """The outcome in words."""
        if not self.certified:
            return note("note.cut", on="failed")
        size, before, now = len(self.cage.vertices), self.overlap_before, self.overlap
        return note("note.cut", asked=self.points_before, given=size, covered=now, before=before)


def cut_at_borders(
    cages: Sequence[Mesh],
    regions: Sequence[Mesh],
    *,
    clearance: float | None = None,
    inner: Sequence[Mesh] | None = None,
    width: float | None = None,
) -> list[Cut]:
    """Cages without what they cover of the other regions, but for a strip as wide as the clearance.

    cages: one for each region. regions: may share borders, but not overlap. clearance: distance to keep from the
    region, 1e-5 of its diagonal unless given, and at most what the cage keeps. inner: what each cage has to enclose,
    the regions unless given; for the levels of a hierarchy, the cages of the level before, cut as well.

    width: distance within which cages simplify borders and the coasts of neighbours; default: not at all.

    Along a border a cage runs parallel to it, with all its points, or the fewest found within the width. Elsewhere it
    is exactly unchanged, and parts behind a neighbour are removed. Every cut cage is certified; one that cannot be is
    returned uncut.

    Raises NestedCagesError for bad arguments, or where shapely is missing.
    """
    inside = regions if inner is None else inner
    if not len(cages) == len(regions) == len(inside):
        raise invalid_file(f"There are {len(cages)} cages, but {len(regions)} regions; give one cage for each.")
    if clearance is not None and not 0.0 < clearance < np.inf:
        raise invalid_file(f"The clearance must be a positive length, not {clearance!r}.")
    shapely = load_shapely(NEEDED_FOR)
    shapes = [_shape(region) for region in regions]
    tree = shapely.STRtree(shapes)
    cuts = []
    for k, cage in enumerate(cages):
        others = [shapes[j] for j in tree.query(_shape(cage)) if j != k]
        least = clearance if clearance is not None else DEFAULT_CLEARANCE * regions[k].diagonal
        cuts.append(_cut(cage, inside[k], shapely.union_all(others), least, width))
    return cuts


def _cut(cage: Mesh, inner: Mesh, others: Any, least: float, width: float | None) -> Cut:
    """The cage of one region; others: the land of its neighbours; least: the clearance."""
    shapely = load_shapely(NEEDED_FOR)
    whole, core = _shape(cage), _shape(inner)
    before, points = shapely.intersection(whole, others).area, len(cage.vertices)
    measured = verify(cage, inner, same_loops=False).clearance
    uncut = Cut(cage, False, measured, before, before, points)
    if not measured > 0.0:  # not a cage
        return uncut
    least = min(least, measured)
    strip, taken = None, others
    if width is not None and before > 0.0:
        strip, taken = _simplified(inner, least, width), shapely.simplify(shapely.buffer(others, width), SHORE * width)
    if strip is None:
        strip = shapely.buffer(core, STRIP * least, join_style="mitre", mitre_limit=STRIP_MITRE_LIMIT)
    rest = shapely.difference(whole, shapely.difference(taken, strip))
    parts = [part for part in shapely.get_parts(rest) if part.intersects(core)]
    try:
        found = united(shapely, parts)
    except InvalidMeshError:
        return uncut
    certificate = verify(found, inner, least, same_loops=False)
    if not certificate:
        return uncut
    return Cut(found, True, certificate.clearance, before, shapely.intersection(_shape(found), others).area, points)


def _simplified(inner: Mesh, least: float, width: float) -> Any:
    """The shape of fewest points found that keeps these distances around a mesh; None if none was."""
    try:
        settings = Settings(clearance=STRIP * min(least, 0.5 * width))
        return _shape(nested_cages(inner, [Within(distance=width)], settings).cages[0])
    except NestedCagesError:
        return None


def _shape(mesh: Mesh) -> Any:
    return load_shapely(NEEDED_FOR).geometry.shape(mesh)
