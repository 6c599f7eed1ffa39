"""Optional libraries for formats: imported when needed, with a clear error if missing."""

from __future__ import annotations

from types import ModuleType
from typing import cast

from ..errors import NestedCagesError

INSTALL = "install it with 'pip install nested-cages[formats]'"
"""Advice about a missing library; the Blender extension includes all but Pillow, since Blender reads
pictures itself."""


def load_shapely(purpose: str) -> ModuleType:
    """shapely (GEOS), for `purpose`, a plural such as "overlapping shapes". Raises NestedCagesError where missing."""
    try:
        import shapely
    except ImportError as error:
        raise NestedCagesError(f"Reading {purpose} needs shapely; {INSTALL}.", code="dependency.missing") from error
    return cast(ModuleType, shapely)


def load_css() -> tuple[ModuleType, ModuleType]:
    """tinycss2 and cssselect2, for style sheets. Raises NestedCagesError where missing."""
    try:
        import cssselect2
        import tinycss2
    except ImportError as error:
        raise NestedCagesError(
            f"Reading style sheets needs tinycss2 and cssselect2; {INSTALL}.", code="dependency.missing"
        ) from error
    return cast(ModuleType, tinycss2), cast(ModuleType, cssselect2)


def load_colours() -> ModuleType:
    """The colours of tinycss2. Raises NestedCagesError where missing."""
    try:
        import tinycss2.color4
    except ImportError as error:
        raise NestedCagesError(
            f"Reading colours by function or in masks needs tinycss2; {INSTALL}.", code="dependency.missing"
        ) from error
    return cast(ModuleType, tinycss2.color4)


def load_pictures() -> ModuleType:
    """The pictures of Pillow. Raises NestedCagesError where missing."""
    try:
        from PIL import Image
    except ImportError as error:
        raise NestedCagesError(
            f"Reading PNG needs Pillow; {INSTALL}.", code="dependency.missing", library="Pillow"
        ) from error
    return Image
