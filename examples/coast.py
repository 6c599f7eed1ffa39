"""A coast generalised for a map with nothing cut off: every point of land stays inside, islands and lakes are kept.

Run as ``python examples/coast.py``; the land is where random heights of all scales rise above the sea.
"""

from __future__ import annotations

import numpy as np
from contourpy import contour_generator
from matplotlib.path import Path as Outline
from scipy.spatial import cKDTree

from nestedcages_core import ArcLength, Mesh, nested_cages, write_geojson
from plot import BLUE, BODY, INK, RED, arguments, fill, line, panels, save

ROUGHNESS = 1.65  # heights of wave number k are of the size k to the minus this
LEAST_AREA = 2e-4  # islands and lakes below this share of the map are not drawn at that scale anyway


def heights(size: int, seed: int = 11) -> np.ndarray:
    """(size, size) random heights with features of all sizes, sinking towards the edge of the map."""
    rng = np.random.default_rng(seed)
    waves = np.fft.fftfreq(size, 1.0 / size)
    scale = np.hypot(waves[:, None], waves[None])
    scale[0, 0] = np.inf
    # the same coast at every size: random numbers belong to wave numbers, the low ones first
    low = min(size, 64)
    noise = rng.normal(size=(low, low)) + 1j * rng.normal(size=(low, low))
    spectrum = (rng.normal(size=(size, size)) + 1j * rng.normal(size=(size, size))) if size > low else noise.copy()
    half = low // 2
    rows = np.r_[0:half, size - half : size]
    spectrum[np.ix_(rows, rows)] = noise
    land = np.fft.ifft2(spectrum * scale**-ROUGHNESS).real
    land /= land.std()
    y, x = np.indices((size, size)) / (size - 1) * 2.0 - 1.0
    return land + 1.1 - 3.2 * np.hypot(x, y) ** 3


def coast(size: int) -> Mesh:
    """The shore lines of all land that is large enough, on the unit square."""
    land = np.pad(heights(size), 1, constant_values=-10.0)
    place = np.linspace(0.0, 1.0, size + 2)
    loops = contour_generator(place, place, land, line_type="Separate").lines(0.0)
    areas = [abs((loop[:-1, 0] * loop[1:, 1] - loop[1:, 0] * loop[:-1, 1]).sum()) / 2.0 for loop in loops]
    return Mesh.from_loops([loop[:-1] for loop, area in zip(loops, areas, strict=True) if area > LEAST_AREA])


def outside(fine: Mesh, outline: Mesh) -> np.ndarray:
    """(n,) which shore points an outline does not contain."""
    crossed = np.zeros(len(fine.vertices), dtype=int)
    for loop in outline.loops:
        crossed += Outline(outline.vertices[np.append(loop, loop[0])], closed=True).contains_points(fine.vertices)
    return crossed % 2 == 0


def rugged(fine: Mesh, width: float) -> tuple[float, float, float, float]:
    """A square window around the place with most shore."""
    near = cKDTree(fine.vertices)
    around = near.query_ball_point(fine.vertices, 0.4 * width, return_length=True)
    x, y = fine.vertices[np.argmax(around)]
    return x - width / 2, x + width / 2, y - width / 2, y + width / 2


def main() -> None:
    given = arguments(__doc__)
    fine = coast(64 if given.small else 512)
    counts = (120, 60) if given.small else (800, 200)
    hierarchy = nested_cages(fine, counts)
    for level in hierarchy.levels:
        print(f"{len(level.cage.vertices)} vertices: {level.report}")
        assert not outside(fine, level.cage).any()
    write_geojson(given.output / "coast.geojson", list(hierarchy.cages))
    print(f"Wrote {given.output / 'coast.geojson'}")

    figure, axes = panels(3, width=5.2, height=5.6)
    for each in axes:
        fill(each, fine, BODY)
        line(each, fine, INK, 0.5)
    for each, width in zip(axes[:2], (0.7, 1.6), strict=True):
        line(each, hierarchy.cages[0], BLUE, width)
        line(each, hierarchy.cages[1], RED, 1.4 * width, 6.0 * width)
    window = rugged(fine, 0.25)
    axes[0].plot(np.take(window, [0, 1, 1, 0, 0]), np.take(window, [2, 2, 3, 3, 2]), color=INK, linewidth=0.8)
    axes[0].set_title(f"a coast of {len(fine.vertices)} vertices in cages of {counts[0]} and {counts[1]}")
    axes[1].set_title("nothing is cut off")
    simplified = ArcLength().decimate(fine, counts[0])
    lost = outside(fine, simplified)
    print(f"{counts[0]} points evenly along the shore would leave {lost.sum()} of {len(lost)} shore points outside")
    line(axes[2], simplified, BLUE, 1.6)
    axes[2].plot(*fine.vertices[lost].T, ".", color=RED, markersize=4.0)
    axes[2].set_title(f"{counts[0]} points along the shore: {lost.sum()} cut off")
    for each in axes[1:]:
        each.set_autoscale_on(False)
        each.axis(window)
    save(figure, given.output / "coast.png")


if __name__ == "__main__":
    main()
