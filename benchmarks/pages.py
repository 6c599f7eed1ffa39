"""Writes what a benchmark printed into docs/measured, and into the pages that have a place for it."""

from __future__ import annotations

import os
import platform
import re
import subprocess
from datetime import date
from functools import cache
from pathlib import Path

import numpy as np

from common import DETAILS, ROOT

MEASURED = ROOT / "docs" / "measured"


def write(name: str, command: str, printed: str) -> None:
    """Keep all of it with command, commit and date; pages show what comes before the details.

    A place is ``<!-- table NAME -->`` … ``<!-- end of table NAME -->``, or NAME_PART for a part of several. README.md
    shows the last paragraph only.
    """
    stamp = f"commit {commit()}, {date.today()}"
    MEASURED.mkdir(exist_ok=True)
    kept = MEASURED / f"{name}.txt"
    kept.write_text(f"{command}\n{stamp}\n{machine()}\n\n{printed}\n", encoding="utf-8")
    for page in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]:
        text = changed = page.read_text(encoding="utf-8")
        link = Path(os.path.relpath(kept, page.parent)).as_posix()
        for place, shown in shown_of(name, printed).items():
            text_of = shown.rpartition("\n\n")[2] if page.name == "README.md" else shown
            block = f"```text\n{text_of}\n```" if "\n" in text_of else text_of
            between = f"\n\n{block}\n\n`{command}`, {stamp}: [output]({link}).\n\n"
            where = re.compile(rf"(<!-- table {place} -->)\n.*?(<!-- end of table {place} -->)", re.DOTALL)
            changed = where.sub(lambda found, between=between: f"{found[1]}{between}{found[2]}", changed)
        if changed != text:
            page.write_text(changed, encoding="utf-8")


def shown_of(name: str, printed: str) -> dict[str, str]:
    """What pages show: place -> all of it, and of each part, up to the details."""
    pieces = re.split(r"^\[(\w+)\]\n", printed, flags=re.MULTILINE)
    found = {f"{name}_{part}": text for part, text in zip(pieces[1::2], pieces[2::2], strict=True)}
    return {place: text.partition(f"\n{DETAILS}\n")[0].strip("\n") for place, text in {name: printed, **found}.items()}


def machine() -> str:
    """The processor, as far as the system tells, and versions."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{(names or [platform.machine()])[0]}, Python {platform.python_version()}, numpy {np.__version__}"


@cache
def commit() -> str:
    """The commit of this clone when first asked, with a sign where its code differs from it."""

    def git(*words: str) -> str:
        done = subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=False)
        return done.stdout.strip()

    changed = git("status", "--porcelain", "--untracked-files=no", "--", "nestedcages_core", "benchmarks", "addon")
    return (git("rev-parse", "--short=8", "HEAD") or "unknown") + ("+" if changed else "")
