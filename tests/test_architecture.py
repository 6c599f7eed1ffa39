"""The rooms import only downwards, the core knows numpy and scipy alone, and Blender stays in the add-on."""

from __future__ import annotations

import ast
import graphlib
import importlib
import pkgutil
import runpy
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import pytest

from support.sources import ROOT, nodes, sources

CORE = "nestedcages_core"

# The rooms of the core, files or packages, in the order of the data flow: each imports only from those before it.
ROOMS = """
checker_distance checker errors libraries tasks cache parameters lapack geometry decimation flow energies solver
constraints contact tightening verification level tolerance hierarchy motion published coordinates character
puppet exchange game batch command __main__ __init__
"""

# The rooms of the add-on, in the same sense. `core` is its door to the core.
ADDON_ROOMS = """
errors core notes keys record scene animation rigging generation binding io following characters puppets properties
making operators ui api __init__
"""
DOOR = "core.py"

THIRD_PARTY = {"numpy", "scipy"}
# Optional libraries, each in its room alone, imported when needed: formats, plots, progress bars.
OPTIONAL = {
    "libraries": {"shapely", "tinycss2", "cssselect2", "PIL", "pyogrio"},
    "geometry": {"matplotlib"},
    "tasks": {"tqdm"},
}
BLENDER = {"bpy", "bmesh", "mathutils", "bpy_extras", "gpu", "gpu_extras", "blf", "aud", "addon_utils", "bl_ui"}
BLENDER_PLACES = (
    "addon/",
    "__init__.py",
    "benchmarks/binding.py",
    "benchmarks/blender_writing.py",
    "benchmarks/many_drawings.py",
    "examples/",
    "packaging/",
    "tests/",
)

# The face of the core. Names are added with care and never taken away: other programs import them.
PUBLIC = """
Mesh nested_cages NestedCagesRun inner_cages nested_cages_many Settings Within Share Progress Hierarchy Level
NestingReport FlowResult Reinflation verify verify_motion Certificate MotionCertificate check cage_coordinates deform
read_svg write_svg from_svg to_svg read_geojson write_geojson from_geojson features_from_geojson to_geojson
write_engine_json to_engine_json read_png collision_outline NestedCagesError InvalidMeshError FlowError ReinflationError
NestingError
"""

# Method objects and helpers, which can be imported from the top too.
IMPORTABLE = """
AllPairs ArcLength Area BatchProgress BoundaryARAP UniformGrid ElementEnergy EvenSamples Feature GaussLegendre
GradientDescent Grids Harmonic IPC InitialDisplacement InteriorARAP Found MeanValue Mirror Rotation LineCycles
Midpoint NoEnergy NoFilter OnCurve Outcome OuterHull OwnDecimation PaperContact Box LeastAngle LeastEdge LoopClearance
PaperFlow PiecewiseLinear ProjectedNewton QuadraticFallOff Repairs SequentialQP ShapeKeeping SignedDistanceFlow
SmallestDistance StepDisplacement Tightening TimeOfImpact TwoSidedFlow WeightedSum alpha_channel boundary_of_pixels
from_engine_json grids is_engine_json
"""


SHARED_NAMES = {CORE: 10, "addon": 20}
"""Upper bounds of the names of functions and classes that stand in several files of a package: a name has one meaning.
What the standalone checker defines, it has for itself; entry points that Python or Blender ask for count too."""


class Import(NamedTuple):
    """One imported name: `parts` of a dotted path, inside the core if `inside`."""

    line: int
    parts: tuple[str, ...]
    inside: bool


def module_of(path: str) -> tuple[str, ...]:
    """`solver/newton.py` -> (solver, newton), `solver/__init__.py` -> (solver,), `__init__.py` -> ()."""
    parts = tuple(path.removesuffix(".py").split("/"))
    return parts[:-1] if parts[-1] == "__init__" else parts


