"""The add-on, registered once from the repository's root as Blender would, and an empty scene for every test."""

from __future__ import annotations

import atexit
import importlib.util
import os
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from types import ModuleType
from typing import Any

import pytest

bpy = pytest.importorskip("bpy")

ROOT = Path(__file__).resolve().parents[2]
# Any name will do: an extension is imported as bl_ext.<repository>.<id>, so nothing may depend on it.
PACKAGE = "nested_cages_extension"


# Before 5.0, Blender as a module may hang in its own clean-up when the interpreter ends after a long run.
ENDS_BY_ITSELF = (5, 0, 0)
STATUS = pytest.StashKey[int]()


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    session.config.stash[STATUS] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config: pytest.Config) -> None:
    """Ends the process with pytest's own exit status when everything has been unregistered and reported."""
    if bpy.app.version < ENDS_BY_ITSELF and STATUS in config.stash:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(config.stash[STATUS])


@pytest.fixture(scope="session")
def extension() -> Iterator[ModuleType]:
    """The root package as Blender's extension, registered for the whole session."""
    spec = importlib.util.spec_from_file_location(PACKAGE, ROOT / "__init__.py", submodule_search_locations=[str(ROOT)])
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = module
    spec.loader.exec_module(module)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    module.register()
    # Classes that are still registered when the interpreter ends make some versions of bpy crash or hang.
    registered = [True]

    def leave() -> None:
        if registered:
            registered.clear()
            module.unregister()

    atexit.register(leave)
    yield module
    leave()


@pytest.fixture(autouse=True)
def empty_scene(extension: ModuleType) -> None:
    """A scene without objects, on frame 1 of 1 to 250, no jobs, and nothing remembered of earlier computations."""
    import_module(f"{PACKAGE}.addon.generation.job").end_all(bpy.context)
    # Without the preferences: to read them too registers Blender's own add-ons again, four times the time.
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    import_module(f"{PACKAGE}.nestedcages_core.cache").forget()


@pytest.fixture(scope="session")
def addon(extension: ModuleType) -> ModuleType:
    """The package `addon`, with its rooms and their files as attributes."""
    package = import_module(f"{PACKAGE}.addon")
    for module in walk_packages(package.__path__, f"{package.__name__}."):
        import_module(module.name)
    return package


@pytest.fixture(scope="session")
def core(extension: ModuleType) -> ModuleType:
    """The core as the add-on sees it."""
    return import_module(f"{PACKAGE}.nestedcages_core")


@pytest.fixture
def runs(core: ModuleType, monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """The levels that the core has computed, not remembered."""
    found: list[object] = []
    run = import_module(f"{core.__name__}.hierarchy.run")
    remembered = run.whole_level

    def noted(work: Any, progress: Any, *asked: Any) -> Any:
        def made() -> Any:
            found.append(asked[3])
            return (yield from work)

        return (yield from remembered(made(), progress, *asked))

    monkeypatch.setattr(run, "whole_level", noted)
    return found
