"""What the limbs of a puppet are for: legs, arms, tails and the head."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .draft import PuppetDraft
from .links import Hold
from .words import TRUNKS

ON_GROUND = 0.15
"""A leg ends this near the lowest point of the drawing, in heights of the drawing."""

ARMS = frozenset({"arm", "upper_arm", "sleeve"})
"""Words for the first part of an arm."""


@dataclass(frozen=True)
class Limbs:
    """Bones of each limb by name, from the body outwards."""

    legs: tuple[tuple[str, ...], ...]
    arms: tuple[tuple[str, ...], ...]
    tails: tuple[tuple[str, ...], ...]
    heads: tuple[tuple[str, ...], ...]


def limbs_of(draft: PuppetDraft, nouns: tuple[str, ...]) -> Limbs:
    """The limbs on the trunk: legs reach the ground, arms are named so or are left and right, a tail bends, and the
    head carries details. nouns: what each part's name says it is.
    """
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
        reaches = min(bottoms[k] for k in parts) < ground + ON_GROUND * (top - ground)
        if nouns[part] == "tail":
            kind = "tails"
        elif reaches and draft.bones[draft.bone_of[part]].tail[1] < draft.bones[draft.bone_of[part]].head[1]:
            kind = "legs"
        elif nouns[part] in ARMS:
            kind = "arms"
        elif {"head", "neck", "skull"} & {nouns[k] for k in parts} or (riders > 1 and not nouns[part]):
            kind = "heads"
        elif draft.sides[part].side and not nouns[part]:
            kind = "arms"
        elif len(draft.chain(part)) > 1:
            kind = "tails"
        else:
            continue
        found[kind].append(bones)
    return Limbs(**{kind: tuple(each) for kind, each in found.items()})


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


def forwards(draft: PuppetDraft) -> float:
    """Sign of a turn that moves a hanging leg forwards: 1 for a figure that looks to larger x, -1 to smaller x."""
    root = next(k for k, link in enumerate(draft.links) if link.parent is None)
    riders = [k for k, link in enumerate(draft.links) if link.hold is Hold.RIDES and link.parent != root]
    middle = float(draft.parts[root].disc[0][0])
    looks = np.sign([float(draft.parts[k].disc[0][0]) - middle for k in riders]).sum()
    return -1.0 if looks < 0.0 else 1.0
