"""Puts every figure and table of the paper and of the comparison into one PDF, by one command.

    python benchmarks/paper_pdf.py [--meshes FOLDER] [--out build/paper.pdf]

Figures 1 to 5 are run again: our drawings of them, or the paper's own meshes in a folder, ``data`` of its program.
Everything else is drawn from the runs that ``benchmarks/compare.py`` made. Needs matplotlib.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from clone import ROOT
from comparison import conclusions, figures, pages, pictures, runs, tables
from data import read_table1

PAGE = (8.27, 11.69)  # inches: A4


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=Path, default=ROOT / "docs" / "comparison", help="their folder (%(default)s)")
    parser.add_argument("--meshes", type=Path, help="folder of the paper's own meshes")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "paper.pdf", help="the file (%(default)s)")
    options = parser.parse_args()
    if not (options.runs / pages.RUNS).is_file():
        print(f"{options.runs / pages.RUNS} is not there; run: {pages.COMMAND}", file=sys.stderr)
        return 1
    make(options.runs, options.meshes, options.out)
    print(f"{options.out} written")
    return 0


def make(folder: Path, meshes: Path | None, path: Path) -> None:
    """Write the PDF."""
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure

    found, record = runs.read(folder / pages.RUNS), pages.read_record(folder)
    path.parent.mkdir(parents=True, exist_ok=True)
    with PdfPages(path) as pdf:

        def text(title: str, body: str) -> None:
            page = Figure(PAGE)
            page.text(0.06, 0.96, title, fontsize=13, va="top")
            page.text(0.06, 0.92, body, fontsize=6, va="top", family="monospace")
            pdf.savefig(page)

        claims = [
            f"{k}. {conclusion.claim}\n\n{columns(pages.said(*both))}"
            for k, (conclusion, both) in enumerate(conclusions.verdicts(found).items(), 1)
        ]
        text("Nested cages in the plane: figures and tables", "\n\n".join([record["machine"], *claims]))
        drawn = pictures.panes(figures.results(meshes))
        drawn.suptitle("Figures 1 to 5 of the paper", fontsize=9)
        pdf.savefig(drawn)
        text("Table 1 of the paper", columns(tables.table_1(found, read_table1())))
        text("The paper's compiled program", columns(pages.program_table()))
        for conclusion in conclusions.CONCLUSIONS:
            drawn = getattr(pictures, conclusion.name)(found)
            drawn.suptitle(conclusion.caption, fontsize=9)
            pdf.savefig(drawn)
        for title, table in (
            ("Contacts from the same starts", tables.contacts(found)), ("Equal ranges", tables.ranges(found)),
            ("Whole methods", tables.whole(found)), ("From 2022 to ours", tables.by_drawing(found, "ladder")),
            ("Flows", tables.flows(found)), ("Energies", tables.energies(found)),
        ):  # fmt: skip
            text(title, columns(table))


def columns(table: str) -> str:
    """A Markdown table with its columns aligned."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines() if "---" not in line]
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)


if __name__ == "__main__":
    sys.exit(main())
