"""Which loops of a drawing are worth their vertices: holes are filled and parts joined where that is cheaper.

- `parts`: a drawing as parts with holes with parts.
- `joining`: outlines around two parts, or around a part and the hole that it lies in.
- `knapsack`: the best split of vertices over all that may become of them.
- `choosing`: the decimation that does so.
- `tradeoff`: what other numbers of vertices would give.
"""

from .choosing import FewerLoops, advice
from .tradeoff import Tradeoff, knee_note

__all__ = ["FewerLoops", "Tradeoff", "advice", "knee_note"]
