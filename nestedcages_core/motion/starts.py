"""The first cage of a motion: it fixes the distribution of vertices, so it is chosen for all poses at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..errors import NestedCagesError
from ..geometry.mesh import Mesh
from ..levels import nested_cages
from .following import Follower
from .promises import Promises

CANDIDATES = 3
"""Number of poses, spread over the motion, whose cages are candidates for the first cage."""

SAMPLE_POSES = 4
"""Number of poses, spread over the motion, at which a candidate is evaluated."""


def first_cage(
    poses: Sequence[Mesh],
    wanted: int | Mesh,
    promises: Promises,
    follower: Callable[[Mesh, Mesh], Follower],
) -> Mesh:
    """A cage of the first pose whose mean cost over the poses is small. Raises NestedCagesError.

    poses: meshes of the first poses; follower: makes a follower from a cage and the pose that it encloses.
    """
    first = nested_cages(poses[0], [wanted], promises.settings).levels[0].cage
    if isinstance(wanted, Mesh):
        return first
    best, least = first, _mean_cost(follower(first, poses[0]), first, poses, 0)
    for at in sorted({round(k * (len(poses) - 1) / CANDIDATES) for k in range(1, CANDIDATES)} - {0}):
        try:
            cage = nested_cages(poses[at], [wanted], promises.settings_at(poses[at])).levels[0].cage
        except NestedCagesError:
            continue
        moving = follower(cage, poses[at])
        if _mean_cost(moving, cage, poses, at) >= least:
            continue
        back = _followed_back(moving, cage, poses[: at + 1])
        cost = np.inf if back is None else _mean_cost(follower(back, poses[0]), back, poses, 0)
        if back is not None and cost < least:
            best, least = back, cost
    return best


def _mean_cost(follower: Follower, cage: Mesh, poses: Sequence[Mesh], at: int) -> float:
    """Mean cost of a cage of pose ``at`` that follows directly to each of some poses; infinite if it cannot."""
    unit = follower.units.points
    costs = []
    for k in sorted({round(s * (len(poses) - 1) / SAMPLE_POSES) for s in range(SAMPLE_POSES)}):
        if k == at:
            costs.append(follower.cost(unit(cage.vertices), unit(poses[k].vertices)))
            continue
        cages = follower.next(unit(cage.vertices), unit(poses[at].vertices), unit(poses[k].vertices))
        if cages is None:
            return np.inf
        costs.append(follower.cost(cages[-1], unit(poses[k].vertices)))
    return float(np.mean(costs))


def _followed_back(follower: Follower, cage: Mesh, poses: Sequence[Mesh]) -> Mesh | None:
    """The cage of the last of the poses, as it follows back to the first one."""
    unit = follower.units.points
    vertices = unit(cage.vertices)
    for before, after in zip(poses[:0:-1], poses[-2::-1], strict=True):
        cages = follower.next(vertices, unit(before.vertices), unit(after.vertices))
        if cages is None:
            return None
        vertices = cages[-1]
    return cage.moved(follower.stored(vertices))
