"""A skeleton along the limbs of a shape: the pruned medial axis, cut into bones where it forks, bends or is long."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh, MeshLike
from ...geometry.predicates import winding_number
from ...parameters import check_positive
from .bone import Bone, named

MERGED = 0.7
"""Forks closer than this, in radii, are one."""

STUB = 1.2
"""A limb that reaches less than this from its fork, in radii of the fork, is none."""

LEAVES_DISC = 0.75
"""A limb starts where it leaves the disc of its fork: this part of that disc's radius from its centre."""

SHORTEST = 0.8
"""Least distance between joints, in radii of the limb."""

THIN = 0.85
"""The axis may be cut where it gets thinner than this, in radii of the limb."""

STEEP = 0.4
"""It is cut where it also thins by this much per length: there it turns into a corner of the tip (0.7 in a right one),
while a limb only tapers."""

TIP_REACH = 0.8
"""How far the last bone of a limb goes on straight towards the tip, in radii there."""

LOOK_BACK = 8
"""Points of the axis that tell the direction at the tip."""

SAMPLES = 600
"""Points on all outlines together, whose Voronoi diagram gives the axis."""

LEAST_SAMPLES = 8
"""Minimum number of points on an outline."""

AROUND = 1.3
"""An edge of the axis lies between points of the outline that are this many times as far apart along it as straight."""

SEPARATE = 0.5
"""The same along the outline, in radii of the two ends of the edge; nearer ones are noise of the outline."""

Graph = dict[int, set[int]]


@dataclass(frozen=True)
class Skeleton:
    """What becomes a bone; lengths are in radii of the limb."""

    protrudes: float = 1.0
    """A limb reaches at least this far beyond the disc of its fork; larger: fewer limbs."""
    bends: float = 0.35
    """A joint where the axis is this far from the straight line; larger: fewer joints."""
    long: float = 7.0
    """A straight bone longer than this gets a joint in its middle, such as an elbow or a knee."""

    def __post_init__(self) -> None:
        check_positive(self, "protrudes", "bends", "long")


@dataclass(frozen=True, eq=False)
class _Chain:
    """A path of the axis from a fork or the root to the next fork or a tip."""

    path: list[int]
    parent: int | None
    is_limb: bool
    """Whether it ends at a tip."""


def suggest_bones(shape: MeshLike, skeleton: Skeleton | None = None) -> tuple[Bone, ...]:
    """Bones along the limbs of a shape, roots first, each inside; a round shape gets one bone or none.

    The root is at the widest fork. Names are "body" along the trunk and "limb" with a number, with `.L` and `.R` where
    two limbs mirror each other left and right of the root; L is at larger x, as for a character seen from the front.
    """
    chosen = skeleton or Skeleton()
    mesh = Mesh.of(shape)
    axis = pruned(medial_axis(mesh), chosen.protrudes)
    bones: list[Bone] = []
    for root, children in _trees(axis):
        bones += _bones_of(axis, _chains(axis, root, children), chosen, len(bones))
    return tuple(named(bones))


def _trees(axis: MedialAxis) -> list[tuple[int, dict[int, list[int]]]]:
    """The root and the children of each point, for each part of the axis: shortest paths from the widest fork.

    Loops around holes open at the point farthest from the root.
    """
    if not axis.links:
        return []
    points = np.array(list(axis.links))
    number = {point: k for k, point in enumerate(points.tolist())}
    ends = np.array([(number[i], number[j]) for i, others in axis.links.items() for j in others]).T
    steps = axis.points[points[ends[0]]] - axis.points[points[ends[1]]]
    lengths = np.hypot(steps[:, 0], steps[:, 1]) + np.finfo(float).tiny
    graph = scipy.sparse.csr_array((lengths, tuple(ends)), shape=(len(points),) * 2)
    parts = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
    degrees = np.array([len(axis.links[point]) for point in points.tolist()])
    trees = []
    for part in np.unique(parts):
        members = np.flatnonzero(parts == part)
        forks, tips = members[degrees[members] > 2], members[degrees[members] == 1]
        candidates = forks if len(forks) else tips if len(tips) else members
        root = candidates[np.argmax(axis.radii[points[candidates]])]
        before = scipy.sparse.csgraph.dijkstra(graph, directed=False, indices=root, return_predecessors=True)[1]
        children: dict[int, list[int]] = {}
        for member in members[before[members] >= 0].tolist():
            children.setdefault(int(points[before[member]]), []).append(int(points[member]))
        trees.append((int(points[root]), children))
    return trees


