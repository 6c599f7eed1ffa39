"""Every hierarchy that a test of the core gets passes by the independent checker once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

import nestedcages_core
from nestedcages_core import check
from nestedcages_core.cache import forget

LARGEST_PAIRS = 100_000
"""Product of the vertex counts of cage and fine mesh up to which a level is judged."""

STEPS_JUDGED = 2
"""Motions between steps that are judged of each level, spread evenly; all of them in thorough tests."""


@pytest.fixture(autouse=True)
def nothing_remembered() -> None:
    """Each test computes what it tests."""
    forget()


@pytest.fixture(autouse=True)
def judged(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> Iterator[None]:
    """Check the levels of every hierarchy when it is made, each once."""
    hierarchy = nestedcages_core.Hierarchy
    make = hierarchy.__init__
    seen: dict[int, Any] = {}

    def made(self: Any, *arguments: Any, **options: Any) -> None:
        make(self, *arguments, **options)
        for level in self.levels:
            small = len(level.cage.vertices) * len(level.fine.vertices) <= LARGEST_PAIRS
            if small and id(level) not in seen:
                seen[id(level)] = level  # kept, so that no other level gets its id
                steps = None if "thorough" in request.keywords else STEPS_JUDGED
                found = check(level.fine, level, motions=steps).problems
                assert not found, f"the checker found: {'; '.join(found[:5])}"

    monkeypatch.setattr(hierarchy, "__init__", made)
    yield
