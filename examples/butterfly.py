"""A butterfly drawn by hand: a free cage, a symmetric one, one that is tighter at the head, and one with pinned tips.

Run as ``python examples/butterfly.py``.
"""

from __future__ import annotations

import numpy as np

from nestedcages_core import DetectSymmetry, Mesh, Settings, nested_cages, verify, write_svg
from plot import BLUE, BODY, GREEN, INK, ORANGE, RED, arguments, fill, line, panels, save

COUNT = 24
SHAKE = 0.012  # how far the hand is off, in units of the drawing
FINEST = 12  # points per corner of the sketch
HEAD = 0.9  # height above which the drawing is head and feelers

SKETCH = [
    (0.0, 1.25), (0.1, 1.22), (0.32, 1.75), (0.38, 1.7), (0.16, 1.1), (0.2, 0.85), (0.5, 1.0), (1.1, 1.45), (1.7, 1.4),
    (1.75, 0.9), (1.45, 0.35), (0.9, 0.1), (1.25, -0.1), (1.35, -0.6), (1.1, -1.15), (0.95, -1.45), (0.8, -1.1),
    (0.45, -0.7), (0.2, -0.3), (0.12, -0.8), (0.0, -1.05),
]  # fmt: skip
"""The right half, from the top of the head to the end of the body."""


def butterfly() -> Mesh:
    """Both halves, with rounded corners, and shaken: not quite symmetric."""
    right = np.array(SKETCH)
    corners = np.concatenate([right, (right * [-1.0, 1.0])[-2:0:-1]])[::-1]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    t = np.linspace(0.0, 1.0, FINEST, endpoint=False)[None, :, None]
    start, end = np.roll(middles, 1, axis=0)[:, None], middles[:, None]
    points = ((1 - t) ** 2 * start + 2 * t * (1 - t) * corners[:, None] + t**2 * end).reshape(-1, 2)
    x, y = points.T
    return Mesh.from_loops([points + SHAKE * np.stack([np.sin(3 * y + 2 * x), np.sin(4 * x + 1.0)], axis=1)])


def main() -> None:
    given = arguments(__doc__)
    fine = butterfly()
    tips = [int(np.argmin(np.hypot(*(fine.vertices - corner).T))) for corner in ((0.95, -1.35), (-0.95, -1.35))]
    is_head = (fine.vertices[:, 1] > HEAD) & (np.abs(fine.vertices[:, 0]) < 0.5)
    chosen = {
        "free": Settings(),
        "symmetric": Settings(symmetry=DetectSymmetry()),
        "the head matters": Settings(symmetry=DetectSymmetry(), weights=np.where(is_head, 8.0, 1.0)),
        "tips of the wings pinned": Settings(symmetry=DetectSymmetry(), pins=tips),
    }
    cages = []
    figure, axes = panels(len(chosen), width=3.2, height=3.4)
    for each, (title, settings), colour in zip(axes, chosen.items(), (RED, BLUE, GREEN, ORANGE), strict=True):
        level = nested_cages(fine, [COUNT], settings).levels[0]
        assert verify(level.cage, fine)
        print(f"{title}: {level.report}")
        cages.append(level.cage)
        fill(each, level.cage, colour, 0.15)
        fill(each, fine, BODY)
        line(each, fine, INK, 0.8)
        line(each, level.cage, colour, 1.5, 5.0)
        if settings.pins:
            each.plot(*fine.vertices[tips].T, "o", color=INK, markersize=4.0, zorder=3)
        each.set_title(f"{title}, {100 * level.report.excess:.1f} %")
    for each in axes:
        for cage in cages:
            each.update_datalim(cage.vertices)
    write_svg(given.output / "butterfly.svg", [fine, cages[1]])
    save(figure, given.output / "butterfly.png")


if __name__ == "__main__":
    main()
