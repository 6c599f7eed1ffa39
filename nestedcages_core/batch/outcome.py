"""One shape of a batch, and what came of it."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from time import perf_counter
from typing import Any, TypeAlias

from ..geometry.mesh import Mesh
from ..levels import Hierarchy, Settings, nested_cages

Keep: TypeAlias = Callable[[Hierarchy], Any]


@dataclass(frozen=True, eq=False)
class Outcome:
    """The result of one shape, or its error."""

    key: Hashable
    """Key of the shape, or its index in the input."""
    result: Any = None
    """The Hierarchy, or the part that was kept; None after an error."""
    error: Exception | None = None
    seconds: float = 0.0
    """Seconds of computation in the worker."""

    def unwrap(self) -> Any:
        """The result; raises the error if there is one."""
        if self.error is not None:
            raise self.error
        return self.result


@dataclass(frozen=True, eq=False)
class Task:
    """One shape to be computed by a worker."""

    key: Hashable
    shape: Any
    levels: Any
    settings: Settings
    keep: Keep | None

    def run(self) -> Outcome:
        """The outcome; errors are stored in it and do not end the batch."""
        began = perf_counter()
        try:
            mesh = Mesh.of(self.shape)
            levels = self.levels(mesh) if callable(self.levels) else self.levels
            hierarchy = nested_cages(mesh, levels, self.settings)
            result = hierarchy if self.keep is None else self.keep(hierarchy)
            return Outcome(self.key, result, None, perf_counter() - began)
        except Exception as error:
            return Outcome(self.key, None, error, perf_counter() - began)
