"""Sets of cages as earlier versions stored them, in custom properties, as views of records."""

from __future__ import annotations

import json
from types import SimpleNamespace

import bpy

from .. import keys

FINE, CAGE = "FINE", "CAGE"
HOLDS, FAULT = "HOLDS", "FAULT"
# Codes of notes that are sentences already, of those on a distance or an excess, and the beginning of findings' codes.
TEXT, TOLERANCE, CHECK = "note.text", "note.tolerance", "check."


def view(collection: bpy.types.Collection) -> SimpleNamespace:
    """What an earlier version stored of a set. It had no clearance, grid and symmetry that were asked for."""
    others = collection.get(keys.OTHERS)
    stored = [collection.get(keys.SOURCE), *(others.values() if hasattr(others, "values") else ())]
    hides = collection.get(keys.HIDES)
    hidden = list(hides) if hasattr(hides, "__len__") and not isinstance(hides, str) else []
    sources = [obj if isinstance(obj, bpy.types.Object) else None for obj in stored]
    found: dict[int, bpy.types.Object] = {}
    for obj in collection.objects:
        level = keys.value(obj, keys.LEVEL, int)
        if obj.type == "MESH" and level is not None and level >= 0:
            found.setdefault(level, obj)
    frames = keys.numbers(collection, keys.FRAMES, 3)
    colours = keys.value(collection, keys.COLOURS, int)
    return SimpleNamespace(
        version=0,
        sources=[
            SimpleNamespace(object=obj, hidden=number < len(hidden) and bool(hidden[number]))
            for number, obj in enumerate(sources)
        ],
        title=keys.value(collection, keys.NAME, str, ""),
        levels=[SimpleNamespace(object=found[level], hidden=False) for level in sorted(found)],
        inside=keys.value(collection, keys.INSIDE, bool, False),
        moving=keys.value(collection, keys.MOVING, bool, False),
        known=False,
        kinds=keys.value(collection, keys.KINDS, str, ""),
        colours=colours if colours is not None and colours >= 0 else -1,
        bound=keys.value(collection, keys.BOUND, str, ""),
        playing=keys.has(collection, keys.HIDES),
        frames=tuple(map(int, frames or (0, 0, 0))),
        animated=frames is not None,
        markers=[SimpleNamespace(name=name, frame=frame) for name, frame in _markers(collection)],
    )


def _markers(collection: bpy.types.Collection) -> list[tuple[str, int]]:
    """Names and frames of the markers that an earlier version stored; invalid entries are skipped."""
    try:
        found = json.loads(keys.value(collection, keys.MARKERS, str, ""))
    except (ValueError, RecursionError):
        return []
    pairs = [pair for pair in found if isinstance(pair, list) and len(pair) == 2] if isinstance(found, list) else []
    return [(name, frame) for name, frame in pairs if isinstance(name, str) and isinstance(frame, int)]


def member_view(obj: bpy.types.Object) -> SimpleNamespace:
    """What an earlier version stored of an object."""
    level = keys.value(obj, keys.LEVEL, int) or 0
    home = next((found for found in obj.users_collection if keys.has(found, keys.SOURCE)), None)
    check = keys.value(obj, keys.CHECK, str, "")
    frames = [int(part) for part in check.split() if part.isdecimal()]
    phases = keys.numbers(obj, keys.PHASES, 3)
    names = (keys.FLOW_START, keys.REINFLATION_START, keys.TIGHTENING_START, keys.END)
    said = {TEXT: keys.value(obj, keys.NOTES, str, ""), TOLERANCE: keys.value(obj, keys.NEED, str, "")}
    said[f"{CHECK}text"] = keys.value(obj, keys.FINDING, str, "")
    return SimpleNamespace(
        role="NONE" if level < 0 or obj.type != "MESH" else CAGE if level else FINE,
        level=level,
        of=keys.value(home, keys.SOURCE, bpy.types.Object) if home is not None else None,
        home=home,
        inside=keys.value(obj, keys.INSIDE, bool, False),
        vertices=keys.value(obj, keys.VERTICES, int) or -1,
        certified=set(),
        stamp="",
        clearance=keys.value(obj, keys.CLEARANCE, float, 0.0),
        asked=0.0,
        excess=keys.value(obj, keys.EXCESS, float, 0.0),
        most=keys.value(obj, keys.EXCESS, float, 0.0),
        start=keys.value(obj, keys.BEGINS_FROM, str, ""),
        seconds=keys.value(obj, keys.SECONDS, float, 0.0),
        phases=tuple(map(int, phases or (-1, -1, -1))),
        frames=tuple(found if (found := keys.value(obj, name, int)) is not None else -1 for name in names),
        check=FAULT if check.startswith("Broken") else HOLDS if check else "NONE",
        checked=(frames[0], frames[-1]) if frames else (0, 0),
        notes=[SimpleNamespace(code=code, data=json.dumps({"text": text})) for code, text in said.items() if text],
        sentence=keys.value(obj, keys.CERTIFICATE, str, ""),
    )
