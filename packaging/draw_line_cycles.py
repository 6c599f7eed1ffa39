"""Draws how line cycles find a cage, on the outline of a bean: docs/line_cycles.svg.

python packaging/draw_line_cycles.py
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from nestedcages_core import Mesh  # noqa: E402
from nestedcages_core.decimation.hull.offset import HULL_OFFSET  # noqa: E402
from nestedcages_core.decimation.line_cycles.around import Around  # noqa: E402
from nestedcages_core.decimation.line_cycles.crossings import Choice  # noqa: E402
from nestedcages_core.decimation.request import Request  # noqa: E402

OUTPUT = ROOT / "docs" / "line_cycles.svg"
VERTICES = 6  # of the cage
WIDTH, GAP, MARGIN = 300.0, 40.0, 24.0  # pixels: of a panel, between panels, around the outline
SHOWN = 6  # every so many candidates is drawn
STYLE = (
    ".paper{fill:#fff}.solid{fill:#d8d4cc;stroke:#55504a;stroke-width:1.2}.line{stroke:#9db4d0;stroke-width:.7}"
    ".edge{stroke:#1d5fa8;stroke-width:2;fill:none}.area{fill:#f2c14e;fill-opacity:.75}"
    ".contact{fill:#c0392b}.corner{fill:#1d5fa8}text{font:13px sans-serif;fill:#33302c}"
)


def bean() -> Mesh:
    """An outline with a dent, smooth but for its vertices."""
    turn = np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False)
    radius = 1.0 + 0.28 * np.cos(2.0 * turn) + 0.16 * np.sin(3.0 * turn)
    return Mesh.from_loops([radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)])


def points(ring: np.ndarray) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in ring)


def picture() -> str:
    """Three panels: candidates, one turn and its area, the best cycle."""
    request = Request.of(bean(), VERTICES)
    around = Around(request, request.outline, HULL_OFFSET)
    list(around._search())
    ((loop, search),) = around.searches.items()
    choice = Choice.of({loop: search}, {loop: VERTICES}, None)
    ring, lines = choice.rings[0], search.lines.take(choice.line)
    low, high = ring.min(axis=0), ring.max(axis=0)
    scale = (WIDTH - 2.0 * MARGIN) / (high - low).max()

    def at(place: np.ndarray, panel: int) -> np.ndarray:
        x, y = ((np.atleast_2d(place) - 0.5 * (low + high)) * scale).T
        return np.stack([x + 0.5 * WIDTH + panel * (WIDTH + GAP), 0.5 * WIDTH - y], axis=1)

    parts = [f'<rect class="paper" width="{3 * WIDTH + 2 * GAP:.0f}" height="{WIDTH + 30:.0f}"/>']
    outline = search.chain.vertices
    for panel in range(3):
        parts.append(f'<polygon class="solid" points="{points(at(outline, panel))}"/>')
    some = search.lines.take(np.arange(0, len(search.lines), SHOWN))
    for point, direction in zip(some.point, some.direction, strict=True):
        (x1, y1), (x2, y2) = at(np.stack([point - 0.2 * direction, point + 0.2 * direction]), 0)
        parts.append(f'<line class="line" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"/>')
    # from the contact of line 0 by its vertex with line 1 to the contact of that, and back along the outline
    first, last = (int(np.ceil(lines.place[k])) for k in (0, 1))
    turn = np.concatenate([lines.point[:1], ring[1:2], lines.point[1:2], outline[first:last][::-1]])
    parts.append(f'<polygon class="area" points="{points(at(turn, 1))}"/>')
    parts.append(f'<polyline class="edge" points="{points(at(turn[:3], 1))}"/>')
    parts.append(f'<polygon class="edge" points="{points(at(ring, 2))}"/>')
    dots = [("contact", lines.point[:2], 1), ("corner", ring[1:2], 1), ("contact", lines.point, 2), ("corner", ring, 2)]
    for kind, places, panel in dots:
        parts += [f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="3.5"/>' for x, y in at(places, panel)]
    for panel, words in enumerate(("1. Candidate lines", "2. A turn costs the area it adds", "3. The cheapest cycle")):
        parts.append(f'<text x="{panel * (WIDTH + GAP) + 40:.0f}" y="{WIDTH + 14:.0f}">{words}</text>')
    size = f'viewBox="0 0 {3 * WIDTH + 2 * GAP:.0f} {WIDTH + 30:.0f}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n<style>{STYLE}</style>\n' + "\n".join(parts) + "\n</svg>\n"
    )


if __name__ == "__main__":
    OUTPUT.write_text(picture(), encoding="utf-8")
