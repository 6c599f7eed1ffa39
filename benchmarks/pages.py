"""Writes what a benchmark printed into docs/measured, and into the pages that have a place for it."""

from __future__ import annotations

import os
import re
import subprocess
from datetime import date
from functools import cache
from pathlib import Path

from common import DETAILS, ROOT

MEASURED = ROOT / "docs" / "measured"


def write(name: str, command: str, printed: str) -> None:
    """Keep all of it with command, commit and date; pages show what comes before the details.

    A place is ``<!-- table NAME -->`` … ``<!-- end of table NAME -->``. README.md shows the last paragraph only.
    """
    stamp = f"commit {commit()}, {date.today()}"
    MEASURED.mkdir(exist_ok=True)
    kept = MEASURED / f"{name}.txt"
    kept.write_text(f"{command}\n{stamp}\n\n{printed}\n", encoding="utf-8")
    shown = printed.partition(f"\n{DETAILS}\n")[0].strip("\n")
    place = re.compile(rf"(<!-- table {name} -->)\n.*?(<!-- end of table {name} -->)", re.DOTALL)
    for page in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]:
        text = page.read_text(encoding="utf-8")
        block = shown.rpartition("\n\n")[2] if page.name == "README.md" else f"```text\n{shown}\n```"
        link = Path(os.path.relpath(kept, page.parent)).as_posix()
        block += f"\n\n`{command}`, {stamp}: [output]({link})."
        changed = place.sub(lambda found, block=block: f"{found[1]}\n\n{block}\n\n{found[2]}", text)
        if changed != text:
            page.write_text(changed, encoding="utf-8")


@cache
def commit() -> str:
    """The commit of this clone when first asked, with a sign where files differ from it."""
    words = ["git", "-C", str(ROOT), "describe", "--always", "--dirty=+", "--exclude=*"]
    told = subprocess.run(words, capture_output=True, text=True, check=False)
    return told.stdout.strip() or "unknown"
