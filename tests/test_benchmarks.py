"""The benchmarks run from a fresh clone, their shapes are the ones on record, and peers are counted in full."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import shapely

ROOT = Path(__file__).resolve().parents[1]
BENCHMARKS = ROOT / "benchmarks"
PARTS = ("bent.py", "clone.py", "mechanisms.py", "page.py", "random_shapes.py", "shortcut_hulls.py")  # of the others
SCRIPTS = sorted(path.name for path in BENCHMARKS.glob("*.py") if path.name not in PARTS)
NEEDS = {"bpy", "hypothesis", "ipctk", "matplotlib", "nestedcages_core", "numpy", "scipy", "shapely"}


@pytest.fixture
def data(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import data

    return data


def imported(tree: ast.AST) -> list[str]:
    """The first parts of the modules that a file imports at its top, in order."""
    found: list[str] = []
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            found += [alias.name.partition(".")[0] for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.append(node.module.partition(".")[0])
    return found


def test_a_benchmark_finds_the_core_in_a_clone() -> None:
    own = {path.stem for path in BENCHMARKS.iterdir()}
    doors = {
        "bent",
        "binding",
        "cast",
        "clone",
        "data",
        "maps",
    }  # on the path by these, or no need
    for script in SCRIPTS:
        modules = imported(ast.parse((BENCHMARKS / script).read_text(encoding="utf-8")))
        assert set(modules) <= sys.stdlib_module_names | own | NEEDS, script
        assert next(name for name in modules if name in own or name == "nestedcages_core") in doors, script


@pytest.mark.slow
def test_a_benchmark_runs_where_the_package_is_not_installed(tmp_path: Path) -> None:
    # an editable installation is made known by a finder
    run = f"""
import runpy, sys
sys.meta_path = [finder for finder in sys.meta_path if "editable" not in str(finder).lower()]
sys.path = [{str(BENCHMARKS)!r}, *(entry for entry in sys.path if entry != {str(ROOT)!r})]
sys.argv = ["table1.py", "--repeats", "1"]
runpy.run_path({str(BENCHMARKS / "table1.py")!r}, run_name="__main__")
"""
    done = subprocess.run(
        [sys.executable, "-P", "-c", run], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "ratio of times, C++ to ours" in done.stdout


def test_no_command_names_a_folder_outside_the_repository() -> None:
    pages = [*BENCHMARKS.rglob("*.py"), *ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), ROOT / "Makefile"]
    named = [path.name for path in pages if "../shared" in path.read_text(encoding="utf-8")]
    assert named == []


def test_drawn_shapes_are_the_ones_on_record(data: ModuleType) -> None:
    # vertices and area of the shapes that the records were set on
    expected = {
        "blob_500": (500, 3.182349),
        "blob_2000": (2000, 3.183747),
        "comb": (401, 2.268),
        "disc_64": (128, 2.352411),
        "koch_4": (768, 2.048049),
        "star200": (200, 1.322517),
    }
    for name, (count, area) in expected.items():
        mesh = data.shape(name)
        assert len(mesh.vertices) == count
        assert mesh.area == pytest.approx(area, abs=1e-6), name
    assert {name for name, _ in data.read_records()} == set(data.shape_names())


def test_glyphs_are_the_ones_on_record(data: ModuleType) -> None:
    pytest.importorskip("matplotlib")
    assert len(data.shape("glyph_B").vertices) == 201
    assert len(data.shape("glyph_g").vertices) == 293


def test_table_1_has_the_rows_of_the_paper(data: ModuleType) -> None:
    rows = data.read_table1()
    assert [row.fine_vertices for row in rows] == [32, 48, 64, 96, 128, 192, 256, 512]
    assert all(row.reference_seconds > 1.0 and row.reference_excess > 19.0 for row in rows)


def test_the_vertices_of_all_parts_of_a_peer_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import peers
    from nestedcages_core import Mesh

    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    ring = shapely.Polygon(3 * square, [square + 1.0])
    assert peers._corners(ring) == 8
    assert peers._corners(shapely.MultiPolygon([ring, shapely.Polygon(square + 5.0)])) == 12

    turn = 2 * np.pi * np.arange(60) / 60
    disc = np.column_stack([np.cos(turn), np.sin(turn)])
    two = peers.buffer_and_simplify(Mesh.from_loops([disc, disc + 4.0]), 12)
    assert 6 <= two.vertices <= 12
    assert two.excess > 5.0  # no twelve vertices enclose two round discs more tightly


def test_shortcut_hulls_are_the_best_of_all_choices_of_vertices(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    from itertools import combinations

    from nestedcages_core import Mesh
    from peers import polygons
    from shortcut_hulls import shortcut_hull

    star = np.array([3.0, 1.0] * 4)[:, None] * np.array([(np.cos(t), np.sin(t)) for t in np.arange(8) * np.pi / 4])
    fine = Mesh.from_loops([star * np.array([[1.0, 1.1]])])
    loop, solid = fine.vertices, polygons(fine)
    for count in (5, 6):
        choices = (shapely.Polygon(loop[list(places)]) for places in combinations(range(8), count))
        least = min(hull.area for hull in choices if hull.is_valid and hull.covers(solid))
        assert shortcut_hull(fine, count, solid).area == pytest.approx(least)
    assert shortcut_hull(fine, 3, solid) is None  # the convex hull has four corners


@pytest.mark.slow
def test_no_polygon_is_below_the_lower_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """A dozen-pointed outline: the bound is below cages, and for a ring at the optimum in closed form."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    from bound import lower_bound
    from nestedcages_core import Mesh, nested_cages

    angle = np.arange(12) * np.pi / 6
    radius = np.tile([1.0, 0.6, 0.9, 0.7], 3)
    star = Mesh.from_loops([radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])])
    area = nested_cages(star, [6]).levels[0].cage.area
    asked = lower_bound(star, 6, area, target=-0.02, seconds=0.3)  # more than there can be
    assert 0.95 * area < asked.area < area
    assert not asked.proven
    ring = Mesh.from_loops([np.column_stack([np.cos(angle), np.sin(angle)])])
    optimum = 4.0 * np.cos(np.pi / 12) ** 2 * np.tan(np.pi / 4)
    found = lower_bound(ring, 4, optimum, target=1e-3)
    assert found.proven
    assert optimum / 1.001 == pytest.approx(found.area)


