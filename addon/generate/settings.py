"""The settings: once as the scene's settings, which the panel shows, and once as the operator's properties; and the
parameters of other modules from them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

import bpy
from bpy.types import Context

from ..animation.timeline import Timing
from ..blender.props import choice, flag, length, number, text, whole
from ..drawing.planar import ReadingOptions
from .options import AUTO, DECIMATIONS, DIRECTIONS, ENERGIES, LOOPS, SYMMETRIES, items
from .options import NONE as NO_SYMMETRY

# Percentages suit every drawing; for a text or an imported icon these are about 60 and 24 vertices.
DEFAULT_LEVELS = "20%, 8%"


class GenerationProperties:
    """The settings, as a mixin for Blender's classes."""

    levels: text(
        "Vertices",
        "What each cage has, finest first: a number of vertices (64), a share of the drawing's vertices (20%), or as "
        "few as keep within a distance of the drawing (5mm, 0.2ft, 2u for units) or add at most some area (+25%)",
        default=DEFAULT_LEVELS,
    )
    use_selected_as_levels: flag(
        "Selected as Cages", "Use the active object as the drawing and the other selected objects as its coarse meshes"
    )
    together: flag(
        "All in One", "Wrap all selected drawings in common cages, in the plane of the active one; united if they cross"
    )
    inside: flag("Cage Inside", "Make cages inside the drawing, of locally largest area, each inside the one before")
    convex: flag("Convex", "Make the smallest convex polygon around each part, with as many vertices as the level says")
    grid: length("Grid", "Put all vertices of cages at multiples of this length from the object's origin; 0 for none")
    loops: choice("Loops", "Which loops of the drawing have one of their own in a cage", LOOPS, default=AUTO)
    symmetry: choice("Symmetry", "What makes both sides of a cage alike", SYMMETRIES, default=NO_SYMMETRY)
    symmetry_order: whole("Order", "Number of sectors that are alike", default=2, min=2, soft_max=12)
    directions: choice("Edges", "Directions of the edges of cages in the plane of the drawing", DIRECTIONS)
    weight_group: text("Weights", "Vertex group: where its weights are high, cages have more vertices and less excess")
    pin_group: text(
        "Pins", "Vertex group: cages keep a vertex at each of its vertices with a weight of more than a half"
    )
    joint_armature: text("Joints", "Armature: cages keep a vertex on both sides of the ends of its bones")
    min_edge: length("Shortest Edge", "No edge of a cage is shorter than this, where there is room; 0 for any")
    min_angle: number(
        "Sharpest Angle",
        "No angle of a cage is sharper than this, where there is room; 0 for any",
        min=0.0,
        max=1.04,
        subtype="ANGLE",
        unit="ROTATION",
    )
    clearance: length(
        "Clearance", "Smallest distance between a cage and what it encloses; 0 uses the share of the size below"
    )
    clearance_share: number(
        "Clearance in %",
        "Smallest distance in percent of the drawing's diagonal; 0 uses the smallest that is safe, 0.001 %",
        min=0.0,
        max=100.0,
        soft_max=10.0,
        precision=3,
        subtype="PERCENTAGE",
    )
    decimation: choice("Coarse Meshes", "How coarse meshes are made", items(DECIMATIONS))
    energy: choice("Energy", "What a cage minimises", items(ENERGIES))
    as_published: flag(
        "As Published",
        "Shrink and grow back as in Augmenting Nested Cages with IPC (Gurditta & Jacobson 2022), with repairs and "
        "without tightening: slow and loose, for teaching and comparison. Lengths are those of its program, made for "
        "drawings of about 2 units across",
    )
    start_frame: whole("Start Frame", "First frame of the animation", default=1, soft_min=0)
    frames_per_step: whole(
        "Frames per Step", "Frames from one step of the computation to the next", default=4, min=1, soft_max=24
    )
    length: whole(
        "Length", "Frames of the whole animation; 0 plays as many for each step as below", min=0, soft_max=500
    )
    show_flow: flag("Show Flow", "Start with the drawing shrinking into the coarse mesh", default=True)
    thickness: length(
        "Line Thickness",
        (
            "Thickness of the lines in renders; 0 shows the cages alone, in proportion to the drawing. To leave a cage "
            "out, disable it in renders"
        ),
    )
    close_open: flag("Close Open Lines", "Join the ends of open splines and lines instead of reporting them")
    project: flag("Project Anyway", "Flatten non-planar drawings onto the plane that fits them best")


NAMES = tuple(GenerationProperties.__annotations__)


def _forgotten(deferred: Any) -> Any:
    """The same property of an operator, without the value of the last time, which would hide the panel's."""
    keywords = {name: value for name, value in deferred.keywords.items() if name != "options"}
    return deferred.function(**keywords, options={*deferred.keywords.get("options", {"ANIMATABLE"}), "SKIP_SAVE"})


class OperatorProperties(GenerationProperties):
    """The settings of an operator: those that are not given are the panel's when it is invoked, by a shortcut or from
    the search, and the defaults when a script executes it.
    """

    if not TYPE_CHECKING:
        __annotations__ = {name: _forgotten(each) for name, each in get_type_hints(GenerationProperties).items()}

    def take_from_panel(
        self, context: Context, leave: Iterable[str] = (), instead: GenerationProperties | None = None
    ) -> None:
        """Sets what is neither given nor to be left as the panel shows it, or other settings `instead`."""
        properties: Any = self.properties  # type: ignore[attr-defined]
        kept = {name: getattr(self, name) for name in NAMES if name in leave or properties.is_property_set(name)}
        copy_values(instead or settings_of(context), self)
        for name, value in kept.items():
            setattr(self, name, value)


class NestedCagesSettings(bpy.types.PropertyGroup, GenerationProperties):
    """The scene's settings for the next cages."""

    # The panel fits the animation to a length; scripts that give frames per step get what they ask for.
    length: whole(
        "Length",
        "Frames of the whole animation; 0 plays as many for each step as below",
        default=120,
        min=0,
        soft_max=500,
    )


def settings_of(context: Context) -> NestedCagesSettings:
    """The settings of the scene."""
    return context.scene.nested_cages


def copy_values(source: GenerationProperties, target: GenerationProperties | bpy.types.OperatorProperties) -> None:
    """Copies all settings from `source` to `target`."""
    for name in NAMES:
        setattr(target, name, getattr(source, name))


Filled = TypeVar("Filled", ReadingOptions, Timing)


def all_values(values: GenerationProperties) -> dict[str, Any]:
    """All settings, by name."""
    return {name: getattr(values, name) for name in NAMES}


def filled(kind: type[Filled], values: GenerationProperties) -> Filled:
    """How to read objects, or when to play steps: the fields are named as settings."""
    given: dict[str, Any] = {field.name: getattr(values, field.name) for field in fields(kind)}
    return kind(**given)
