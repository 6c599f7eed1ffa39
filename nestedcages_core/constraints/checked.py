"""Constraints written elsewhere: what they answer is tried out before a run begins; `check_constraint` does more."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from ..decimation.base import MIN_PER_LOOP
from ..decimation.outline import Lines
from ..decimation.sampling import NormalFrame
from ..energies import CageEnergy
from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .base import Bound, Constraint, Terms, Units, are_finite

Answer = TypeVar("Answer")

CORNERS = 8
"""Vertices of the regular polygon that stands for a cage."""


def checked(constraint: Constraint, about: Mesh, side: int, units: Units) -> Constraint:
    """The constraint about a drawing. Raises NestedCagesError where a hook of one written elsewhere answers wrongly.

    units: those of the solvers for the drawing.
    """
    if type(constraint).__module__.startswith(__package__):
        return constraint.of(about, side)

    def answer(hook: str, ask: Callable[[], Answer], valid: Callable[[Answer], bool], rule: str) -> Answer:
        try:
            if valid(found := ask()):
                return found
        except NestedCagesError:
            raise
        except Exception as error:
            raise wrong(constraint, hook, f"failed with {type(error).__name__}: {error}") from error
        raise wrong(constraint, hook, f"must answer with {rule}")

    angle = 2.0 * np.pi * np.arange(CORNERS) / CORNERS
    polygon = about.vertices.mean(axis=0) + about.diagonal * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    cage = Mesh.from_loops([polygon])
    unit, fine = (mesh.moved(units.points(mesh.vertices)) for mesh in (cage, about))
    frame = NormalFrame.of(about.loop_order)
    points = frame.into(cage.vertices)
    ahead = frame.into(cage.edge_ends) - points
    lines = Lines.of(points, np.zeros(CORNERS), ahead / np.hypot(*ahead.T)[:, None])
    fewest, most, loops = MIN_PER_LOOP * len(about.loops), len(about.vertices), len(about.loops)

    new = answer("of", lambda: constraint.of(about, side), lambda x: isinstance(x, Constraint), "a Constraint")
    answer("turn_limits", lambda: new.turn_limits, lambda x: _are_lengths(x, 2), "a length and an angle of at least 0")
    whole = f"a whole number from {fewest} to {most}"
    answer("count", lambda: new.count(about, most), lambda x: x in range(fewest, most + 1), whole)
    lengths = "a finite length of at least 0 for each loop, or None"
    answer("distances", lambda: new.distances(about), lambda x: x is None or _are_lengths(x, loops), lengths)
    numbers = "numbers of the shape (2, K), none of them NaN"
    answer("free", lambda: new.free(lines, frame), lambda x: x.shape == (2, CORNERS) and not np.isnan(x).any(), numbers)
    bound = answer("bound", lambda: new.bound(unit, fine, units), lambda x: isinstance(x, Bound), "a Bound")
    terms = "Terms(Rows(vertex, weight, direction), room), each about different vertices, in finite numbers"
    answer("rows", lambda: bound.rows(unit.vertices, 0.1), lambda x: all(map(_is_sound, x)), terms)
    lengths = "a finite length of at least 0 for each vertex"
    answer("short", lambda: bound.short(unit.vertices), lambda x: _are_lengths(x, CORNERS), lengths)
    energy = "an energy of cages, or None"
    answer("term", lambda: new.term(unit, units), lambda x: isinstance(x, CageEnergy | None), energy)
    answer("fault", lambda: new.fault(cage, about), lambda x: isinstance(x, str | None), "a Fault, or None")
    return new


def wrong(constraint: object, hook: str, problem: str) -> NestedCagesError:
    """The error for what a hook of a constraint, or of its bound, does."""
    name = type(constraint).__name__
    return NestedCagesError(f"{name}.{hook} {problem}.", code="constraint.failed", name=name, method=hook)


def _is_sound(terms: Terms) -> bool:
    """Whether rows are about different vertices of the polygon, in arrays that fit and finite numbers."""
    rows, room = Terms(*terms)
    vertex, shapes = np.sort(rows.vertex, axis=0), ((2, len(room)), (len(rows.vertex), 2, len(room)))
    fits = rows.weight.shape == vertex.shape and room.shape == vertex.shape[1:] and rows.direction.shape in shapes
    whole = vertex.dtype.kind in "iu" and bool(((vertex >= 0) & (vertex < CORNERS)).all())
    return fits and whole and are_finite(terms) and not (vertex[1:] == vertex[:-1]).any()


def _are_lengths(found: FloatArray | tuple[float, float], count: int) -> bool:
    """Whether so many finite numbers of at least 0 were found."""
    lengths = np.asarray(found, np.float64)
    return lengths.shape == (count,) and bool(((lengths >= 0.0) & (lengths < np.inf)).all())
