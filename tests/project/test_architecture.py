"""Packages import only downwards, the core knows numpy and scipy alone, and Blender stays in the add-on."""

from __future__ import annotations

import ast
import graphlib
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from support.sources import ROOT, nodes, sources

# Each package or module imports only from those before it.
LAYERS = {
    "nestedcages_core": """
        checker_distance checker errors libraries run progress parameters lapack geometry decimation energies solver
        flow constraints contact tightening verification tolerance levels motion published coordinates
        formats puppets batch command __main__ __init__
    """,
    "addon": """
        errors keys core memory messages blender drawing cage_sets animation transfer bind generate properties files api
        verify puppets motion watch operators ui __init__ __main__
    """,
}
ORDER = {package: layers.split() for package, layers in LAYERS.items()}
CORE, ADDON = ORDER
OPTIONAL = {"shapely", "tinycss2", "cssselect2", "PIL", "psd_tools", "pyogrio", "matplotlib", "tqdm"}


def imported(package: str) -> Iterator[tuple[str, ast.stmt, str]]:
    """Path, statement and dotted name of each import in a package; names inside of it begin with its own."""
    for path, source in sources(package).items():
        folder = Path(path).parts[:-1]
        for node in nodes(source):
            if isinstance(node, ast.Import):
                yield from ((path, node, alias.name) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                base = [*folder[: len(folder) + 1 - node.level]] if node.level else []
                module = [*base, *(node.module or "").split(".")] if node.module else base
                yield from ((path, node, ".".join([*module, alias.name])) for alias in node.names)


def arrows(package: str) -> dict[str, set[str]]:
    """Each package or module inside of a package -> those that it imports."""
    found: dict[str, set[str]] = {name: set() for name in ORDER[package]}
    for path, _, name in imported(package):
        own, parts = Path(path).parts[1].removesuffix(".py"), name.split(".")
        if parts[0] == package and len(parts) > 1:
            other = parts[1] if parts[1] in found else "__init__"
            found.setdefault(own, set()).update({other} - {own})
    return found


@pytest.mark.parametrize("package", ORDER)
def test_packages_import_only_from_packages_before_them(package: str) -> None:
    rank = {name: place for place, name in enumerate(ORDER[package])}
    assert [f"{a} -> {b}" for a, others in arrows(package).items() for b in others if rank[b] > rank[a]] == []


@pytest.mark.parametrize("package", ORDER)
def test_no_files_import_each_other_in_a_circle(package: str) -> None:
    modules = {path.removesuffix(".py").replace("/", ".").removesuffix(".__init__"): path for path in sources(package)}
    graph: dict[str, set[str]] = {path: set() for path in sources(package)}
    for path, _, name in imported(package):
        target = modules.get(name) or modules.get(name.rpartition(".")[0])
        graph[path] |= {target} - {path, None}
    graphlib.TopologicalSorter(graph).prepare()  # raises CycleError


def test_nothing_but_the_command_imports_puppets() -> None:
    """Cages and their motion work without the package."""
    own = f"{CORE}/puppets/"
    users = {path for path, _, name in imported(CORE) if name.startswith(f"{CORE}.puppets") and own not in path}
    assert users == {f"{CORE}/__init__.py", f"{CORE}/command/puppet.py"}  # the names of the first are imported later


def test_the_core_imports_numpy_scipy_and_optional_libraries_alone() -> None:
    allowed = {CORE, "numpy", "scipy", *OPTIONAL, *sys.stdlib_module_names}
    outside = [(path, name) for path, _, name in imported(CORE) if name.partition(".")[0] not in allowed]
    absolute = [path for path, node, name in imported(CORE) if name.startswith(CORE) and not getattr(node, "level", 0)]
    assert outside == absolute == []


def test_the_addon_imports_the_core_that_it_carries() -> None:
    """An installed extension finds the core below its own package, so an absolute import would miss it."""
    for path, source in sources(ADDON).items():
        for block in nodes(source):
            if isinstance(block, ast.If) and "TYPE_CHECKING" in ast.unparse(block.test):
                block.body = [ast.Pass()]
        absolute = [n for n in ast.walk(nodes(source)[0]) if getattr(n, "module", None) and n.module.startswith(CORE)]
        assert not absolute or path == "addon/__main__.py", path


def test_the_diagrams_of_the_architecture_show_the_imports() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    for package, diagram in zip(ORDER, re.findall(r"```mermaid\n(.*?)```", text, re.DOTALL), strict=True):
        drawn: dict[str, set[str]] = {}
        for line in re.findall(r"^ +(\w+) --> (.*)$", diagram, re.MULTILINE):
            drawn.setdefault(line[0], set()).update(line[1].split(" & "))
        hidden = {"__init__", "__main__"}
        shown = {a: others - hidden for a, others in arrows(package).items() if a not in hidden}

        def reached(start: str, graph: dict[str, set[str]] = drawn) -> set[str]:
            return {start}.union(*(reached(other, graph) for other in graph.get(start, ())))

        assert [(a, b) for a, others in drawn.items() for b in others if b not in shown[a]] == [], "no such import"
        assert [(a, b) for a, others in shown.items() for b in others if b not in reached(a)] == [], (
            "an arrow is missing"
        )


@pytest.mark.slow
def test_only_the_tests_of_kernels_import_internals_of_the_core() -> None:
    internal = []
    for path, source in sources("tests").items():
        if path.startswith("tests/kernels/"):
            continue
        for node in nodes(source):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            internal += [(path, name) for name in names if name.startswith((f"{CORE}.", "benchmarks"))]
    assert internal == []
