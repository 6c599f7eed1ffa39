"""What is said of a cage: its certificate, what Verify Cages found, and notes on the run."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from bpy.types import Object

from ..core import core
from ..messages import in_scene, sentence

CAGE = "CAGE"
HOLDS, FAULT, UNJUDGED = "HOLDS", "FAULT", "UNJUDGED"
# Code of notes on a distance or an excess, and the beginning of findings' codes.
TOLERANCE, CHECK = "note.tolerance", "check."
# What is said of a cage that is not the certified one any more.
EDITED = "Edited since it was certified: verify it, or generate it again"


@dataclass(frozen=True)
class Certificate:
    """What is certified of a cage, and what Verify Cages found of it since; lengths in units of the scene.

    excess, most: of a motion, the median and the largest. frames: the first ones of its phases, and of the result; -1
    for none. sentence, verdict, finding: for users. need: how it meets a distance or an excess. edited: not any more.
    """

    clearance: float
    excess: float
    most: float
    keeps_loops: bool
    moving: bool
    start: str
    seconds: float
    frames: tuple[int, int, int, int]
    sentence: str
    verdict: str
    finding: str
    need: str
    notes: tuple[str, ...]
    edited: bool

    @classmethod
    def of(cls, cage: Object, level: int, *, inside: bool) -> Certificate:
        """Of a cage and its level in its set."""
        node: Any = cage.nested_cages_member  # type: ignore[attr-defined]
        said: dict[str, list[str]] = {"need": [], "finding": [], "other": []}
        for code, data in notes(node):
            kind = "need" if code == TOLERANCE else "finding" if code.startswith(CHECK) else "other"
            said[kind].append(sentence(code, data))
        first, reinflation, tightening, last = node.frames
        return cls(
            node.clearance, node.excess, node.most, "LOOPS" in node.certified, "MOTION" in node.certified, node.start,
            node.seconds, (first, reinflation, tightening, last), _certified(node, level, inside=inside), verdict(node),
            " ".join(said["finding"]), " ".join(said["need"]), tuple(said["other"]), is_edited(cage),
        )  # fmt: skip


def _certified(node: Any, level: int, *, inside: bool) -> str:
    """What is certified of a cage, as a sentence."""
    loops = "all loops kept" if "LOOPS" in node.certified else "with loops of its own"
    nested = f"strictly {'inside' if inside else 'encloses'} level {level - 1}"
    if "MOTION" in node.certified:
        first, last = node.frames[0], node.frames[3]
        return (
            f"Certified as stored from frame {first} to {last} and at all instants between: simple, {nested}; "
            f"clearance {node.clearance:.3g} at least, excess {100.0 * node.excess:.2f} % in the median, "
            f"{100.0 * node.most:.2f} % at most"
        )
    area = f"{-100.0 * node.excess:.2f} % less area" if inside else f"excess {100.0 * node.excess:.2f} %"
    return f"Certified as stored: simple, {loops}, {nested}; clearance {node.clearance:.3g}, {area}"


def set_notes(node: Any, given: Iterable[core.Fault], scale: float = 1.0) -> None:
    """Replaces the notes on a member; scale: the scene's length of their unit."""
    node.notes.clear()
    for each in given:
        said, item = in_scene(each, scale), node.notes.add()
        item.code, item.data = said.code, json.dumps(dict(said.data))


def set_check(node: Any, finding: core.Fault) -> None:
    """Replaces what Verify Cages found by another finding."""
    for number in reversed([k for k, item in enumerate(node.notes) if item.code.startswith(CHECK)]):
        node.notes.remove(number)
    item = node.notes.add()
    item.code, item.data = finding.code, json.dumps(dict(finding.data))


def notes(node: Any) -> list[tuple[str, dict[str, Any]]]:
    """Codes and data of the notes on a member."""
    return [(item.code, _data(item.data)) for item in node.notes]


def sentences(node: Any, *, checks: bool = False, others: bool = True) -> list[str]:
    """The notes on a member, as sentences: those of Verify Cages only if ``checks``, and all ``others``."""
    return [sentence(*each) for each in notes(node) if (checks if each[0].startswith(CHECK) else others)]


def verdict(node: Any) -> str:
    """The result of Verify Cages in a few words; empty if it was not checked."""
    first, last = node.checked
    if node.check == FAULT:
        return f"Broken on frame {last}"
    if node.check == UNJUDGED:
        return "Not judged"
    if node.check != HOLDS:
        return ""
    return f"Holds on frame {last}" if first == last else f"Holds on {first} – {last}"


def restate(obj: Object, clearance: float, excess: float, given: Iterable[core.Fault] = (), scale: float = 1.0) -> None:
    """What is certified of a cage that was moved or edited, and noted on it, instead of what was; clearance: in scene
    units. scale: the scene's length of the notes' unit.
    """
    node: Any = obj.nested_cages_member  # type: ignore[attr-defined]
    node.clearance, node.excess, node.most = clearance, excess, excess
    node.check, node.stamp = "NONE", stamp(obj)
    set_notes(node, given, scale)


def is_edited(obj: Object) -> bool:
    """Whether a cage is not the one that was certified any more."""
    node: Any = obj.nested_cages_member  # type: ignore[attr-defined]
    return node.role == CAGE and bool(node.stamp) and node.stamp != stamp(obj)


def is_judged(obj: Object) -> bool:
    """Whether the last check was of a cage as it is now."""
    node: Any = obj.nested_cages_member  # type: ignore[attr-defined]
    return node.check in (HOLDS, FAULT) and node.judged == stamp(obj)


def stamp(obj: Object) -> str:
    """A digest of the coordinates of an object's mesh."""
    points = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", points)
    return hashlib.blake2b(points.tobytes(), digest_size=8).hexdigest()


def remove(obj: Object) -> None:
    """Makes an object a plain one."""
    if "nested_cages_member" in obj.bl_rna.properties:
        obj.nested_cages_member.before.mesh = None  # type: ignore[attr-defined]
        obj.property_unset("nested_cages_member")


def _data(text: str) -> dict[str, Any]:
    """The data of a note; empty if a stranger's file has something else there."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return data if isinstance(data, dict) else {}
