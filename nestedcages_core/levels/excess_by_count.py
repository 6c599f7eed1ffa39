"""The excess of a cage as a function of its number of vertices."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np

from ..decimation.base import MIN_PER_LOOP
from ..decimation.starts import Outlines
from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh, MeshLike
from ..libraries import load_pyplot
from .settings import Settings

OUTLINES = 12
"""Maximum number of outlines of the sequence that are looked at."""


class ExcessByCount(dict[int, float]):
    """About the excess of the tightest cage for each number of vertices; see `excess_by_count`."""

    def __repr__(self) -> str:
        return f"ExcessByCount({', '.join(f'{count}: {excess:.3g}' for count, excess in self.items())})"

    def plot(self, ax: Any = None) -> Any:
        """Draw the curve with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            The axes to draw on. Default: new ones.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        NestedCagesError
            If matplotlib is missing.
        """
        axes = load_pyplot().subplots()[1] if ax is None else ax
        axes.step(list(self), list(self.values()), where="post")
        axes.set_xlabel("vertices")
        axes.set_ylabel("excess")
        return axes


def excess_by_count(shape: MeshLike, most: int, *, clearance: float = 0.0) -> ExcessByCount:
    """About the excess of the tightest cage of a shape for each number of vertices.

    One search per outline knows all numbers; nothing is tightened or certified. Values never rise.

    Parameters
    ----------
    shape : MeshLike
        The shape, as `nested_cages` takes it.
    most : int
        Maximum number of vertices, at least 3.
    clearance : float, default 0.0
        Distance that cages keep, in the units of the shape.

    Returns
    -------
    ExcessByCount
        A mapping from numbers of vertices, ascending, to the part of the shape's area that a cage has beyond it.

    Raises
    ------
    NestedCagesError
        If the shape or a value is invalid.

    Examples
    --------
    >>> import nestedcages_core as core
    >>> curve = core.excess_by_count([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], 6)
    >>> list(curve)
    [3, 4, 5, 6]
    >>> f"{curve[5]:.2f}"
    '0.17'
    """
    fine = Mesh.of(shape)
    if not isinstance(most, int | np.integer) or isinstance(most, bool) or most < MIN_PER_LOOP:
        raise NestedCagesError(
            f"most must be a whole number of at least {MIN_PER_LOOP}, not {most!r}.",
            code="setting.invalid",
            name="most",
            value=most,
        )
    around = Outlines(fine, int(most), Settings(clearance=clearance).clearance or 0.0)
    least: FloatArray = np.full(most + 1, np.inf)
    for k in np.unique(np.linspace(0, len(around.sequence) - 1, OUTLINES).round().astype(int)).tolist():
        with suppress(NestedCagesError):  # too many parts, or no room between them
            areas, _ = around.least_areas(k)
            least[: len(areas)] = np.minimum(least[: len(areas)], areas)
    least = np.minimum.accumulate(least)
    return ExcessByCount({k: float(least[k] / fine.area - 1.0) for k in np.flatnonzero(np.isfinite(least)).tolist()})
