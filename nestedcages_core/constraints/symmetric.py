"""Symmetric cages: choice of the symmetry, symmetric outlines, possible vertex counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..decimation.base import MIN_PER_LOOP, LevelTarget
from ..errors import Fault, InvalidMeshError, NestingError, note
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.group import Orbits, Symmetry, orbits_of
from ..geometry.mesh import Mesh
from ..geometry.precision import NEGLIGIBLE, ROUNDING_ULPS
from ..geometry.predicates import winding_number
from ..geometry.solids import overlay
from ..geometry.symmetry import Mirror, Rotation
from ..geometry.symmetry.detection import DetectSymmetry
from ..geometry.vectors import rotated_right
from ..solver.elimination import Elimination
from .base import Bound, Constraint, Rounding, Units
from .numbers import Numbers

SPECK = 1e-3
"""Area, as a fraction of the whole, below which holes between a drawing and its images are filled."""


MOST_OF_ALL_IMAGES = 100_000
"""Vertices of a drawing and its images: more take minutes to overlay."""


@dataclass(frozen=True)
class Symmetric(Constraint):
    """Cages with a symmetry: their vertices are images of each other, bit by bit."""

    on = "symmetry"
    is_rule = False
    group: Symmetry = field()
    numbers: Rounding | None = None
    """The numbers that images are rounded to."""
    keeps: bool = True
    """Whether cages keep all loops."""

    def of(self, about: Mesh, side: int) -> Symmetric:
        """The symmetry with its place."""
        return replace(self, group=self.group.placed(about))

    def rounded(self, numbers: Rounding) -> Symmetric:
        """The symmetry on them."""
        return replace(self, numbers=numbers)

    def outline(self, outline: LevelTarget, side: int) -> LevelTarget:
        """The drawing and its images."""
        mesh, notes = with_images(outline.mesh, self.group, side)
        return outline._replace(mesh=mesh, notes=(*outline.notes, *notes))

    def count(self, outline: Mesh, count: int) -> int:
        """See `possible_count`."""
        return possible_count(count, outline, self.group, keeps=self.keeps)

    def snapped(self, coarse: Mesh, steps: FloatArray, side: int) -> FloatArray:
        """Steps with images exactly where they belong. Raises NestingError where vertices of the mesh have none."""
        orbits = orbits_of(coarse, self.group)
        if orbits is None:
            raise NestingError(
                f"The start does not have {self.group}; use more vertices, or a coarse mesh whose vertices are images "
                "of each other.",
                code="symmetry.not_found",
            )
        return np.stack([orbits.symmetrised(step) for step in steps])

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """Images move together."""
        orbits = orbits_of(coarse.moved(units.to_input(coarse.vertices)), self.group)
        return Bound() if orbits is None else BoundImages(orbits)

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Whether all vertices are images of each other, on the numbers."""
        numbers = self.numbers
        exact = cage if numbers is None else cage.moved(numbers.exact(cage.vertices))
        orbits = orbits_of(exact, self.group)
        if orbits is not None:
            images = orbits.symmetrised(exact.vertices)
            away = np.abs((images if numbers is None else numbers.nearest(images)) - cage.vertices)
            if numbers is None and isinstance(self.group, Mirror):  # a point on a slanted axis is rounded again
                rounding = ROUNDING_ULPS * np.finfo(float).eps * np.abs([*exact.vertices, self.group.point]).max()
                away[orbits.on_axis[orbits.orbit]] -= rounding
            if not (away > 0.0).any():
                return None
        return Fault(f"The cage does not have {self.group}.", "symmetry.missed")


@dataclass(frozen=True, eq=False)
class BoundImages(Bound):
    """The vertices of each orbit move alike, by elimination."""

    orbits: Orbits

    def eliminated(self, images: Elimination | None, successor: IntArray) -> Elimination:
        """The motions of the first vertices."""
        return Elimination.of_images(self.orbits, successor)


def symmetric(
    asked: Symmetry | DetectSymmetry, fine: Mesh, numbers: Numbers | None
) -> tuple[Symmetric | None, tuple[Fault, ...]]:
    """The symmetry with its place, that of a drawing if it is to be found, and notes about that; None if it has none.

    On a grid the place is moved to it. Raises NestingError if no grid has such a symmetry.
    """
    notes: tuple[Fault, ...] = ()
    if isinstance(asked, DetectSymmetry):
        found, difference = asked.of(fine)
        if found is None:
            return None, (note("note.symmetry", on="none", tolerance=float(asked.tolerance)),)
        asked = found
        notes = (note("note.symmetry", on="found", symmetry=str(found), difference=float(difference)),)
    group = asked.placed(fine)
    if numbers is not None and numbers.grid is not None:
        group, moved = _on_grid(group, numbers, fine)
        notes += moved
    return Symmetric(group), notes


