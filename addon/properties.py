"""The record of a set of cages: what was asked for, what is certified, and how it plays and is bound.

A `NestedCagesMember` on each object has its place in a chain, and on the finest cage the `NestedCagesRecord` of the
set. Pointers of objects follow their copies. `record` reads and writes all this.
"""

from __future__ import annotations

import bpy
from bpy.props import BoolVectorProperty, FloatVectorProperty, IntVectorProperty
from bpy.types import Mesh, Object, Scene

from .blender.props import choice, flag, number, pointer, registration, row, several, text, whole
from .generate.settings import GenerationProperties, NestedCagesSettings

ROLES = [(name, name.title(), "") for name in ("NONE", "FINE", "CAGE", "FIELD", "LINES", "PROXY", "FILL", "HANDLES")]
CHECKS = [(name, name.title(), "") for name in ("NONE", "HOLDS", "FAULT", "UNJUDGED")]
PROMISES = [(name, name.title(), "") for name in ("LOOPS", "MOTION")]


class NestedCagesNote(bpy.types.PropertyGroup):
    """What is to be said: a code and its data as JSON; the sentence is made when it is drawn."""

    code: text("Code", "What kind of note it is")
    data: text("Data", "The values in it, as JSON")


class NestedCagesReference(bpy.types.PropertyGroup):
    """An object in a list: a drawing of a set, or of a drawing the finest cage of a set."""

    object: pointer("Object", "The object", Object)
    hidden: flag("Hidden", "Whether the animation hides this drawing meanwhile")


class NestedCagesRange(bpy.types.PropertyGroup):
    """Of a scene: its first and last frame before the animation, and as the animation set them."""

    known: flag("Known", "Whether the animation set the range")
    before: row(IntVectorProperty, "Before", "First and last frame before the animation", size=2)
    ours: row(IntVectorProperty, "Ours", "First and last frame as the animation set them", size=2)


class NestedCagesUsed(bpy.types.PropertyGroup, GenerationProperties):
    """The settings that the cages were made with."""


class NestedCagesRecord(bpy.types.PropertyGroup):
    """Of a set, on its finest cage, which it has whatever the number of its levels."""

    parts: several("Drawings", "The drawings in these cages", NestedCagesReference)
    title: text("Title", "Name of the drawing when the cages were made")
    inside: flag("Inside", "Whether the cages lie inside the drawing")
    moving: flag("Moving", "Whether the cages follow the drawing's own animation")
    known: flag("Known", "Whether the settings are those that the cages were made with")
    settings: pointer("Settings", "As used", NestedCagesUsed)
    kinds: text("Kinds", "What the cages are by the rules for them")
    colours: whole("Colours", "Number of its colours", default=-1)
    bound: text("Bound", "The method that the drawing is bound by; empty if it is not")
    playing: flag("Playing", "Whether a moving copy is shown instead of the drawings")
    frames: row(IntVectorProperty, "Frames", "Start, result and end of the animation", size=3)
    animated: flag("Animated", "Whether the frames are those of an animation")
    marker: text("Marker", "Name of the marker of the result; empty without one")
    marker_frame: whole("Marker Frame", "Frame of the marker")
    drawn: text("Drawn", "Digests of the drawings that the cages were certified or verified for")


class NestedCagesBefore(bpy.types.PropertyGroup):
    """A bound object as it was."""

    mesh: pointer("Mesh", "Its mesh", Mesh)
    matrix: row(FloatVectorProperty, "Matrix", "Its own transform, row by row", size=16)
    hidden: row(BoolVectorProperty, "Hidden", "In renders, in viewports, and in this view", size=3)


class NestedCagesMember(bpy.types.PropertyGroup):
    """Of an object: its place in a set, and what was found when it was made; lengths in scene units."""

    role: choice("Role", "What the object is", ROLES)
    inner: pointer("Inner", "What a cage encloses", Object)
    outer: pointer("Outer", "The cage around it", Object)
    sets: several("Sets", "The finest cages of a drawing's sets, and silhouettes that show it", NestedCagesReference)
    record: pointer("Record", "What is said of the set, on its finest cage", NestedCagesRecord)
    helpers: several("Helpers", "Objects that show it, fill it, move it, or carry its field", NestedCagesReference)
    shows: pointer("Shows", "What a helper shows, fills or moves", Object)
    thickness: number("Thickness", "Of the lines that a helper shows")
    before: pointer("Before", "As it was before it was bound", NestedCagesBefore)
    certified: choice("Certified", "What is certified, apart from strict nesting", PROMISES, options={"ENUM_FLAG"})
    stamp: text("Stamp", "Digest of the certified coordinates")
    clearance: number("Clearance", "Least distance from what it encloses")
    excess: number("Excess", "Excess area; of a motion, the median")
    most: number("Most", "Largest excess during a motion")
    start: text("Start", "What the run began with")
    seconds: number("Seconds", "Time of the computation")
    frames: row(
        IntVectorProperty, "Frames", "First frames of its phases, and of the result", size=4, default=(-1, -1, -1, -1)
    )
    check: choice("Check", "What Verify Cages found", CHECKS)
    checked: row(IntVectorProperty, "Checked", "First and last frame of the check", size=2)
    judged: text("Judged", "Digest of the coordinates that Verify Cages judged")
    posed: text("Posed", "Digest of the pose that it judged")
    notes: several("Notes", "Notes on the run", NestedCagesNote)
    parts: several("Parts", "What a silhouette shows", NestedCagesReference)


CLASSES = (
    NestedCagesSettings,
    NestedCagesNote,
    NestedCagesReference,
    NestedCagesRange,
    NestedCagesUsed,
    NestedCagesRecord,
    NestedCagesBefore,
    NestedCagesMember,
)

# Of what, under which name, and what they say.
POINTERS = (
    (Object, "nested_cages_member", NestedCagesMember, "Its part in a set of cages"),
    (Scene, "nested_cages", NestedCagesSettings, "Settings of the next cages"),
    (Scene, "nested_cages_playing", NestedCagesRange, "Frames before and as the animation set them"),
)

_register, _unregister = registration(CLASSES)


def register() -> None:
    _register()
    for owner, name, kind, says in POINTERS:
        setattr(owner, name, pointer(name.replace("_", " ").title(), says, kind))


def unregister() -> None:
    for owner, name, _, _ in POINTERS:
        delattr(owner, name)
    _unregister()
