"""The package ``nestedcages_core``, imported on first use: Blender starts faster, and without scipy the add-on still
registers and says what is missing.
"""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING

from .errors import UserError

if TYPE_CHECKING:
    import nestedcages_core as core
else:

    class _LazyCore(ModuleType):
        """Stands for the core; each name is looked up there when it is asked for. Raises: UserError without scipy."""

        def __getattr__(self, name: str) -> object:
            if name.startswith("__"):
                raise AttributeError(name)  # asked by tools that inspect modules, not by the add-on
            try:
                from .. import nestedcages_core
            except ImportError as error:
                if (error.name or "").partition(".")[0] != "scipy":
                    raise
                raise UserError(
                    "Nested Cages needs scipy, which is not bundled with this copy of the extension: "
                    "install the zip for your operating system and Blender version"
                ) from error
            return getattr(nestedcages_core, name)

    core = _LazyCore("core", __doc__)

__all__ = ["core"]