def _on_grid(symmetry: Symmetry, numbers: Numbers, fine: Mesh) -> tuple[Symmetry, tuple[Fault, ...]]:
    """The symmetry moved to the nearest lines of a grid, and a note. Raises NestingError if no such grid has it."""
    moved: Symmetry
    if isinstance(symmetry, Mirror) and 0.0 in symmetry.direction:
        before = np.array(symmetry.point)
        after = numbers.exact(before)
        moved = replace(symmetry, point=tuple(after.tolist()))
    elif isinstance(symmetry, Rotation) and symmetry.order in (2, 4):
        before = np.array(symmetry.centre)
        after = numbers.exact(before)
        moved = replace(symmetry, centre=tuple(after.tolist()))
    else:
        raise NestingError(
            f"No grid has {symmetry}: only vertical and horizontal mirrors and rotations of order 2 and 4 map it to "
            "itself; leave out the grid or the symmetry.",
            code="symmetry.off_lattice",
        )
    shift = float(np.abs(after - before).max())
    if shift <= NEGLIGIBLE * fine.diagonal:
        return moved, ()
    return moved, (note("note.symmetry", on="grid", symmetry=str(moved), difference=shift),)


def with_images(fine: Mesh, symmetry: Symmetry, side: int = 1) -> tuple[Mesh, tuple[Fault, ...]]:
    """A symmetric mesh for the decimation: the fine mesh, or the union with its images and a note.

    side: -1 for their intersection, for inner cages. Raises NestingError.
    """
    if orbits_of(fine, symmetry) is not None:
        return fine, ()
    if symmetry.order * len(fine.vertices) > MOST_OF_ALL_IMAGES:
        raise NestingError(
            f"The drawing has {len(fine.vertices)} vertices; with its images under {symmetry} there are "
            f"{symmetry.order * len(fine.vertices)}, and at most {MOST_OF_ALL_IMAGES} can be overlaid; "
            "ask for a lower order, or simplify the drawing.",
            code="limit.exceeded",
            what="images",
        )
    images = [fine.moved(symmetry.image(fine.vertices, k)) for k in range(symmetry.order)]
    try:
        if symmetry.reverses:
            images = [Mesh(image.vertices, image.edges) for image in images]
        together = overlay(images, intersection=side < 0)
        if side > 0:
            together = _without_pockets(together, images)
        elif not together.has_loops_like(fine):
            raise InvalidMeshError(f"Together they leave {len(together.loops)} loops.", code="symmetry.not_found")
        orbits = orbits_of(together, symmetry)
        if orbits is None:
            raise InvalidMeshError("The images of its vertices are not vertices of it.", code="symmetry.not_found")
        together = together.moved(orbits.symmetrised(together.vertices)).validated()
    except InvalidMeshError as error:
        what = "around" if side > 0 else "inside"
        raise NestingError(
            f"No symmetric cage {what} the drawing and its images was found with {symmetry}: {error} Leave out the "
            "symmetry, or draw the shape more symmetric.",
            code="symmetry.not_found",
        ) from error
    area = together.area / fine.area
    if 100.0 * abs(area - 1.0) < NEGLIGIBLE:
        return together, ()
    said = note("note.outline", on="" if side > 0 else "inside", area=float(area), change=float(area - 1.0))
    return together, (said,)


def _without_pockets(union: Mesh, images: Sequence[Mesh]) -> Mesh:
    """The union of some images without holes that are not inside a hole of every image, and without specks."""
    longest = [loop[np.argmax(union.edge_lengths[loop])] for loop in union.loops]
    start, end = union.vertices[longest], union.edge_ends[longest]
    points = 0.5 * (start + end) + NEGLIGIBLE * rotated_right(end - start)
    kept = np.abs(union.loop_areas) >= SPECK * union.area
    for image in images:
        outer = image.loop_signs[image.loop_of_vertex] > 0
        kept &= winding_number(points, image.vertices[outer], image.edge_ends[outer]) > 0
    kept |= union.loop_signs > 0
    return (
        union if kept.all() else Mesh.from_loops([ring for ring, stays in zip(union.rings, kept, strict=True) if stays])
    )


def possible_count(count: int, fine: Mesh, symmetry: Symmetry, *, keeps: bool = True) -> int:
    """The number of vertices closest to `count`, less if possible, that a cage around a symmetric mesh can have.

    With a mirror, loops across it can have any number, and pairs of loops even ones; with
    rotations every number is a multiple of their order. keeps: whether each loop has one of its own; if not, too few
    for all may be enough for one.
    """
    orbits = orbits_of(fine, symmetry)
    if orbits is None:
        return count
    image = fine.loop_of_vertex[orbits.partner[[loop[0] for loop in fine.loops]]]
    own = image == np.arange(len(image))
    step = 1 if symmetry.reverses and own.any() else symmetry.order
    own_least = MIN_PER_LOOP if symmetry.reverses else -(-MIN_PER_LOOP // symmetry.order) * symmetry.order
    least = int(own.sum()) * own_least + int((~own).sum()) * MIN_PER_LOOP
    if count < least and not keeps:
        step, least = 1 if symmetry.reverses else symmetry.order, own_least
    return max(count // step * step, least)
