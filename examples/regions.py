"""The regions of a country, each in its own cage: fewer points, and no place is cut off its region.

Run as ``python examples/regions.py``. The country is the land of examples/coast.py, divided along crooked borders that
neighbours share; all cages are made by several processes. Then the cages are cut at the borders, which leaves next
to no overlap.
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from os import cpu_count

import numpy as np
from contourpy import contour_generator

from coast import heights, outside, rugged
from nestedcages_core import Feature, Hierarchy, Mesh, cut_at_borders, nested_cages_many, verify, write_geojson
from plot import INK, LEVELS, QUIET, arguments, fill, line, panels, save

REGIONS = 24
SHARE = 0.08  # vertices of a cage, as a share of its region's
LEAST = 8  # vertices for every loop of a region
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


def level(region: Mesh) -> list[int]:
    return [max(round(SHARE * len(region.vertices)), LEAST * len(region.loops))]


def cage(hierarchy: Hierarchy) -> Mesh:
    return hierarchy.cages[0]


def main() -> None:
    given = arguments(__doc__)
    regions = divided(96 if given.small else 512, 5 if given.small else REGIONS)
    with ProcessPoolExecutor(min(cpu_count() or 1, 8)) as pool:
        outcomes = nested_cages_many(regions, level, executor=pool, keep=cage)
    cages = {outcome.key: outcome.unwrap() for outcome in outcomes}
    cuts = dict(zip(regions, cut_at_borders(list(cages.values()), list(regions.values())), strict=True))
    bordered = {name: cut.cage for name, cut in cuts.items()}
    for name, region in regions.items():
        assert not outside(region, cages[name]).any()
        assert verify(bordered[name], region, same_loops=False)
    before, after, exact = (
        sum(len(mesh.vertices) for mesh in meshes.values()) for meshes in (regions, cages, bordered)
    )
    land = sum(region.area for region in regions.values())
    wide, thin = (sum(getattr(cut, name) for cut in cuts.values()) / land for name in ("overlap_before", "overlap"))
    print(f"{len(regions)} regions of {before} vertices in cages of {after}; every point is inside its region's cage")
    print(f"Cages cover {wide:.2%} of their neighbours; cut at the borders {thin:.5%}, with {exact} vertices")
    write_geojson(given.output / "regions.geojson", [Feature(mesh, {"name": name}) for name, mesh in bordered.items()])
    print(f"Wrote {given.output / 'regions.geojson'}")

    figure, axes = panels(4, width=5.2, height=5.6)
    colours = [PALE[k % len(PALE)] for k in range(len(regions))]
    for each in axes:
        for region, colour in zip(regions.values(), colours, strict=True):
            fill(each, region, colour)
            line(each, region, QUIET, 0.5)
    for each, width, shown in zip(axes[1:], (0.8, 1.8, 1.8), (cages, cages, bordered), strict=True):
        for k, made in enumerate(shown.values()):
            line(each, made, LEVELS[k % len(LEVELS)], width)
    window = rugged(next(iter(regions.values())), 0.25)
    axes[1].plot(np.take(window, [0, 1, 1, 0, 0]), np.take(window, [2, 2, 3, 3, 2]), color=INK, linewidth=0.8)
    axes[0].set_title(f"{len(regions)} regions, {before} vertices")
    axes[1].set_title(f"a cage around each, {after} vertices")
    axes[2].set_title("cages overlap where borders were: no place is lost")
    axes[3].set_title("cut at the borders: coarse coasts, exact borders")
    for each in axes[2:]:
        each.set_autoscale_on(False)
        each.axis(window)
    save(figure, given.output / "regions.png")


if __name__ == "__main__":
    main()
