"""The settings: once as the scene's settings, which the panel shows, and once as the operator's properties."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, get_type_hints

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..generation.choices import REPAIRS, SETTINGS
from ..generation.methods import Methods
from ..generation.rules import NONE as NO_SYMMETRY
from ..generation.rules import SYMMETRIES
from . import level_list

# Percentages suit every drawing; for a text or an imported icon these are about 60 and 24 vertices.
DEFAULT_LEVELS = "20%, 8%"


def _choice(name: str) -> Any:
    """The property for a choice of methods."""
    setting = SETTINGS[name]
    return EnumProperty(
        name=setting.name, description=setting.description, items=setting.items, default=setting.default
    )


def length(name: str, description: str) -> Any:
    """The property for a length of the scene, 0 for none."""
    return FloatProperty(
        name=name,
        description=description,
        default=0.0,
        min=0.0,
        soft_max=1.0,
        precision=4,
        step=1,
        subtype="DISTANCE",
        unit="LENGTH",
    )


def _fill_list(self: object, _context: bpy.types.Context) -> None:
    """Updates the list from the levels' text; only the scene's settings have a list."""
    if isinstance(self, NestedCagesSettings):
        level_list.fill(self)


class GenerationProperties:
    """The settings, as a mixin for Blender's classes."""

    levels: StringProperty(
        name="Levels",
        description=(
            "What each cage has, finest first: a number of vertices (64), a share of the drawing's (20%), or the "
            "fewest within a distance of the drawing (5mm, 0.2ft, 2u for units) or so much more area (+25%). * is an "
            "own object"
        ),
        default=DEFAULT_LEVELS,
        update=_fill_list,
    )
    level_objects: StringProperty(
        name="Own Objects",
        description="Names of the objects that * stands for in the levels, one per line",
        default="",
        update=_fill_list,
    )
    use_selected_as_levels: BoolProperty(
        name="Selected as Levels",
        description="Use the active object as the drawing and the other selected objects as its coarse meshes",
        default=False,
    )
    together: BoolProperty(
        name="All in One",
        description="Wrap all selected drawings in common cages, in the plane of the active one; united if they cross",
        default=False,
    )
    inside: BoolProperty(
        name="Inside",
        description="Make cages inside the drawing, of locally largest area, each inside the one before",
        default=False,
    )
    convex: BoolProperty(
        name="Convex",
        description="Make the smallest convex polygon around each part, with as many vertices as the level says",
        default=False,
    )
    grid: length(
        "Grid",
        "Put all vertices of cages at multiples of this length from the object's origin; 0 for none",
    )
    merge: length(
        "Merge",
        "Parts closer than this share a loop of the cage, and smaller holes are filled; 0 keeps all loops",
    )
    symmetry: EnumProperty(
        name="Symmetry", description="What makes both sides of a cage alike", items=SYMMETRIES, default=NO_SYMMETRY
    )
    symmetry_order: IntProperty(
        name="Order", description="Number of sectors that are alike", default=2, min=2, soft_max=12
    )
    weight_group: StringProperty(
        name="Weights",
        description="Vertex group: where its weights are high, cages have more vertices and less excess",
        default="",
    )
    pin_group: StringProperty(
        name="Pins",
        description="Vertex group: cages keep a vertex at each of its vertices with a weight of more than a half",
        default="",
    )
    joint_armature: StringProperty(
        name="Joints",
        description="Armature: cages keep a vertex on both sides of the ends of its bones",
        default="",
    )
    min_edge: length(
        "Shortest Edge",
        "No edge of a cage is shorter than this, where there is room; 0 for any",
    )
    min_angle: FloatProperty(
        name="Sharpest Angle",
        description="No angle of a cage is sharper than this, where there is room; 0 for any",
        default=0.0,
        min=0.0,
        max=1.04,
        subtype="ANGLE",
        unit="ROTATION",
    )
    clearance: length(
        "Clearance",
        "Smallest distance between a cage and what it encloses; 0 uses the share of the size below",
    )
    clearance_share: FloatProperty(
        name="Of the Size",
        description="Smallest distance in percent of the drawing's diagonal; 0 uses the smallest that is safe, 0.001 %",
        default=0.0,
        min=0.0,
        max=100.0,
        soft_max=10.0,
        precision=3,
        subtype="PERCENTAGE",
    )
    decimation: _choice("decimation")
    energy: _choice("energy")
    start_frame: IntProperty(
        name="Start Frame",
        description="First frame of the animation",
        default=1,
        soft_min=0,
    )
    frames_per_step: IntProperty(
        name="Frames per Step",
        description="Frames from one step of the computation to the next",
        default=4,
        min=1,
        soft_max=24,
    )
    fit_length: BoolProperty(
        name="Fit to Length",
        description="Let the whole animation take the frames below, whatever the number of steps",
        default=False,
    )
    length: IntProperty(
        name="Length",
        description="Frames of the whole animation",
        default=120,
        min=2,
        soft_min=24,
        soft_max=500,
    )
    show_flow: BoolProperty(
        name="Show Flow",
        description="Start with the drawing shrinking into the coarse mesh",
        default=True,
    )
    shrink: BoolProperty(
        name="Shrink Further",
        description="Let the drawing shrink further than the method needs, so that its return shows",
        default=True,
    )
    ease: BoolProperty(
        name="Ease",
        description="Ease in and out of each phase",
        default=False,
    )
    loop_back: BoolProperty(
        name="Loop Back",
        description="Play the animation backwards after the result, so that it ends as it began",
        default=False,
    )
    in_turn: BoolProperty(
        name="One after Another",
        description="Play several drawings one after the other instead of together",
        default=False,
    )
    show_result: BoolProperty(
        name="Jump to Result",
        description="Go to the frame that shows the finished cages",
        default=True,
    )
    thickness: length(
        "Line Thickness",
        (
            "Thickness of the lines in renders; 0 shows the cages alone, in proportion to the drawing. To leave a cage "
            "out, disable it in renders"
        ),
    )
    resolution: IntProperty(
        name="Resolution",
        description="Segments between two control points of a curve; 0 uses the curve's own resolution",
        default=0,
        min=0,
        soft_max=64,
        max=1024,
    )
    close_open: BoolProperty(
        name="Close Open Lines",
        description="Join the ends of open splines and lines instead of reporting them",
        default=False,
    )
    project: BoolProperty(
        name="Project Anyway",
        description="Flatten non-planar drawings onto the plane that fits them best",
        default=False,
    )
    contact: _choice("contact")
    repairs: EnumProperty(
        name="Repairs",
        description="Fixes applied to the published method",
        items=REPAIRS,
        default=set(Methods.repairs),
        options={"ENUM_FLAG"},
    )
    expansion_energy: _choice("expansion_energy")
    solver: _choice("solver")
    step_filter: _choice("step_filter")
    broad_phase: _choice("broad_phase")
    flow: _choice("flow")
    quadrature: _choice("quadrature")
    starts: IntProperty(
        name="Starts",
        description="Maximum number of coarse meshes to start from; the tightest cage is kept",
        default=Methods.starts,
        min=1,
        soft_max=12,
    )
    tighten: BoolProperty(
        name="Tighten",
        description="Tighten the cage to a local optimum once the drawing is back, a step that the paper does not have",
        default=Methods.tighten,
    )
    fall_back: BoolProperty(
        name="Fall Back to Hull",
        description="If the flow fails, start from the outer hull",
        default=Methods.fall_back,
    )


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
        self, context: bpy.types.Context, leave: Iterable[str] = (), instead: GenerationProperties | None = None
    ) -> None:
        """Sets what is neither given nor to be left as the panel shows it, or other settings `instead`."""
        properties: Any = self.properties  # type: ignore[attr-defined]
        kept = {name: getattr(self, name) for name in NAMES if name in leave or properties.is_property_set(name)}
        copy_values(instead or settings_of(context), self)
        for name, value in kept.items():
            setattr(self, name, value)


