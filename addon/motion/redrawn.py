"""Drawings that are new from frame to frame, as in Grease Pencil: each is held until the next one, and so are
its cages. Does not touch the scene.

Since drawings of different loops have no common topology, a tight ring around each stands for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from bpy.types import Object

from ..blender.jobs import Progress, Work
from ..core import core
from ..drawing.grease_pencil import KINDS
from ..drawing.planar import Drawing
from ..drawing.plane import united
from ..errors import FloatArray, UserError
from ..generate.options import Options
from ..generate.run import Generation, Request

# Vertices of a ring: those of the drawing, but at most so many, and so many times those of the cages at least.
MOST_OF_A_RING, MULTIPLE = 256, 3


@dataclass(frozen=True)
class Poses:
    """The outline of an object on frames (T,): points (T, n, 2), float32 values as float64, in the plane of
    ``drawing``, the first pose.

    The frame of the drawing is in the object's space, so the object's own transform is not part of the motion.
    ``scale`` is the world length of its unit on the first frame. ``redrawn``: the drawings (T,) that have no common
    topology, in place of points.
    """

    drawing: Drawing
    frames: FloatArray
    points: FloatArray
    scale: float
    redrawn: tuple[Drawing, ...] = ()


def is_redrawn(obj: Object, frames: Sequence[int]) -> bool:
    """Whether an object has several keys with drawings of their own on some frames."""
    if obj.type != KINDS[0]:
        return False
    keys = [[key.frame_number for key in layer.frames] for layer in obj.data.layers]
    return any(frames[0] < number <= frames[-1] for numbers in keys for number in numbers)


def runs(poses: Poses) -> list[int]:
    """The indices of the frames on which another drawing begins."""
    shown = [[loop.tobytes() for loop in drawing.loops] for drawing in poses.redrawn]
    return [number for number, loops in enumerate(shown) if not number or loops != shown[number - 1]]


def in_one(poses: Poses) -> Poses:
    """All drawings as one that stands still."""
    shown = [poses.redrawn[number] for number in runs(poses)]
    areas = [core.formats.Painted(drawing.loops, evenodd=True) for drawing in shown]
    whole = replace(shown[0], loops=united(shown[0].name, areas), united=True)
    points = np.concatenate(whole.loops)
    return replace(poses, drawing=whole, frames=poses.frames[[0, -1]], points=np.stack([points, points]))


def certificates(cage: core.Mesh, poses: Poses) -> Iterator[core.Certificate]:
    """That a cage encloses each drawing. Raises: UserError."""
    for number in runs(poses):
        yield _certificate(cage, poses.redrawn[number].mesh(), f"Frame {poses.frames[number]:g}")


def rings(poses: Poses, wanted: Sequence[int], options: Options) -> Work[list[list[core.Mesh]]]:
    """For the ring and each cage, finest first: its shapes around the drawings, of one topology. Raises: UserError."""
    counts = list(wanted)
    largest = max(sum(map(len, drawing.loops)) for drawing in poses.redrawn)
    counts.insert(0, max(min(largest, MOST_OF_A_RING), MULTIPLE * max(counts)))
    asked, numbers = replace(options, levels=tuple(counts), loops="one"), runs(poses)
    shapes: list[list[core.Mesh]] = [[] for _ in counts]
    for done, number in enumerate(numbers):
        drawing = poses.redrawn[number]
        named = replace(drawing, name=f"{drawing.name}, frame {poses.frames[number]:g}")
        generation = Generation([Request(named)], asked)
        for step in generation:
            yield Progress((done + step.fraction) / len(numbers), step.message)
        inner = drawing.mesh()
        for made, count, level in zip(shapes, counts, generation.results[0].levels, strict=True):
            made.append(_filled_up(level.cage, count))
            _certificate(made[-1], inner, named.name)
            inner = made[-1]
    return shapes


def _certificate(cage: core.Mesh, inner: core.Mesh, name: str) -> core.Certificate:
    certificate = core.verify(cage, inner, same_loops=False)
    if not certificate.holds:
        raise UserError(f"{name}: the cage does not enclose the drawing: ask for more clearance")
    return certificate


def _filled_up(cage: core.Mesh, count: int) -> core.Mesh:
    """A cage of one loop with further vertices in the middle of its longest edges, up to a number of them."""
    loop: FloatArray = cage.vertices[cage.loops[0]]
    while len(loop) < count:
        ends = np.roll(loop, -1, axis=0)
        longest = int(np.linalg.norm(ends - loop, axis=1).argmax())
        middle = (0.5 * (loop[longest] + ends[longest])).astype(np.float32)
        loop = np.insert(loop, longest + 1, middle, axis=0)
    return core.Mesh.from_loops([loop])
