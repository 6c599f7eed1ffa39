"""Time to bind a figure of twelve parts to one cage in Blender, and to pose all its 20,000 vertices.

    python benchmarks/binding.py

Needs Blender as a Python module (bpy). Prints processor and wall-clock time, in one thread if OMP_NUM_THREADS is 1.
"""

from __future__ import annotations

import argparse
import importlib.util
import sys
import time
from types import ModuleType
from typing import Any

import bpy
import numpy as np

from clone import ROOT

PACKAGE = "nested_cages_extension"  # any name: Blender gives extensions names of its own
# Ends and radius of each limb of a figure 3.5 high.
LIMBS = (
    ((0.0, 0.2), (0.0, 1.0), 0.38), ((0.0, 1.2), (0.0, 1.5), 0.1), ((0.0, 1.62), (0.0, 1.75), 0.3),
    ((-0.1, 1.7), (-0.1, 1.71), 0.04), ((0.1, 1.7), (0.1, 1.71), 0.04), ((-0.35, 1.2), (-0.95, 1.15), 0.12),
    ((-0.95, 1.15), (-1.5, 1.1), 0.1), ((-1.55, 1.1), (-1.7, 1.1), 0.12), ((0.35, 1.2), (0.95, 1.15), 0.12),
    ((0.95, 1.15), (1.5, 1.1), 0.1), ((-0.22, 0.0), (-0.28, -1.2), 0.15), ((0.22, 0.0), (0.28, -1.2), 0.15),
)  # fmt: skip


def extension() -> ModuleType:
    """The root package as Blender's extension."""
    spec = importlib.util.spec_from_file_location(PACKAGE, ROOT / "__init__.py", submodule_search_locations=[str(ROOT)])
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = module
    spec.loader.exec_module(module)
    return module


def limb(start: tuple[float, float], end: tuple[float, float], radius: float, count: int) -> np.ndarray:
    """A capsule (count, 2) around a segment."""
    a, b = np.array(start), np.array(end)
    turn = np.arctan2(*(b - a)[::-1])
    half = np.linspace(-np.pi / 2.0, np.pi / 2.0, count // 2)
    return np.concatenate(
        [c + radius * np.column_stack([np.cos(t), np.sin(t)]) for c, t in ((b, turn + half), (a, turn + np.pi + half))]
    )


def figure(vertices: int) -> list[Any]:
    """Twelve selected outlines of so many vertices altogether."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    made = []
    for number, (start, end, radius) in enumerate(LIMBS):
        points = limb(start, end, radius, vertices // len(LIMBS))
        mesh = bpy.data.meshes.new(f"Part {number}")
        ring = np.arange(len(points))
        mesh.from_pydata([(x, y, 0.0) for x, y in points], np.column_stack([ring, np.roll(ring, -1)]).tolist(), [])
        made.append(bpy.data.objects.new(mesh.name, mesh))
        bpy.context.scene.collection.objects.link(made[-1])
        made[-1].select_set(True)
    bpy.context.view_layer.objects.active = made[0]
    return made


def seconds(work: Any) -> tuple[float, float]:
    """Processor and wall-clock time of a call."""
    wall, processor = time.perf_counter(), time.process_time()
    work()
    return time.process_time() - processor, time.perf_counter() - wall


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vertices", type=int, default=20_000, help="of all parts together")
    parser.add_argument("--frames", type=int, default=24, help="number of poses")
    given = parser.parse_args()
    package = extension()
    package.register()
    try:
        run(given.vertices, given.frames)
    finally:
        package.unregister()  # some versions of bpy hang at exit otherwise


def run(vertices: int, frames: int) -> None:
    parts = figure(vertices)
    times = seconds(lambda: bpy.ops.object.nested_cages_generate(levels="31", together=True, show_flow=False))
    print("generate: {:.2f} s of processor, {:.2f} s".format(*times))
    cage = next(obj for obj in bpy.data.objects if obj.name.endswith("Cage 1"))
    print("bind:     {:.2f} s of processor, {:.2f} s".format(*seconds(bpy.ops.object.nested_cages_bind)))
    rest = np.array([vertex.co for vertex in cage.data.vertices])
    arm = rest[:, 0] < -0.9

    def pose(turn: float) -> None:
        bent = rest.copy()
        cosine, sine = np.cos(turn), np.sin(turn)
        bent[arm, :2] = (rest[arm, :2] - (-0.95, 1.15)) @ [[cosine, sine], [-sine, cosine]] + (-0.95, 1.15)
        cage.data.vertices.foreach_set("co", bent.astype(np.float32).ravel())
        cage.data.update()
        bpy.context.view_layer.update()

    pose(0.0)
    times = seconds(lambda: [pose(np.pi / 3.0 * frame / frames) for frame in range(frames)])
    count = sum(len(part.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices) for part in parts)
    print(
        f"pose {count} vertices of {len(parts)} parts under {len(rest)}: {1e3 * times[0] / frames:.1f} ms of CPU, "
        f"{1e3 * times[1] / frames:.1f} ms, {frames / times[1]:.0f} frames a second"
    )


if __name__ == "__main__":
    main()
