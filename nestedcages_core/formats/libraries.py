"""Optional libraries of file formats, imported when they are needed."""

from __future__ import annotations

from typing import Any

from ..libraries import needed


def load_pyogrio(purpose: str) -> Any:
    """pyogrio (GDAL), for the subject of a sentence. Raises NestedCagesError where it is missing."""
    with needed("pyogrio", purpose):
        import pyogrio
    return pyogrio


def load_pictures() -> Any:
    """The pictures of Pillow."""
    with needed("Pillow", "Reading PNG"):
        from PIL import Image
    return Image
