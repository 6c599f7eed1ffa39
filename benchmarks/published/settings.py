"""Other papers' methods as settings: no fallback, and no tightening but their own."""

from dataclasses import replace

from nestedcages_core import (
    AUGMENTED_2022,
    AUGMENTED_2022_REPAIRED,
    Area,
    NoEnergy,
)

from .sacht_2015 import ElTopo, SachtFlow
from .sellan_2022 import LevelSet
from .simplification import EdgeCollapse

NESTED_CAGES_2015 = replace(
    AUGMENTED_2022,
    decimation=EdgeCollapse(),
    flow=SachtFlow(),
    contact=ElTopo(energy=NoEnergy(), final_energy=Area()),
)
"""Sacht et al. (2015): edge collapse, the flow down the signed distance with the gradient at midpoints, expansion by El
Topo without an energy, and a final pass that lowers the area."""

SIMPLE_2022 = replace(AUGMENTED_2022_REPAIRED, decimation=LevelSet(change_loops=True))
"""Simple nested cages (in Sellán et al. 2022): the level set itself is the cage, with no flow and no contact. As in its
program, holes may close and parts merge; see `LevelSet` for what differs."""
