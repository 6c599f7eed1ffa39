"""F1 leads to pages that exist."""

from __future__ import annotations

import re
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest
from bl_operators.wm import WM_OT_doc_view_manual as DocView

from support.sources import ROOT

sys.path.insert(0, str(ROOT / "packaging"))

import manual_pages


@pytest.fixture
def manual(extension):
    return sys.modules[f"{extension.__name__}.addon.ui.online_manual"]


@pytest.mark.parametrize(
    ("name", "page"),
    [
        ("bpy.ops.object.nested_cages_generate", "cages"),
        ("bpy.ops.object.nested_cages_verify", "verify"),
        ("bpy.ops.object.nested_cages_rebind", "bind"),
        ("bpy.ops.scene.nested_cages_use_preset", "levels"),
        ("bpy.types.NestedCagesSettings.clearance", "levels"),
        ("bpy.types.NestedCagesSettings.shrink", "animation"),
        ("bpy.types.NestedCagesSettings.energy", "levels"),
        ("bpy.types.OBJECT_OT_nested_cages_generate.as_published", "levels"),
        ("bpy.types.NestedCagesSettings.thickness", "cages"),
        ("bpy.types.NestedCagesPreferences.category", "install"),
        ("bpy.types.OBJECT_OT_nested_cages_generate.resolution", "cages"),
    ],
)
def test_f1_leads_to_a_page_of_the_guide(manual, name, page) -> None:
    url = DocView._lookup_rna_url(name, verbose=False)
    assert url == (ROOT / "docs" / "guide" / f"{page}.md").as_uri()


def test_f1_leads_to_the_pages_that_the_zip_brings(manual, monkeypatch, tmp_path) -> None:
    guides = [(tmp_path / "manual" / "docs" / "guide", ".html"), *manual.GUIDES[1:]]
    assert manual.GUIDES[0][0].relative_to(ROOT) == Path("manual", "docs", "guide")
    monkeypatch.setattr(manual, "GUIDES", guides)
    assert manual_pages.write_pages(tmp_path / "manual") >= len({page for _, page in manual.PAGES})
    prefix, pages = manual.manual_map()
    assert prefix == f"{guides[0][0].as_uri()}/"
    for _, page in pages:
        assert (guides[0][0] / page).is_file(), page


class Links(HTMLParser):
    """What a page links to and shows, its anchors, and what it says."""

    def __init__(self, path) -> None:
        super().__init__()
        self.found, self.anchors, self.text, self.open = [], set(), [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes) -> None:
        given = dict(attributes)
        self.found += [given[name] for name in ("href", "src") if name in given]
        self.anchors |= {given["id"]} if "id" in given else set()
        if tag not in {"img", "meta"}:
            self.open.append(tag)

    def handle_endtag(self, tag) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data) -> None:
        if not {"pre", "code", "style"} & set(self.open):
            self.text.append(data)


def test_the_pages_are_whole(tmp_path) -> None:
    manual_pages.write_pages(tmp_path)
    pages = {path: Links(path) for path in tmp_path.rglob("*.html")}
    assert len(pages) >= 14
    for path, page in pages.items():
        assert not page.open
        said = "".join(page.text)
        for mark in ("](", "**", "|--", "```", "\n#", "&lt;"):
            assert mark not in said, (path.name, mark)
        assert not re.search(r"(?<![\w*])\*\w", said), path.name
        for address in page.found:
            if "://" not in address:
                name, _, place = address.partition("#")
                target = (path.parent / name).resolve() if name else path
                assert target.is_file(), (path.name, address)
                assert not place or place in pages[target].anchors, (path.name, address)
    words = set(re.findall(r"[a-z]{4,}", "".join(pages[tmp_path / "docs" / "guide" / "cages.html"].text).lower()))
    source = (ROOT / "docs" / "guide" / "cages.md").read_text(encoding="utf-8")
    source = re.sub(r"!?\[[^\]]*\]\([^)]*\)|`[^`]*`", "", source)
    assert words >= set(re.findall(r"[a-z]{4,}", source.lower()))


def test_without_the_guide_there_are_no_pages(manual, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(manual, "GUIDES", ((tmp_path / "nowhere", ".md"),))
    assert manual.manual_map() == ("", ())


def test_other_pages_are_left_to_blender(extension) -> None:
    url = DocView._lookup_rna_url("bpy.types.Object.location", verbose=False)
    assert url is not None and "nested" not in url
