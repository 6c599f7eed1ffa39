"""The documentation is true: links lead somewhere, Python runs, the diagrams are up to date."""

import doctest
import importlib.util
import os
import pkgutil
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

import nestedcages_core
from support.sources import ROOT

PAGES = [
    path
    for folder in (".", "docs", "docs/guide", "benchmarks", "examples")
    for path in sorted((ROOT / folder).glob("*.md"))
]
PYTHON = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)


def anchors(page: Path) -> set[str]:
    """The ids of a page's headings, as code hosts make them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def links_lead_somewhere(page: Path) -> None:
    for address in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if address.startswith(("http://", "https://")):
            continue
        name, _, place = address.partition("#")
        target = (page.parent / name).resolve() if name else page
        assert target.is_file(), address
        assert not place or place in anchors(target), address


class Elements(HTMLParser):
    """Counts the elements that a reader sees."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.counted: Counter[str] = Counter()
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag in {"h1", "h2", "h3", "img", "kbd", "li", "ol", "pre", "table", "tr", "ul"}:
            self.counted[tag] += 1


def pages_look_alike_on_code_hosts_and_on_the_site(page: Path) -> None:
    markdown, markdown_it = pytest.importorskip("markdown"), pytest.importorskip("markdown_it")
    pytest.importorskip("pymdownx")
    text = page.read_text(encoding="utf-8")
    host = markdown_it.MarkdownIt("gfm-like", {"linkify": False}).render(text)
    named = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("markdown_extensions:")[2].partition("\n\n")[0]
    extensions = re.findall(r"^  - ([\w.]+)", named, flags=re.MULTILINE)
    assert "tables" in extensions
    site = markdown.Markdown(extensions=extensions).convert(text)
    assert Elements(site).counted == Elements(host).counted


def pictures_have_a_text(page: Path) -> None:
    assert re.findall(r"!\[\s*\]\([^)]*\)", page.read_text(encoding="utf-8")) == []


def numbers_are_those_that_were_measured(page: Path) -> None:
    """What a page shows of a benchmark stands in the file that has all of it, with the same commit and date."""
    text = page.read_text(encoding="utf-8")
    for name, shown in re.findall(r"<!-- table (\w+) -->\n(.*?)<!-- end of table \1 -->", text, flags=re.DOTALL):
        lines = [line.strip() for line in shown.splitlines() if line.strip() and not line.startswith("```")]
        stamp = re.fullmatch(r"`(.*)`, (commit \S+, [\d-]+): \[output\]\((.*)\)\.", lines[-1])
        assert stamp is not None, f"{name} does not say when and of which commit it was measured"
        whole = (page.parent / stamp[3]).read_text(encoding="utf-8")
        assert whole.startswith(f"{stamp[1]}\n{stamp[2]}\n"), name
        assert [line for line in lines[:-1] if line not in whole] == [], name


PAGES_LOOK_ALIKE = pages_look_alike_on_code_hosts_and_on_the_site
HOLD = (links_lead_somewhere, PAGES_LOOK_ALIKE, pictures_have_a_text, numbers_are_those_that_were_measured)


@pytest.mark.parametrize("hold", HOLD)
def test_all_pages(hold: Callable[[Path], None]) -> None:
    for page in PAGES:
        hold(page)


def test_the_architecture_names_files_that_are_there() -> None:
    text = "".join((ROOT / "docs" / page).read_text(encoding="utf-8") for page in ("architecture.md", "method.md"))
    core = ROOT / "nestedcages_core"
    named = re.findall(r"`([\w/]+(?:/|\.py))`", text)
    assert len(named) > 40
    folders = (ROOT, core, core / "published", core / "levels")
    assert [name for name in named if not any((folder / name).exists() for folder in folders)] == []
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    tests = {path.name for path in (ROOT / "tests").rglob("test_*.py")}
    assert set(re.findall(r"`(?:tests/)?(test_\w+\.py)`", text)) <= tests


@pytest.fixture
def packaging(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "packaging"))
    return importlib.import_module("docs_pages")


def test_every_code_of_an_error_has_a_page(packaging: ModuleType) -> None:
    text = (ROOT / "docs" / "errors.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `([\w.]+)` \|.* \| (.*) \|$", text, flags=re.MULTILINE))
    assert {code: tuple(re.findall(r"`(\w+)`", data)) for code, data in rows.items()} == dict(nestedcages_core.CODES)
    pages = packaging.error_pages(text)
    assert list(pages) == list(rows)


def test_the_reference_has_every_public_name(packaging: ModuleType) -> None:
    page = packaging.core_page()
    assert re.findall(r"^::: nestedcages_core\.(\w+)$", page, flags=re.MULTILINE) == list(nestedcages_core.__all__)
    assert page.count("\n## ") >= 5


@pytest.mark.check
@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if PYTHON.search(page.read_text(encoding="utf-8"))],
    ids=lambda page: page.relative_to(ROOT).as_posix(),
)
def test_the_python_of_a_page_runs(page: Path, tmp_path: Path) -> None:
    blocks = PYTHON.findall(page.read_text(encoding="utf-8"))
    if importlib.util.find_spec("joblib") is None:
        blocks = [block for block in blocks if "joblib" not in block]
    source = "\n".join(blocks).replace("/tmp/", f"{tmp_path.as_posix()}/")
    if "bpy" in source:
        pytest.importorskip("bpy")
        enable = 'bpy.ops.preferences.addon_enable(module="bl_ext.user_default.nested_cages")'
        assert enable in source
        # the installed extension is tried by packaging/try_extension.py; here it is the one of this clone
        source = source.replace(enable, REGISTER).replace("bl_ext.user_default.nested_cages", "extension") + UNREGISTER
    script = tmp_path / "page.py"
    script.write_text(source, encoding="utf-8")
    env = {**os.environ, "PYTHONPATH": str(ROOT), "MPLBACKEND": "agg"}
    command = [sys.executable, str(script)]
    done = subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr + done.stdout


def test_the_line_for_a_whole_geodataframe_runs() -> None:
    shapely = pytest.importorskip("shapely")

    class Series(list):  # a GeoSeries maps like this
        def map(self, function: Callable) -> list:
            return [function(shape) for shape in self]

    (line,) = re.findall(r"`(frame\.geometry\.map.*)`", (ROOT / "docs" / "python.md").read_text(encoding="utf-8"))
    islands = shapely.union(shapely.Point(0, 0).buffer(1), shapely.Point(4, 0).buffer(1))
    frame = SimpleNamespace(geometry=Series([shapely.Point(0, 0).buffer(2), islands]))
    made = eval(line, {"frame": frame, "shapely": shapely, "nested_cages": nestedcages_core.nested_cages})
    assert [cage.geom_type for cage in made] == ["Polygon", "MultiPolygon"]
    assert all(cage.contains(shape) for cage, shape in zip(made, frame.geometry, strict=True))


REGISTER = f"""
import importlib.util, sys
root = {str(ROOT)!r}
spec = importlib.util.spec_from_file_location("extension", root + "/__init__.py", submodule_search_locations=[root])
extension = sys.modules["extension"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(extension)
extension.register()
"""
UNREGISTER = "\nextension.unregister()\n"


@pytest.mark.slow
def test_the_examples_in_docstrings_run() -> None:
    tried = 0
    for module in pkgutil.walk_packages(nestedcages_core.__path__, "nestedcages_core."):
        if not module.name.endswith("__main__"):
            outcome = doctest.testmod(importlib.import_module(module.name), optionflags=doctest.NORMALIZE_WHITESPACE)
            assert outcome.failed == 0, module.name
            tried += outcome.attempted
    assert tried > 0
