"""Checks the site that mkdocs has built: lists, tables, pictures, links, pages of error codes, search and dark mode.

    python packaging/check_site.py [build/site]

Prints what is wrong, page by page; the exit status is 1 if anything is.
"""

from __future__ import annotations

import json
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

ROOT = Path(__file__).resolve().parents[1]
DOORS = ("docs/guide/index.html", "docs/python.html", "docs/method.html")
"""Pages that the front page leads to: Blender, Python, research."""

UNREAD = re.compile(r"(^|\n)\s*(\d+\. |[-*] |\||#+ |```)")
"""Markdown that was not understood, at the beginning of a line of text."""


class Page(HTMLParser):
    """What one page of the site has."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.ids: set[str] = set()
        self.unnamed: list[str] = []
        self.text: list[str] = []
        self._inside = ""
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.ids |= {given[name] for name in ("id", "name") if given.get(name)}
        if tag == "img" and not given.get("alt", "").strip():
            self.unnamed.append(given.get("src", ""))
        self.links += [given[name] for name in ("href", "src") if given.get(name)]
        if tag in {"p", "pre"}:
            self._inside = tag
            self.text.append("")

    def handle_endtag(self, tag: str) -> None:
        self._inside = "" if tag in {"p", "pre"} else self._inside

    def handle_data(self, data: str) -> None:
        if self._inside == "p":
            self.text[-1] += data


def problems(site: Path, codes: list[str]) -> list[str]:
    """What is wrong with a site, a sentence each."""
    pages = {path.resolve(): Page(path) for path in sorted(site.rglob("*.html")) if path.name != "404.html"}
    found = []
    for path, page in pages.items():
        name = path.relative_to(site.resolve())
        found += [f"{name}: the picture {source} has no alternative text" for source in page.unnamed]
        found += [f"{name}: a list or table is plain text: {text[:60]!r}" for text in page.text if UNREAD.search(text)]
        for link in page.links:
            parts = urlsplit(link)
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if parts.scheme or parts.netloc or link.startswith("data:"):
                continue
            if not target.exists():
                found.append(f"{name}: the link {link} leads nowhere")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].ids:
                found.append(f"{name}: the link {link} names a place that is not there")
    front = pages.get((site / "index.html").resolve())
    missing = [door for door in DOORS if front is None or door not in front.links]
    found += [f"index.html: the front page does not lead to {door}" for door in missing]
    found += [f"errors/{code}.html is missing" for code in codes if not (site / "errors" / f"{code}.html").is_file()]
    index = site / "search" / "search_index.json"
    if not index.is_file() or not json.loads(index.read_text(encoding="utf-8"))["docs"]:
        found.append("search/search_index.json: nothing can be searched")
    if front is not None and 'data-md-color-scheme="slate"' not in (site / "index.html").read_text(encoding="utf-8"):
        found.append("index.html: there is no dark mode")
    return found


def main() -> int:
    site = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build" / "site"
    table = (ROOT / "docs" / "errors.md").read_text(encoding="utf-8")
    found = problems(site, re.findall(r"^\| `([\w.]+)` \|", table, re.MULTILINE))
    print("\n".join(found) or f"{sum(1 for _ in site.rglob('*.html'))} pages, nothing wrong")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
