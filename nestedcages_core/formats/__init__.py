"""Shapes in and out: SVG, GeoJSON and pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..libraries import imported_later

if TYPE_CHECKING:
    from .coverage import Coverage as Coverage
    from .coverage import coverage_cages as coverage_cages
    from .files import read_whole as read_whole
    from .files import write_files as write_files
    from .files import write_whole as write_whole
    from .geojson import Feature as Feature
    from .geojson import features_from_geojson as features_from_geojson
    from .geojson import from_geojson as from_geojson
    from .geojson import measures as measures
    from .geojson import read_geojson as read_geojson
    from .geojson import read_map as read_map
    from .geojson import to_geojson as to_geojson
    from .geojson import write_geojson as write_geojson
    from .gis_files import map_document as map_document
    from .limits import Limits as Limits
    from .pieces import convex_pieces as convex_pieces
    from .pieces import piece_vertices as piece_vertices
    from .solids import Painted as Painted
    from .solids import clipped as clipped
    from .solids import joined as joined
    from .solids import solid as solid
    from .svg.document import DRAWING_LIMITS as DRAWING_LIMITS
    from .svg.document import Frame as Frame
    from .svg.gradients import Shades as Shades
    from .svg.gradients import shaded as shaded
    from .svg.parts import SvgPart as SvgPart
    from .svg.parts import svg_parts as svg_parts
    from .svg.reading import from_svg as from_svg
    from .svg.reading import is_written_svg as is_written_svg
    from .svg.reading import read_svg as read_svg
    from .svg.reading import read_svg_drawing as read_svg_drawing
    from .svg.reading import svg_drawing as svg_drawing
    from .svg.writing import to_svg as to_svg
    from .svg.writing import write_svg as write_svg
else:  # each name from its module: to read a map loads no SVG
    __getattr__ = imported_later(
        __name__,
        {
            "coverage": "Coverage coverage_cages",
            "files": "read_whole write_files write_whole",
            "geojson": "Feature features_from_geojson from_geojson measures read_geojson read_map to_geojson "
            "write_geojson",
            "gis_files": "map_document",
            "limits": "Limits",
            "pieces": "convex_pieces piece_vertices",
            "solids": "Painted clipped joined solid",
            "svg.document": "DRAWING_LIMITS Frame",
            "svg.parts": "SvgPart svg_parts",
            "svg.gradients": "Shades shaded",
            "svg.reading": "from_svg is_written_svg read_svg read_svg_drawing svg_drawing",
            "svg.writing": "to_svg write_svg",
        },
    )