def imports(path: str, parts: Iterable[ast.AST]) -> Iterator[Import | str]:
    """All imports among nodes of the core's file `path`; a string says what is forbidden."""
    module = module_of(path)
    package = module if path.endswith("__init__.py") else module[:-1]
    for node in parts:
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield Import(node.lineno, tuple(alias.name.split(".")), False)
        elif isinstance(node, ast.ImportFrom):
            named = tuple(node.module.split(".")) if node.module else ()
            if node.level == 0:
                yield Import(node.lineno, named, False)
            elif node.level > len(package) + 1:
                yield f"{path}:{node.lineno}: a relative import that leaves the core"
            else:
                base = package[: len(package) + 1 - node.level]
                for alias in node.names:
                    yield Import(node.lineno, (*base, *named, alias.name), True)
        elif isinstance(node, ast.Call):
            function = node.func
            name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
            if (
                name in {"__import__", "import_module"} and path != "__init__.py"
            ):  # the face comes last and may take all
                yield f"{path}:{node.lineno}: an import by string, which nobody can check"


def arrow_violations(sources: Mapping[str, str], rooms: str) -> list[str]:
    """What the files of a package (path below it -> source) import from a later room, one sentence each."""
    rank = {room: place for place, room in enumerate(rooms.split())}
    known = {module_of(path)[0] for path in sources if module_of(path)}
    found: list[str] = [f"{room}: this room has no place in the order" for room in sorted(known - rank.keys())]
    for path, source in sources.items():
        own = (module_of(path) or ("__init__",))[0]
        for item in imports(path, nodes(source)):
            if isinstance(item, Import) and item.inside:
                room = item.parts[0] if item.parts[0] in known else "__init__"  # a name that the package exports
                if room != own and rank.get(room, -1) > rank.get(own, len(rooms)):
                    found.append(f"{path}:{item.line}: {own} imports {room}, which comes after it")
    return found


def room_violations(sources: Mapping[str, str], rooms: str = ROOMS) -> list[str]:
    """What the core's files (path below the core -> source) import against the rules, one sentence each."""
    found = arrow_violations(sources, rooms)
    for path, source in sources.items():
        own = (module_of(path) or ("__init__",))[0]
        for item in imports(path, nodes(source)):
            if isinstance(item, str):
                found.append(item)
            elif item.inside:
                continue
            elif item.parts[0] == CORE:
                found.append(f"{path}:{item.line}: the core is imported absolutely")
            elif item.parts[0] not in THIRD_PARTY | OPTIONAL.get(own, set()) | sys.stdlib_module_names:
                found.append(f"{path}:{item.line}: imports {item.parts[0]}")
    return found


# What only a gate makes, and what of a level only its gate changes.
GATE = "level/gate.py"
MADE_BY = {"Level": GATE, "JudgedCage": GATE, "Seal": GATE, "Key": "level/motion_gate.py"}
JUDGED_FIELDS = {"coarse", "cage", "fine", "flow", "reinflation", "seal", "side"}


def gate_violations(sources: Mapping[str, str]) -> list[str]:
    """Where the files of a package (path below it -> source) make what only a gate makes, one sentence each."""
    found: list[str] = []
    for path, source in sources.items():
        for node in nodes(source):
            if not isinstance(node, ast.Call):
                continue
            name = ast.unparse(node.func).rpartition(".")[2]
            changed = {each.arg for each in node.keywords} & JUDGED_FIELDS
            if MADE_BY.get(name, path) != path:
                found.append(f"{path}:{node.lineno}: makes a {name}")
            elif path != GATE and name == "replace" and changed and "level" in ast.unparse(node.args[0]).lower():
                found.append(f"{path}:{node.lineno}: changes {', '.join(sorted(changed))} of a level")
    return found


class WithoutTypeChecking(ast.NodeTransformer):
    """Leaves out what only a type checker imports."""

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt]:
        if "TYPE_CHECKING" in ast.unparse(node.test):
            return node.orelse
        return self.generic_visit(node)


def circle(sources: Mapping[str, str]) -> list[str] | None:
    """Files of a package that import each other in a circle, if only for a type checker; None if there are none."""
    files = {module_of(path): path for path in sources}
    graph: dict[str, set[str]] = {path: set() for path in sources}
    for path, source in sources.items():
        for item in imports(path, nodes(source)):
            if isinstance(item, Import) and item.inside:
                target = item.parts if item.parts in files else item.parts[:-1]
                if target in files and files[target] != path:
                    graph[path].add(files[target])
    try:
        tuple(graphlib.TopologicalSorter(graph).static_order())
    except graphlib.CycleError as error:
        return list(error.args[1])
    return None


