"""A short text that identifies the input of a result: equal texts mean equal results."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from types import CodeType
from typing import Any

import numpy as np

from ..geometry.mesh import Mesh
from .tasks import Task

REVISION = 1
"""Number of changes to the method that make stored results out of date."""


def fingerprint(task: Task) -> str:
    """Fingerprint of shape, levels, settings and ``keep``; empty if the shape or its levels are not valid.

    User-defined objects without fields count as new in every run, since their behaviour cannot be read from them.
    """
    try:
        mesh = Mesh.of(task.shape)
        levels = task.levels(mesh) if callable(task.levels) else task.levels
        parts = (REVISION, mesh, list(levels), task.settings, task.keep)
    except Exception:  # running the task reports the reason
        return ""
    found = hashlib.sha256()
    _add(found.update, parts)
    return found.hexdigest()


def _add(update: Callable[[bytes], None], value: Any) -> None:
    """Feed a value to the hash, each part with its type and length, so that different values differ."""
    update(f"<{type(value).__module__}.{type(value).__qualname__}>".encode())
    if isinstance(value, Mesh):
        _add(update, value.vertices)
        _add(update, value.edges)
    elif isinstance(value, np.ndarray):
        update(f"{value.dtype.str}{value.shape}".encode() + value.tobytes())
    elif isinstance(value, list | tuple):
        update(f"{len(value)}".encode())
        for item in value:
            _add(update, item)
    elif is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            update(field.name.encode())
            _add(update, getattr(value, field.name))
    elif callable(value) and hasattr(value, "__code__"):
        update(f"{value.__module__}.{value.__qualname__}".encode())
        _add(update, (value.__code__, value.__defaults__, [cell.cell_contents for cell in value.__closure__ or ()]))
    elif isinstance(value, CodeType):
        update(value.co_code)
        _add(update, (value.co_consts, value.co_names))
    else:
        update(repr(value).encode())
