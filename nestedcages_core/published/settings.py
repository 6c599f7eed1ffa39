"""The published methods as settings: one definition for the add-on's presets, the benchmarks and scripts.

They have no fallback, and no tightening but their own.
"""

from dataclasses import replace

from ..decimation.choices import EdgeCollapse
from ..energies import Area
from ..energies.no_energy import NoEnergy
from ..hierarchy import Settings
from ..tightening import Tightening
from .gurditta_jacobson_2022 import (
    PROGRAM_RANGE,
    PROGRAM_STEP,
    GradientDescent,
    Midpoint,
    PaperContact,
    PaperFlow,
    Repairs,
    SignedDistanceFlow,
)
from .sacht_2015 import ElTopo
from .sellan_2022 import LevelSet

AUGMENTED_2022 = Settings(
    fallback=None,
    flow=PaperFlow(step=PROGRAM_STEP, absolute=True),
    contact=PaperContact(d_hat=PROGRAM_RANGE, absolute=True),
    tightening=Tightening(iterations=0),
)
"""Gurditta & Jacobson (2022) as written: its program's flow, barriers and gradient descent, with the program's absolute
lengths, so that the result depends on the units of the drawing."""

AUGMENTED_2022_REPAIRED = replace(
    AUGMENTED_2022,
    flow=PaperFlow(exact_parity=True),
    contact=PaperContact(
        solver=GradientDescent(refuse_infinite=True), repairs=Repairs(parity=True, exact_home=True)
    ),
)  # fmt: skip
"""The same with fixes of its program, without which the fine mesh never fully returns: exact tests, finite energies,
exact return, and lengths relative to the drawing as on the annulus of Table 1."""

NESTED_CAGES_2015 = replace(
    AUGMENTED_2022,
    decimation=EdgeCollapse(),
    flow=SignedDistanceFlow(step=1e-3, limit=1000, by_longest_side=True, quadrature=Midpoint()),
    contact=ElTopo(energy=NoEnergy(), final_energy=Area()),
)
"""Sacht et al. (2015): edge collapse, the flow down the signed distance with the gradient at midpoints, expansion by El
Topo without an energy, and a final pass that lowers the area."""

SIMPLE_2022 = replace(AUGMENTED_2022_REPAIRED, decimation=LevelSet(change_loops=True))
"""Simple nested cages (in Sellán et al. 2022): the level set itself is the cage, with no flow and no contact. As in its
program, holes may close and parts merge; see `LevelSet` for what differs."""
