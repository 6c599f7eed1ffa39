"""Transparent pixels that sprites of three games draw: as rectangles, convex hulls, and hulls of game puppets.

Sprites with an alpha channel and a longer side of 96 to 512 pixels, drawn at random (`--seed`) from packages of Debian.
Overdraw is the area that is drawn beyond opaque pixels, in parts of these. All but rectangles keep a pixel of distance.
"""

from __future__ import annotations

import random
import time
from itertools import islice
from pathlib import Path

import numpy as np
import shapely

from common import DETAILS, Options, table
from files import fetched
from nestedcages_core import NestedCagesError, read_png
from nestedcages_core.puppets.engines.hulls import MARGIN, islands_of
from puppet_engines import corners_of

GAMES = ("ardentryst", "endless-sky-data", "fillets-ng-data")
COUNTS = (8, 12, 16, 24)
LEAST_SIDE, MOST_SIDE = 96, 512
SPRITES, FEW = 30, 3
"""Of each game, and in a quick run."""


def usable(path: Path) -> np.ndarray | None:
    """The picture, if it is a sprite of the sizes that are measured."""
    try:
        pixels = read_png(path)
    except (NestedCagesError, OSError):
        return None
    opaque = pixels[..., 3] > 0
    fits = LEAST_SIDE <= max(opaque.shape) <= MOST_SIDE
    return pixels if fits and opaque.any() and not opaque.all() else None


def overdraw_of(pixels: np.ndarray) -> tuple[list[float], int, float]:
    """Overdraw of each way, corners of opaque pixels outside of our hulls, and the CPU time of the slowest count."""
    opaque = pixels[..., 3] > 0
    rows, columns = np.nonzero(opaque)
    area, corners = float(opaque.sum()), corners_of(opaque)
    box = float((np.ptp(rows) + 1) * (np.ptp(columns) + 1))
    convex = shapely.MultiPoint(corners).convex_hull.buffer(MARGIN, join_style="mitre").area
    row, outside, seconds = [box / area - 1, convex / area - 1], 0, 0.0
    for count in COUNTS:
        start = time.process_time()
        hulls = [shapely.Polygon(island.loop) for island in islands_of(pixels, 0, 0, count)]
        seconds = max(seconds, time.process_time() - start)
        whole = shapely.union_all(hulls)
        shapely.prepare(whole)
        outside += int((~shapely.contains_xy(whole, corners)).sum())
        row.append(sum(hull.area for hull in hulls) / area - 1)
    return row, outside, seconds


def run(options: Options) -> str:
    """Median, mean and worst tenth; then each sprite."""
    rows, found, failed, outside, seconds = [], [], 0, 0, []
    for game in GAMES:
        files = sorted(path for path in fetched(game, debian=True).rglob("*.png") if not path.is_symlink())
        random.Random(options.seed).shuffle(files)
        sprites = ((path, pixels) for path in files if (pixels := usable(path)) is not None)
        for path, pixels in islice(sprites, FEW if options.quick else SPRITES):
            try:
                row, beyond, took = overdraw_of(pixels)
            except NestedCagesError as error:
                failed += 1
                rows.append((game, path.name, *["-"] * (len(COUNTS) + 2), error.code))
                continue
            found.append(row)
            outside += beyond
            seconds.append(took)
            rows.append((game, path.name, *(f"{100 * part:.0f}" for part in row), f"{took:.1f} s"))
    names = ("rectangle", "convex hull", *(f"{count} vertices" for count in COUNTS))
    shown = [
        (name, *(f"{each:.0f} %" for each in (np.median(column), column.mean(), np.quantile(column, 0.9))))
        for name, column in zip(names, 100 * np.array(found).T, strict=True)
    ]
    return (
        f"{table(('around the sprite', 'median', 'mean', 'worst tenth'), shown)}\n\n"
        f"{len(found)} sprites of {', '.join(GAMES)}; {failed} failed;\n"
        f"corners of opaque pixels outside a hull: {outside}.\n\n{DETAILS}\n\n"
        f"CPU of the slowest count: median {np.median(seconds):.2f} s, worst {max(seconds):.2f} s\n\n"
        f"{table(('game', 'sprite', *(f'{name}, %' for name in names), 'CPU'), rows)}"
    )
