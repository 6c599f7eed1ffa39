"""Optional libraries of geometry and file formats, imported when they are needed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from .errors import NestedCagesError

INSTALL = "install it with 'pip install nested-cages[formats]'"
"""Advice about a missing library; the Blender extension includes all but Pillow, since Blender reads
pictures itself."""


@contextmanager
def _needed(name: str, purpose: str, install: str = INSTALL) -> Iterator[None]:
    """Raises NestedCagesError where the library is missing; purpose: the subject, such as "Merging parts"."""
    try:
        yield
    except ImportError as error:
        problem = f"{purpose} needs {name}; {install}."
        raise NestedCagesError(problem, code="dependency.missing", library=name) from error


def load_shapely(purpose: str) -> Any:
    """shapely (GEOS), for the subject of a sentence. Raises NestedCagesError where it is missing."""
    with _needed("shapely", purpose):
        import shapely
    return shapely


def has_shapely() -> bool:
    """Whether shapely can be imported."""
    try:
        load_shapely("This")
    except NestedCagesError:
        return False
    return True


def load_css() -> tuple[Any, Any]:
    """tinycss2, with its colours, and cssselect2."""
    with _needed("tinycss2 and cssselect2", "Reading styles and colours by function or in masks"):
        import cssselect2
        import tinycss2.color4
    return tinycss2, cssselect2


def load_pyogrio(purpose: str) -> Any:
    """pyogrio (GDAL), for the subject of a sentence. Raises NestedCagesError where it is missing."""
    with _needed("pyogrio", purpose, "install it with 'pip install nested-cages[maps]'"):
        import pyogrio
    return pyogrio


def load_pictures() -> Any:
    """The pictures of Pillow."""
    with _needed("Pillow", "Reading PNG"):
        from PIL import Image
    return Image
