"""Puppets: layered drawings whose parts move by themselves, rigid ones with a bone, bending ones with a field.

The armature is the draft: its bones lie along the parts and hang on each other as the parts do. Pressed again, the
button keeps what was changed there: parents and joints.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from bpy.types import Collection, Context, Object

from .. import cage_sets, keys
from ..bind import field
from ..blender import mesh_data
from ..blender.jobs import Progress, Work
from ..cage_sets.selection import select
from ..core import blamed, core
from ..drawing.plane import Frame, middle_of_box, transform, turned_as_most, world_matrix
from ..errors import FloatArray, UserError
from ..files import silhouettes
from . import armatures, caps, controls, weights
from .one_cage import skin

# What the import adds to the name of a layer for a shape without a name.
NUMBERED = re.compile(r"[ .]\d+$")
# Directions along the plane's normal are compared as multiples of this fraction of the drawing's size.
SAME_DEPTH = 1e-6


@dataclass(frozen=True)
class Drawn:
    """Drawings in stacking order, the lowest first, as parts in a plane, and why some were left out."""

    frame: Frame
    objects: tuple[tuple[Object, ...], ...]
    """Those of each part: the shapes of a layer that have no names of their own are one."""
    parts: tuple[core.puppets.PuppetPart, ...]
    problems: tuple[UserError, ...]

    @property
    def lowest(self) -> dict[str, Object]:
        """The lowest object of each part, by its name."""
        return {part.name: own[0] for part, own in zip(self.parts, self.objects, strict=True)}

    def places_in(self, armature: Object) -> Callable[[FloatArray], FloatArray]:
        """What takes points (n, 3) of an armature to the parts' coordinates."""
        matrix = world_matrix(armature)
        return lambda points: self.frame.from_world(transform(matrix, points))[0]


def drawn(context: Context, objects: Sequence[Object], old: Object | None) -> Work[Drawn]:
    """What objects paint, each by itself, as parts of a puppet. Raises: UserError if nothing is painted.

    old: the armature that moves them already, in whose plane they are.
    """
    largest = max(sorted(objects, key=lambda obj: obj.name), key=lambda obj: float(obj.dimensions.length))
    if old is not None:
        frame = armatures.frame_of(old)
    else:
        frame = turned_as_most(silhouettes.plane_of(context, largest), objects)
    normal = np.array(frame.matrix)[:3, 2]
    grid = SAME_DEPTH * max(float(obj.dimensions.length) for obj in objects) or 1.0
    depth = {obj.name: round(float(normal @ middle_of_box(obj)) / grid) for obj in objects}
    shapes: dict[str, list[Object]] = {}
    names = _part_names(objects, old)
    for obj in sorted(objects, key=lambda obj: (depth[obj.name], obj.name)):
        shapes.setdefault(names[obj], []).append(obj)
    kept, parts, problems = [], [], []
    for number, (name, own) in enumerate(shapes.items()):
        yield Progress(0.3 * number / len(shapes), f"reading '{name}'")
        try:
            loops, left_out = yield from silhouettes.painted_loops(context, own, frame, closed=True)
        except UserError as error:
            problems.append(error)
            continue
        problems += left_out
        kept.append(tuple(own))
        groups = tuple(home.name for home in own[0].users_collection[:1])
        parts.append(core.puppets.PuppetPart(name, core.Mesh.from_loops(loops), groups))
    if not parts:
        raise problems[0]
    return Drawn(frame, tuple(kept), tuple(parts), tuple(problems))


