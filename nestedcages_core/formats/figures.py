"""Pictures of results, for notebooks and plots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..geometry.arrays import FloatArray
from ..libraries import load_pyplot

COLOURS = ("#27364b", "#0072b2", "#009e73", "#d55e00", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours of levels, in turn: dark for drawings, then the colour-blind safe palette of Okabe and Ito."""

DRAWING_OPACITY, CAGE_OPACITY = 0.9, 0.15
"""Opacity of fills."""

SHOWN_DRAWING = ("#7a8ba3", 0.6)
"""Colour and opacity of drawings in pictures: cages inside show, on white pages and on dark ones."""

PICTURE_WIDTH, PICTURE_HEIGHT = 480.0, 320.0
"""Maximum size of a picture in a notebook, in pixels."""

PICTURE_MARGIN = 0.03
"""Margin of a picture, and half the space between frames, as a fraction of a frame's diagonal."""


def svg_picture(frames: Sequence[Sequence[Any]]) -> str:
    """The picture that a notebook shows: frames of meshes side by side, with y pointing up."""
    points = np.concatenate([mesh.vertices for frame in frames for mesh in frame])
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    margin = PICTURE_MARGIN * float(np.hypot(*size))
    step = float(size[0]) + 2.0 * margin
    width, height = step * len(frames), float(size[1]) + 2.0 * margin
    pixels = min(PICTURE_WIDTH * len(frames) / width, PICTURE_HEIGHT / height)
    shapes = []
    for k, frame in enumerate(frames):
        shapes.append(f'<g transform="translate({margin - low[0] + k * step:.9g} 0)">')
        for level, mesh in _largest_first(frame):
            colour, opacity = _paint(level)
            shapes.append(
                f'<path d="{path_data(mesh)}" fill="{colour}" fill-opacity="{opacity}" fill-rule="evenodd" '
                f'stroke="{colour}" stroke-width="1.2" vector-effect="non-scaling-stroke"/>'
            )
        shapes.append("</g>")
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{pixels * width:.0f}" height="{pixels * height:.0f}" '
        f'viewBox="0 0 {width:.9g} {height:.9g}"><g transform="translate(0 {margin + low[1] + size[1]:.9g}) '
        f'scale(1 -1)">{"".join(shapes)}</g></svg>'
    )


def plotted(meshes: Sequence[Any], ax: Any = None) -> Any:
    """Draw meshes with matplotlib on axes, by default new ones; returns the axes. Raises NestedCagesError."""
    axes = load_pyplot().subplots()[1] if ax is None else ax
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    for level, mesh in _largest_first(meshes):
        outline = Path.make_compound_path(*(Path(ring, closed=True) for ring in map(_closed, mesh.rings)))
        colour, opacity = _paint(level)
        axes.add_patch(PathPatch(outline, facecolor="none", edgecolor=colour, linewidth=1.0))
        axes.add_patch(PathPatch(outline, facecolor=colour, edgecolor="none", alpha=opacity))
    axes.set_aspect("equal")
    axes.autoscale_view()
    return axes


def path_data(mesh: Any) -> str:
    """The loops of a mesh as SVG path data; outer loops and holes have opposite directions, so any fill rule works."""
    return " ".join(f"M {' L '.join(f'{x!r} {y!r}' for x, y in ring.tolist())} Z" for ring in mesh.rings)


def _paint(level: int) -> tuple[str, float]:
    """Colour and opacity of a level in pictures."""
    return (COLOURS[level % len(COLOURS)], CAGE_OPACITY) if level else SHOWN_DRAWING


def _largest_first(meshes: Sequence[Any]) -> list[tuple[int, Any]]:
    """Meshes with their levels, in the order in which none hides another."""
    return sorted(enumerate(meshes), key=lambda each: -each[1].area)


def _closed(ring: FloatArray) -> FloatArray:
    return np.concatenate((ring, ring[:1]))
