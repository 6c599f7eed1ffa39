"""Puts what a benchmark found into a page of the documentation, between the two comments that name it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from datetime import date
from functools import cache
from pathlib import Path

from clone import ROOT

MEASURED = ROOT / "docs" / "measured"
"""Everything that the benchmarks printed, one file each."""


def measured(page: Path, name: str, command: str, printed: str, shown: str) -> None:
    """Keep all that a command printed, and put what is shown of it into a page, with commit and date."""
    of = stamp()
    MEASURED.mkdir(exist_ok=True)
    kept = MEASURED / f"{name}.txt"
    kept.write_text(f"{command}\n{of}\n\n{printed.strip()}\n", encoding="utf-8")
    link = Path(os.path.relpath(kept, page.parent)).as_posix()
    put(page, name, f"{shown}\n\n`{command}`, {of}: [output]({link}).".strip())


def put(page: Path, name: str, text: str) -> None:
    """Put a text in its place. Exits with a sentence where the page has none."""
    before = page.read_text(encoding="utf-8")
    place = re.compile(rf"(<!-- table {name} -->)\n.*?(<!-- end of table {name} -->)", re.DOTALL)
    if not place.search(before):
        sys.exit(f"{page.name} has no place for the table: <!-- table {name} --> and <!-- end of table {name} -->.")
    page.write_text(place.sub(lambda found: f"{found[1]}\n\n{text}\n\n{found[2]}", before), encoding="utf-8")


def stamp() -> str:
    """Commit and date of what is measured now."""
    return f"commit {commit()}, {date.today()}"


@cache
def commit() -> str:
    """The commit of this clone when first asked, with a sign where files differ from it."""
    told = subprocess.run(
        ["git", "describe", "--always", "--dirty=+", "--exclude=*"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    return told.stdout.strip() or "unknown"
