"""The check of the demo's animation finds what it is there to find, on scenes with one thing wrong each."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from examples.check_animation import check_animation

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
def cages(scene: bpy.types.Scene) -> tuple[bpy.types.Object, bpy.types.Object, bpy.types.Object]:
    """Source, fine mesh and cage, marked as the add-on marks them; the flow ends on frame 3."""
    source = add(scene.collection, "Source", SQUARE)
    collection = bpy.data.collections.new("Source Cages")
    scene.collection.children.link(collection)
    fine, cage = add(collection, "Fine", SQUARE), add(collection, "Cage", AROUND)
    collection["nested_cages_source"], collection["nested_cages_end"] = source, LAST
    fine["nested_cages_level"], cage["nested_cages_level"] = 0, 1
    for name, frame in (("flow_start", 1), ("reinflation_start", 3), ("tightening_start", 7), ("end", LAST)):
        cage[f"nested_cages_{name}"] = frame
    return source, fine, cage


def test_nothing_wrong(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    outcome = check_animation(scene)
    assert outcome.problems == ()
    assert outcome.poses == 2 * (LAST - 3) + 1


def test_crossing_during_the_flow_is_the_method(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    _, fine, _ = cages
    animate(fine, SQUARE + 1.0, 2)
    assert check_animation(scene).problems == ()


def test_crossing_is_found(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    _, fine, _ = cages
    animate(fine, SQUARE + 1.0, 5)
    problems = check_animation(scene).problems
    # Halfway to the pose the corners touch the cage, which counts, on the way there and from there.
    assert {problem.split(",")[0] for problem in problems} == {f"frame {frame}" for frame in ("4.5", "5", "5.5", "6")}
    assert all("meets the edge" in problem for problem in problems)


def test_crossing_between_two_frames_is_found(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    _, fine, _ = cages
    # A turn by half a circle takes the corners through the centre: fine on whole frames, folded between them.
    animate(fine, SQUARE[[2, 3, 0, 1]], 5)
    cage = cages[2]
    animate(cage, AROUND[[2, 3, 0, 1]], 5)
    problems = check_animation(scene).problems
    assert {problem.split(",")[0] for problem in problems} == {f"frame {frame}" for frame in ("4.5", "5", "5.5", "6")}


def test_a_cage_that_crosses_itself_is_found(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    animate(cages[2], AROUND[[0, 1, 3, 2]], 5)
    assert any("meets the edge" in problem for problem in check_animation(scene).problems)


def test_a_cage_beside_the_drawing_is_found(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    for vertex in cages[2].data.vertices:
        vertex.co.x += 9.0
    assert any("outside of the cage" in problem for problem in check_animation(scene).problems)


def test_not_home_by_one_bit_is_found(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    cages[1].data.vertices[2].co.x = np.nextafter(np.float32(1), np.float32(2))
    (problem,) = check_animation(scene).problems
    assert problem.startswith("on the last frame: 1 vertices")


def test_a_lost_vertex_is_found(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    source = cages[0]
    source.data.vertices.add(1)
    source.data.vertices[4].co = (0.5, 0.5, 0.0)
    (problem,) = check_animation(scene).problems
    assert problem == "on the last frame: 1 points of the source are missing"


def test_another_place_is_found(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    cages[1].location.x = 1.0
    (problem,) = check_animation(scene).problems
    assert "does not lie where the source does" in problem


def test_an_empty_scene_is_no_success(scene: bpy.types.Scene) -> None:
    assert check_animation(scene).problems == ("there are no cages in the scene",)


def test_an_animation_that_was_removed(scene: bpy.types.Scene, cages: tuple[bpy.types.Object, ...]) -> None:
    del cages[2]["nested_cages_flow_start"]
    assert check_animation(scene).problems == ("Source Cages: its animation was removed",)