def blender_violations(sources: Mapping[str, str]) -> list[str]:
    """Files (path below the project's root -> source) that import Blender's modules where they must not."""
    return [
        f"{path}:{item.line}: imports {item.parts[0]}"
        for path, source in sources.items()
        if not path.startswith(BLENDER_PLACES) and any(module in source for module in BLENDER)
        for item in imports(path, nodes(source))
        if isinstance(item, Import) and not item.inside and item.parts[0] in BLENDER
    ]


def shared_names(sources: Mapping[str, str]) -> dict[str, list[str]]:
    """The names of top-level functions and classes that stand in several files (path -> source), with these files."""
    places: defaultdict[str, list[str]] = defaultdict(list)
    for path, source in sources.items():
        tops = {n.name for n in ast.iter_child_nodes(nodes(source)[0]) if isinstance(n, ast.FunctionDef | ast.ClassDef)}
        for name in tops:
            places[name].append(path)
    return {name: paths for name, paths in places.items() if len(paths) > 1}


def below(folder: str) -> dict[str, str]:
    """Path below a folder of the project -> source of each Python file there."""
    return {path.removeprefix(f"{folder}/"): source for path, source in sources(folder).items()}


# The project


def test_rooms_import_only_from_rooms_before_them() -> None:
    assert room_violations(below(CORE)) == []


def test_kernel_and_constraints_ask_for_no_class_of_a_method() -> None:
    methods = {"Area", "ArcLength", "IPC", "LineCycles", "OuterHull", "SequentialQP", "Tightening", "TwoSidedFlow"}
    asked = [
        (path, node.lineno)
        for path, source in sources(*(f"{CORE}/{room}" for room in ("constraints", "level", "tolerance"))).items()
        for node in nodes(source)
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "isinstance"
        if methods & {name.id for name in ast.walk(node.args[1]) if isinstance(name, ast.Name)}
    ]
    assert asked == []


def test_only_the_gate_makes_levels_and_keys() -> None:
    assert gate_violations(below(CORE)) == []
    assert gate_violations(below("addon")) == []
    wrong = "Level(1)\nx.Key(2)\nreplace(level, cage=3)\nreplace(level, report=4)\nreplace(plan, fine=5)"
    assert len(gate_violations({"a.py": wrong})) == 3
    assert gate_violations({GATE: wrong}) == [f"{GATE}:2: makes a Key"]


def test_no_circle_inside_the_core() -> None:
    assert circle(below(CORE)) is None


def test_blender_stays_in_the_addon() -> None:
    assert blender_violations(sources()) == []


def test_rooms_of_the_addon_import_only_from_rooms_before_them() -> None:
    assert arrow_violations(below("addon"), ADDON_ROOMS) == []


def test_no_circle_inside_the_addon() -> None:
    assert circle(below("addon")) is None


def test_addon_imports_the_core_it_carries_through_one_door() -> None:
    # An installed extension finds the core below its own package, so an absolute import would miss it.
    for path, source in below("addon").items():
        found = list(imports(path, ast.walk(WithoutTypeChecking().visit(ast.parse(source)))))
        absolute = [item for item in found if isinstance(item, Import) and not item.inside and item.parts[0] == CORE]
        assert absolute == [], path
        assert [item for item in found if isinstance(item, str)] == [] or path == DOOR


def test_addon_needs_no_room_that_its_zip_leaves_out() -> None:
    files = below("addon")
    left_out = {"batch", "command", *importlib.import_module(CORE)._LATER["batch"].split()}
    used = {
        node.attr
        for source in files.values()
        for node in nodes(source)
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "core"
    }
    door = {str(node.value).partition(".")[0] for node in nodes(files[DOOR]) if isinstance(node, ast.Constant)}
    assert "nested_cages_many" in left_out and "Mesh" in used and "geometry" in door
    assert not left_out & (used | door)


@pytest.mark.parametrize("package", SHARED_NAMES)
def test_a_name_stands_for_one_function_or_class(package: str) -> None:
    shared = shared_names(below(package))
    assert len(shared) <= SHARED_NAMES[package], shared


