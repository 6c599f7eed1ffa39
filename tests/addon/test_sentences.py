"""What users read can be translated: whole sentences with named words, looked up by Blender, never glued together."""

from __future__ import annotations

import ast
import string
from collections.abc import Iterator
from pathlib import Path

import pytest

from conftest import ROOT

FILES = [path for path in sorted((ROOT / "addon").rglob("*.py")) if "presets" not in path.parts]
LOOKED_UP = {"say", "say_count", "Refusal"}


def calls(path: Path) -> Iterator[tuple[str, ast.Call]]:
    """Every call in a file, with the name of what is called."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            yield getattr(node.func, "attr", getattr(node.func, "id", "")), node


def literals(node: ast.expr) -> list[str]:
    """The strings that an argument can be, as far as they are written there."""
    if isinstance(node, ast.IfExp):
        return literals(node.body) + literals(node.orelse)
    return [node.value] if isinstance(node, ast.Constant) and isinstance(node.value, str) else []


def words(sentence: str) -> set[str]:
    """Names of the words that a sentence leaves open."""
    return {name for _, name, _, _ in string.Formatter().parse(sentence) if name is not None}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_sentences_are_whole_and_get_their_words(path) -> None:
    for name, call in calls(path):
        if name in LOOKED_UP:
            assert not any(isinstance(argument, ast.JoinedStr) for argument in call.args), ast.unparse(call)
            given = {keyword.arg for keyword in call.keywords} | ({"count"} if name == "say_count" else set())
            for argument in call.args:
                for sentence in literals(argument):
                    assert words(sentence) <= given or None in given, ast.unparse(call)  # None: handed on as **words


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_nothing_is_reported_or_shown_past_the_translation(path) -> None:
    for name, call in calls(path):
        if name in {"report", "status_text_set"}:
            shown = call.args[-1]
            assert not isinstance(shown, ast.JoinedStr) and not literals(shown), ast.unparse(call)
        if name in {"label", "progress"}:
            for keyword in call.keywords:
                assert keyword.arg != "text" or not isinstance(keyword.value, ast.JoinedStr), ast.unparse(call)
