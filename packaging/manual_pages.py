"""The user guide as pages that any browser shows, for the extension's zip: F1 works without a network.

    python packaging/manual_pages.py FOLDER

Needs markdown-it-py (``pip install markdown-it-py``), which reads Markdown as code hosts do.
"""

from __future__ import annotations

import html
import os
import re
import shutil
import sys
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("docs/guide/*.md", "docs/formats.md")
"""What becomes a page, at the same place below the output folder; ``docs/guide/README.md`` is where they begin."""

STYLE = """
body { max-width: 46em; margin: 2em auto; padding: 0 1em; font: 16px/1.5 system-ui, sans-serif; color: #222 }
img { max-width: 100%; border: 1px solid #ccc }
table { border-collapse: collapse } td, th { border: 1px solid #ccc; padding: .3em .6em; text-align: left }
pre { background: #f4f4f4; padding: .8em; overflow-x: auto } code { background: #f4f4f4 }
kbd { border: 1px solid #aaa; border-radius: 3px; padding: 0 .3em; background: #f4f4f4 }
@media (prefers-color-scheme: dark) { body { background: #222; color: #ddd } a { color: #8bf }
  pre, code, kbd { background: #333 } }
"""
MARKDOWN = MarkdownIt("commonmark", {"html": True, "xhtmlOut": False}).enable("table")


def main() -> int:
    if len(sys.argv) != 2:
        print("Name the folder to write to: python packaging/manual_pages.py FOLDER", file=sys.stderr)
        return 2
    print(f"{write_pages(Path(sys.argv[1]))} pages written to {sys.argv[1]}")
    return 0


def write_pages(folder: Path) -> int:
    """Write all pages and their pictures; return the number of pages. Raises FileNotFoundError if one is missing."""
    sources = [path for pattern in PAGES for path in sorted(ROOT.glob(pattern))]
    for source in sources:
        target = folder / source.relative_to(ROOT).with_suffix(".html")
        target.parent.mkdir(parents=True, exist_ok=True)
        page, pictures = page_of(source, sources)
        target.write_text(page, encoding="utf-8")
        for name in pictures:
            picture = folder / os.path.relpath(source.parent / name, ROOT)
            picture.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source.parent / name, picture)
    return len(sources)


def page_of(source: Path, sources: Sequence[Path]) -> tuple[str, list[str]]:
    """HTML of one page, and the pictures that it shows or links; links to other `sources` lead to their pages."""
    text = source.read_text(encoding="utf-8")
    tokens = MARKDOWN.parse(text)
    pictures = [name for token in flattened(tokens) if (name := picture_of(token))]
    for heading, content in pairwise(tokens):
        if heading.type == "heading_open":
            heading.attrSet("id", anchor(content.content))
    for token in tokens:
        if token.children:
            token.children = list(with_working_links(token.children, source, sources))
    body = MARKDOWN.renderer.render(tokens, MARKDOWN.options, {})
    title = html.escape(text.partition("\n")[0].lstrip("# "))
    head = f'<meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>'
    return f"<!DOCTYPE html>\n<html><head>{head}</head><body>\n{body}</body></html>\n", pictures


def flattened(tokens: Sequence[Token]) -> Iterator[Token]:
    """All tokens, those of inline text included."""
    for token in tokens:
        yield token
        yield from flattened(token.children or ())


def picture_of(token: Token) -> str | None:
    """The file of the picture that a token shows or links."""
    address = token.attrGet({"image": "src", "link_open": "href"}.get(token.type, ""))
    return str(address) if address and re.fullmatch(r"[^:]+\.(png|gif)", str(address)) else None


def anchor(heading: str) -> str:
    """The id of a heading, as code hosts make it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def with_working_links(tokens: Sequence[Token], source: Path, sources: Sequence[Path]) -> Iterator[Token]:
    """Inline tokens whose links lead to pages, pictures or the web; links to anything else become plain text."""
    dropped: list[bool] = []
    for token in tokens:
        if token.type == "link_open":
            address = str(token.attrGet("href"))
            path, mark, place = address.partition("#")
            to_page = bool(path) and "://" not in address and (source.parent / path).resolve() in sources
            if to_page:
                token.attrSet("href", f"{path.removesuffix('.md')}.html{mark}{place}")
            dropped.append(not (to_page or "://" in address or not path or picture_of(token)))
            if dropped[-1]:
                continue
        elif token.type == "link_close" and dropped.pop():
            continue
        yield token


if __name__ == "__main__":
    sys.exit(main())