def test_public_interface() -> None:
    core = importlib.import_module(CORE)
    assert set(PUBLIC.split()) <= set(core.__all__)
    assert set(IMPORTABLE.split()).isdisjoint(core.__all__)
    assert len(core.__all__) == len(set(core.__all__)) < 50
    assert [name for name in (*core.__all__, *IMPORTABLE.split()) if not hasattr(core, name)] == []


def test_every_room_shows_what_the_top_passes_on() -> None:
    core = importlib.import_module(CORE)
    shown = {
        name
        for module in pkgutil.walk_packages(core.__path__, f"{CORE}.")
        if not module.name.endswith("__main__")
        for name in getattr(importlib.import_module(module.name), "__all__", ())
    }
    assert sorted(set(IMPORTABLE.split()) - shown) == []


# The checkers themselves, on sources made for it

ORDER = "errors mesh solver flow __init__"
GOOD = {
    "__init__.py": "from .flow import run\nfrom .mesh import Mesh",
    "errors.py": "from __future__ import annotations\nimport math",
    "mesh.py": "import numpy as np\nfrom scipy.sparse import csr_matrix\nfrom .errors import Bad",
    "solver/__init__.py": "from .newton import Newton\nfrom ..mesh import Mesh",
    "solver/newton.py": "from . import line_search\nfrom ..errors import Bad",
    "solver/line_search.py": "from ..mesh import Mesh",
    "flow.py": "from . import mesh, solver\nfrom .solver.newton import Newton",
}


def test_good_sources_pass() -> None:
    assert room_violations(GOOD, ORDER) == []
    assert circle(GOOD) is None
    assert shared_names({**GOOD, "flow.py": "class Run:\n    run = 1", "solver/newton.py": "def run(): pass"}) == {}
    assert shared_names({"flow.py": "def run(): pass", "mesh.py": "def run(): pass"}) == {"run": ["flow.py", "mesh.py"]}
    assert circle({**GOOD, "solver/line_search.py": "from .newton import Newton"}) is not None
    assert room_violations({**GOOD, "libraries.py": "def load():\n    import shapely"}, f"{ORDER} libraries") == []
    assert blender_violations({"benchmarks/table1.py": "import bpy.ops"}) == ["benchmarks/table1.py:1: imports bpy"]


@pytest.mark.parametrize(
    ("path", "source", "complaint"),
    [
        ("mesh.py", "from .flow import run", "mesh.py:1: mesh imports flow, which comes after it"),
        ("mesh.py", "def late():\n    from . import solver", "mesh.py:2: mesh imports solver, which comes after it"),
        ("solver/newton.py", "from ..flow import run", "solver/newton.py:1: solver imports flow, which comes after it"),
        ("flow.py", "from nestedcages_core.geometry.mesh import Mesh", "flow.py:1: the core is imported absolutely"),
        ("flow.py", "import os\nimport shapely.geometry", "flow.py:2: imports shapely"),
        ("flow.py", "try:\n    import bpy\nexcept ImportError:\n    pass", "flow.py:2: imports bpy"),
        ("flow.py", "from ..addon import convert", "flow.py:1: a relative import that leaves the core"),
        ("flow.py", "import importlib\nimportlib.import_module('bpy')", "flow.py:2: an import by string"),
        ("drawer.py", "import math", "drawer: this room has no place in the order"),
    ],
)
def test_bad_sources_are_found(path: str, source: str, complaint: str) -> None:
    (found,) = room_violations({**GOOD, path: source}, ORDER)
    assert found.startswith(complaint)


def test_faults_put_in_by_hand_have_their_place_and_their_test() -> None:
    """Who changes such a place, or such a test, changes its line in `packaging/by_hand.py` too."""
    for path, before, _, test in runpy.run_path(str(ROOT / "packaging" / "by_hand.py"))["FAULTS"]:
        assert (ROOT / path).read_text(encoding="utf-8").count(before) == 1, f"{path}: {before}"
        file, name = test.split("::")
        assert f"def {name}(" in (ROOT / file).read_text(encoding="utf-8"), test
