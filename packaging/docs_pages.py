"""Gathers the pages of the documentation's site in build/pages, where mkdocs finds them.

    python packaging/docs_pages.py

The pages keep their places, so that links between them are the same on a code host and on the site. What a page links
to comes along. The API reference lists the public names of the core and its packages; mkdocstrings fills it in.
"""

from __future__ import annotations

import ast
import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CORE = ROOT / "nestedcages_core"
PAGES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "benchmarks/README.md", "examples/README.md")
SITE = ROOT / "build" / "pages"

LINK = re.compile(r"\]\(((?!https?:|#)[^)\s#]+)")
GROUP = re.compile(r'^    (?:# (?P<title>.*)|"(?P<name>\w+)",)$', re.MULTILINE)


def main() -> int:
    shutil.rmtree(SITE, ignore_errors=True)
    sources = [ROOT / name for name in PAGES if (ROOT / name).is_file()] + sorted((ROOT / "docs").rglob("*.md"))
    for source in sources:
        text = source.read_text(encoding="utf-8")
        write(source.relative_to(ROOT), text)
        for name in LINK.findall(text):
            target = (source.parent / name).resolve()
            if target.is_file() and target.suffix != ".md":
                copy = SITE / target.relative_to(ROOT)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(target, copy)
    codes = error_pages((ROOT / "docs" / "errors.md").read_text(encoding="utf-8"))
    for name, text in codes.items():
        write(Path("errors") / f"{name}.md", text)
    write(Path("api/core.md"), core_page())
    write(Path("api/packages.md"), packages_page())
    print(f"{len(sources) + len(codes) + 2} pages gathered in {SITE.relative_to(ROOT)}")
    return 0


def write(place: Path, text: str) -> None:
    """Write a page of the site."""
    (SITE / place).parent.mkdir(parents=True, exist_ok=True)
    (SITE / place).write_text(text, encoding="utf-8")


def error_pages(listed: str) -> dict[str, str]:
    """A page for each code in the tables of docs/errors.md."""
    pages = {}
    for code, meaning, data in re.findall(r"^\| `([\w.]+)` \| (.*) \| (.*) \|$", listed, re.MULTILINE):
        meaning = meaning.replace("](constraints.md", "](../docs/constraints.md")
        lines = [f"# {code}", "", meaning, "", f"Data: {data or 'none'}.", "", "[All codes](../docs/errors.md)", ""]
        pages[code] = "\n".join(lines)
    return pages


def core_page() -> str:
    """The names at the top of the core, in its own order and groups."""
    source = (CORE / "__init__.py").read_text(encoding="utf-8")
    lines = ["# The core", "", "What most programs need: `from nestedcages_core import ...`.", ""]
    for match in GROUP.finditer(source[source.index("__all__ =") :]):
        if match["title"]:
            lines += [f"## {match['title'].capitalize()}", ""]
        else:
            lines += [f"::: nestedcages_core.{match['name']}", ""]
    return "\n".join(lines)


def packages_page() -> str:
    """The public names of each package that are not at the top."""
    top = set(offered(CORE / "__init__.py"))
    lines = ["# The packages", "", "Public names of each package that are not at the top.", ""]
    for path in sorted(CORE.rglob("*.py")):
        names = [name for name in offered(path) if name not in top]
        if names and path != CORE / "__init__.py":
            module = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
            first = (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n")[0]
            lines += [f"## {module}", "", first, ""]
            for name in names:
                lines += [f"::: {module}.{name}", ""]
    return "\n".join(lines)


def offered(path: Path) -> list[str]:
    """The `__all__` of a file."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__":
            return list(ast.literal_eval(node.value))
    return []


if __name__ == "__main__":
    sys.exit(main())
