"""Puppets: which part hangs on which, parts that bend, and the ranges in which nothing folds."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity

import nestedcages_core as core
from nestedcages_core import PartChoice, Puppet, PuppetDraft, PuppetPart, draft_puppet, puppet_of, walk
from support.documents import refusal, svg
from support.figures import ball, front_figure, limb, side_figure, solid
from support.marks import slow_after

pytestmark = pytest.mark.slow

FOX = Path(__file__).resolve().parents[2] / "examples/fox.svg"
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


@pytest.fixture(scope="module")
def draft() -> PuppetDraft:
    return draft_puppet(front_figure())


@cache
def tailed(count: int | None = None) -> Puppet:
    """A bent tail with a spot on it, on a body."""
    bent = [(2.0 + 0.4 * k, 0.5 + 0.8 * np.sin(0.4 * k)) for k in range(24)]
    parts = [limb("tail", *bent, width=1.2), ball("body", 0.0, 0.5, 2.6), ball("spot", *bent[14], 0.3)]
    return puppet_of(draft_puppet(parts, {} if count is None else {"tail": PartChoice(bones=count)}))


@cache
def puppet_from(parts: Callable[[], list[PuppetPart]]) -> Puppet:
    return puppet_of(draft_puppet(parts()))


def test_parts_hang_together_by_their_overlaps(draft: PuppetDraft) -> None:
    assert parents(draft) == PARENTS
    riders = {part.name for k, part in enumerate(draft.parts) if not draft.chain(k)}
    assert riders == {"eye_l", "eye_r", "pupil_l", "pupil_r"}  # without bones of their own
    assert {bone.name for bone in draft.bones} >= {"torso", "head", "arm.L", "arm.R", "hand.L", "shin.R"}
    knee = draft.links[draft.number("shin_l")].joint
    assert np.hypot(knee[0] - 1.1, knee[1] + 4.0) < 0.3
    assert [bone.parent for bone in draft.bones].count(None) == 1
    assert all(bone.parent is None or bone.parent < k for k, bone in enumerate(draft.bones))


@pytest.mark.slow
def test_a_fox_of_many_layers_hangs_together() -> None:
    fox = draft_puppet(core.puppet_parts(FOX.read_text(encoding="utf-8"))[0])
    under = [6, 0, 6, 2, 6, 4, None, 6, 6, 8, 6, 10, 6, 6, 13, 17, 15, 6, 17, 18, 17, 20, 17, 22]
    assert [link.parent for link in fox.links] == under and fox.doubtful == ("ear-far 17", "nose 20")
    assert [k for k in range(24) if not fox.chain(k)] == [7, 13, 14, 16, 20, 21, 23]


def test_neither_place_nor_size_nor_direction_of_the_drawing_counts() -> None:
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    moved = [
        PuppetPart(part.name, core.Mesh(1e3 * part.outline.vertices @ turn + 5e4, part.outline.edges))
        for part in front_figure()
    ]
    assert parents(draft_puppet(moved)) == PARENTS


@pytest.mark.slow
def test_a_choice_moves_a_part_to_another_parent_and_can_be_taken_back(draft: PuppetDraft) -> None:
    edited = draft.edited("hand_l", PartChoice(parent="torso", joint=(1.0, 0.0)))
    assert parents(edited) == PARENTS | {"hand_l": "torso"}
    assert edited.links[edited.number("hand_l")].joint == (1.0, 0.0)
    assert parents(edited.edited("hand_l", PartChoice())) == PARENTS
    rooted = draft.edited("head", PartChoice(parent=""))
    assert parents(rooted) == PARENTS | {"head": None, "neck": "head", "torso": "neck"}


@pytest.mark.parametrize(
    "choices",
    [
        {"arm_l": PartChoice(parent="hand_l"), "hand_l": PartChoice(parent="arm_l")},
        {"arm_l": PartChoice(parent="wing")},
        {"wing": PartChoice(bones=2)},
        {"arm_l": PartChoice(parent=""), "head": PartChoice(parent="")},
    ],
)
def test_choices_that_cannot_be_are_an_error(choices: dict[str, PartChoice]) -> None:
    for parts in (front_figure(), []):
        refusal(draft_puppet, parts, choices)
    for wrong in ({"bones": 0}, {"bones": 2, "chain": ((0, 0), (1, 0))}):
        assert refusal(PartChoice, **wrong).code == "setting.invalid"


def test_a_part_that_touches_nothing_hangs_on_the_nearest_and_is_doubtful() -> None:
    balloon = draft_puppet([*front_figure(), ball("balloon", 9.0, 9.0, 1.0)])
    assert parents(balloon) == PARENTS | {"balloon": "head"}
    assert "balloon" in balloon.doubtful and len(balloon.notes) == 1 and "balloon" in balloon.notes[0]


def test_joints_lie_in_what_parts_share() -> None:
    """Nearly touching, touching along an edge and at a corner, and overlapping where outlines touch elsewhere too."""
    near = draft_puppet([solid("body", shapely.box(0.0, 0.0, 6.0, 3.0)), ball("head", 7.03, 2.0, 1.0)])
    assert near.links[1].parent == 0 and np.hypot(near.links[1].joint[0] - 6.0, near.links[1].joint[1] - 2.0) < 0.1
    boxes = [shapely.box(0.0, 0.0, 4.0, 2.0), shapely.box(0.0, 0.0, 1.0, 6.0), shapely.box(0.0, 4.0, 3.0, 6.0)]
    other = shapely.union_all([shapely.box(2.0, 2.0, 6.0, 3.0), shapely.box(3.0, 2.0, 6.0, 4.0)])
    touching = draft_puppet(
        [solid("one", shapely.union_all(boxes)), solid("other", other)], {"one": PartChoice(parent="")}
    )
    assert touching.links[1].parent == 0 and not touching.doubtful
    boxes = [shapely.box(8.0, 1.0, 12.0, 5.0), shapely.box(11.0, -2.0, 12.0, 5.0), shapely.box(2.0, -2.0, 12.0, 0.0)]
    arm = shapely.box(0.0, 0.0, 10.0, 2.0)
    bent = draft_puppet([solid("bent", shapely.union_all(boxes)), solid("arm", arm)], {"bent": PartChoice(parent="")})
    assert shapely.box(8.0, 1.0, 10.0, 2.0).contains(shapely.Point(bent.links[1].joint))


def test_a_hand_before_a_hip_is_no_pin_of_it() -> None:
    by_name = {
        "leg": 'd="M90 100 L90 190" stroke="#456" stroke-width="34" stroke-linecap="round" fill="none"',
        "body": 'd="M60 20 H120 V120 H60 Z" fill="#e95"',
        "arm": 'd="M66 34 L52 72" stroke="#c73" stroke-width="22" stroke-linecap="round" fill="none"',
        "forearm": 'd="M52 72 L84 98" stroke="#c73" stroke-width="18" stroke-linecap="round" fill="none"',
        "hand": 'd="M90 92 a11 11 0 1 0 .1 0 z" fill="#c73"',
    }
    parts, _ = core.puppet_parts(svg("".join(f'<path id="{name}" {data}/>' for name, data in by_name.items())))
    assert parents(draft_puppet(parts))["hand"] == "forearm"


# Names and groups


def crossed(child: str, parent: str, other: str) -> str | None:
    """What the child hangs on that lies on a parent and another part alike, beside each other."""
    strap = solid(child, shapely.box(-1.4, -6.4, 1.4, -5.6))
    beside = [limb(name, (x, -2.0), (x, -9.0), width=1.6) for name, x in ((parent, -0.9), (other, 0.9))]
    return parents(draft_puppet([ball("body", 0.0, 0.0, 3.0), *beside, strap]))[child]


@pytest.mark.parametrize(
    ("child", "parent", "other"),
    [("foot_l", "leg_l", "leg_r"), ("RightHand", "rightForeArm", "leftForeArm"),
     ("left foot", "LeftUpLeg", "RightUpLeg"), ("foot", "leg", "wing"), ("tooth_low", "jaw_low", "nose"),
     ("tail_tip", "tail", "path12"), ("segment 3", "segment 2", "segment 1"), ("FL_lower", "FL_upper", "FR_upper"),
     ("banana", "hand", "leg"), ("hand", "forearm", "leg")],
)  # fmt: skip
def test_names_say_what_hangs_on_what(child: str, parent: str, other: str) -> None:
    for names in ((parent, other), (other, parent)):
        assert crossed(child, *names) == parent


def test_a_group_of_layers_says_what_hangs_together() -> None:
    for own in ("one", "other"):
        parts = [solid("strap", shapely.box(-1.4, -6.4, 1.4, -5.6), own)]
        for name, x in (("one", -0.9), ("other", 0.9)):
            parts.insert(0, solid(f"path_{name}", shapely.box(x - 0.8, -9.0, x + 0.8, -2.0), name))
        assert parents(draft_puppet([ball("body", 0.0, 0.0, 3.0), *parts]))["strap"] == f"path_{own}"


def test_hips_are_the_root_of_names_where_there_are_some() -> None:
    for first, second, root in (("torso", "pelvis", "pelvis"), ("shirt", "shorts", "shorts"), ("torso", "x", "torso")):
        boxes = [solid(first, shapely.box(-2, 1.5, 2, 6)), solid(second, shapely.box(-2, -2, 2, 2.5))]
        found = parents(draft_puppet([*boxes, limb("arm", (1.5, 5.0), (5.0, 4.0))]))
        assert found[root] is None and found["arm"] == first


def test_near_and_far_are_named_as_left_and_right() -> None:
    """Also where both legs lie behind the body, as trousers under a coat."""
    _, arm_far, *body, _, arm = side_figure()
    legs = [limb(name, (x, -1.0), (x, -5.0), width=0.9) for name, x in (("leg_far", 0.5), ("leg_near", -0.5))]
    for parts, near, far in ((side_figure(), "leg", "leg_far"), ([arm_far, *legs, *body, arm], "leg_near", "leg_far")):
        made = draft_puppet(parts)
        sides = {part.name: (side.side, side.depth) for part, side in zip(made.parts, made.sides, strict=True)}
        assert sides[near] == sides["arm"] == ("R", "near") and sides[far] == sides["arm_far"] == ("L", "far")
        assert {bone.name for bone in made.bones} >= {"leg.L", "leg.R", "arm.L", "arm.R"}


def test_what_is_rigid_by_its_name_has_one_bone_unless_a_user_wants_more() -> None:
    for name, choices, bones in (("spear", {}, 1), ("spear", {"spear": PartChoice(bones=3)}, 3), ("tail", {}, 6)):
        made = draft_puppet([ball("hand", 0.0, 0.0, 1.0), limb(name, (0.0, 0.0), (14.0, 0.0))], choices)
        assert len(made.chain(1)) == bones


def test_bones_are_longer_where_a_part_is_thicker_and_shorter_at_its_ends() -> None:
    """The blends of two joints share the bones between; a blend is as long as the part is thick there."""
    four = {"tail": PartChoice(parent="body", bones=4)}
    straight = draft_puppet([ball("body", 0.0, 0.0, 2.0), limb("tail", (1.0, 0.0), (25.0, 0.0), width=1.0)], four)
    wedge = shapely.Polygon([(0.0, -2.0), (0.0, 2.0), (28.0, 0.8), (28.0, -0.8)])
    pointed = draft_puppet([ball("body", 0.0, 0.0, 3.0), solid("tail", wedge)], four)
    for made in (straight, pointed):
        first, second, third, last = (made.bones[bone].length for bone in made.chain(1))
        assert first < 0.9 * second and last < 0.9 * third
    second, third = (pointed.bones[bone].length for bone in pointed.chain(1)[1:3])
    assert second > 1.1 * third


# Bending


@pytest.mark.parametrize("count", slow_after(1, [2, None, 8], thorough_after=2))
def test_no_outline_folds_within_the_ranges_whatever_the_other_joints_do(count: int | None) -> None:
    """Points of the part keep their order: small triangles around them do not flip."""
    puppet = tailed(count)
    joints = puppet.draft.chain(0)[1:]
    assert all(puppet.ranges[k].low <= -60.0 and puppet.ranges[k].high >= 60.0 for k in joints) or count == 8
    random = np.random.default_rng(1)
    low, high = puppet.draft.parts[0].outline.bounds[:2], puppet.draft.parts[0].outline.bounds[2:]
    centres = random.uniform(low, high, (4000, 2))
    centres = centres[shapely.contains_xy(puppet.draft.parts[0].solid.buffer(-0.02), *centres.T)]
    corners = (centres[:, None] + 1e-3 * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])).reshape(-1, 2)
    for trial in range(20):
        pick = random.uniform if trial % 2 else lambda *ends: random.choice(ends)
        turned = {puppet.bones[k].name: float(pick(puppet.ranges[k].low, puppet.ranges[k].high)) for k in joints}
        assert puppet.beyond(turned) == ()
        a, b, c = puppet.moved(0, corners, turned).reshape(-1, 3, 2).transpose(1, 0, 2)
        assert np.linalg.det(np.stack([b - a, c - a], axis=1)).min() > 0.0


def test_ranges_reach_far_and_a_pose_beyond_names_its_bones() -> None:
    puppet = tailed(2)
    own = puppet.ranges[puppet.draft.chain(0)[1]]
    assert own.low <= own.simple_low < -60.0 and 60.0 < own.simple_high <= own.high
    assert 90.0 < -own.low <= 170.0 and 90.0 < own.high <= 170.0
    assert puppet.beyond({"tail.001": 30.0, "tail": 175.0}) == ()
    assert puppet.beyond({"tail.001": 172.0}) == ("tail.001",)
    for angle in np.linspace(own.simple_low, own.simple_high, 15):
        (outline, *_) = puppet.posed({"tail.001": angle})
        assert shapely.Polygon(outline).is_valid
    refusal(puppet.posed, {"wing": 1.0})


def test_weights_suit_engines() -> None:
    puppet = tailed()
    for part in (0, 2):  # a rider bends with what it lies on
        bones, weights = puppet.strongest(part, puppet.draft.parts[part].outline.vertices)
        assert bones.shape == weights.shape and weights.shape[1] <= 4
        assert np.allclose(weights.sum(axis=1), 1.0) and (np.diff(weights, axis=1) <= 0.0).all()
        assert set(bones[weights > 0].tolist()) <= set(puppet.draft.chain(0))
        np.testing.assert_array_equal(bones, puppet.strongest(0, puppet.draft.parts[part].outline.vertices)[0])
    inside = np.array([[2.2 + 0.1 * k, 0.5 + 0.8 * np.sin(0.1 * k + 0.2)] for k in range(80)])
    strongest = puppet.strongest(0, inside)[0][:, 0]
    assert (np.diff(strongest) >= 0).all() and len(set(strongest.tolist())) == len(puppet.draft.chain(0))
    rest = puppet.posed({})
    assert all(np.allclose(a, part.outline.vertices) for a, part in zip(rest, puppet.draft.parts, strict=True))


@pytest.mark.slow
def test_a_limb_turns_alone_with_what_hangs_on_it() -> None:
    puppet = puppet_from(front_figure)
    arm = next(bone for bone in puppet.bones if bone.name == "arm.L")
    turned = shapely.affinity.rotate
    for part, points in zip(puppet.draft.parts, puppet.posed({"arm.L": 40.0}), strict=True):
        moves = part.name in ("arm_l", "hand_l")
        assert np.allclose(points, part.outline.vertices) != moves
        if part.name == "hand_l":
            wanted = turned(shapely.LinearRing(part.outline.vertices), 40.0, origin=arm.head)
            np.testing.assert_allclose(points, shapely.get_coordinates(wanted)[:-1], atol=1e-6)


def test_a_part_whose_joints_would_turn_too_little_has_fewer_bones() -> None:
    """A wedge folds early; a user may still ask for its bones."""
    wedge = solid("fin", shapely.Polygon([(0.0, -3.0), (0.0, 3.0), (5.0, 0.6), (9.0, 2.5), (9.0, -2.5), (5.0, -0.6)]))
    parts = [wedge, ball("body", -2.0, 0.0, 4.0)]
    assert len(puppet_of(draft_puppet(parts, {"fin": PartChoice(bones=2)})).ranges) == 3
    free = puppet_of(draft_puppet(parts)).ranges
    assert all(each.low <= -90.0 and each.high >= 90.0 for each in free)


@pytest.mark.slow
@pytest.mark.parametrize("count", slow_after(0, [None, 6], thorough_after=1))
def test_parts_of_several_areas_and_with_narrow_holes_bend(count: int | None) -> None:
    """Joints lie in the area that bends, not on the way to it."""
    tail = limb("tail", (5.0, 0.0), (12.0, 0.0), width=0.7).solid
    speck, hole = shapely.Point(2.0, 0.0).buffer(0.4), shapely.Point(9.0, 0.1).buffer(0.06)
    parts = [solid("tail", shapely.union_all([tail, speck]) - hole), ball("body", 0.0, 0.0, 2.6)]
    puppet = puppet_of(draft_puppet(parts, {"tail": PartChoice(bones=count)}))
    joints = [puppet.bones[bone].head for bone in puppet.draft.chain(0)[1:]]
    assert joints and shapely.contains_xy(tail, *np.array(joints).T).all()


@pytest.mark.slow
def test_covers_keep_the_joint_painted_and_show_nothing_at_rest() -> None:
    """A bar with square ends opens at its joint; one with round ends in the middle of its parent does not."""
    lower, upper = (solid(name, shapely.box(x, 0.0, x + 5.0, 2.0)) for name, x in (("lower", 4.6), ("upper", 0.0)))
    round_end = limb("arm", (1.0, 1.0), (1.0, -4.0), width=0.9)
    made = draft_puppet([lower, upper, round_end], {"upper": PartChoice(parent="")})
    (cap,) = puppet_of(made).caps
    area, joint = shapely.Polygon(cap.outline.vertices), made.links[0].joint
    assert (cap.part, made.bones[cap.bone].name) == (0, "upper")
    assert lower.solid.buffer(1e-9).contains(area)
    kept = shapely.union_all([upper.solid, area, shapely.affinity.rotate(lower.solid, 90.0, origin=joint)])
    disc = shapely.Point(joint).buffer(1.0)
    assert disc.difference(kept).area < 0.001 * disc.area < disc.difference(shapely.difference(kept, area)).area


# Walks


@pytest.mark.slow
@pytest.mark.parametrize("parts", slow_after(0, [side_figure, front_figure]), ids=["side", "front"])
def test_walks_stay_within_the_ranges_and_repeat(parts: Callable[[], list[PuppetPart]]) -> None:
    puppet = puppet_from(parts)
    frames = walk(puppet).frames
    assert all(puppet.beyond(frame) == () for frame in frames)
    assert max(abs(angle) for frame in frames for angle in frame.values()) > 1.0
    following = [*frames[1:], frames[0]]
    assert max(abs(a[bone] - b[bone]) for a, b in zip(frames, following, strict=True) for bone in a) < 15.0


@pytest.mark.slow
def test_legs_of_a_walk_take_turns_and_a_walk_needs_legs() -> None:
    frames = walk(puppet_from(side_figure)).frames
    left, right = (np.array([frame[name] for frame in frames]) for name in ("leg.L", "leg.R"))
    assert np.ptp(left) > 30.0 and np.allclose(left, np.roll(right, len(frames) // 2))
    puppet = puppet_of(draft_puppet([ball("body", 0.0, 0.0, 2.0)]))
    refusal(walk, puppet)


# What artists' files are


def test_what_a_hand_holds_and_bars_and_frames_are_rigid() -> None:
    window = shapely.box(0.0, 0.0, 9.0, 2.0) - shapely.box(0.3, 0.3, 8.7, 1.7)
    for part, parent in (
        (limb("thing", (0.0, 0.0), (9.0, 4.0), width=0.8), ball("hand", 0.0, 0.0, 0.8)),
        (solid("girder", shapely.box(0.0, -0.4, 9.0, 0.4)), ball("body", 0.0, 0.0, 2.0)),
        (solid("window", window), ball("body", 0.0, 1.0, 2.0)),
    ):
        made = draft_puppet([part, parent], {parent.name: PartChoice(parent="")})
        assert len(made.chain(0)) <= 1, part.name
    tail = limb("tail", (0.0, 0.0), (9.0, 4.0), width=0.8)
    assert len(draft_puppet([tail, ball("body", 0.0, 0.0, 2.0)]).chain(0)) > 1


def test_wheels_turn_about_their_hubs_and_are_no_legs() -> None:
    wheels = [ball(f"path{k}", x, 0.0, 1.0) for k, x in enumerate((-3.0, 3.0))]
    made = draft_puppet([solid("frame", shapely.box(-5.0, 0.3, 5.0, 2.0)), *wheels])
    for k, x in ((1, -3.0), (2, 3.0)):
        assert made.links[k].joint == pytest.approx((x, 0.0), abs=0.02) and parents(made)[f"path{k - 1}"] == "frame"
    refusal(walk, puppet_of(made))


def test_alternatives_ride_on_one_part_and_covers_on_what_they_cover() -> None:
    head = ball("head", 0.0, 0.0, 4.0)
    mouths = [
        solid(f"mouth {shape}", shapely.box(-1.0, -2.0, 1.0, -1.0 - 0.2 * k), "mouth")
        for k, shape in enumerate(("open", "closed", "wide"))
    ]
    made = draft_puppet([ball("body", 0.0, -7.5, 4.0), head, *mouths])
    assert {parents(made)[mouth.name] for mouth in mouths} == {"head"}
    assert len({made.bone_of[k] for k in (2, 3, 4)}) == 1
    shin, greave = (limb(name, (0.0, -5.0), (0.0, -12.0), width=w) for name, w in (("path1", 1.0), ("path2", 1.2)))
    foot = ball("path3", 0.3, -12.2, 0.8)
    made = draft_puppet([shin, greave, foot, ball("path4", 0.0, -2.0, 4.0)])
    assert parents(made)["path2"] == "path1" == parents(made)["path3"]


def test_names_tell_sides_in_other_languages() -> None:
    body = solid("Туловище", shapely.box(-2.0, 0.0, 2.0, 6.0))
    for left, right in (("Левая рука", "Правая рука"), ("左腕", "右腕"), ("bras gauche", "bras droit")):
        arms = [limb(name, (x, 5.0), (2.5 * x, 1.0), width=0.9) for name, x in ((left, -2.0), (right, 2.0))]
        made = draft_puppet([*arms, body])
        assert [side.side for side in made.sides] == ["L", "R", ""]


def test_trousers_fork_and_long_bodies_bend_both_ways_from_where_limbs_hang() -> None:
    legs = [shapely.LineString([(0.0, 0.0), (x, -8.0)]).buffer(0.9) for x in (-2.4, 2.4)]
    trousers = solid("trousers", shapely.union_all([*legs, shapely.box(-1.2, -0.5, 1.2, 1.5)]))
    body = [(float(x), 0.0) for x in np.linspace(-12.0, 12.0, 9)]
    hung = [limb(f"path{k}", (x, 0.0), (x, -4.0), width=0.8) for k, x in enumerate((-1.5, 1.5))]
    for parts, root, ends in (
        ([trousers, solid("torso", shapely.box(-1.2, 1.0, 1.2, 6.0))], "trousers", ((-2.4, -8.0), (2.4, -8.0))),
        ([limb("body", *body, width=2.0), *hung], "body", ((-12.0, 0.0), (12.0, 0.0))),
    ):
        puppet = puppet_of(draft_puppet(parts, {root: PartChoice(parent="")}))
        made = puppet.draft
        bones = [made.bones[k] for k in made.chain(made.number(root))]
        assert all(min(np.hypot(*np.subtract(bone.tail, end)) for bone in bones) < 1.5 for end in ends)
        turns = [puppet.ranges[k] for k in made.chain(made.number(root))[1:]]
        assert min(min(-each.low, each.high) for each in turns) > 40.0
        rng, field = np.random.default_rng(3), puppet.fields[made.number(root)]
        assert field is not None
        places, corners = field.grid.vertices, field.grid.triangles
        for _ in range(20):
            pose = {puppet.bones[k].name: rng.uniform(puppet.ranges[k].low, puppet.ranges[k].high)
                    for k in made.chain(made.number(root))[1:]}  # fmt: skip
            a, b, c = puppet.moved(made.number(root), places, pose)[corners].transpose(1, 2, 0)
            assert ((b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0])).all()
