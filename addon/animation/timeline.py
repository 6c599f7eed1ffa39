"""When each level plays: frames of its phases and steps, their markers, and the scene's last frame."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import keys

Frames = TypeVar("Frames", float, NDArray[np.float64])


@dataclass(frozen=True)
class Timing:
    """Frame of the first step, frames from one step to the next, and whether the flow is part of the animation.

    `ease`: each phase begins and ends slowly, in the same frames. `loop_back`: after the result all plays back to the
    start.
    """

    start_frame: int = 1
    frames_per_step: int = 4
    show_flow: bool = True
    ease: bool = False
    loop_back: bool = False


class Phases(Protocol):
    """Where the phases of a level are in its steps: the last index of the flow, the first of the tightening, and the
    last of all.
    """

    @property
    def flow_end(self) -> int: ...

    @property
    def tightening(self) -> int: ...

    @property
    def last(self) -> int: ...


@dataclass(frozen=True)
class StoredPhases:
    """The phases of a level in an earlier output, as its cage stores them."""

    flow_end: int
    tightening: int
    last: int

    @classmethod
    def of(cls, cage: bpy.types.Object) -> StoredPhases | None:
        """The phases of an animated cage; None if it has none, or values that make no animation."""
        found = keys.numbers(cage, keys.PHASES, 3)
        if found is None or not 0 <= found[0] <= found[1] <= found[2]:
            return None
        return cls(*map(int, found))


@dataclass(frozen=True)
class Span:
    """The frames of one level: of the first flow step, reinflation step and tightening step, and of the result.

    `flow` equals `reinflation` if there is no flow to see."""

    flow: int
    reinflation: int
    tightening: int
    end: int


def spans(levels: Sequence[Phases], timing: Timing) -> tuple[Span, ...]:
    """When each level plays: one after the other, with a pause of one step between them."""
    found: list[Span] = []
    start = timing.start_frame
    for level in levels:
        skipped = 0 if timing.show_flow else level.flow_end

        def at(step: int, start: int = start, skipped: int = skipped) -> int:
            return start + (step - skipped) * timing.frames_per_step

        found.append(Span(start, at(level.flow_end), at(level.tightening), at(level.last)))
        start = found[-1].end + timing.frames_per_step
    return tuple(found)


def last_frame(played: Sequence[Span], timing: Timing) -> int:
    """The last frame of the whole animation; without looping back it shows the result."""
    end = played[-1].end
    return round(mirrored(timing.start_frame, end, timing)) if timing.loop_back else end


def mirrored(frame: Frames, end: int, timing: Timing) -> Frames:
    """Frame on the way back that shows what `frame` shows on the way there; the result on `end` stays for a step."""
    return 2 * end + timing.frames_per_step - frame


def step_frames(level: Phases, span: Span, timing: Timing) -> NDArray[np.float64]:
    """Frames (S,) of the steps that are shown.

    Easing moves the steps in time within their phase, so the way is the same and so is what is certified: between two
    steps the motion stays linear, and the phases begin and end on the same frames.
    """
    first = 0 if timing.show_flow else level.flow_end
    indices = np.arange(first, level.last + 1)
    frames = span.flow + (indices - first) * float(timing.frames_per_step)
    if timing.ease:
        for start, end in ((first, level.flow_end), (level.flow_end, level.tightening), (level.tightening, level.last)):
            if end > start:
                part = (indices[start - first : end - first + 1] - start) / (end - start)
                length = (end - start) * timing.frames_per_step
                frames[start - first : end - first + 1] = frames[start - first] + length * _when(part)
    return frames


def _when(part: NDArray[np.float64]) -> NDArray[np.float64]:
    """Times in [0, 1] at which smoothstep, s = 3t² - 2t³, has come to `part`: t = 1/2 - sin(asin(1 - 2s) / 3)."""
    times: NDArray[np.float64] = 0.5 - np.sin(np.arcsin(1.0 - 2.0 * part) / 3.0)
    return times


def add_markers(scene: bpy.types.Scene, played: Sequence[Span]) -> list[tuple[str, int]]:
    """Marks where the phases of each level begin; returns the markers' names and frames."""
    wanted: list[tuple[str, int]] = []
    for number, span in enumerate(played, 1):
        if span.reinflation > span.flow:
            wanted.append((f"Flow {number}", span.flow))
        wanted.append((f"Reinflation {number}", span.reinflation))
        wanted.append((f"Tightening {number}", span.tightening))
    for name, frame in wanted:
        scene.timeline_markers.new(name, frame=frame)
    return wanted


def remove_markers(scene: bpy.types.Scene, names_and_frames: Sequence[tuple[str, int]]) -> None:
    """Removes one marker for each name and frame, where it is still there."""
    for name, frame in names_and_frames:
        marker = next((m for m in scene.timeline_markers if m.name == name and m.frame == frame), None)
        if marker is not None:
            scene.timeline_markers.remove(marker)


def extend_scene(
    scene: bpy.types.Scene, collection: bpy.types.Collection, played: Sequence[Span], timing: Timing
) -> None:
    """Adds the markers of an output and lets the scene last as long; the collection stores both for `restore_scene`."""
    collection[keys.MARKERS] = json.dumps(add_markers(scene, played))
    last = last_frame(played, timing)
    if scene.frame_end < last:
        collection[keys.FRAME_END] = [scene.frame_end, last]
        scene.frame_end = last


def restore_scene(scene: bpy.types.Scene, collection: bpy.types.Collection) -> None:
    """Removes the markers of an output and the frames by which it made the scene longer."""
    remove_markers(scene, _stored_markers(collection))
    found = keys.numbers(collection, keys.FRAME_END, 2)
    if found is not None and found[0] > 0 and scene.frame_end == found[1]:
        scene.frame_end = int(found[0])
    keys.remove(collection, [keys.MARKERS, keys.FRAME_END])


def _stored_markers(collection: bpy.types.Collection) -> list[tuple[str, int]]:
    """Names and frames of an output's markers; what is not written that way is left out."""
    try:
        found = json.loads(keys.text(collection, keys.MARKERS))
    except ValueError:
        return []
    pairs = [pair for pair in found if isinstance(pair, list) and len(pair) == 2] if isinstance(found, list) else []
    return [(name, frame) for name, frame in pairs if isinstance(name, str) and isinstance(frame, int)]
