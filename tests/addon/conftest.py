"""The add-on, registered once from the repository's root as Blender would, and an empty scene for every test."""

import os
import sys

import pytest

bpy = pytest.importorskip("bpy")

from support.blender import (  # noqa: E402, F401 - fixtures
    core,
    empty_scene,
    extension,
    hasty,
    leave,
    reports,
    timers,
    window,
)
from support.drawings import circle, generate, made, poly_curve, star  # noqa: E402

# Before 5.0, Blender as a module may hang in its own clean-up when the interpreter ends after a long run.
ENDS_BY_ITSELF = (5, 0, 0)
STATUS = pytest.StashKey[int]()


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    session.config.stash[STATUS] = int(exitstatus)
    leave()


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config: pytest.Config) -> None:
    """Ends the process with pytest's own exit status when everything has been unregistered and reported."""
    if bpy.app.version < ENDS_BY_ITSELF and STATUS in config.stash:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(config.stash[STATUS])


@pytest.fixture
def cages():
    """A drawing with a hole and its cages: the source, the fine mesh, the cages."""
    source = poly_curve("Drawing", [star() * 2.0, circle(20, 0.5)])
    source.location = (1.0, 2.0, 0.5)
    source.rotation_euler = (0.3, 0.2, 0.1)
    source.scale = (2.0, 2.0, 2.0)
    generate("24, 12")
    fine, *found = made()
    return source, fine, found
