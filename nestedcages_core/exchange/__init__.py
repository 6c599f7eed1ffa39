"""Shapes in and out: SVG, GeoJSON and collision outlines for game engines."""

from .character_json import character_to_engine_json
from .coverage import Coverage, coverage_cages
from .engine_json import (
    frames_to_engine_json,
    from_engine_json,
    is_engine_json,
    outlines_from_engine_json,
    to_engine_json,
    write_engine_json,
)
from .files import read_whole, write_whole
from .fill import Painted, clipped, joined, solid
from .geojson import (
    Feature,
    Map,
    features_from_geojson,
    from_geojson,
    read_geojson,
    read_map,
    to_geojson,
    write_geojson,
)
from .gis_files import FILES, map_document
from .limits import Limits
from .puppet_parts import puppet_parts
from .svg.document import Frame
from .svg.levels import levels_in_svg
from .svg.options import DRAWING_LIMITS, SvgOptions
from .svg.parts import SvgPart, svg_parts
from .svg.reading import SvgDrawing, from_svg, is_written_svg, read_svg, read_svg_drawing, svg_drawing
from .svg.writing import to_svg, write_svg
from .swept import swept

__all__ = [
    "DRAWING_LIMITS",
    "FILES",
    "Coverage",
    "Feature",
    "Frame",
    "Limits",
    "Map",
    "Painted",
    "SvgDrawing",
    "SvgOptions",
    "SvgPart",
    "character_to_engine_json",
    "clipped",
    "coverage_cages",
    "features_from_geojson",
    "frames_to_engine_json",
    "from_engine_json",
    "from_geojson",
    "from_svg",
    "is_engine_json",
    "is_written_svg",
    "joined",
    "levels_in_svg",
    "map_document",
    "outlines_from_engine_json",
    "puppet_parts",
    "read_geojson",
    "read_map",
    "read_svg",
    "read_svg_drawing",
    "read_whole",
    "solid",
    "svg_drawing",
    "svg_parts",
    "swept",
    "to_engine_json",
    "to_geojson",
    "to_svg",
    "write_engine_json",
    "write_geojson",
    "write_svg",
    "write_whole",
]
