"""The check of the demo's animation finds what it is there to find, on scenes with one thing wrong each."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from examples.check_animation import Played, check_animation

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
AROUND = 2.0 * (SQUARE - 0.5) + 0.5
LAST = 11


@pytest.fixture
def scene() -> bpy.types.Scene:
    return bpy.context.scene


def add(owner: bpy.types.Collection, name: str, points: np.ndarray) -> bpy.types.Object:
    """A closed loop as a wire."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(
        np.column_stack((points, np.zeros(len(points)))), [(i, (i + 1) % len(points)) for i in range(4)], []
    )
    item = bpy.data.objects.new(name, mesh)
    owner.objects.link(item)
    return item


def animate(item: bpy.types.Object, points: np.ndarray, frame: int) -> None:
    """Moves the object to `points` on `frame`, and back on the frames before and after."""
    if item.data.shape_keys is None:
        item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Pose", from_mix=False)
    key.points.foreach_set("co", np.column_stack((points, np.zeros(len(points)))).astype(np.float32).ravel())
    for at, value in ((frame - 1, 0.0), (frame, 1.0), (frame + 1, 0.0)):
        key.value = value
        key.keyframe_insert("value", frame=at)


@pytest.fixture
def cages(scene: bpy.types.Scene) -> Played:
    """A set of one cage; the flow ends on frame 3."""
    source = add(scene.collection, "Source", SQUARE)
    collection = bpy.data.collections.new("Source Cages")
    scene.collection.children.link(collection)
    fine, cage = add(collection, "Fine", SQUARE), add(collection, "Cage", AROUND)
    return Played(collection.name, source, fine, [cage], [(1, 3, 7, LAST)])


def test_nothing_wrong(scene: bpy.types.Scene, request: pytest.FixtureRequest) -> None:
    assert check_animation(scene, []).problems == ("there are no cages in the scene",)
    outcome = check_animation(scene, [request.getfixturevalue("cages")])
    assert outcome.problems == ()
    assert outcome.poses == 2 * (LAST - 3) + 1


def test_crossing_during_the_flow_is_the_method(scene: bpy.types.Scene, cages: Played) -> None:
    animate(cages.fine, SQUARE + 1.0, 2)
    assert check_animation(scene, [cages]).problems == ()


def test_crossing_is_found(scene: bpy.types.Scene, cages: Played) -> None:
    animate(cages.fine, SQUARE + 1.0, 5)
    problems = check_animation(scene, [cages]).problems
    # Halfway to the pose the corners touch the cage, which counts, on the way there and from there.
    assert {problem.split(",")[0] for problem in problems} == {f"frame {frame}" for frame in ("4.5", "5", "5.5", "6")}
    assert all("meets the edge" in problem for problem in problems)


def test_crossing_between_two_frames_is_found(scene: bpy.types.Scene, cages: Played) -> None:
    # A turn by half a circle takes the corners through the centre: fine on whole frames, folded between them.
    animate(cages.fine, SQUARE[[2, 3, 0, 1]], 5)
    animate(cages.cages[0], AROUND[[2, 3, 0, 1]], 5)
    problems = check_animation(scene, [cages]).problems
    assert {problem.split(",")[0] for problem in problems} == {f"frame {frame}" for frame in ("4.5", "5", "5.5", "6")}


def drop_a_vertex(source: bpy.types.Object, *_: bpy.types.Object) -> None:
    source.data.vertices.add(1)
    source.data.vertices[4].co = (0.5, 0.5, 0.0)


FAULTS = {
    "a cage that crosses itself": (lambda _, fine, cage: animate(cage, AROUND[[0, 1, 3, 2]], 5), "meets the edge"),
    "a cage beside the drawing": (
        lambda _, fine, cage: cage.data.transform(Matrix.Translation((9.0, 0.0, 0.0))), "outside of the cage"
    ),
    "not home by one bit": (
        lambda _, fine, cage: setattr(fine.data.vertices[2].co, "x", np.nextafter(np.float32(1), np.float32(2))),
        "on the last frame: 1 vertices",
    ),
    "a lost vertex": (drop_a_vertex, "on the last frame: 1 points of the source are missing"),
    "another place": (lambda _, fine, cage: setattr(fine.location, "x", 1.0), "does not lie where the source does"),
    "an animation that was removed": (
        None, "Source Cages: its animation was removed"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_found(scene: bpy.types.Scene, cages: Played, name: str) -> None:
    fault, said = FAULTS[name]
    if fault is None:
        cages.frames.clear()
    else:
        fault(cages.source, cages.fine, *cages.cages)
    assert said in check_animation(scene, [cages]).problems[0]
