"""The extension of this checkout, registered in a headless Blender as the installed one is."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "nested_cages"  # the name that the package of the extension gets, whatever its folder is called


@contextmanager
def registered() -> Iterator[None]:
    """Registers the extension for a while. Blender does not always survive its exit with classes left behind."""
    spec = importlib.util.spec_from_file_location(PACKAGE, ROOT / "__init__.py", submodule_search_locations=[str(ROOT)])
    assert spec is not None
    assert spec.loader is not None
    package = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = package
    spec.loader.exec_module(package)
    package.register()
    try:
        yield
    finally:
        package.unregister()
