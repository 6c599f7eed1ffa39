"""A draft of a puppet: parts, how they hang together, and bones; made by rules, changed by choices."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...errors import invalid_setting
from ...geometry.arrays import FloatArray
from ..naming import Names
from ..part import PuppetPart, with_unique_names
from ..skeleton.bone import Bone
from ..skeleton.bone_tree import BoneTree
from ..skeleton.chains import MOST_BONES, bar_like, bones_of, stiff
from .lexicon import HOLDING, RIGID
from .links import Hold, Link, PartChoice
from .names import words_of
from .sides import Side, sides_of
from .tree import links_of

TOWARDS = 0.3
"""A rigid part's bone ends at its only limb's joint, if that is at least this part of the part's length away."""


@dataclass(frozen=True, eq=False)
class PuppetDraft:
    """Parts with their links and bones. Make it with `draft_puppet`, change it with `edited`."""

    parts: tuple[PuppetPart, ...]
    """In stacking order, the lowest first; names are unique."""
    links: tuple[Link, ...]
    """How each part hangs on another."""
    sides: tuple[Side, ...]
    """Left or right, near or far, of each part."""
    bones: tuple[Bone, ...]
    """Parents first; the root's come first. Names are those of the parts, with numbers along a part that bends, and .L
    and .R."""
    bone_of: tuple[int, ...]
    """The first bone of each part; for a rider, the bone that it follows."""
    choices: Mapping[str, PartChoice] = field(default_factory=dict)
    """What a user decided, by name of the part."""

    def chain(self, part: int) -> tuple[int, ...]:
        """The bones along a part, from its joint to its tip; none for a rider."""
        if self.links[part].hold is Hold.RIDES:
            return ()
        return tuple(k for k, owner in enumerate(self.part_of) if owner == part)

    @property
    def part_of(self) -> tuple[int, ...]:
        """The part along which each bone lies."""
        owners = sorted((first, part) for part, first in enumerate(self.bone_of) if self.links[part].hold != Hold.RIDES)
        return tuple(max((f, p) for f, p in owners if f <= bone)[1] for bone in range(len(self.bones)))

    def children(self, part: int) -> tuple[int, ...]:
        """The parts that hang on a part, riders included."""
        return tuple(k for k, link in enumerate(self.links) if link.parent == part)

    @property
    def doubtful(self) -> tuple[str, ...]:
        """Names of the parts whose parent is uncertain."""
        return tuple(part.name for part, link in zip(self.parts, self.links, strict=True) if link.is_doubtful)

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences about what to look at."""
        said = []
        for part, link in zip(self.parts, self.links, strict=True):
            if link.parent is not None and link.gap == np.inf and not link.is_chosen:
                nearest = self.parts[link.parent].name
                said.append(f"{part.name} touches nothing: it hangs on {nearest}, which is nearest.")
            elif link.is_doubtful:
                parent = self.parts[link.parent].name if link.parent is not None else ""
                said.append(f"{part.name} might hang on another part than {parent}.")
        return tuple(said)

    def number(self, name: str) -> int:
        """The number of the part with a name. Raises NestedCagesError if there is none."""
        for k, part in enumerate(self.parts):
            if part.name == name:
                return k
        raise invalid_setting(f"There is no part {name!r}; there are {', '.join(part.name for part in self.parts)}.")

    def edited(self, name: str, choice: PartChoice) -> PuppetDraft:
        """The draft with another choice about a part, all else derived again; `PartChoice()` takes choices back.

        Raises NestedCagesError for the name of no part, or if parts would hang on each other in a circle.
        """
        self.number(name)
        choices = {**self.choices, name: choice}
        if choice == PartChoice():
            del choices[name]
        return draft_puppet(self.parts, choices)


def draft_puppet(parts: Iterable[PuppetPart], choices: Mapping[str, PartChoice] | None = None) -> PuppetDraft:
    """A draft from parts in stacking order, the lowest first.

    choices: what a user decided, by name of the part. Raises NestedCagesError if there are no parts, for choices about
    parts that do not exist, for circles, and where shapely is missing.
    """
    named = with_unique_names(parts)
    chosen = dict(choices or {})
    links = links_of(named, chosen)
    sides = sides_of(named, links)
    bones, bone_of = _bones(named, links, sides, chosen, {})
    return PuppetDraft(named, links, sides, bones, bone_of, chosen)


def stiffened(draft: PuppetDraft, most: Mapping[str, int]) -> PuppetDraft:
    """A draft with a maximum number of bones in some parts, by their names, unless a user chose how many."""
    bones, bone_of = _bones(draft.parts, draft.links, draft.sides, draft.choices, most)
    return replace(draft, bones=bones, bone_of=bone_of)


def _bones(
    parts: Sequence[PuppetPart],
    links: Sequence[Link],
    sides: Sequence[Side],
    choices: Mapping[str, PartChoice],
    most: Mapping[str, int],
) -> tuple[tuple[Bone, ...], tuple[int, ...]]:
    """Bones from the root outwards, and the bone of each part."""
    bones: list[Bone] = []
    first: dict[int, int] = {}
    trees: dict[int, BoneTree] = {}
    names = Names()

    def carrier(part: int, place: tuple[float, float]) -> int:
        """The bone of a part that moves a place on it."""
        return first[part] + (trees[part].nearest(np.array(place)) if part in trees else 0)

    for part in _from_the_root(links):
        link = links[part]
        if link.hold is Hold.RIDES and link.parent is not None:
            first[part] = carrier(link.parent, link.joint)
            continue
        limbs = [other.joint for other in links if other.parent == part and other.hold is Hold.JOINT]
        choice = choices.get(parts[part].name, PartChoice())
        if choice.chain is not None:
            tree = BoneTree.chain(np.array(choice.chain))
        else:
            tree = bones_of(
                parts[part],
                None if link.parent is None else link.joint,
                limbs,
                bones=choice.bones or (1 if _is_rigid(parts, links, sides, part) else None),
                most=most.get(parts[part].name, MOST_BONES),
            )
            if len(tree) == 1 and len(limbs) == 1 and link.parent is not None:
                tree = BoneTree.chain(_towards(np.stack((tree.heads[0], tree.tails[0])), np.array(limbs[0])))
        above = None if link.parent is None else carrier(link.parent, link.joint)
        first[part], trees[part] = len(bones), tree
        for head, tail, on in zip(tree.heads.tolist(), tree.tails.tolist(), tree.parents, strict=True):
            parent = above if on < 0 else first[part] + on
            name = names.new(sides[part].stem, f".{sides[part].side}" if sides[part].side else "")
            bones.append(Bone((head[0], head[1]), (tail[0], tail[1]), parent, name))
    return tuple(bones), tuple(first[part] for part in range(len(parts)))


def _is_rigid(parts: Sequence[PuppetPart], links: Sequence[Link], sides: Sequence[Side], part: int) -> bool:
    """Whether a part is rigid by its name or its shape; or has no known name, and a hand holds it or it is a bar that
    has no twin."""
    noun, parent = words_of(parts[part].name).noun, links[part].parent
    if noun:
        return noun in RIGID
    is_held = parent is not None and words_of(parts[parent].name).noun in HOLDING
    is_bar = not sides[part].side and bar_like(parts[part], is_root=parent is None)
    return is_held or is_bar or stiff(parts[part])


def _from_the_root(links: Sequence[Link]) -> list[int]:
    """Parts, parents first."""
    order = [k for k, link in enumerate(links) if link.parent is None]
    for part in order:
        order += [k for k, link in enumerate(links) if link.parent == part]
    return order


def _towards(chain: FloatArray, joint: FloatArray) -> FloatArray:
    far = np.hypot(*(joint - chain[0])) > TOWARDS * np.hypot(*(chain[1] - chain[0]))
    return np.stack((chain[0], joint)) if far else chain
