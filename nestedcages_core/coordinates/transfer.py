"""Transfer of functions between the levels of a hierarchy: always interpolation, since cages enclose each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import scipy

from ..errors import invalid_setting
from ..geometry.mesh import Mesh
from ..geometry.triangulation import Sampling, Triangulation, triangulate
from ..levels import Hierarchy

COARSENING = 2.0
"""Default ratio of the spacings of consecutive grids, as usual for multigrid."""


@dataclass(frozen=True, eq=False)
class Grids:
    """A triangulation of every solid of a hierarchy, from the fine mesh to the coarsest cage, and prolongations."""

    grids: tuple[Triangulation, ...]
    steps: tuple[scipy.sparse.csr_array, ...]
    """steps[k]: (N_k, N_{k+1}) prolongation from grid k + 1 to grid k."""

    def prolongation(self, finer: int, coarser: int) -> scipy.sparse.csr_array:
        """From values on a coarse grid, linear on its triangles, to values on a finer one.

        Parameters
        ----------
        finer, coarser : int
            Numbers of grids, 0 for the finest.

        Returns
        -------
        (N_finer, N_coarser) sparse array
            Rows sum to 1, no entry is negative, and linear functions are reproduced.

        Raises
        ------
        NestedCagesError
            For grids that do not exist, or in the other order.
        """
        if not 0 <= finer <= coarser < len(self.grids):
            raise invalid_setting(
                f"There is no prolongation from grid {coarser} to grid {finer}: the {len(self.grids)} grids are "
                "numbered from 0, the finest, and values go from a coarser to a finer one."
            )
        operator = scipy.sparse.csr_array(scipy.sparse.eye_array(len(self.grids[finer].vertices), format="csr"))
        for step in self.steps[finer:coarser]:
            operator = operator @ step
        return operator

    def restriction(self, finer: int, coarser: int) -> scipy.sparse.csr_array:
        """(N_coarser, N_finer) loads on a fine grid to loads on a coarser one: the transposed prolongation."""
        return self.prolongation(finer, coarser).T.tocsr()


def grids(hierarchy: Hierarchy, spacing: float | Sequence[float] | None = None) -> Grids:
    """Grids on all levels, with prolongations as in the multigrid use of Sacht, Vouga & Jacobson (2015, section 5).

    Parameters
    ----------
    hierarchy : Hierarchy
        A fine mesh and its cages.
    spacing : float or sequence of float, optional
        Distance between the points of the finest grid, each further one twice as coarse; or one per grid. Unit: the
        input's. Default: the vertices of fine mesh and cages alone.

    Returns
    -------
    Grids

    Raises
    ------
    NestedCagesError
        For another number of spacings.
    """
    solids: list[Mesh] = [hierarchy.fine, *hierarchy.cages]
    if spacing is None:
        samplings: list[Sampling | None] = [None] * len(solids)
    elif isinstance(spacing, Sequence):
        if len(spacing) != len(solids):
            raise invalid_setting(
                f"{len(spacing)} spacings were given for {len(solids)} grids; give one for the fine mesh and one for "
                "each cage."
            )
        samplings = [Sampling(each) for each in spacing]
    else:
        samplings = [Sampling(spacing * COARSENING**k) for k in range(len(solids))]
    made = tuple(triangulate(solid, sampling) for solid, sampling in zip(solids, samplings, strict=True))
    steps = tuple(coarse.interpolation(fine.vertices) for fine, coarse in pairwise(made))
    return Grids(made, steps)
