"""Builds the C++ program of Gurditta & Jacobson 2022 from a checkout of yours, and runs it on the discs of Table 1 and
its own meshes.

    python benchmarks/paper_program.py --checkout DIR --libigl DIR --eigen DIR --output times.csv
    python benchmarks/table1.py --data times.csv
    python benchmarks/performance.py table1 --program-times times.csv

``--compare benchmarks/data/program.csv`` runs it and `as_published` on the meshes of figures 1 and 2, those in
the checkout, and on discs: a table of docs/comparison/as-published.md.

Nothing of that program is part of this project. It needs libigl 2.4 and Eigen 3 (folders that hold `igl` and `Eigen`),
TinyAD, which is a submodule of its checkout, and a C++ compiler. Its sources are compiled as they are, but for its
window: a header of ours stands in for that, which shows nothing, steps to the last frame, and notes the CPU seconds
until the window opens and the cage at the end. Exit status 1 if it cannot be built.
"""

from __future__ import annotations

import argparse
import csv
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

import clone  # noqa: F401 - puts the core of this clone on the path
from data import COARSE_RING_VERTICES, Table1Row, annulus, read_shape, read_table1
from nestedcages_core import Mesh, as_published, verify
from page import stamp

COLUMNS = "fine_vertices", "reference_cpp_cpu_s", "reference_cpp_excess_percent"
"""Of the file with the times, as in data/table1.csv."""

