"""What the user can set: once as the scene's settings, which the panel shows, and once as the operator's properties."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeVar

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

from ..animation.timeline import Timing
from ..generation.choices import REPAIRS, SETTINGS
from ..generation.generate import Options, parse_levels
from ..generation.methods import Methods
from ..scene.convert import ReadingOptions
from . import level_list

Filled = TypeVar("Filled", ReadingOptions, Timing, Methods)
# Parts, because any drawing has them; of a text or an imported icon they are some 60 and 24 vertices.
DEFAULT_LEVELS = "20%, 8%"


def _choice(name: str) -> Any:
    """The property for a choice of methods."""
    setting = SETTINGS[name]
    return EnumProperty(
        name=setting.name, description=setting.description, items=setting.items, default=setting.default
    )


def _fill_list(self: object, _context: bpy.types.Context) -> None:
    """Shows the levels' text in the list, which only the scene's settings have."""
    if isinstance(self, NestedCagesSettings):
        level_list.fill(self)


class GenerationProperties:
    """The settings, for a class of Blender to inherit."""

    levels: StringProperty(  # type: ignore[valid-type]
        name="Levels",
        description=(
            "Vertices of each cage from the inside out: parts of the drawing's own number, such as 20%, or numbers, "
            "such as 64, 24. * stands for the next of the own objects"
        ),
        default=DEFAULT_LEVELS,
        update=_fill_list,
    )
    level_objects: StringProperty(  # type: ignore[valid-type]
        name="Own Objects",
        description="Names of the objects that * stands for in the levels, one on each line",
        default="",
        update=_fill_list,
    )
    use_selected_as_levels: BoolProperty(  # type: ignore[valid-type]
        name="Selected as Levels",
        description=(
            "The active object is the drawing, and the other selected objects are its coarse meshes, from finest to "
            "coarsest"
        ),
        default=False,
    )
    together: BoolProperty(  # type: ignore[valid-type]
        name="All in One",
        description=(
            "Wrap all selected drawings in common cages, as if they were one object, instead of each in its own; they "
            "lie in the plane of the active one"
        ),
        default=False,
    )
    clearance: FloatProperty(  # type: ignore[valid-type]
        name="Clearance",
        description=(
            "Smallest distance between a cage and what it encloses; 0 takes a hundred thousandth of the drawing's size"
        ),
        default=0.0,
        min=0.0,
        soft_max=1.0,
        precision=4,
        step=1,
        subtype="DISTANCE",
        unit="LENGTH",
    )
    decimation: _choice("decimation")  # type: ignore[valid-type]
    energy: _choice("energy")  # type: ignore[valid-type]
    start_frame: IntProperty(  # type: ignore[valid-type]
        name="Start Frame",
        description="Frame on which the animation begins",
        default=1,
        soft_min=0,
    )
    frames_per_step: IntProperty(  # type: ignore[valid-type]
        name="Frames per Step",
        description="Frames from one step of the computation to the next",
        default=4,
        min=1,
        soft_max=24,
    )
    show_flow: BoolProperty(  # type: ignore[valid-type]
        name="Show Flow",
        description="Begin the animation with the drawing shrinking into the coarse mesh, which it passes through",
        default=True,
    )
    ease: BoolProperty(  # type: ignore[valid-type]
        name="Ease",
        description="Let shrinking, growing back and tightening begin and end slowly, on the same certified way",
        default=False,
    )
    loop_back: BoolProperty(  # type: ignore[valid-type]
        name="Loop Back",
        description="Play everything backwards after the result, so that the animation ends as it began",
        default=False,
    )
    show_result: BoolProperty(  # type: ignore[valid-type]
        name="Jump to Result",
        description="Go to the frame that shows the finished cages when they are made",
        default=True,
    )
    thickness: FloatProperty(  # type: ignore[valid-type]
        name="Line Thickness",
        description="Thickness of the lines of drawing and cages in renders; 0 leaves them out of renders",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        precision=4,
        step=1,
        subtype="DISTANCE",
        unit="LENGTH",
    )
    resolution: IntProperty(  # type: ignore[valid-type]
        name="Resolution",
        description=(
            "Segments between two control points of a curve; 0 takes the resolution that the curve is shown with"
        ),
        default=0,
        min=0,
        soft_max=64,
        max=1024,
    )
    close_open: BoolProperty(  # type: ignore[valid-type]
        name="Close Open Lines",
        description="Join the two ends of open splines and lines instead of refusing them",
        default=False,
    )
    project: BoolProperty(  # type: ignore[valid-type]
        name="Project Anyway",
        description="Flatten drawings that are not planar onto the plane that fits them best instead of refusing them",
        default=False,
    )
    contact: _choice("contact")  # type: ignore[valid-type]
    repairs: EnumProperty(  # type: ignore[valid-type]
        name="Repairs",
        description="Faults of the paper's program to be mended, in those parts of it that are chosen",
        items=REPAIRS,
        default=set(Methods.repairs),
        options={"ENUM_FLAG"},
    )
    expansion_energy: _choice("expansion_energy")  # type: ignore[valid-type]
    solver: _choice("solver")  # type: ignore[valid-type]
    step_filter: _choice("step_filter")  # type: ignore[valid-type]
    broad_phase: _choice("broad_phase")  # type: ignore[valid-type]
    flow: _choice("flow")  # type: ignore[valid-type]
    quadrature: _choice("quadrature")  # type: ignore[valid-type]
    starts: IntProperty(  # type: ignore[valid-type]
        name="Starts",
        description="How many coarse meshes to start from, where there are several; the tightest cage is kept",
        default=Methods.starts,
        min=1,
        soft_max=12,
    )
    tighten: BoolProperty(  # type: ignore[valid-type]
        name="Tighten",
        description="Bring the cage to its optimum once the drawing is home, which the paper does not do",
        default=Methods.tighten,
    )
    fall_back: BoolProperty(  # type: ignore[valid-type]
        name="Fall Back to Hull",
        description="Start from the outer hull where the drawing cannot get into a coarse mesh, instead of refusing",
        default=Methods.fall_back,
    )


# All settings; and what is shown together, in this order.
NAMES = tuple(GenerationProperties.__annotations__)
WHAT = ("use_selected_as_levels", "together", "clearance", "decimation", "energy")
FRAMES = ("start_frame", "frames_per_step")
ANIMATION = ("show_flow", "ease", "loop_back", "show_result")
LOOKS = ("thickness",)
READING = ("resolution", "close_open", "project")
ADVANCED = (
    *("contact", "repairs", "expansion_energy", "solver", "step_filter", "broad_phase"),
    *("flow", "quadrature", "starts", "tighten", "fall_back"),
)


class NestedCagesSettings(bpy.types.PropertyGroup, GenerationProperties):
    """The scene's settings for the next cages; the levels also as a list, which writes the text and is filled by it."""

    level_list: CollectionProperty(  # type: ignore[valid-type]
        name="Level List", description="The levels, one by one", type=level_list.NestedCagesLevel
    )
    level_index: IntProperty(  # type: ignore[valid-type]
        name="Level", description="The level that is chosen in the list", default=0, min=0
    )


