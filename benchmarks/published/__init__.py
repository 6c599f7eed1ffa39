"""Methods of other papers as they were published, behind the same protocols as ours.

- `sacht_2015`: its flow, and contact by El Topo's filter.
- `sellan_2022`: level sets as coarse meshes.
- `simplification`: coarse meshes across the fine mesh.
- `NESTED_CAGES_2015`, `SIMPLE_2022`: whole methods as settings. The core has those of the paper that it follows.
"""

from .sacht_2015 import ElTopo, SachtFlow
from .sellan_2022 import LevelSet
from .settings import NESTED_CAGES_2015, SIMPLE_2022
from .simplification import DouglasPeucker, EdgeCollapse, Visvalingam

__all__ = [
    "NESTED_CAGES_2015",
    "SIMPLE_2022",
    "DouglasPeucker",
    "EdgeCollapse",
    "ElTopo",
    "LevelSet",
    "SachtFlow",
    "Visvalingam",
]
