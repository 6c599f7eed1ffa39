"""What simplifying cuts off and a cage holds: a sprite, a coast and a character, in as many vertices either way.

Run as ``python examples/cut_or_held.py``; needs shapely and matplotlib. Simplified by Douglas and Peucker's method, as
drawing programs, maps and game engines do.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from coast import coast
from nestedcages_core import Mesh, boundary_of_pixels, from_svg, nested_cages, read_svg
from plot import BLUE, INK, arguments, fill, line, panels, save
from sprite_outline import fox as sprite_of

FOX = Path(__file__).with_name("fox.svg")
SAND, CUT_OFF = "#d8cba8", "#d1005a"
HALVINGS = 60
LINE, LOST = 2.6, 1.6  # widths of outlines and around what is cut off, in points
TITLE = 17  # size of the words in points


def simplified(shape: shapely.Geometry, count: int) -> shapely.Geometry:
    """A shape in at most `count` vertices by Douglas and Peucker: the largest detail that fits, by bisection."""
    low, high = 0.0, float(np.hypot(*np.subtract(shape.bounds[2:], shape.bounds[:2])))
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        fits = shapely.get_num_coordinates(shape.simplify(middle, preserve_topology=False).exterior) <= count + 1
        low, high = (low, middle) if fits else (middle, high)
    return shape.simplify(high, preserve_topology=False)


def largest(mesh: Mesh) -> shapely.Geometry:
    """The outline of the largest part, without holes."""
    return max((shapely.Polygon(ring) for ring in mesh.rings), key=lambda part: part.area)


def sprite(axes: Any) -> None:
    """The pixels of the sprite."""
    picture = sprite_of(64)
    axes.imshow(picture, extent=(0, 64, 0, 64), interpolation="nearest")


def character(axes: Any) -> None:
    """The fox in its colours, shape by shape."""
    for path in ET.parse(FOX).iter("{http://www.w3.org/2000/svg}path"):
        shape = from_svg(f'<svg viewBox="-270 -250 530 380"><path d="{path.get("d")}"/></svg>')
        fill(axes, shape.moved(shape.vertices * (1.0, -1.0)), path.get("fill", "none"))


def main() -> None:
    given = arguments(__doc__)
    pixels = boundary_of_pixels(sprite_of(64)[:, :, 3] > 0.5)
    land = coast(64 if given.small else 256)
    drawing = read_svg(FOX)
    shapes = (
        ("a sprite", 12, largest(pixels.moved(pixels.vertices * (1.0, -1.0) + (0.0, 64.0))), sprite),
        ("a coast", 16, largest(land), lambda axes: fill(axes, Mesh.from_loops([shore]), SAND)),
        ("a character", 16, largest(drawing.moved(drawing.vertices * (1.0, -1.0))), character),
    )
    shore = np.array(shapes[1][2].exterior.coords)[:-1]
    figure, panes = panels(6, rows=2, width=4.6, height=4.3)
    for (name, count, shape, draw), above, below in zip(shapes, panes[:3], panes[3:], strict=True):
        cut = simplified(shape, count)
        fine = Mesh.from_loops([np.array(shape.exterior.coords)[:-1]])
        cage = nested_cages(fine, count)[0].cage
        lost = shape.difference(shapely.make_valid(cut))
        print(f"{name}: {count} vertices cut off {100 * lost.area / shape.area:.1f} %, or hold it all")
        for axes in (above, below):
            draw(axes)
        for part in shapely.get_parts(lost):
            above.fill(*np.array(part.exterior.coords).T, facecolor=CUT_OFF, edgecolor=CUT_OFF, linewidth=LOST)
        above.plot(*np.array(cut.exterior.coords).T, color=INK, linewidth=LINE, marker="o", markersize=2.5 * LINE)
        line(below, cage, BLUE, LINE, 5.0 * LINE)
        margin = 0.04 * fine.diagonal
        left, low, right, high = cage.bounds
        for axes in (above, below):
            axes.set_xlim(left - margin, right + margin)
            axes.set_ylim(low - margin, high + margin)
        above.set_title(f"{name}, simplified", size=TITLE, color=INK)
        below.set_title(f"in a cage, also {count} vertices", size=TITLE, color=BLUE)
    save(figure, given.output / "cut_or_held.png")


if __name__ == "__main__":
    main()
