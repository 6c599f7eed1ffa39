"""LAPACK's Cholesky factorisation within a band, from the module of scipy that holds it.

Importing the package scipy.linalg takes longer than most first cages: it imports 190 modules, of which one is LAPACK.
"""

from __future__ import annotations

import sys
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from typing import Any

NAME = "scipy.linalg._flapack"


def _routines() -> tuple[Any, ...]:
    """From the module alone, or from scipy.linalg. Raises: ModuleNotFoundError without scipy."""
    if sys.platform == "win32":
        import scipy  # noqa: F401 - tells Windows where its libraries are
    try:
        if NAME not in sys.modules:
            package: Any = find_spec("scipy")
            spec: Any = PathFinder.find_spec(
                NAME, [f"{folder}/linalg" for folder in package.submodule_search_locations]
            )
            module = module_from_spec(spec)
            spec.loader.exec_module(module)
            sys.modules[NAME] = module  # for scipy.linalg, if that is imported later
        found: Any = sys.modules[NAME]
        return found.dpbtrf, found.dpbtrs
    except (ImportError, AttributeError):  # another scipy may keep it elsewhere
        from scipy.linalg import lapack

        return lapack.dpbtrf, lapack.dpbtrs


dpbtrf, dpbtrs = _routines()
