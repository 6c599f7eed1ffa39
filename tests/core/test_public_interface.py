"""How the package is used from Python: plain arrays, results that show themselves, names, and what is imported when."""

import ast
import copy
import json
import os
import pickle
import subprocess
import sys
import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
import pytest
import shapely.geometry

import nestedcages_core as core
from nestedcages_core import Hierarchy, Mesh, MovingCages, nested_cages, to_geojson, to_svg
from support.judging import rejected
from support.shapes import annulus, islands, ring, star
from support.sources import ROOT

OUTER, HOLE = ring(60, 1.0), ring(20, 0.4)
POSES = np.stack([OUTER * (1.0 + 0.1 * k) for k in range(4)])


@pytest.fixture(scope="module")
def hierarchy() -> Hierarchy:
    return nested_cages([OUTER, HOLE], [24, 12], clearance=0.01)


@pytest.fixture(scope="module")
def moving() -> MovingCages:
    return core.animated_cages(OUTER, POSES, 12, clearance=0.01)


@pytest.mark.parametrize("shape", [OUTER, OUTER.tolist(), tuple(map(tuple, OUTER)), [OUTER], OUTER[None]])
def test_a_single_loop_is_a_shape(shape: Any) -> None:
    assert Mesh.of(shape) == Mesh.from_loops([OUTER])


def test_a_level_is_a_geometry(hierarchy: Hierarchy) -> None:
    level = hierarchy[0]
    assert shapely.geometry.shape(level).equals(shapely.geometry.shape(level.cage))
    assert Mesh.of(level) == level.cage
    mesh = shapely.geometry.shape(hierarchy.fine)
    assert (len(mesh.interiors), mesh.area) == (1, pytest.approx(hierarchy.fine.area, rel=1e-12))


def test_a_hierarchy_is_a_sequence_of_levels(hierarchy: Hierarchy) -> None:
    first, second = hierarchy
    assert (len(hierarchy), hierarchy[:1], list(reversed(hierarchy))) == (2, (first,), [second, first])
    assert hierarchy[-1] is second is hierarchy.levels[1]
    assert first in hierarchy and isinstance(first, core.Level) and not first.inside
    assert first.vertices is first.cage.vertices
    assert first.excess == first.report.excess
    assert hierarchy.cages == (first.cage, second.cage)
    assert second.fine is first.cage


def test_results_show_themselves_in_short(hierarchy: Hierarchy, moving: MovingCages) -> None:
    for result in (hierarchy, hierarchy[1], hierarchy[0].flow, hierarchy[0].reinflation, hierarchy.fine, moving):
        assert repr(result).startswith(f"{type(result).__name__}(")
        assert "array(" not in repr(result) or result is moving
    assert max(len(repr(each)) for each in (hierarchy, hierarchy[1])) < 120
    assert repr(hierarchy.fine) == "Mesh(80 vertices, 2 loops)"
    for report in (hierarchy[0].report, moving.levels[0].report):
        assert f"{100.0 * np.median(report.excess):.2f} %" in str(report)


def test_meshes_are_equal_by_value() -> None:
    mesh, again = (Mesh.from_loops([OUTER, HOLE]) for _ in range(2))
    assert mesh == again
    assert len({mesh, again}) == 1
    assert mesh != Mesh.from_loops([HOLE, OUTER])
    assert mesh != mesh.moved(mesh.vertices + 1e-12)
    assert mesh != "mesh"
    assert [len(loop) for loop in mesh.rings] == [60, 20]
    np.testing.assert_allclose(mesh.bounds, (-1.0, -1.0, 1.0, 1.0), atol=0.01)


