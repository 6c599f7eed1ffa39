"""Each test computes what it tests."""

from __future__ import annotations

import pytest

from nestedcages_core.cache import forget


@pytest.fixture(autouse=True)
def nothing_remembered() -> None:
    """Each test computes what it tests."""
    forget()
