"""The records of sets of cages: read, written, and published as custom properties for other programs."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from typing import Any

import bpy
import numpy as np
from bpy.types import Collection, Object

from .. import keys
from ..core import core
from ..notes import in_scene, sentence
from .helpers import *  # noqa: F403 - all of these are the room's face
from .helpers import CAGE, CHECK, FAULT, HOLDS, NO_RECORD, TOLERANCE, new_node, node_of

# What is said of a cage that is not the certified one any more.
EDITED = "Edited since it was certified: verify it, or generate it again"


def of(collection: Collection) -> Any:
    """The record of a set; collections that are none get no own, see `node_of`."""
    return new(collection) if collection.is_property_set("nested_cages") else NO_RECORD


def new(collection: Collection) -> Any:
    """The same, to make a collection that of a set."""
    return collection.nested_cages  # type: ignore[attr-defined]


def keep(collection: Collection) -> None:
    """Keeps the record on each object too: it goes with copies, and is there if the collection is removed."""
    cage_set = of(collection)
    if not len(cage_set.levels):
        return
    objects = [part.object for part in cage_set.levels if part.object is not None and part.object.is_editable]
    given = values(cage_set)
    for obj in objects:
        assign(node_of(obj).kept, given)
        publish(obj)
    facts = {
        keys.SOURCE: cage_set.sources[0].object if len(cage_set.sources) else None,
        keys.INSIDE: cage_set.inside,
        keys.END: cage_set.frames[1],
        keys.BOUND: cage_set.bound or None,
    }
    keys.remove(collection, facts)
    keys.store(collection, {name: value for name, value in facts.items() if value is not None})


def bind(collection: Collection, method: str) -> None:
    """Notes by what method a drawing is bound; empty: not at all."""
    of(collection).bound = method
    keep(collection)


def values(group: Any) -> dict[str, Any]:
    """The properties of a group as plain values; those of an unset pointer to a group are there too."""
    plain: dict[str, Any] = {}
    for prop in group.bl_rna.properties:
        name, value = prop.identifier, getattr(group, prop.identifier)
        if name == "rna_type":
            continue
        if prop.type == "COLLECTION":
            plain[name] = [values(item) for item in value]
        elif prop.type == "POINTER" and isinstance(value, bpy.types.PropertyGroup):
            plain[name] = values(value)
        elif getattr(prop, "is_array", False):
            plain[name] = tuple(value)
        else:
            plain[name] = set(value) if isinstance(value, set) else value
    return plain


def assign(group: Any, given: dict[str, Any]) -> None:
    """Sets the properties of a group to `values` of one."""
    for name, value in given.items():
        if isinstance(value, list):
            items = getattr(group, name)
            items.clear()
            for item in value:
                assign(items.add(), item)
        elif isinstance(value, dict):
            assign(getattr(group, name), value)
        else:
            setattr(group, name, value)


def refer(items: Any, objects: Any) -> None:
    """Makes a list of parts refer to objects, which know of it."""
    items.clear()
    for obj in objects:
        items.add().object = obj
        if obj.library is None:
            new_node(obj)


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
    if node.check != HOLDS:
        return ""
    return f"Holds on frame {last}" if first == last else f"Holds on {first} – {last}"


def certificate(node: Any) -> str:
    """What is certified of a cage, as a sentence; empty for the fine mesh."""
    if node.role != CAGE:
        return ""
    loops = "all loops kept" if "LOOPS" in node.certified else "with loops of its own"
    nested = f"strictly {'inside' if node.inside else 'encloses'} level {node.level - 1}"
    if "MOTION" in node.certified:
        first, last = node.frames[0], node.frames[3]
        return (
            f"Certified as stored from frame {first} to {last} and at all instants between: simple, {nested}; "
            f"clearance {node.clearance:.3g} at least, excess {100.0 * node.excess:.2f} % in the median, "
            f"{100.0 * node.most:.2f} % at most"
        )
    area = f"{-100.0 * node.excess:.2f} % less area" if node.inside else f"excess {100.0 * node.excess:.2f} %"
    return f"Certified as stored: simple, {loops}, {nested}; clearance {node.clearance:.3g}, {area}"


def restate(obj: Object, clearance: float, excess: float, given: Iterable[core.Fault] = (), scale: float = 1.0) -> None:
    """What is certified of a cage that was moved or edited, and noted on it, instead of what was; clearance: in scene
    units. scale: the scene's length of the notes' unit.
    """
    node = node_of(obj)
    node.clearance, node.excess, node.most = clearance, excess, excess
    node.check, node.stamp = "NONE", stamp(obj)
    set_notes(node, given, scale)
    publish(obj)


def is_edited(obj: Object) -> bool:
    """Whether a cage is not the one that was certified any more."""
    node = node_of(obj)
    return node.role == CAGE and bool(node.stamp) and node.stamp != stamp(obj)


def is_judged(obj: Object) -> bool:
    """Whether the last check was of a cage as it is now."""
    node = node_of(obj)
    return node.check in (HOLDS, FAULT) and node.judged == stamp(obj)


def stamp(obj: Object) -> str:
    """A digest of the coordinates of an object's mesh."""
    points = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", points)
    return hashlib.blake2b(points.tobytes(), digest_size=8).hexdigest()


def publish(obj: Object) -> None:
    """Writes what other programs may want to know of an object as custom properties, which the add-on never reads."""
    node = node_of(obj)
    facts: dict[str, Any] = {keys.LEVEL: node.level, keys.VERTICES: len(obj.data.vertices)}
    if node.role == CAGE:
        said: dict[str, list[str]] = {"need": [], "finding": [], "other": []}
        for code, data in notes(node):
            kind = "need" if code == TOLERANCE else "finding" if code.startswith(CHECK) else "other"
            said[kind].append(sentence(code, data))
        facts |= {
            keys.CLEARANCE: node.clearance,
            keys.EXCESS: node.excess,
            keys.INSIDE: node.inside,
            keys.NEED: " ".join(said["need"]),
            keys.BEGINS_FROM: node.start,
            keys.SECONDS: node.seconds,
            keys.NOTES: "; ".join(said["other"]),
            keys.CERTIFICATE: certificate(node),
        }
        names = (keys.FLOW_START, keys.REINFLATION_START, keys.TIGHTENING_START, keys.END)
        facts |= {name: frame for name, frame in zip(names, node.frames, strict=True) if frame >= 0}
        facts |= {keys.CHECK: verdict(node), keys.FINDING: " ".join(said["finding"])} if node.check != "NONE" else {}
    keys.remove(obj, [name for name in PUBLISHED if name not in facts])
    keys.store(obj, facts)


# The names of what is published of objects.
PUBLISHED = (
    *(keys.LEVEL, keys.VERTICES, keys.CLEARANCE, keys.EXCESS, keys.INSIDE, keys.NEED, keys.BEGINS_FROM, keys.SECONDS),
    *(keys.NOTES, keys.CERTIFICATE, keys.FLOW_START, keys.REINFLATION_START, keys.TIGHTENING_START, keys.END),
    *(keys.CHECK, keys.FINDING),
)


def remove(obj: Object) -> None:
    """Makes an object a plain one."""
    node = node_of(obj)
    for prop in node.bl_rna.properties:
        if prop.identifier not in {"rna_type", "kept", "before"}:
            node.property_unset(prop.identifier)
    node.before.mesh = None
    assign(node.kept, {"sources": [], "levels": [], "markers": []})
    keys.remove(obj, keys.ours(obj))


def _data(text: str) -> dict[str, Any]:
    """The data of a note; empty if a stranger's file has something else there."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return data if isinstance(data, dict) else {}
