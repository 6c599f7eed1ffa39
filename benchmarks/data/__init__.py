"""What the benchmarks run on: the paper's discs and its Table 1, shapes drawn by formulas, and the records on them."""

from __future__ import annotations

import csv
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import clone  # noqa: F401
from data.drawn import DRAWN, annulus, ring
from nestedcages_core import Mesh

__all__ = [
    "COARSE_RING_VERTICES",
    "HELD_OUT_SHAPES",
    "PROGRAM",
    "TABLE_1",
    "Record",
    "Table1Row",
    "annulus",
    "read_records",
    "read_shape",
    "read_table1",
    "ring",
    "shape",
    "shape_names",
]

HERE = Path(__file__).parent
TABLE_1 = HERE / "table1.csv"
RECORDS = HERE / "records.csv"
HELD_OUT_SHAPES = HERE / "held_out.json"  # letters, icons and maps, each with its source and licence
PROGRAM = HERE / "program.csv"  # what the paper's program and `as_published` make of the same meshes
PAPER_SECONDS = "paper_flow_s", "paper_reinflation_s"  # columns of the first
COARSE_RING_VERTICES = 16  # vertices of each of the coarse annulus' two rings, the paper's


def disc_optimum(ring_vertices: int, m: int = COARSE_RING_VERTICES) -> float:
    """Excess in per cent of the tightest annulus of m + m vertices around that of Table 1, for at least m vertices.

    The edges of the outer m-gon are flush with edges of the ring: area cos²(π/k) Σ tan(θ/2). The m-gon in the hole has
    its vertices on those of the ring: area ½ r² Σ sin θ. Angles θ between neighbours are multiples of 2π/k that add up
    to 2π; tan is convex and sin concave, so they are as equal as possible. Proof: docs/method.md.
    """
    steps, longer = divmod(ring_vertices, m)
    angles = 2.0 * np.pi / ring_vertices * np.array([steps + 1] * longer + [steps] * (m - longer))
    outer = np.cos(np.pi / ring_vertices) ** 2 * np.tan(0.5 * angles).sum()
    hole = 0.5 * 0.25 * np.sin(angles).sum()
    return 100.0 * (float(outer - hole) / annulus(ring_vertices).area - 1.0)


@dataclass(frozen=True)
class Table1Row:
    """One row: `fine_vertices` in all, times in CPU seconds, excess in per cent; None where there is no figure."""

    fine_vertices: int
    reference_seconds: float | None = None
    """Of its program on our machine."""
    reference_excess: float | None = None
    paper_seconds: float | None = None
    """Of flow and reinflation in the paper, on the authors' machine."""

    @property
    def fine_ring_vertices(self) -> int:
        return self.fine_vertices // 2

    @property
    def optimum_excess(self) -> float:
        """Least excess of a cage of 16 + 16 vertices, without clearance, in closed form."""
        return disc_optimum(self.fine_ring_vertices)


def read_table1(path: Path = TABLE_1) -> tuple[Table1Row, ...]:
    """Rows of the reference table at `path`. Raises OSError, KeyError."""

    def number(text: str) -> float | None:
        return float(text) if text.strip() else None

    with path.open(newline="", encoding="utf-8") as file:
        return tuple(
            Table1Row(
                int(row["fine_vertices"]),
                number(row["reference_cpp_cpu_s"]),
                number(row["reference_cpp_excess_percent"]),
                sum(float(row[name]) for name in PAPER_SECONDS) if PAPER_SECONDS[0] in row else None,
            )
            for row in csv.DictReader(file)
        )


@dataclass(frozen=True)
class Record:
    """The best on record for a shape at a vertex count; nan where there is none."""

    excess: float = np.nan
    """Least one, in per cent."""
    seconds: float = np.nan
    """CPU seconds."""
    hull: float = np.nan
    """Excess of a strict progressive hull, in per cent."""


def read_records(path: Path = RECORDS) -> dict[tuple[str, int], Record]:
    """The records by shape and vertex count."""
    with path.open(newline="", encoding="utf-8") as file:
        return {
            (row["shape"], int(row["cage_vertices"])): Record(
                float(row["excess_percent"]), float(row["cpu_seconds"]), float(row["hull_excess_percent"])
            )
            for row in csv.DictReader(file)
        }


def shape_names(folder: Path | None = None, only: Sequence[str] | None = None) -> list[str]:
    """Names of the shapes that are drawn here, or of those in `folder`. Exits with a sentence where there are none."""
    found = sorted(path.name.removesuffix("_V.csv") for path in folder.glob("*_V.csv")) if folder else sorted(DRAWN)
    where = str(folder) if folder else "benchmarks/data"
    unknown = [name for name in only or () if name not in found]
    if unknown:
        sys.exit(f"{where} has no shape called {unknown[0]!r}; it has {', '.join(found) or 'none'}.")
    if not found:
        sys.exit(f"{where} has no shapes: files name_V.csv (x, y in each line) and name_E.csv (two vertex indices).")
    return list(only or found)


def shape(name: str, folder: Path | None = None) -> Mesh:
    """One of the shapes drawn here, or of those in `folder`."""
    if folder:
        return read_shape(folder, name)
    try:
        return DRAWN[name]()
    except ModuleNotFoundError as error:
        sys.exit(f"{name} is a glyph of a font that comes with {error.name}: pip install -e '.[benchmark]'.")


def read_shape(folder: Path, name: str) -> Mesh:
    """The mesh in `folder/name_V.csv` (x, y in each line) and `folder/name_E.csv` (two vertex indices in each line)."""
    vertices = np.loadtxt(folder / f"{name}_V.csv", delimiter=",", ndmin=2)
    edges = np.loadtxt(folder / f"{name}_E.csv", delimiter=",", ndmin=2)
    return Mesh(vertices[:, :2], edges.astype(np.int64))
