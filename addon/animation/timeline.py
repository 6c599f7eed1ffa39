"""When each level plays: frames of its phases and steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..core import core
from ..errors import FloatArray


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
class Span:
    """The frames of one level: of the first flow step, reinflation step and tightening step, of the result, and (S,) of
    all steps that are shown.

    `flow` equals `reinflation` if the flow is not shown."""

    flow: int
    reinflation: int
    tightening: int
    end: int
    steps: FloatArray


def spans(levels: Sequence[core.Level], timing: Timing) -> list[Span]:
    """When each level plays: one after the other, with a pause of one step between them. Flow and reinflation of a
    level are one sequence.
    """
    phases = [_phases(level, timing) for level in levels]
    shown = sum(last - first for first, *_, last in phases) + len(levels) - 1
    # Fractional if the animation is fitted to a length.
    per_step = max(timing.length - 1.0, 1.0) / max(shown, 1) if timing.length else float(timing.frames_per_step)
    played: list[Span] = []
    start = float(timing.start_frame)
    for steps in phases:
        frames = [round(start)]
        for before, after in pairwise(steps):
            # A phase with steps takes at least one frame.
            frames.append(max(round(start + (after - steps[0]) * per_step), frames[-1] + (after > before)))
        flow, reinflation, tightening, end = frames
        played.append(Span(flow, reinflation, tightening, end, _step_frames(steps, frames)))
        start = max(start + (steps[-1] - steps[0] + 1) * per_step, frames[-1] + 1.0)
    return played


def _phases(level: core.Level, timing: Timing) -> tuple[int, int, int, int]:
    """Steps of a level: the first that is shown, the last of the flow, the first of the tightening, and the last."""
    flow_end, path = len(level.flow.steps) - 1, level.reinflation
    return (
        0 if timing.show_flow else flow_end,
        flow_end,
        flow_end + path.tightening_start,
        flow_end + len(path.cage_steps) - 1,
    )


def _step_frames(phases: Sequence[int], frames: Sequence[int]) -> FloatArray:
    """Frames (S,) of the steps that are shown, at equal distances within each phase."""
    first = phases[0]
    indices = np.arange(first, phases[-1] + 1)
    found = np.full(len(indices), float(frames[0]))
    for (start, start_frame), (end, end_frame) in pairwise(zip(phases, frames, strict=True)):
        if end > start:
            done = (indices[start - first : end - first + 1] - start) / (end - start)
            found[start - first : end - first + 1] = start_frame + (end_frame - start_frame) * done
    return found
