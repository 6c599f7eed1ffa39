"""Which loops of a drawing are worth their vertices: holes are filled and parts joined where that is cheaper.

- `parts`: a drawing as parts with holes with parts.
- `joining`: outlines around two parts, or around a part and the hole that it lies in.
- `knapsack`: the best split of vertices over all that may become of them.
- `choosing`: the decimation that does so.
"""

from .choosing import FewerLoops, advice

__all__ = ["FewerLoops", "advice"]
