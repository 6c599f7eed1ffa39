"""The area of a warning around an island: at most thirty points, all land and five kilometres of sea, six decimals.

Run as ``python examples/warning_area.py``; needs shapely and matplotlib. Next to it, the usual recipe: buffer, simplify
until there are few enough points, round. The coast of Sri Lanka is Natural Earth's, 1:10 million, public domain.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import shapely

from nestedcages_core import check, nested_cages, read_geojson, write_geojson
from plot import BLUE, INK, arguments, fill, line, panels, save

COAST = Path(__file__).with_name("sri_lanka.geojson")
POINTS, DECIMALS = 30, 6
SEA = 0.045  # degrees, about five kilometres
LAND, MISSED = "#d8cba8", "#d1005a"
HALVINGS = 40


def recipe(wanted: shapely.Geometry) -> shapely.Geometry:
    """The buffered land simplified until it has few enough points, and rounded."""
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        tolerance = (low + high) / 2.0
        few = shapely.get_num_coordinates(wanted.simplify(tolerance)) <= POINTS
        low, high = (low, tolerance) if few else (tolerance, high)
    simple = wanted.simplify(high)
    return shapely.transform(simple, lambda points: np.round(points, DECIMALS))


def main() -> None:
    given = arguments(__doc__)
    land = read_geojson(COAST)
    area = nested_cages(land, POINTS, clearance=SEA, grid=10.0**-DECIMALS)[0]
    assert check(land, area.cage, clearance=SEA, grid=10.0**-DECIMALS, same_loops=False)
    write_geojson(given.output / "warning_area.geojson", area.cage, decimals=DECIMALS)
    wanted = shapely.geometry.shape(land).buffer(SEA)
    usual = recipe(wanted)
    left_out = wanted.difference(usual)
    print(f"Warning area: {area}; {'; '.join(area.report.notes)}")
    print(f"The recipe leaves out {100.0 * left_out.area / wanted.area:.2f} % of the area that is to be warned")
    print(f"Wrote {given.output / 'warning_area.geojson'}")

    figure, (left, right) = panels(2, width=4.5, height=6.0)
    for axes in (left, right):
        axes.fill(*np.array(shapely.get_parts(wanted)[0].exterior.coords).T, color="#e7eef5")
        fill(axes, land, LAND)
    for part in shapely.get_parts(left_out):
        left.fill(*np.array(part.exterior.coords).T, facecolor=MISSED, edgecolor=MISSED, linewidth=0.8)
    for part in shapely.get_parts(usual):
        left.plot(*np.array(part.exterior.coords).T, color=INK, marker=".")
    line(right, area.cage, BLUE, 1.8, 8.0)
    left.set_title("buffered, simplified: parts get no warning", color=INK)
    right.set_title(f"a cage of {len(area.vertices)} points: nobody is left out", color=BLUE)
    save(figure, given.output / "warning_area.png")


if __name__ == "__main__":
    main()
