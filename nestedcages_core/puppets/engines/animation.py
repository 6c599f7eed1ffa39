"""Animations of bones as keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ...errors import invalid_setting
from ...geometry.arrays import FloatArray
from ..skeleton.bone import Bone
from ..walk import Clip


@dataclass(frozen=True, eq=False)
class Animation:
    """Keys of bones at common times, linear in between."""

    name: str
    times: FloatArray
    """(K,) seconds, from 0 on, increasing."""
    turned: Mapping[str, FloatArray]
    """(K,) degrees by name of the bone, counter-clockwise, relative to its parent and to rest; not wrapped."""
    shifted: Mapping[str, FloatArray] = field(default_factory=dict)
    """(K, 2) by name of the bone: how far its head is from rest, in pixels along the axes of the drawing at rest, y
    pointing up, before its parent moves it."""
    loops: bool = True

    @classmethod
    def of(cls, clip: Clip) -> Animation:
        """A clip, which repeats: its first frame again at the end."""
        frames = (*clip.frames, clip.frames[0])
        names = dict.fromkeys(name for frame in frames for name in frame)
        turned = {name: np.array([frame.get(name, 0.0) for frame in frames]) for name in names}
        return cls(clip.name, clip.seconds * np.arange(len(frames)) / len(clip.frames), turned)

    def check(self, bones: Sequence[Bone]) -> None:
        """Raise NestedCagesError for keys of no bone, and for wrong times or numbers of keys."""
        times, names = np.asarray(self.times), {bone.name for bone in bones}
        if times.ndim != 1 or not len(times) or times[0] != 0.0 or not (np.diff(times) > 0.0).all():
            raise invalid_setting(f"The times of the animation {self.name!r} must increase from 0 on.")
        for keys, shape in ((self.turned, times.shape), (self.shifted, (len(times), 2))):
            for name, values in keys.items():
                if name not in names:
                    raise invalid_setting(f"The animation {self.name!r} moves {name!r}, which is no bone.")
                if np.shape(values) != shape or not np.isfinite(values).all():
                    raise invalid_setting(f"The keys of {name!r} in {self.name!r} must be {shape} finite numbers.")
