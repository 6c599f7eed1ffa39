"""A drawing that has changed: which parts are the old ones, and a draft in which these hang as before."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from .draft import PuppetDraft, draft_puppet
from .links import Hold, PartChoice
from .parts import PuppetPart, with_unique_names

SAME_PLACE = 0.5
"""A part without an id or a name of its own is an old one if they share this part of what both cover together."""


@dataclass(frozen=True, eq=False)
class Redraft:
    """A draft of a changed drawing."""

    draft: PuppetDraft
    old_names: dict[str, str]
    """The old name of each part that was there before, by its name now."""
    added: tuple[str, ...]
    removed: tuple[str, ...]


def redrafted(old: PuppetDraft, parts: Iterable[PuppetPart]) -> Redraft:
    """A draft of changed parts that keeps what it can of an old one.

    Parts are told again by their ids, then by group and name, then by place. Those whose parent is still there hang on
    it as before; unchanged outlines keep their joints and numbers of bones. Whatever is new is drafted by the rules.
    """
    new = with_unique_names(parts)
    match = _matches(old.parts, new)
    name_of = {was: new[now].name for now, was in match.items()}
    choices: dict[str, PartChoice] = {}
    for now, was in match.items():
        link, chosen = old.links[was], old.choices.get(old.parts[was].name, PartChoice())
        if link.parent is None:
            choices[new[now].name] = PartChoice(parent="", bones=chosen.bones)
        elif link.parent in name_of:
            is_same = new[now].outline == old.parts[was].outline
            count = len(old.chain(was))
            choices[new[now].name] = PartChoice(
                parent=name_of[link.parent],
                joint=link.joint if is_same else chosen.joint,
                hold=link.hold if link.hold is Hold.RIDES else Hold.JOINT,
                bones=count if is_same and count else chosen.bones,
            )
    return Redraft(
        draft_puppet(new, choices),
        {new[now].name: old.parts[was].name for now, was in match.items()},
        tuple(part.name for k, part in enumerate(new) if k not in match),
        tuple(part.name for k, part in enumerate(old.parts) if k not in match.values()),
    )


def _matches(old: tuple[PuppetPart, ...], new: tuple[PuppetPart, ...]) -> dict[int, int]:
    """The old part of each new one that has one, by numbers."""
    found: dict[int, int] = {}

    def free() -> tuple[list[int], list[int]]:
        taken = set(found.values())
        return [k for k in range(len(new)) if k not in found], [k for k in range(len(old)) if k not in taken]

    for key in (lambda part: part.identity, lambda part: (part.groups, part.name)):
        ours, theirs = free()
        known = {key(old[k]): k for k in theirs if key(old[k])}
        for k in ours:
            if key(new[k]) in known:
                found[k] = known.pop(key(new[k]))
    ours, theirs = free()
    shared = sorted(((_shared(new[k], old[j]), k, j) for k in ours for j in theirs), reverse=True)
    for share, k, j in shared:
        if share >= SAME_PLACE and k not in found and j not in found.values():
            found[k] = j
    return found


def _shared(one: PuppetPart, other: PuppetPart) -> float:
    """The area that two parts share over the area that they cover together."""
    both = float(one.solid.intersection(other.solid).area)
    return both / (one.outline.area + other.outline.area - both)
