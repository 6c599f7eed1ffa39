"""A Poisson problem solved by multigrid over nested cages, beside conjugate gradients without it.

Every cage contains the one before, so each grid is interpolated to the finer one without guessing values outside: what
Sacht, Vouga and Jacobson made nested cages for. Run as ``python examples/poisson.py``.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import LinearOperator, cg, splu

from nestedcages_core import Grids, grids, nested_cages, read_svg
from plot import LEVELS, arguments, line, save

DRAWING = Path(__file__).resolve().parent / "letter_a.svg"
COUNTS = (150, 80, 40, 24)
TOLERANCE = 1e-8  # of the residual, relative to the load
SMOOTHING, DAMPING = 2, 0.7  # Jacobi steps before and after each correction; their share


class Multigrid:
    """V-cycles for the equations of the finest grid: the coarser ones are restricted from it (Galerkin)."""

    def __init__(self, made: Grids, stiffness: csr_array, inside: np.ndarray) -> None:
        """inside: the unknowns among the vertices of the finest grid; the others are zero."""
        self.matrices = [stiffness]
        self.up: list[csr_array] = []
        rows = inside
        for step in made.steps:
            step = step[rows]
            used = np.flatnonzero(step.sum(axis=0))  # coarse vertices that no unknown sees carry nothing
            step = step[:, used].tocsr()
            self.up.append(step)
            self.matrices.append((step.T @ self.matrices[-1] @ step).tocsr())
            rows = used
        self.diagonals = [matrix.diagonal() for matrix in self.matrices]
        self.coarsest = splu(self.matrices[-1].tocsc())

    def cycle(self, load: np.ndarray, level: int = 0) -> np.ndarray:
        """An approximate solution on a level."""
        if level == len(self.up):
            return self.coarsest.solve(load)
        matrix, scale = self.matrices[level], DAMPING / self.diagonals[level]
        found = scale * load
        for _ in range(SMOOTHING - 1):
            found += scale * (load - matrix @ found)
        step = self.up[level]
        found += step @ self.cycle(step.T @ (load - matrix @ found), level + 1)
        for _ in range(SMOOTHING):
            found += scale * (load - matrix @ found)
        return found


def timed(solve: Callable[[], tuple[np.ndarray, int]], name: str) -> np.ndarray:
    began = time.perf_counter()
    found, iterations = solve()
    print(f"{name:40s} {iterations:5d} iterations {time.perf_counter() - began:8.3f} s")
    return found


def main() -> None:
    given = arguments(__doc__)
    fine = read_svg(DRAWING)
    hierarchy = nested_cages(fine, COUNTS)
    began = time.perf_counter()
    made = grids(hierarchy, fine.diagonal / (60 if given.small else 700))
    print(f"Grids of {', '.join(str(len(grid.vertices)) for grid in made.grids)} vertices in", end=" ")
    print(f"{time.perf_counter() - began:.2f} s")

    grid = made.grids[0]
    inside = grid.inside
    stiffness = grid.stiffness()[inside][:, inside].tocsr()
    load = (grid.mass() @ np.ones(len(grid.vertices)))[inside]  # -Δu = 1 inside, u = 0 on the outline

    def conjugate_gradients(preconditioner: LinearOperator | None) -> tuple[np.ndarray, int]:
        steps: list[int] = []
        found, failed = cg(
            stiffness, load, rtol=TOLERANCE, maxiter=20_000, M=preconditioner, callback=lambda _: steps.append(1)
        )
        assert not failed
        return found, len(steps)

    def multigrid() -> tuple[np.ndarray, int]:
        cycles = Multigrid(made, stiffness, inside)
        return conjugate_gradients(LinearOperator(stiffness.shape, matvec=cycles.cycle))

    plain = timed(lambda: conjugate_gradients(None), "conjugate gradients")
    fast = timed(multigrid, "the same with multigrid over the cages")
    direct = timed(lambda: (splu(stiffness.tocsc()).solve(load), 1), "direct, by factors")
    for found in (plain, fast):
        assert np.abs(found - direct).max() < 1e-5 * np.abs(direct).max()

    values = np.zeros(len(grid.vertices))
    values[inside] = fast
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 5), layout="constrained")
    left.tripcolor(*grid.vertices.T, grid.triangles, values, shading="gouraud", cmap="viridis", rasterized=True)
    left.set_title(f"−Δu = 1 on {len(inside)} points inside")
    for level, colour in list(zip(made.grids[2:], LEVELS, strict=False))[::-1]:
        right.triplot(*level.vertices.T, level.triangles, color=colour, linewidth=0.4)
    for cage, colour in zip(hierarchy.cages[1:], LEVELS, strict=False):
        line(right, cage, colour, 1.2)
    right.set_title("its coarser grids, each inside the next")
    for axes in (left, right):
        axes.set_aspect("equal")
        axes.axis("off")
        axes.invert_yaxis()
    save(figure, given.output / "poisson.png")


if __name__ == "__main__":
    main()
