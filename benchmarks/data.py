"""What the benchmarks run on: the discs of the paper's Table 1, the table itself, and shapes kept as two CSV files."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from nestedcages_core import Mesh

OUTER_RADIUS, INNER_RADIUS = 1.0, 0.5  # the paper's annulus, in its units
COARSE_RING_VERTICES = 16  # vertices of each of the coarse annulus' two rings, the paper's


@dataclass(frozen=True)
class Table1Row:
    """One row: `fine_vertices` in all, times in CPU seconds, excess in per cent; None where there is no figure."""

    fine_vertices: int
    fine_ring_vertices: int
    reference_seconds: float | None = None
    reference_excess: float | None = None
    optimum_excess: float | None = None


# The fine meshes of Table 1; the figures beside them are read from the reference.
TABLE_1_SIZES = (32, 48, 64, 96, 128, 192, 256, 512)
TABLE_1_WITHOUT_REFERENCE = tuple(Table1Row(size, size // 2) for size in TABLE_1_SIZES)


def read_table1(path: Path) -> tuple[Table1Row, ...]:
    """Rows of the reference table at `path`, a CSV file with the columns used below. Raises OSError, KeyError."""

    def number(text: str) -> float | None:
        return float(text) if text.strip() else None

    with path.open(newline="", encoding="utf-8") as file:
        return tuple(
            Table1Row(
                int(row["fine_vertices"]),
                int(row["fine_ring_vertices"]),
                number(row["reference_cpp_cpu_s"]),
                number(row["reference_cpp_excess_percent"]),
                number(row["optimum_excess_percent"]),
            )
            for row in csv.DictReader(file)
        )


def ring(count: int, radius: float) -> np.ndarray:
    """Regular polygon (count, 2) about the origin, counter-clockwise, first vertex on the x axis."""
    angles = 2 * np.pi * np.arange(count) / count
    return radius * np.column_stack((np.cos(angles), np.sin(angles)))


def annulus(ring_vertices: int) -> Mesh:
    """The paper's annulus with `ring_vertices` on either ring."""
    return Mesh.from_loops([ring(ring_vertices, OUTER_RADIUS), ring(ring_vertices, INNER_RADIUS)])


def read_shape(folder: Path, name: str) -> Mesh:
    """The mesh in `folder/name_V.csv` (x, y in each line) and `folder/name_E.csv` (two vertex indices in each line)."""
    vertices = np.loadtxt(folder / f"{name}_V.csv", delimiter=",", ndmin=2)
    edges = np.loadtxt(folder / f"{name}_E.csv", delimiter=",", ndmin=2)
    return Mesh(vertices[:, :2], edges.astype(np.int64))
