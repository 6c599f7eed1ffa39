"""Every reader with the grammar of what it is given."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hypothesis import strategies as st

from nestedcages_core import Mesh, features_from_geojson, from_engine_json, from_geojson, from_svg
from nestedcages_core.exchange.pictures.png import decode_png

from . import grammars

READERS: dict[str, tuple[st.SearchStrategy[Any], Callable[[Any], Any]]] = {
    "SVG": (grammars.svg_documents, from_svg),
    "GeoJSON": (grammars.geojson_documents, from_geojson),
    "GeoJSON, feature by feature": (grammars.geojson_documents, features_from_geojson),
    "collision outlines": (grammars.engine_documents, from_engine_json),
    "PNG": (grammars.png_documents, decode_png),
    "loops of points": (grammars.loops(), Mesh.from_loops),
}
"""Grammar and reader."""