def test_every_writer_takes_every_result(hierarchy: Hierarchy) -> None:
    level = hierarchy[0]
    assert to_svg(hierarchy) == to_svg([hierarchy.fine, *hierarchy.cages])
    assert to_svg(level) == to_svg([level.fine, level.cage])
    assert core.from_svg(to_svg(level.cage)) == level.cage
    assert len(json.loads(to_geojson(hierarchy))["features"]) == 3
    assert core.from_geojson(to_geojson(level.cage)).has_loops_like(level.cage)
    assert core.from_svg(to_svg(OUTER)) == core.from_geojson(to_geojson(OUTER)) == Mesh.of(OUTER)
    found = core.features_from_geojson(to_geojson(hierarchy))
    assert [each.properties["level"] for each in found] == [0, 1, 2]
    assert [each.properties["area"] for each in found] == [mesh.area for mesh in hierarchy.meshes]


def test_meshes_settings_and_results_travel(hierarchy: Hierarchy, moving: MovingCages) -> None:
    for mesh in (annulus(12), islands(), Mesh.from_loops([ring(5)]).moved(2.0 * ring(5))):
        for copied in (pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh)):
            assert copied == mesh
            assert (copied.is_validated, copied.area) == (mesh.is_validated, mesh.area)
            assert not copied.vertices.flags.writeable
            assert np.array_equal(copied.moved(copied.vertices).loops[-1], mesh.loops[-1])
    back = pickle.loads(pickle.dumps(hierarchy))
    assert back.cages == hierarchy.cages
    assert (back[0].reinflation.cage_steps == hierarchy[0].reinflation.cage_steps).all()
    assert (back[0].reinflation.fine_steps == hierarchy[0].reinflation.fine_steps).all()
    assert back[0].report == hierarchy[0].report
    again = pickle.loads(pickle.dumps(moving)).levels[0]
    assert (again.cage_steps == moving.levels[0].cage_steps).all()
    for settings in (core.Settings(clearance=0.1), core.Settings(stored=np.float32, pins=[1])):
        assert pickle.loads(pickle.dumps(settings)) == settings


def test_results_have_pictures(hierarchy: Hierarchy, moving: MovingCages) -> None:
    for result, meshes in ((hierarchy, 3), (hierarchy[0], 2), (hierarchy.fine, 1), (moving, 8)):
        drawn = ET.fromstring(result._repr_svg_()).findall(".//{*}path")
        assert len(drawn) == meshes
        assert all("nan" not in path.attrib["d"] for path in drawn)


def test_the_picture_of_a_motion_shows_its_poses(moving: MovingCages) -> None:
    frames = moving.frames
    assert len(frames) == 4
    for (fine, cage), pose in zip(frames, POSES, strict=True):
        assert np.array_equal(fine.vertices, pose)
        assert shapely.geometry.shape(cage).contains(shapely.geometry.shape(fine))


@pytest.mark.slow
def test_results_plot_themselves(hierarchy: Hierarchy, monkeypatch: pytest.MonkeyPatch) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = hierarchy.plot()
    drawn = len(axes.patches)
    assert drawn >= 3
    assert hierarchy[0].plot(axes) is axes
    assert len(axes.patches) > drawn
    low, high = axes.get_xlim()
    assert low < hierarchy[-1].cage.bounds[0] < hierarchy[-1].cage.bounds[2] < high
    for name in [name for name in sys.modules if name.partition(".")[0] == "matplotlib"]:
        monkeypatch.setitem(sys.modules, name, None)
    with rejected("dependency.missing", library="matplotlib"):
        hierarchy.plot()


def without(monkeypatch: pytest.MonkeyPatch, library: str) -> None:
    """Makes a library one that cannot be imported."""
    for name in {library, *(name for name in sys.modules if name.partition(".")[0] == library)}:
        monkeypatch.setitem(sys.modules, name, None)


@pytest.mark.parametrize(
    ("work", "library"),
    [
        (lambda: nested_cages(star(5, 40), 12, symmetry=core.Mirror((0.1, 0.2), (0.0, 1.0))), "shapely"),
    ],
    ids=["a symmetry"],
)
def test_a_library_that_is_missing_is_named(work: Any, library: str, monkeypatch: pytest.MonkeyPatch) -> None:
    without(monkeypatch, library)
    with rejected("dependency.missing", library=library):
        work()


