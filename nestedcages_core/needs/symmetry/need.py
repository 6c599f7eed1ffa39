"""Symmetric cages: choice of the symmetry, possible vertex counts, and symmetric coarse meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from ...decimation.budget import LEAST_PER_LOOP
from ...errors import Fault, InvalidMeshError, NestingError, note
from ...geometry.group import Symmetry
from ...geometry.mesh import Mesh
from ...geometry.precision import NEGLIGIBLE
from ...geometry.predicates import winding_number
from ...geometry.solids import overlay
from ...geometry.symmetry.detection import Found
from ...geometry.symmetry.maps import Mirror
from ...geometry.vectors import rotated_right
from ...level.attempts import contacts_for
from ...level.plan import Need, Numbers, Plan
from ...level.settings import LevelSettings
from ...level.symmetrised_start import orbits_of
from ...level.units import ROUNDING_ULPS
from ...verification.certificate import loops_in_words

Chosen = TypeVar("Chosen", bound=LevelSettings)

SPECK = 1e-3
"""Area, as a fraction of the whole, below which holes between a drawing and its images are filled."""


MOST_OF_ALL_IMAGES = 100_000
"""Vertices of a drawing and its images: more take minutes to overlay."""


@dataclass(frozen=True)
class Symmetric(Need):
    """Cages with a symmetry."""

    group: Symmetry

    def fill(self, plan: Plan) -> Plan:
        """The symmetry, and a symmetric outline."""
        outline, notes = with_images(plan.outline, self.group, plan.side)
        return replace(plan, group=self.group, outline=outline).with_remarks(*notes)

    def count(self, plan: Plan, count: int) -> tuple[int, tuple[Fault, ...]]:
        """See `possible_count`."""
        return possible_count(count, plan.outline, self.group)

    def fault(self, plan: Plan, cage: Mesh) -> Fault | None:
        """Whether all vertices are images of each other: on the numbers of the plan."""
        exact = cage if plan.numbers is None else cage.moved(plan.numbers.exact(cage.vertices))
        orbits = orbits_of(exact, self.group)
        if orbits is not None:
            images, on_axis = orbits.symmetrised(exact.vertices), orbits.on_axis[orbits.orbit]
            away = np.abs((images if plan.numbers is None else plan.numbers.nearest(images)) - cage.vertices)
            if plan.numbers is None and on_axis.any():  # a point on a slanted axis is rounded again
                away[on_axis] -= (
                    ROUNDING_ULPS
                    * np.finfo(float).eps
                    * np.abs([*exact.vertices, getattr(self.group, "point", (0, 0))]).max()
                )
            if not (away > 0.0).any():
                return None
        return Fault(f"The cage does not have {self.group}.", "symmetry.missed")


def on_lattice(symmetry: Symmetry, numbers: Numbers, fine: Mesh) -> tuple[Symmetry, tuple[Fault, ...]]:
    """The symmetry moved to the nearest lines of a grid, and a note. Raises NestingError if no such grid has it."""
    possible = 0.0 in symmetry.direction if isinstance(symmetry, Mirror) else symmetry.order in (2, 4)
    if not possible:
        raise NestingError(
            f"No grid has {symmetry}: only vertical and horizontal mirrors and rotations of order 2 and 4 map it to "
            "itself; leave out the grid or the symmetry.",
            code="symmetry.off_lattice",
        )
    name = "point" if isinstance(symmetry, Mirror) else "centre"
    before = np.array(getattr(symmetry, name))
    after = numbers.exact(before)
    moved: Symmetry = replace(symmetry, **{name: tuple(after.tolist())})  # type: ignore[type-var]
    shift = float(np.abs(after - before).max())
    if shift <= NEGLIGIBLE * fine.diagonal:
        return moved, ()
    return moved, (note("note.symmetry", on="grid", symmetry=str(moved), difference=shift),)


def found_for(symmetry: Symmetry | Found, fine: Mesh) -> tuple[Symmetry | None, tuple[Fault, ...]]:
    """The symmetry with its place, that of a drawing if it is to be found, and a note about that."""
    notes: tuple[Fault, ...] = ()
    if isinstance(symmetry, Found):
        found, difference = symmetry.of(fine)
        if found is None:
            return None, (note("note.symmetry", on="none", tolerance=float(symmetry.tolerance)),)
        symmetry = found
        notes = (note("note.symmetry", on="found", symmetry=str(found), difference=float(difference)),)
    return symmetry.placed(fine), notes


def keeping(choices: Chosen, symmetry: Symmetry) -> Chosen:
    """The methods, told to keep a symmetry. Raises NestingError for methods that cannot."""
    contacts, decimation = contacts_for(choices), choices.decimation
    if not all(getattr(each, "keeps_ties", False) for each in contacts):
        raise NestingError(
            f"Symmetric cages need contact=SequentialQP(), not {choices.contact!r}; leave it out.",
            code="setting.conflict",
        )
    if not hasattr(decimation, "keeping"):
        raise NestingError(
            f"Symmetric cages need decimation=LineCycles(), not {decimation!r}.", code="setting.conflict"
        )
    kept = decimation.keeping(symmetry)
    return replace(
        choices,
        contact=contacts,
        decimation=kept,
        fallback=None if choices.fallback is None else kept.outside,
    )


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
            raise InvalidMeshError(f"Together they leave {loops_in_words(together)}.", code="symmetry.not_found")
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
    holes = np.flatnonzero(union.loop_signs < 0)
    kept = [k for k in holes.tolist() if abs(union.loop_areas[k]) >= SPECK * union.area]
    longest = [union.loops[k][np.argmax(union.edge_lengths[union.loops[k]])] for k in kept]
    start, end = union.vertices[longest], union.edge_ends[longest]
    points = 0.5 * (start + end) + NEGLIGIBLE * rotated_right(end - start)
    for image in images:
        around = [image.loops[k] for k in np.flatnonzero(image.loop_signs > 0)]
        covered = np.zeros(len(points), bool)
        for loop in around:
            covered |= winding_number(points, image.vertices[loop], image.edge_ends[loop]) > 0
        kept = [k for k, inside in zip(kept, covered, strict=True) if inside]
        points = points[covered]
    left = [loop for k, loop in enumerate(union.loops) if union.loop_signs[k] > 0 or k in kept]
    return union if len(left) == len(union.loops) else Mesh.from_loops([union.vertices[loop] for loop in left])


def possible_count(count: int, fine: Mesh, symmetry: Symmetry) -> tuple[int, tuple[Fault, ...]]:
    """The number of vertices closest to `count`, less if possible, that a cage around a symmetric mesh can have.

    And a note if it differs. With a mirror, loops across it can have any number, and pairs of loops even ones; with
    rotations every number is a multiple of their order.
    """
    orbits = orbits_of(fine, symmetry)
    if orbits is None:
        return count, ()
    image = fine.loop_of_vertex[orbits.partner[[loop[0] for loop in fine.loops]]]
    own = image == np.arange(len(image))
    step = 1 if symmetry.reverses and own.any() else symmetry.order
    own_least = LEAST_PER_LOOP if symmetry.reverses else -(-LEAST_PER_LOOP // symmetry.order) * symmetry.order
    least = int(own.sum()) * own_least + int((~own).sum()) * LEAST_PER_LOOP
    possible = max(count // step * step, least)
    if possible == count:
        return count, ()
    return possible, (note("note.count", on="symmetry", asked=count, given=possible, symmetry=str(symmetry)),)
