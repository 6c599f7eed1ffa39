"""Small changes of a file's code, each alone, for ``mutants.py``."""

from __future__ import annotations

import ast
import difflib
from collections.abc import Callable, Iterator
from typing import NamedTuple

SWAPS: dict[type, type] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.And: ast.Or, ast.Or: ast.And,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.USub: ast.UAdd,
    ast.FloorDiv: ast.Mult, ast.Pow: ast.Mult,
}  # fmt: skip
"""What each operator becomes."""

SCALE = 1.02
"""Factor on floating-point constants."""

UNJUDGED = {"strict", "repr"}
"""Keywords that no result depends on: of `zip`, where lengths are equal, and of `field`, for people who look at it."""


class Mutant(NamedTuple):
    """One change of a file."""

    path: str
    lines: range
    """Those of the statement that is changed, or of its head."""
    before: str
    after: str
    source: str

    def __str__(self) -> str:
        return f"{self.before}  ->  {self.after}"


def mutants(path: str, source: str) -> Iterator[Mutant]:
    """Every change of a file, each alone."""
    heads, original = list(_heads(ast.parse(source))), plain(source).splitlines()
    for number in range(sum(1 for _ in _changes(ast.parse(source)))):
        tree = ast.parse(source)
        line, change = next(each for k, each in enumerate(_changes(tree)) if k == number)
        change()
        changed = ast.unparse(ast.fix_missing_locations(tree))
        lines = [each for each in difflib.ndiff(original, changed.splitlines()) if each[0] in "-+"]
        before, after = (" ".join(each[2:].strip() for each in lines if each[0] == sign) for sign in "-+")
        if before != after:
            yield Mutant(path, min((head for head in heads if line in head), key=len), before, after, changed)


def plain(source: str) -> str:
    """The source as the changed ones are written."""
    return ast.unparse(ast.parse(source))


def _heads(tree: ast.AST) -> Iterator[range]:
    """Lines of each statement, without those of the statements in it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt):
            inner = [each.lineno for each in ast.walk(node) if isinstance(each, ast.stmt) and each.lineno > node.lineno]
            yield range(node.lineno, min(inner, default=(node.end_lineno or node.lineno) + 1))


def _changes(tree: ast.AST) -> Iterator[tuple[int, Callable[[], object]]]:
    """Line and action of each change of a tree; messages, logs, annotations and docstrings stay."""
    for node in _judged(tree):
        line = getattr(node, "lineno", 0)
        if isinstance(node, ast.Compare):
            for k, operator in enumerate(node.ops):
                if type(operator) in SWAPS:
                    yield line, lambda n=node, k=k, o=operator: n.ops.__setitem__(k, SWAPS[type(o)]())
        elif isinstance(node, ast.BinOp | ast.BoolOp | ast.UnaryOp | ast.AugAssign) and type(node.op) in SWAPS:
            yield line, lambda n=node: setattr(n, "op", SWAPS[type(n.op)]())
        elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
            yield line, lambda n=node: setattr(n, "value", not n.value)
        elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            new = node.value + 1 if isinstance(node.value, int) or node.value == 0.0 else node.value * SCALE
            yield line, lambda n=node, new=new: setattr(n, "value", new)
        if isinstance(node, ast.If | ast.IfExp | ast.While):
            for value in (True, False) if not isinstance(node, ast.While) else (False,):
                yield line, lambda n=node, value=value: setattr(n, "test", ast.Constant(value))
        for name in ("body", "orelse"):
            block = getattr(node, name, None)
            for k, statement in enumerate(block if isinstance(block, list) else ()):
                if isinstance(statement, ast.AugAssign) or (
                    isinstance(statement, ast.Expr)
                    and isinstance(statement.value, ast.Call | ast.Yield)
                    and not _is_log(statement)
                ):
                    yield statement.lineno, lambda b=block, k=k: b.__setitem__(k, ast.Pass())


def _judged(node: ast.AST) -> Iterator[ast.AST]:
    """The node and all below it whose change a test should see."""
    for_types = isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
    if isinstance(node, ast.Raise | ast.JoinedStr | ast.Assert) or for_types or _is_log(node):
        return
    if (isinstance(node, ast.keyword) and node.arg in UNJUDGED) or _asks_for_inside(node):
        return
    yield node
    shaped = isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "reshape"
    for name, value in ast.iter_fields(node):
        if name in {"annotation", "returns", "decorator_list"}:
            continue
        for child in value if isinstance(value, list) else [value]:
            # any negative length of reshape is the one to be found
            if isinstance(child, ast.AST) and not (shaped and ast.unparse(child) == "-1"):
                yield from _judged(child)


def _asks_for_inside(node: ast.AST) -> bool:
    """Whether a node is a comparison ``side < 0``: a side is 1 or -1, so that ``<= 0`` and ``< 1`` are the same."""
    return isinstance(node, ast.Compare) and ast.unparse(node).split(".")[-1] == "side < 0"


def _is_log(node: ast.AST) -> bool:
    """Whether a node is a statement that writes to the log."""
    call = node.value if isinstance(node, ast.Expr) else None
    return isinstance(call, ast.Call) and ast.unparse(call.func).startswith("logger.")
