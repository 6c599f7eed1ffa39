"""What the panels show of the active object: computed once after an update, only read when they are drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from bpy.types import Context, Object

from .. import cage_sets, messages, watch
from ..cage_sets import CageSet, changes
from ..cage_sets.selection import scene_of
from ..drawing import planar
from ..errors import UserError, counted
from ..files.pictures import image_on
from ..generate.levels import lengths, loop_sizes, meanings, parse_levels
from ..generate.options import KEEP
from ..generate.settings import settings_of
from ..motion import live
from ..operators.generate import why_nothing
from ..puppets.armatures import is_puppet, puppet_of
from ..puppets.controls import reach_of
from ..verify import claims

# Icons for how a cage is.
HOLDS, BROKEN, EDITED, ADVICE, MADE = "CHECKMARK", "ERROR", "QUESTION", "INFO", "MOD_MESHDEFORM"
# Modes in which the panels can be used; in the others, and while drawing, they say what to do.
USABLE = ("OBJECT", "EDIT_MESH", "POSE")


@dataclass(frozen=True)
class CageLine:
    """A cage by name: its size, an icon and a sentence on how it is."""

    name: str
    text: str
    icon: str
    sentence: str


@dataclass(frozen=True)
class SetLines:
    """A set: what it is called, whether a drawing has another shape than its cages are for, and the cages."""

    name: str
    changed: bool
    cages: tuple[CageLine, ...]


@dataclass(frozen=True)
class Shown:
    """Of the active object: what is selected, what to do if it has no outline, what the levels come to, and its sets;
    whether these are bound, or play; whether it is an armature; its puppet by name, and bones with an IK constraint.
    """

    title: str = ""
    hint: str = ""
    counts: str = ""
    sets: tuple[SetLines, ...] = ()
    bound: bool = False
    plays: bool = False
    armature: bool = False
    puppet: str = ""
    reaching: tuple[str, ...] = ()


# The last one, and what it depended on.
_known: dict[str, Any] = {}


def shown(context: Context) -> Shown:
    """What to draw now: the same as last time unless something was updated."""
    active, settings = context.view_layer.objects.active, settings_of(context)
    key = (
        watch.moment(context), context.mode, active.session_uid if active is not None else 0,
        settings.levels, settings.inside, settings.loops, settings.use_selected_as_levels,
    )  # fmt: skip
    if _known.get("key") != key:
        _known.update(key=key, shown=_computed(context, active))
    found: Shown = _known["shown"]
    return found


def _computed(context: Context, active: Object | None) -> Shown:
    selected = context.selected_objects
    sets = CageSet.all_of(active) if active is not None else []
    if active is None or not (sets or active in selected or context.mode != "OBJECT"):
        return Shown(hint=_hint(context, selected[0] if selected else None))
    others = len(set(selected) - {active})
    puppet = puppet_of([active])
    return Shown(
        title=f"{active.name} and {counted(others, 'other')}" if others else active.name,
        hint="" if sets and context.mode in USABLE else _hint(context, active),
        counts=_counts(context, active) if cage_sets.level_of(active) is None else "",
        sets=tuple(_lines(context, each) for each in sets),
        bound=any(each.bound for each in sets),
        plays=any(each.bound or each.record.moving for each in sets),
        armature=active.type == "ARMATURE" and not is_puppet(active),
        puppet=puppet.name if puppet is not None else "",
        reaching=tuple(bone.name for bone in puppet.pose.bones if reach_of(bone) is not None) if puppet else (),
    )


def _hint(context: Context, obj: Object | None) -> str:
    """What to do before cages can be made; empty if they can be."""
    if context.mode.startswith("PAINT_G"):
        return "Draw closed shapes, then go to Object Mode and press Generate."
    if context.mode not in USABLE:
        return "Go to Object Mode to make cages."
    if obj is not None and planar.readable(obj):
        return ""
    if obj is not None and image_on(obj) is not None:
        return f"'{obj.name}' is a picture: see Cutout below."
    if obj is not None and obj.type == "ARMATURE":
        return f"'{obj.name}' is an armature: see Puppet below."
    return f"{why_nothing(context)}."


def _lines(context: Context, cage_set: CageSet) -> SetLines:
    """A line for each cage of a set, with its size against the drawing's."""
    lines, size, cages = [], 1.0, cage_set.cages
    following = live.current()
    followed = following is not None and following.identity in {obj.session_uid for obj in cage_set.originals}
    changed = not followed and changes.is_changed(cage_set)
    for cage in cages:
        node = cage_sets.node_of(cage)
        size *= 1.0 + node.excess
        name = cage.name.removeprefix(f"{cage_set.record.title} ").removeprefix("Inner ")
        text = f"{name}: {len(cage.data.vertices)} vertices, {messages.larger(size)}"
        icon, sentence = (EDITED, "") if changed else _health(context, cage, bound=bool(cage_set.bound))
        lines.append(CageLine(cage.name, text, icon, sentence))
    return SetLines(cage_set.name, changed, tuple(lines))


def _health(context: Context, cage: Object, *, bound: bool) -> tuple[str, str]:
    """An icon for how a cage is, and one sentence on what is wrong with it, if anything is."""
    node, stands = cage_sets.node_of(cage), claims.stands(context, cage)
    if node.check in (cage_sets.FAULT, cage_sets.UNJUDGED) and stands:
        icon = BROKEN if node.check == cage_sets.FAULT else EDITED
        return icon, " ".join(cage_sets.sentences(node, checks=True, others=False))
    if not bound and cage_sets.is_edited(cage):
        return (HOLDS, "") if stands and cage_sets.is_judged(cage) else (EDITED, cage_sets.EDITED)
    told = [each for each in cage_sets.notes(node) if messages.is_told(*each)]
    advice = [messages.sentence(*each) for each in told if not each[0].startswith(cage_sets.CHECK)]
    if advice:
        return ADVICE, advice[0]
    return (HOLDS if stands or not bound else MADE), ""


def _counts(context: Context, drawing: Object) -> str:
    """The vertices of the cages of a drawing: "20 % = 10, 8 % = 4 vertices"; empty if they are not known."""
    settings = settings_of(context)
    if settings.use_selected_as_levels or drawing.mode != "OBJECT":
        return ""
    sizes = loop_sizes(drawing)
    try:
        levels = parse_levels(settings.levels, lengths(scene_of(context))) if sum(sizes) else ()
    except UserError:
        return ""
    keeps = settings.inside or settings.loops == KEEP
    return meanings(levels, sizes, drawing.dimensions.length, keeps=keeps) if levels else ""
