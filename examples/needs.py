"""One drawing, and cages for what they are needed for: inside and outside, within a distance, on a grid, convex, ...

Run as ``python examples/needs.py``; the drawing is a starfish with a hole.
"""

from __future__ import annotations

import numpy as np

from nestedcages_core import (
    Found,
    Mesh,
    Settings,
    Within,
    convex_pieces,
    inner_cages,
    nested_cages,
    verify,
    write_svg,
)
from plot import BLUE, BODY, INK, LEVELS, ORANGE, arguments, fill, line, panels, save

GRID, DISTANCE, MARGIN = 0.125, 0.08, 0.06  # in the drawing's units, of which it is some 2.5 wide


def starfish(count: int) -> Mesh:
    """A round shape with five arms that is symmetric but for ripples, and a hole."""
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    radius = 1.0 + 0.28 * np.cos(5 * angles - np.pi / 2) + 0.012 * np.sin(23 * angles)
    ring = np.linspace(0.0, 2.0 * np.pi, count // 4, endpoint=False)
    hole = 0.35 * np.column_stack((np.cos(ring), np.sin(ring)))
    return Mesh.from_loops([radius[:, None] * np.column_stack((np.cos(angles), np.sin(angles))), hole])


def main() -> None:
    given = arguments(__doc__)
    fine = starfish(120 if given.small else 400)
    outer = nested_cages(fine, [24]).cages[0]
    inner = inner_cages(fine, [24]).cages[0]
    safe = inner_cages(fine, [32], Settings(clearance=MARGIN)).cages[0]
    near = nested_cages(fine, [Within(distance=DISTANCE)]).levels[0]
    grid = nested_cages(fine, [24], Settings(grid=GRID)).cages[0]
    convex = nested_cages(fine, [6], Settings(convex=True)).cages[0]
    alike = nested_cages(fine, [26], Settings(symmetry=Found())).levels[0]
    weights = np.where(fine.vertices[:, 1] > 0.0, 1.0, 0.02)
    upper = nested_cages(fine, [24], Settings(weights=weights)).cages[0]
    assert verify(outer, fine)
    assert verify(fine, inner)
    assert verify(fine, safe, MARGIN)
    assert verify(convex, fine, same_loops=False)
    assert all(verify(cage, fine) for cage in (near.cage, grid, alike.cage, upper))
    pieces = convex_pieces(outer, most=8)
    print(f"area {fine.area:.4f}, between {inner.area:.4f} inside and {outer.area:.4f} outside, with 24 vertices each")
    print(f"within {DISTANCE}: {len(near.cage.vertices)} vertices, none has fewer than {near.report.fewest}")
    print(alike.report.notes[0])
    write_svg(given.output / "needs.svg", {"fine": fine, "inner": inner, "outer": outer})
    print(f"Wrote {given.output / 'needs.svg'}")

    shown = (
        ("inside and outside: 24 vertices each", (outer, inner)),
        (f"a safe area: {MARGIN} inside", (safe,)),
        (f"within {DISTANCE}: {len(near.cage.vertices)} vertices", (near.cage,)),
        (f"on a grid of {GRID}", (grid,)),
        ("convex: 6 vertices", (convex,)),
        (f"symmetric: {len(alike.cage.vertices)} vertices", (alike.cage,)),
        ("where it matters: above", (upper,)),
        (f"{len(pieces)} convex pieces of at most 8", ()),
    )
    figure, axes = panels(len(shown), width=3.2, height=3.3, rows=2)
    for each, (title, cages) in zip(axes, shown, strict=True):
        if cages:
            fill(each, fine, BODY)
            line(each, fine, INK, 0.7)
        for cage, colour in zip(cages, (BLUE, ORANGE), strict=False):
            line(each, cage, colour, 1.5, 4.0)
        each.set_title(title, fontsize=9)
    for k, piece in enumerate(pieces):
        fill(axes[-1], Mesh.from_loops([piece]), LEVELS[k % len(LEVELS)], 0.35)
        line(axes[-1], Mesh.from_loops([piece]), INK, 0.7)
    low, high = np.floor(outer.vertices.min(axis=0) / GRID), np.ceil(outer.vertices.max(axis=0) / GRID)
    x, y = (GRID * part for part in np.meshgrid(*map(np.arange, low, high + 1)))
    axes[3].plot(x.ravel(), y.ravel(), ".", color=INK, markersize=1.0)
    save(figure, given.output / "needs.png")


if __name__ == "__main__":
    main()
