"""Files come from strangers: nothing that the core or the add-on reads is ever run as code."""

from __future__ import annotations

import ast
import re
import unicodedata
from collections.abc import Iterator

import pytest

from support.sources import nodes, sources

FORBIDDEN_CALLS = {"eval", "exec", "compile", "__import__"}
FORBIDDEN_MODULES = {"pickle", "marshal", "shelve", "dill", "cloudpickle", "joblib"}
FORBIDDEN_OPTIONS = {"allow_pickle", "shell"}
FORBIDDEN = FORBIDDEN_CALLS | FORBIDDEN_MODULES | FORBIDDEN_OPTIONS


def uses(source: str) -> Iterator[tuple[int, str]]:
    """Line and name of everything that runs data as code."""
    for node in nodes(source):
        if isinstance(node, ast.Call):
            if isinstance(node.func, ast.Name) and node.func.id in FORBIDDEN_CALLS:
                yield node.lineno, node.func.id
            on = (word for word in node.keywords if not (isinstance(word.value, ast.Constant) and not word.value.value))
            yield from ((node.lineno, word.arg) for word in on if word.arg in FORBIDDEN_OPTIONS)
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [node.module or ""]
        yield from ((node.lineno, name) for name in names if name.partition(".")[0] in FORBIDDEN_MODULES)


def test_data_is_never_run() -> None:
    files = {path: source for path, source in sources("nestedcages_core", "addon").items() if FORBIDDEN & named(source)}
    assert [(path, use) for path, source in files.items() for use in uses(source)] == []


def named(source: str) -> set[str]:
    """All words of a source, as Python reads them, so that few files are parsed."""
    return set(re.findall(r"\w+", unicodedata.normalize("NFKC", source)))


@pytest.mark.parametrize(
    "wrong", ["eval(x)", "import pickle", "from dill import load", "run(x, shell=True)", "\uff45val(x)"]
)
def test_what_runs_data_is_found(wrong: str) -> None:
    assert list(uses(wrong)) and FORBIDDEN & named(wrong)
