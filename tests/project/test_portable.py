"""Nothing in the code or among the file names stops at Windows or macOS."""

import ast
import re
import subprocess
from collections.abc import Iterator
from pathlib import PurePosixPath

import pytest

from support.sources import ROOT, nodes, sources

FOLDERS = ("nestedcages_core", "addon", "packaging", "examples", "benchmarks")
POSIX_MODULES = {"fcntl", "grp", "posix", "pty", "pwd", "resource", "termios", "tty"}
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


@pytest.mark.slow
def test_files_are_opened_with_an_encoding_and_nothing_needs_posix() -> None:
    files = sources(*FOLDERS).items()
    assert [f"{name}:{line}" for name, source in files for line in without_encoding(source)] == []
    for name, source in files:
        top = [node for node in ast.parse(source).body if isinstance(node, ast.Import | ast.ImportFrom)]
        imported = {alias.name for node in top if isinstance(node, ast.Import) for alias in node.names}
        imported |= {node.module or "" for node in top if isinstance(node, ast.ImportFrom)}
        assert not POSIX_MODULES & {module.partition(".")[0] for module in imported}, name


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
