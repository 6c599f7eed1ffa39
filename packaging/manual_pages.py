"""The user guide as pages that any browser shows, for the extension's zip: F1 works without a network.

    python packaging/manual_pages.py FOLDER

Reads the part of Markdown that the guide is written in: headings, paragraphs, lists with pictures in them, tables,
code, links, emphasis and inline HTML.
"""

from __future__ import annotations

import html
import os
import re
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("docs/guide/*.md", "docs/exchange.md", "README.md")
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
ITEM = re.compile(r"( *)([-*]|\d+\.) +(.*)")


def main() -> int:
    if len(sys.argv) != 2:
        print("Name the folder to write to: python packaging/manual_pages.py FOLDER", file=sys.stderr)
        return 2
    print(f"{write_pages(Path(sys.argv[1]))} pages written to {sys.argv[1]}")
    return 0


def write_pages(folder: Path) -> int:
    """Writes all pages and their pictures; returns how many pages. Raises: FileNotFoundError for a lost picture."""
    sources = [path for pattern in PAGES for path in sorted(ROOT.glob(pattern))]
    for source in sources:
        target = folder / source.relative_to(ROOT).with_suffix(".html")
        target.parent.mkdir(parents=True, exist_ok=True)
        text = source.read_text(encoding="utf-8")
        target.write_text(_Page(source, sources).whole(text), encoding="utf-8")
        for name in re.findall(r"\]\(([^)\s]+\.(?:png|gif))\)", text):
            picture = folder / os.path.relpath(source.parent / name, ROOT)
            picture.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source.parent / name, picture)
    return len(sources)


class _Page:
    """One page; `sources` are all that become pages, so that links between them stay links."""

    def __init__(self, source: Path, sources: list[Path]) -> None:
        self.source, self.sources = source, sources

    def whole(self, text: str) -> str:
        body = "\n".join(self.blocks(text.splitlines()))
        title = html.escape(text.partition("\n")[0].lstrip("# "))
        head = f'<meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>'
        return f"<!DOCTYPE html>\n<html><head>{head}</head><body>\n{body}\n</body></html>\n"

    def blocks(self, lines: list[str]) -> Iterator[str]:
        """HTML of the blocks that the lines make."""
        at = 0
        while at < len(lines):
            line = lines[at]
            end = at + 1
            if line.startswith("```"):
                while not lines[end].startswith("```"):
                    end += 1
                yield f"<pre>{html.escape(chr(10).join(lines[at + 1 : end]))}</pre>"
                end += 1
            elif heading := re.fullmatch(r"(#+) (.*)", line):
                anchor = re.sub(r"[^\w\- ]", "", heading[2].lower()).replace(" ", "-")
                size = len(heading[1])
                yield f'<h{size} id="{anchor}">{self.inline(heading[2])}</h{size}>'
            elif ITEM.fullmatch(line):
                # A list goes on over lines that are indented, or empty with such a line after them.
                while end < len(lines) and (
                    ITEM.fullmatch(lines[end])
                    or lines[end].startswith("  ")
                    or (not lines[end] and end + 1 < len(lines) and re.match(r"  +\S|\d+\. |- ", lines[end + 1]))
                ):
                    end += 1
                yield from self.items(lines[at:end])
            elif line.startswith("|"):
                while end < len(lines) and lines[end].startswith("|"):
                    end += 1
                yield from self.table(lines[at:end])
            elif line.strip():
                while end < len(lines) and lines[end].strip() and not re.match(r"#|```|\||[-*] |\d+\. ", lines[end]):
                    end += 1
                yield f"<p>{self.inline(' '.join(part.strip() for part in lines[at:end]))}</p>"
            at = end

    def items(self, lines: list[str]) -> Iterator[str]:
        """A list, whose items may hold any blocks."""
        first = ITEM.fullmatch(lines[0])
        kind = "ul" if first[2] in "-*" else "ol"
        start = "" if kind == "ul" else f' start="{first[2][:-1]}"'
        yield f"<{kind}{start}>"
        starts = [i for i, line in enumerate(lines) if (item := ITEM.fullmatch(line)) and item[1] == first[1]]
        for begin, end in zip(starts, [*starts[1:], len(lines)], strict=True):
            rest = lines[begin + 1 : end]
            indent = min((len(line) - len(line.lstrip()) for line in rest if line.strip()), default=0)
            inner = [ITEM.fullmatch(lines[begin])[3], *(line[indent:] for line in rest)]
            yield f"<li>{''.join(self.blocks(inner))}</li>"
        yield f"</{kind}>"

    def table(self, lines: list[str]) -> Iterator[str]:
        """A table, whose second line is the rule under its head."""
        yield "<table>"
        for number, line in enumerate(lines):
            if number != 1:
                tag = "td" if number else "th"
                cells = "".join(f"<{tag}>{self.inline(cell.strip())}</{tag}>" for cell in line.strip("|").split("|"))
                yield f"<tr>{cells}</tr>"
        yield "</table>"

    def inline(self, text: str) -> str:
        """Emphasis, code, pictures and links; inline HTML stays."""
        codes: list[str] = []

        def keep(match: re.Match[str]) -> str:
            codes.append(f"<code>{html.escape(match[1])}</code>")
            return f"\0{len(codes) - 1}\0"

        text = re.sub(r"`([^`]+)`", keep, text)
        text = re.sub(r"&(?!\w+;)", "&amp;", text)
        text = re.sub(r"<(?!/?\w)", "&lt;", text)
        text = re.sub(r"!\[([^\]]*)\]\(([^)]+)\)", r'<img alt="\1" src="\2">', text)
        text = re.sub(r"\[([^\]]*)\]\(([^)]+)\)", self.link, text)
        text = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", text)
        text = re.sub(r"\*([^*\s](?:[^*]*[^*\s])?)\*", r"<em>\1</em>", text)
        return re.sub(r"\0(\d+)\0", lambda match: codes[int(match[1])], text)

    def link(self, match: re.Match[str]) -> str:
        """A link to another page, to a place of this one or to the web; of others the text."""
        words, address = match[1], match[2]
        path, mark, place = address.partition("#")
        if "://" in address or not path:
            return f'<a href="{address}">{words}</a>'
        if (self.source.parent / path).resolve() in self.sources:
            return f'<a href="{path.removesuffix(".md")}.html{mark}{place}">{words}</a>'
        if re.fullmatch(r".*\.(png|gif)", path):
            return f'<a href="{path}">{words}</a>'
        return words


if __name__ == "__main__":
    sys.exit(main())