def reading_options(values: GenerationProperties) -> ReadingOptions:
    """How objects are read."""
    return _filled(ReadingOptions, values)


def _filled(kind: type[Filled], values: GenerationProperties) -> Filled:
    """A dataclass whose fields are called as the settings are."""
    found = {name: getattr(values, name) for name in kind.__dataclass_fields__}
    return kind(**{name: frozenset(value) if isinstance(value, set) else value for name, value in found.items()})


def options(values: GenerationProperties) -> Options:
    """What is computed. Raises: UserError if the levels cannot be read."""
    levels = () if values.use_selected_as_levels else parse_levels(values.levels)
    return Options(levels=levels, clearance=values.clearance, methods=methods(values))


def methods(values: GenerationProperties) -> Methods:
    """How it is computed."""
    return _filled(Methods, values)


def draw(layout: bpy.types.UILayout, values: GenerationProperties, names: Iterable[str]) -> None:
    """Draws settings, and dims those that what is chosen has no use for."""
    chosen = methods(values)
    for name in names:
        line = layout.column()
        line.active = chosen.has_use_for(name)
        line.prop(values, name)


def own_names(values: GenerationProperties) -> list[str]:
    """Names of the own objects that the levels use."""
    return [] if values.use_selected_as_levels else level_list.names_of(values.levels, values.level_objects)


def timing(values: GenerationProperties) -> Timing:
    """How the result is animated."""
    return _filled(Timing, values)


def copy_values(source: GenerationProperties, target: GenerationProperties) -> None:
    """Sets all settings of `target` to those of `source`."""
    for name in NAMES:
        setattr(target, name, getattr(source, name))
    if isinstance(source, NestedCagesSettings) and len(source.level_list):
        # The list knows its objects even if they were renamed.
        target.level_objects = level_list.own_objects(source)


def register() -> None:
    bpy.utils.register_class(level_list.NestedCagesLevel)
    bpy.utils.register_class(NestedCagesSettings)
    bpy.types.Scene.nested_cages = PointerProperty(
        type=NestedCagesSettings, name="Nested Cages", description="Settings of the next cages"
    )


def unregister() -> None:
    del bpy.types.Scene.nested_cages
    bpy.utils.unregister_class(NestedCagesSettings)
    bpy.utils.unregister_class(level_list.NestedCagesLevel)
