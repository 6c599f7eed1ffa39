"""What speaks for and against one part hanging on another, and for a part being the root, in numbers.

None of them changes when the drawing is moved, turned or scaled, and but for names and groups none reads anything but
shapes and their order in the stack. Mirrored parts, and near and far ones, share their evidence but for names: they
hang alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import takewhile

import numpy as np
import scipy

from ...geometry.arrays import FloatArray
from ...geometry.vectors import norm
from ...libraries import load_shapely
from ..overlaps import Meeting, Meetings
from ..part import NEEDED_FOR, PuppetPart
from .names import NAMES, agreements, root_names, words_of
from .sides import alike_pairs, twins_of

CONTAINED, MOSTLY = 0.8, 0.7
"""A part lies in another one with at least this part of its area; it lies on one with at least that."""

WITHIN = (0.5, 0.9)
"""From which part of its area on another one a part is no longer its neighbour, and from which it is a detail of it."""

SLENDER = (1.2, 1.8)
"""Slenderness below which a part has no ends, and from which these count fully."""

NEAR_END, NEAR_SIDE, NEAR_PARENT_END = 0.25, 0.25, 0.35
"""An overlap is at an end or a side of a part up to this far from it, in lengths of the part."""

APART = 0.35
"""Width of a joint of parts that do not overlap, in halves of the length along which they nearly touch."""

LEAST_WIDTH = 0.03
"""Below this, in radii of the thinner part, joints are equally thin."""

LARGEST, SMALLEST, THICKEST = 4.0, 3.0, 2.0
"""Ratios of areas, up and down, and of radii count up to this; logarithms."""

LIKE_A_LIMB = 0.02
"""A part smaller than this is no limb of another one, in areas of that."""

AS_THICK = 0.9
"""Radius from which one part may carry another one, in those of that."""

SEEN = 0.9
"""Part of an overlap that parts in between may hide, if the two are to be neighbours."""

FAR_OFF = 1.2
"""Parts that no overlaps connect to the root are this much farther from it than all others."""

WAY = 4.0
"""A way to the root through the parts counts in quarters of the drawing's diagonal."""


