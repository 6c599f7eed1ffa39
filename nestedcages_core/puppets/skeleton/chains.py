"""Which parts bend, and their bones: a chain from a joint to a tip, two from a fork or from where limbs hang."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.vectors import norm, rotated_left
from ...libraries import load_shapely
from ..part import NEEDED_FOR, PuppetPart
from .bone_tree import BoneTree
from .midline import Midline, PartAxis, largest_component
from .skeleton import along_path

LEAF_BENDS, CARRIER_BENDS = 4.4, 9.0
"""A part bends if it is at least this long, in radii, from its joint to its tip; one that carries limbs is stiffer."""

END_BONE, THICK, THINNEST = 0.75, 0.5, 0.4
"""The first and the last bone are this much shorter than those between, which share their length among two blends;
where a part is thicker, bones are longer by this power of the radius, which counts from this part of the median on. Of
95 parts with three bones and more, half then turn 130° at least, not 109° as with equal bones, and 2 less than 90°,
not 15 (`benchmarks/cast`)."""

BONE_LENGTH, MOST_BONES = 4.0, 6
"""Length of a bone in a part that bends, in radii: room for the blends around both of its joints; and the most bones
that a draft gives a part."""

KNEE, KNEE_PLACE = 0.35, (0.4, 0.6)
"""Two bones meet where the middle is farthest from straight, if that is this far, in radii, and within these parts of
the length."""

FRAME, BLOB, ROOT_BLOB, BOX_FILL = 0.6, 1.5, 2.2, 0.5
"""What does not bend: a frame, which is less than this much of its filled outline; a part less slender than this, or
than that if it is the root, that fills this much of its box."""

BAR, BAR_ROOT, BAR_FILL = 6.0, 4.0, 0.75
"""A bar: at least this slender, as a root that, and this much of its box."""

BY_ITS_END = 0.7
"""A part bends if it hangs by its end: what lies beyond its joint is at least this much of its whole length."""

FORKED_HULL, SPREAD = 0.93, 0.6
"""A part that forks fills less than this of its convex hull; two ways from a root are a fork, as legs of trousers, if
their tips are nearer than this, in lengths of both."""


def bones_of(
    part: PuppetPart,
    joint: tuple[float, float] | None,
    limbs: Sequence[tuple[float, float]],
    *,
    bones: int | None,
    most: int,
) -> BoneTree:
    """The bones of a part.

    joint: where the part turns; None for a root. limbs: joints of what turns on it. bones: number of bones in a chain,
    if a user chose it; most: the maximum otherwise.
    """
    one = BoneTree.chain(_straight(part, joint))
    axis = None if bones == 1 or (bones is None and (most == 1 or stiff(part))) else PartAxis.of(part)
    if axis is None:
        return one
    solid = load_shapely(NEEDED_FOR).geometry.shape(largest_component(part.outline).__geo_interface__)
    if bones is None and most > 2:
        forked = _forked(part, axis, joint, limbs, most, solid)
        if forked is not None:
            return forked
    if joint is None:
        way = axis.midline(axis.longest, from_tip=True)
    else:
        way = axis.midline(axis.way(axis.nearest(joint)), np.array(joint))
    if way is None:
        return one
    if bones is None:
        hangs_by_its_end = joint is None or way.length >= BY_ITS_END * along_path(axis.points[axis.longest])[-1]
        if way.slenderness < _least(limbs) or _is_blob(part, is_root=joint is None) or not hangs_by_its_end:
            return one if joint is None else BoneTree.chain(way.points[[0, -1]])
        bones = min(_count(way), most)
    return BoneTree.chain(_chain(way, bones, solid)) if bones > 1 else one


def _least(limbs: Sequence[tuple[float, float]]) -> float:
    return CARRIER_BENDS if limbs else LEAF_BENDS


def _count(way: Midline) -> int:
    return int(np.clip(way.slenderness / BONE_LENGTH, 2, MOST_BONES))


def _forked(
    part: PuppetPart,
    axis: PartAxis,
    joint: tuple[float, float] | None,
    limbs: Sequence[tuple[float, float]],
    most: int,
    solid: Any,
) -> BoneTree | None:
    """Two chains on a bone of a part that forks; or both ways along a root, from the middle of where its limbs hang."""
    may_fork = part.solid.area < FORKED_HULL * part.solid.convex_hull.area
    trunk: FloatArray | None = None
    if joint is not None:
        way = axis.way(axis.nearest(joint))
        fork = axis.fork(way) if may_fork else None
        if fork is None:
            return None
        at, other = fork
        ways = [axis.midline(axis.branch(at, tip)) for tip in (way[-1], other)]
        trunk = np.stack((np.array(joint), axis.points[at]))
        if norm(trunk[1] - trunk[0]) <= 0.5 * axis.radii[at]:
            return None
        least = _least(limbs)
    else:
        along = along_path(axis.points[axis.longest])
        hung = [along[int(norm(axis.points[axis.longest] - np.array(place)).argmin())] for place in limbs]
        at = axis.longest[int(np.abs(along - (np.median(hung) if hung else 0.5 * along[-1])).argmin())]
        tips = axis.longest[-1], axis.longest[0]
        ways = [axis.midline(axis.way(at, tip), axis.points[at]) for tip in tips]
        least = 0.5 * LEAF_BENDS
        ahead = np.array([way.points[-1] - axis.points[at] for way in ways if way is not None])
        lengths = sum(way.length for way in ways if way is not None)
        if may_fork and len(ahead) == 2 and norm(ahead[0] - ahead[1]) <= SPREAD * lengths:
            back = -ahead.sum(axis=0) / norm(ahead.sum(axis=0))
            trunk = axis.points[at] + axis.radii[at] * np.stack((0.0 * back, back))
            ways = [axis.midline(axis.branch(at, tip)) for tip in tips]
        elif sum(way.slenderness for way in ways if way is not None) < _least(limbs) or _is_blob(part, is_root=True):
            return None
    found = [way for way in ways if way is not None and way.slenderness >= least]
    if len(found) < 2:
        return None
    each = max(1, (most - (trunk is not None)) // 2)
    chains = [_chain(way, min(_count(way), each), solid) for way in sorted(found, key=lambda way: -way.slenderness)]
    tree = BoneTree.chain(chains.pop(0) if trunk is None else trunk)
    for chain in chains:
        tree = tree.with_chain(chain)
    return tree


def _chain(way: Midline, bones: int, solid: Any) -> FloatArray:
    """(K + 1, 2) places of at most so many bones along a way, all in a solid."""
    along = along_path(way.points)
    for count in range(bones, 1, -1):
        places = _places(way, along, count)
        if count == 2:
            places[1] = _knee(way, along, places[1])
        chain = np.stack([np.interp(places, along, way.points[:, axis]) for axis in (0, 1)], axis=1)
        if load_shapely(NEEDED_FOR).contains_xy(solid, chain[1:-1]).all():
            return chain
    return way.points[[0, -1]]


def stiff(part: PuppetPart) -> bool:
    """Whether a part is round or a frame."""
    return part.is_round or bool(part.solid.area < FRAME * part.filled.area)


def bar_like(part: PuppetPart, *, is_root: bool) -> bool:
    """Whether a part is long, straight and of even width."""
    return part.slenderness > (BAR_ROOT if is_root else BAR) and _box_share(part) > BAR_FILL


def _is_blob(part: PuppetPart, *, is_root: bool) -> bool:
    """Whether a part is about as wide as long."""
    return part.slenderness < (ROOT_BLOB if is_root else BLOB) and _box_share(part) > BOX_FILL


def _box_share(part: PuppetPart) -> float:
    """How much of its box a part fills."""
    return float(part.solid.area / (norm(part.box[1] - part.box[0]) * norm(part.box[3] - part.box[0])))


def _places(way: Midline, along: FloatArray, count: int) -> FloatArray:
    """(count + 1,) where bones begin and end, along a way."""
    length = np.maximum(way.radii, THINNEST * way.median) ** -THICK
    bones = np.concatenate(([0.0], np.cumsum(0.5 * (length[1:] + length[:-1]) * np.diff(along))))
    each = np.ones(count)
    each[[0, -1]] = END_BONE
    ends = np.concatenate(([0.0], np.cumsum(each))) / each.sum()
    return np.interp(ends * bones[-1], bones, along)


def _knee(way: Midline, along: FloatArray, otherwise: float) -> float:
    """Where along a way of two bones their joint is: where it is bent, or at another place."""
    ends = way.points[-1] - way.points[0]
    off = np.abs((way.points - way.points[0]) @ (rotated_left(ends) / norm(ends)))
    low, high = (part * along[-1] for part in KNEE_PLACE)
    off = np.where((along >= low) & (along <= high), off, 0.0)
    farthest = int(off.argmax())
    return float(along[farthest] if off[farthest] > KNEE * way.median else otherwise)


def _straight(part: PuppetPart, joint: tuple[float, float] | None) -> FloatArray:
    """One bone: from the joint to the farthest point, or along a root, upwards or to the right."""
    if joint is not None:
        start = np.array(joint)
        away = part.outline.vertices - start
        return np.stack((start, start + away[int(norm(away).argmax())]))
    ends = part.ends
    along = ends[1] - ends[0]
    if along[int(np.abs(along).argmax())] < 0.0:
        ends = ends[::-1]
    inset = min(0.5 * part.slenderness**-1.0, 0.4) * (ends[1] - ends[0])
    return np.stack((ends[0] + inset, ends[1] - inset))
