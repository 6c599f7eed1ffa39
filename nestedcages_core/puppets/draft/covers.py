"""What is one thing though it is drawn in several parts: clothes over a limb, and alternatives that are shown in turn;
and wheels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...libraries import load_shapely
from ..part import NEEDED_FOR, PuppetPart
from .names import name_words, words_of
from .sides import alike_pairs

SAME_PLACE, HIDES = 0.5, 0.85
"""A cover: least common area over joined area, and what part of the lower part it hides."""

IN_TURN = 0.5
"""Least common area of alternatives, in those of the smaller one."""

STANDS = 0.15
"""How far from the ground a wheel may end, in heights of the drawing."""


def covers_of(parts: Sequence[PuppetPart]) -> dict[int, int]:
    """What each part covers, such as a legging its shin. Parts that are alike are left and right, or near and far."""
    solids, alike = [part.filled for part in parts], set(alike_pairs(parts))
    found: dict[int, int] = {}
    for low, high, shared in _overlapping(solids):
        joined = solids[low].area + solids[high].area - shared
        if shared >= max(SAME_PLACE * joined, HIDES * solids[low].area) and (low, high) not in alike:
            found[high] = found.get(low, low) if high not in found else found[high]
    return found


def alternatives_of(parts: Sequence[PuppetPart]) -> list[list[int]]:
    """Sets of parts that are shown in turn: all in a group that have its name and another word, and lie at the same
    place. A number alone is what programs add to shapes without names."""
    groups: dict[tuple[str, ...], list[int]] = {}
    for k, part in enumerate(parts):
        groups.setdefault(part.groups, []).append(k)
    found = []
    for path, own in groups.items():
        stem = _lower_words(path[-1]) if path else []
        names = [_lower_words(parts[k].name) for k in own]
        are_named = all(name[: len(stem)] == stem and any(map(str.isalpha, name[len(stem) :])) for name in names)
        if not stem or len(own) < 2 or not are_named:
            continue
        solids = [parts[k].filled for k in own]
        together = {
            k
            for low, high, shared in _overlapping(solids)
            if shared >= IN_TURN * min(solids[low].area, solids[high].area)
            for k in (low, high)
        }
        if len(together) == len(own):
            found.append(own)
    return found


def wheels_of(parts: Sequence[PuppetPart]) -> list[int]:
    """Round parts without a known name that stand on the ground in twos: they turn about their centres."""
    bottoms = [float(part.outline.vertices[:, 1].min()) for part in parts]
    ground = min(bottoms)
    near = ground + STANDS * (max(float(part.outline.vertices[:, 1].max()) for part in parts) - ground)
    found = set[int]()
    for pair in alike_pairs(parts):
        stand = all(bottoms[k] < near and parts[k].is_round and not words_of(parts[k].name).noun for k in pair)
        if stand and not parts[pair[0]].solid.contains(parts[pair[1]].solid.centroid):
            found |= {*pair}
    return sorted(found)


def _lower_words(name: str) -> list[str]:
    return [word.lower() for word in name_words(name)]


def _overlapping(solids: Sequence[Any]) -> list[tuple[int, int, float]]:
    """Pairs that overlap, the lower first, and the area that they share."""
    shapely = load_shapely(NEEDED_FOR)
    pairs = shapely.STRtree(solids).query(solids, predicate="intersects").T.tolist()
    return [(i, j, float(solids[i].intersection(solids[j]).area)) for i, j in sorted(pairs) if i < j]
