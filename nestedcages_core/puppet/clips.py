"""Clips for puppets: angles of bones over time. Every frame stays within the ranges that are proved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..errors import invalid_setting
from ..geometry.arrays import FloatArray
from .limbs import Limbs, forwards, limbs_of
from .puppet import Puppet
from .words import words_of

STRIDE, KNEE_LIFT, ARM_SWING = 22.0, 32.0, 18.0
"""Degrees of a walk: of a thigh forwards and back, of a knee while the leg swings, of an arm."""

WAVE_UP, WAVE_SWAY = 55.0, 22.0
"""Degrees of a wave: of the arm above level, of the forearm to and fro."""

SWAY, LAG = 6.0, 0.7
"""Degrees by which heads, tails and arms sway; radians by which each bone of a tail is behind the one before."""

WITHIN = 0.98
"""The part of a proved range that clips use."""


@dataclass(frozen=True)
class Clip:
    """An animation that repeats."""

    name: str
    seconds: float
    """Length; the first frame follows the last one."""
    frames: tuple[dict[str, float], ...] = field(repr=False)
    """Degrees by name of the bone, counter-clockwise, relative to the parent and to rest; at equal times."""


def walk(puppet: Puppet, *, seconds: float = 1.0, frames: int = 24) -> Clip:
    """Steps on the spot for two legs, four or more: of two legs side by side, one is half a step ahead.

    Raises NestedCagesError for a puppet with fewer than two legs.
    """
    limbs, ahead, turn = _limbs(puppet), forwards(puppet.draft), _full_turn(frames)
    if len(limbs.legs) < 2:
        raise invalid_setting(f"A walk needs two legs that reach the ground; this puppet has {len(limbs.legs)}.")
    tracks: dict[str, FloatArray] = {}
    for leg, phase in zip(limbs.legs, _phases(puppet, limbs.legs), strict=True):
        at = turn + phase
        swing, lift = ahead * STRIDE * np.sin(at), ahead * KNEE_LIFT * np.maximum(np.cos(at), 0.0)
        tracks |= dict(zip(leg, (swing, -lift, 0.7 * lift - 0.5 * swing), strict=False))
    for arm, phase in zip(limbs.arms, _phases(puppet, limbs.arms), strict=True):
        swing = ahead * ARM_SWING * np.sin(turn + phase + np.pi)
        tracks |= dict(zip(arm, (swing, 0.5 * swing + 0.5 * ahead * ARM_SWING), strict=False))
    tracks |= _swaying([*limbs.tails, *(head[:1] for head in limbs.heads)], 2.0 * turn)
    return _clip("walk", puppet, tracks, seconds, frames)


def wave(puppet: Puppet, *, seconds: float = 1.0, frames: int = 24) -> Clip:
    """One arm up, and its outer part to and fro. Raises NestedCagesError for a puppet without arms."""
    limbs, turn = _limbs(puppet), _full_turn(frames)
    if not limbs.arms:
        raise invalid_setting("A wave needs an arm; this puppet has none.")
    arm = limbs.arms[-1]  # drawn last, the nearest
    bone = next(each for each in puppet.bones if each.name == arm[0])
    along = np.array(bone.tail) - bone.head
    middle = puppet.draft.bones[0].head[0]
    target = WAVE_UP if bone.head[0] + along[0] >= middle else 180.0 - WAVE_UP
    up = (target - np.rad2deg(np.arctan2(along[1], along[0])) + 180.0) % 360.0 - 180.0
    tracks = {arm[0]: np.full(frames, up)}
    sways = arm[min(1, len(arm) - 1)]
    tracks[sways] = tracks.get(sways, np.zeros(frames)) + WAVE_SWAY * np.sin(turn)
    tracks |= _swaying([head[:1] for head in limbs.heads], turn)
    return _clip("wave", puppet, tracks, seconds, frames)


def idle(puppet: Puppet, *, seconds: float = 3.0, frames: int = 48) -> Clip:
    """Standing still: head, arms and tail sway; a puppet without any of them sways as a whole."""
    limbs = _limbs(puppet)
    swaying = [*limbs.tails, *((*head[:1],) for head in limbs.heads), *(arm[:1] for arm in limbs.arms)]
    swaying = swaying or [tuple(puppet.draft.bones[bone].name for bone in puppet.draft.chain(_root(puppet)))]
    return _clip("idle", puppet, _swaying(swaying, _full_turn(frames)), seconds, frames)


def _limbs(puppet: Puppet) -> Limbs:
    return limbs_of(puppet.draft, tuple(words_of(part.name).noun for part in puppet.draft.parts))


def _root(puppet: Puppet) -> int:
    return next(k for k, link in enumerate(puppet.draft.links) if link.parent is None)


def _full_turn(frames: int) -> FloatArray:
    """(frames,) angles of a full turn. Raises NestedCagesError for no frames."""
    if frames < 1:
        raise invalid_setting(f"A clip has at least one frame, not {frames}.")
    return np.arange(frames) * (2.0 * np.pi / frames)


def _phases(puppet: Puppet, limbs: Sequence[tuple[str, ...]]) -> list[float]:
    """When each limb steps, in radians: limbs side by side take turns, and so do those in front and behind."""
    heads = {bone.name: bone.head[0] for bone in puppet.bones}
    order = sorted(range(len(limbs)), key=lambda k: heads[limbs[k][0]])
    places = {limb: number for number, limb in enumerate(order)}
    return [np.pi * ((places[k] + 1) // 2 % 2 if len(limbs) > 2 else places[k]) for k in range(len(limbs))]


def _swaying(limbs: Sequence[tuple[str, ...]], turn: FloatArray) -> dict[str, FloatArray]:
    return {bone: SWAY * np.sin(turn - LAG * k) for limb in limbs for k, bone in enumerate(limb)}


def _clip(name: str, puppet: Puppet, tracks: Mapping[str, FloatArray], seconds: float, frames: int) -> Clip:
    """Tracks within the ranges of their bones, frame by frame. Raises NestedCagesError unless seconds are positive."""
    if not 0.0 < seconds < np.inf:
        raise invalid_setting(f"A clip takes a positive time, not {seconds!r} seconds.")
    turns = {bone.name: each for bone, each in zip(puppet.bones, puppet.ranges, strict=True)}
    kept = {
        bone: np.clip(angles, WITHIN * turns[bone].simple_low, WITHIN * turns[bone].simple_high)
        for bone, angles in tracks.items()
    }
    poses = tuple({bone: float(angles[frame]) for bone, angles in kept.items()} for frame in range(frames))
    return Clip(name, seconds, poses)
