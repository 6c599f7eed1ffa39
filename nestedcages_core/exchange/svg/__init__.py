"""SVG in and out: what is painted becomes a mesh, meshes become paths with holes."""

from __future__ import annotations

from .document import Frame
from .options import DRAWING_LIMITS, SvgOptions
from .parts import SvgPart, svg_parts
from .reading import SvgDrawing, SvgShapes, from_svg, read_svg, read_svg_drawing, svg_drawing, svg_shapes
from .writing import to_svg, write_svg

__all__ = [
    "DRAWING_LIMITS",
    "Frame",
    "SvgDrawing",
    "SvgOptions",
    "SvgPart",
    "SvgShapes",
    "from_svg",
    "read_svg",
    "read_svg_drawing",
    "svg_drawing",
    "svg_parts",
    "svg_shapes",
    "to_svg",
    "write_svg",
]
