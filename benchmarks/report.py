"""Makes a short report of the comparison as PDF: abstract, methods, experiments, limits.

    python benchmarks/report.py [--out build/report.pdf]

All numbers and plots are those of the pages, which ``benchmarks/compare.py`` writes. Needs fpdf2 and matplotlib, whose
fonts it uses (``pip install nested-cages[comparison]``).
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from clone import ROOT

PAGES = ROOT / "docs" / "comparison"
PDF = ROOT / "build" / "report.pdf"

TITLE = "Nested cages in the plane: contacts compared"
ABSTRACT = (
    "Nested cages wrap a shape in coarse outlines that strictly enclose it. Their contact resolution has been done by "
    "velocity filters, by barriers, and by quadratic programs, but never compared. We implement the published contacts "
    "as they are behind one interface, give all of them the same starts, and judge them by one exact certificate."
)
METHODS = (
    "A fine mesh flows into a coarse one and back, while contact pushes the coarse mesh out. Every contact gets the "
    "same coarse mesh and the same recorded flow, and is judged when the fine mesh is back, to the last bit: the cage "
    "must be simple and strictly enclose the shape, by exact predicates, and the motion must be free of crossings at "
    "every instant. Excess is the area of the cage over that of the shape, minus one. Times are CPU seconds of one "
    "implementation in Python and compare algorithms."
)
SIZES = {"title": 18.0, "heading": 13.0, "text": 9.5, "small": 8.0}
MARGIN, LEADING = 18.0, 1.45  # millimetres; line height over font size
MILLIMETRES_PER_POINT = 0.3528


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pages", type=Path, default=PAGES, help="folder of the results and plots (%(default)s)")
    parser.add_argument("--out", type=Path, default=PDF, help="the file to write (%(default)s)")
    options = parser.parse_args()
    results = options.pages / "results.json"
    if not results.is_file():
        print(f"{results} is not there; run: python benchmarks/compare.py", file=sys.stderr)
        return 1
    try:
        import fpdf  # noqa: F401
    except ImportError:
        print("fpdf2 is not installed: pip install -e '.[comparison]'.", file=sys.stderr)
        return 2
    make(json.loads(results.read_text(encoding="utf-8")), options.pages, options.out)
    print(f"{options.out} written")
    return 0


def make(results: dict[str, Any], pictures: Path, path: Path) -> None:
    """Write the report."""
    from comparison import report

    paper = Paper()
    paper.title(TITLE)
    claims = " ".join(said["text"].split("**")[1] for said in results["conclusions"].values() if said["holds"])
    paper.heading("Abstract")
    paper.text(f"{ABSTRACT} {claims}")
    paper.heading("1 Methods")
    paper.text(METHODS)
    paper.items(report.WHAT)
    paper.heading("2 Experiments")
    paper.text(
        f"{results['runs']:,} runs in {results['minutes']} minutes, of which contacts alone on "
        f"{results.get('starts', 0)} random shapes and glyphs. {results['machine']}."
    )
    if "contacts" in results:
        paper.text("Contacts from the same starts; medians over shapes that all solve.")
        paper.table(results["contacts"])
    if "methods" in results:
        paper.text("Whole methods: successes; medians where all leave a cage; the discs of Table 1.")
        paper.table(results["methods"])
    for name, title in report.PLOTS:
        if (pictures / name).is_file():
            paper.picture(pictures / name, title)
    paper.heading("3 Conclusions")
    paper.items(
        (said["text"] if said["holds"] else f"Contradicted by these runs: {said['text']}")
        for said in results["conclusions"].values()
    )
    if results.get("tried"):
        paper.text(results["tried"])
    paper.heading("4 Limits")
    paper.items([*report.LIMITS, *report.MORE_LIMITS])
    paper.heading("References")
    paper.items(report.REFERENCES, small=True)
    paper.write(path)


class Paper:
    """A document of one column."""

    def __init__(self) -> None:
        from fpdf import FPDF
        from matplotlib import get_data_path

        self.pdf = FPDF(format="A4")
        fonts = Path(get_data_path()) / "fonts" / "ttf"
        for style, file in (("", "DejaVuSans"), ("B", "DejaVuSans-Bold"), ("I", "DejaVuSans-Oblique")):
            self.pdf.add_font("Sans", style, fonts / f"{file}.ttf")
        self.pdf.set_margins(MARGIN, MARGIN)
        self.pdf.set_auto_page_break(True, MARGIN)
        self.pdf.set_title(TITLE)
        self.pdf.add_page()

    def title(self, text: str) -> None:
        """The title."""
        self._write(text, "title", bold=True)

    def heading(self, text: str) -> None:
        """A heading, kept with the lines after it."""
        if self.pdf.will_page_break(4 * SIZES["heading"] * MILLIMETRES_PER_POINT * LEADING):
            self.pdf.add_page()
        self.pdf.ln(2.0)
        self._write(text, "heading", bold=True)

    def text(self, text: str, size: str = "text") -> None:
        """A paragraph, with ** and * as in Markdown."""
        self._write(plain(text), size)

    def items(self, texts: Any, *, small: bool = False) -> None:
        """Paragraphs with bullets."""
        for text in texts:
            self._write(f"• {plain(text)}", "small" if small else "text")

    def table(self, rows: list[list[str]]) -> None:
        """A table, the first column wider, the first row its headings."""
        from fpdf.fonts import FontFace

        self.pdf.set_font("Sans", size=SIZES["small"])
        widths = (2.2, *[1.0] * (len(rows[0]) - 1))
        with self.pdf.table(col_widths=widths, headings_style=FontFace(emphasis="BOLD")) as table:
            for row in rows:
                table.row(row)
        self.pdf.ln(2.0)

    def picture(self, path: Path, title: str) -> None:
        """A picture over the whole width, with its title."""
        from PIL import Image

        with Image.open(path) as opened:
            width = min(self.pdf.epw, self.pdf.epw * opened.width / 900.0)
            height = width * opened.height / opened.width
        if height > 0.85 * self.pdf.eph:
            width, height = width * 0.85 * self.pdf.eph / height, 0.85 * self.pdf.eph
        if self.pdf.will_page_break(height + 8.0):
            self.pdf.add_page()
        self.pdf.image(path, w=width)
        self._write(title, "small")

    def write(self, path: Path) -> None:
        """Write the file."""
        path.parent.mkdir(parents=True, exist_ok=True)
        self.pdf.output(str(path))

    def _write(self, text: str, size: str, *, bold: bool = False) -> None:
        self.pdf.set_font("Sans", "B" if bold else "", SIZES[size])
        line = SIZES[size] * MILLIMETRES_PER_POINT * LEADING
        self.pdf.multi_cell(0, line, text, markdown=not bold, new_x="LMARGIN", new_y="NEXT")
        self.pdf.ln(0.35 * line)


def plain(text: str) -> str:
    """Markdown as the PDF writer has it: ** for bold, __ for italics, no code."""
    parts = text.replace("`", "").split("**")
    return "**".join(part.replace("__", "").replace("*", "__") for part in parts)


if __name__ == "__main__":
    sys.exit(main())