NO_WINDOW = """
#pragma once
#include <Eigen/Core>
#include <ctime>
#include <fstream>
#include <functional>
#include <iomanip>
#include <iostream>
#include <map>

namespace igl::opengl::glfw {
class Viewer {
public:
    struct Shown {
        Eigen::MatrixXd vertices;
        float point_size = 0.0f;
        template <class... T> void set_edges(const Eigen::MatrixXd &v, const T &...) { vertices = v; }
        template <class... T> void set_mesh(const T &...) {}
        template <class... T> void set_points(const T &...) {}
        template <class... T> void set_colors(const T &...) {}
    };
    struct Background { Eigen::Vector4f background_color; };
    std::function<bool(Viewer &, unsigned int, int)> callback_key_pressed;

    Background &core() { return background; }
    Shown &data(int index) { return shown[index]; }
    int append_mesh() { return ++meshes; }
    int launch() {
        for (int press = 0; press < FRAMES; press++) callback_key_pressed(*this, 's', 0);
        std::ofstream out("result.csv");
        out << std::setprecision(17) << seconds << '\\n';
        for (int k = 0; k < shown[1].vertices.rows(); k++)
            out << shown[1].vertices(k, 0) << ',' << shown[1].vertices(k, 1) << '\\n';
        return 0;
    }

private:
    static constexpr int FRAMES = 300;  // more than it makes; it stays at the last one
    double seconds = double(std::clock()) / CLOCKS_PER_SEC;
    std::map<int, Shown> shown;
    Background background;
    int meshes = 0;
};
}
"""
"""The stand-in for the window: the second of its meshes is the cage, and the key s goes to the next frame."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--checkout", type=Path, required=True, help="the program's sources, with main.cpp")
    parser.add_argument("--libigl", type=Path, required=True, help="folder with igl/, such as libigl/include")
    parser.add_argument("--eigen", type=Path, required=True, help="folder with Eigen/, such as /usr/include/eigen3")
    parser.add_argument("--tinyad", type=Path, help="folder with TinyAD/ (default: that of the checkout)")
    parser.add_argument("--output", type=Path, required=True, help="CSV file for the times")
    parser.add_argument("--compiler", default=os.environ.get("CXX", "c++"), help="C++ compiler (default: $CXX or c++)")
    parser.add_argument("--compare", type=Path, help="CSV file for its excess beside that of as_published")
    parser.add_argument("--rows", type=int, nargs="+", help="only discs with so many vertices")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "run" / "cages"
        if not built(program, options):
            return 1
        rows = [row for row in read_table1() if not options.rows or row.fine_vertices in options.rows]
        measured = [timed(program, row) for row in rows]
        if options.compare:
            compare(program, options.checkout / "data", options.compare)
    with options.output.open("w", newline="", encoding="utf-8") as file:
        lines = csv.writer(file)
        lines.writerow(COLUMNS)
        for row in measured:
            known = (row.fine_vertices, row.reference_seconds, row.reference_excess)
            lines.writerow(["" if value is None else f"{value:.4g}" for value in known])
    return 0


def built(program: Path, options: argparse.Namespace) -> bool:
    """Whether the program could be compiled, without its window."""
    header = program.parent / "include" / "igl" / "opengl" / "glfw" / "Viewer.h"
    header.parent.mkdir(parents=True)
    header.write_text(NO_WINDOW, encoding="utf-8")
    tinyad = options.tinyad or options.checkout / "TinyAD" / "include"
    own = program.parent / "include", options.checkout / "include"
    folders = [f"-I{path}" for path in own] + [f"-isystem{path}" for path in (tinyad, options.libigl, options.eigen)]
    sources = [options.checkout / "main.cpp", *sorted((options.checkout / "src").glob("*.cpp"))]
    # what CMake's build type Release means
    command = [options.compiler, "-std=c++17", "-O3", "-DNDEBUG", *folders, *sources, "-o", program]
    print("compiling", flush=True)
    return subprocess.run([str(word) for word in command], check=False).returncode == 0


def timed(program: Path, row: Table1Row) -> Table1Row:
    """The row with CPU seconds and excess of the program; None where it ends without a result."""
    seconds, excess = ran(program, annulus(row.fine_ring_vertices), annulus(COARSE_RING_VERTICES))
    print(f"{row.fine_vertices:4d} vertices: {seconds} s, excess {excess} %", flush=True)
    return replace(row, reference_seconds=seconds, reference_excess=excess)


def ran(program: Path, fine: Mesh, coarse: Mesh) -> tuple[float | None, float | None]:
    """CPU seconds and excess of the program; None where it ends without a result."""
    for name, mesh in (("fine", fine), ("coarse", coarse)):
        written(program.parent.parent / "data", name, mesh)
    result = program.parent / "result.csv"
    result.unlink(missing_ok=True)
    subprocess.run([program, "fine", "coarse"], cwd=program.parent, stdout=subprocess.DEVNULL, check=False)
    if not result.is_file():
        return None, None
    first, *points = result.read_text(encoding="utf-8").split()
    cage = coarse.moved(np.loadtxt(points, delimiter=",", ndmin=2))
    return float(first), 100.0 * (cage.area / fine.area - 1.0)


def compare(program: Path, meshes: Path, path: Path) -> None:
    """Write what the program and `as_published` make of the same meshes."""
    with path.open("w", newline="", encoding="utf-8") as file:
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(
            ("mesh", "program_excess_percent", "ours_excess_percent", "encloses", "short_diagonals", "stamp")
        )
        lines.writerows((*side_by_side(program, *case), stamp()) for case in cases(meshes))


def cases(folder: Path) -> list[tuple[str, Mesh, Mesh]]:
    """The program's own meshes, discs of Table 1, and one of them at other sizes."""
    pairs = (("figure 1", "A_guy_fine", "A_guy_coarse"), ("figure 2", "octagon_hole_hand", "square_hole_hand"))
    found = [(name, read_shape(folder, fine), read_shape(folder, coarse)) for name, fine, coarse in pairs]
    coarse = annulus(COARSE_RING_VERTICES)
    found += [(f"disc {2 * k}", annulus(k), coarse) for k in (row.fine_ring_vertices for row in read_table1())]
    disc = annulus(COARSE_RING_VERTICES)
    return [*found, *((f"disc 32, {scale:g} times the size", disc.moved(scale * disc.vertices),
                       coarse.moved(scale * coarse.vertices)) for scale in (0.5, 3.0))]  # fmt: skip


def side_by_side(program: Path, name: str, fine: Mesh, coarse: Mesh) -> tuple[str, ...]:
    """What the program and `as_published` make of a pair of meshes."""
    _, excess = ran(program, fine, coarse)
    ours = as_published(fine, coarse)
    certificate = verify(ours.cage, fine)
    print(f"{name}: {excess} % and {100.0 * certificate.excess} %", flush=True)
    text = "" if excess is None else f"{excess:.6f}"
    return name, text, f"{100.0 * certificate.excess:.6f}", str(certificate.holds), f"{ours.short / fine.diagonal:.3g}"


def written(folder: Path, name: str, mesh: Mesh) -> None:
    """Write a mesh as the program reads it: two CSV files in a folder next to that in which it runs."""
    folder.mkdir(exist_ok=True)
    np.savetxt(folder / f"{name}_V.csv", mesh.vertices, delimiter=",", fmt="%.17g")
    np.savetxt(folder / f"{name}_E.csv", mesh.edges, delimiter=",", fmt="%d")


if __name__ == "__main__":
    sys.exit(main())
