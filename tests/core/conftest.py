"""Every hierarchy that a test of the core gets passes by the independent judge once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

import nestedcages_core
from judge import faults_of_cage, faults_of_motion
from nestedcages_core.cache import forget

LARGEST_PAIRS = 100_000
"""Product of the vertex counts of cage and fine mesh up to which a level is judged."""

STEPS_JUDGED = 4
"""Motions between steps that are judged of each level, spread evenly; all of them in thorough tests."""


def faults_of_level(level: Any, *, all_steps: bool = False) -> list[str]:
    """What the judge finds wrong with a level of a hierarchy."""
    way = level.reinflation
    like_fine = sorted(level.cage.loop_signs.tolist()) == sorted(level.fine.loop_signs.tolist())
    around, within = (level.fine, level.cage) if level.inside else (level.cage, level.fine)
    faults = faults_of_cage(around, within, level.report.wanted_clearance, same_loops=like_fine)
    last = len(way.cage_steps) - 1
    steps = (
        range(last) if all_steps else sorted({k * last // STEPS_JUDGED for k in range(STEPS_JUDGED)} & {*range(last)})
    )
    if not (way.fine_steps[-1] == level.fine.vertices).all():
        faults.append("the fine mesh is not back at its coordinates")
    return faults + faults_of_motion(level.cage.edges, level.fine.edges, way.cage_steps, way.fine_steps, steps)


@pytest.fixture(autouse=True)
def nothing_remembered() -> None:
    """Each test computes what it tests."""
    forget()


@pytest.fixture(autouse=True)
def judged(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> Iterator[None]:
    """Judge the levels of every hierarchy when it is made, each once."""
    hierarchy = nestedcages_core.Hierarchy
    make = hierarchy.__init__
    seen: dict[int, Any] = {}

    def made(self: Any, *arguments: Any, **options: Any) -> None:
        make(self, *arguments, **options)
        for level in self.levels:
            small = len(level.cage.vertices) * len(level.fine.vertices) <= LARGEST_PAIRS
            if small and id(level) not in seen:
                seen[id(level)] = level  # kept, so that no other level gets its id
                faults = faults_of_level(level, all_steps="thorough" in request.keywords)
                assert not faults, f"the judge found: {'; '.join(faults[:5])}"

    monkeypatch.setattr(hierarchy, "__init__", made)
    yield
