"""Puppets: which part hangs on which, parts that bend, and the ranges in which nothing folds."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
import shapely
import shapely.affinity

from nestedcages_core import Mesh, NestedCagesError
from nestedcages_core.character import Linear, PreserveVolume, Skin, skinned
from nestedcages_core.coordinates import folded
from nestedcages_core.exchange import puppet_parts
from nestedcages_core.puppet import (
    Clip,
    Hold,
    PartChoice,
    Puppet,
    PuppetDraft,
    PuppetPart,
    draft_puppet,
    idle,
    puppet_of,
    walk,
    wave,
)
from nestedcages_core.puppet.arborescence import best_parents
from nestedcages_core.puppet.puppet import LEAST_TURN
from nestedcages_core.puppet.words import agreements, root_names, side_of, words_of
from support.marks import slow_after


def solid(name: str, area: shapely.Geometry) -> PuppetPart:
    return PuppetPart(name, Mesh.of(area), identity=name)


def limb(name: str, *points: tuple[float, float], width: float = 1.0) -> PuppetPart:
    return solid(name, shapely.LineString(points).buffer(0.5 * width))


def ball(name: str, x: float, y: float, radius: float) -> PuppetPart:
    return solid(name, shapely.Point(x, y).buffer(radius))


def figure() -> list[PuppetPart]:
    """A figure from the front: legs behind the torso, arms over it with hands below the arms, and a face."""
    parts = [limb(f"thigh_{s}", (k * 1.0, -1.0), (k * 1.1, -4.0)) for s, k in (("l", 1), ("r", -1))]
    parts += [limb(f"shin_{s}", (k * 1.1, -4.0), (k * 1.2, -7.0), width=0.9) for s, k in (("l", 1), ("r", -1))]
    parts += [limb("neck", (0.0, 3.0), (0.0, 4.4), width=0.8)]
    parts += [solid("torso", shapely.box(-1.6, -1.4, 1.6, 3.4).buffer(0.3))]
    parts += [ball("head", 0.0, 5.5, 1.5), ball("eye_l", 0.5, 5.8, 0.3), ball("eye_r", -0.5, 5.8, 0.3)]
    parts += [ball("pupil_l", 0.5, 5.8, 0.12), ball("pupil_r", -0.5, 5.8, 0.12)]
    for s, k in (("l", 1), ("r", -1)):
        parts += [ball(f"hand_{s}", k * 3.4, -0.4, 0.6)]
        parts += [limb(f"arm_{s}", (k * 1.6, 3.0), (k * 3.4, 0.0), width=0.9)]
    return parts


PARENTS = {
    "torso": None, "neck": "torso", "head": "neck", "thigh_l": "torso", "thigh_r": "torso", "shin_l": "thigh_l",
    "shin_r": "thigh_r", "eye_l": "head", "eye_r": "head", "pupil_l": "eye_l", "pupil_r": "eye_r", "arm_l": "torso",
    "arm_r": "torso", "hand_l": "arm_l", "hand_r": "arm_r",
}  # fmt: skip


def parents(draft: PuppetDraft) -> dict[str, str | None]:
    names = [part.name for part in draft.parts]
    return {
        name: None if link.parent is None else names[link.parent] for name, link in zip(names, draft.links, strict=True)
    }


def test_parts_hang_together_by_their_overlaps() -> None:
    draft = draft_puppet(figure())
    assert parents(draft) == PARENTS
    holds = {part.name: link.hold for part, link in zip(draft.parts, draft.links, strict=True)}
    assert {name for name, hold in holds.items() if hold is Hold.RIDES} == {"eye_l", "eye_r", "pupil_l", "pupil_r"}
    assert {bone.name for bone in draft.bones} >= {"torso", "head", "arm.L", "arm.R", "hand.L", "shin.R"}
    knee = draft.links[draft.number("shin_l")].joint
    assert np.hypot(knee[0] - 1.1, knee[1] + 4.0) < 0.3


def test_bones_form_one_tree_in_the_order_of_their_parents() -> None:
    bones = draft_puppet(figure()).bones
    assert [bone.parent for bone in bones].count(None) == 1
    assert all(bone.parent is None or bone.parent < k for k, bone in enumerate(bones))


def test_parts_move_and_turn_as_one_drawing() -> None:
    """Neither place, size nor direction of the drawing changes what hangs on what."""
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    moved = [
        PuppetPart(part.name, Mesh(1e3 * part.outline.vertices @ turn + 5e4, part.outline.edges)) for part in figure()
    ]
    assert parents(draft_puppet(moved)) == PARENTS


def test_caps_keep_the_joint_painted_and_show_nothing_at_rest() -> None:
    """A bar with square ends opens at its joint; one with round ends in the middle of its parent does not."""
    lower, upper = (solid(name, shapely.box(x, 0.0, x + 5.0, 2.0)) for name, x in (("lower", 4.6), ("upper", 0.0)))
    round_end = limb("arm", (1.0, 1.0), (1.0, -4.0), width=0.9)
    draft = draft_puppet([lower, upper, round_end], {"upper": PartChoice(parent="")})
    (cap,) = puppet_of(draft).caps
    area, joint = shapely.Polygon(cap.outline.vertices), draft.links[0].joint
    assert (cap.part, draft.bones[cap.bone].name) == (0, "upper")
    assert lower.solid.buffer(1e-9).contains(area)
    kept = shapely.union_all([upper.solid, area, shapely.affinity.rotate(lower.solid, 90.0, origin=joint)])
    disc = shapely.Point(joint).buffer(1.0)
    assert disc.difference(kept).area < 0.001 * disc.area < disc.difference(shapely.difference(kept, area)).area


def test_ink_goes_on_along_the_edge_of_a_cap() -> None:
    """As wide as around the part, and only where paint was cut; a part of one paint has no ink."""
    lower, upper = (solid(name, shapely.box(x, 0.0, x + 5.0, 2.0)) for name, x in (("lower", 4.6), ("upper", 0.0)))
    draft = draft_puppet([lower, upper], {"upper": PartChoice(parent="")})
    (cap,) = puppet_of(draft).caps
    filled = shapely.buffer(lower.solid, -0.1)

    def paints(places: np.ndarray) -> np.ndarray:
        return np.where(
            shapely.contains_xy(lower.solid, *places.T), np.where(shapely.contains_xy(filled, *places.T), 3, 7), -1
        )

    ink = cap.ink(lower, paints)
    assert ink is not None and ink.paint == 7
    assert cap.solid.buffer(1e-9).contains(ink.area)
    cut = shapely.Point(draft.links[0].joint).buffer(cap.radius).boundary.intersection(cap.solid.buffer(1e-3))
    assert 0.09 < ink.area.area / cut.length < 0.11
    assert sum(shapely.Polygon(ring).area for ring in ink.rings) == pytest.approx(ink.area.area)
    assert cap.ink(lower, lambda places: np.zeros(len(places), int)) is None


def test_a_joint_lies_in_what_parts_share_and_not_where_they_touch_too() -> None:
    """Outlines along pixels often touch beside an overlap; caps and bends need the radius at the joint."""
    bent = shapely.union_all(
        [shapely.box(8.0, 1.0, 12.0, 5.0), shapely.box(11.0, -2.0, 12.0, 5.0), shapely.box(2.0, -2.0, 12.0, 0.0)]
    )
    arm = shapely.box(0.0, 0.0, 10.0, 2.0)
    assert shapely.intersection(arm, bent).geom_type == "GeometryCollection"
    draft = draft_puppet([solid("bent", bent), solid("arm", arm)], {"bent": PartChoice(parent="")})
    link = draft.links[1]
    assert shapely.box(8.0, 1.0, 10.0, 2.0).contains(shapely.Point(link.joint)) and 0.4 < link.radius <= 0.5
    assert puppet_of(draft).caps


def test_parts_that_touch_along_an_edge_and_at_a_corner_hang_together() -> None:
    """What they share has points and lines, and no area."""
    one = shapely.union_all(
        [shapely.box(0.0, 0.0, 4.0, 2.0), shapely.box(0.0, 0.0, 1.0, 6.0), shapely.box(0.0, 4.0, 3.0, 6.0)]
    )
    other = shapely.union_all([shapely.box(2.0, 2.0, 6.0, 3.0), shapely.box(3.0, 2.0, 6.0, 4.0)])
    assert {part.geom_type for part in shapely.get_parts(shapely.intersection(one, other))} == {"Point", "LineString"}
    draft = draft_puppet([solid("one", one), solid("other", other)], {"one": PartChoice(parent="")})
    assert draft.links[1].parent == 0 and draft.links[1].gap == 0.0


@pytest.mark.slow
def test_a_choice_moves_a_part_to_another_parent_and_can_be_taken_back() -> None:
    draft = draft_puppet(figure())
    edited = draft.edited("hand_l", PartChoice(parent="torso", joint=(1.0, 0.0)))
    assert parents(edited) == PARENTS | {"hand_l": "torso"}
    assert edited.links[edited.number("hand_l")].joint == (1.0, 0.0)
    assert parents(edited.edited("hand_l", PartChoice())) == PARENTS
    rooted = draft.edited("head", PartChoice(parent=""))
    assert parents(rooted) == PARENTS | {"head": None, "neck": "head", "torso": "neck"}


@pytest.mark.parametrize(
    ("choices", "said"),
    [
        ({"arm_l": PartChoice(parent="hand_l"), "hand_l": PartChoice(parent="arm_l")}, "would hang on itself"),
        ({"arm_l": PartChoice(parent="wing")}, "no part 'wing'"),
        ({"arm_l": PartChoice(parent=""), "head": PartChoice(parent="")}, "can't both be the root"),
    ],
)
def test_choices_that_cannot_be_are_told(choices: dict[str, PartChoice], said: str) -> None:
    with pytest.raises(NestedCagesError, match=said):
        draft_puppet(figure(), choices)


def test_a_part_that_touches_nothing_hangs_on_the_nearest_and_is_told() -> None:
    draft = draft_puppet([*figure(), ball("balloon", 9.0, 9.0, 1.0)])
    assert draft.notes == ("balloon touches nothing: it hangs on head, which is nearest.",)
    assert "balloon" in draft.doubtful


def test_parts_that_nearly_touch_hang_together() -> None:
    draft = draft_puppet([solid("body", shapely.box(0.0, 0.0, 6.0, 3.0)), ball("head", 7.03, 2.0, 1.0)])
    link = draft.links[1]
    assert (link.parent, link.gap) == (0, pytest.approx(0.03, abs=1e-3))
    assert np.hypot(link.joint[0] - 6.0, link.joint[1] - 2.0) < 0.1


def tail(count: int | None = None) -> tuple[list[PuppetPart], dict[str, PartChoice]]:
    """A bent tail with a spot on it, on a body."""
    bent = [(2.0 + 0.4 * k, 0.5 + 0.8 * np.sin(0.4 * k)) for k in range(24)]
    parts = [limb("tail", *bent, width=1.2), ball("body", 0.0, 0.5, 2.6), ball("spot", *bent[14], 0.3)]
    return parts, {} if count is None else {"tail": PartChoice(bones=count)}


SKINS = [PreserveVolume(), Linear()]


@cache
def with_tail(count: int | None = None, skin: Skin = SKINS[0]) -> Puppet:
    return puppet_of(draft_puppet(*tail(count)), skin)


@cache
def puppet_from(parts: Callable[[], list[PuppetPart]]) -> Puppet:
    return puppet_of(draft_puppet(parts()))


@pytest.mark.parametrize("skin", SKINS, ids=["volume", "linear"])
@pytest.mark.parametrize("count", slow_after(1, [None, 8]))
def test_no_triangle_flips_within_the_ranges_whatever_the_other_joints_do(skin: Skin, count: int | None) -> None:
    puppet = with_tail(count, skin)
    field = puppet.fields[0]
    assert field is not None
    joints = range(field.first_bone + 1, field.first_bone + 1 + len(field.bends))
    assert all(puppet.ranges[k].low <= -60.0 and puppet.ranges[k].high >= 60.0 for k in joints) or count == 8
    vertices, triangles = field.grid.vertices, field.grid.triangles
    weights = np.zeros((len(vertices), len(puppet.bones)))
    weights[:, field.first_bone : field.first_bone + len(field.bends) + 1] = field.weights
    random = np.random.default_rng(1)
    for trial in range(30):
        pick: Callable[[float, float], float] = random.uniform if trial % 2 else lambda *ends: random.choice(ends)
        turned = {k: pick(puppet.ranges[k].low, puppet.ranges[k].high) for k in joints}
        posed = skinned(vertices, weights, puppet.bones, turned, skin).astype(np.float32).astype(np.float64)
        assert not folded(posed, triangles).any()


@pytest.mark.parametrize("skin", SKINS, ids=["volume", "linear"])
def test_ranges_end_near_the_first_fold(skin: Skin) -> None:
    puppet = with_tail(2, skin)
    field = puppet.fields[0]
    assert field is not None
    joint = field.first_bone + 1
    weights = np.zeros((len(field.grid.vertices), len(puppet.bones)))
    weights[:, field.first_bone : joint + 1] = field.weights
    for end in (puppet.ranges[joint].low, puppet.ranges[joint].high):
        assert 90.0 < abs(end) <= 170.0
        beyond = skinned(field.grid.vertices, weights, puppet.bones, {joint: end + 1.0 * np.sign(end)}, skin)
        assert abs(end) == 170.0 or folded(beyond, field.grid.triangles).any()


def test_the_cage_stays_simple_in_its_narrower_range() -> None:
    puppet = with_tail(2)
    field = puppet.fields[0]
    assert field is not None
    joint = field.first_bone + 1
    own = puppet.ranges[joint]
    assert own.low <= own.simple_low < -60.0 and 60.0 < own.simple_high <= own.high
    ring = shapely.linestrings(field.grid.vertices[field.rim])
    order = shapely.get_coordinates(shapely.polygonize([shapely.union_all(ring)]).geoms[0].exterior)

    def is_simple(angle: float) -> bool:
        return bool(shapely.is_valid(shapely.Polygon(puppet.moved(0, order, {puppet.bones[joint].name: angle}))))

    assert all(is_simple(angle) for angle in np.linspace(own.simple_low, own.simple_high, 41))


def test_weights_suit_engines_and_vertices_are_those_that_float32_stores() -> None:
    puppet = with_tail()
    field = puppet.fields[0]
    assert field is not None and puppet.fields[2] is field and puppet.fields[1] is None
    for array in (field.grid.vertices, field.weights):
        assert np.array_equal(array, array.astype(np.float32))
    assert np.array_equal(field.weights.sum(axis=1), np.ones(len(field.weights)))
    assert (field.weights >= 0.0).all() and ((field.weights > 0.0).sum(axis=1) <= 2).all()
    bones, weights = puppet.strongest(2, puppet.draft.parts[2].outline.vertices)
    assert bones.shape == weights.shape and weights.shape[1] <= 4
    assert np.allclose(weights.sum(axis=1), 1.0) and (np.diff(weights, axis=1) <= 0.0).all()


def moved_by(puppet: Puppet, turned: dict[str, float]) -> dict[str, float]:
    """How far each part moves at most."""
    posed = zip(puppet.draft.parts, puppet.posed(turned), strict=True)
    return {part.name: float(np.abs(points - part.outline.vertices).max()) for part, points in posed}


def test_a_limb_turns_alone_with_what_hangs_on_it() -> None:
    moved = moved_by(puppet_from(figure), {"arm.L": 40.0})
    assert {name for name, by in moved.items() if by > 1e-9} == {"arm_l", "hand_l"}


def test_a_pose_beyond_a_range_names_its_bones() -> None:
    puppet = with_tail(2)
    assert puppet.beyond({"tail.001": 30.0, "tail": 175.0}) == ()
    assert puppet.beyond({"tail.001": 172.0}) == ("tail.001",)
    with pytest.raises(NestedCagesError, match="no bone 'wing'"):
        puppet.posed({"wing": 1.0})


def test_a_part_whose_joints_would_turn_too_little_has_fewer_bones() -> None:
    """A wedge folds early; a user may still ask for its bones."""
    wedge = solid("fin", shapely.Polygon([(0.0, -3.0), (0.0, 3.0), (5.0, 0.6), (9.0, 2.5), (9.0, -2.5), (5.0, -0.6)]))
    parts = [wedge, ball("body", -2.0, 0.0, 4.0)]
    asked = {"fin": PartChoice(hold=Hold.JOINT, bones=2)}
    ranges = puppet_of(draft_puppet(parts, asked)).ranges
    free = puppet_of(draft_puppet(parts, {"fin": PartChoice(hold=Hold.JOINT)}))
    assert all(each.low <= -LEAST_TURN and each.high >= LEAST_TURN for each in free.ranges)
    assert len(ranges) == 3


@pytest.mark.slow
def test_parts_of_several_areas_and_with_narrow_holes_have_fields() -> None:
    """Joints lie in the area that bends, not on the way to it; a hole too narrow for the clearance is filled."""
    tail = limb("tail", (5.0, 0.0), (12.0, 0.0), width=0.7).solid
    speck, hole = shapely.Point(2.0, 0.0).buffer(0.4), shapely.Point(9.0, 0.1).buffer(0.06)
    parts = [solid("tail", shapely.union_all([tail, speck]) - hole), ball("body", 0.0, 0.0, 2.6)]
    for count in (None, 6):
        puppet = puppet_of(draft_puppet(parts, {"tail": PartChoice(bones=count)}))
        joints = [puppet.bones[bone].head for bone in puppet.draft.chain(0)[1:]]
        assert joints and shapely.contains_xy(tail, *np.array(joints).T).all()


@pytest.mark.parametrize(
    ("name", "noun", "side"),
    [
        ("eye_l", "eye", "L"),
        ("leftArm", "arm", "L"),
        ("leftarm", "arm", "L"),
        ("RightForeArm", "forearm", "R"),
        ("LeftUpLeg", "upper_leg", "L"),
        ("L_Arm_Low", "lower_arm", "L"),
        ("shield_arm_upper", "upper_arm", ""),
        ("inner ear right", "inner_ear", "R"),
        ("upper teeth", "tooth", ""),
        ("hindleg", "leg", ""),
        ("FL_lower", "lower_leg", "L"),
        ("hind_lower_far", "lower_leg", ""),
        ("r2d2", "", ""),
        ("Füße", "", ""),
    ],
)
def test_names_say_what_a_part_is(name: str, noun: str, side: str) -> None:
    assert (words_of(name).noun, side_of(name)) == (noun, side)


def test_left_does_not_hang_on_right_and_feet_hang_on_legs() -> None:
    said = {
        ("foot_l", "leg_l"): {"names": 1.0, "labels": 1.0},
        ("foot_l", "leg_r"): {"names_of_others": 1.0, "labels_of_others": 1.0},
        ("foot_l", "leg"): {"names": 1.0},
        ("hind_foot_far", "hind_arm_near"): {"names_of_others": 1.0, "labels": 1.0, "labels_of_others": 1.0},
        ("tooth_low", "jaw_low"): {"names": 1.0, "labels": 1.0},
        ("tail_tip", "tail"): {"name_extends": 1.0},
        ("fish_tail", "fish"): {"name_extends": 1.0},
        ("segment 3", "segment 2"): {"name_follows": 1.0},
        ("segment 3", "segment 1"): {"labels_of_others": 1.0},
        ("FL_lower", "FR_upper"): {"names_of_others": 1.0, "labels": 1.0, "labels_of_others": 1.0},
        ("shirt", "shorts"): {"names": 1.0},
        ("torso", "arm_l"): {"names_of_others": 1.0, "names_reversed": 1.0},
        ("banana", "hand_l"): {"held": 1.0},
        ("path12", "leg_r"): {},
    }
    for (child, parent), columns in said.items():
        found = agreements([words_of(child), words_of(parent)], [(0, 1)])
        assert {name: value for name, (value,) in found.items() if value} == columns, (child, parent)


def test_names_choose_the_closest_of_the_parts_that_are_there() -> None:
    """A head hangs on a neck, on a body only without one; a leg on hips first; the tail of a fish, on it."""
    words = [words_of(name) for name in ("head", "torso", "neck", "leg", "hips", "fish", "fish_tail")]
    assert agreements(words, [(0, 1), (0, 2), (3, 1), (3, 4)])["names"] == [0.0, 1.0, 0.0, 1.0]
    assert agreements(words, [(0, 1), (3, 1), (6, 1)])["names"] == [1.0, 1.0, 1.0]
    assert agreements(words, [(6, 1), (6, 5)])["names"] == [0.0, 0.0]


def test_hips_are_the_root_of_names_where_there_are_some() -> None:
    words = [words_of(name) for name in ("torso", "arm", "path1", "pelvis")]
    assert root_names(words) == [0.0, -1.0, 0.0, 1.0]
    assert root_names([words_of(name) for name in ("shirt", "left shin", "shorts")]) == [0.0, -1.0, 1.0]
    assert root_names(words[:3]) == [1.0, -1.0, 0.0]


def test_a_group_of_layers_says_what_hangs_together() -> None:
    """A strap lies on two limbs alike; it hangs on the one that is in its group."""
    body = ball("body", 0.0, 0.0, 3.0)
    legs = [limb(f"path{k}", (x, -2.0), (x, -9.0), width=1.6) for k, x in enumerate((-0.9, 0.9))]
    strap = solid("strap", shapely.box(-1.4, -6.4, 1.4, -5.6))
    for k in (0, 1):
        names = "one", "other"
        parts = [replace(leg, groups=(name,)) for leg, name in zip(legs, names, strict=True)]
        found = parents(draft_puppet([body, *parts, replace(strap, groups=(names[k],))]))
        assert found["strap"] == f"path{k}"


def test_what_is_rigid_by_its_name_has_one_bone_unless_a_user_wants_more() -> None:
    parts = [ball("hand", 0.0, 0.0, 1.0), limb("spear", (0.0, 0.0), (14.0, 0.0))]
    free, asked = draft_puppet(parts), draft_puppet(parts, {"spear": PartChoice(bones=3)})
    bending = draft_puppet([parts[0], replace(parts[1], name="tail")])
    assert [len(each.chain(1)) for each in (free, asked, bending)] == [1, 3, 6]


def test_bones_are_longer_where_a_part_is_thicker_and_shorter_at_its_ends() -> None:
    """The blends of two joints share the bones between; a blend is as long as the part is thick there."""
    four = {"tail": PartChoice(hold=Hold.JOINT, bones=4)}
    straight = draft_puppet([ball("body", 0.0, 0.0, 2.0), limb("tail", (1.0, 0.0), (25.0, 0.0), width=1.0)], four)
    wedge = shapely.Polygon([(0.0, -2.0), (0.0, 2.0), (28.0, 0.8), (28.0, -0.8)])
    pointed = draft_puppet([ball("body", 0.0, 0.0, 3.0), solid("tail", wedge)], four)
    for draft in (straight, pointed):
        first, second, third, last = (draft.bones[bone].length for bone in draft.chain(1))
        assert first < 0.9 * second and last < 0.9 * third
    second, third = (pointed.bones[bone].length for bone in pointed.chain(1)[1:3])
    assert second > 1.1 * third


def test_a_hand_before_a_hip_is_no_pin_of_it() -> None:
    by_name = {
        "leg": 'd="M90 100 L90 190" stroke="#456" stroke-width="34" stroke-linecap="round" fill="none"',
        "body": 'd="M60 20 H120 V120 H60 Z" fill="#e95"',
        "arm": 'd="M66 34 L52 72" stroke="#c73" stroke-width="22" stroke-linecap="round" fill="none"',
        "forearm": 'd="M52 72 L84 98" stroke="#c73" stroke-width="18" stroke-linecap="round" fill="none"',
        "hand": 'd="M90 92 a11 11 0 1 0 .1 0 z" fill="#c73"',
    }
    paths = "".join(f'<path id="{name}" {data}/>' for name, data in by_name.items())
    parts = puppet_parts(f'<svg xmlns="http://www.w3.org/2000/svg" width="200" height="220">{paths}</svg>')[0]
    assert parents(draft_puppet(parts))["hand"] == "forearm"


def test_every_part_gets_the_parent_of_the_best_tree() -> None:
    """Against all trees of five nodes; among them are ones in which the best parents of all make a circle."""
    random = np.random.default_rng(3)
    for _ in range(40):
        gain = random.normal(size=(5, 5))
        best = -np.inf
        for choice in product(range(5), repeat=4):
            parent = [-1, *choice]
            depth = [sum(1 for _ in up(parent, node)) for node in range(5)]
            if max(depth) < 5:
                best = max(best, sum(gain[node, parent[node]] for node in range(1, 5)))
        found = best_parents(gain, 0)
        assert found[0] == -1 and sum(gain[node, found[node]] for node in range(1, 5)) == pytest.approx(best)


def up(parent: list[int], node: int) -> Iterator[int]:
    """The nodes above a node, at most five of them."""
    for _ in range(5):
        node = parent[node]
        if node < 0:
            return
        yield node


def strider() -> list[PuppetPart]:
    """A figure from the side that looks to the right: one arm and one leg behind the body, one of each before it."""
    far = [limb("leg_far", (0.2, -1.0), (0.2, -5.0), width=0.9), limb("arm_far", (0.2, 2.6), (0.2, -0.4), width=0.7)]
    near = [limb("leg", (-0.2, -1.0), (-0.2, -5.0), width=0.9), limb("arm", (-0.2, 2.6), (-0.2, -0.4), width=0.7)]
    body = [solid("body", shapely.box(-1.0, -1.6, 1.0, 3.0).buffer(0.3)), ball("head", 0.2, 4.2, 1.2)]
    return [*far, *body, ball("eye", 0.9, 4.4, 0.2), ball("ear", 0.3, 4.2, 0.25), *near]


def test_near_and_far_are_told_and_named_as_left_and_right() -> None:
    draft = draft_puppet(strider())
    sides = {part.name: (side.side, side.depth) for part, side in zip(draft.parts, draft.sides, strict=True)}
    assert sides["leg"] == sides["arm"] == ("R", "near") and sides["leg_far"] == sides["arm_far"] == ("L", "far")
    assert {bone.name for bone in draft.bones} >= {"leg.L", "leg.R", "arm.L", "arm.R"}


def test_limbs_that_are_named_near_and_far_may_all_lie_behind_the_body() -> None:
    """As trousers under a coat, next to each other."""
    _, arm_far, *body, _, arm = strider()
    legs = [limb(name, (x, -1.0), (x, -5.0), width=0.9) for name, x in (("leg_far", 0.5), ("leg_near", -0.5))]
    draft = draft_puppet([arm_far, *legs, *body, arm])
    sides = {part.name: (side.side, side.depth) for part, side in zip(draft.parts, draft.sides, strict=True)}
    assert sides["leg_near"] == sides["arm"] == ("R", "near") and sides["leg_far"] == sides["arm_far"] == ("L", "far")


@pytest.mark.slow
@pytest.mark.parametrize("parts", [figure, strider], ids=["front", "side"])
@pytest.mark.parametrize("clip", [walk, wave, idle])
def test_clips_stay_within_the_ranges_and_repeat(
    clip: Callable[[Puppet], Clip], parts: Callable[[], list[PuppetPart]]
) -> None:
    puppet = puppet_from(parts)
    made = clip(puppet)
    assert all(puppet.beyond(frame) == () for frame in made.frames)
    moved = {bone for frame in made.frames for bone, angle in frame.items() if abs(angle) > 1.0}
    assert moved
    steps = [
        max(abs(a[bone] - b[bone]) for bone in a)
        for a, b in zip(made.frames, made.frames[1:] + made.frames[:1], strict=True)
    ]
    assert max(steps) < 15.0


def test_legs_of_a_walk_take_turns() -> None:
    frames = walk(puppet_from(strider)).frames
    left, right = (np.array([frame[name] for frame in frames]) for name in ("leg.L", "leg.R"))
    assert np.ptp(left) > 30.0 and np.allclose(left, np.roll(right, len(frames) // 2))


def test_clips_without_the_limbs_for_them_are_told() -> None:
    puppet = puppet_of(draft_puppet([ball("body", 0.0, 0.0, 2.0)]))
    assert idle(puppet).frames
    for clip, said in ((walk, "needs two legs"), (wave, "needs an arm")):
        with pytest.raises(NestedCagesError, match=said):
            clip(puppet)


@pytest.mark.slow
def test_skins_differ_little_where_bones_turn_little() -> None:
    """Linear blending thins a limb at its joint by cos θ/2 at most, as for engines."""
    parts = [limb("tail", (2.0, 0.0), (12.0, 0.0), width=1.2), ball("body", 0.0, 0.0, 2.6)]
    gaps = []
    for angle in (30.0, 60.0):
        volume, linear = (puppet_of(draft_puppet(parts, {"tail": PartChoice(bones=2)}), skin) for skin in SKINS)
        points = np.stack((np.linspace(2.0, 12.0, 99), np.full(99, 0.55)), axis=1)
        apart = [each.moved(0, points, {"tail.001": angle}) for each in (volume, linear)]
        gaps.append(float(np.hypot(*(apart[0] - apart[1]).T).max()))
    assert 0.0 < gaps[0] < gaps[1] < 1.2 * (1.0 - np.cos(np.deg2rad(30.0)))