class NestedCagesSettings(bpy.types.PropertyGroup, GenerationProperties):
    """The scene's settings for the next cages; the levels also as a list, which writes the text and is filled by it."""

    # The panel fits the animation to a length; scripts that give frames per step get what they ask for.
    fit_length: BoolProperty(
        name="Fit to Length",
        description="Let the whole animation take the frames below, whatever the number of steps",
        default=True,
    )
    level_list: CollectionProperty(
        name="Level List", description="The levels, one by one", type=level_list.NestedCagesLevel
    )
    level_index: IntProperty(name="Level", description="The level that is chosen in the list", default=0, min=0)


def settings_of(context: bpy.types.Context) -> NestedCagesSettings:
    """The settings of the scene."""
    settings: NestedCagesSettings = context.scene.nested_cages
    return settings


def copy_values(source: GenerationProperties, target: GenerationProperties | bpy.types.OperatorProperties) -> None:
    """Copies all settings from `source` to `target`."""
    for name in NAMES:
        setattr(target, name, getattr(source, name))
    if isinstance(source, NestedCagesSettings) and len(source.level_list):
        # The list refers to objects, which survive renaming.
        target.level_objects = level_list.own_objects(source)


def register() -> None:
    bpy.utils.register_class(level_list.NestedCagesLevel)
    bpy.utils.register_class(NestedCagesSettings)
    bpy.types.Scene.nested_cages = PointerProperty(  # type: ignore[attr-defined, func-returns-value]
        type=NestedCagesSettings, name="Nested Cages", description="Settings of the next cages"
    )


def unregister() -> None:
    del bpy.types.Scene.nested_cages  # type: ignore[attr-defined]
    bpy.utils.unregister_class(NestedCagesSettings)
    bpy.utils.unregister_class(level_list.NestedCagesLevel)
