"""Nothing in the code or among the file names stops at Windows or macOS."""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path, PurePosixPath, PureWindowsPath

import numpy as np
import pytest

from nestedcages_core import Mesh, to_engine_json, to_svg
from nestedcages_core.command import main, outputs
from nestedcages_core.command import sources as inputs
from support.sources import ROOT, nodes, sources

FOLDERS = ("nestedcages_core", "addon", "packaging", "examples", "benchmarks")

POSIX_MODULES = {"fcntl", "grp", "posix", "pty", "pwd", "resource", "termios", "tty"}
POSIX_NAMES = {"fork", "forkpty", "geteuid", "getuid", "killpg", "mkfifo", "setsid", "sysconf", "SIGKILL", "SIGPROF"}
# Limits that are only set on Linux, and mutants that need fork: both after a look at the system.
GUARDED = ("benchmarks/hostile/outcome.py", "packaging/mutants.py")

TEXT_CALLS = {"read_text", "write_text"}
RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
LONGEST_PATH = 120
"""Characters: Windows allows 260 with the folder of the clone."""


def without_encoding(source: str) -> Iterator[int]:
    """Lines that open text files by the encoding of the system."""
    for node in nodes(source):
        if not isinstance(node, ast.Call):
            continue
        named = {keyword.arg for keyword in node.keywords}
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        modes = [*node.args, *(keyword.value for keyword in node.keywords if keyword.arg == "mode")]
        binary = any(isinstance(mode, ast.Constant) and "b" in str(mode.value) for mode in modes)
        of = ast.unparse(node.func.value) if isinstance(node.func, ast.Attribute) else ""
        is_open = name == "open" and not binary and of not in ("Image", "os", "tarfile")
        if (name in TEXT_CALLS or is_open) and "encoding" not in named:
            yield node.lineno


def posix_only(source: str) -> Iterator[str]:
    """Modules imported at the top, and names, that only POSIX systems have."""
    for node in nodes(source)[0].body:  # type: ignore[attr-defined]
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        yield from POSIX_MODULES & {name.partition(".")[0] for name in names}
    for node in nodes(source):
        if isinstance(node, ast.Attribute) and node.attr in POSIX_NAMES and ast.unparse(node.value) in ("os", "signal"):
            yield node.attr


@pytest.mark.slow
def test_files_are_opened_with_an_encoding_and_nothing_needs_posix() -> None:
    files = sources(*FOLDERS).items()
    assert [f"{name}:{line}" for name, source in files for line in without_encoding(source)] == []
    assert [f"{name}: {it}" for name, source in files if name not in GUARDED for it in posix_only(source)] == []


def test_names_of_files_are_allowed_and_distinct_everywhere() -> None:
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    if done.returncode != 0:
        pytest.skip("not a clone")
    names = [name for name in done.stdout.decode("utf-8").split("\0") if name]
    assert len({name.casefold() for name in names}) == len(names)
    for name in names:
        assert not re.search(r'[<>:"|?*\\]', name), name
        assert len(name) <= LONGEST_PATH, name
        parts = PurePosixPath(name).parts
        assert not any(RESERVED.fullmatch(part) or part.endswith((".", " ")) for part in parts), name


def test_names_with_backslashes_are_understood(monkeypatch: pytest.MonkeyPatch) -> None:
    """As Windows reads them: with its separators, drives and endings of any case."""
    for module in (inputs, outputs):
        monkeypatch.setattr(module, "Path", PureWindowsPath)
    source = inputs.Source("C:\\icons.set\\a b.SVG", "drawing")
    assert inputs.kind_of(source.path) == "drawing"
    names = ["D:\\cages.d\\{stem}.JSON", "cages/{stem}.GeoJSON", "..\\out.svg"]
    written = [("D:\\cages.d\\a b.JSON", "json"), ("cages/a b.GeoJSON", "geojson"), ("..\\out.svg", "svg")]
    assert outputs.targets(names, source, None) == written


@pytest.mark.slow
def test_spawned_workers_and_a_console_of_few_characters(tmp_path: Path) -> None:
    """What Windows does: workers import everything anew, and the console has no snowman."""
    feature = {"type": "Feature", "properties": {"name": "☃"}, "geometry": STAR.__geo_interface__}
    path = tmp_path / "☃.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [feature] * 2}), encoding="utf-8")
    words = [str(path), "--levels", "4", "--jobs", "2", "-o", str(tmp_path / "{stem} out.geojson")]
    code = "import multiprocessing as m, sys; m.set_start_method('spawn'); from nestedcages_core.command import main; "
    done = subprocess.run(
        [sys.executable, "-c", f"{code}sys.exit(main(sys.argv[1:]))", *words],
        cwd=ROOT, capture_output=True, env={**os.environ, "PYTHONIOENCODING": "cp1252", "PYTHONUTF8": "0"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert b"Traceback" not in done.stderr
    assert len(json.loads((tmp_path / "☃ out.geojson").read_text(encoding="utf-8"))["features"]) == 2


STAR = Mesh.from_loops([np.array([[0, 0], [10, 0], [10, 10], [6, 10], [5, 4], [4, 10], [0, 10]], float)])


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a b.svg", to_svg(STAR).replace("><", ">\n<")),
        ("ä.geojson", json.dumps(STAR.__geo_interface__, indent=1)),
        ("a.json", to_engine_json(STAR).replace(",", ",\n")),
    ],
)
def test_files_that_windows_wrote_are_read(tmp_path: Path, name: str, text: str) -> None:
    """A byte order mark, and lines that end with a carriage return too."""
    path = tmp_path / name
    for mark, end in ((b"", "\n"), (b"\xef\xbb\xbf", "\r\n")):
        path.write_bytes(mark + text.replace("\n", end).encode("utf-8"))
        assert main([str(path), "--levels", "4", "-o", str(tmp_path / f"{len(mark)}.json")]) == 0
    plain, windows = ((tmp_path / f"{size}.json").read_bytes() for size in (0, 3))
    assert plain == windows
