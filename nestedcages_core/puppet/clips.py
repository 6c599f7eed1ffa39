"""Clips for puppets: angles of bones over time. Every frame stays within the ranges that are proved."""

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
"""Degrees of a walk: of a thigh forwards and back, of a knee while the leg swings, of an arm."""

WAVE_UP, LEG_UP, WAVE_SWAY = 55.0, 15.0, 22.0
"""Degrees of a wave: of the arm above level, of a leg that waves instead, of the forearm to and fro."""

SWAY, LAG = 6.0, 0.7
"""Degrees by which heads, tails and arms sway; radians by which each bone of a tail is behind the one before."""

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

    Raises NestedCagesError for a puppet with fewer than two legs.
    """
    figure, turn = _figure(puppet), _full_turn(frames)
    limbs, ahead = figure.limbs, figure.ahead
    if len(limbs.legs) < 2:
        raise invalid_setting(f"A walk needs two legs that reach the ground; this puppet has {len(limbs.legs)}.")
    tracks: dict[str, FloatArray] = {}
    for leg, phase, middle in zip(limbs.legs, _phases(figure, limbs.legs), _middles(figure), strict=True):
        at = turn + phase
        swing, lift = ahead * STRIDE * np.sin(at), ahead * KNEE_LIFT * np.maximum(np.cos(at), 0.0)
        tracks |= dict(zip(leg, (middle + swing, -lift, 0.7 * lift - 0.5 * swing), strict=False))
    for arm, phase in zip(limbs.arms, _phases(figure, limbs.arms), strict=True):
        swing = ahead * ARM_SWING * np.sin(turn + phase + np.pi)
        tracks |= dict(zip(arm, (swing, 0.5 * swing + 0.5 * ahead * ARM_SWING), strict=False))
    tracks |= _swaying([*limbs.tails, *(head[:1] for head in limbs.heads)], 2.0 * turn)
    return _clip("walk", figure, tracks, seconds, frames)


def wave(puppet: Puppet | Figure, *, seconds: float = 1.0, frames: int = 24) -> Clip:
    """One arm up, and its outer part to and fro; of a puppet without arms, the foremost leg.

    Raises NestedCagesError for a puppet without arms and legs.
    """
    figure, turn = _figure(puppet), _full_turn(frames)
    limbs, bones = figure.limbs, {bone.name: bone for bone in figure.bones}
    if not limbs.arms and not limbs.legs:
        raise invalid_setting("A wave needs an arm or a leg; this puppet has none.")
    # of those drawn last, the nearest
    arm = limbs.arms[-1] if limbs.arms else max(limbs.legs[::-1], key=lambda leg: figure.ahead * bones[leg[0]].head[0])
    bone = bones[arm[0]]
    along = np.array(bone.tail) - bone.head
    side = bone.head[0] + along[0] - figure.bones[0].head[0] if limbs.arms else figure.ahead
    level = WAVE_UP if limbs.arms else LEG_UP
    target = level if side >= 0.0 else 180.0 - level
    up = (target - np.rad2deg(np.arctan2(along[1], along[0])) + 180.0) % 360.0 - 180.0
    tracks = {arm[0]: np.full(frames, up)}
    sways = arm[min(1, len(arm) - 1)]
    tracks[sways] = tracks.get(sways, np.zeros(frames)) + WAVE_SWAY * np.sin(turn)
    tracks |= _swaying([head[:1] for head in limbs.heads], turn)
    return _clip("wave", figure, tracks, seconds, frames)


def idle(puppet: Puppet | Figure, *, seconds: float = 3.0, frames: int = 48) -> Clip:
    """Standing still: head, arms and tail sway; a puppet without any of them sways as a whole."""
    figure = _figure(puppet)
    limbs = figure.limbs
    swaying = [*limbs.tails, *((*head[:1],) for head in limbs.heads), *(arm[:1] for arm in limbs.arms)]
    swaying = swaying or [*limbs.trunks]
    return _clip("idle", figure, _swaying(swaying, _full_turn(frames)), seconds, frames)


def _figure(puppet: Puppet | Figure) -> Figure:
    return puppet if isinstance(puppet, Figure) else puppet.figure


def _full_turn(frames: int) -> FloatArray:
    """(frames,) angles of a full turn. Raises NestedCagesError for no frames."""
    if frames < 1:
        raise invalid_setting(f"A clip has at least one frame, not {frames}.")
    return np.arange(frames) * (2.0 * np.pi / frames)


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


def _swaying(limbs: Sequence[tuple[str, ...]], turn: FloatArray) -> dict[str, FloatArray]:
    return {bone: SWAY * np.sin(turn - LAG * k) for limb in limbs for k, bone in enumerate(limb)}


def _clip(name: str, figure: Figure, tracks: Mapping[str, FloatArray], seconds: float, frames: int) -> Clip:
    """Tracks within the ranges of their bones, frame by frame. Raises NestedCagesError unless seconds are positive."""
    if not 0.0 < seconds < np.inf:
        raise invalid_setting(f"A clip takes a positive time, not {seconds!r} seconds.")
    turns = {bone.name: each for bone, each in zip(figure.bones, figure.ranges, strict=True)}
    kept = {
        bone: np.clip(angles, USED * turns[bone].simple_low, USED * turns[bone].simple_high)
        for bone, angles in tracks.items()
    }
    poses = tuple({bone: float(angles[frame]) for bone, angles in kept.items()} for frame in range(frames))
    return Clip(name, seconds, poses, tuple(_rise(figure, kept, frames).tolist()))


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
