"""The boundary of the opaque pixels of a picture, along pixel edges."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import BoolArray, FloatArray
from ...geometry.mesh import Mesh
from ..limits import Limits, no_outline

CUT = 0.25
"""Cut at the corner of a transparent pixel between two opaque ones that only share a point, in pixels."""

EAST, SOUTH, WEST, NORTH = range(4)
STEPS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
"""One pixel edge in each direction; x counts columns, y counts rows downwards."""


def boundary_of_pixels(opaque: BoolArray, *, limits: Limits | None = None) -> Mesh:
    """The outline of the pixels that are True in (H, W); pixel (row, column) is the square from (column, row) on.

    Opaque pixels that share only a corner belong together. The boundary would touch itself there; it passes through
    the two transparent pixels instead, cutting off their corners, so that every opaque pixel stays inside. Nowhere
    else does it leave the pixels' edges. Raises InvalidMeshError if nothing is opaque, NestedCagesError if more edges
    of pixels bound it than the limits allow points.
    """
    solid = np.pad(np.asarray(opaque, dtype=bool), 1)
    if solid.ndim != 2 or not solid.any():
        raise no_outline("The picture has no opaque pixel; choose another picture or a lower threshold.")
    # unit edges with the opaque pixel to the right when walking with y downwards, by direction and starting corner
    above, below = solid[:-1, 1:-1], solid[1:, 1:-1]
    left, right = solid[1:-1, :-1], solid[1:-1, 1:]
    leaves = np.zeros((4, solid.shape[0] - 1, solid.shape[1] - 1), dtype=bool)  # whether an edge leaves a corner
    leaves[EAST, :, :-1] = below & ~above
    leaves[WEST, :, 1:] = above & ~below
    leaves[SOUTH, :-1, :] = left & ~right
    leaves[NORTH, 1:, :] = right & ~left
    (limits or Limits()).check("points", int(np.count_nonzero(leaves)))
    return Mesh.from_loops(_walked(leaves))


def _walked(leaves: BoolArray) -> list[FloatArray]:
    """The loops of unit edges, corners only.

    leaves: (4, rows, columns) whether an edge leaves a corner in a direction. Where two do, the walk turns left, away
    from its opaque pixel and around the transparent one between two opaque pixels, which joins these.
    """
    rows, columns = leaves.shape[1:]
    corners = rows * columns
    ahead = np.array([1, columns, -1, -columns])
    flat = leaves.reshape(4, corners)
    direction, corner = np.nonzero(flat)
    target = corner + ahead[direction]
    onward = np.full(len(direction), -1)
    for turn in (1, 0, -1):  # right, straight on, left: the last that is possible is kept
        candidate = (direction + turn) % 4
        possible = flat[candidate, target]
        onward[possible] = candidate[possible]
    crowded = flat.sum(axis=0, dtype=np.int8) == 2
    following = np.searchsorted(direction * corners + corner, onward * corners + target)  # edges are in this order
    turning = (onward != direction).tolist()
    points = np.stack((target % columns, target // columns), axis=1).astype(np.float64)
    # the corner at the end of each edge: one point, or two where it is cut off
    cut = crowded[target]
    before = points - CUT * STEPS[direction]
    after = points + CUT * STEPS[onward]
    before[~cut] = points[~cut]
    followers, cuts = following.tolist(), cut.tolist()
    seen = bytearray(len(followers))
    loops = []
    for start in range(len(followers)):
        if seen[start]:
            continue
        chain: list[int] = []
        edge = start
        while not seen[edge]:
            seen[edge] = 1
            if turning[edge]:
                chain.append(edge)
            edge = followers[edge]
        twice = np.repeat(chain, [1 + cuts[k] for k in chain])
        second = np.zeros(len(twice), dtype=bool)
        second[1:] = twice[1:] == twice[:-1]
        loops.append(np.where(second[:, None], after[twice], before[twice]))
    return loops
