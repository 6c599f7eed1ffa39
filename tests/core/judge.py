"""An independent judge of cages and motions: exact in every verdict, and without a line of the package it judges.

Coordinates are fractions whose denominators are powers of two: multiplied by the largest of these, all become whole
numbers, with which Python computes without rounding. Bounding boxes are compared as floats, which is exact as well. In
motions, a point meets an edge where a quadratic polynomial in time is zero: its roots are kept as (p + q √d) / r, and
the sign of any polynomial there is found by squaring.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np

TOLERANCE = Fraction(1, 10**9)
"""Relative shortfall of a clearance that counts as reached."""

CLEARLY = 1e-9
"""Relative size above which the sign of a product of differences in float64 is beyond doubt: a million roundings."""

NEARLY = 1e-6
"""Relative excess over the smallest distance in float64 up to which distances are compared exactly."""

BLOCK = 2_000_000
"""Pairs whose bounding boxes are compared at once."""

Array = Any
Root = tuple[int, int, int, int]
"""The number (p + q √d) / r with r > 0."""
Quadratic = tuple[int, int, int]
"""Coefficients of 1, s and s²."""


def whole_numbers(*arrays: Array) -> tuple[list[Array], int]:
    """The arrays times one power of two that makes every entry a Python integer, and that power."""
    fractions = [[Fraction(number) for number in np.asarray(array).ravel().tolist()] for array in arrays]
    factor = max((number.denominator for entries in fractions for number in entries), default=1)
    whole = []
    for array, entries in zip(arrays, fractions, strict=True):
        numbers = np.empty(len(entries), dtype=object)
        numbers[:] = [int(number * factor) for number in entries]
        whole.append(numbers.reshape(np.shape(array)))
    return whole, factor


def cross(u: Array, v: Array) -> Array:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


def dot(u: Array, v: Array) -> Array:
    return u[..., 0] * v[..., 0] + u[..., 1] * v[..., 1]


def signs(numbers: Array) -> Array:
    """(K,) of -1, 0 and 1 for whole numbers of any size."""
    return (numbers > 0).astype(int) - (numbers < 0).astype(int)


# Cages


class Outline:
    """Closed loops as plain arrays: vertices as floats and as whole numbers, and the vertex after each."""

    def __init__(self, vertices: Array, whole: Array, edges: Array) -> None:
        self.vertices, self.whole, self.edges = vertices, whole, np.asarray(edges)
        count = len(vertices)
        starts, ends = self.edges.T
        self.faults = []
        if sorted(starts.tolist()) != list(range(count)) or sorted(ends.tolist()) != list(range(count)):
            self.faults.append("some vertex is not the start of one edge and the end of one")
            return
        self.after = np.empty(count, int)
        self.after[starts] = ends
        self.loops = self._loops()
        self.loop_of = np.empty(count, int)
        for k, loop in enumerate(self.loops):
            self.loop_of[loop] = k

    def _loops(self) -> list[list[int]]:
        left, loops = set(range(len(self.after))), []
        while left:
            loop = [min(left)]
            while (following := int(self.after[loop[-1]])) != loop[0]:
                loop.append(following)
            left -= set(loop)
            loops.append(loop)
        return loops

    def doubled_area(self, loop: list[int]) -> int:
        return int(cross(self.whole[loop], self.whole[self.after[loop]]).sum())

    def boxes(self) -> tuple[Array, Array]:
        ends = self.vertices[self.after]
        return np.minimum(self.vertices, ends), np.maximum(self.vertices, ends)


def overlapping(low: Array, high: Array, other_low: Array, other_high: Array) -> tuple[Array, Array]:
    """Pairs of boxes that share a point; boxes with a corner of nan or none share none."""
    rows = max(1, BLOCK // max(1, len(other_low)))
    found = []
    for begin in range(0, len(low), rows):
        part = slice(begin, begin + rows)
        meet = np.ones((len(low[part]), len(other_low)), bool)
        for axis in (0, 1):
            meet &= low[part, None, axis] <= other_high[None, :, axis]
            meet &= other_low[None, :, axis] <= high[part, None, axis]
        i, j = np.nonzero(meet)
        found.append((i + begin, j))
    i, j = (np.concatenate([pair[k] for pair in found]) if found else np.zeros(0, int) for k in (0, 1))
    return i, j


def segments_meet(a: Array, b: Array, c: Array, d: Array) -> Array:
    """(K,) whether closed segments a-b and c-d of whole numbers (K, 2) share a point, given that their boxes do."""
    one, other = (
        signs(cross(b - a, c - a)) * signs(cross(b - a, d - a)),
        signs(cross(d - c, a - c)) * signs(cross(d - c, b - c)),
    )
    return (one <= 0) & (other <= 0)


def self_contacts(outline: Outline) -> list[str]:
    """Edges of one outline that meet, apart from neighbours in their common vertex."""
    boxes = outline.boxes()
    i, j = overlapping(*boxes, *boxes)
    i, j = i[i < j], j[i < j]
    points, after = outline.whole, outline.after
    neighbours = (after[i] == j) | (after[j] == i)
    a, b, c, d = points[i], points[after[i]], points[j], points[after[j]]
    meet = segments_meet(a, b, c, d) & ~neighbours
    first = np.where(after[i] == j, i, j)[neighbours]  # the edge into the common vertex, then the edge out of it
    into, out = points[after[first]] - points[first], points[after[after[first]]] - points[after[first]]
    folded = (signs(cross(into, out)) == 0) & (signs(dot(into, out)) <= 0)
    faults = [f"edges {p} and {q} meet" for p, q in zip(i[meet].tolist(), j[meet].tolist(), strict=True)]
    return faults + [f"the boundary folds back or stands still at vertex {after[k]}" for k in first[folded]]


def winding(point: Array, outline: Outline, loop: list[int]) -> int:
    """How often a loop runs around a point (2,) that is not on it."""
    a, b = outline.whole[loop], outline.whole[outline.after[loop]]
    up = (a[:, 1] <= point[1]) & (b[:, 1] > point[1])
    down = (a[:, 1] > point[1]) & (b[:, 1] <= point[1])
    side = signs(cross(b - a, point - a))
    return int((up & (side > 0)).sum()) - int((down & (side < 0)).sum())


def faults_of_cage(cage: Any, fine: Any, clearance: float, *, same_loops: bool = True) -> list[str]:
    """What is wrong with a cage around a fine mesh, both with ``vertices`` and directed ``edges``; empty if nothing."""
    meshes = [np.asarray(mesh.vertices, float) for mesh in (cage, fine)]
    if not all(np.isfinite(vertices).all() for vertices in meshes):
        return ["coordinates that are not finite"]
    whole, factor = whole_numbers(*meshes)
    outlines = [
        Outline(vertices, numbers, mesh.edges)
        for vertices, numbers, mesh in zip(meshes, whole, (cage, fine), strict=True)
    ]
    faults = [fault for outline in outlines for fault in outline.faults]
    if faults:
        return faults
    for name, outline in zip(("cage", "fine"), outlines, strict=True):
        faults += [f"{name}: {fault}" for fault in self_contacts(outline)]
    outer, inner = outlines
    i, j = overlapping(*outer.boxes(), *inner.boxes())
    ends = outer.whole[i], outer.whole[outer.after[i]], inner.whole[j], inner.whole[inner.after[j]]
    meet = segments_meet(*ends)
    faults += [f"cage edge {p} meets fine edge {q}" for p, q in zip(i[meet].tolist(), j[meet].tolist(), strict=True)]
    if faults:
        return faults
    return faults_of_nesting(outer, inner, same_loops) + faults_of_distance(outer, inner, clearance, factor)


def faults_of_nesting(cage: Outline, fine: Outline, same_loops: bool) -> list[str]:
    """Orientation, containment and correspondence of loops that neither cross nor touch."""
    loops = [(outline, loop) for outline in (cage, fine) for loop in outline.loops]
    kept = len(cage.loops)
    around: list[list[int]] = []  # for each loop, those that enclose it
    turns: list[list[int]] = []
    for outline, loop in loops:
        point = outline.whole[loop[0]]
        found = [0 if other is loop else winding(point, its, other) for its, other in loops]
        turns.append(found)
        around.append([k for k, turn in enumerate(found) if turn])
    sense = [1 if outline.doubled_area(loop) > 0 else -1 for outline, loop in loops]
    faults = []
    for k, (outline, _) in enumerate(loops):
        own = range(kept) if outline is cage else range(kept, len(loops))
        depth = len(set(around[k]) & set(own))
        if sense[k] != (-1) ** depth:
            faults.append(f"loop {k} turns the wrong way for its depth {depth}")
    for k in range(kept, len(loops)):
        if sum(turns[k][:kept]) != 1:
            faults.append(f"fine loop {k - kept} is outside of the cage")
    for k in range(kept):
        if sum(turns[k][kept:]) != 0:
            faults.append(f"cage loop {k} is inside of the fine solid")
    if not same_loops or faults:
        return faults
    parent = [max(above, key=lambda k: len(around[k]), default=None) for above in around]
    for k in range(len(loops)):
        is_cage, is_outer = k < kept, sense[k] > 0
        if is_cage != is_outer:  # a fine outer loop lies directly in a cage's, a hole of the cage in a fine one
            above = parent[k]
            alone = above is not None and parent.count(above) == 1
            if not alone or (above < kept) == is_cage or sense[above] != sense[k]:
                faults.append(f"loop {k} has no partner of its own")
    if kept != len(fine.loops):
        faults.append(f"the cage has {kept} loops, the fine mesh {len(fine.loops)}")
    return faults


def squared_distance(point: Array, start: Array, end: Array) -> Fraction:
    """From a point to a segment, all (2,) whole numbers."""
    along, to = end - start, point - start
    length, place = int(dot(along, along)), int(dot(along, to))
    if place <= 0:
        return Fraction(int(dot(to, to)))
    if place >= length:
        return Fraction(int(dot(point - end, point - end)))
    return Fraction(int(cross(along, to)) ** 2, length)


def smallest_squared_distance(cage: Outline, fine: Outline) -> Fraction:
    """Between two outlines that do not meet, in whole numbers squared."""
    closest: list[tuple[float, Outline, int, Outline, int]] = []
    for points, lines in ((cage, fine), (fine, cage)):
        start, end = lines.vertices, lines.vertices[lines.after]
        for k, point in enumerate(points.vertices):
            along, to = end - start, point - start
            length = dot(along, along)  # zero by underflow where an edge is as good as a point
            place = np.clip(dot(along, to) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
            gaps = np.hypot(*(to - place[:, None] * along).T)
            closest += [(float(gaps[m]), points, k, lines, int(m)) for m in np.argsort(gaps)[:3]]
    size = max(float(np.abs(outline.vertices).max()) for outline in (cage, fine))
    limit = min(gap for gap, *_ in closest) * (1.0 + NEARLY) + CLEARLY * 1e-4 * size
    return min(
        squared_distance(points.whole[k], lines.whole[m], lines.whole[lines.after[m]])
        for gap, points, k, lines, m in closest
        if gap <= limit
    )


def faults_of_distance(cage: Outline, fine: Outline, clearance: float, factor: int) -> list[str]:
    wanted = Fraction(clearance) * factor * (1 - TOLERANCE)
    least = smallest_squared_distance(cage, fine)
    if least < wanted**2:
        return [f"the distance is {math.sqrt(float(least / factor**2)):.9g}, not {clearance:.9g}"]
    return []


# Motions


def roots(polynomial: Quadratic) -> list[Root]:
    """Real roots of a polynomial that is not zero."""
    c0, c1, c2 = polynomial
    if c2 == 0:
        return [] if c1 == 0 else [(-c0, 0, 0, c1) if c1 > 0 else (c0, 0, 0, -c1)]
    d = c1 * c1 - 4 * c2 * c0
    if d < 0:
        return []
    p, r = (-c1, 2 * c2) if c2 > 0 else (c1, -2 * c2)
    return [(p, -1, d, r), (p, 1, d, r)]


def sign_of_surd(u: int, v: int, d: int) -> int:
    """The sign of u + v √d."""
    v = v if d else 0
    if u >= 0 and v >= 0:
        return 1 if u or v else 0
    if u <= 0 and v <= 0:
        return -1
    size = u * u - v * v * d
    return (size > 0) - (size < 0) if u > 0 else (size < 0) - (size > 0)


def sign_at(polynomial: Quadratic, root: Root) -> int:
    """The sign of a polynomial at a root of another."""
    (c0, c1, c2), (p, q, d, r) = polynomial, root
    return sign_of_surd(c0 * r * r + c1 * r * p + c2 * (p * p + q * q * d), c1 * r * q + 2 * c2 * p * q, d)


def within_the_step(root: Root) -> bool:
    p, q, d, r = root
    return sign_of_surd(p, q, d) >= 0 and sign_of_surd(p - r, q, d) <= 0


def touches(
    side: Quadratic,
    past_start: Quadratic,
    before_end: Quadratic,
    squared_length: Quadratic = (1, 0, 0),
    squared_distance: Quadratic = (1, 0, 0),
) -> bool:
    """Whether for some s in [0, 1] the first polynomial is zero and the next two are not negative.

    Where the edge shrinks to a point, that says nothing: then the distance to its start must be zero.
    """
    if any(side):
        instants = roots(side)
    else:  # a closed set has its boundary where one of them changes its sign, or at an end
        instants = [(0, 0, 0, 1), (1, 0, 0, 1)]
        instants += [root for polynomial in (past_start, before_end) if any(polynomial) for root in roots(polynomial)]
    return any(
        within_the_step(s)
        and sign_at(past_start, s) >= 0
        and sign_at(before_end, s) >= 0
        and (sign_at(squared_length, s) > 0 or sign_at(squared_distance, s) == 0)
        for s in instants
    )


def quadratic(product: Any, u: tuple[Array, Array], v: tuple[Array, Array]) -> Array:
    """(K, 3) coefficients of the product of two vectors that move linearly, each given before and after."""
    du, dv = u[1] - u[0], v[1] - v[0]
    return np.stack([product(u[0], v[0]), product(u[0], dv) + product(du, v[0]), product(du, dv)], axis=-1)


def moving_pairs(before: Array, after: Array, edges: Array, is_cage: Array) -> tuple[Array, Array]:
    """Pairs (point, edge) whose swept boxes meet and which must not touch: all but those within the fine mesh."""
    low, high = np.minimum(before, after), np.maximum(before, after)
    start, end = edges.T
    edge_low, edge_high = np.minimum(low[start], low[end]), np.maximum(high[start], high[end])
    point, edge = overlapping(low, high, edge_low, edge_high)
    wanted = (is_cage[point] | is_cage[start[edge]]) & (point != start[edge]) & (point != end[edge])
    return point[wanted], edge[wanted]


def in_doubt(before: Array, after: Array, point: Array, start: Array, end: Array) -> Array:
    """(K,) whether it is not plain already in float64 that a point stays on one side of the line of its edge."""
    u = before[end] - before[start], after[end] - after[start]
    w = before[point] - before[start], after[point] - after[start]
    plain = np.ones((2, len(point)), bool)
    for sense, row in ((1.0, plain[0]), (-1.0, plain[1])):
        for one, other in ((u[0], w[0]), (u[1], w[1])):
            size = np.abs(one[:, 0] * other[:, 1]) + np.abs(one[:, 1] * other[:, 0])
            row &= sense * cross(one, other) > CLEARLY * size
        middle = cross(u[0], w[1]) + cross(u[1], w[0])
        size = sum(np.abs(one[:, k] * other[:, 1 - k]) for one, other in ((u[0], w[1]), (u[1], w[0])) for k in (0, 1))
        row &= sense * middle > CLEARLY * size
    return ~plain.any(axis=0)


def contacts_in_step(before: Array, after: Array, edges: Array, is_cage: Array) -> Iterator[str]:
    """Every point that meets an edge while both move linearly from ``before`` to ``after`` (n, 2)."""
    point, edge = moving_pairs(before, after, edges, is_cage)
    start, end = edges[edge].T
    doubtful = in_doubt(before, after, point, start, end)
    point, start, end = point[doubtful], start[doubtful], end[doubtful]
    if not len(point):
        return
    used, places = np.unique(np.concatenate([point, start, end]), return_inverse=True)
    point_at, start_at, end_at = places.reshape(3, -1)
    (whole_before, whole_after), _ = whole_numbers(before[used], after[used])
    along, from_start, from_end = (
        tuple(x[one] - x[other] for x in (whole_before, whole_after))
        for one, other in ((end_at, start_at), (point_at, start_at), (point_at, end_at))
    )
    side = quadratic(cross, along, from_start)
    past_start, past_end = quadratic(dot, along, from_start), quadratic(dot, along, from_end)
    length, distance = quadratic(dot, along, along), quadratic(dot, from_start, from_start)
    for k in range(len(point)):
        polynomials = (side[k], past_start[k], -past_end[k], length[k], distance[k])
        if touches(*(tuple(polynomial) for polynomial in polynomials)):
            yield f"vertex {point[k]} meets the edge {start[k]}-{end[k]}"


def faults_of_motion(
    cage_edges: Array, fine_edges: Array, cage_steps: Array, fine_steps: Array, steps: Any = None
) -> list[str]:
    """Contacts of the cage with the fine mesh or itself during the linear motions from ``steps`` on (all unless given).

    Vertices of the fine mesh are counted on from those of the cage.
    """
    count = cage_steps.shape[1]
    edges = np.concatenate([np.asarray(cage_edges), np.asarray(fine_edges) + count])
    is_cage = np.arange(count + fine_steps.shape[1]) < count
    together = [np.concatenate(pair) for pair in zip(cage_steps, fine_steps, strict=True)]
    chosen = range(len(together) - 1) if steps is None else steps
    return [
        f"between steps {k} and {k + 1}, {contact}"
        for k in chosen
        for contact in contacts_in_step(together[k], together[k + 1], edges, is_cage)
    ]
