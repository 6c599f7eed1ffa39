"""Common properties of operators on pictures: how to outline opaque pixels."""

from __future__ import annotations

from typing import Any

from .kinds import flag, number


class PictureProperties:
    """The properties, as a mixin for Blender's classes."""

    padding: number(
        "Padding",
        "Distance in pixels between the outline and opaque pixels; none, unless set, around an opaque tile",
        default=1.0,
        min=0.0,
        soft_max=32.0,
    )
    threshold: number("Threshold", "Opacity above which a pixel counts as opaque", min=0.0, max=1.0, subtype="FACTOR")
    holes: flag("Holes", "Keep holes open instead of filling them")


# Their names, which are those of the core's options.
NAMES = tuple(PictureProperties.__annotations__)


def values(owner: Any) -> dict[str, Any]:
    """The options for ``Picture.outline`` of an operator with these properties."""
    return {name: getattr(owner, name) for name in NAMES} | {"tile": not owner.properties.is_property_set("padding")}
