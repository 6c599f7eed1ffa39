"""The package ``nestedcages_core``, imported on first use: Blender starts faster, and without scipy the add-on still
registers and reports what is missing.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

from .errors import UserError, told

if TYPE_CHECKING:
    import nestedcages_core as core
    from nestedcages_core import run as runs
    from nestedcages_core.errors import notes as errors
    from nestedcages_core.formats import pictures
    from nestedcages_core.geometry import broad_phase, distance, loops, predicates, triangulation
    from nestedcages_core.levels import certify, steps
else:

    class _LazyModule(ModuleType):
        """The core or one of its modules; finds names there on first use. Raises: UserError without scipy."""

        def __getattr__(self, name: str) -> object:
            if name.startswith("__"):
                raise AttributeError(name)  # used by tools that inspect modules, not by the add-on
            try:
                from .. import nestedcages_core

                room = nestedcages_core.__name__
                module = nestedcages_core if self.__name__ == "core" else import_module(f"{room}.{self.__name__}")
                return getattr(module, name)
            except ImportError as error:
                if (error.name or "").partition(".")[0] != "scipy":
                    raise
                raise UserError(
                    "Nested Cages needs scipy, which is not bundled with this copy of the extension: "
                    "install the zip for your operating system and Blender version"
                ) from error

    core, broad_phase = map(_LazyModule, ("core", "geometry.broad_phase"))
    distance = _LazyModule("geometry.distance")
    loops, pictures, predicates = map(_LazyModule, ("geometry.loops", "formats.pictures", "geometry.predicates"))
    errors, certify, steps = map(_LazyModule, ("errors.notes", "levels.certify", "levels.steps"))
    runs, triangulation = map(_LazyModule, ("run", "geometry.triangulation"))

__all__ = ["blamed", "broad_phase", "certify", "core", "distance", "errors", "loops"]
__all__ += ["pictures", "predicates", "runs", "steps", "triangulation"]


@contextmanager
def blamed(what: str) -> Iterator[None]:
    """Errors of the core and of files, as those of what is at fault: "'name'". Raises: UserError."""
    try:
        yield
    except (core.NestedCagesError, OSError) as error:
        raise UserError(f"{what}: {told(error)}") from error
