"""A puppet: a draft with the fields of its bending parts, weights everywhere, and ranges of its joints."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from ..errors import invalid_setting
from ..geometry.arrays import FloatArray, IntArray
from .caps import Cap, caps_of
from .draft.draft import PuppetDraft, stiffened
from .draft.evidence import CONTAINED
from .draft.links import Hold, PartChoice
from .field.bone_weights import skinned
from .field.mesh import BendField, bend_field
from .field.ranges import FREE, JointRange, first_that_turns, least_turn, ranges_of
from .field.skinning import PreserveVolume, Skin
from .limbs import Figure, forwards, limbs_of
from .skeleton.bone import Bone, by_number, ends_of
from .skeleton.bone_tree import BoneTree

Made = TypeVar("Made")

LEAST_TURN, LEAST_OF_FORK = 90.0, 45.0
"""Degrees that each joint of a draft turns at least, either way, without a fold; and each one of a part that forks."""


@dataclass(frozen=True, eq=False)
class Puppet:
    """Parts that move by themselves. Make it with `puppet_of`."""

    draft: PuppetDraft
    fields: tuple[BendField | None, ...]
    """The field that carries each part: its own one if it bends, that of the part it rides on; None for a part that one
    bone moves, `draft.bone_of`."""
    ranges: tuple[JointRange, ...]
    """Of each bone."""
    skin: Skin = field(default_factory=PreserveVolume)
    """How bones blend, for which weights and ranges hold."""

    @property
    def bones(self) -> tuple[Bone, ...]:
        """The draft's bones: head, tail, parent and name."""
        return self.draft.bones

    @cached_property
    def caps(self) -> tuple[Cap, ...]:
        """Paint that stays behind at joints, so that nothing opens there."""
        return caps_of(self.draft)

    @property
    def figure(self) -> Figure:
        """Bones, ranges and limbs, of which clips are made."""
        limbs = limbs_of(self.draft)
        return Figure(self.bones, self.ranges, limbs, forwards(self.draft, limbs))

    def weights_at(self, part: int, points: FloatArray) -> FloatArray:
        """(P, B) weights of all bones at points (P, 2) of a part, rows of sum 1: one not 0 without a field, two at its
        vertices, at most four between these."""
        weights = np.zeros((len(points), len(self.bones)))
        carrier = self.fields[part]
        if carrier is None:
            weights[:, self.draft.bone_of[part]] = 1.0
        else:
            own = slice(carrier.first_bone, carrier.first_bone + len(carrier.bends) + 1)
            weights[:, own] = carrier.weights_at(points)
        return weights

    def strongest(self, part: int, points: FloatArray, most: int = 4) -> tuple[IntArray, FloatArray]:
        """(P, most) numbers and weights of the strongest bones at points of a part, strongest first; rows of sum 1."""
        weights = self.weights_at(part, points)
        order = np.argsort(-weights, axis=1, kind="stable")[:, :most]
        kept = np.take_along_axis(weights, order, axis=1)
        return order, kept / kept.sum(axis=1, keepdims=True)

    def moved(self, part: int, points: FloatArray, turned: Mapping[str, float]) -> FloatArray:
        """Points (P, 2) of a part where a pose takes them.

        turned: degrees, counter-clockwise, relative to the parent, by name of the bone. Raises NestedCagesError for the
        name of no bone. Points in a field move with its triangles, as what is bound to it in Blender.
        """
        degrees, carrier = by_number(self.bones, turned), self.fields[part]
        if carrier is None:
            return skinned(points, self.weights_at(part, points), self.bones, degrees, self.skin)
        vertices = carrier.grid.vertices
        weights = np.zeros((len(vertices), len(self.bones)))
        weights[:, carrier.first_bone : carrier.first_bone + len(carrier.bends) + 1] = carrier.weights
        posed = skinned(vertices, weights, self.bones, degrees, self.skin)
        return np.asarray(points + carrier.grid.interpolation(points) @ (posed - vertices))

    def posed(self, turned: Mapping[str, float]) -> list[FloatArray]:
        """(n, 2) vertices of each part's outline under a pose; see `moved`."""
        return [self.moved(k, part.outline.vertices, turned) for k, part in enumerate(self.draft.parts)]

    def scaled(self, unit: float) -> Puppet:
        """The puppet with bones in other units; fields stay as they are."""

        def end(place: tuple[float, float]) -> tuple[float, float]:
            return unit * place[0], unit * place[1]

        bones = tuple(replace(bone, head=end(bone.head), tail=end(bone.tail)) for bone in self.bones)
        return replace(self, draft=replace(self.draft, bones=bones))

    def beyond(self, turned: Mapping[str, float]) -> tuple[str, ...]:
        """Names of the bones that a pose turns out of the ranges without folds; with none, the pose is proved."""
        degrees = by_number(self.bones, turned)
        return tuple(self.bones[k].name for k, angle in degrees.items() if not self.ranges[k].holds(angle))


