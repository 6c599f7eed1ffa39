"""Draws the rooms of the core and of the add-on and which uses which, from the imports in the sources: docs/rooms.svg
and docs/addon_rooms.svg.

    python packaging/draw_rooms.py

An arrow that follows from others is left out: the picture shows the fewest arrows that say the same.
"""

from __future__ import annotations

import ast
import html
import sys
import textwrap
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CORE = ROOT / "nestedcages_core"
ADDON = "addon"
PICTURES = {"rooms.svg": "The rooms of Nested Cages", "addon_rooms.svg": "The rooms of its add-on"}
APART = {"__main__"}  # only starts the command

Graph = Mapping[str, set[str]]
"""Room -> rooms that it imports."""

WIDTH, HEIGHT, GAP_X, GAP_Y, MARGIN = 232, 78, 26, 34, 16  # of boxes and between them, in pixels
LETTERS = 35  # in a line of a box


def imported_rooms() -> dict[str, set[str]]:
    """The rooms of the core and what each imports when it runs; the add-on imports the core's face."""
    rooms: dict[str, set[str]] = {}
    for path in sorted(CORE.rglob("*.py")):
        parts = path.relative_to(CORE).with_suffix("").parts
        package = parts[:-1]
        face = parts == ("__init__",)  # imports some rooms when asked for, and lists them for a type checker
        found = rooms.setdefault(ADDON if face else parts[0], set())
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree) if face else statements(tree):
            if isinstance(node, ast.ImportFrom) and node.level:
                base = (*package[: len(package) + 1 - node.level], *(node.module or "").split("."))
                target = next((part for part in base if part), None)
                found |= {target} if target else {alias.name for alias in node.names}
    return _known(rooms)


def addon_rooms() -> dict[str, set[str]]:
    """The rooms of the add-on and what each imports, but for its own registration."""
    rooms: dict[str, set[str]] = {}
    folder = ROOT / ADDON
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder).with_suffix("").parts
        if parts == ("__init__",):
            continue
        found = rooms.setdefault(parts[0], set())
        for node in statements(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == len(parts):
                found |= {node.module.split(".")[0]} if node.module else {alias.name for alias in node.names}
    return _known(rooms)


def _known(rooms: dict[str, set[str]]) -> dict[str, set[str]]:
    """Rooms without those apart, and imports of other rooms only."""
    for name in APART:
        rooms.pop(name, None)
    return {room: {other for other in found if other in rooms and other != room} for room, found in rooms.items()}


def statements(tree: ast.AST) -> list[ast.AST]:
    """All nodes but those that only a type checker sees."""
    found = [tree]
    for child in ast.iter_child_nodes(tree):
        if not (isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test)):
            found += statements(child)
    return found


def below(rooms: Graph, room: str) -> set[str]:
    """All rooms that a room needs, directly or not."""
    return rooms[room].union(*(below(rooms, other) for other in rooms[room]))


def arrows(rooms: Graph) -> dict[str, set[str]]:
    """The imports that do not follow from others."""
    return {room: found - set().union(*(below(rooms, other) for other in found)) for room, found in rooms.items()}


def floors(rooms: Graph) -> list[list[str]]:
    """Rooms by the longest way down from them, the lowest floor first."""
    height: dict[str, int] = {}

    def of(room: str) -> int:
        if room not in height:
            height[room] = 1 + max((of(other) for other in rooms[room]), default=-1)
        return height[room]

    top = max(map(of, rooms))
    return [sorted(room for room in rooms if height[room] == level) for level in range(top + 1)]


def purpose(room: str, home: Path = CORE) -> str:
    """The first line of the docstring of a room in the folder `home`, up to the first pause."""
    folder = ROOT / ADDON if room == ADDON else home / room
    path = folder / "__init__.py" if folder.is_dir() else folder.with_suffix(".py")
    line = (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n")[0]
    return line.partition(". ")[0].rstrip(".")


def draw(rooms: Graph, title: str, home: Path = CORE) -> str:
    """The picture of the rooms in the folder `home` as SVG text."""
    levels = floors(rooms)[::-1]
    width = max(len(level) for level in levels) * (WIDTH + GAP_X) - GAP_X + 2 * MARGIN
    height = len(levels) * (HEIGHT + GAP_Y) - GAP_Y + 2 * MARGIN
    corner: dict[str, tuple[float, float]] = {}
    for floor, level in enumerate(levels):
        left = (width - len(level) * (WIDTH + GAP_X) + GAP_X) / 2
        for place, room in enumerate(level):
            corner[room] = left + place * (WIDTH + GAP_X), MARGIN + floor * (HEIGHT + GAP_Y)
    lines, boxes = [], []
    for room, others in arrows(rooms).items():
        for other in sorted(others):
            (x0, y0), (x1, y1) = corner[room], corner[other]
            start, end, top, bottom = x0 + WIDTH / 2, x1 + WIDTH / 2, y0 + HEIGHT, y1
            reach = (bottom - top) / 2
            lines.append(
                f'<path class="arrow" id="{room}-{other}" marker-end="url(#head)" '
                f'd="M{start:.0f} {top:.0f}C{start:.0f} {top + reach:.0f} {end:.0f} {bottom - reach:.0f} '
                f'{end:.0f} {bottom - 5:.0f}"/>'
            )
    for room, (x, y) in corner.items():
        words = textwrap.wrap(purpose(room, home), LETTERS, max_lines=3, placeholder=" …")
        said = "".join(
            f'<text class="purpose" x="{x + 10:.0f}" y="{y + 37 + 15 * k:.0f}">{html.escape(line)}</text>'
            for k, line in enumerate(words)
        )
        boxes.append(
            f'<g class="room" id="{room}"><rect x="{x:.0f}" y="{y:.0f}" width="{WIDTH}" height="{HEIGHT}" rx="6"/>'
            f'<text class="name" x="{x + 10:.0f}" y="{y + 20:.0f}">{room}</text>{said}</g>'
        )
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" '
            f'height="{height:.0f}">',
            f"<title>{title}; an arrow leads to what a room uses</title>",
            "<style>text{font-family:system-ui,sans-serif;fill:#1d2733}.name{font-size:14px;font-weight:600}"
            ".purpose{font-size:11.5px;fill:#46566a}rect{fill:#eef3f9;stroke:#7d93ad}"
            ".arrow{fill:none;stroke:#7d93ad;stroke-width:1.4}</style>",
            '<defs><marker id="head" viewBox="0 0 8 8" refX="6" refY="4" markerWidth="7" markerHeight="7" '
            'orient="auto"><path d="M0 0L8 4L0 8z" fill="#7d93ad"/></marker></defs>',
            f'<rect width="{width:.0f}" height="{height:.0f}" style="fill:#fff;stroke:none"/>',
            *lines,
            *boxes,
            "</svg>\n",
        ]
    )


def main() -> int:
    drawn = [(imported_rooms(), CORE), (addon_rooms(), ROOT / ADDON)]
    for (name, title), (rooms, home) in zip(PICTURES.items(), drawn, strict=True):
        (ROOT / "docs" / name).write_text(draw(rooms, title, home), encoding="utf-8")
        print(f"docs/{name} drawn")
    return 0


if __name__ == "__main__":
    sys.exit(main())