@pytest.mark.slow
def test_the_propositions_stand_when_attacked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import propositions

    assert propositions.third(12, 7)
    assert propositions.fifth(3, 7)
    assert propositions.sixth(2, 7)
    p, a, b = (np.array(ends) for ends in ([[0.5, 1.0], [0.5, -1.0]], [[0.0, 0.0]] * 2, [[1.0, 0.0]] * 2))
    assert propositions.meets(p, a, b)
    assert not propositions.meets(p + np.array([0.6, 0.0]), a, b)
    assert not propositions.meets(p * [[1.0, 1.0], [1.0, -0.1]], a, b)


def test_the_paper_names_what_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """The sources of `make paper`, not the PDF: what it includes is made, and what it cites is known."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import paper_pdf

    assert paper_pdf.typst_table("| a | b |\n| --- | --- |\n| 1_0 | **2** |") == (
        "#table(columns: 2,\n  [a], [b],\n  [1\\_0], [*2*],\n)"
    )
    text = (ROOT / "docs" / "paper" / "paper.typ").read_text(encoding="utf-8")
    maker = (BENCHMARKS / "paper_pdf.py").read_text(encoding="utf-8")
    included = re.findall(r'(?:image|include|json)[ (]"([\w.]+)"', text)
    assert len(included) > 8
    for name in included:
        stem = name.removesuffix(".typ")
        assert name in maker or f'"{stem}"' in maker, name
    labels = set(re.findall(r"<([\w-]+)>", text))
    known = set(re.findall(r"^@\w+{(\w+),", (ROOT / "docs" / "references.bib").read_text("utf-8"), re.MULTILINE))
    cited = set(re.findall(r"@([\w-]+)", text)) - labels
    assert len(cited) > 20
    assert cited <= known


def test_the_fewest_convex_pieces_of_small_shapes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    from needed.pieces import fewest

    corner = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], float)
    plus = [[1, 0], [2, 0], [2, 1], [3, 1], [3, 2], [2, 2], [2, 3], [1, 3], [1, 2], [0, 2], [0, 1], [1, 1]]
    turn = 2.0 * np.pi * np.arange(20) / 20
    round_one = np.column_stack((np.cos(turn), np.sin(turn)))
    assert fewest(corner, 8) == 2
    assert fewest(np.array(plus, float), 8) == 3
    assert fewest(round_one, 8) == 3
    assert fewest(round_one, 20) == 1
    assert fewest(round_one, 3) == 18


def test_the_page_has_a_place_for_every_benchmark_that_it_shows(data: ModuleType, tmp_path, monkeypatch) -> None:
    import page
    import performance

    monkeypatch.setattr(page, "ROOT", tmp_path)
    monkeypatch.setattr(page, "MEASURED", tmp_path / "docs" / "measured")
    copy = tmp_path / "docs" / "page.md"
    copy.parent.mkdir()
    shutil.copy(performance.PAGE, copy)
    page.measured(copy, "machine", "the command", "NEW", "NEW")
    for name, (command, _) in performance.RUNS.items():
        source = performance.PAGE.with_name(performance.PAGES.get(name, performance.PAGE.name))
        shutil.copy(source, copy)
        assert (BENCHMARKS / command.split()[0]).is_file()
        page.measured(copy, name, "the command", f"all of {name}\nthe end", f"a part of {name}")
        assert (page.MEASURED / f"{name}.txt").read_text().endswith(f"\n\nall of {name}\nthe end\n")
        assert f"a part of {name}\n\n`the command`, commit " in copy.read_text(encoding="utf-8")
        assert f"(measured/{name}.txt)" in copy.read_text(encoding="utf-8")
    with pytest.raises(SystemExit, match="no place"):
        page.put(copy, "nothing", "NEW")
    printed = "one\nratio 1\ntwo"
    assert performance.as_markdown(printed, "ratio") == "```text\nratio 1\n```"
    assert performance.as_markdown("| a |\n|---|\nx", ".*") == "| a |\n|---|\nx"


PRETENDED = """#!{python}
import pathlib, sys
fine, coarse = (pathlib.Path("..", "data", f"{{name}}_V.csv").read_text() for name in sys.argv[1:])
if len(fine.split()) > 40:
    sys.exit("no memory")
