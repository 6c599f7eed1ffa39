"""What is imported when: the core starts without scipy's packages and without the rooms that no cage needs."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import nestedcages_core
from nestedcages_core import lapack

ROOT = Path(__file__).resolve().parents[2]

MAX_LINES_LOADED = 12_680
"""Lines of the core that a default cage imports; a reader of the method has to know no more."""

METHOD = (
    "constraints",
    "contact",
    "decimation",
    "energies",
    "flow",
    "geometry/precision.py",
    "level",
    "solver",
    "tightening",
    "tolerance",
    "verification",
)
"""Rooms of the method."""

MAX_NAMED_NUMBERS = 277
"""Constants and default parameters of the method with numbers in them: lower it whenever one goes."""

PROGRAM = """
import sys
import numpy as np
import nestedcages_core
print(*sorted(sys.modules))
from nestedcages_core import Mesh, nested_cages
angle = np.linspace(0.0, 2.0 * np.pi, 80, endpoint=False)
radius = 1.0 + 0.3 * np.cos(5.0 * angle) + 0.1 * np.sin(angle + 1.0)
nested_cages(Mesh.from_loops([np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)]), [12])
print(*sorted(sys.modules))
import nestedcages_core.exchange
print(*sorted(sys.modules))
"""
"""Tells what is imported by the core, by the first cage, and by the readers."""


@pytest.fixture(scope="module")
def imported() -> list[set[str]]:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True, check=True, timeout=120
    )
    return [set(line.split()) for line in done.stdout.splitlines()]


def parts(modules: set[str], package: str) -> set[str]:
    """The public modules directly below a package."""
    names = {
        module.removeprefix(f"{package}.").partition(".")[0] for module in modules if module.startswith(f"{package}.")
    }
    return {name for name in names if not name.startswith("_")}


@pytest.mark.slow
def test_the_core_starts_without_the_parts_of_scipy(imported: list[set[str]]) -> None:
    rooms = {"batch", "command", "coordinates", "exchange", "motion", "published"}
    assert parts(imported[0], "nestedcages_core").isdisjoint(rooms)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="scipy tells Windows where its libraries are")
def test_the_first_cage_needs_nothing_of_scipy_but_lapack(imported: list[set[str]]) -> None:
    assert {name for name in imported[1] if name.partition(".")[0] == "scipy"} == {lapack.NAME}


@pytest.mark.slow
@pytest.mark.parametrize("found", [True, False])
def test_lapack_is_that_of_scipy_whether_its_module_is_found_or_not(found: bool) -> None:
    program = f"""
import importlib.util
find_spec = importlib.util.find_spec
if not {found}:
    importlib.util.find_spec = lambda _: None
from nestedcages_core import lapack
importlib.util.find_spec = find_spec
import scipy.linalg.lapack as whole
for name in ("dpbsv", "dpbtrf", "dpbtrs"):
    assert getattr(lapack, name) is getattr(whole, name)
"""
    subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=True, timeout=120)


def test_readers_import_their_libraries_when_needed(imported: list[set[str]]) -> None:
    assert {"shapely", "tinycss2", "cssselect2"}.isdisjoint(imported[2])


def test_a_default_cage_loads_a_part_of_the_core(imported: list[set[str]]) -> None:
    modules = {name for name in imported[1] if name.startswith("nestedcages_core")}
    files = [ROOT / f"{name.replace('.', '/')}{end}" for name in modules for end in (".py", "/__init__.py")]
    lines = sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files if file.is_file())
    assert lines <= MAX_LINES_LOADED
    unused = (
        "decimation.choices",
        "decimation.loops",
        "energies.choices",
        "contact.ipc",
        "geometry.triangulation",
        "constraints.",
        "published",
    )
    assert [name for name in modules if name.startswith(tuple(f"nestedcages_core.{room}" for room in unused))] == []


def named_numbers(tree: ast.Module) -> list[str]:
    """Names of constants that hold numbers, and of fields with numbers as defaults, but for signs; all explained."""
    found: list[str] = []
    for scope in (tree, *(node for node in tree.body if isinstance(node, ast.ClassDef))):
        for node, after in zip(scope.body, [*scope.body[1:], None], strict=True):
            if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
                continue
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = [name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)]
            names = [name for name in names if name.isupper() or (isinstance(scope, ast.ClassDef) and name != "side")]
            parts = ast.walk(node.value) if scope is tree else [node.value]
            if names and any(isinstance(part, ast.Constant) and type(part.value) in (int, float) for part in parts):
                explained = isinstance(after, ast.Expr) and isinstance(getattr(after.value, "value", None), str)
                assert explained or scope is not tree, names
                found += names
    return found


def test_the_method_has_few_numbers_and_explains_each() -> None:
    core = ROOT / "nestedcages_core"
    files = [file for room in METHOD for file in ([core / room] if ".py" in room else (core / room).rglob("*.py"))]
    names = [name for file in files for name in named_numbers(ast.parse(file.read_text(encoding="utf-8")))]
    assert len(names) <= MAX_NAMED_NUMBERS


def test_names_imported_later_are_those_that_a_type_checker_sees() -> None:
    tree = ast.parse(Path(nestedcages_core.__file__).read_text(encoding="utf-8"))
    (checked,) = [node for node in tree.body if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"]
    seen = {
        (node.module, alias.name) for node in checked.body if isinstance(node, ast.ImportFrom) for alias in node.names
    }
    assert seen == {(room, name) for room, names in nestedcages_core._LATER.items() for name in names.split()}
    assert all(hasattr(nestedcages_core, name) for _, name in seen)
    assert dir(nestedcages_core) == sorted(nestedcages_core.__all__)  # what most programs need
    assert not hasattr(nestedcages_core, "no_such_name")
