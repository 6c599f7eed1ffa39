"""What all tests share: repeatable examples, and an independent judge of every hierarchy of the core."""

import os
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import settings

import nestedcages_core
from nestedcages_core import check

# A test run says the same of the same code everywhere; HYPOTHESIS_PROFILE=default looks at new examples every time.
settings.register_profile("repeatable", derandomize=True, deadline=None)  # slow machines find no faults
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))

MAX_PAIRS = 100_000
"""Product of the vertex counts of cage and fine mesh up to which a level is judged."""

JUDGED_STEPS = 2
"""Motions between steps that are judged of each level, spread evenly; all of them in thorough tests."""


@pytest.fixture(autouse=True)
def judged(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> Iterator[None]:
    """Check the levels of every hierarchy when it is made, each once, by the independent checker."""
    hierarchy = nestedcages_core.Hierarchy
    make = hierarchy.__init__
    seen: dict[int, Any] = {}

    def made(self: Any, *arguments: Any, **options: Any) -> None:
        make(self, *arguments, **options)
        for level in self.levels:
            small = len(level.cage.vertices) * len(level.fine.vertices) <= MAX_PAIRS
            if small and id(level) not in seen:
                seen[id(level)] = level  # kept, so that no other level gets its id
                steps = None if "thorough" in request.keywords else JUDGED_STEPS
                found = check(level.fine, level, motions=steps).problems
                assert not found, f"the checker found: {'; '.join(found[:5])}"

    monkeypatch.setattr(hierarchy, "__init__", made)
    yield
