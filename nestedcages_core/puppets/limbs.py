"""What the limbs of a puppet are for, legs, arms, tails and the head, and all that a clip needs of a puppet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .draft.draft import PuppetDraft
from .draft.lexicon import ARMS, LEGS, TRUNKS
from .draft.links import Hold
from .draft.names import words_of
from .field.ranges import JointRange
from .skeleton.bone import Bone

ON_GROUND = 0.15
"""A leg ends this near the lowest point of the drawing, in heights of the drawing."""

FROM_THE_FRONT, LEGS_APART = 0.35, 0.2
"""How far a figure steps that is seen from the front, against one seen from the side; and least distance of its two
legs, in lengths of a leg."""


class Limbs(NamedTuple):
    """Bones of each limb by name, from the body outwards."""

    legs: tuple[tuple[str, ...], ...]
    arms: tuple[tuple[str, ...], ...]
    tails: tuple[tuple[str, ...], ...]
    heads: tuple[tuple[str, ...], ...]
    trunks: tuple[tuple[str, ...], ...]
    """The bones of the root, once."""


@dataclass(frozen=True)
class Figure:
    """A puppet as clips see it: bones, without what they move."""

    bones: tuple[Bone, ...]
    """Parents first."""
    ranges: tuple[JointRange, ...]
    """Of each bone."""
    limbs: Limbs
    ahead: float
    """Sign and size of turns that move a hanging leg forwards: 1 for a figure that looks to larger x, -1 to smaller x,
    less for one that is seen from the front."""


def limbs_of(draft: PuppetDraft) -> Limbs:
    """The limbs on the trunk: legs reach the ground and are named so or are one of a pair, arms are named so or are
    left and right, a tail bends, and the head carries details.
    """
    nouns = tuple(words_of(part.name).noun for part in draft.parts)
    bottoms = [float(part.outline.vertices[:, 1].min()) for part in draft.parts]
    ground, top = min(bottoms), max(float(part.outline.vertices[:, 1].max()) for part in draft.parts)
    found: dict[str, list[tuple[str, ...]]] = {"legs": [], "arms": [], "tails": [], "heads": []}
    trunk = [k for k, link in enumerate(draft.links) if link.parent is None or _is_trunk(draft, k, nouns)]
    for part, link in enumerate(draft.links):
        if link.hold is not Hold.JOINT or link.parent not in trunk or part in trunk:
            continue
        parts = _outwards(draft, part)
        bones = tuple(draft.bones[bone].name for k in parts for bone in draft.chain(k))
        riders = sum(draft.links[k].hold is Hold.RIDES for own in parts for k in draft.children(own))
        is_paired = not nouns[part] and bool(draft.sides[part].side) and not draft.parts[part].is_round
        may_be_leg = is_paired or nouns[part] in LEGS
        reaches = may_be_leg and min(bottoms[k] for k in parts) < ground + ON_GROUND * (top - ground)
        if nouns[part] == "tail":
            kind = "tails"
        elif reaches and draft.bones[draft.bone_of[part]].tail[1] < draft.bones[draft.bone_of[part]].head[1]:
            kind = "legs"
        elif nouns[part] in ARMS:
            kind = "arms"
        elif {"head", "neck", "skull"} & {nouns[k] for k in parts} or (riders > 1 and not nouns[part]):
            kind = "heads"
        elif is_paired:
            kind = "arms"
        elif len(draft.chain(part)) > 1:
            kind = "tails"
        else:
            continue
        found[kind].append(bones)
    root = next(k for k, link in enumerate(draft.links) if link.parent is None)
    trunks = (tuple(draft.bones[bone].name for bone in draft.chain(root)),)
    return Limbs(**{kind: tuple(each) for kind, each in found.items()}, trunks=trunks)


def _is_trunk(draft: PuppetDraft, part: int, nouns: tuple[str, ...]) -> bool:
    """Whether a part is named as one of the trunk, and hangs on such a one or on the root."""
    above = draft.links[part].parent
    if nouns[part] not in TRUNKS or draft.links[part].hold is not Hold.JOINT or above is None:
        return False
    return draft.links[above].parent is None or _is_trunk(draft, above, nouns)


def _outwards(draft: PuppetDraft, part: int) -> list[int]:
    """A part and what turns on it, the largest one each time."""
    found = [part]
    while True:
        ahead = [k for k in draft.children(found[-1]) if draft.links[k].hold is Hold.JOINT]
        if not ahead:
            return found
        found.append(max(ahead, key=lambda k: draft.parts[k].outline.area))


def forwards(draft: PuppetDraft, limbs: Limbs) -> float:
    """Sign and size of turns that move a hanging leg forwards; see `Figure`."""
    root = next(k for k, link in enumerate(draft.links) if link.parent is None)
    riders = [k for k, link in enumerate(draft.links) if link.hold is Hold.RIDES and link.parent != root]
    middle = float(draft.parts[root].disc[0][0])
    looks = np.sign([float(draft.parts[k].disc[0][0]) - middle for k in riders]).sum()
    return (-1.0 if looks < 0.0 else 1.0) * (FROM_THE_FRONT if _is_from_the_front(draft, limbs) else 1.0)


def _is_from_the_front(draft: PuppetDraft, limbs: Limbs) -> bool:
    """Whether a figure has two legs that are apart."""
    if len(limbs.legs) != 2:
        return False
    bones = {bone.name: bone for bone in draft.bones}
    one, other = ([bones[name] for name in leg] for leg in limbs.legs)
    return abs(one[0].head[0] - other[0].head[0]) > LEGS_APART * sum(bone.length for bone in one)
