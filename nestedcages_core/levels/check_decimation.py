"""What a decimation must obey, tried out on some shapes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..decimation import Decimation, Starts
from ..decimation.base import Count
from ..errors import NestedCagesError, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .nested_cages import nested_cages


def check_decimation(decimation: Decimation) -> None:
    """Try out that a decimation obeys what `nested_cages` relies on.

    For a star, a ring and two parts it makes meshes of several total numbers of vertices, and of numbers per loop. Each
    must be a valid `Mesh` with one loop for each loop of the shape, in its order and direction, and at most as many
    vertices as wanted; the same call must make the same mesh, and leave the shape as it is. Too few vertices must raise
    `NestingError`. A decimation may raise it elsewhere too, but must make a mesh for each shape. At last it starts a
    cage.

    Parameters
    ----------
    decimation : Decimation
        An object with the method ``decimate(fine, count, *, clearance)``, such as ``LineCycles()``.

    Raises
    ------
    NestedCagesError
        With a sentence that says what it does otherwise, and for which shape and number.

    Examples
    --------
    >>> import nestedcages_core as core
    >>> core.check_decimation(core.ArcLength())
    """
    for name, fine in shapes().items():
        sizes = [len(loop) for loop in fine.loops]
        made = 0
        for count in (len(sizes) * 6, len(sizes) * 9, [max(3, size // 2) for size in sizes]):
            made += _is_made(decimation, name, fine, count)
        if made == 0:
            raise _wrong(decimation, f"makes no mesh around {name}")
        try:
            decimation.decimate(fine, 3 * len(sizes) - 1)
        except NestingError:
            pass
        else:
            raise _wrong(decimation, f"makes a mesh of {3 * len(sizes) - 1} vertices around {name}, less than 3 a loop")
    star = shapes()["a star"]
    nested_cages(star, 12, decimation=decimation, fallback=None)  # certifies the cage, or raises


def shapes() -> dict[str, Mesh]:
    """A star, a ring and two parts."""

    def ring(size: int, radius: float, x: float = 0.0, dent: float = 0.0) -> FloatArray:
        angle = 2.0 * np.pi * np.arange(size) / size
        away = radius * (1.0 + dent * np.cos(5.0 * angle + 0.3))
        return np.stack([x + away * np.cos(angle), away * np.sin(angle)], axis=1)

    return {
        "a star": Mesh.from_loops([ring(60, 1.0, dent=0.3)]),
        "a ring": Mesh.from_loops([ring(40, 1.0), ring(30, 0.5, 0.1)]),
        "two parts": Mesh.from_loops([ring(40, 1.0), ring(50, 0.8, 2.5, dent=0.1)]),
    }


def _is_made(decimation: Decimation, name: str, fine: Mesh, count: Count) -> bool:
    """Whether there is a mesh for a number of vertices. Raises NestedCagesError where it is not as it must be."""
    before = fine.vertices.copy()
    try:
        meshes = list(_meshes(decimation, fine, count))
        again = decimation.decimate(fine, count)
    except NestingError:
        return False
    where = f"around {name}, for {count} vertices,"
    if not np.array_equal(fine.vertices, before):
        raise _wrong(decimation, f"{where} changes the shape")
    for mesh in meshes:
        if not isinstance(mesh, Mesh):
            raise _wrong(decimation, f"{where} makes {mesh!r} instead of a Mesh")
        if not np.array_equal(mesh.loop_signs, fine.loop_signs):
            raise _wrong(decimation, f"{where} makes other loops than the shape has, or in another order")
        if len(mesh.vertices) > int(np.sum(count)):
            raise _wrong(decimation, f"{where} makes {len(mesh.vertices)}")
    if not np.array_equal(meshes[0].vertices, again.vertices):
        raise _wrong(decimation, f"{where} makes another mesh each time")
    return True


def _meshes(decimation: Decimation, fine: Mesh, count: Count) -> Iterator[Mesh]:
    yield decimation.decimate(fine, count, clearance=0.0)
    if isinstance(decimation, Starts):
        for start in decimation.starts(fine, count, clearance=0.0):
            yield start.coarse


def _wrong(decimation: Decimation, what: str) -> NestedCagesError:
    return NestedCagesError(f"{type(decimation).__name__} {what}.", code="method.wrong", name=type(decimation).__name__)
