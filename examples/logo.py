"""A logo from SVG: overlapping shapes, holes and curves become one outline, cages go back to SVG in the same units.

Run as ``python examples/logo.py``; reads examples/logo.svg.
"""

from __future__ import annotations

from pathlib import Path

from nestedcages_core import Settings, nested_cages, read_svg, write_svg
from plot import BLUE, BODY, INK, RED, arguments, fill, line, panels, save

LOGO = Path(__file__).resolve().parent / "logo.svg"
TOLERANCE = 0.05  # distance between curves and their chords, in user units of the drawing
COUNTS = (64, 24)


def main() -> None:
    given = arguments(__doc__)
    fine = read_svg(LOGO, tolerance=0.5 if given.small else TOLERANCE)
    # what is enclosed with this clearance is enclosed with its curves, not only with their chords
    hierarchy = nested_cages(fine, COUNTS, Settings(clearance=1.5 * TOLERANCE))
    print(f"The logo has {len(fine.vertices)} vertices in {len(fine.loops)} loops")
    for level in hierarchy.levels:
        print(f"{len(level.cage.vertices):4d} vertices: {level.report}")
    write_svg(given.output / "logo_cages.svg", [fine, *hierarchy.cages], view_box=(0, 0, 200, 200))
    print(f"Wrote {given.output / 'logo_cages.svg'}")

    figure, axes = panels(2)
    for each, cages in zip(axes, ((), hierarchy.cages), strict=True):
        for cage, colour in reversed(list(zip(cages, (BLUE, RED), strict=False))):
            fill(each, cage, colour, 0.12)
            line(each, cage, colour, 1.8, 7.0)
        fill(each, fine, BODY)
        line(each, fine, INK, 1.0)
        each.invert_yaxis()
    axes[0].set_title(f"logo.svg, united: {len(fine.vertices)} vertices")
    axes[1].set_title(f"cages of {COUNTS[0]} and {COUNTS[1]} vertices")
    save(figure, given.output / "logo.png")


if __name__ == "__main__":
    main()
