"""Properties of operators that outline pictures."""

from __future__ import annotations

from typing import Any

from ..blender.props import flag, number, whole


class PictureProperties:
    """Properties of operators on pictures: how to outline opaque pixels."""

    vertices: whole("Vertices", "Vertex count of the outline of a picture", default=64, min=3, soft_max=256)
    padding: number(
        "Padding",
        "Distance in pixels between the outline and opaque pixels; 0 if not set and all of the picture is opaque",
        default=1.0,
        min=0.0,
        soft_max=32.0,
    )
    threshold: number(
        "Threshold", "Opacity above which a pixel counts as opaque", default=0.5, min=0.0, max=1.0, subtype="FACTOR"
    )
    holes: flag("Holes", "Keep holes open instead of filling them")


# Their names, which are those of the core's options.
NAMES = tuple(PictureProperties.__annotations__)


def trace_options(owner: Any) -> dict[str, Any]:
    """The options for ``Picture.outline`` of an operator with these properties."""
    options = {name: getattr(owner, name) for name in NAMES if name != "vertices"}
    return options | {"tile": not owner.properties.is_property_set("padding")}
