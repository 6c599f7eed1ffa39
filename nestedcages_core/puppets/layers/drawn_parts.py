"""The parts of a layered SVG as parts of a puppet."""

from __future__ import annotations

from typing import Any

from ...formats.solids import Painted, solid
from ...formats.svg.parts import SvgPart, svg_parts
from ...geometry.mesh import Mesh
from ..part import PuppetPart
from .grouping import without_aids
from .layer import Notes


def puppet_parts(text: str | bytes, **options: Any) -> tuple[tuple[PuppetPart, ...], tuple[str, ...]]:
    """Each shape of a document with all that it paints, the lowest first, y pointing up, and notes on omissions.

    options: fields of `SvgOptions`. Raises NestedCagesError as `from_svg`.
    """
    parts, notes = svg_parts(text, **options)
    said = Notes()
    found = tuple(PuppetPart(part.name, _outline(part), part.groups) for part in without_aids(parts, said))
    return found, (*notes, *said.sentences)


def _outline(part: SvgPart) -> Mesh:
    """Fill and stroke as one, turned over."""
    paints = [paint for paint in (part.fill, part.stroke) if paint is not None]
    whole = solid([Painted(paint.rings) for paint in paints]) if len(paints) > 1 else paints[0]
    return Mesh.from_loops([ring * (1.0, -1.0) for ring in whole.rings])
