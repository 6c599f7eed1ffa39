"""Every number with a name says what it is for, and in each room a name stands for one constant."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from support.sources import nodes, sources

PROJECT = ("nestedcages_core", "addon")


class Constant(NamedTuple):
    name: str
    value: str
    where: str
    is_described: bool


def constants(source: str, where: str) -> Iterator[Constant]:
    """The constants of a module whose values hold numbers, those that are assigned together one by one.

    They are described by the string after them, by a comment on their line, or by one in the lines right above.
    """
    lines, body = source.splitlines(), nodes(source)[0].body  # type: ignore[attr-defined]
    for number, statement in enumerate(body):
        target = _target(statement)
        if target is None or not _has_number(statement.value):  # type: ignore[attr-defined]
            continue
        value = statement.value  # type: ignore[attr-defined]
        names = target.elts if isinstance(target, ast.Tuple) else [target]
        values = value.elts if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) else [value] * len(names)
        described = _has_string_after(body, number) or _has_comment(lines, statement)
        for one, its in zip(names, values, strict=True):
            if isinstance(one, ast.Name) and one.id.lstrip("_").isupper():
                yield Constant(one.id, ast.unparse(its), f"{where}:{statement.lineno}", described)


def _target(statement: ast.stmt) -> ast.expr | None:
    if isinstance(statement, ast.Assign):
        return statement.targets[0]
    return statement.target if isinstance(statement, ast.AnnAssign) and statement.value is not None else None


def _has_number(value: ast.expr) -> bool:
    """Whether a value is a number, or made of numbers; those that are indices of something do not count."""
    nodes = list(ast.walk(value))
    indices = {id(part) for node in nodes if isinstance(node, ast.Subscript) for part in ast.walk(node.slice)}
    return any(
        isinstance(node, ast.Constant) and type(node.value) in (int, float) and id(node) not in indices
        for node in nodes
    )


def _has_string_after(body: list[ast.stmt], number: int) -> bool:
    """Whether a string follows, with nothing but other constants between."""
    for statement in body[number + 1 :]:
        if isinstance(statement, ast.Expr):
            return isinstance(statement.value, ast.Constant) and isinstance(statement.value.value, str)
        if _target(statement) is None:
            return False
    return False


def _has_comment(lines: list[str], statement: ast.stmt) -> bool:
    if "# " in lines[statement.lineno - 1]:
        return True
    for line in reversed(lines[: statement.lineno - 1]):
        if not line.strip():
            return False
        if line.startswith("#"):
            return True
    return False


def undescribed(files: Mapping[str, str]) -> list[str]:
    found = [constant for where, source in files.items() for constant in constants(source, where)]
    return [f"{constant.where}: {constant.name}" for constant in found if not constant.is_described]


def ambiguous(files: Mapping[str, str]) -> list[str]:
    """Names of constants with several values, or with one value that is written several times."""
    places: defaultdict[str, list[Constant]] = defaultdict(list)
    for where, source in files.items():
        for constant in constants(source, where):
            places[constant.name].append(constant)
    return [f"{name}: {', '.join(c.where for c in found)}" for name, found in places.items() if len(found) > 1]


def rooms() -> Iterator[dict[str, str]]:
    """The files of each room. Each published method is a room, since it names its constants as its paper does."""
    found: defaultdict[str, dict[str, str]] = defaultdict(dict)
    for where, source in sources(*PROJECT).items():
        folders = where.split("/")[:-1]
        found["/".join(folders[: 3 if "published" in folders else 2])][where] = source
    yield from found.values()


def test_every_constant_says_what_it_is_for() -> None:
    assert undescribed(sources(*PROJECT)) == []


def test_a_name_stands_for_one_constant() -> None:
    assert [found for room in rooms() for found in ambiguous(room)] == []
