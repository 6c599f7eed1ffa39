"""The region that a moving drawing sweeps, for one still cage around a whole animation."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..motion.poses import read_poses
from .solids import Painted, shapely, solid

PARTS_PER_POSE = 4
"""Number of parts of the motion between two poses. In each, an edge is assumed to sweep the convex hull of its two
places. That is too much only where it turns over, by an amount that falls with the square of the number of parts."""

SWEPT_SEAM = 1e-6
"""Width of gaps that are closed, as a fraction of the drawing's diagonal: rounding between abutting hulls."""


def swept(fine: Mesh, poses: ArrayLike | Iterable[ArrayLike]) -> Mesh:
    """The union of all positions of a drawing that moves linearly from pose to pose.

    fine: its edges are the topology; poses: (T, n, 2), or an iterable of (n, 2). Covers a little more than the union
    where edges turn over between poses. Raises InvalidMeshError that names a pose, NestedCagesError without shapely.
    """
    places = [pose.vertices for pose in read_poses(fine, poses, None)]
    solids = [Painted([place[loop] for loop in fine.loops]) for place in places]
    ways = [_swept_edges(fine, before, after) for before, after in pairwise(places)]
    corners = np.concatenate(ways).reshape(-1, 2)
    hulls = shapely.convex_hull(shapely.multipoints(corners, indices=np.repeat(np.arange(len(corners) // 4), 4)))
    areas = hulls[shapely.get_dimensions(hulls) == 2]
    return solid([*solids, *areas], width=SWEPT_SEAM * fine.diagonal)


def _swept_edges(fine: Mesh, before: FloatArray, after: FloatArray) -> FloatArray:
    """(PARTS_PER_POSE · n, 4, 2) the two places of each edge in each part of the motion."""
    share = np.linspace(0.0, 1.0, PARTS_PER_POSE + 1)[:, None, None]
    at = before + share * (after - before)
    at[-1] = after
    ends = at[:, fine.successor]
    places: FloatArray = np.stack((at[:-1], ends[:-1], at[1:], ends[1:]), axis=2).reshape(-1, 4, 2)
    return places