def _part_names(objects: Sequence[Object], old: Object | None) -> dict[Object, str]:
    """The name of the part that each object belongs to: that of its layer, which numbers it, or its own; in a puppet,
    and in a copy of one, the name that it had when the puppet was made.
    """
    found: dict[Object, str] = {}
    for obj in objects:
        stem = NUMBERED.sub("", armatures.COUNTED.sub("", obj.name))
        layers = (layer.name for layer in obj.users_collection if armatures.COUNTED.sub("", layer.name) == stem)
        found[obj] = next(layers, obj.name)
    stems = Counter(armatures.COUNTED.sub("", name) for name in set(found.values()))
    found = {obj: stem if stems[stem := armatures.COUNTED.sub("", name)] == 1 else name for obj, name in found.items()}
    known = {obj: str(obj.get(keys.DRAWN, "")) for obj in objects if obj.parent == old is not None}
    for name in set(known.values()) - {""}:
        now = [found[obj] for obj in known if known[obj] == name]
        one = name if name in now else now[0]  # others are copies, which are parts of their own
        found.update({obj: name for obj in known if known[obj] == name and found[obj] == one})
    return found


@dataclass(frozen=True)
class Making:
    """How a puppet is made."""

    limits: bool = True
    """Whether bones are limited to their proved ranges."""
    linear: bool = False
    """Whether bones are blended as in game engines, instead of keeping volume."""
    reach: float = 0.0
    """How much legs and arms follow the controls at their ends, from 0 to 1."""
    caps: bool = True
    """Whether joints stay painted when parts turn."""
    title: str = ""
    """Name of a new one; empty for that of the collection of all drawings, or of the part that all hang on."""


def articulate(
    context: Context, given: Drawn, old: Object | None, options: Making
) -> Work[tuple[Object, core.puppets.Puppet]]:
    """An armature that moves the drawings part by part. Raises: UserError, which may leave new objects behind.

    old: that of an earlier puppet of theirs, which is drawn as it is changed now.
    """
    yield Progress(0.3, "finding joints")
    with blamed("The puppet"):
        if old is not None:
            armatures.mark_subdivided(old)
            choices = armatures.choices_in(old, given.parts, given.lowest, given.places_in(old))
        else:
            choices = armatures.parents_of(given.parts, given.objects)
        draft = core.puppets.draft_puppet(given.parts, choices)
        yield Progress(0.4, "cages and weights of parts that bend")
        blend = core.puppets.Linear() if options.linear else core.puppets.PreserveVolume()
        puppet = core.puppets.puppet_of(draft, blend)
    yield Progress(0.9, "making bones")
    _check_followers(given, puppet)
    everyone = [obj for own in given.objects for obj in own]
    solved, before = puppet, weights.carriers_of(old) if old is not None else weights.left_over(everyone)
    if old is None:
        home = _common_home(given)
        root = puppet.draft.parts[puppet.draft.part_of[0]].name
        title = options.title or (home.name if home else root)
        armature = armatures.add_armature(context, home, given.frame, title)
        armatures.hang_as(armature, everyone)
    else:
        armature, puppet = old, weights.by_hand(old, puppet, given.frame)
        caps.remove_caps(armature)
        for obj in armatures.drawings_of(armature):
            armatures.hang(obj, armature)  # bones may go
    limits = solved.ranges if options.limits else ()
    puppet = armatures.draw_bones(context, armature, given.frame, puppet, limits)
    controls.add_controls(context, armature, puppet.figure, options.reach)
    context.view_layer.update()
    carriers: dict[int, Object] = {}
    for number, objects in enumerate(given.objects):
        carrier = puppet.fields[number]
        if carrier is not None and id(carrier) not in carriers:
            carriers[id(carrier)] = made = _carrier(context, objects[0], armature, given.frame, puppet, number)
            weights.note_solved(made, solved.fields[number].weights)
        for obj in objects:
            field.release(obj)
            obj[keys.DRAWN] = puppet.draft.parts[number].name
            armatures.hang(obj, armature, "" if carrier else puppet.bones[puppet.draft.bone_of[number]].name)
            if carrier is not None:
                field.follow(obj, carriers[id(carrier)], carriers[id(carrier)])
    _replace(before, armature)
    caps.remove_left_over(everyone)
    context.view_layer.update()
    caps.draw_caps(context, armature, given.frame, given.objects, puppet, puppet.caps if options.caps else ())
    select(context, armature)
    return armature, puppet


