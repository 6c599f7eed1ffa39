"""Checks the cages in a .blend file as Blender plays them, by the independent checker, exactly.

Run as ``python examples/check_animation.py FILE.blend``; exit status 1 if anything is wrong. On the last frame each
cage must enclose the inner mesh, and the fine mesh must have the source's coordinates, bit by bit. From the end of a
level's flow on, the cage must meet neither the inner mesh nor itself between one half frame and the next.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parent))

from extension import PACKAGE, registered
from nestedcages_core.checker import faults_of_cage, faults_of_motion

DOUBLED = 1e-6  # of the drawing's size: points of a curve that are closer are one point, where two pieces meet


@dataclass(frozen=True)
class Played:
    """A set of cages, finest first, and when each plays: first frames of its phases, and of the result; empty if the
    animation was removed. inside: whether the cages lie inside the drawing.
    """

    name: str
    source: bpy.types.Object
    fine: bpy.types.Object
    cages: list[bpy.types.Object]
    frames: list[tuple[int, int, int, int]]
    inside: bool = False


def played() -> list[Played]:
    """The sets of the file, while the add-on is registered."""
    found = import_module(PACKAGE).CageSet.everywhere()
    times = {cage_set: [each.frames for each in cage_set.certificates if each.frames[0] >= 0] for cage_set in found}
    return [Played(s.name, s.source, s.fine, s.cages, times[s], s.inside) for s in found]


@dataclass(frozen=True)
class Outcome:
    """What was looked at, and a sentence for each thing that is wrong."""

    poses: int
    problems: tuple[str, ...]


@dataclass(frozen=True)
class Pose:
    """Evaluated vertices (n, 2) and edges (m, 2) of a mesh object in its own plane."""

    vertices: np.ndarray
    edges: np.ndarray


def check_animation(scene: bpy.types.Scene, sets: list[Played]) -> Outcome:
    """Checks sets of cages in `scene`."""
    problems = [] if sets else ["there are no cages in the scene"]
    poses = 0
    before = scene.frame_current
    for cage_set in sets:
        if len(cage_set.frames) < len(cage_set.cages):
            problems.append(f"{cage_set.name}: its animation was removed")
            continue
        for name, found in checked_poses(scene, cage_set):
            poses += 1
            problems += [f"{name}: {problem}" for problem in found]
        problems += home_problems(scene, cage_set)
    scene.frame_set(before)
    return Outcome(poses, tuple(problems))


def checked_poses(scene: bpy.types.Scene, cage_set: Played) -> Iterator[tuple[str, list[str]]]:
    """Goes through a set's animation: name and problems of each pair of levels at each half frame."""
    levels, last = [cage_set.fine, *cage_set.cages], cage_set.frames[-1][3]
    before: dict[int, tuple[Pose, Pose]] = {}
    for half in range(2 * min(flow for flow, *_ in cage_set.frames), 2 * last + 1):
        frame = half / 2
        scene.frame_set(half // 2, subframe=half % 2 / 2)
        graph = bpy.context.evaluated_depsgraph_get()
        for level, (inner, cage) in enumerate(itertools.pairwise(levels), 1):
            if frame >= cage_set.frames[level - 1][1] and not any(flows(o, frame) for o in cage_set.frames[level:][:1]):
                name = f"frame {frame:g}, level {level - 1} in level {level}"
                pair = (evaluated(cage, graph), evaluated(inner, graph))
                problems = contacts(before[level], pair) if level in before else []
                if frame == last:
                    problems += faults_of_cage(*(pair[::-1] if cage_set.inside else pair), alike=False)
                before[level] = pair
                yield name, problems
            else:
                before.pop(level, None)


def flows(outer: tuple[int, int, int, int], frame: float) -> bool:
    """Whether a cage is away from home because the level around it, with these frames, has a flow of its own."""
    flow, reinflation, tightening, _ = outer
    return flow != reinflation and flow < frame < tightening


def evaluated(item: bpy.types.Object, graph: bpy.types.Depsgraph) -> Pose:
    """The object as the dependency graph shows it now."""
    mesh = item.evaluated_get(graph).data
    points = np.empty((len(mesh.vertices), 3), np.float32)
    edges = np.empty((len(mesh.edges), 2), np.int32)
    mesh.vertices.foreach_get("co", points.ravel())
    mesh.edges.foreach_get("vertices", edges.ravel())
    return Pose(points[:, :2].astype(np.float64), edges.astype(np.int64))


def contacts(before: tuple[Pose, Pose], now: tuple[Pose, Pose]) -> list[str]:
    """Contacts of the outer one of two meshes with the inner one or itself between two moments, on straight lines."""
    (outer, inner), steps = now, [np.stack([a.vertices, b.vertices]) for a, b in zip(before, now, strict=True)]
    return faults_of_motion(outer.edges, inner.edges, steps[0], steps[1], [0])


def home_problems(scene: bpy.types.Scene, cage_set: Played) -> list[str]:
    """Whether the fine mesh on the last frame has the very coordinates of the source, and lies where it does."""
    source, fine = cage_set.source, cage_set.fine
    scene.frame_set(cage_set.frames[-1][3])
    graph = bpy.context.evaluated_depsgraph_get()
    shown = points_of(fine.evaluated_get(graph).data)
    wanted = outline_of(source)
    if fine.matrix_world != source.matrix_world:
        return ["on the last frame: the fine mesh does not lie where the source does"]
    problems: list[str] = []
    strangers = {tuple(point) for point in shown.tolist()} - {tuple(point) for point in wanted.tolist()}
    if strangers:
        problems.append(f"on the last frame: {len(strangers)} vertices of the fine mesh are not those of the source")
    reach = DOUBLED * float(np.linalg.norm(np.ptp(wanted, axis=0)))
    gaps = np.array([np.abs(shown - point).max(axis=1).min() for point in wanted])
    lost = np.count_nonzero(gaps > reach)
    if lost:
        problems.append(f"on the last frame: {lost} points of the source are missing")
    return problems


def outline_of(source: bpy.types.Object) -> np.ndarray:
    """Points (n, 3) of a curve's outline or of a mesh, in the object's own space."""
    if source.type != "CURVE":
        return points_of(source.evaluated_get(bpy.context.evaluated_depsgraph_get()).data)
    copy, data = source.copy(), source.data.copy()
    data.dimensions = "3D"  # a filled curve shows its area, and that leaves points out
    data.bevel_depth = data.extrude = 0.0
    copy.data = data
    try:
        return points_of(copy.to_mesh())
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.curves.remove(data)


def points_of(mesh: bpy.types.Mesh) -> np.ndarray:
    """Vertices (n, 3) of a mesh, as stored."""
    points = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    return points


def main(arguments: list[str]) -> int:
    if len(arguments) != 1 or not Path(arguments[0]).is_file():
        print("Name one .blend file: python examples/check_animation.py FILE.blend", file=sys.stderr)
        return 2
    with registered():  # which knows what is a cage; what plays is checked without it
        bpy.ops.wm.open_mainfile(filepath=str(Path(arguments[0]).resolve()))
        sets = played()
    outcome = check_animation(bpy.context.scene, sets)
    for problem in outcome.problems:
        print(problem, file=sys.stderr)
    print(f"{outcome.poses} poses checked, {len(outcome.problems)} problems")
    return int(bool(outcome.problems))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