class Evidence:
    """The evidence about all pairs of parts that meet."""

    def __init__(self, parts: Sequence[PuppetPart]) -> None:
        self.parts = parts
        self.meetings = Meetings(parts)
        self.near = self.meetings.near
        self.areas = np.array([part.outline.area for part in parts])
        self.radii = np.array([part.disc[1] for part in parts])
        self.words = [words_of(part.name) for part in parts]
        self.pairs = [(child, parent) for child in range(len(parts)) for parent in sorted(self.near[child])]
        """Child and parent, both ways, by child."""
        shapely = load_shapely(NEEDED_FOR)
        solids = [part.solid for part in parts]
        self._middles = shapely.get_coordinates(shapely.centroid(solids))
        bounds = shapely.total_bounds(solids)
        self.size = float(norm(bounds[2:] - bounds[:2]))
        self._off_centre = norm(self._middles - 0.5 * (bounds[:2] + bounds[2:])) / self.size
        self._slender = np.array([_ramp(part.slenderness, *SLENDER) for part in parts])

    def share(self, child: int, parent: int) -> float:
        """The part of a child's area that lies in its parent."""
        met = self.meetings.get(child, parent)
        return 0.0 if met is None else met.area / float(self.areas[child])

    # ---- the root

    def of_roots(self) -> dict[str, FloatArray]:
        """Columns (n,): how large, thick and central each part is, and what it meets."""
        count = len(self.parts)
        below, above = (
            np.log1p([sum(self._is_limb(q, k) and (q < k) is under for q in self.near[k]) for k in range(count)])
            for under in (True, False)
        )
        larger = [[self.share(k, q) for q in self.near[k] if self.areas[q] > self.areas[k]] for k in range(count)]
        return {
            "area": np.clip(np.log(self.areas / self.areas.max()), -SMALLEST, 0.0),
            "radius": np.clip(np.log(self.radii / self.radii.max()), -SMALLEST, 0.0),
            "meets": np.array([len(each) for each in self.near]) / count,
            "hidden": 1.0 - self._visible / self.areas,
            "off_centre": self._off_centre,
            "within": np.array([max(each, default=0.0) for each in larger]),
            "limbs": np.log1p(np.expm1(below) + np.expm1(above)),
            "between": np.minimum(below, above),
            "names": np.array(root_names(self.words)),
        }

    def _is_limb(self, limb: int, part: int) -> bool:
        return 0.0 < self.share(limb, part) < CONTAINED and bool(self.areas[limb] > LIKE_A_LIMB * self.areas[part])

    @cached_property
    def _visible(self) -> FloatArray:
        """(n,) area of each part that no part above it hides."""
        shapely = load_shapely(NEEDED_FOR)
        above = [shapely.union_all([self.parts[j].solid for j in near if j > k]) for k, near in enumerate(self.near)]
        return np.array(shapely.area(shapely.difference([part.solid for part in self.parts], above)))

    # ---- links

    def of_links(self, root: int) -> dict[str, FloatArray]:
        """Columns (M,) for each of `pairs`, if a part is the root."""
        way = self._ways(root)
        base = self._middles[root]
        found = {name: column.copy() for name, column in self._of_pairs.items()}
        child, parent = np.array(self.pairs, dtype=int).reshape(-1, 2).T
        free = self._free
        inward = norm(self._middles - base)[child] - norm(self._joints - base)
        lengths = np.array([norm(part.box[2] - part.box[0]) for part in self.parts])
        found["inward"] = np.clip(inward / lengths[child], -1.0, 1.0) * free
        found["way"] = np.clip(WAY * (way[child] - way[parent]) / self.size, -1.0, 1.0)
        found["on_root"] = (parent == root) * free
        twin = np.array(twins_of(self.parts, root))
        number = {pair: k for k, pair in enumerate(self.pairs)}
        other = [k if twin[c] == c else number.get((twin[c], twin[p]), k) for k, (c, p) in enumerate(self.pairs)]
        return {k: column if k in NAMES else 0.5 * (column + column[other]) for k, column in found.items()}

    def _ways(self, root: int) -> FloatArray:
        """(n,) lengths of the shortest ways to the root, from middle to joint to middle."""
        child, parent = np.array(self.pairs, dtype=int).reshape(-1, 2).T
        lengths = norm(self._middles[child] - self._joints) + norm(self._middles[parent] - self._joints)
        seen = self._hidden < SEEN
        graph = scipy.sparse.csr_array((lengths[seen], (child[seen], parent[seen])), shape=(len(self.parts),) * 2)
        way = scipy.sparse.csgraph.dijkstra(graph, directed=False, indices=root)
        return np.where(np.isfinite(way), way, FAR_OFF * way[np.isfinite(way)].max())

    @cached_property
    def _joints(self) -> FloatArray:
        """(M, 2) middles of the overlaps."""
        return np.array([self.meetings[pair].disc[0] for pair in self.pairs]).reshape(-1, 2)

    @cached_property
    def _hidden(self) -> FloatArray:
        """(M,) the part of each overlap that parts between the two hide."""
        shapely = load_shapely(NEEDED_FOR)
        found = []
        for one, other in self.pairs:
            met = self.meetings[one, other]
            both = set(self.near[one]) & set(self.near[other])
            between = [self.parts[q].solid for q in both if min(one, other) < q < max(one, other)]
            hidden = met.area and between and met.shared.intersection(shapely.union_all(between)).area / met.area
            found.append(float(hidden or 0.0))
        return np.array(found)

    @cached_property
    def _free(self) -> FloatArray:
        """(M,) 1 for a child next to its parent, 0 for one that lies in it."""
        return np.array([1.0 - _ramp(self.share(*pair), *WITHIN) for pair in self.pairs])

    @cached_property
    def _of_pairs(self) -> dict[str, FloatArray]:
        rows = [self._of_pair(*pair) for pair in self.pairs]
        found = {name: np.array([row[name] for row in rows]) for name in (rows[0] if rows else ())}
        found |= {name: np.array(column) for name, column in agreements(self.words, self.pairs).items()}
        alike = {frozenset(pair) for pair in alike_pairs(self.parts)}
        same = np.array([float(frozenset(pair) in alike) for pair in self.pairs])
        return found | {"hidden": self._hidden * self._free, "alike": same}

    def _of_pair(self, child: int, parent: int) -> dict[str, float]:
        """What does not depend on the root."""
        part, met = self.parts[child], self.meetings[child, parent]
        share = self.share(child, parent)
        within = _ramp(share, *WITHIN)
        free = 1.0 - within
        larger = float(np.log(self.areas[parent] / self.areas[child]))
        thicker = float(np.clip(np.log(self.radii[parent] / self.radii[child]), -THICKEST, THICKEST))
        at_end = self._slender[child] * _at_end(met, part, NEAR_END)
        at_parent_end = self._slender[parent] * _middle_at_end(met, self.parts[parent])
        at_side = (1.0 - self._slender[child]) * _at_end(met, part, NEAR_SIDE, across=True)
        thinner = min(self.radii[child], self.radii[parent])
        width = (met.disc[1] if met.area > 0.0 else APART * 0.5 * met.length) / thinner
        over = sum(self.share(child, q) >= MOSTLY for q in range(parent + 1, child))
        return {
            "touches": float(met.area == 0.0),
            "share": share,
            "holds_parent": _ramp(self.share(parent, child), *WITHIN),
            "smaller": float(np.clip(larger, -SMALLEST, 0.0)),
            "larger_than_detail": float(np.clip(larger, 0.0, LARGEST)) * within,
            "snug": float(np.log(np.clip(width, LEAST_WIDTH, 1.0))) * free,
            "at_side": at_side * free,
            "at_parent_end": at_parent_end * free,
            "chain": at_end * at_parent_end * float(np.exp(-abs(thicker))),
            "group": _common(part.groups, self.parts[parent].groups),
            "detail_above": float(parent < child) * within,
            "layers_below_detail": float(np.log1p(over)) * within,
            "layers": float(np.log1p(abs(child - parent))) * free,
            "thicker": thicker * free,
            "thicker_than_detail": thicker * within,
            "through_between": self._through(child, parent, only_between=True),
            "through": self._through(child, parent, only_between=False),
        }

    def _through(self, child: int, parent: int, *, only_between: bool) -> float:
        """How well the child would hang on another part that lies on the parent: a thigh on hips before a cape."""
        best = 0.0
        for q in self.near[child]:
            if q == parent or self.share(q, parent) == 0.0 or self.meetings[child, q].area == 0.0:
                continue
            if only_between:
                is_able = min(child, parent) < q < max(child, parent)
            else:
                is_able = self.radii[q] > AS_THICK * self.radii[child] and self.areas[q] < self.areas[parent]
            if is_able:
                thinner = min(self.radii[child], self.radii[q])
                fits = min(1.0, self.meetings[child, q].disc[1] / thinner) * self.share(q, parent)
                best = max(best, fits if only_between else fits * (1.0 - self.share(child, q)))
        return float(best)


def _ramp(value: float, low: float, high: float) -> float:
    """0 up to one value, 1 from another one on."""
    return float(np.clip((value - low) / (high - low), 0.0, 1.0))


def _at_end(met: Meeting, part: PuppetPart, reach: float, *, across: bool = False) -> float:
    """1 for an overlap at an end of a part, 0 for one farther than `reach` from both."""
    low, high = met.span(part, across=across)
    return 1.0 - _ramp(min(low, 1.0 - high), 0.0, reach)


def _middle_at_end(met: Meeting, part: PuppetPart) -> float:
    """The same for the middle of the overlap."""
    middle = 0.5 * sum(met.span(part))
    return 1.0 - _ramp(min(middle, 1.0 - middle), 0.0, NEAR_PARENT_END)


def _common(groups: Sequence[str], others: Sequence[str]) -> float:
    """The part of some groups, one in the other, that others are too."""
    same = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(groups, others, strict=False)))
    return same / len(groups) if groups else 0.0
