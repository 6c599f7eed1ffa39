"""Five levels around one drawing: each cage encloses the one before with about half of its vertices.

Run as ``python examples/five_levels.py``; reads examples/letter_a.svg.
"""

from __future__ import annotations

from pathlib import Path

from nestedcages_core import nested_cages, read_svg, verify, write_svg
from plot import BODY, INK, LEVELS, arguments, fill, line, panels, save

DRAWING = Path(__file__).resolve().parent / "letter_a.svg"
COUNTS = (128, 72, 40, 22, 12)


def main() -> None:
    given = arguments(__doc__)
    fine = read_svg(DRAWING)
    hierarchy = nested_cages(fine, COUNTS[2:] if given.small else COUNTS)
    for level in hierarchy.levels:
        print(f"{len(level.cage.vertices):4d} vertices: {level.report}")
        assert verify(level.cage, fine)
    write_svg(given.output / "five_levels.svg", [fine, *hierarchy.cages])
    print(f"Wrote {given.output / 'five_levels.svg'}")

    figure, axes = panels(len(hierarchy.levels) + 1, width=2.8, height=3.2)
    for k, each in enumerate(axes):
        shown = list(zip(hierarchy.cages, LEVELS, strict=False))
        for cage, colour in reversed(shown if k == 0 else shown[k - 1 : k]):
            fill(each, cage, colour, 0.15)
            line(each, cage, colour, 1.5, 4.0)
        fill(each, fine, BODY)
        line(each, fine, INK, 0.8)
        each.update_datalim(hierarchy.cages[-1].vertices)
        each.autoscale_view()
        each.invert_yaxis()  # drawings count y downwards
        each.set_title("all" if k == 0 else f"{len(hierarchy.cages[k - 1].vertices)} vertices")
    save(figure, given.output / "five_levels.png")


if __name__ == "__main__":
    main()
