"""Transparent pixels that sprites draw: rectangle, convex hull, and the certified hulls of game puppets.

    python benchmarks/overdraw.py [--sprites 20] [--seed 1] [--write]

Takes sprites with an alpha channel and a longer side of 96 to 512 pixels at random from three games in Debian, which it
downloads with apt-get. Overdraw: the area that is drawn beyond opaque pixels, in parts of these. All hulls keep a pixel
of distance from opaque pixels, except the rectangle. --write puts the table into docs/puppets.md.
"""

from __future__ import annotations

import argparse
import random
import time
from itertools import islice
from pathlib import Path

import numpy as np
import shapely

from clone import ROOT
from engines.judge import corners_of
from nestedcages_core import NestedCagesError
from nestedcages_core.exchange.pictures import read_png
from nestedcages_core.game.islands import MARGIN, islands_of
from page import measured
from painted import DEBIAN, fetched

GAMES = ("ardentryst", "endless-sky-data", "fillets-ng-data")
COUNTS = (8, 12, 16, 24)
LEAST_SIDE, MOST_SIDE = 96, 512


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
        islands = islands_of(pixels, 0, 0, count)
        seconds = max(seconds, time.process_time() - start)
        hulls = [shapely.Polygon(island.loop) for island in islands]
        whole = shapely.union_all(hulls)
        shapely.prepare(whole)
        outside += int((~shapely.contains_xy(whole, corners)).sum())
        row.append(sum(hull.area for hull in hulls) / area - 1)
    return row, outside, seconds


def table(everything: list[list[float]], outside: int, failed: int) -> str:
    """The overdraw of all sprites, in percent."""
    names = ("rectangle", "convex hull", *(f"{count} vertices" for count in COUNTS))
    rows = [
        f"| {name} | {np.median(column):.0f} % | {column.mean():.0f} % | {np.quantile(column, 0.9):.0f} % |"
        for name, column in zip(names, 100 * np.array(everything).T, strict=True)
    ]
    games = ", ".join(GAMES)
    said = f"{len(everything)} sprites of {games}; {failed} failed; corners of opaque pixels outside a hull: {outside}."
    return "\n".join(("| around the sprite | median | mean | worst tenth |", "|---|---|---|---|", *rows, "", said))


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--sprites", type=int, default=20, help="of each game")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--write", action="store_true")
    given = options.parse_args()
    lines, everything, failed, outside, seconds = [], [], 0, 0, []
    for game in GAMES:
        files = sorted(path for path in fetched(game, DEBIAN).rglob("*.png") if not path.is_symlink())
        random.Random(given.seed).shuffle(files)
        sprites = ((path, pixels) for path in files if (pixels := usable(path)) is not None)
        for path, pixels in islice(sprites, given.sprites):
            try:
                row, beyond, took = overdraw_of(pixels)
            except NestedCagesError as error:
                failed += 1
                lines.append(f"{game} {path.name}: {error}")
                continue
            everything.append(row)
            outside += beyond
            seconds.append(took)
            lines.append(f"{game} {path.name}: {', '.join(f'{100 * part:.0f}' for part in row)} %, {took:.1f} s")
    shown = table(everything, outside, failed)
    lines += [shown, f"CPU of the slowest count: median {np.median(seconds):.2f} s, worst {max(seconds):.2f} s"]
    print("\n".join(lines))
    if given.write:
        command = f"python benchmarks/overdraw.py --sprites {given.sprites} --seed {given.seed} --write"
        measured(ROOT / "docs" / "puppets.md", "overdraw", command, "\n".join(lines), shown)


if __name__ == "__main__":
    main()
