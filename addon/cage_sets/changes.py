"""Whether a drawing has another shape than the one its cages were certified for, by digests that the set stores."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from typing import Any

import bpy
from bpy.types import Object

from ..blender import display, mesh_data
from ..drawing.grease_pencil import KINDS
from ..keys import found_object
from . import CageSet

# Kinds of settings that a digest is about, and those that only concern the interface.
SIMPLE, INTERFACE = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}, {"is_active", "show_expanded", "use_pin_to_last"}

# In place of a digest that is not known, and a state that differs from all others.
UNKNOWN, EDITED = "-", "edited"

# By session ID of drawings, the digests of their own points, and of their settings, until they are updated.
_known: dict[int, tuple[str, str]] = {}


def states(drawings: Iterable[Object]) -> dict[int, str]:
    """The states of drawings, by session ID."""
    return {obj.session_uid: state_of([obj]) for obj in drawings}


def edited_since(before: Mapping[int, str]) -> set[int]:
    """Session IDs of the drawings that have other shapes than in these states."""
    drawings = filter(None, map(found_object, before))
    return {obj.session_uid for obj in drawings if differs(before[obj.session_uid], state_of([obj]))}


def settle(sets: Iterable[CageSet], edited: Set[int] = frozenset()) -> None:
    """Notes that cages are certified, or verified, for their drawings as they are now; edited: session IDs of drawings
    that have changed meanwhile.
    """
    for cage_set in sets:
        drawings = cage_set.originals
        state = EDITED if edited & {obj.session_uid for obj in drawings} else state_of(drawings)
        if cage_set.finest.is_editable and cage_set.record.drawn != state:
            cage_set.record.drawn = state


def is_changed(cage_set: CageSet) -> bool:
    """Whether a drawing has changed since then."""
    return differs(cage_set.record.drawn, state_of(cage_set.originals), moved=bool(cage_set.bound))


def differs(before: str, now: str, *, moved: bool = False) -> bool:
    """Whether states are of other shapes, as far as known. Settings and modifiers may be animated: what they come to is
    only compared on the same frame, and not where cages have moved the drawing.
    """
    pairs = zip(("points", "frame", "settings", "box"), before.split(), now.split(), strict=False)
    differing = {name for name, *both in pairs if both[0] != both[1] and UNKNOWN not in both}
    if moved:
        differing.discard("box")
    return "points" in differing or (bool(differing) and "frame" not in differing)


def state_of(drawings: Sequence[Object]) -> str:
    """Digests of points, the frame, and digests of settings and of bounding boxes with modifiers."""
    for obj in drawings:
        if obj.session_uid not in _known:
            _known[obj.session_uid] = _digest(_points(obj)), _digest(_settings(obj))
    points, settings = (_digest(_known[obj.session_uid][part].encode() for obj in drawings) for part in (0, 1))
    box = UNKNOWN
    if all(obj.visible_get() for obj in drawings):  # else modifiers are not evaluated
        box = _digest(repr([corner[:] for corner in obj.bound_box]).encode() for obj in drawings)
    return f"{points} {bpy.context.scene.frame_current} {settings} {box}"


def forget(*drawings: Object) -> None:
    """What was updated may have another shape; without drawings, all may."""
    for obj in drawings:
        _known.pop(obj.session_uid, None)
    if not drawings:
        _known.clear()


def _digest(parts: Iterable[bytes]) -> str:
    digest = hashlib.blake2b(digest_size=8)
    for part in parts:
        digest.update(part)
    return digest.hexdigest()


def _points(obj: Object) -> Iterator[bytes]:
    """The points of a drawing in its own space; of a text its letters."""
    data: Any = obj.data
    if obj.type == "MESH":
        yield mesh_data.stored(data.vertices, "co", 3).tobytes()
    elif obj.type == "CURVE":
        for spline in data.splines:
            for name in ("co", "handle_left", "handle_right") if spline.type == "BEZIER" else ():
                yield mesh_data.stored(spline.bezier_points, name, 3).tobytes()
            yield mesh_data.stored(spline.points, "co", 4).tobytes()
    elif obj.type == "FONT":
        yield data.body.encode()
    elif obj.type == "CURVES":
        yield mesh_data.stored(data.position_data, "vector", 3).tobytes()
    elif obj.type == KINDS[0]:
        for frame in (frame for layer in data.layers for frame in layer.frames):
            places = frame.drawing.attributes.get("position")
            yield b"" if places is None else mesh_data.stored(places.data, "vector", 3).tobytes()


def _settings(obj: Object) -> Iterator[bytes]:
    """The settings of curves and texts, and of modifiers that are not the add-on's."""
    blocks: list[Any] = [each for each in obj.modifiers if not display.is_ours(each)]
    for block in [*blocks, *([obj.data] if obj.type in {"CURVE", "FONT"} else [])]:
        for prop in block.bl_rna.properties:
            plain = prop.type in SIMPLE and not prop.is_readonly and not getattr(prop, "is_array", False)
            if plain and prop.identifier not in INTERFACE:
                yield f"{prop.identifier} {getattr(block, prop.identifier)}".encode()
