"""What cages are needed for, measured on the drawn shapes: the numbers of the pages in docs/needs.

    python benchmarks/needs.py                                  # all tables
    python benchmarks/needs.py grids --shapes glyph_g koch_4    # one table, some shapes
    python benchmarks/needs.py --write                          # puts tables into docs/measured, conclusions into pages

Exit status 1 if a cage is not certified.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping

from clone import ROOT
from data import shape, shape_names
from needed import convex, grids, inner, pieces, symmetry, within
from needed.table import Table
from nestedcages_core import Mesh
from page import measured

TABLES: dict[str, Callable[[Mapping[str, Mesh]], Table]] = {
    "within": within.table,
    "inner": inner.table,
    "grids": grids.table,
    "convex": convex.table,
    "pieces": pieces.table,
    "symmetry": symmetry.table,
}
"""Each makes a table of shapes by their names."""

PAGES = {
    "within": "tolerance",
    "inner": "inner",
    "grids": "grid",
    "convex": "convex",
    "pieces": "convex",
    "symmetry": "symmetry",
}
"""Page of each table in docs/needs."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"only these: {', '.join(TABLES)}")
    parser.add_argument("--shapes", nargs="*", help="only these shapes")
    parser.add_argument("--write", action="store_true", help="put them into the documentation")
    options = parser.parse_args()
    unknown = [name for name in options.tables if name not in TABLES]
    if unknown:
        parser.error(f"there is no table {unknown[0]!r}; there are {', '.join(TABLES)}")
    shapes = {name: shape(name) for name in shape_names(None, options.shapes)}
    good = True
    for name in options.tables or TABLES:
        made = TABLES[name](shapes)
        good = good and made.good
        print(f"{name}\n{made}\n", flush=True)
        if options.write:
            page = ROOT / "docs" / "needs" / f"{PAGES[name]}.md"
            measured(page, name, f"python benchmarks/needs.py {name}", str(made), made.after)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