def _check_followers(given: Drawn, puppet: core.puppets.Puppet) -> None:
    """Raises: UserError if an object cannot follow."""
    for carrier, objects in zip(puppet.fields, given.objects, strict=True):
        for obj in objects:
            problem = field.why_not(obj) if carrier is not None else ""
            if problem or not obj.is_editable:
                raise UserError(problem or f"'{obj.name}' is linked from another file: make it local first")


def _replace(carriers: Mapping[str, Object], armature: Object) -> None:
    """Removes hidden meshes of parts and their fields; those that the armature has now get their names."""
    gone = {part: _with_field(carrier) for part, carrier in carriers.items()}
    names = {part: [each.name for each in own] for part, own in gone.items()}
    bpy.data.batch_remove([block for own in gone.values() for each in own for block in (each, each.data)])
    for part, made in weights.carriers_of(armature).items():
        for each, name in zip(_with_field(made), names.get(part, ()), strict=False):
            each.name = each.data.name = name


def _with_field(carrier: Object) -> list[Object]:
    """A hidden mesh and its field."""
    return [carrier, *cage_sets.helpers_of(carrier, cage_sets.FIELD)]


def _common_home(given: Drawn) -> Collection | None:
    """The smallest collection that all drawings are in."""
    everyone = {obj for own in given.objects for obj in own}
    common = [home for home in bpy.data.collections if home.is_editable and everyone.issubset(home.all_objects)]
    return min(common, key=lambda home: (len(home.all_objects), len(home.children_recursive)), default=None)


@contextmanager
def at_rest(context: Context, objects: Sequence[Object], armature: Object | None) -> Iterator[None]:
    """Temporarily shows drawings, and the armature that moves them, as they were drawn.

    Disabled ones too, such as mouths that others are swapped for: else Blender has them where they were seen last.
    """
    empties = [obj for obj in objects if field.shown_by(obj) != obj]
    hidden = [obj for obj in objects if obj.hide_viewport]
    before = armature.data.pose_position if armature is not None else ""
    with field.unposed(obj for obj in objects if obj not in empties):
        try:
            for empty in empties:
                empty.instance_type = "COLLECTION"
            for obj in hidden:
                obj.hide_viewport = False
            if armature is not None:
                armature.data.pose_position = "REST"
                context.view_layer.update()
            yield
        finally:
            for obj in hidden:
                obj.hide_viewport = True
            for empty in empties:
                empty.instance_type = "COLLECTION" if field.shown_by(empty) == empty else "NONE"
            if armature is not None:
                armature.data.pose_position = before


def _carrier(
    context: Context, obj: Object, armature: Object, frame: Frame, puppet: core.puppets.Puppet, number: int
) -> Object:
    """A hidden mesh that bones bend, for a part and what rides on it, with its field."""
    bent = puppet.fields[number]
    assert bent is not None
    grid = bent.grid
    points = np.column_stack([grid.vertices, np.full(len(grid.vertices), frame.height)])
    name = puppet.draft.parts[number].name
    made, still = (
        bpy.data.objects.new(title, mesh_data.new_mesh(title, points, faces=grid.triangles))
        for title in (f"{name} Bend", f"{name} Bend Field")
    )
    for new in (made, still):
        obj.users_collection[0].objects.link(new)
        new.parent = armature  # where it stands: copies lose other transforms
        new.display_type = "WIRE"
        new.hide_viewport = new.hide_render = new.hide_select = True
        new[keys.PART] = name
    cage_sets.make_helper(still, cage_sets.FIELD, made)
    bones = puppet.bones[bent.first_bone : bent.first_bone + len(bent.bends) + 1]
    skin(made, armature, bones, bent.weights, keeps_volume=puppet.skin != core.puppets.Linear())
    context.view_layer.update()
    field.pose(made, made)
    return made
