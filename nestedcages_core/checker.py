"""An independent check of cages and of their motions: it uses nothing of this package but `checker_distance`.

It reads coordinates and edges, never a certificate. Coordinates are fractions whose denominators are powers of two:
multiplied by the largest of these they are whole numbers, which Python does not round. Boxes are compared as floats,
exactly too. Lengths have roots and turns have cosines: these are held against exact bounds that differ by `TOLERANCE`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np

from .checker_distance import dot_cross, farther_than, squared_gaps, whole_numbers

TOLERANCE = Fraction(1, 10**9)
"""Relative error of a clearance, a distance or an image that is accepted."""
BLOCK = 2_000_000
"""Number of pairs compared at once; bounds the memory."""


@dataclass(frozen=True)
class Verdict:
    """What is wrong, a sentence each; true if nothing is. And which loops have none of their own in a cage."""

    problems: tuple[str, ...]
    lost: tuple[str, ...] = ()
    """Holes that are filled, and loops that share one, a sentence each."""

    def __bool__(self) -> bool:
        return not self.problems


def check(
    fine: Any,
    cage_or_levels: Any,
    clearance: float | None = None,
    *,
    same_loops: bool | Sequence[bool] | None = None,
    inside: bool = False,
    grid: float | None = None,
    symmetry: Any = None,
    distance: float | None = None,
    motions: int | None = None,
) -> Verdict:
    """Check cages, or the levels of a hierarchy, from their numbers alone.

    Parameters
    ----------
    fine : Any
        The drawing: an object with vertices (n, 2) and directed edges (n, 2), rings of points (k, 2), or a GeoJSON
        geometry. For moving cages its edges count; its vertices are then those at their keys.
    cage_or_levels : Any
        A cage, several from the finest to the coarsest, a hierarchy or moving cages.
    clearance : float, optional
        Smallest distance, in input units. Default: what a level was asked for, else anything above 0.
    same_loops : bool or sequence of bool, optional
        Whether cages, or each of them, keep the loops of what they enclose. Where they need not, it must lie in them
        all the same, and `Verdict.lost` names filled holes and joined loops. Default: yes, unless a level's coarse mesh
        did not or a moving cage has other loops.
    inside : bool, optional
        Whether these are inner cages.
    grid : float, optional
        Coordinates are multiples of this length. Default: the level's.
    symmetry : Mirror or Rotation, optional
        What cages are mapped onto themselves by; without a place, about the mean of the cage's vertices.
    distance : float, optional
        No point of a cage's solid is farther from the solid of ``fine``, in input units.
    motions : int, optional
        Number of motions between steps to check per level, spread evenly. Default: all.

    Returns
    -------
    Verdict
        True if nothing is wrong.

    Examples
    --------
    >>> from nestedcages_core import check
    >>> bool(check([(2, 1), (6, 1), (4, 5)], [(-1, -1), (9, -1), (4, 9)], clearance=0.5))
    True
    """
    given = getattr(cage_or_levels, "levels", cage_or_levels)
    problems, lost, levels = [], list[str](), list(given) if _depth(given) > 3 else [given]
    if levels and len(getattr(levels[0], "fine_steps", ())) and hasattr(fine, "edges"):
        fine = SimpleNamespace(vertices=levels[0].fine_steps[0], edges=fine.edges)
    within = fine
    for k, level in enumerate(levels):
        cage, report, inner = getattr(level, "cage", level), getattr(level, "report", None), inside
        asked = alike = same_loops[k] if isinstance(same_loops, Sequence) else same_loops
        wanted = getattr(report, "wanted_clearance", 0.0) if clearance is None else clearance
        if hasattr(level, "coarse"):
            inner, loops = level.inside, [sorted(Loops(mesh).is_hole) for mesh in (level.coarse, level.fine)]
            alike = loops[0] == loops[1] if asked is None else asked
        elif hasattr(level, "cage_steps") and asked is None:
            with suppress(ValueError):  # what is no shape is reported below
                alike = sorted(Loops(cage).is_hole) == sorted(Loops(within).is_hole)
        found = faults_of_cage(*((within, cage) if inner else (cage, within)), wanted, alike is not False)
        if not found:
            lost += Loops(cage, within).lost() if alike is False and not inner else []
            found += faults_of_needs(cage, grid, symmetry, report)
            both = Loops(*((fine, cage) if inner else (cage, fine)))
            found += farther_than(distance, both.x, both.after, both.is_fine, TOLERANCE) if distance else []
            found += faults_of_steps(within, level, wanted, alike, motions) if hasattr(level, "cage") else []
        problems += [f"level {k + 1}: {fault}" if len(levels) > 1 else fault for fault in found]
        within = cage
    return Verdict(tuple(problems) if levels else ("there is no cage",), tuple(lost))


def faults_of_steps(fine: Any, level: Any, clearance: float, alike: bool | None, motions: int | None) -> list[str]:
    """What is wrong with the steps of a level, or with a moving cage, which is checked at each of its keys."""
    way, cage, drawing = getattr(level, "reinflation", level), level.cage, getattr(level, "fine", fine)
    steps, home = [np.asarray(way.cage_steps), np.asarray(way.fine_steps)], 0 if way is level else -1
    both = Loops(SimpleNamespace(vertices=steps[1][home], edges=drawing.edges)), Loops(fine)
    ends = [{*zip(*loops.x.T.tolist(), *loops.x[loops.after].T.tolist(), strict=True)} for loops in both]
    found = [] if ends[0] == ends[1] else ["the fine mesh is not back at its coordinates"]
    found += [] if np.array_equal(steps[0][home], cage.vertices) else ["the steps do not lead to the cage"]
    for k, (x, y) in enumerate(zip(*steps, strict=True)) if way is level else ():
        outer, inner = (SimpleNamespace(vertices=z, edges=mesh.edges) for z, mesh in ((x, cage), (y, drawing)))
        found += [f"at key {k}, {fault}" for fault in faults_of_cage(outer, inner, clearance, alike is not False)]
    last = len(steps[0]) - 1
    chosen = range(last) if motions is None else sorted({k * last // motions for k in range(motions)} & {*range(last)})
    return found + faults_of_motion(cage.edges, drawing.edges, steps[0], steps[1], chosen)


def _depth(given: Any) -> int:
    """2 for a ring of points, 3 for a shape, 4 for several."""
    if isinstance(given, Mapping) or any(hasattr(given, name) for name in ("vertices", "cage", "__geo_interface__")):
        return 3
    return 0 if not hasattr(given, "__len__") or isinstance(given, str) else 1 + _depth(given[0]) if len(given) else 4


def rings_of(shape: Any) -> list[Any]:
    """The loops (k, 2) of a shape; without edges, turned so that the solid is on their left. Raises ValueError."""
    shape = getattr(shape, "__geo_interface__", shape) if not hasattr(shape, "vertices") else shape
    if hasattr(shape, "vertices"):
        vertices, edges, rings = np.asarray(shape.vertices, float), np.asarray(shape.edges).tolist(), []
        if not edges or any(sorted(ends) != [*range(len(vertices))] for ends in zip(*edges, strict=True)):
            raise ValueError("some vertex is not the start of one edge and the end of one")
        after = dict(edges)
        while after:
            loop = [next(iter(after))]
            while (following := after.pop(loop[-1])) != loop[0]:
                loop.append(following)
            rings.append(vertices[loop])
        return rings
    if isinstance(shape, Mapping):
        polygons = shape["coordinates"] if shape["type"] == "MultiPolygon" else [shape["coordinates"]]
        shape = [ring for polygon in polygons for ring in polygon]
    if _depth(shape) not in (2, 3):
        raise ValueError("a shape is a mesh, rings of points (x, y), or a Polygon or MultiPolygon of GeoJSON")
    rings = [np.array([p[:2] for p in ring], float) for ring in ([shape] if _depth(shape) == 2 else shape)]
    rings = [ring[:-1] if (ring[0] == ring[-1]).all() else ring for ring in rings]
    x = np.concatenate(rings)
    whole = whole_numbers(x)[0]
    loops, after = consecutive([len(ring) for ring in rings])
    is_hole = (turns_around(x, whole, after, loops) != 0).sum(axis=1) % 2 == 1
    areas = dot_cross(whole, whole[after])[1]
    return [ring if (areas[loop].sum() < 0) == hole else ring[::-1]
            for ring, loop, hole in zip(rings, loops, is_hole, strict=True)]  # fmt: skip


def consecutive(lengths: list[int]) -> tuple[list[Any], Any]:
    """The vertices of each of some loops, one loop after the other, and the vertex after each."""
    loops = np.split(np.arange(sum(lengths)), np.cumsum(lengths)[:-1])
    return loops, np.concatenate([np.roll(loop, -1) for loop in loops])


def turns_around(x: Any, whole: Any, after: Any, loops: list[Any]) -> Any:
    """(L, L) how often around the first vertex of each loop, which is on no other, each other one runs.

    x, whole: vertices (n, 2) and the same in whole numbers. Edges that cross the ray to the right are counted.
    """
    found, of = np.zeros((len(loops), len(loops)), int), np.repeat(np.arange(len(loops)), [len(loop) for loop in loops])
    first, (left, right) = np.array([loop[0] for loop in loops]), np.sort([x[:, 0], x[after, 0]], axis=0)
    for part in np.array_split(np.arange(len(loops)), 1 + len(loops) * len(x) // BLOCK):
        at_x, at_y = x[first[part], :, None].transpose(1, 0, 2)
        begins_below, ends_below = x[:, 1] <= at_y, x[after, 1] <= at_y
        k, e = np.nonzero((begins_below != ends_below) & (right >= at_x) & (of != part[:, None]))
        up, beyond = begins_below[k, e], left[e] > at_x[k, 0]
        near = np.flatnonzero(~beyond)
        a, b, p = whole[e[near]], whole[after[e[near]]], whole[first[part[k[near]]]]
        beyond[near] = (dot_cross(b - a, p - a)[1] > 0) == up[near]
        np.add.at(found, (part[k], of[e]), np.where(up, 1, -1) * beyond)
    return found


def overlapping(low: Any, high: Any, other_low: Any, other_high: Any) -> Any:
    """(2, K) pairs of boxes that share a point, in order: found by the squares of a grid for each size of boxes."""
    found, boxes, others = [np.zeros((2, 0), int)], (low, high), (other_low, other_high)
    least = np.abs(np.concatenate([*boxes, *others])).max(initial=0.0) * 2.0**-40
    size, other = (np.frexp(np.maximum((b - a).max(axis=1), least))[1] for a, b in (boxes, others))
    for power in np.unique(np.concatenate([size, other])):
        few, many = np.flatnonzero(other == power), np.flatnonzero(size <= power)
        found += [np.stack(pair) for pair in _sharing(many, boxes, few, others, power)]
        few, many = np.flatnonzero(size == power), np.flatnonzero(other < power)
        found += [np.stack(pair[::-1]) for pair in _sharing(many, others, few, boxes, power)]
    pairs = np.concatenate(found, axis=1)
    return pairs[:, np.lexsort(pairs[::-1])]


def _sharing(i: Any, boxes: Any, j: Any, others: Any, power: int) -> Iterator[tuple[Any, Any]]:
    """Pairs of some boxes and of some others that share a point; all fit in squares of a grid, 2 to a power wide."""
    (i, squares), (j, other_squares) = _squares(i, boxes, power), _squares(j, others, power)
    order = other_squares.argsort()
    first, last = (other_squares[order].searchsorted(squares, side) for side in ("left", "right"))
    count = last - first
    for part in np.array_split(np.arange(len(i)), 1 + int(count.sum()) // BLOCK):
        k = np.repeat(part, count[part])
        m = order[np.arange(len(k)) - np.repeat(np.cumsum(count[part]) - count[part] - first[part], count[part])]
        low, high = np.maximum(boxes[0][i[k]], others[0][j[m]]), np.minimum(boxes[1][i[k]], others[1][j[m]])
        corner = np.floor(np.ldexp(low, -power)) @ [1.0, 1j]  # each pair once: where what both share begins
        shared = (low <= high).all(axis=1) & (corner == squares[k])
        yield i[k[shared]], j[m[shared]]


def _squares(k: Any, boxes: Any, power: int) -> tuple[Any, Any]:
    """Some boxes, and each square of a grid that one of them meets, as a complex number."""
    low, high = (np.floor(np.ldexp(ends[k], -power)) for ends in boxes)
    corners = [(np.stack([x[:, 0], y[:, 1]], axis=1) @ [1.0, 1j]) for x in (low, high) for y in (low, high)]
    wide, tall = (high > low).T
    met = [np.full(len(k), True), tall, wide, wide & tall]
    return np.concatenate([k[m] for m in met]), np.concatenate([c[m] for c, m in zip(corners, met, strict=True)])


class Loops:
    """The closed loops of a shape, or of a cage and of what it encloses, one after the other."""

    def __init__(self, *shapes: Any) -> None:
        read = [(ring, k) for k, shape in enumerate(shapes) for ring in rings_of(shape)]
        self.x, lengths = np.concatenate([ring for ring, _ in read]), [len(ring) for ring, _ in read]
        self.loops, self.after = consecutive(lengths)
        self.loop_is_fine = np.array([k == 1 for _, k in read])
        self.is_fine = np.repeat(self.loop_is_fine, lengths)
        self.whole, self.factor = whole_numbers(self.x)
        doubled_areas = dot_cross(self.whole, self.whole[self.after])[1]
        self.is_hole = [doubled_areas[loop].sum() <= 0 for loop in self.loops]
        self.low, self.high = (f(self.x, self.x[self.after]) for f in (np.minimum, np.maximum))

    def near(self, k: int) -> str:
        return f"the {'fine mesh' if self.is_fine[k] else 'cage'} near ({self.x[k, 0]:.9g}, {self.x[k, 1]:.9g})"

    def contacts(self, *, between: bool = False) -> list[str]:
        """Edges that meet, apart from neighbours in their common vertex; between: only those of different shapes."""
        i, j = overlapping(self.low, self.high, self.low, self.high)
        apart = (i < j) & (self.after[i] != j) & (self.after[j] != i)
        apart &= (self.is_fine[i] != self.is_fine[j]) | (not between)
        i, j = i[apart], j[apart]
        ab, cd = (np.stack([self.whole[k], self.whole[self.after[k]]]) for k in (i, j))
        one, other = (np.sign(dot_cross(u[1] - u[0], v - u[0])[1]) for u, v in ((ab, cd), (cd, ab)))
        meet = (one[0] * one[1] <= 0) & (other[0] * other[1] <= 0)
        into = self.whole[self.after] - self.whole
        onwards, turn = dot_cross(into, into[self.after])
        found = [f"{self.near(p)} meets {self.near(q)}" for p, q in zip(i[meet], j[meet], strict=True)]
        folded = self.after[(turn == 0) & (onwards <= 0) & (not between)]
        return found + [f"{self.near(k)} folds back or stands still" for k in folded]

    @cached_property
    def turns(self) -> Any:
        """(L, L) how often each loop is inside of each other one, by its first vertex."""
        return turns_around(self.x, self.whole, self.after, self.loops)

    @property
    def parents(self) -> list[int]:
        """The smallest loop around each one, -1 for none."""
        depth = (self.turns != 0).sum(axis=1)
        return [max(np.flatnonzero(row).tolist(), key=depth.__getitem__, default=-1) for row in self.turns]

    def lost(self) -> list[str]:
        """Holes of the fine mesh that a cage around it fills, and loops that share one of the cage."""
        parent, names = self.parents, [self.near(loop[0]) for loop in self.loops]
        fine, hole = np.flatnonzero(self.loop_is_fine).tolist(), self.is_hole
        kept = {p for k, p in enumerate(parent) if not self.loop_is_fine[k] and hole[k]}
        filled, groups = [k for k in fine if hole[k] and k not in kept], dict[int, list[int]]()
        filled = [k for k in filled if not self.turns[k, filled].any()]  # what lies in a filled hole is not named
        for k in (k for k in fine if not hole[k] and not self.turns[k, filled].any()):
            groups.setdefault(parent[k], [parent[k]] if self.loop_is_fine[parent[k]] else []).append(k)
        found = [f"the hole of {names[k]} is filled" for k in filled]
        shared = [", ".join(names[k] for k in loops) for loops in groups.values() if len(loops) > 1]
        return found + [f"the loops of {loops} share one" for loops in shared]

    def misplaced(self, alike: bool) -> list[str]:
        """Loops of a cage and a fine mesh, which do not meet, that turn or lie wrongly or have no partner."""
        found, fine, hole, turns = [], self.loop_is_fine, self.is_hole, self.turns
        names = [f"the loop of {self.near(loop[0])}" for loop in self.loops]
        for k, row in enumerate(turns):
            if row[fine == fine[k]].sum() != hole[k]:
                found.append(f"{names[k]} has the wrong orientation")
            elif row[fine != fine[k]].sum() != fine[k]:
                found.append(f"{names[k]} lies {'outside of the cage' if fine[k] else 'inside of the fine mesh'}")
        if found or not alike:
            return found
        parent = self.parents
        for k in np.flatnonzero(fine != hole).tolist():  # the inner one of two is the only child of its partner
            p = parent[k]
            if p < 0 or parent.count(p) > 1 or fine[p] == fine[k] or hole[p] != hole[k]:
                found.append(f"{names[k]} has no partner of its own")
        counts = (~fine).sum(), fine.sum()
        return found + ([f"the cage has {counts[0]} loops, not {counts[1]}"] if counts[0] != counts[1] else [])

    def too_near(self, clearance: float) -> list[str]:
        """Whether a cage and a fine mesh, which do not meet, are nearer than a clearance above 0."""
        wanted = (Fraction(clearance) * self.factor * (1 - TOLERANCE)) ** 2
        low, high, near = np.nextafter(self.x - clearance, -np.inf), np.nextafter(self.x + clearance, np.inf), []
        for fine in (True, False):
            k, e = np.flatnonzero(self.is_fine == fine), np.flatnonzero(self.is_fine != fine)
            i, j = overlapping(low[k], high[k], self.low[e], self.high[e])
            near.append(np.stack([k[i], e[j]]))
        k, e = np.concatenate(near, axis=1)
        squared, length = squared_gaps(*(self.whole[i] for i in (k, e, self.after[e])))
        short = squared * wanted.denominator < length * wanted.numerator
        gaps = [(Decimal(c) / Decimal(d)).sqrt() for c, d in zip(squared[short], length[short], strict=True)]
        return [f"the distance is {min(gaps) / self.factor:.9g}, not {clearance:.9g}"] if gaps else []


def faults_of_cage(cage: Any, fine: Any, clearance: float = 0.0, alike: bool = True) -> list[str]:
    """What is wrong with a cage around a fine mesh; empty if nothing."""
    try:
        both, _ = Loops(cage, fine), Fraction(clearance)
    except (ValueError, KeyError, TypeError, IndexError, OverflowError) as error:
        return [str(error)]
    return both.contacts() or both.misplaced(alike) + (both.too_near(clearance) if clearance > 0 else [])


def faults_of_rings(cage: Any, rings: Any, *, inside: bool = False) -> list[str]:
    """Rings, valid or not, that meet a cage or, unless it is an inner one, have a point outside of it."""
    both = Loops(cage, [ring for ring in rings if len(np.unique(ring, axis=0)) > 1])
    found = both.contacts(between=True)
    for k, row in enumerate(both.turns if not (found or inside) else ()):
        if both.loop_is_fine[k] and row[~both.loop_is_fine].sum() != 1:
            found.append(f"{both.near(both.loops[k][0])}, as it was given, lies outside of the cage")
    return found


def faults_of_needs(cage: Any, grid: float | None, symmetry: Any, report: Any) -> list[str]:
    """Coordinates off a grid, and edges without an image under a mirror (point, direction) or rotation (centre, order).

    A spacing is the decimal that reads as it; a coordinate on the grid, the float next to a multiple, as it is stored.
    """
    loops, held = Loops(cage), np.dtype(getattr(report, "stored", None) or "float64").type
    found = [] if (held(loops.x) == loops.x).all() else [f"some coordinates are not numbers of type {held.__name__}"]
    if (grid := getattr(report, "grid", None) if grid is None else grid) is not None:
        step = min(Fraction(repr(float(grid))), Fraction(grid), key=lambda ratio: ratio.numerator)
        off = [x for x in loops.x.ravel().tolist() if float(held(float(round(Fraction(x) / step) * step))) != x]
        found += [f"{len(off)} coordinates are not multiples of {grid:.9g}, such as {off[0]!r}"] if off else []
    if symmetry is not None:
        is_mirror, x = hasattr(symmetry, "direction"), loops.whole * Fraction(1, loops.factor)
        place = symmetry.point if is_mirror else symmetry.centre
        middle = x.mean(axis=0) if place is None else np.array([Fraction(number) for number in place])
        half = symmetry.direction if is_mirror else (np.cos(np.pi / symmetry.order), np.sin(np.pi / symmetry.order))
        u, (dx, dy) = np.array([Fraction(number) for number in half]), ((x - middle) * [1, -1 if is_mirror else 1]).T
        cosine, sine = (part / (u @ u) for part in dot_cross(u * [1, -1], u))  # of twice the angle of u, or nearly so
        images = middle + np.stack([cosine * dx - sine * dy, sine * dx + cosine * dy], axis=1)
        slack = TOLERANCE * Fraction(np.ptp(loops.x, axis=0).max())
        low, high = (np.nextafter((images + side * slack).astype(float), side * np.inf) for side in (-1, 1))
        partner = dict(overlapping(low, high, loops.x, loops.x).T.tolist())
        edges = {frozenset(edge) for edge in enumerate(loops.after.tolist())}
        lost = [edge for edge in edges if frozenset(map(partner.get, edge)) not in edges]
        found += [f"{loops.near(min(lost[0]))} has no image under the symmetry"] if lost else []
    return found


def faults_of_motion(cage_edges: Any, fine_edges: Any, cage_steps: Any, fine_steps: Any, chosen: Any) -> list[str]:
    """Contacts of the cage with the fine mesh or itself in linear motion from chosen steps to the next ones.

    A point p is on an edge a-b where (p - a) × (p - b) is zero and (p - a) · (p - b) is not positive.
    """
    count, x, found = cage_steps.shape[1], np.concatenate([cage_steps, fine_steps], axis=1), []
    start, end = np.concatenate([np.asarray(cage_edges), np.asarray(fine_edges) + count]).T
    for k in chosen:
        low, high = x[k : k + 2].min(axis=0), x[k : k + 2].max(axis=0)
        p, e = overlapping(low, high, np.minimum(low[start], low[end]), np.maximum(high[start], high[end]))
        counts = ((p < count) | (start[e] < count)) & (p != start[e]) & (p != end[e])
        p, a, b = p[counts], start[e[counts]], end[e[counts]]
        used, at = np.unique([p, a, b], return_inverse=True)
        places = whole_numbers(x[k : k + 2, used])[0][:, at.reshape(3, -1)]
        u, v = ([y[0] - y[m] for y in places] for m in (1, 2))
        products = [dot_cross(u[m], v[n]) for m, n in ((0, 0), (0, 1), (1, 0), (1, 1))]
        between, beside = (np.stack([c[0], c[1] + c[2], c[3]], axis=1) for c in zip(*products, strict=True))
        doubtful = (np.abs(np.sign(beside).sum(axis=1)) < 3) & (np.sign(between).sum(axis=1) < 3)
        hits = [m for m in np.flatnonzero(doubtful) if touches(beside[m], between[m])]
        found += [f"between steps {k} and {k + 1}, vertex {p[m]} meets the edge {a[m]}-{b[m]}" for m in hits]
    return found


def touches(beside: Any, between: Any) -> bool:
    """Whether in [0, 1] the first polynomial, b0 (1 - s)² + b1 s (1 - s) + b2 s², is once 0 and the second not > 0."""
    one, other = ((b0, b1 - 2 * b0, b0 - b1 + b2) for b0, b1, b2 in (beside, between))
    instants = roots(*one) if any(one) else [(0, 0, 0, 1), (1, 0, 0, 1), *roots(*other)]
    return any(sign_at(other, s) <= 0 <= sign_at((0, 1, 0), s) and sign_at((-1, 1, 0), s) <= 0 for s in instants)


def roots(c0: int, c1: int, c2: int) -> list[tuple[int, int, int, int]]:
    """Real roots of c0 + c1 s + c2 s², each as p, q, d, r for (p + q √d) / r; none of zero."""
    d = c1 * c1 - 4 * c2 * c0
    return [(-c1, q, d, 2 * c2) for q in (-1, 1) if d >= 0] if c2 else [(-c0, 0, 0, c1)] if c1 else []


def sign_at(polynomial: Any, root: tuple[int, int, int, int]) -> int:
    """The sign of a polynomial at a root of another; u + v √d has the sign of u |u| + v |v| d."""
    (c0, c1, c2), (p, q, d, r) = polynomial, root
    u, v = c0 * r * r + c1 * r * p + c2 * (p * p + q * q * d), c1 * r * q + 2 * c2 * p * q
    return int(np.sign(u * abs(u) + v * abs(v) * d))
