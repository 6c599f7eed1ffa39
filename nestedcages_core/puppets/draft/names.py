"""What names say by `lexicon`: which part of a body hangs on which, and that left does not hang on right."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf

from .lexicon import (
    CODES,
    DEPTHS,
    ENDS,
    HALVES,
    HEIGHTS,
    HOLDING,
    IRREGULAR,
    NO_EXTENSION,
    PARENTS,
    PLACES,
    ROOT_NAMES,
    SIDES,
    TRUNKS,
)

HEIGHT, NUMBER = 3, 4
"""Places of the labels for heights and for numbers, after those for sides, depths and ends."""

NAMES = (
    "names",
    "names_of_others",
    "names_reversed",
    "held",
    "name_extends",
    "name_follows",
    "labels",
    "labels_of_others",
)
"""What names say of a pair: of parts of a body that hang together, that do not, or the other way around; that a hand
may hold a thing; that one is a part of the other, as a tip of a tail, or the next one; sides, depths, ends, heights and
numbers that are the same, and that are not."""


@dataclass(frozen=True)
class Words:
    """What a name says."""

    noun: str
    """The part of a body; empty if the name says none that is known."""
    labels: tuple[frozenset[str], ...]
    """Words for its side, its depth, its end of the body and its height, and its numbers."""
    others: tuple[str, ...] = ()
    """All words but these."""


def name_words(name: str) -> list[str]:
    """The words of a name, split at signs, at capitals and around numbers, and after a word for a place."""
    spread = re.sub(r"(?<=[^\W\d_A-ZА-Я])(?=[A-ZА-Я])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=[左右])|(?=[左右])", " ", name)
    return [half for word in re.findall(r"[^\W\d_]+|\d+", spread) for half in _halves(word)]


def name_without(name: str, dropped: Iterable[str]) -> str:
    """A name without some of its words; the name itself if it has none of them, or no others."""
    words = name_words(name)
    kept = [word for word in words if word.lower() not in dropped]
    return "_".join(kept) if kept and len(kept) < len(words) else name


def side_of(name: str) -> str:
    """L or R if a name says so; a single letter counts at the start and at the end."""
    words = [word.lower() for word in name_words(name)]
    sides = [
        SIDES[word] for k, word in enumerate(words) if word in SIDES and (len(word) > 1 or k in (0, len(words) - 1))
    ]
    others = [word for word in words if word.isalpha() and word not in SIDES]
    has_more = any(len(word) > 1 or not word.isascii() for word in others)
    return sides[-1] if sides and has_more else ""


def words_of(name: str) -> Words:
    """What a name says about its part."""
    words = [word.lower() for word in name_words(name)]
    labels = [frozenset(side_of(name))]
    labels += [frozenset(table[word] for word in words if word in table) for table in (DEPTHS, ENDS, HEIGHTS)]
    numbers = frozenset(word for word in words if word.isdigit())
    nouns = [word for word in words if word not in {**DEPTHS, **ENDS, **HEIGHTS, **SIDES} and not word.isdigit()]
    noun = nouns[-1] if nouns else ""
    limb = next((word for word in ("arm", "leg") if word in words), "")
    if limb:
        half = next((HALVES[word] for word in words if word in HALVES), "")
        noun = "forearm" if "fore arm" in " ".join(words) else f"{half}_{limb}" if half else noun
        labels[HEIGHT] = frozenset()
    elif {"upper", "lower"} & set(nouns):
        noun = next((word for word in nouns if _known_noun(word)), f"{'upper' if 'upper' in nouns else 'lower'}_leg")
    elif noun == "ear" and "inner" in nouns:
        noun = "inner_ear"
    return Words(_known_noun(noun), (*labels, numbers), tuple(nouns))


def _known_noun(noun: str) -> str:
    """A part of a body, as one of it; empty if it is none that is known."""
    singular = IRREGULAR.get(noun, noun.removesuffix("s"))
    return next((each for each in (noun, singular) if each in PARENTS or each in TRUNKS), "")


def _halves(word: str) -> tuple[str, ...]:
    """A word that says where and what, such as hindleg, as two; other words as they are."""
    low = word.lower()
    if low in CODES:
        return CODES[low]
    cuts = [at for at in range(3, len(word) - 2) if low[:at] in PLACES and _known_noun(low[at:])]
    return (word[: cuts[0]], word[cuts[0] :]) if cuts and not _known_noun(low) else (word,)


def agreements(words: Sequence[Words], pairs: Sequence[tuple[int, int]]) -> dict[str, list[float]]:
    """What names say, as the columns `NAMES` of the evidence that the first of each pair hangs on the second.

    Of several parts that one may hang on by its name, the closest ones count: a head hangs on a neck, else on a body.
    """
    ranks = [_rank(words[child], words[parent]) for child, parent in pairs]
    extends = [_extends(words[child], words[parent]) for child, parent in pairs]
    extending = {child for (child, _), is_so in zip(pairs, extends, strict=True) if is_so}
    extending -= {child for child in extending if words[child].noun in NO_EXTENSION}
    least = dict[int, float]()
    for (child, _), rank in zip(pairs, ranks, strict=True):
        least[child] = min(rank, least.get(child, inf))
    rows = []
    for (child, parent), rank, is_extension in zip(pairs, ranks, extends, strict=True):
        one, other = words[child], words[parent]
        is_known = bool(one.noun in PARENTS and other.noun)
        is_named = rank < inf and rank == least[child] and child not in extending
        both = [(own, its) for own, its in zip(one.labels, other.labels, strict=True) if own and its]
        rows.append((
            is_named,
            is_known and not is_named,
            rank == inf and _rank(other, one) < inf,
            not one.noun and other.noun in HOLDING,
            is_extension,
            _follows(one, other),
            sum(bool(own & its) for own, its in both),
            sum(not own & its for own, its in both) - _follows(one, other),
        ))  # fmt: skip
    return {name: [float(row[k]) for row in rows] for k, name in enumerate(NAMES)}


def root_names(words: Sequence[Words]) -> list[float]:
    """1 for the names of the most likely roots, 0 for others of a trunk and unknown ones, -1 for other known ones."""
    ranks = [next((k for k, root in enumerate(ROOT_NAMES) if each.noun in root), inf) for each in words]
    best = min(ranks)
    return [1.0 if rank == best < inf else 0.0 if rank < inf else -1.0 * bool(each.noun)
            for each, rank in zip(words, ranks, strict=True)]  # fmt: skip


def _rank(child: Words, parent: Words) -> float:
    """The group of a part among those that another one hangs on by its name; infinite if it is in none, or on another
    side, farther or nearer, or at another end of the body."""
    pairs = zip(child.labels[:HEIGHT], parent.labels[:HEIGHT], strict=True)
    if any(own and its and not own & its for own, its in pairs):
        return inf
    return next((k for k, group in enumerate(PARENTS.get(child.noun, ())) if parent.noun in group), inf)


def _follows(child: Words, parent: Words) -> bool:
    """Whether two names differ by their number alone, and the former's is the next one."""
    same = child.others == parent.others and child.labels[:NUMBER] == parent.labels[:NUMBER]
    own, its = (each.labels[NUMBER] for each in (child, parent))
    return same and len(own) == len(its) == 1 and int(*own) == int(*its) + 1


def _extends(child: Words, parent: Words) -> bool:
    """Whether the name of a part begins as that of another one does, and goes on."""
    return parent.others != () and parent.others == child.others[: len(parent.others)] != child.others
