"""A Poisson problem solved by multigrid over nested cages, next to conjugate gradients without it.

Every cage contains the one before, so each grid is interpolated to the finer one without guessing values outside: what
Sacht, Vouga and Jacobson made nested cages for. Run as ``python examples/poisson.py``.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import LinearOperator, cg, splu

from nestedcages_core import Grids, grids, nested_cages, read_svg
from plot import BLUE, LEVELS, QUIET, RED, arguments, line, save

DRAWING = Path(__file__).resolve().parent / "letter_a.svg"
COUNTS = (150, 80, 40, 24)
TOLERANCE = 1e-8  # of the residual, relative to the load
OFFSET = "offset points"  # how matplotlib counts the way from a place to its label
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


Solve = Callable[[Callable[[np.ndarray], object]], np.ndarray]  # takes what is told of every iteration


@dataclass(frozen=True)
class Run:
    """A solution, how long it took, and the residual after every iteration, relative to the load."""

    found: np.ndarray
    seconds: float
    residuals: list[float]


def run(name: str, solve: Solve, residual: Callable[[np.ndarray], float]) -> Run:
    """Solves once against the clock and once to see the residuals."""
    began = time.perf_counter()
    found = solve(lambda _: None)
    seconds = time.perf_counter() - began
    residuals = [1.0]
    solve(lambda now: residuals.append(residual(now)))
    print(f"{name:40s} {len(residuals) - 1:5d} iterations {seconds:8.3f} s")
    return Run(found, seconds, residuals)


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

    def conjugate_gradients(
        tell: Callable[[np.ndarray], object], preconditioner: LinearOperator | None = None
    ) -> np.ndarray:
        found, failed = cg(stiffness, load, rtol=TOLERANCE, maxiter=20_000, M=preconditioner, callback=tell)
        assert not failed
        return found

    def multigrid(tell: Callable[[np.ndarray], object]) -> np.ndarray:
        cycles = Multigrid(made, stiffness, inside)
        return conjugate_gradients(tell, LinearOperator(stiffness.shape, matvec=cycles.cycle))

    def residual(found: np.ndarray) -> float:
        return float(np.linalg.norm(load - stiffness @ found) / np.linalg.norm(load))

    runs = {
        "conjugate gradients": run("conjugate gradients", conjugate_gradients, residual),
        "with multigrid": run("the same with multigrid over the cages", multigrid, residual),
    }
    began = time.perf_counter()
    direct = splu(stiffness.tocsc()).solve(load)
    factors = time.perf_counter() - began
    print(f"{'direct, by factors':40s} {1:5d} iterations {factors:8.3f} s")
    for each in runs.values():
        assert np.abs(each.found - direct).max() < 1e-5 * np.abs(direct).max()

    values = np.zeros(len(grid.vertices))
    values[inside] = direct
    figure, (left, right, course) = plt.subplots(1, 3, figsize=(14, 5), layout="constrained")
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
    for (name, each), colour in zip(runs.items(), (QUIET, BLUE), strict=True):
        times = np.linspace(0.0, each.seconds, len(each.residuals))
        course.semilogy(times, each.residuals, color=colour, linewidth=2.0, marker="o" if len(times) < 20 else None)
        half = len(times) // 2
        course.annotate(name, (times[half], each.residuals[half]), color=colour, xytext=(10, 2), textcoords=OFFSET)
    course.axvline(factors, color=RED, linestyle=":")
    course.annotate("direct", (factors, 1.0), color=RED, xytext=(10, 2), textcoords=OFFSET)
    course.set_xlabel("seconds")
    course.set_title("residual")
    course.spines[["top", "right"]].set_visible(False)
    save(figure, given.output / "poisson.png")


if __name__ == "__main__":
    main()