def puppet_of(draft: PuppetDraft, skin: Skin | None = None) -> Puppet:
    """Fields, weights and ranges for a draft.

    A part with a joint that turns less than `LEAST_TURN` gets fewer bones, unless a user chose how many: the own
    draft of the puppet has these. Raises NestedCagesError where a part that bends has no cage.
    """
    chosen = skin or PreserveVolume()
    ends_of(draft.bones)
    draft, made = bent(draft, lambda draft, part: _best_field(draft, part, chosen))
    fields: dict[int, BendField] = {}
    ranges = [FREE] * len(draft.bones)
    for part, (own, turns) in made.items():
        chain = draft.chain(part)
        ranges[chain[1] : chain[-1] + 1] = turns
        fields.update(dict.fromkeys((part, *riders_on(draft, part)), replace(own, first_bone=chain[0])))
    return Puppet(draft, tuple(fields.get(k) for k in range(len(draft.parts))), tuple(ranges), chosen)


def bent(
    draft: PuppetDraft, make: Callable[[PuppetDraft, int], tuple[Made, list[JointRange]]]
) -> tuple[PuppetDraft, dict[int, tuple[Made, list[JointRange]]]]:
    """What is made for each part that bends, by its number, and the ranges of its joints, by a draft in which parts
    have fewer bones where one turns less than `LEAST_TURN`, unless a user chose how many. Numbers of bones are those
    when a part was made."""
    known: dict[tuple[int, int], tuple[Made, list[JointRange]]] = {}
    most: dict[str, int] = {}
    while True:
        counts = {part: len(draft.chain(part)) for part in range(len(draft.parts))}
        bending = [(part, count) for part, count in counts.items() if count > 1]
        for part, count in bending:
            if (part, count) not in known:
                known[part, count] = make(draft, part)
            name = draft.parts[part].name
            is_free = draft.choices.get(name, PartChoice()).bones is None
            forks = len({draft.bones[bone].parent for bone in draft.chain(part)}) < count
            if is_free and least_turn(known[part, count][1]) < (LEAST_OF_FORK if forks else LEAST_TURN):
                most[name] = count - 1
        stiffer = stiffened(draft, most)
        if len(stiffer.bones) == len(draft.bones):
            return draft, {part: known[part, count] for part, count in bending}
        draft = stiffer


def limb_of(draft: PuppetDraft, part: int) -> tuple[BoneTree, float]:
    """A part's bones, and the radius around its own joint that no bend reaches, so that no paint opens there."""
    own, link = draft.chain(part), draft.links[part]
    bones = [draft.bones[bone] for bone in own]
    parents = [-1, *((bone.parent or 0) - own[0] for bone in bones[1:])]
    tree = BoneTree(np.array([bone.head for bone in bones]), np.array([bone.tail for bone in bones]), tuple(parents))
    return tree, 0.0 if link.parent is None else link.radius


def reweighted(puppet: Puppet, part: int, weights: FloatArray) -> Puppet:
    """The puppet with other weights (N, K + 1) in the field of a part, rows of sum 1, and the ranges that are proved of
    them: no angle if a vertex follows more than two bones, or two that are not next to each other.
    """
    old = puppet.fields[part]
    if old is None:
        raise invalid_setting(f"{puppet.draft.parts[part].name} does not bend, so it has no weights.")
    new, first = old.with_weights(weights), old.first_bone + 1
    ranges = list(puppet.ranges)
    ranges[first : first + len(old.bends)] = ranges_of(new, puppet.skin)
    fields = tuple(new if each is old else each for each in puppet.fields)
    return replace(puppet, fields=fields, ranges=tuple(ranges))


def _best_field(draft: PuppetDraft, part: int, skin: Skin) -> tuple[BendField, list[JointRange]]:
    """The field of a part and the ranges of its joints, with denser triangles where these are too narrow."""
    bones, kept = limb_of(draft, part)
    solids = [draft.parts[k].solid for k in (part, *riders_on(draft, part))]
    return first_that_turns(bend_field(solids, bones, draft.bone_of[part], kept, skin), skin, LEAST_TURN)


def riders_on(draft: PuppetDraft, part: int) -> list[int]:
    """What lies on a part and bends with it, riders of riders included."""
    found: list[int] = []
    for k in draft.children(part):
        link = draft.links[k]
        if link.hold is Hold.RIDES and link.radius > 0.0 and _share_on(draft, k, part) >= CONTAINED:
            found += [k, *riders_on(draft, k)]
    return found


def _share_on(draft: PuppetDraft, rider: int, part: int) -> float:
    """The part of a rider's area that lies on a part."""
    solid = draft.parts[rider].solid
    return float(solid.intersection(draft.parts[part].solid).area / solid.area)
