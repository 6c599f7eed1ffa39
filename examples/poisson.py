"""A Poisson problem solved by multigrid over nested cages, next to conjugate gradients without it.

Every cage contains the one before, so each grid is interpolated to the finer one without guessing values outside: what
Sacht, Vouga and Jacobson made nested cages for. Run as ``python examples/poisson.py``.
"""

from __future__ import annotations

import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import LinearOperator, cg, splu

from nestedcages_core import Grids, grids, nested_cages, read_svg
from plot import BLUE, LEVELS, QUIET, arguments, line, save

DRAWING = Path(__file__).resolve().parent / "letter_a.svg"
COUNTS = (150, 80, 40, 24)
TOLERANCE = 1e-8  # of the residual, relative to the load
SMOOTHING, DAMPING = 2, 0.7  # Jacobi steps before and after each correction; their share


class Multigrid:
    """V-cycles for the equations of the finest grid: the coarser ones are restricted from it (Galerkin)."""

    def __init__(self, made: Grids, stiffness: csr_array, inside: np.ndarray) -> None:
        """inside: the unknowns among the vertices of the finest grid; the others are zero."""
        self.matrices, self.up, rows = [stiffness], [], inside
        for step in made.steps:
            used = np.flatnonzero(step[rows].sum(axis=0))  # coarse vertices that no unknown sees carry nothing
            self.up.append(step[rows][:, used].tocsr())
            self.matrices.append((self.up[-1].T @ self.matrices[-1] @ self.up[-1]).tocsr())
            rows = used
        self.coarsest = splu(self.matrices[-1].tocsc())

    def cycle(self, load: np.ndarray, level: int = 0) -> np.ndarray:
        """An approximate solution on a level."""
        if level == len(self.up):
            return self.coarsest.solve(load)
        matrix, step = self.matrices[level], self.up[level]
        scale = DAMPING / matrix.diagonal()
        found = scale * load
        for _ in range(SMOOTHING - 1):
            found += scale * (load - matrix @ found)
        found += step @ self.cycle(step.T @ (load - matrix @ found), level + 1)
        for _ in range(SMOOTHING):
            found += scale * (load - matrix @ found)
        return found


def main() -> None:
    given = arguments(__doc__)
    fine = read_svg(DRAWING)
    hierarchy = nested_cages(fine, COUNTS)
    made = grids(hierarchy, fine.diagonal / (60 if given.small else 700))
    grid = made.grids[0]
    print(f"Grids of {', '.join(str(len(each.vertices)) for each in made.grids)} vertices")
    inside = grid.inside
    stiffness = grid.stiffness()[inside][:, inside].tocsr()
    load = (grid.mass() @ np.ones(len(grid.vertices)))[inside]  # -Δu = 1 inside, u = 0 on the outline
    direct = splu(stiffness.tocsc()).solve(load)
    figure, (left, right, course) = plt.subplots(1, 3, figsize=(14, 5), layout="constrained")
    cycles = Multigrid(made, stiffness, inside)
    multigrid = LinearOperator(stiffness.shape, matvec=cycles.cycle)
    for name, solver, colour in (("conjugate gradients", None, QUIET), ("with multigrid", multigrid, BLUE)):
        steps = [np.zeros_like(load)]
        began, keep = time.perf_counter(), lambda x, to=steps: to.append(x.copy())
        found, failed = cg(stiffness, load, rtol=TOLERANCE, maxiter=20_000, M=solver, callback=keep)
        seconds = time.perf_counter() - began
        assert not failed and np.abs(found - direct).max() < 1e-5 * np.abs(direct).max()
        print(f"{name:20s} {len(steps) - 1:5d} iterations {seconds:8.3f} s")
        residuals = [np.linalg.norm(load - stiffness @ each) / np.linalg.norm(load) for each in steps]
        course.semilogy(np.linspace(0.0, seconds, len(steps)), residuals, color=colour, linewidth=2.0, label=name)
    values = np.zeros(len(grid.vertices))
    values[inside] = direct
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
    course.set_xlabel("seconds")
    course.set_title("residual")
    course.legend(frameon=False)
    course.spines[["top", "right"]].set_visible(False)
    save(figure, given.output / "poisson.png")


if __name__ == "__main__":
    main()
