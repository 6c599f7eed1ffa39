"""Everything that was measured, as the report and the discussion need it."""

from __future__ import annotations

from typing import NamedTuple

from comparison.experiments import Results, Reuse


class Findings(NamedTuple):
    """Everything that was measured."""

    table1: Results
    ladder: Results
    figures: Results
    starts: Results
    alone: Results
    filters: Results
    energies: Results
    reuse: dict[str, Reuse]
    seconds: float


def share(cost: Reuse) -> float:
    """Building of lists as a percentage of the reinflation."""
    return 100.0 * cost.building / max(cost.reinflation, 1e-12)
