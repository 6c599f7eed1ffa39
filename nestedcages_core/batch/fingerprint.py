"""A short text that identifies the input of a result: equal texts mean equal results."""

from __future__ import annotations

import functools
import hashlib
import sys
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from ..geometry.mesh import Mesh
from .tasks import Task

INSTALLED = {*sys.stdlib_module_names, "numpy", "scipy", "shapely", __name__.partition(".")[0]}
"""Packages whose functions are the same in every run."""

NAMED = (ModuleType, type, FunctionType, BuiltinFunctionType, np.ufunc)
"""What is known by its name if it is installed."""

PLAIN = (bool, int, float, complex, str, bytes, type(None), type(...), np.generic)

REVISION = 2
"""Number of changes to the method that make stored results out of date."""


class UnreadableError(Exception):
    """A function, or something that it refers to, has a state that cannot be read."""


def fingerprint(task: Task) -> str:
    """Fingerprint of shape, levels, settings and ``keep``; empty if the shape or its levels are not valid.

    Empty too if an object has neither fields nor a `key`, a text that stands for it, and its state cannot be read: then
    no stored result counts as the same.
    """
    try:
        mesh = Mesh.of(task.shape)
        levels = task.levels(mesh) if callable(task.levels) else task.levels
        return hash_of((REVISION, mesh, list(levels), task.settings, task.keep))
    except Exception:  # running the task reports the reason
        return ""


def hash_of(value: Any) -> str:
    """Hash of a value by its content, of a function by its code and all that it refers to. Raises UnreadableError."""
    found = hashlib.sha256()
    _add(found.update, value, set())
    return found.hexdigest()


def _add(update: Callable[[bytes], None], value: Any, seen: set[int]) -> None:
    """Feed a value to the hash, each part with its type and length, so that different values differ."""
    update(f"<{type(value).__module__}.{type(value).__qualname__}>".encode())
    if id(value) in seen:  # a function that calls itself
        return
    if isinstance(value, PLAIN):
        update(repr(value).encode())
    elif isinstance(value, np.ndarray) and not value.dtype.hasobject:
        update(f"{value.dtype.str}{value.shape}".encode() + value.tobytes())
    elif isinstance(getattr(value, "key", None), str):
        update(value.key.encode())
    else:
        parts = list(_parts(value, seen))
        update(f"{len(parts)}".encode())
        for part in parts:
            _add(update, part, seen)


def _parts(value: Any, seen: set[int]) -> Iterator[Any]:
    """What a value consists of. Raises UnreadableError."""
    if isinstance(value, Mesh):
        yield from (value.vertices, value.edges)
    elif isinstance(value, list | tuple):
        yield from value
    elif isinstance(value, dict):
        yield from value.items()
    elif isinstance(value, set | frozenset):
        yield from sorted(map(hash_of, value))
    elif isinstance(value, CodeType):
        yield from (value.co_code, value.co_consts, value.co_names)
    elif isinstance(value, functools.partial):
        yield from (value.func, value.args, value.keywords)
    elif isinstance(value, MethodType):
        yield from (value.__func__, value.__self__)
    elif isinstance(value, NAMED) and _module(value) in INSTALLED:
        yield from (_module(value), getattr(value, "__qualname__", value.__name__))
    elif isinstance(value, FunctionType):
        seen.add(id(value))
        cells = [cell.cell_contents for cell in value.__closure__ or ()]
        named = [(name, value.__globals__[name]) for name in _names(value.__code__) if name in value.__globals__]
        yield from (value.__module__, value.__qualname__, value.__code__, value.__defaults__, value.__kwdefaults__)
        yield from (cells, named)
    elif is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            yield from (field.name, getattr(value, field.name))
    else:
        raise UnreadableError(f"{value!r:.80} has a state that cannot be read")


def _module(value: Any) -> str:
    """The package that a module, class or function comes from."""
    found = value.__name__ if isinstance(value, ModuleType) else getattr(value, "__module__", None) or "numpy"
    return str(found).partition(".")[0]


def _names(code: CodeType) -> list[str]:
    """The names of a function and of those within it, sorted."""
    inner = (name for each in code.co_consts if isinstance(each, CodeType) for name in _names(each))
    return sorted({*code.co_names, *inner})
