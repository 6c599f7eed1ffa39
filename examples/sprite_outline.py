"""A sprite's collision outline: a PNG goes in, sixteen vertices come out, and no opaque pixel is outside.

Run as ``python examples/sprite_outline.py``; writes a sprite, its outline in pixels as GeoJSON, and a picture.
"""

from __future__ import annotations

import matplotlib.image
import numpy as np

from nestedcages_core import boundary_of_pixels, collision_outline, read_png, write_geojson
from plot import BLUE, GREEN, QUIET, arguments, line, panels, save

VERTICES, PADDING = 16, 1.0  # of the outline; distance in pixels
COAT, BELLY, DARK = (0.93, 0.55, 0.20), (0.99, 0.87, 0.68), (0.20, 0.16, 0.22)


def fox(size: int) -> np.ndarray:
    """(size, size, 4) a sitting fox with a soft edge, drawn by distances to circles and capsules."""
    y, x = (np.indices((size, size)) + 0.5) / size

    def capsule(ax: float, ay: float, bx: float, by: float, start: float, end: float) -> np.ndarray:
        """Negative inside; the radius goes from `start` at a to `end` at b."""
        t = (((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2)).clip(0.0, 1.0)
        return np.hypot(x - ax - t * (bx - ax), y - ay - t * (by - ay)) - (start + t * (end - start))

    tail = np.minimum(capsule(0.60, 0.86, 0.83, 0.75, 0.07, 0.10), capsule(0.83, 0.75, 0.80, 0.50, 0.10, 0.015))
    body = np.minimum(capsule(0.42, 0.55, 0.50, 0.80, 0.10, 0.15), capsule(0.36, 0.60, 0.33, 0.92, 0.05, 0.035))
    head = np.minimum(capsule(0.42, 0.38, 0.40, 0.38, 0.14, 0.14), capsule(0.36, 0.42, 0.19, 0.46, 0.10, 0.02))
    ears = np.minimum(capsule(0.34, 0.28, 0.29, 0.10, 0.06, 0.008), capsule(0.49, 0.28, 0.56, 0.11, 0.06, 0.008))
    solid = np.minimum(np.minimum(tail, body), np.minimum(head, ears))

    def cover(inside: np.ndarray) -> np.ndarray:
        return (0.5 - inside * size).clip(0.0, 1.0)[:, :, None]

    picture = np.zeros((size, size, 4))
    picture[:, :, :3] = COAT
    light = np.minimum(capsule(0.83, 0.70, 0.80, 0.50, 0.08, 0.015), capsule(0.38, 0.60, 0.42, 0.80, 0.05, 0.07))
    light = np.minimum(light, capsule(0.34, 0.46, 0.20, 0.47, 0.06, 0.02))
    eyes = np.minimum(np.hypot(x - 0.31, y - 0.36) - 0.018, np.hypot(x - 0.45, y - 0.36) - 0.018)
    dark = np.minimum(np.minimum(eyes, np.hypot(x - 0.175, y - 0.455) - 0.022), np.abs(solid + 0.006) - 0.006)
    for part, colour in ((light, BELLY), (dark, DARK)):
        picture[:, :, :3] += cover(part) * (np.array(colour) - picture[:, :, :3])
    picture[:, :, 3:] = cover(solid)
    return picture


def main() -> None:
    given = arguments(__doc__)
    size = 48 if given.small else 128
    sprite_file = given.output / "fox.png"
    matplotlib.image.imsave(sprite_file, fox(size))

    sprite = read_png(sprite_file)
    outline = collision_outline(sprite, VERTICES, padding=PADDING)
    pixels = {"y": "down", "width": size, "height": size}
    write_geojson(given.output / "fox_outline.geojson", outline, pixels=pixels, pieces=8)

    opaque = sprite[:, :, 3] > 0
    exact = boundary_of_pixels(opaque)
    print(f"{opaque.sum()} opaque pixels, whose boundary has {len(exact.vertices)} corners")
    print(f"Outline: {len(outline.vertices)} vertices, {100 * (outline.area / exact.area - 1):.1f} % larger")
    print(f"Wrote {given.output / 'fox_outline.geojson'}")

    figure, (left, right) = panels(2)
    for axes in (left, right):
        axes.imshow(sprite, extent=(0, size, size, 0), interpolation="nearest")
    line(left, exact, QUIET, 1.0)
    left.set_title(f"opaque pixels: {len(exact.vertices)} corners")
    line(right, outline, BLUE, 2.0, 9.0)
    low_x, low_y, high_x, high_y = outline.bounds
    right.axis((low_x - 2, high_x + 2, high_y + 2, low_y - 2))
    left.axis(right.axis())
    right.set_title(f"collision outline: {VERTICES} vertices, {PADDING:g} pixel of padding", color=GREEN)
    save(figure, given.output / "sprite_outline.png")


if __name__ == "__main__":
    main()
