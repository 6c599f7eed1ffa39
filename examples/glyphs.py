"""Five hundred glyphs of a font, each in its own cage, made by several processes.

Run as ``python examples/glyphs.py``; the font is DejaVu Sans, which matplotlib brings along.
"""

from __future__ import annotations

import time
from concurrent.futures import ProcessPoolExecutor
from os import cpu_count

import numpy as np
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath

from nestedcages_core import BatchProgress, Hierarchy, InvalidMeshError, Mesh, from_svg, nested_cages_many
from plot import BLUE, BODY, INK, arguments, fill, line, panels, save

COUNT, VERTICES = 500, 12  # glyphs; vertices per loop of each cage
FONT = FontProperties(family="DejaVu Sans")
SIZE = 100.0  # of the em square


def path_data(outline: Outline) -> str:
    """The outline in the path language of SVG."""
    letters = {Outline.MOVETO: "M", Outline.LINETO: "L", Outline.CURVE3: "Q", Outline.CURVE4: "C"}
    parts = []
    for points, code in outline.iter_segments(curves=True, simplify=False):
        parts.append("Z" if code == Outline.CLOSEPOLY else letters[code] + " ".join(f"{x:.4f}" for x in points))
    return " ".join(parts)


def glyphs(count: int) -> dict[str, Mesh]:
    """That many glyphs by their character; those that are empty or touch themselves are left out."""
    found: dict[str, Mesh] = {}
    for code in sorted(get_font(findfont(FONT)).get_charmap()):
        character = chr(code)
        if len(found) == count:
            break
        if not character.isalnum():
            continue
        data = path_data(TextPath((0, 0), character, size=SIZE, prop=FONT))
        try:
            found[character] = from_svg(f'<svg><path d="{data}"/></svg>')
        except InvalidMeshError:
            continue
    return found


def vertices(mesh: Mesh) -> list[int]:
    """The level for a glyph: as many vertices for every loop, none more than it has."""
    return [min(VERTICES * len(mesh.loops), len(mesh.vertices))]


def cage(hierarchy: Hierarchy) -> Mesh:
    return hierarchy.cages[0]


def show(progress: BatchProgress) -> None:
    if progress.finished % 100 == 0:
        print(f"{progress.finished} of {progress.total} glyphs")


def main() -> None:
    given = arguments(__doc__)
    shapes = glyphs(12 if given.small else COUNT)
    began = time.perf_counter()
    with ProcessPoolExecutor(min(cpu_count() or 1, 8)) as pool:
        outcomes = nested_cages_many(shapes, vertices, executor=pool, progress=show, keep=cage)
    failed = [outcome for outcome in outcomes if outcome.error is not None]
    for outcome in failed:
        print(f"{outcome.key}: {outcome.error}")
    excess = np.median([outcome.unwrap().area / shapes[outcome.key].area - 1 for outcome in outcomes if outcome.result])
    print(f"{len(outcomes)} glyphs, {len(failed)} failed, {time.perf_counter() - began:.1f} s,", end=" ")
    print(f"{100 * excess:.1f} % larger in the median")

    columns = 6 if given.small else 25
    figure, (axes,) = panels(1, width=16.0, height=14.0 * len(outcomes) / columns**2 + 1.0)
    for k, outcome in enumerate(outcomes):
        corner = SIZE * np.array([(k % columns) * 1.6, -(k // columns) * 1.4])
        glyph = shapes[outcome.key]
        fill(axes, glyph.moved(glyph.vertices + corner), BODY)
        if outcome.result is not None:
            line(axes, outcome.result.moved(outcome.result.vertices + corner), BLUE, 0.7)
    axes.set_title(f"{len(outcomes)} glyphs of DejaVu Sans, {VERTICES} vertices for every loop", color=INK)
    save(figure, given.output / "glyphs.png")


if __name__ == "__main__":
    main()
