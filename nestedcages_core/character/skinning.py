"""Vertices under a pose of bones: rotations and translations blended as dual quaternions, which keeps limbs thick."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..geometry.arrays import FloatArray
from .bones import Bone, ends_of


def skinned(points: FloatArray, weights: FloatArray, bones: Sequence[Bone], turned: Mapping[int, float]) -> FloatArray:
    """(P, 2) points moved by bones that are turned around their heads.

    points: (P, 2) at rest; weights: (P, B), rows of sum 1; turned: degrees, counter-clockwise, by number of the bone,
    relative to its parent. As Blender's Armature modifier with *Preserve Volume* (dual quaternions, Kavan et al. 2007).
    """
    ends_of(bones)
    turns, shifts = np.ones(len(bones), dtype=np.complex128), np.zeros(len(bones), dtype=np.complex128)
    halves = np.zeros(len(bones))
    for number, bone in enumerate(bones):  # z -> turn z + shift, in the complex plane
        angle = np.deg2rad(turned.get(number, 0.0))
        own, head = np.exp(1j * angle), complex(*bone.head)
        turn, shift, half = own, head - own * head, 0.5 * angle
        if bone.parent is not None:
            above = turns[bone.parent]
            turn, shift, half = above * own, above * shift + shifts[bone.parent], half + halves[bone.parent]
        turns[number], shifts[number], halves[number] = turn, shift, half
    real = np.exp(1j * halves)
    dual = 0.5 * shifts * np.conj(real)
    strongest = real[weights.argmax(axis=1)]
    signs = np.where(np.real(real[None] * np.conj(strongest)[:, None]) < 0.0, -1.0, 1.0)
    blended, moved = (weights * signs) @ real, (weights * signs) @ dual
    size = np.abs(blended)
    blended, moved = blended / size, moved / size
    z = blended**2 * (points[:, 0] + 1j * points[:, 1]) + 2.0 * moved * blended
    return np.stack((z.real, z.imag), axis=1)
