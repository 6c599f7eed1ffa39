"""The certificate of a cage by exact predicates: simple, same loops, strictly around the solid of the fine mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..errors import Fault, InvalidMeshError
from ..geometry.arrays import IntArray
from ..geometry.mesh import MESH_LIKE, Mesh, MeshLike, Nesting, is_mesh_like
from ..geometry.precision import ROUND_OFF
from ..geometry.smallest_gap import smallest_gap
from ..geometry.vectors import crossing_point, format_point
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

    Parameters
    ----------
    cage, fine : MeshLike
        What `Mesh.of` reads: meshes, objects with `__geo_interface__`, lists of loops (k, 2).
    clearance : float, optional
        Smallest distance between the two boundaries that is required, in input units. Default: they must not meet.
    same_loops : bool, optional
        Whether the cage must keep the loops of the fine mesh; without it, a cage may cover holes, and one loop may
        wrap several components.

    Returns
    -------
    Certificate
        True if all requirements are met; ``problems`` has the others, also for an invalid shape.

    Raises
    ------
    InvalidMeshError
        For input that is no shape.

    Examples
    --------
    >>> from nestedcages_core import verify
    >>> bool(verify([(-1, -1), (9, -1), (4, 9)], [(2, 1), (6, 1), (4, 5)], clearance=0.5))
    True
    """
    problems: list[Fault] = []
    outer, inner = (_read(shape, name, problems) for shape, name in ((cage, "cage"), (fine, "fine mesh")))
    if outer is None or inner is None:
        return Certificate(outer is not None, False, False, float("nan"), float("nan"), tuple(problems))
    nesting = Nesting(outer, inner)
    turned = _turned_loops(cage, outer) if isinstance(cage, Mesh) else np.zeros(0, np.int64)
    problems += [
        _on_loop(f"Loop {k} of the cage near {{}} is turned inside out.", "cage.turned", outer, k) for k in turned
    ]
    strict, loops_kept, lost, measured = False, False, NONE_LOST, 0.0
    if nesting.contact is not None:
        problems.append(_contact(nesting, *nesting.contact))
    else:
        outside, misplaced = list(_outside(nesting)), list(_misplaced_loops(nesting))
        problems += outside
        strict, loops_kept = not outside, not misplaced and len(turned) == 0
        if same_loops and strict:
            problems += misplaced
        elif strict and misplaced:
            lost = LostLoops.of(outer, inner, nesting)
        measured = smallest_gap(outer.edge_tree, inner.edge_tree)
        if not measured >= clearance * (1.0 - ROUND_OFF):  # nor is a clearance of nan kept
            said = f"The cage comes as near as {measured:.6g} to the fine mesh; {clearance:.6g} is required."
            problems.append(Fault(said, "cage.too_close", clearance=measured, wanted=clearance))
    return Certificate(True, loops_kept, strict, measured, outer.area / inner.area - 1.0, tuple(problems), lost)


def _read(shape: MeshLike, name: str, problems: list[Fault]) -> Mesh | None:
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


def _turned_loops(cage: Mesh, validated: Mesh) -> IntArray:
    """Loops whose direction or role has changed since the cage's edges were oriented."""
    opposed = cage.loop_of_vertex[cage.edges[cage.edges[:, 0] != validated.edges[:, 0], 0]]
    return np.union1d(opposed, np.flatnonzero(validated.loop_signs != cage.loop_signs))


def loops_in_words(mesh: Mesh) -> str:
    """The numbers of outer loops and holes, in words."""
    outer = int((mesh.loop_signs > 0).sum())
    holes = len(mesh.loops) - outer
    return f"{outer} outer loop{'s' * (outer != 1)} and {holes or 'no'} hole{'s' * (holes != 1)}"


def _on_loop(sentence: str, code: str, mesh: Mesh, loop: int) -> Fault:
    """A fault of a loop; {} in the sentence is its place."""
    at = mesh.vertices[mesh.loops[loop][0]]
    return Fault(sentence.format(format_point(at)), code, loops=[loop], place=at)


def _contact(nesting: Nesting, u: int, v: int) -> Fault:
    """Where the edges that start at vertex u of the cage and v of the fine mesh meet."""
    cage, fine = nesting.outer, nesting.inner
    corners = [u, int(cage.successor[u]), v, int(fine.successor[v])]
    point = crossing_point(*cage.vertices[corners[:2]], *fine.vertices[corners[2:]])
    said = (
        f"The cage meets the fine mesh near {format_point(point)}: edge {corners[0]}-{corners[1]} of the cage touches "
        f"edge {corners[2]}-{corners[3]} of the fine mesh."
    )
    return Fault(said, "cage.meets", vertices=corners, place=point)


def _outside(nesting: Nesting) -> Iterator[Fault]:
    """A sentence for each part of the fine solid that the cage's solid does not cover."""
    outside, inside = nesting.uncovered
    for k in outside.tolist():
        said = f"Loop {k} of the fine mesh near {{}} lies outside the cage."
        yield _on_loop(said, "cage.leaves_out", nesting.inner, k)
    for k in inside.tolist():
        said = f"Loop {k} of the cage near {{}} lies inside the fine mesh and leaves a part of it uncovered."
        yield _on_loop(said, "cage.leaves_out", nesting.outer, k)


def _misplaced_loops(nesting: Nesting) -> Iterator[Fault]:
    """A sentence if the loops of the two meshes do not correspond one to one.

    In the forest of all loops, an outer fine loop must be the only child of an outer cage loop, and a hole of the cage
    the only child of a hole of the fine mesh.
    """
    meshes = nesting.outer, nesting.inner
    ours, theirs = map(loops_in_words, meshes)
    if ours != theirs:
        yield Fault(f"The cage has {ours}, but the fine mesh has {theirs}.", "cage.loops_differ")
        return
    kept = len(nesting.outer.loops)
    signs = np.concatenate([mesh.loop_signs for mesh in meshes])
    is_cage = np.arange(2 * kept) < kept
    parent = nesting.parents
    children = np.bincount(parent[parent >= 0], minlength=2 * kept)
    lower = np.flatnonzero(is_cage != (signs > 0))
    partner = parent[lower]
    alone = (partner >= 0) & (children[partner] == 1)
    alone &= (signs[partner] == signs[lower]) & (is_cage[partner] != is_cage[lower])
    if not alone.all():
        names = ("cage", "fine mesh")
        which, k = divmod(int(lower[~alone][0]), kept)
        said = f"Loop {k} of the {names[which]} near {{}} matches no loop of the {names[1 - which]}."
        yield _on_loop(said, "cage.loops_differ", meshes[which], k)