def _chains(axis: MedialAxis, root: int, children: dict[int, list[int]]) -> list[_Chain]:
    """Paths between root, forks and tips; forks near each other are joined, stubs are dropped."""
    found: list[_Chain] = []
    waiting: list[tuple[list[int], int | None]] = [([root, child], None) for child in children.get(root, [])]
    while waiting:
        path, parent = waiting.pop()
        while len(children.get(path[-1], [])) == 1:
            path.append(children[path[-1]][0])
        ahead = children.get(path[-1], [])
        length, radius = axis.length(path), axis.radii[path[0]]
        if not ahead and length + axis.radii[path[-1]] < STUB * radius:
            continue
        if ahead and length < MERGED * radius:
            waiting += [([*path, child], parent) for child in ahead]
            continue
        waiting += [([path[-1], child], len(found)) for child in ahead]
        found.append(_Chain(path, parent, not ahead))
    return found


def _bones_of(axis: MedialAxis, chains: list[_Chain], chosen: Skeleton, first: int) -> list[Bone]:
    """Bones of one tree, numbered from `first`; the thickest chain from the root that forks again is the trunk."""
    tops = [k for k, chain in enumerate(chains) if chain.parent is None]
    if not tops:
        return []
    forking = [k for k in tops if any(chain.parent == k for chain in chains)] or tops
    trunk = max(forking, key=lambda k: float(axis.radii[chains[k].path].mean()))
    bones: list[Bone] = []
    last: dict[int, int] = {}
    begun = first
    for k in [trunk, *(k for k in range(len(chains)) if k != trunk)]:
        chain = chains[k]
        path = trimmed(axis, chain.path) if chain.is_limb else chain.path
        if k != trunk:
            path = _outside_fork(axis, path)
        parent = None if k == trunk else begun if chain.parent is None else last[chain.parent]
        joints = _joints(axis, path, chosen)
        for i, j in pairwise(joints):
            tail = axis.points[path[j]]
            if chain.is_limb and j == joints[-1]:
                tail = tail + TIP_REACH * axis.radii[path[j]] * _direction(
                    axis.points[path[max(j - LOOK_BACK, 0) : j + 1]]
                )
            head = axis.points[path[i]]
            kind = "body" if k == trunk else "limb"
            bones.append(Bone((float(head[0]), float(head[1])), (float(tail[0]), float(tail[1])), parent, kind))
            parent = first + len(bones) - 1
        last[k] = begun if parent is None else parent
    return bones


def _direction(points: FloatArray) -> FloatArray:
    """(2,) unit vector from the first point to the last."""
    along: FloatArray = points[-1] - points[0]
    return along / (np.hypot(*along) or 1.0)


def trimmed(axis: MedialAxis, path: list[int]) -> list[int]:
    """A limb without its last turn into a corner of the tip."""
    points, radii = axis.points[path], axis.radii[path]
    least = THIN * float(np.median(radii))
    along = along_path(points)
    end = len(path)
    while end > 2 and radii[end - 1] < least < np.hypot(*(points[end - 1] - points[0])):
        before = int(np.searchsorted(along, along[end - 1] - 0.5 * least))
        if radii[before] - radii[end - 1] < STEEP * (along[end - 1] - along[before]):
            break
        end -= 1
    return path[:end]


def along_path(points: FloatArray) -> FloatArray:
    """(N,) distance of each point of a path from the first."""
    steps = np.diff(points, axis=0)
    return np.concatenate(([0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))))


def _outside_fork(axis: MedialAxis, path: list[int]) -> list[int]:
    """A limb thinner than its fork, from where it leaves the fork's disc."""
    disc = LEAVES_DISC * axis.radii[path[0]]
    if float(np.median(axis.radii[path])) >= disc:
        return path
    away = axis.points[path] - axis.points[path[0]]
    start = int(np.argmax(np.hypot(away[:, 0], away[:, 1]) > disc))
    return path[start:] if len(path) - start > 2 else path


def _joints(axis: MedialAxis, path: list[int], chosen: Skeleton) -> list[int]:
    """Places on a path where bones meet: where it bends (after Douglas & Peucker), and in the middle of long parts."""
    points, radii = axis.points[path], axis.radii[path]
    kept, waiting = {0, len(path) - 1}, [(0, len(path) - 1)]
    while waiting:
        i, j = waiting.pop()
        normal = _direction(points[[i, j]])[::-1] * (-1.0, 1.0)
        off = np.abs((points[i : j + 1] - points[i]) @ normal) / radii[i : j + 1]
        k = i + int(np.argmax(off))
        if off[k - i] > chosen.bends and i < k < j:
            kept.add(k)
            waiting += [(i, k), (k, j)]
    along = along_path(points)
    for i, j in pairwise(sorted(kept)):
        pieces = int((along[j] - along[i]) / (chosen.long * np.median(radii[i : j + 1]))) + 1
        wanted = along[i] + (along[j] - along[i]) * np.arange(1, pieces) / pieces
        kept |= set(np.searchsorted(along, wanted).tolist())
    least = SHORTEST * float(np.median(radii))
    joints = [0]
    for k in sorted(kept)[1:-1]:
        if along[k] - along[joints[-1]] > least and along[-1] - along[k] > least:
            joints.append(k)
    return [*joints, len(path) - 1]


