"""Which files the results depend on, and whether they are still those that the results were made with.

Comments, docstrings and layout do not count: what is compared is the syntax of each file.
"""

from __future__ import annotations

import ast
import hashlib
import json
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "nestedcages_core"
BENCHMARKS = ROOT / "benchmarks"

UNUSED = ("batch", "command", "coordinates", "exchange", "motion", "__main__.py", "__init__.py")
"""Rooms of the core that no method of the comparison goes through."""

WRITING = ("report.py", "plots.py", "tables.py", "pdf.py", "digest.py", "conclusions.py")
"""Files of the comparison that write results down but have no part in them."""

FILE = "digest.json"

CHANGED = 1
"""Exit status where the results are of other code."""


def sources() -> list[Path]:
    """The files, sorted."""
    found = [path for path in CORE.rglob("*.py") if path.relative_to(CORE).parts[0] not in UNUSED]
    found += [path for path in (BENCHMARKS / "comparison").rglob("*.py") if path.name not in WRITING]
    found += [BENCHMARKS / "random_shapes.py", *(BENCHMARKS / "data").glob("*")]
    return sorted(path for path in found if path.is_file() and path.suffix in (".py", ".csv"))


def digests() -> dict[str, str]:
    """Path below the project's root -> digest."""
    return {path.relative_to(ROOT).as_posix(): _digest(path) for path in sources()}


def whole(found: dict[str, str]) -> str:
    """One digest of all."""
    return hashlib.sha256(json.dumps(found, sort_keys=True).encode()).hexdigest()[:12]


def write(folder: Path) -> None:
    """Say which sources the results in a folder are of."""
    (folder / FILE).write_text(json.dumps(digests(), indent=1, sort_keys=True) + "\n", encoding="utf-8")


def changed(folder: Path) -> list[str]:
    """Files that differ from those that the results in a folder were made with, that are new, or gone. Raises OSError
    without a record."""
    then, now = json.loads((folder / FILE).read_text(encoding="utf-8")), digests()
    return sorted(name for name in then.keys() | now.keys() if then.get(name) != now.get(name))


def check(folder: Path) -> int:
    """Say whether the results in a folder are of this code; the exit status."""
    again = "run: python benchmarks/compare.py"
    try:
        names = changed(folder)
    except OSError:
        print(f"{folder / FILE} is not there; {again}")
        return CHANGED
    for name in names:
        print(f"{name} has changed since the comparison was made")
    print(again if names else "The comparison is of this code.")
    return CHANGED if names else 0


def _digest(path: Path) -> str:
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        text = "\n".join(_syntax(ast.parse(text)))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _syntax(node: ast.AST) -> Iterator[str]:
    """The nodes of a tree in order, without docstrings and without what only some versions of Python list."""
    yield type(node).__name__
    for name, value in ast.iter_fields(node):
        if name in ("kind", "type_comment", "type_params", "ctx"):
            continue
        entries = value if isinstance(value, list) else [value]
        for entry in entries:
            if isinstance(entry, ast.Expr) and isinstance(entry.value, ast.Constant):
                continue  # a docstring, of a module, a class, a function or an attribute
            if isinstance(entry, ast.AST):
                yield f"{name}:"
                yield from _syntax(entry)
            elif entry is not None:
                yield f"{name}={entry!r}"
    yield "."
