"""The certificate of a cage by exact predicates: simple, same loops, strictly around the solid of the fine mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import Fault, InvalidMeshError
from ..geometry.arrays import IntArray
from ..geometry.mesh import MESH_LIKE, Mesh, MeshLike, Nesting, is_mesh_like
from ..geometry.precision import ROUND_OFF
from ..geometry.smallest_gap import smallest_gap
from ..geometry.vectors import crossing_point, place
from .lost_loops import NONE_LOST, LostLoops


@dataclass(frozen=True)
class Certificate:
    """Verdicts on a cage and the fine mesh in it; true if all requirements are met."""

    simple: bool
    """The cage is valid: finite, closed loops that neither cross nor touch."""
    loops_kept: bool
    """The cage has as many loops as the fine mesh, each with its own sense, and each next to one of its own kind."""
    strict: bool
    """The solid of the fine mesh lies in the interior of the cage's solid: every component, and all of it."""
    clearance: float
    """Measured smallest distance between the two boundaries; 0 where they meet, nan where it cannot be measured."""
    excess: float
    """area(cage) / area(fine) - 1; nan if one of them is not valid."""
    problems: tuple[Fault, ...]
    """A sentence, with a code and data, for each requirement that is not met."""
    lost: LostLoops = NONE_LOST
    """Holes of the fine mesh that the cage fills, and loops that share one of the cage."""

    @property
    def holds(self) -> bool:
        """Whether every requirement is met."""
        return not self.problems

    def __bool__(self) -> bool:
        return self.holds


def verify(cage: MeshLike, fine: MeshLike, clearance: float = 0.0, *, same_loops: bool = True) -> Certificate:
    """The certificate of a cage around a fine mesh, for any pair; every verdict but the distance is exact.

    cage, fine: meshes, or anything that `Mesh.of` reads: objects with `__geo_interface__`, lists of loops (k, 2).
    clearance: the distance between the two boundaries to ask for, in input units.
    same_loops: whether the cage must keep the loops of the fine mesh; without it, a cage may cover holes, and one loop
    may wrap several components.

    Raises InvalidMeshError for input that is not a shape; for an invalid shape, the certificate says so.
    """
    problems: list[Fault] = []
    judged, judged_fine = (_at_the_door(mesh, name, problems) for mesh, name in ((cage, "cage"), (fine, "fine mesh")))
    if judged is None or judged_fine is None:
        return Certificate(judged is not None, False, False, float("nan"), float("nan"), tuple(problems))
    pair = _Pair(judged, judged_fine)
    turned = _turned_loops(cage, judged) if isinstance(cage, Mesh) else np.zeros(0, np.int64)
    problems += [
        pair.fault(f"Loop {k} of the cage near {{}} is turned inside out.", "cage.turned", judged, int(k))
        for k in turned
    ]
    contact = pair.contact()
    problems += contact
    strict, loops_kept, lost = False, False, NONE_LOST
    if not contact:
        outside = pair.outside()
        problems += outside
        strict = not outside
        misplaced = pair.misplaced_loops()
        loops_kept = not misplaced and len(turned) == 0
        if same_loops and strict:
            problems += misplaced
        elif strict and misplaced:
            lost = LostLoops.of(judged, judged_fine, pair.nesting)
    measured = 0.0 if contact else pair.gap()
    if not contact and not measured >= clearance * (1.0 - ROUND_OFF):  # nor is a clearance of nan kept
        said = f"The cage comes as near as {measured:.6g} to the fine mesh; {clearance:.6g} is asked for."
        problems.append(Fault(said, "cage.too_close", clearance=measured, wanted=clearance))
    excess = judged.area / judged_fine.area - 1.0
    return Certificate(True, loops_kept, strict, measured, excess, tuple(problems), lost)


def _at_the_door(shape: MeshLike, name: str, problems: list[Fault]) -> Mesh | None:
    """The validated mesh, or None and a sentence."""
    if not is_mesh_like(shape):
        raise InvalidMeshError(f"The {name} must be {MESH_LIKE}, not {type(shape).__name__}.", code="mesh.unreadable")
    try:
        return Mesh.of(shape, strict=name == "cage").validated()
    except InvalidMeshError as error:
        where = {key: error.data[key] for key in ("loops", "vertices", "place") if key in error.data}
        code = "cage.invalid" if name == "cage" else "fine.invalid"
        problems.append(Fault(f"The {name} is not a valid mesh: {error}", code, **where))
        return None


