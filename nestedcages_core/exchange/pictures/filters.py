"""The row filters of PNG undone (ISO/IEC 15948, section 9), all rows at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SUB, UP, AVERAGE, PAETH = 1, 2, 3, 4
"""Filter types other than none (section 9.2)."""


def unfiltered(lines: NDArray[np.uint8], pixel: int) -> NDArray[np.uint8]:
    """(H, S) bytes of the rows; lines: (H, 1 + S), the filter before each row; pixel: bytes from one to the next."""
    if lines[:, 0].max() < AVERAGE:
        return _by_rows(lines, pixel)
    return _by_diagonals(lines, pixel)


def _by_rows(lines: NDArray[np.uint8], pixel: int) -> NDArray[np.uint8]:
    """Without AVERAGE and PAETH every row is a running sum, a sum with the row above, or itself."""
    rows = lines[:, 1:].copy()
    for y, kind in enumerate(lines[:, 0].tolist()):
        if kind == SUB:
            for k in range(pixel):
                np.add.accumulate(rows[y, k::pixel], out=rows[y, k::pixel])
        elif kind == UP and y:
            rows[y] += rows[y - 1]
    return rows


def _by_diagonals(lines: NDArray[np.uint8], pixel: int) -> NDArray[np.uint8]:
    """A pixel needs those to the left, above, and above to the left: all pixels of one diagonal at once."""
    height = len(lines)
    kinds = lines[:, 0]
    width = (lines.shape[1] - 1) // pixel
    row = width + 1  # a column of zeros to the left, a row of zeros above
    pixels = np.zeros(((height + 1) * row, pixel), dtype=np.uint8)
    pixels.reshape(height + 1, row, pixel)[1:, 1:] = lines[:, 1:].reshape(height, width, pixel)
    chosen = [(kinds == kind)[:, None] for kind in (SUB, UP, AVERAGE, PAETH)]
    for d in range(height + width - 1):
        top, count = max(0, d - width + 1), min(d, height - 1) + 1 - max(0, d - width + 1)
        first = row + d + 1 + top * (row - 1)

        def along(shift: int, first: int = first, count: int = count) -> NDArray[np.uint8]:
            return pixels[first - shift :: row - 1][:count] if row > 1 else pixels[first - shift : first - shift + 1]

        here = along(0)
        left, up, corner = (along(shift).astype(np.int16) for shift in (1, row, row + 1))
        by_left, by_up = np.abs(up - corner), np.abs(left - corner)
        by_corner = np.abs(left + up - 2 * corner)
        nearest = np.where(by_up <= by_corner, up, corner)
        nearest = np.where((by_left <= by_up) & (by_left <= by_corner), left, nearest)
        predicted = np.zeros_like(left)
        for mask, value in zip(chosen, (left, up, (left + up) >> 1, nearest), strict=True):
            np.copyto(predicted, value, where=mask[top : top + count])
        here += predicted.astype(np.uint8)
    return np.ascontiguousarray(pixels.reshape(height + 1, row, pixel)[1:, 1:].reshape(height, -1))
