"""Puts what a benchmark has found into a page of the documentation, between the two comments that name it."""

from __future__ import annotations

import re
import sys


def placed(page: str, name: str, text: str) -> str:
    """The page with a text in its place. Exits with a sentence where it has none."""
    place = re.compile(rf"(<!-- table {name} -->)\n.*?(<!-- end of table {name} -->)", re.DOTALL)
    if not place.search(page):
        sys.exit(f"The page has no place for the table: <!-- table {name} --> and <!-- end of table {name} -->.")
    return place.sub(lambda found: f"{found[1]}\n\n{text}\n\n{found[2]}", page)
