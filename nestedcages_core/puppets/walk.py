"""The walk of a puppet: angles of bones over time. Every frame stays within the ranges that are proved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..errors import invalid_setting
from ..geometry.arrays import FloatArray
from .limbs import Figure
from .puppet import Puppet

STRIDE, KNEE_LIFT, ARM_SWING = 22.0, 32.0, 18.0
"""Degrees: of a thigh forwards and back, of a knee while the leg swings, of an arm."""

SWAY, LAG = 6.0, 0.7
"""Degrees by which heads and tails sway; radians by which each bone of a tail is behind the one before."""

USED = 0.98
"""The part of a proved range that clips use."""


@dataclass(frozen=True)
class Clip:
    """An animation that repeats."""

    name: str
    seconds: float
    """Length; the first frame follows the last one."""
    frames: tuple[dict[str, float], ...] = field(repr=False)
    """Degrees by name of the bone, counter-clockwise, relative to the parent and to rest; at equal times."""
    rise: tuple[float, ...] = field(repr=False)
    """How much higher the whole figure is on each frame, to stand on the lowest of its legs."""


def walk(puppet: Puppet | Figure, *, seconds: float = 1.0, frames: int = 24) -> Clip:
    """Steps on the spot for two legs, four or more: of two legs side by side, one is half a step ahead.

    Raises NestedCagesError for a puppet with fewer than two legs, no frames, and a time that is not positive.
    """
    if not 0.0 < seconds < np.inf:
        raise invalid_setting(f"A clip takes a positive time, not {seconds!r} seconds.")
    if frames < 1:
        raise invalid_setting(f"A clip has at least one frame, not {frames}.")
    figure = puppet if isinstance(puppet, Figure) else puppet.figure
    limbs, ahead = figure.limbs, figure.ahead
    if len(limbs.legs) < 2:
        raise invalid_setting(f"A walk needs two legs that reach the ground; this puppet has {len(limbs.legs)}.")
    turn = np.arange(frames) * (2.0 * np.pi / frames)
    tracks: dict[str, FloatArray] = {}
    for leg, phase, middle in zip(limbs.legs, _phases(figure, limbs.legs), _middles(figure), strict=True):
        at = turn + phase
        swing, lift = ahead * STRIDE * np.sin(at), ahead * KNEE_LIFT * np.maximum(np.cos(at), 0.0)
        tracks |= dict(zip(leg, (middle + swing, -lift, 0.7 * lift - 0.5 * swing), strict=False))
    for arm, phase in zip(limbs.arms, _phases(figure, limbs.arms), strict=True):
        swing = ahead * ARM_SWING * np.sin(turn + phase + np.pi)
        tracks |= dict(zip(arm, (swing, 0.5 * swing + 0.5 * ahead * ARM_SWING), strict=False))
    for limb in (*limbs.tails, *(head[:1] for head in limbs.heads)):
        tracks |= {bone: SWAY * np.sin(2.0 * turn - LAG * k) for k, bone in enumerate(limb)}
    turns = {bone.name: each for bone, each in zip(figure.bones, figure.ranges, strict=True)}
    kept = {
        bone: np.clip(angles, USED * turns[bone].simple_low, USED * turns[bone].simple_high)
        for bone, angles in tracks.items()
    }
    poses = tuple({bone: float(angles[frame]) for bone, angles in kept.items()} for frame in range(frames))
    return Clip("walk", seconds, poses, tuple(_rise(figure, kept, frames).tolist()))


def _order(figure: Figure, limbs: Sequence[tuple[str, ...]]) -> list[int]:
    """Limbs from smaller to larger x."""
    heads = {bone.name: bone.head[0] for bone in figure.bones}
    return sorted(range(len(limbs)), key=lambda k: heads[limbs[k][0]])


def _middles(figure: Figure) -> FloatArray:
    """(legs,) degrees from each leg as drawn to the middle of it and the one next to it; 0 as seen from the front."""
    legs, bones = figure.limbs.legs, {bone.name: bone for bone in figure.bones}
    found = np.zeros(len(legs))
    if abs(figure.ahead) < 1.0:
        return found
    along = [complex(*bones[leg[-1]].head) - complex(*bones[leg[0]].head) for leg in legs]
    order = _order(figure, legs)
    for one, other in zip(order[::2], order[1::2], strict=False):
        if along[one] and along[other]:
            apart = float(np.rad2deg(np.angle(along[other] / along[one])))
            found[[one, other]] = 0.5 * apart, -0.5 * apart
    return found


def _phases(figure: Figure, limbs: Sequence[tuple[str, ...]]) -> list[float]:
    """When each limb steps, in radians: limbs side by side take turns, and so do those in front and behind."""
    order = _order(figure, limbs)
    places = {limb: number for number, limb in enumerate(order)}
    return [np.pi * ((places[k] + 1) // 2 % 2 if len(limbs) > 2 else places[k]) for k in range(len(limbs))]


def _rise(figure: Figure, tracks: Mapping[str, FloatArray], frames: int) -> FloatArray:
    """(frames,) how much lower than at rest the lowest end of a leg would be."""
    standing = {bone for leg in figure.limbs.legs for bone in leg}
    turns, shifts = list[Any](), list[Any]()  # of each bone on each frame: z goes to turn z + shift
    low, rest = np.full(frames, np.inf), np.inf
    for bone in figure.bones:
        head, turn = complex(*bone.head), np.exp(1j * np.deg2rad(tracks.get(bone.name, np.zeros(frames))))
        above, shift = (1.0, 0.0) if bone.parent is None else (turns[bone.parent], shifts[bone.parent])
        turns.append(above * turn)
        shifts.append(above * (head - turn * head) + shift)
        if bone.name in standing:
            low = np.minimum(low, (turns[-1] * complex(*bone.tail) + shifts[-1]).imag)
            rest = min(rest, bone.tail[1])
    return rest - low if standing else np.zeros(frames)
