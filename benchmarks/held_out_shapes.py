"""Writes the held-out shapes, benchmarks/data/held_out.json, from packages of npm. The file is in the repository.

    npm pack @mapbox/maki @primer/octicons @svg-maps/italy @svg-maps/mexico @svg-maps/spain @fontsource/alegreya \\
        @fontsource/lobster
    python benchmarks/held_out_shapes.py FOLDER     # with the packages as they were packed

From each source every valid outline of 40 to 300 vertices, in an order drawn at random, until there are enough. No
method was run on them before they were chosen, and none was tuned on them since. Needs fontTools, as matplotlib does.
"""

from __future__ import annotations

import io
import json
import string
import sys
import tarfile
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

import clone  # noqa: F401
from data import HELD_OUT_SHAPES
from data.drawn import glyph
from nestedcages_core import Mesh, NestedCagesError, from_svg

LEAST, MOST = 40, 300
"""Vertices of a shape."""
DIGITS = 3
"""Decimals that are kept, of a drawing scaled to a size of 100."""
SEED = 2026


class Source(NamedTuple):
    """A package, the family that its shapes are of, its licence, and how many are taken."""

    package: str
    family: str
    licence: str
    wanted: int


SOURCES = (
    Source("fontsource-alegreya-5.3.0", "letters", "OFL-1.1", 10),
    Source("fontsource-lobster-5.3.0", "letters", "OFL-1.1", 10),
    Source("mapbox-maki-8.2.0", "icons", "CC0-1.0", 10),
    Source("primer-octicons-19.42.0", "icons", "MIT", 10),
    Source("svg-maps-italy-2.0.0", "maps", "CC-BY-4.0", 6),
    Source("svg-maps-mexico-2.0.0", "maps", "CC-BY-4.0", 7),
    Source("svg-maps-spain-2.0.0", "maps", "CC-BY-4.0", 7),
)


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__)
        return 2
    shapes = []
    with TemporaryDirectory() as fonts:
        for source in SOURCES:
            with tarfile.open(Path(sys.argv[1]) / f"{source.package}.tgz") as package:
                drawn = dict(drawings(source.family, package, Path(fonts)))
            names = sorted(drawn)
            np.random.default_rng(SEED).shuffle(names)
            kept = [line for name in names if (line := outline(source, name, drawn[name])) is not None]
            shapes += kept[: source.wanted]
    HELD_OUT_SHAPES.write_text("[\n" + ",\n".join(map(json.dumps, shapes)) + "\n]\n", encoding="utf-8")
    return 0


def drawings(family: str, package: tarfile.TarFile, fonts: Path) -> Iterator[tuple[str, str]]:
    """Name and SVG of what a package draws; of a font, name of its family and a character."""
    for member in package.getmembers():
        content = package.extractfile(member)
        path = Path(member.name)
        if content is None:
            continue
        if family == "letters" and path.name.endswith("-latin-400-normal.woff"):
            yield from letters(content.read(), fonts / f"{path.stem}.ttf")
        elif family == "maps" and path.suffix == ".svg":
            pieces = content.read().decode("utf-8").split("<path")
            yield from ((piece.split('id="')[1].split('"')[0], f"<svg><path{piece.split('/>')[0]}/></svg>")
                        for piece in pieces[1:])  # fmt: skip
        elif family == "icons" and path.suffix == ".svg" and "symbol" not in path.name:
            yield path.stem, content.read().decode("utf-8")


def letters(woff: bytes, path: Path) -> Iterator[tuple[str, str]]:
    """Names of the letters of a font, which matplotlib can draw from then on."""
    from fontTools.ttLib import TTFont
    from matplotlib import font_manager

    font = TTFont(io.BytesIO(woff))
    font.flavor = None
    font.save(path)
    font_manager.fontManager.addfont(path)
    family = font_manager.FontProperties(fname=path).get_name()
    for character in string.ascii_letters + string.digits + "&?%§ß":
        yield f"{family} {character}", ""


def outline(source: Source, name: str, svg: str) -> dict[str, object] | None:
    """A line of the file; None where the drawing is not a valid mesh of the right size."""
    try:
        mesh = from_svg(svg) if svg else glyph(name[-1], per_curve=6, family=name[:-2])
        points = np.round(100.0 * (mesh.vertices - mesh.vertices.min(axis=0)) / mesh.diagonal, DIGITS)
        loops = [points[loop].tolist() for loop in mesh.loops]
        fits = LEAST <= len(Mesh.from_loops(loops).vertices) <= MOST
    except NestedCagesError:
        return None
    line = {"name": name, "family": source.family, "source": source.package, "licence": source.licence, "loops": loops}
    return line if fits else None


if __name__ == "__main__":
    sys.exit(main())
