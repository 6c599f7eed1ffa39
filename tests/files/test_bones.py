"""Bones along limbs, weights inside the cage, poses, and a character that a game engine reads and poses by itself."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import Bone, Character, Mesh, Skeleton, bone_weights, nested_cages, suggest_bones, with_joints
from support.documents import refusal
from support.figures import LIMBS, random_figure
from support.marks import slow_after
from support.shapes import letter_a, ring


@pytest.fixture(scope="module")
def figure() -> Mesh:
    return Mesh.of(shapely.union_all([shapely.LineString(limb[:2]).buffer(limb[2]) for limb in LIMBS.values()]))


@pytest.fixture(scope="module")
def character(figure: Mesh) -> Character:
    bones = suggest_bones(figure)
    (level,) = nested_cages(figure, 24, clearance=0.01 * figure.diagonal)
    return Character.of(figure, with_joints(level.cage, bones), bones)


def lengths(bones: list[Bone], scale: float = 1.0) -> list[float]:
    return sorted(float(np.hypot(*np.subtract(bone.tail, bone.head))) / scale for bone in bones)


def test_a_figure_gets_a_bone_per_limb_and_joints_in_long_ones(figure: Mesh) -> None:
    bones = suggest_bones(figure)
    names = [bone.name for bone in bones]
    assert len(set(names)) == len(names)
    assert (names[0], bones[0].parent) == ("body", None)
    sides = [{name[:-2] for name in names if name.endswith(side)} for side in (".L", ".R")]
    assert sides[0] == sides[1]
    assert len({name.partition(".")[0] for name in sides[0]}) == 2  # arms and legs
    shape = shapely.geometry.shape(figure)
    for number, bone in enumerate(bones):
        assert shape.buffer(1e-9).covers(shapely.LineString([bone.head, bone.tail])), bone
        assert bone.parent is None or bone.parent < number
        assert not bone.name.endswith(".L") or bone.tail[0] > 0.0
    tips = np.array([bone.tail for bone in bones])
    for x, y in ((1.7, 1.1), (-1.7, 1.1), (0.28, -1.3), (-0.28, -1.3), (0.0, 1.9)):
        assert np.hypot(*(tips - (x, y)).T).min() < 0.25
    assert len(suggest_bones(figure, Skeleton(long=100.0))) < len(bones)
    assert len(suggest_bones(figure, Skeleton(protrudes=20.0))) < len(suggest_bones(figure, Skeleton(protrudes=1.0)))
    for angle in (0.7, 2.0):  # they turn and scale with the shape
        turn = 100.0 * np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        turned = suggest_bones(figure.moved(figure.vertices @ turn).validated())
        np.testing.assert_allclose(lengths(turned, 100.0), lengths(bones), atol=0.11)


def test_rings_and_blobs_are_no_trouble() -> None:
    assert len(suggest_bones(ring(100))) <= 1
    assert suggest_bones([ring(100), ring(100, 0.8)])
    assert suggest_bones(letter_a(6))
    assert suggest_bones([ring(3), ring(4) * np.array([0.05, 3.0]) + np.array([5.0, 0.0])])
    elbow = Mesh.of(shapely.LineString([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0)]).buffer(0.4))
    assert len(suggest_bones(elbow, Skeleton(long=100.0))) > 1  # it has a joint where it bends


def test_a_cage_gets_vertices_on_both_sides_of_an_elbow_and_stays() -> None:
    bar = Mesh.of([(0.0, 0.0), (8.0, 0.0), (8.0, 1.0), (0.0, 1.0)])
    bones = [Bone((0.5, 0.5), (4.0, 0.5)), Bone((4.0, 0.5), (7.5, 0.5), parent=0)]
    jointed = with_joints(bar, bones)
    assert sorted(jointed.vertices[:, 0].tolist()) == [0.0, 0.0, 3.5, 3.5, 4.5, 4.5, 8.0, 8.0]
    assert jointed.area == bar.area
    assert len(with_joints(jointed, bones).vertices) == len(jointed.vertices)
    assert len(with_joints(bar, [*bones, Bone((20.0, 0.0), (21.0, 0.0)), Bone((21.0, 0.0), (22.0, 0.0))]).vertices) == 8


# Weights


@pytest.mark.slow
@settings(max_examples=10)
@given(st.integers(0, 10_000))
def test_weights_of_random_bones_are_a_partition_of_unity(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cage = Mesh.of(np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]) + rng.uniform(-0.2, 0.2, (6, 2)))
    bones = [Bone(tuple(a), tuple(b)) for a, b in rng.uniform(-1, 4, (rng.integers(1, 5), 2, 2))]
    weights = bone_weights(cage, bones)
    assert weights.shape == (6, len(bones)) and weights.min() >= 0.0
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-12)


def test_weights_do_not_leak_across_a_gap() -> None:
    """Two legs side by side: as the crow flies the other one is near, through the body it is far."""
    legs = np.array([[0, 0], [1, 0], [1, 5], [1.2, 5], [1.2, 0], [2.2, 0], [2.2, 6], [0, 6]], float)
    weights = bone_weights(Mesh.of(legs), [Bone((0.5, 5.4), (0.5, 0.2)), Bone((1.7, 5.4), (1.7, 0.2))])
    assert weights[[0, 1], 0].min() > 0.99 and weights[[4, 5], 1].min() > 0.99


def test_an_island_without_a_bone_follows_the_nearest() -> None:
    cage = Mesh.from_loops([ring(8) + np.array([x, 0.0]) for x in (0.0, 5.0, 10.0)])
    weights = bone_weights(cage, [Bone((-0.5, 0.0), (0.5, 0.0)), Bone((9.5, 0.0), (10.5, 0.0))])
    np.testing.assert_array_equal(weights[:16], np.repeat([[1.0, 0.0]], 16, axis=0))
    np.testing.assert_array_equal(weights[16:, 1], 1.0)


@pytest.mark.parametrize(
    "bones",
    [[], [Bone((0.0, 0.0), (0.0, 0.0), name="arm")], [Bone((0.0, np.nan), (0.0, 0.0))],
     [Bone((0.0, 0.0), (0.5, 0.0), parent=0)]],
)  # fmt: skip
def test_bones_that_make_no_sense_are_an_error(bones: list[Bone]) -> None:
    refusal(bone_weights, Mesh.of(ring(8)), bones)


# Poses


def test_a_turn_of_the_root_turns_everything(character: Character) -> None:
    shape, cage = character.posed({"body": 30.0})
    centre = np.array(character.bones[0].head)
    turn = np.array([[np.cos(np.pi / 6), np.sin(np.pi / 6)], [-np.sin(np.pi / 6), np.cos(np.pi / 6)]])
    np.testing.assert_allclose(cage, (character.cage.vertices - centre) @ turn + centre, atol=1e-9)
    np.testing.assert_allclose(shape, (character.shape.vertices - centre) @ turn + centre, atol=1e-7)


def test_a_bent_limb_moves_alone_and_does_not_fold(character: Character) -> None:
    rest = character.shape.vertices
    lower = next(bone.name for bone in character.bones if bone.name.endswith(".001.L") and bone.tail[0] > 1.5)
    for angle in (-120.0, -60.0, 60.0, 120.0):
        shape, cage = character.posed({lower: angle})
        moved = np.hypot(*(shape - rest).T)
        assert moved[rest[:, 0] > 1.6].min() > 0.3
        assert moved[rest[:, 0] < 0.0].max() < 0.02
        assert shapely.geometry.shape(character.shape.moved(shape)).is_valid
        assert character.cage.moved(cage).validated().area > 0.9 * character.cage.area  # volume is kept
    refusal(character.posed, {"tail": 10.0})


@pytest.mark.slow
@pytest.mark.parametrize("seeds", slow_after(0, [range(3), range(3, 25)], thorough_after=1), ids=["few", "many"])
def test_limbs_of_random_figures_bend_without_folding_where_there_is_room(seeds: range) -> None:
    """Each bone turned by 60 and 90 degrees both ways: outlines stay simple unless limbs meet, and in their cages."""
    for angle, crossing, leaving in ((60, 0.1, 0.055), (90, 0.13, 0.06)):
        crossed, left = [], []
        for figure in (each for each in map(random_figure, seeds) if len(each.loops) == 1):  # no limbs grown together
            bones = suggest_bones(figure)
            (level,) = nested_cages(figure, 40, clearance=0.01 * figure.diagonal)
            made = Character.of(figure, with_joints(level.cage, bones), bones)
            for bone in bones[1:]:
                for turned in (angle, -angle):
                    shape, cage = made.posed({bone.name: turned})
                    bent, outline = shapely.Polygon(shape[figure.loops[0]]), shapely.Polygon(cage[made.cage.loops[0]])
                    if bent.is_valid:  # no limb meets another one
                        crossed.append(not outline.is_valid)
                        away = shapely.distance(shapely.make_valid(outline), shapely.points(shape)).max()
                        left.append(away > 0.002 * figure.diagonal)
        assert np.mean(crossed) <= crossing, (angle, np.mean(crossed))
        assert np.mean(left) <= leaving, (angle, np.mean(left))