@dataclass(frozen=True, eq=False)
class MedialAxis:
    """Points of the axis with the radii of their discs, and how they are linked."""

    points: FloatArray
    """(N, 2)."""
    radii: FloatArray
    """(N,) distance to the outline."""
    links: Graph
    """Neighbours of each point that is used."""

    def length(self, path: list[int]) -> float:
        """Length of a path."""
        return float(along_path(self.points[path])[-1])


def medial_axis(mesh: Mesh) -> MedialAxis:
    """The edges of the Voronoi diagram of points on the outline that lie inside, without those that noise makes."""
    points, loop, along, total = _on_outline(mesh)
    diagram = scipy.spatial.Voronoi(points)
    centres = diagram.vertices
    inside = winding_number(centres, mesh.vertices, mesh.edge_ends) == 1
    radii = scipy.spatial.cKDTree(points).query(centres)[0]
    pairs, ends = diagram.ridge_points, np.array(diagram.ridge_vertices)
    bounded = (ends >= 0).all(axis=1)
    pairs, ends = pairs[bounded], ends[bounded]
    used = inside[ends].all(axis=1)
    pairs, (first, second) = pairs[used], ends[used].T
    a, b = pairs.T
    between = np.abs(along[a] - along[b])
    between = np.where(loop[a] == loop[b], np.minimum(between, total[loop[a]] - between), np.inf)
    straight = np.hypot(*(points[a] - points[b]).T)
    real = (between > AROUND * straight) & (between > SEPARATE * (radii[first] + radii[second]))
    links: Graph = {}
    for i, j in zip(first[real].tolist(), second[real].tolist(), strict=True):
        links.setdefault(i, set()).add(j)
        links.setdefault(j, set()).add(i)
    return MedialAxis(centres, radii, links)


def pruned(axis: MedialAxis, protrudes: float) -> MedialAxis:
    """The axis without branches that reach less than `protrudes` radii beyond their fork, shortest first."""
    links = {point: set(others) for point, others in axis.links.items()}
    while True:
        worst, least = None, protrudes
        for tip in [point for point, others in links.items() if len(others) == 1]:
            path = _branch(links, tip)
            fork = path[-1]
            if len(links[fork]) >= 3:
                reach = (axis.length(path) + axis.radii[tip]) / axis.radii[fork] - 1.0
                if reach < least:
                    worst, least = path, reach
        if worst is None:
            return MedialAxis(axis.points, axis.radii, {point: others for point, others in links.items() if others})
        for i, j in pairwise(worst):
            links[i].discard(j)
            links[j].discard(i)


def _branch(links: Graph, tip: int) -> list[int]:
    """The path from a tip to the next fork or other tip."""
    path = [tip]
    while True:
        ahead = [point for point in links[path[-1]] if len(path) < 2 or point != path[-2]]
        if not ahead or (len(path) > 1 and len(links[path[-1]]) != 2):
            return path
        path.append(ahead[0])


def _on_outline(mesh: Mesh) -> tuple[FloatArray, IntArray, FloatArray, FloatArray]:
    """Evenly spaced points (P, 2), their loops, their places along these, and the length of each loop."""
    spacing = float(mesh.edge_lengths.sum()) / SAMPLES
    points, loops, places, lengths = [], [], [], []
    for number, loop in enumerate(mesh.loops):
        ends = np.concatenate(([0.0], np.cumsum(mesh.edge_lengths[loop])))
        count = max(round(ends[-1] / spacing), LEAST_SAMPLES)
        at = (np.arange(count) + 0.5) * ends[-1] / count
        ring = mesh.vertices[np.append(loop, loop[0])]
        points.append(np.stack([np.interp(at, ends, ring[:, axis]) for axis in (0, 1)], axis=1))
        loops.append(np.full(count, number))
        places.append(at)
        lengths.append(ends[-1])
    return np.concatenate(points), np.concatenate(loops), np.concatenate(places), np.array(lengths)
