"""What the user can set: once as the scene's settings, which the panel shows, and once as the operator's properties."""

from __future__ import annotations

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

from . import level_list
from .animation import Timing
from .convert import ReadingOptions
from .generate import Options, parse_levels

DECIMATION_ITEMS = (
    (
        "ON_CURVE",
        "On the Curve",
        "Coarse meshes start on the drawing, so that it is seen to shrink, and to push them out while it grows back; "
        "further levels start from the outer hull",
    ),
    (
        "OUTER_HULL",
        "Outer Hull",
        "Coarse meshes start outside of the drawing, which need not shrink: the tightest cages",
    ),
    ("ARC_LENGTH", "Even Resampling", "Coarse vertices lie on the drawing at equal distances along it, on every level"),
)


ENERGY_ITEMS = (
    ("AREA", "Least Area", "As tight as the number of vertices allows"),
    ("SHAPE_KEEPING", "Keep Shape", "Tight, but straight stays straight, level stays level and symmetric symmetric"),
    ("INITIAL_DISPLACEMENT", "Least Motion", "As close to the coarse mesh as can be"),
    ("BOUNDARY_ARAP", "Rigid Outline", "The outline of the coarse mesh bends and stretches as little as can be"),
    ("INTERIOR_ARAP", "Rigid Inside", "What is inside the coarse mesh bends and stretches as little as can be"),
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
            "Number of vertices of each cage from the inside out, such as 64, 24; or parts of the drawing's own "
            "number, such as 10%. * stands for the next of the own objects"
        ),
        default="64, 24",
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
    decimation: EnumProperty(  # type: ignore[valid-type]
        name="Coarse Meshes",
        description="How the coarse mesh that becomes a cage is made",
        items=DECIMATION_ITEMS,
        default="ON_CURVE",
    )
    energy: EnumProperty(  # type: ignore[valid-type]
        name="Energy",
        description="What a cage minimises",
        items=ENERGY_ITEMS,
        default="AREA",
    )
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
        description=(
            "Begin and end shrinking, growing back and tightening slowly, on the same way and as free of collisions"
        ),
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


# In the order of the panel.
NAMES = tuple(GenerationProperties.__annotations__)


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
    return ReadingOptions(resolution=values.resolution, close_open=values.close_open, project=values.project)


def options(values: GenerationProperties) -> Options:
    """What is computed. Raises: Refusal if the levels are not numbers."""
    levels = () if values.use_selected_as_levels else parse_levels(values.levels)
    return Options(levels=levels, clearance=values.clearance, decimation=values.decimation, energy=values.energy)


def own_names(values: GenerationProperties) -> list[str]:
    """Names of the own objects that the levels use."""
    return [] if values.use_selected_as_levels else level_list.names_of(values.levels, values.level_objects)


def timing(values: GenerationProperties) -> Timing:
    """How the result is animated."""
    names = ("start_frame", "frames_per_step", "show_flow", "ease", "loop_back")
    return Timing(**{name: getattr(values, name) for name in names})


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
    bpy.types.Scene.nested_cages = PointerProperty(type=NestedCagesSettings, name="Nested Cages")


def unregister() -> None:
    del bpy.types.Scene.nested_cages
    bpy.utils.unregister_class(NestedCagesSettings)
    bpy.utils.unregister_class(level_list.NestedCagesLevel)
