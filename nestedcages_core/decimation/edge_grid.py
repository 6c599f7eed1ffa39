"""Edges by position and length: which edges of changing loops may touch a box."""

from __future__ import annotations

from math import frexp

OCTAVES_PER_LEVEL = 2
"""Factors of two between the cell sizes of neighbouring levels; 2 was faster than 1 and 3 on glyphs and fractals."""

STRIDE = 1 << 32
"""Cells of a column are numbered from column * STRIDE; a collision of numbers only costs time."""


class EdgeGrid:
    """Grids of several cell sizes; each edge is in one cell, that of its midpoint, on the level of its length.

    A cell is larger than its edges, so an edge reaches at most half a cell from its middle, whatever the mixture of
    long and short edges. Scalar on purpose: the loops change edge by edge.
    """

    def __init__(self, count: int, origin: tuple[float, float], finest: float) -> None:
        """Reserve space for edges 0 .. count - 1; origin: a point near the loops, for small cell numbers.

        finest: length below which edges share the cells of a level: a rounding of the coordinates.
        """
        self._origin = origin
        self._lowest = _level(finest)
        self._levels: dict[int, tuple[float, float, dict[int, list[int]]]] = {}
        self._cells: list[dict[int, list[int]]] = [{}] * count
        self._keys = [0] * count

    def insert(self, edge: int, ax: float, ay: float, bx: float, by: float) -> None:
        """Add an edge from (ax, ay) to (bx, by)."""
        level = max(_level(max(abs(bx - ax), abs(by - ay))), self._lowest)
        if level not in self._levels:
            size = 2.0 ** (level * OCTAVES_PER_LEVEL)
            self._levels[level] = (0.5 * size, 1.0 / size, {})
        _, inverse, cells = self._levels[level]
        column = int((0.5 * (ax + bx) - self._origin[0]) * inverse)
        row = int((0.5 * (ay + by) - self._origin[1]) * inverse)
        key = column * STRIDE + row
        if key in cells:
            cells[key].append(edge)
        else:
            cells[key] = [edge]
        self._cells[edge], self._keys[edge] = cells, key

    def remove(self, edge: int) -> None:
        """Remove an edge."""
        cells, key = self._cells[edge], self._keys[edge]
        members = cells[key]
        if len(members) == 1:
            del cells[key]
        else:
            members.remove(edge)

    def near(self, low_x: float, low_y: float, high_x: float, high_y: float) -> list[int]:
        """A superset of the edges whose boxes touch the given box."""
        found: list[int] = []
        origin_x, origin_y = self._origin
        low_x, low_y, high_x, high_y = low_x - origin_x, low_y - origin_y, high_x - origin_x, high_y - origin_y
        for half, inverse, cells in self._levels.values():
            if not cells:
                continue
            # int() rounds towards zero for edges and boxes alike, hence keeps their order
            left, right = int((low_x - half) * inverse), int((high_x + half) * inverse)
            bottom, top = int((low_y - half) * inverse), int((high_y + half) * inverse)
            if (right - left + 1) * (top - bottom + 1) > len(cells):
                for members in cells.values():
                    found += members
                continue
            for column in range(left * STRIDE, right * STRIDE + 1, STRIDE):
                for key in range(column + bottom, column + top + 1):
                    if key in cells:
                        found += cells[key]
        return found


def _level(length: float) -> int:
    """The level of edges of a length, so that a cell of size 2 ** (level * OCTAVES_PER_LEVEL) is larger than these."""
    return frexp(length)[1] // OCTAVES_PER_LEVEL + 1
