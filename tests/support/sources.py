"""The project's Python files, each read and parsed once."""

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@cache
def sources(*folders: str) -> dict[str, str]:
    """Path from the root -> source of each Python file in some folders of the project, or in all that belong to it."""
    places = [ROOT / name for name in folders] or [
        path for path in ROOT.iterdir() if path.is_dir() and path.name[0] != "." and path.name not in {"build", "dist"}
    ]
    files = [*(() if folders else ROOT.glob("*.py")), *(path for place in places for path in place.rglob("*.py"))]
    return {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in sorted(files)}


@cache
def nodes(source: str) -> list[ast.AST]:
    """All nodes of a source, the module first."""
    return list(ast.walk(ast.parse(source)))
