"""The regions of a country simplified: a cage around the land, divided along borders that are simplified once.

Run as ``python examples/regions.py``. The country is the land of examples/coast.py, divided along crooked borders that
neighbours share. No land is cut off the coast, and regions leave no gap and do not overlap.
"""

from __future__ import annotations

import json

import numpy as np
import shapely
from contourpy import contour_generator

from coast import heights, outside, rugged
from nestedcages_core import Mesh, coverage_cages
from plot import INK, QUIET, RED, arguments, fill, line, panels, save

REGIONS = 24
SHARE = "8%"  # vertices of the cage, as a share of the coast's
CROOKED = 0.035  # how far borders stray from straight lines, by the size of the map
LEAST_AREA = 2e-4  # parts of a region below this share of the map are left out
PALE = ("#c3cfdf", "#d9e4c8", "#f1ddc4", "#e5d0df", "#cfe3e6", "#eee3b8")


def divided(size: int, count: int) -> dict[str, Mesh]:
    """That many regions by name; neighbours meet in the very same points along their common border."""
    land = np.pad(heights(size), 1, constant_values=-10.0)
    place = np.linspace(0.0, 1.0, size + 2)
    x, y = np.meshgrid(place, place)
    inland = np.argwhere(land > 0.3)
    rng = np.random.default_rng(5)
    chosen = [inland[rng.integers(len(inland))]]
    while len(chosen) < count:  # each capital as far as possible from the others
        gaps = np.min([((inland - other) ** 2).sum(axis=1) for other in chosen], axis=0)
        chosen.append(inland[np.argmax(gaps)])
    stray_x, stray_y = (CROOKED * np.pad(heights(size, seed), 1, mode="edge") for seed in (3, 4))
    x, y = x + stray_x, y + stray_y
    away = np.array([np.hypot(x - x[row, column], y - y[row, column]) for row, column in chosen])
    regions = {}
    for k, own in enumerate(away):
        others = np.delete(away, k, axis=0).min(axis=0)
        inside = np.where(land > 0.0, others - own, np.minimum(land, others - own))
        loops = contour_generator(place, place, inside, line_type="Separate").lines(0.0)
        areas = [abs((loop[:-1, 0] * loop[1:, 1] - loop[1:, 0] * loop[:-1, 1]).sum()) / 2.0 for loop in loops]
        kept = [loop[:-1] for loop, area in zip(loops, areas, strict=True) if area > LEAST_AREA]
        if kept:
            regions[f"Region {len(regions) + 1}"] = Mesh.from_loops(kept)
    return regions


def main() -> None:
    given = arguments(__doc__)
    regions = divided(96 if given.small else 512, 5 if given.small else REGIONS)
    (found,) = coverage_cages(list(regions.values()), SHARE)
    simple = {name: Mesh.of(region) for name, region in zip(regions, found.regions, strict=True)}
    for region in regions.values():
        assert not outside(region, found.coast.cage).any()
    before = len(np.unique(np.concatenate([region.vertices for region in regions.values()]), axis=0))
    print(f"{len(regions)} regions of {before} points; simplified {found.points}, all land inside: {found.coast}")
    print(f"Borders moved by at most {found.width:.3g} of the map's size")
    features = [
        {"type": "Feature", "properties": {"name": name}, "geometry": shapely.geometry.mapping(region)}
        for name, region in zip(regions, found.regions, strict=True)
    ]
    text = json.dumps({"type": "FeatureCollection", "features": features})
    (given.output / "regions.geojson").write_text(text, encoding="utf-8")
    print(f"Wrote {given.output / 'regions.geojson'}")

    figure, axes = panels(3, width=5.2, height=5.6)
    colours = [PALE[k % len(PALE)] for k in range(len(regions))]
    for each in axes[::2]:
        for region, colour in zip(regions.values(), colours, strict=True):
            fill(each, region, colour)
            line(each, region, QUIET, 0.5)
    for each, width in zip(axes[1:], (1.0, 1.8), strict=True):
        for mesh, colour in zip(simple.values(), colours, strict=True):
            if each is axes[1]:
                fill(each, mesh, colour)
            line(each, mesh, INK, width)
    window = rugged(next(iter(regions.values())), 0.25)
    axes[1].plot(np.take(window, [0, 1, 1, 0, 0]), np.take(window, [2, 2, 3, 3, 2]), color=RED, linewidth=1.2)
    axes[0].set_title(f"{len(regions)} regions, {before} points")
    axes[1].set_title(f"simplified: {found.points} points, no gap, no overlap")
    axes[2].set_title("coasts outside, borders simplified once")
    axes[2].set_autoscale_on(False)
    axes[2].axis(window)
    save(figure, given.output / "regions.png")


if __name__ == "__main__":
    main()
