"""What names say: which part of a body hangs on which, and that left does not hang on right. English words only."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf

SIDES = {"l": "L", "left": "L", "r": "R", "right": "R"}
"""Words for sides."""

DEPTHS = {"near": "near", "far": "far", "behind": "far"}
"""Words for what lies nearer to who looks at it."""

ENDS = {"front": "fore", "fore": "fore", "back": "hind", "rear": "hind", "hind": "hind"}
"""Words for the ends of an animal."""

HEIGHTS = {"up": "up", "top": "up", "low": "low", "bottom": "low"}
"""Words for what is above and below, such as jaws."""

PLACES = {word for word in (*SIDES, *DEPTHS, *ENDS, *HEIGHTS, "upper", "lower") if len(word) > 2}
"""Words that names have before a part of a body, at times as one word: hindleg."""

IRREGULAR = {"feet": "foot", "teeth": "tooth", "hooves": "hoof", "calves": "calf"}
"""Plurals without an s alone."""

_TORSO = "torso body chest thorax coat dress robe shirt jacket spine sweater hoodie blouse tunic ribcage"
_HIPS = "hips pelvis waist abdomen skirt trousers pants shorts jeans kilt"
_ARM, _FOREARM = "upper_arm arm sleeve humerus", "forearm lower_arm ulna"
_THIGH, _SHIN = "thigh upper_leg leg haunch femur", "shin calf lower_leg shank hock tibia"
_FACE = "cheek ear hair fringe beard moustache hat helmet horn antler antenna feeler jaw snout muzzle "
_FACE += "beak bill trunk tusk visor face mask glasses plume crest crown tiara wattle blush freckle "
_FACE += "headband bandana bang ponytail pigtail braid bun eyepatch veil wig hood beanie goatee chin forehead"
_HANDS = "hand paw claw glove fist pincer gauntlet"
_TOOLS = "sword hilt handle shield staff stick spear bow axe wand gun rifle pistol hammer mace dagger knife torch "
_TOOLS += "lantern umbrella cane flag"
_FEET = "foot hoof shoe boot ankle sandal sneaker slipper talon sock"

_HANGS_ON = (
    ("pupil iris glint lash lid eyelash eyelid", "eye"),
    ("earring", "ear, head"),
    ("eye brow eyebrow", "face mask visor, head skull helmet"),
    ("lens", "glasses"),
    ("brim", "hat"),
    ("mane", f"neck head {_TORSO}"),
    ("knee", f"{_SHIN} {_THIGH}"),
    ("elbow cuff", f"{_FOREARM} {_ARM}"),
    ("kneepad", f"{_SHIN} {_THIGH}"),
    ("shoulder pauldron", f"{_ARM} {_TORSO}"),
    ("button pocket zip zipper tie necktie badge lapel", _TORSO),
    ("buckle", "belt"),
    ("blade guard", _TOOLS),
    ("nail", "finger thumb toe"),
    ("sole lace", "foot shoe boot"),
    ("nostril", "nose snout muzzle beak bill, face, head skull"),
    ("nose mouth whisker", "snout muzzle, face, head skull"),
    ("tooth tongue lip", "mouth head skull jaw"),
    (_FACE, "head skull helmet"),
    ("head skull", f"neck, {_TORSO}"),
    ("neck", f"{_TORSO}"),
    (_HIPS, _TORSO),
    ("tail", f"{_HIPS} {_TORSO}"),
    ("scarf collar ruff necklace bowtie", f"neck, {_TORSO}"),
    ("bell tag pendant", f"collar necklace, neck, {_TORSO}"),
    ("scabbard sheath holster", f"belt, {_HIPS} {_TORSO}"),
    ("apron pouch vest backpack bag satchel quiver", f"{_TORSO} {_HIPS}"),
    ("hem", "skirt dress robe coat"),
    ("heel", "foot shoe boot"),
    ("pad", "paw"),
    ("greave", _SHIN),
    ("wrist bracelet watch bracer", f"{_FOREARM}, {_ARM}"),
    ("wing fin cape cloak belly breast belt saddle shell hump udder", f"{_TORSO} {_HIPS}"),
    (_ARM, _TORSO),
    (_FOREARM, _ARM),
    ("hand claw glove fist pincer gauntlet", f"{_FOREARM}, {_ARM}"),
    ("paw", f"{_FOREARM} {_SHIN}, {_ARM} {_THIGH}"),
    ("finger thumb", f"{_HANDS} wing"),
    (_TOOLS, f"{_HANDS} {_FOREARM}"),
    (_THIGH, f"{_HIPS} {_TORSO}"),
    (_SHIN, _THIGH),
    (_FEET, f"{_SHIN}, {_THIGH}"),
    ("toe", f"paw {_FEET}"),
)
PARENTS = {
    word: tuple(frozenset(group.split()) for group in parents.split(","))
    for words, parents in _HANGS_ON
    for word in words.split()
}
"""What each part of a body hangs on; where there are several groups, on a part of the first one that is there."""

TRUNKS = frozenset(f"{_TORSO} {_HIPS}".split())
"""Parts of a body that are its root."""

TURNING = frozenset(f"{_ARM} {_FOREARM} {_THIGH} {_SHIN} hand paw claw foot hoof wing fin tail jaw head neck".split())
"""Parts of a body that turn, wherever they lie."""

HOLDING = frozenset(f"{_HANDS} beak mouth".split())
"""Parts of a body that hold things."""

NAMES = "names", "names_of_others", "names_reversed", "held", "name_extends", "labels", "labels_of_others"
"""What names say of a pair: of parts of a body that hang together, that do not, or the other way around; that a hand
may hold a thing; that one is a part of the other, as a tip of a tail; sides, depths, ends, heights and numbers that are
the same, and that are not."""


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
    words = re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+", name)
    return [half for word in words for half in _halves(word)]


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
    has_more = any(word.isalpha() and len(word) > 1 and word not in SIDES for word in words)
    return sides[-1] if sides and has_more else ""


def words_of(name: str) -> Words:
    """What a name says about its part."""
    words = [word.lower() for word in name_words(name)]
    side = side_of(name)
    labels = [frozenset(table[word] for word in words if word in table) for table in (DEPTHS, ENDS, HEIGHTS)]
    numbers = frozenset(word for word in words if word.isdigit())
    nouns = [word for word in words if word not in {**DEPTHS, **ENDS, **HEIGHTS, **SIDES} and not word.isdigit()]
    noun = nouns[-1] if nouns else ""
    for half in {"upper", "lower"} & set(nouns):
        other = next((word for word in nouns if word in PARENTS), "leg")
        noun = f"{half}_{other}" if other in ("arm", "leg") else other
    known = next((each for each in (noun, IRREGULAR.get(noun, noun.removesuffix("s"))) if _is_known(each)), "")
    return Words(known, (frozenset(side), *labels, numbers), tuple(nouns))


def _is_known(noun: str) -> bool:
    return noun in PARENTS or noun in TRUNKS


def _halves(word: str) -> tuple[str, ...]:
    """A word that says where and what, such as hindleg, as two; other words as they are."""
    low = word.lower()
    cuts = [at for at in range(3, len(word) - 2) if low[:at] in PLACES and _is_known(low[at:])]
    return (word[: cuts[0]], word[cuts[0] :]) if cuts and not _is_known(low) else (word,)


def agreements(words: Sequence[Words], pairs: Sequence[tuple[int, int]]) -> dict[str, list[float]]:
    """What names say, as the columns `NAMES` of the evidence that the first of each pair hangs on the second.

    Of several parts that one may hang on by its name, the closest ones count: a head hangs on a neck, else on a body.
    """
    ranks = [_rank(words[child], words[parent]) for child, parent in pairs]
    least = dict[int, float]()
    for (child, _), rank in zip(pairs, ranks, strict=True):
        least[child] = min(rank, least.get(child, inf))
    rows = []
    for (child, parent), rank in zip(pairs, ranks, strict=True):
        one, other = words[child], words[parent]
        is_known = bool(one.noun in PARENTS and other.noun)
        is_named = rank < inf and rank == least[child]
        both = [(own, its) for own, its in zip(one.labels, other.labels, strict=True) if own and its]
        rows.append((
            is_named,
            is_known and not is_named,
            _rank(other, one) < inf,
            not one.noun and other.noun in HOLDING,
            other.others != () and other.others == one.others[: len(other.others)] != one.others,
            sum(bool(own & its) for own, its in both),
            sum(not own & its for own, its in both),
        ))  # fmt: skip
    return {name: [float(row[k]) for row in rows] for k, name in enumerate(NAMES)}


def _rank(child: Words, parent: Words) -> float:
    """The group of a part among those that another one hangs on by its name; infinite if it is in none."""
    return next((k for k, group in enumerate(PARENTS.get(child.noun, ())) if parent.noun in group), inf)