rows = [[float(number) for number in line.split(",")] for line in coarse.split()]
pathlib.Path("result.csv").write_text("1.5\\n" + "\\n".join(f"{{1.5 * x}},{{1.5 * y}}" for x, y in rows))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="runs a script by its first line")
def test_the_papers_program_is_timed_and_its_cages_are_measured(data, tmp_path, monkeypatch, capsys) -> None:
    import paper_program

    def compiled(program: Path, options: object) -> bool:
        program.parent.mkdir()
        program.write_text(PRETENDED.format(python=sys.executable), encoding="utf-8")
        program.chmod(0o755)
        return True

    monkeypatch.setattr(paper_program, "built", compiled)
    times = tmp_path / "times.csv"
    folders = ["--checkout", "c", "--libigl", "l", "--eigen", "e"]
    monkeypatch.setattr(sys, "argv", ["paper_program.py", *folders, "--output", str(times), "--rows", "32", "512"])
    assert paper_program.main() == 0
    first, last = data.read_table1(times)
    coarse, fine = data.annulus(16), data.annulus(16)
    assert (first.fine_vertices, first.reference_seconds) == (32, 1.5)
    assert first.reference_excess == pytest.approx(100.0 * (1.5**2 * coarse.area / fine.area - 1.0), rel=1e-3)
    assert (last.fine_vertices, last.reference_seconds, last.reference_excess) == (512, None, None)
    assert last.optimum_excess == pytest.approx(2.580, abs=1e-3)


def test_the_optimum_of_the_discs_is_that_of_a_search(data) -> None:
    """Sixteen lines that touch a ring, at the least area found by moving them; and the cages that are made."""
    random = np.random.default_rng(0)
    for vertices, expected in ((16, 0.0), (64, 2.430), (256, 2.580)):
        assert data.disc_optimum(vertices) == pytest.approx(expected, abs=1e-3)
    ring = data.ring(64, 1.0)

    def area(angles: np.ndarray) -> float:
        normal = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        height = (ring @ normal.T).max(axis=0)
        corner = np.linalg.solve(np.stack([normal, np.roll(normal, -1, 0)], axis=1),
                                 np.stack([height, np.roll(height, -1)], axis=1)[..., None])[..., 0]  # fmt: skip
        after = np.roll(corner, -1, axis=0)
        return 0.5 * float((corner[:, 0] * after[:, 1] - corner[:, 1] * after[:, 0]).sum())

    least = 16.0 * np.cos(np.pi / 64) ** 2 * np.tan(np.pi / 16)
    even = 2.0 * np.pi * np.arange(16) / 16
    assert area(even + np.pi / 64) == pytest.approx(least, rel=1e-12)
    assert min(area(np.sort(even + random.normal(0.0, 0.05, 16))) for _ in range(200)) > least


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="stopped by a signal of POSIX")
def test_the_slowest_small_requests_take_bounded_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """Next to a plain cage of the same run; none of them took more than 45 times as much, which may double."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import slowest

    found = slowest.slowest(slowest.KEPT)
    assert len(found) == len(slowest.KEPT) and found[0][0] < 200.0, found[0]
    assert not [said for _, _, said in found if ": STOPPED" in said or ": RAISED" in said]