def _turned_loops(cage: Mesh, judged: Mesh) -> IntArray:
    """Loops whose direction or role has changed since the cage's edges were oriented."""
    opposed = cage.loop_of_vertex[cage.edges[cage.edges[:, 0] != judged.edges[:, 0], 0]]
    return np.union1d(opposed, np.flatnonzero(judged.loop_signs != cage.loop_signs))


def loops_in_words(mesh: Mesh) -> str:
    """The numbers of outer loops and holes, in words."""
    outer = int((mesh.loop_signs > 0).sum())
    holes = len(mesh.loops) - outer
    return f"{outer} outer loop{'s' * (outer != 1)} and {holes or 'no'} hole{'s' * (holes != 1)}"


class _Pair:
    """A valid cage and a valid fine mesh, and the sentences about them."""

    def __init__(self, cage: Mesh, fine: Mesh) -> None:
        self.cage, self.fine = cage, fine
        self.nesting = Nesting(cage, fine)

    def fault(self, sentence: str, code: str, mesh: Mesh, loop: int) -> Fault:
        """A fault of a loop; {} in the sentence is its place."""
        at = mesh.vertices[mesh.loops[loop][0]]
        return Fault(sentence.format(place(at)), code, loops=[loop], place=at)

    def contact(self) -> list[Fault]:
        """A sentence if the boundaries touch or cross."""
        if self.nesting.contact is None:
            return []
        u, v = self.nesting.contact
        ends = self.cage.successor[u], self.fine.successor[v]
        corners = self.cage.vertices[[u, ends[0]]], self.fine.vertices[[v, ends[1]]]
        point = crossing_point(*corners[0], *corners[1])
        said = (
            f"The cage meets the fine mesh near {place(point)}: edge {u}-{ends[0]} of the cage touches edge "
            f"{v}-{ends[1]} of the fine mesh."
        )
        return [Fault(said, "cage.meets", vertices=[u, ends[0], v, ends[1]], place=point)]

    def outside(self) -> list[Fault]:
        """A sentence for each part of the fine solid that the cage's solid does not cover."""
        outside, inside = self.nesting.uncovered
        code, uncovered = "cage.leaves_out", "lies inside the fine mesh and leaves a part of it uncovered."
        leaks = [
            self.fault(f"Loop {k} of the fine mesh near {{}} lies outside the cage.", code, self.fine, int(k))
            for k in outside
        ]
        gaps = [self.fault(f"Loop {k} of the cage near {{}} {uncovered}", code, self.cage, int(k)) for k in inside]
        return leaks + gaps

    def misplaced_loops(self) -> list[Fault]:
        """A sentence if the loops of the two meshes do not correspond one to one.

        In the forest of all loops, an outer fine loop must be the only child of an outer cage loop, and a hole of the
        cage the only child of a hole of the fine mesh.
        """
        kept = len(self.cage.loops)
        ours, theirs = loops_in_words(self.cage), loops_in_words(self.fine)
        if ours != theirs:
            return [Fault(f"The cage has {ours}, but the fine mesh has {theirs}.", "cage.loops_differ")]
        signs = np.concatenate((self.cage.loop_signs, self.fine.loop_signs))
        is_cage = np.arange(2 * kept) < kept
        parent = self.nesting.parents
        children = np.bincount(parent[parent >= 0], minlength=2 * kept)
        lower = np.flatnonzero(is_cage != (signs > 0))
        partner = parent[lower]
        alone = (partner >= 0) & (children[partner] == 1)
        alone &= (signs[partner] == signs[lower]) & (is_cage[partner] != is_cage[lower])
        if alone.all():
            return []
        k = int(lower[~alone][0])
        if k >= kept:
            k -= kept
            said = f"Loop {k} of the fine mesh near {{}} matches no loop of the cage."
            return [self.fault(said, "cage.loops_differ", self.fine, k)]
        said = f"Loop {k} of the cage near {{}} matches no loop of the fine mesh."
        return [self.fault(said, "cage.loops_differ", self.cage, k)]

    def gap(self) -> float:
        """Smallest distance between the two boundaries."""
        return smallest_gap(self.cage.edge_tree, self.fine.edge_tree)
