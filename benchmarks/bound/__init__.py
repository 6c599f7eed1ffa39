"""A lower bound on the area of all simple polygons of at most m vertices around a loop: docs/method.md, section 5.

- `outline`: the loop, areas between it and chords, what rays from its convex vertices meet.
- `nodes`: cells of edges that touch a vertex, and of cage vertices on the outline.
- `corners`, `chords`: the least area that each kind of move between two nodes encloses.
- `walks`: the cheapest closed walk of at most m vertices, and which moves cheap walks use.
- `search`: cells on cheap walks are halved until the target is proven, or time is up.
"""

from .search import Bound, lower_bound

__all__ = ["Bound", "lower_bound"]
