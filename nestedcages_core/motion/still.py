"""A still cage around a drawing that moves."""

from __future__ import annotations

from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike

from ..errors import NestingError
from ..geometry.mesh import Mesh
from ..tasks import Stage
from ..verification import verify, verify_motion
from .poses import read_poses
from .results import MotionReport, MovingLevel


def certified_still(
    cage: Mesh, fine: Mesh, poses: ArrayLike, *, times: ArrayLike | None = None, clearance: float = 0.0
) -> Stage[float, MovingLevel]:
    """A level with one key: a cage that encloses all poses (T, n, 2) of a drawing, and the motion between them.

    A generator: yields the fraction done. Its certificates are those of the poses. Raises NestingError with the pose.
    """
    began, given = perf_counter(), list(read_poses(fine, poses, times))
    certificates = []
    same_loops = cage.has_loops_like(fine)
    for number, pose in enumerate(given):
        yield number / len(given)
        certificate = verify(cage, fine.moved(pose.vertices), clearance, same_loops=same_loops)
        way = np.stack([given[max(number - 1, 0)].vertices, pose.vertices])
        if not certificate or not verify_motion(cage, fine, np.stack([cage.vertices] * 2), way):
            why = " ".join(certificate.problems) or "The drawing crosses it before this pose."
            raise NestingError(
                f"The still cage does not hold at pose {number}: {why} Ask for more clearance.",
                code="certificate.failed",
                problems=certificate.problems,
                pose=number,
            )
        certificates.append(certificate)
    report = MotionReport(tuple(certificates), np.arange(len(given)), clearance, perf_counter() - began)
    first = given[0]
    return MovingLevel(cage, np.array([first.time]), first.vertices[None], cage.vertices[None], report)