def test_without_a_library_for_bars_progress_is_lines(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    without(monkeypatch, "tqdm")
    assert nested_cages(OUTER, 13, progress=True)[0].cage == nested_cages(OUTER, 13)[0].cage
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) > 2
    shares = [int(line.split()[0].rstrip("%")) for line in lines]
    assert shares == sorted(shares)
    assert shares[0] < 50


PROGRAM = """
import sys
import nestedcages_core
print(*sorted(sys.modules))
import numpy as np
from nestedcages_core import Mesh, nested_cages
angle = np.linspace(0.0, 2.0 * np.pi, 80, endpoint=False)
radius = 1.0 + 0.3 * np.cos(5.0 * angle) + 0.1 * np.sin(angle + 1.0)
nested_cages(Mesh.from_loops([np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)]), [12])
print(*sorted(sys.modules))
nestedcages_core.from_geojson
print(*sorted(sys.modules))
"""
"""Prints what is imported by the package, by the first cage, and by the readers."""


def run_program(program: str, **options: Any) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, timeout=120, **options
    )


@pytest.fixture(scope="module")
def imported() -> list[set[str]]:
    return [set(line.split()) for line in run_program(PROGRAM, check=True).stdout.splitlines()]


def test_a_cage_needs_numpy_and_a_little_of_scipy_alone(imported: list[set[str]]) -> None:
    heavy = {"shapely", "matplotlib", "tqdm", "tinycss2", "cssselect2", "PIL", "multiprocessing", "pyogrio", "bpy"}
    for modules in imported:
        assert {name.partition(".")[0] for name in modules}.isdisjoint(heavy)
    assert "numpy" in imported[1] - imported[0]
    if sys.platform != "win32":  # where scipy has to say where its libraries are
        packages = {name.split(".")[1] for name in imported[1] if name.startswith("scipy.")}
        assert packages <= {"linalg"}
        assert "scipy.linalg" not in imported[1]  # the package, which takes longer than most first cages


def test_what_cages_do_not_need_is_imported_when_it_is_asked_for(imported: list[set[str]]) -> None:
    own = [{name for name in modules if name.startswith("nestedcages_core")} for modules in imported]
    assert own[0] <= own[1] < own[2]


@pytest.mark.slow
def test_another_scipy_may_keep_its_parts_elsewhere() -> None:
    """The first cage is the same where they are not found in their usual place."""
    shape = star(5, 40)
    program = (
        "import importlib.util; importlib.util.find_spec = lambda *_: None\n"
        f"from nestedcages_core import nested_cages; shape = {shape.vertices.tolist()}\n"
        "print(nested_cages(shape, 12)[0].vertices.tolist())"
    )
    assert json.loads(run_program(program, check=True).stdout) == nested_cages(shape, 12)[0].vertices.tolist()


def test_every_name_is_there_and_no_other() -> None:
    assert dir(core) == sorted(core.__all__)
    for name in core.__all__:
        assert getattr(core, name) is not None
    assert not hasattr(core, "no_such_name")
    assert callable(core.convex_pieces)  # further names, for those who know them


def test_a_type_checker_sees_the_names_that_there_are() -> None:
    """Every name that the package imports for type checkers is one of its own."""
    source = ast.parse((ROOT / "nestedcages_core" / "__init__.py").read_text(encoding="utf-8"))
    imports = [node for node in ast.walk(source) if isinstance(node, ast.ImportFrom) and node.level == 1]
    names = {alias.asname or alias.name for node in imports for alias in node.names}
    assert set(core.__all__) <= names
    public = [name for name in sorted(names) if not name.startswith("_")]
    assert [name for name in public if not hasattr(core, name)] == []
