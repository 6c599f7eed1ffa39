"""Typesets docs/paper/paper.typ with figures and tables of today's code and runs: build/paper.pdf, by one command.

    python benchmarks/paper_pdf.py [--meshes FOLDER] [--out build/paper.pdf]

Figures 1 to 5 are run again: our drawings of them, or the paper's own meshes in a folder, ``data`` of its program, as
far as they are there. The rest is of the runs that ``benchmarks/compare.py`` made. Needs matplotlib, shapely and typst
(``pip install nested-cages[comparison]``).
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import sys
from pathlib import Path

from clone import ROOT
from comparison import conclusions, pages, runs, tables
from data import read_table1

SOURCE = ROOT / "docs" / "paper" / "paper.typ"
PICTURES = ("comparison/original.png", "comparison/ranges.png", "comparison/tightened.png", "line_cycles.svg")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--meshes", type=Path, help="folder of the paper's own meshes")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "paper.pdf", help="the file (%(default)s)")
    options = parser.parse_args()
    folder = options.out.with_suffix("")
    put_sources(folder)
    draw(folder, options.meshes)
    import typst

    typst.compile(str(folder / SOURCE.name), output=str(options.out))
    print(f"{options.out} written")
    return 0


def put_sources(folder: Path) -> None:
    """All that the paper includes, but for figures that are drawn."""
    folder.mkdir(parents=True, exist_ok=True)
    docs = ROOT / "docs"
    found, record = runs.read(docs / "comparison" / pages.RUNS), pages.read_record(docs / "comparison")
    for path in (SOURCE, docs / "references.bib", *(docs / name for name in PICTURES)):
        shutil.copy(path, folder / path.name)
    method = (docs / "method.md").read_text(encoding="utf-8")
    for name in ("bound", "peers"):
        shown = re.search(rf"<!-- table {name} -->(.*?)<!-- end", method, re.DOTALL)
        (folder / f"{name}.typ").write_text(typst_table(shown[1] if shown else ""), encoding="utf-8")
    (folder / "table1.typ").write_text(typst_table(tables.table_1(found, read_table1())), encoding="utf-8")
    parts = [
        f"*{k}. {conclusion.claim}*\n\n{typst_table(pages.said(*both))}\n"
        for k, (conclusion, both) in enumerate(conclusions.verdicts(found).items(), 1)
    ]
    (folder / "conclusions.typ").write_text("\n".join(parts), encoding="utf-8")
    (folder / "numbers.json").write_text(json.dumps(record), encoding="utf-8")


def draw(folder: Path, meshes: Path | None) -> None:
    """The method on a letter, and figures 1 to 5."""
    from comparison import figures, pictures

    pictures.save(pictures.method(), folder / "method.png")
    pictures.save(pictures.panes(figures.results(meshes)), folder / "figures.png")


def typst_table(markdown: str) -> str:
    """A table in Markdown as one of Typst; what is not part of a table is left out."""
    rows = [[cell.strip() for cell in line.strip().strip("|").split(" | ")]
            for line in markdown.splitlines() if line.startswith("|") and "| --- " not in line]  # fmt: skip
    if not rows:
        return "#[]"
    cells = ",\n  ".join(", ".join(f"[{escaped(cell)}]" for cell in row) for row in rows)
    return f"#table(columns: {len(rows[0])},\n  {cells},\n)"


def escaped(text: str) -> str:
    """Text whose marks mean nothing to Typst, bold apart."""
    return re.sub(r"([#$@<>_`~\[\]\\])", r"\\\1", text).replace("**", "*")


if __name__ == "__main__":
    sys.exit(main())
