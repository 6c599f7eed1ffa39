"""Checks the cages in a .blend file as Blender plays them: `nested-cages check FILE.blend` runs this program.

On the last frame each cage must enclose the inner mesh, and the fine mesh must have the source's coordinates, bit by
bit. From the end of a level's flow on, the cage must meet neither the inner mesh nor itself between one half frame and
the next. Judged by the independent checker, exactly; the exit status is 1 if anything is wrong.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from nestedcages_core.checker import faults_of_cage, faults_of_motion  # noqa: E402

SAME_POINT = 1e-6
"""Share of the drawing's size below which two points of a curve are one, where two of its pieces meet."""


class Pose(NamedTuple):
    """Evaluated vertices (n, 2) and edges (m, 2) of a mesh object in its own plane."""

    vertices: NDArray[np.float64]
    edges: NDArray[np.int64]


def extension() -> Any:
    """The extension of this folder, registered."""
    spec = importlib.util.spec_from_file_location(
        "played", ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
    )
    assert spec is not None and spec.loader is not None
    package = importlib.util.module_from_spec(spec)
    sys.modules["played"] = package
    spec.loader.exec_module(package)
    package.register()
    return package


def faults_of_set(cages: Any) -> tuple[int, list[str]]:
    """The number of poses checked, and a sentence for each fault of a set of cages."""
    frames = [certificate.frames for certificate in cages.certificates if certificate.frames[0] >= 0]
    if len(frames) < len(cages):
        return 0, [f"{cages.name}: its animation was removed"]
    checked = list(faults_of_poses([cages.fine, *cages], frames, cages.inside))
    return len(checked), [*(fault for faults in checked for fault in faults), *faults_at_end(cages, frames[-1][3])]


def faults_of_poses(meshes: list[Any], frames: list[Any], inside: bool) -> Iterator[list[str]]:
    """Faults of each pair of neighbouring levels at each half frame, finest level first."""
    first, last = min(flow for flow, *_ in frames), frames[-1][3]
    before: dict[int, tuple[Pose, Pose]] = {}
    for half in range(2 * first, 2 * last + 1):
        frame = half / 2
        bpy.context.scene.frame_set(half // 2, subframe=half % 2 / 2)
        for level, (inner, cage) in enumerate(pairwise(meshes)):
            if frame < frames[level][1] or any(flows(outer, frame) for outer in frames[level + 1 : level + 2]):
                before.pop(level, None)
                continue
            now = evaluated(cage), evaluated(inner)
            faults = faults_between(before[level], now) if level in before else []
            if frame == last:
                faults += faults_of_cage(*(now[::-1] if inside else now), alike=False)
            before[level] = now
            yield [f"frame {frame:g}, level {level} in level {level + 1}: {fault}" for fault in faults]


def flows(outer: tuple[int, int, int, int], frame: float) -> bool:
    """Whether a cage is away from home because the level around it, with these frames, has a flow of its own."""
    flow, reinflation, tightening, _ = outer
    return flow != reinflation and flow < frame < tightening


def faults_between(before: tuple[Pose, Pose], now: tuple[Pose, Pose]) -> list[str]:
    """Contacts of a cage with its inner mesh or itself on straight lines from one moment to the next."""
    cage, inner = (np.stack((start.vertices, end.vertices)) for start, end in zip(before, now, strict=True))
    return faults_of_motion(now[0].edges, now[1].edges, cage, inner, [0])


def faults_at_end(cages: Any, last: int) -> list[str]:
    """Whether the fine mesh on the last frame has the very coordinates of the source, and lies where it does."""
    source, fine = cages.source, cages.fine
    bpy.context.scene.frame_set(last)
    if fine.matrix_world != source.matrix_world:
        return ["on the last frame: the fine mesh does not lie where the source does"]
    shown, drawn = vertices(displayed(fine)), outline(source)
    strange = len({*map(tuple, shown.tolist())} - {*map(tuple, drawn.tolist())})
    reach = SAME_POINT * float(np.linalg.norm(np.ptp(drawn, axis=0)))
    lost = int(sum(np.abs(shown - point).max(axis=1).min() > reach for point in drawn))
    return [
        *([f"on the last frame: {strange} vertices of the fine mesh are not those of the source"] if strange else []),
        *([f"on the last frame: {lost} points of the source are missing"] if lost else []),
    ]


def displayed(item: Any) -> Any:
    """The mesh of an object as the dependency graph shows it now."""
    return item.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


def evaluated(item: Any) -> Pose:
    mesh = displayed(item)
    edges = np.empty((len(mesh.edges), 2), np.int32)
    mesh.edges.foreach_get("vertices", edges.ravel())
    return Pose(vertices(mesh)[:, :2].astype(np.float64), edges.astype(np.int64))


def vertices(mesh: Any) -> NDArray[np.float32]:
    """Vertices (n, 3) of a mesh, as stored."""
    points = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    return points


def outline(source: Any) -> NDArray[np.float32]:
    """Points (n, 3) of a curve's outline or of a mesh, in the object's own space."""
    if source.type != "CURVE":
        return vertices(displayed(source))
    copy, data = source.copy(), source.data.copy()
    data.dimensions = "3D"  # a filled curve shows its area, and that leaves points out
    data.bevel_depth = data.extrude = 0.0
    copy.data = data
    try:
        return vertices(copy.to_mesh())
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.curves.remove(data)


def main(path: str) -> int:
    """Check a file; the exit status."""
    package = extension()  # it knows what is a cage; what plays is checked without it
    try:
        bpy.ops.wm.open_mainfile(filepath=str(Path(path).resolve()))
        sets = package.CageSet.everywhere()
        checked = [faults_of_set(cages) for cages in sets]
    finally:
        package.unregister()
    faults = [fault for _, found in checked for fault in found] if sets else ["there are no cages in the file"]
    for fault in faults:
        print(f"wrong: {fault}", file=sys.stderr)
    if not faults:
        print(
            f"Animation: {sum(poses for poses, _ in checked)} poses on frames and half frames checked: no cage touches"
        )
        print("what it encloses, and on the last frame the fine mesh has the drawing's coordinates, bit by bit.")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
