"""What is said of cages: codes with data, stored with them, and the sentences made of these when they are shown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .core import core, errors

SENTENCES: Mapping[str, str] = {
    "places.empty": "'{name}' has nothing in a vertex group '{group}', so that was left out.",
    "drawing.hidden": "Left out of '{name}', since not shown: {hidden}.",
    "note.start rest": "The cage does not grow: growing to points of 'Grid', it would meet the drawing.",
    "note.start fallback": (
        "Your outline could not be used, and another one took its place: draw it around the drawing and all its parts, "
        "with no holes that the drawing has not."
    ),
    "check.holds": "{when}'{outer}' encloses '{inner}': clearance {clearance:.3g}, {excess_percent:.2f} % larger",
    "check.unjudged": "{when}'{outer}' passes over itself, so whether it encloses '{inner}' is not judged",
    "check.frames": "'{outer}' encloses '{inner}' on all frames from {first} to {last}: clearance {clearance:.3g}",
    "check.broken": "{when}'{outer}' does not enclose '{inner}': {text}",
    "check.invalid": "{when}{text}",
    "check.folded": "{when}'{inner}' {how}: {share_percent:.2g} % of its area{more}",
}
"""Of the add-on's own codes: a format for their data; those of the core are in its `notes`."""

LENGTHS: Mapping[str, tuple[str, ...]] = {
    "note.clearance": ("wanted", "given"),
    "note.symmetry": ("difference",),
    "note.pin": ("distance",),
    "note.edge": ("wanted", "given"),
    "note.tolerance": ("limit", "taken"),
}
"""Data of the core's notes that are lengths in the drawing's unit; the limit of an excess is none."""


# Codes of notes on loops that a cage lacks, and on how a cage was made, which are in the report alone.
LOOPS = "note.loops"
ON_METHODS = ("note.start", "note.energy", "note.text")
# A size from which on it is told in times.
MANY_TIMES = 10.0

# Problems of certificates, and why a cage cannot be made, as an artist says them.
BROKEN: Mapping[str, str] = {
    "cage.invalid": "the cage crosses or touches itself",
    "fine.invalid": "what is in it crosses or touches itself",
    "cage.turned": "the cage is turned inside out",
    "cage.meets": "they cross",
    "cage.leaves_out": "a part is outside",
    "cage.loops_differ": "one has holes or parts that the other has not",
    "cage.too_close": "they are too close",
    "flow.loops_differ": ("your outline has not the parts and holes of the drawing: draw it around all of it"),
    "flow.stuck": ("the drawing cannot shrink into your outline: draw it closer there"),
    "reinflation.blocked": ("the drawing cannot grow back in your outline: give it more vertices"),
    "edges.not_aligned": (
        "its edges cannot be along the axes with all else that is asked: use more vertices, or choose other 'Edges'"
    ),
    "coarse.not_nested": "your outline does not lie inside the drawing: move it inside, or enter numbers",
}


def note(code: str, **data: Any) -> core.Fault:
    """A note with a code of the add-on."""
    return core.Fault(sentence(code, data), code, **data)


def is_told(code: str, data: Mapping[str, Any]) -> bool:
    """Whether a note is for the panel: it says what the size of a cage does not, and not only how it was made."""
    on = data.get("on")
    return on in ("fallback", "rest") or not (
        code.startswith(ON_METHODS) or (code == "note.tolerance" and on == "excess")
    )


def in_scene(given: core.Fault, scale: float) -> core.Fault:
    """A note of the core in units of the scene; scale: the scene's length of the drawing's unit."""
    names = () if given.data.get("on") == "excess" else LENGTHS.get(given.code, ())
    return note(given.code, **{name: scale * value if name in names else value for name, value in given.data.items()})


def sentence(code: str, data: Mapping[str, Any]) -> str:
    """What a note says: of loops, which holes are filled, not how many there are; the plain text, if there is any, for
    what this version does not know.
    """
    lost = str(data.get("lost", "")).strip(": ")
    if code == LOOPS and lost:
        return f"{lost[:1].upper()}{lost[1:]}"
    return str(errors.sentence(code, data, SENTENCES))


def larger(size: float) -> str:
    """How much larger than the drawing something is, given its area by that of the drawing."""
    if size >= MANY_TIMES:
        return f"{size:,.0f} times as large"
    percent = 100.0 * abs(size - 1.0)
    shown = f"{percent:.0f}" if percent >= MANY_TIMES else f"{percent:.2g}"
    return f"{shown} % {'smaller' if size < 1.0 else 'larger'}"
