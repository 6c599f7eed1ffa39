"""When each level plays: frames of its phases and steps, the marker of the result, and the scene's range."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass
from itertools import pairwise

import numpy as np
from bpy.types import Scene

from .. import cage_sets
from ..cage_sets import CageSet
from ..core import core
from ..errors import FloatArray

# Name and frame of a marker.
Mark = tuple[str, int]


@dataclass(frozen=True)
class Timing:
    """First frame, frames per step, and whether the flow is part of the animation.

    `length`: frames that everything takes, whatever the number of steps; 0 for frames per step.
    """

    start_frame: int = 1
    frames_per_step: int = 4
    show_flow: bool = True
    length: int = 0


@dataclass(frozen=True)
class Phases:
    """The phases of a level as indices of steps: last of the flow, first of the tightening, and last of all."""

    flow_end: int
    tightening: int
    last: int

    @classmethod
    def of(cls, level: core.Level) -> Phases:
        """The phases of a level whose flow and reinflation play in one sequence."""
        flow_end, way = len(level.flow.steps) - 1, level.reinflation
        return cls(flow_end, flow_end + way.tightening_start, flow_end + len(way.cage_steps) - 1)


@dataclass(frozen=True)
class Span:
    """The frames of one level: of the first flow step, reinflation step and tightening step, and of the result.

    `flow` equals `reinflation` if the flow is not shown."""

    flow: int
    reinflation: int
    tightening: int
    end: int


def spans(levels: Sequence[Phases], timing: Timing) -> tuple[Span, ...]:
    """When each level plays: one after the other, with a pause of one step between them."""
    played: list[Span] = []
    start, per_step = float(timing.start_frame), _frames_per_step(levels, timing)
    for level in levels:
        skipped = 0 if timing.show_flow else level.flow_end
        frames = [round(start)]
        for before, after in pairwise((skipped, level.flow_end, level.tightening, level.last)):
            # A phase with steps takes at least one frame.
            frames.append(max(round(start + (after - skipped) * per_step), frames[-1] + (after > before)))
        played.append(Span(*frames))
        start = max(start + (level.last - skipped + 1) * per_step, frames[-1] + 1.0)
    return tuple(played)


def _frames_per_step(levels: Sequence[Phases], timing: Timing) -> float:
    """Frames from one step to the next; fractional if the animation is fitted to a length."""
    if not timing.length:
        return float(timing.frames_per_step)
    shown = sum(level.last - (0 if timing.show_flow else level.flow_end) for level in levels) + len(levels) - 1
    return max(timing.length - 1.0, 1.0) / max(shown, 1)


def step_frames(level: Phases, span: Span, timing: Timing) -> FloatArray:
    """Frames (S,) of the steps that are shown."""
    first = 0 if timing.show_flow else level.flow_end
    indices = np.arange(first, level.last + 1)
    frames = np.full(len(indices), float(span.flow))
    phases = zip((first, level.flow_end, level.tightening, level.last), astuple(span), strict=True)
    for (start, start_frame), (end, end_frame) in pairwise(phases):
        if end > start:
            done = (indices[start - first : end - first + 1] - start) / (end - start)
            frames[start - first : end - first + 1] = start_frame + (end_frame - start_frame) * done
    return frames


def play_in(cage_set: CageSet, played: Sequence[Span], marker: Mark | None = None) -> Mark:
    """Notes when an output plays, and its marker, one of its own unless several share one; returns the marker."""
    stored, result = cage_set.record, played[-1].end
    noted = stored.markers.add()
    noted.name, noted.frame = marker or (stored.title or cage_set.name, result)
    stored.frames, stored.animated = (played[0].flow, result, result), True
    return noted.name, noted.frame


def settle(scene: Scene, dropped: Sequence[Mark], added: Sequence[Mark] = ()) -> None:
    """Removes markers that no output needs any more, adds new ones, and fits the scene's range to what plays."""
    needed = {(mark.name, mark.frame) for each in CageSet.everywhere() for mark in each.record.markers}
    for name, frame in set(dropped) - needed:
        marker = next((m for m in scene.timeline_markers if m.name == name and m.frame == frame), None)
        if marker is not None:
            scene.timeline_markers.remove(marker)
    there = {(mark.name, mark.frame) for mark in scene.timeline_markers}
    for name, frame in dict.fromkeys(added):
        if (name, frame) not in there:
            scene.timeline_markers.new(name, frame=frame)
    _fit_range(scene)


def stop_playing(cage_set: CageSet) -> list[Mark]:
    """Notes that an output does not play any more; returns its markers."""
    noted = cage_set.record
    dropped = [(marker.name, marker.frame) for marker in noted.markers]
    noted.markers.clear()
    noted.animated = False
    return dropped


def frames_of(cage_set: CageSet) -> tuple[int, int, int] | None:
    """First frame of an output's animation, frame of its result, and last frame; None if it has no animation."""
    return tuple(cage_set.record.frames) if cage_set.record.animated else None


def _fit_range(scene: Scene) -> None:
    """Fits the scene's range to the animations in it; ends that the user has changed since are kept."""
    now = (scene.frame_start, scene.frame_end)
    stored = cage_sets.range_of(scene) or (*now, *now)
    start, end = (before if at == ours else at for before, ours, at in zip(stored[:2], stored[2:], now, strict=True))
    playing = [(each, frames_of(each)) for each in CageSet.everywhere()]
    played = [frames for each, frames in playing if frames is not None and _plays_in(scene, each)]
    first = min([start, *(max(frames[0], 0) for frames in played)])
    last = max([end, *(frames[2] for frames in played)])
    if (first, last) != now:
        scene.frame_start, scene.frame_end = first, last
    if not played:
        cage_sets.set_range(scene, None)
    elif (first, last) != (start, end):
        cage_sets.set_range(scene, (start, end, first, last))


def _plays_in(scene: Scene, cage_set: CageSet) -> bool:
    """Whether objects of an output are in the scene."""
    return any(scene.objects.get(obj.name) == obj for obj in cage_set.members)
