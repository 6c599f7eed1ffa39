"""Time to write a large animation into Blender: ours, and that of the same calls of Blender alone.

    python benchmarks/blender_writing.py --vertices 10000 --steps 200

Needs Blender as a Python module (bpy). Three ways to the same shape keys and keyframes, each in an empty file and each
the fastest of `--repeats`:

* ours: `addon.animation.shape_keys.add_steps`, as the operator calls it;
* ours, recorded: the same with every call that goes to Blender timed, whose sum is Blender's part;
* Blender alone: a bare loop over ready-made arrays with the calls that `add_steps` makes.

Own time is ours less Blender's part. What the clock itself costs is measured too and counted to neither.
"""

from __future__ import annotations

import argparse
import atexit
import time
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Any

import bpy
import numpy as np

from binding import PACKAGE, extension

FRAMES_PER_STEP = 4


class Recorded:
    """Stands for an object of Blender and adds up the time that its calls, reads and writes take."""

    seconds = 0.0
    calls = 0

    def __init__(self, target: Any) -> None:
        object.__setattr__(self, "target", target)

    def __getattr__(self, name: str) -> Any:
        return _timed(lambda: getattr(self.target, name))

    def __setattr__(self, name: str, value: Any) -> None:
        plain = _plain(value)
        _timed(lambda: setattr(self.target, name, plain))

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        plain = [_plain(item) for item in arguments]
        return _timed(lambda: self.target(*plain, **named))

    def __eq__(self, other: object) -> bool:
        return self.target == other

    __hash__ = None  # type: ignore[assignment]


def _plain(item: Any) -> Any:
    return item.target if isinstance(item, Recorded) else item


def _timed(work: Callable[[], Any]) -> Any:
    """Does the work, counts its time, and records what comes back if that is Blender's too."""
    before = time.perf_counter()
    found = work()
    Recorded.seconds += time.perf_counter() - before
    Recorded.calls += 1
    if found is None or isinstance(found, (str, int, float)):
        return found
    return Recorded(found)


def steps_of(vertices: int, steps: int) -> np.ndarray:
    """A circle (steps, vertices, 2) that shrinks and grows back, with another shape on each step."""
    angles = np.linspace(0.0, 2.0 * np.pi, vertices, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    size = 1.0 - 0.5 * np.sin(np.pi * np.arange(steps) / (steps - 1))
    size[-1] = 1.0
    size *= np.where(np.arange(steps) < steps - 1, 1.0 - 1e-3 * (np.arange(steps) + 1) / steps, 1.0)
    return (ring[None] * size[:, None, None]).astype(np.float32)


def fresh(points: np.ndarray) -> bpy.types.Object:
    """An object with the closed outline (n, 2) in an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    count = len(points)
    mesh = bpy.data.meshes.new("Large")
    mesh.vertices.add(count)
    mesh.edges.add(count)
    mesh.vertices.foreach_set("co", np.column_stack([points, np.zeros(count, np.float32)]).ravel())
    mesh.edges.foreach_set("vertices", np.column_stack([np.arange(count), np.roll(np.arange(count), -1)]).ravel())
    mesh.update()
    obj = bpy.data.objects.new("Large", mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def ours(animation: ModuleType, steps: np.ndarray, frames: np.ndarray) -> float:
    """Seconds of our function."""
    obj = fresh(steps[-1])
    before = time.perf_counter()
    animation.add_steps(obj, steps, frames, "Level 1")
    return time.perf_counter() - before


def recorded(animation: ModuleType, steps: np.ndarray, frames: np.ndarray) -> tuple[float, int]:
    """Seconds that Blender took of our function, and how many times it was called."""
    obj = fresh(steps[-1])
    Recorded.seconds, Recorded.calls = 0.0, 0
    plain, animation.bpy = animation.bpy, Recorded(bpy)
    try:
        animation.add_steps(Recorded(obj), steps, frames, "Level 1")
    finally:
        animation.bpy = plain
    return Recorded.seconds - Recorded.calls * clock(), Recorded.calls


def clock() -> float:
    """Seconds that timing one call adds to the time that is told."""
    Recorded.seconds, seconds, calls = 0.0, Recorded.seconds, Recorded.calls
    for _ in range(1000):
        _timed(lambda: None)
    told, Recorded.seconds, Recorded.calls = Recorded.seconds, seconds, calls
    return told / 1000


def blender_alone(steps: np.ndarray, frames: np.ndarray) -> float:
    """Seconds of the bare calls, with everything that is handed to them made before."""
    obj = fresh(steps[-1])
    flat = [np.column_stack([step, np.zeros(len(step), np.float32)]).ravel() for step in steps[:-1]]
    paths = [f'key_blocks["Level 1 Step {index}"].value' for index in range(len(flat))]
    curves = [
        [
            *((float(frames[index - 1]), 0.0) if index else ()),
            *(float(frames[index]), 1.0, float(frames[index + 1]), 0.0),
        ]
        for index in range(len(flat))
    ]
    linear = [1, 1, 1]
    before = time.perf_counter()
    obj.shape_key_add(name="Basis", from_mix=False)
    for index, coordinates in enumerate(flat):
        key = obj.shape_key_add(name=f"Level 1 Step {index}", from_mix=False)
        key.points.foreach_set("co", coordinates)
    keys = obj.data.shape_keys
    action = keys.animation_data_create().action = bpy.data.actions.new("Large Steps")
    for path, keyframes in zip(paths, curves, strict=True):
        if hasattr(action, "fcurve_ensure_for_datablock"):
            curve = action.fcurve_ensure_for_datablock(keys, path)
        else:
            curve = action.fcurves.new(path)
        count = len(keyframes) // 2
        curve.keyframe_points.add(count)
        curve.keyframe_points.foreach_set("co", keyframes)
        curve.keyframe_points.foreach_set("interpolation", linear[:count])
        curve.update()
    return time.perf_counter() - before


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vertices", type=int, default=10_000)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()
    package = extension()
    package.register()
    atexit.register(package.unregister)
    animation = import_module(f"{PACKAGE}.addon.animation.shape_keys")
    steps = steps_of(arguments.vertices, arguments.steps)
    frames = 1 + np.arange(arguments.steps) * FRAMES_PER_STEP
    whole = min(ours(animation, steps, frames) for _ in range(arguments.repeats))
    inside, calls = min(recorded(animation, steps, frames) for _ in range(arguments.repeats))
    alone = min(blender_alone(steps, frames) for _ in range(arguments.repeats))
    print(f"{arguments.vertices} vertices, {arguments.steps} steps; fastest of {arguments.repeats}")
    print(f"ours, in all                     {whole:8.4f} s")
    print(f"  of which Blender, {calls:5d} calls   {inside:8.4f} s")
    print(f"  own time                       {whole - inside:8.4f} s")
    print(f"the same calls of Blender alone  {alone:8.4f} s")
    print(f"  ours beyond them               {whole - alone:8.4f} s")


if __name__ == "__main__":
    main()
