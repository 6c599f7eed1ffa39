"""Errors and notes: a sentence for people (what is wrong, where, what to change), and a code with data for programs."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

CODES: Mapping[str, tuple[str, ...]] = {
    # a shape, and the points that belong to it
    "mesh.empty": (),
    "mesh.unreadable": (),
    "mesh.not_finite": ("vertex", "step"),
    "mesh.out_of_range": ("vertex", "place"),
    "mesh.edge_index": ("edges",),
    "mesh.open": ("vertices",),
    "mesh.repeated_vertex": ("loops", "vertices", "place"),
    "mesh.spike": ("loops", "vertices", "place"),
    "mesh.crossing": ("loops", "vertices", "place"),
    "mesh.nesting": ("loops", "place"),
    "coordinates.outside": ("vertex", "place"),
    "overlay.empty": (),
    # what is asked for
    "setting.invalid": ("name", "value"),
    "setting.conflict": ("names",),
    "level.invalid": (),
    "count.too_small": ("total", "least"),
    "count.per_loop": (),
    "clearance.too_large": ("wanted", "largest"),
    "clearance.no_room": ("wanted", "largest", "loops", "place"),
    "priorities.mismatch": ("given", "available"),
    "poses.invalid": ("pose",),
    "coarse.not_nested": (),
    # what cannot be made
    "flow.loops_differ": ("loops", "place"),
    "flow.stuck": ("place",),
    "reinflation.blocked": ("vertices", "place"),
    "certificate.failed": ("problems", "pose"),
    "motion.collides": ("step", "pose"),
    "motion.blocked": ("pose",),
    "time.over": ("seconds", "level", "stage"),
    "work.over": ("steps", "level", "stage"),
    "symmetry.not_found": (),
    "symmetry.off_lattice": (),
    "symmetry.missed": (),
    "convex.overlapping": ("loops",),
    "convex.impossible": (),
    "convex.missed": (),
    "numbers.no_room": ("spacing", "finer", "count", "clearance"),
    "numbers.missed": (),
    "box.left": ("place", "distance"),
    "edges.not_aligned": ("place",),
    "obstacle.met": ("clearance", "wanted", "place"),
    "edge.short": ("wanted", "given", "place"),
    "angle.sharp": ("wanted", "given", "place"),
    "constraint.missed": (),
    "constraint.failed": ("name", "method"),
    "numbers.unresolved": ("spacing", "vertex", "place"),
    "tolerance.unreachable": ("limit", "taken"),
    "solver.not_finite": (),
    "method.wrong": ("name",),
    # files, batches and what is around them
    "file.invalid": (),
    "limit.exceeded": ("what",),
    "dependency.missing": ("library",),
    "batch.invalid": (),
    # problems of a certificate
    "cage.invalid": ("loops", "vertices", "place"),
    "fine.invalid": ("loops", "vertices", "place"),
    "cage.turned": ("loops", "place"),
    "cage.meets": ("vertices", "place"),
    "cage.leaves_out": ("loops", "place"),
    "cage.loops_differ": ("loops", "place"),
    "cage.too_close": ("clearance", "wanted"),
    # notes of a report
    "note.count": ("asked", "given", "on", "symmetry"),
    "note.start": ("source", "on", "first", "text"),
    "note.clearance": ("wanted", "given", "on"),
    "note.loops": ("wanted", "given", "filled", "joined", "lost"),
    "note.energy": ("energy",),
    "note.untightened": (),
    "note.symmetry": ("symmetry", "difference", "on", "tolerance"),
    "note.outline": ("change", "area", "on"),
    "note.pin": ("place", "distance", "count", "pins"),
    "note.edge": ("wanted", "given"),
    "note.angle": ("wanted", "given"),
    "note.tolerance": ("limit", "taken", "count", "fewest", "on"),
    "note.time": ("seconds", "level", "stage"),
    "note.work": ("steps", "level", "stage"),
    "note.library": ("library",),
    "note.text": ("text",),
}
"""All codes, each with the names of the data that it may carry. Places are (x, y) in the input's units; loops and
vertices are lists of indices; lengths are in the input's units."""

UNKNOWN = "unknown"
"""Code of errors that name none, such as those of a user's own methods."""


class Fault(str):
    """A sentence with a code and data.

    Parameters
    ----------
    sentence : str
        What is wrong, where, and what to change.
    code : str
        One of `CODES`.
    **data
        What the sentence refers to; see `CODES`.
    """

    __slots__ = ("code", "data")
    code: str
    data: Mapping[str, Any]

    def __new__(cls, sentence: str, code: str = UNKNOWN, /, **data: Any) -> Fault:
        made = super().__new__(cls, sentence)
        made.code = code
        made.data = {name: _plain(value) for name, value in data.items()}
        return made

    def __getnewargs_ex__(self) -> tuple[tuple[str, str], dict[str, Any]]:
        """What a copy is made of."""
        return (str(self), self.code), dict(self.data)

    def said(self, sentence: str) -> Fault:
        """The same fault in another sentence."""
        return Fault(sentence, self.code, **self.data)


def note(code: str, **data: Any) -> Fault:
    """A note with the sentence of its code."""
    from .notes import sentence  # most runs have none

    return Fault(sentence(code, data), code, **data)


def _plain(value: Any) -> Any:
    """Arrays and lists as tuples, numbers of numpy as plain ones."""
    value = value.tolist() if hasattr(value, "tolist") else value
    return tuple(map(_plain, value)) if isinstance(value, list | tuple) else value


class NestedCagesError(Exception):
    """Base class of all errors of this package.

    Parameters
    ----------
    message : str
        A sentence for people, or a `Fault`.
    partial : Any, optional
        What was finished before the error, such as the levels of a `Hierarchy`.
    code, **data
        For programs; see `CODES`.
    """

    fault: Fault
    """The message, with its code and data."""
    partial: Any

    def __init__(self, message: str, *, partial: Any = None, code: str = UNKNOWN, **data: Any) -> None:
        super().__init__(message)
        self.fault = message if isinstance(message, Fault) and code == UNKNOWN else Fault(message, code, **data)
        self.partial = partial

    @property
    def code(self) -> str:
        """One of `CODES`."""
        return self.fault.code

    @property
    def data(self) -> Mapping[str, Any]:
        """What the message refers to; see `CODES`."""
        return self.fault.data

    def __reduce__(self) -> tuple[Any, ...]:
        """Keep code, data and `partial` when the error is pickled."""
        return functools.partial(type(self), partial=self.partial), (self.fault,)


class InvalidMeshError(NestedCagesError):
    """The input is not the boundary of a planar solid; the message names the vertex or loop and its place."""


class FlowError(NestedCagesError):
    """The fine mesh could not be brought strictly inside the coarse one; the message names the loop and the cause."""


class ReinflationError(NestedCagesError):
    """The fine mesh could not return to its place without contact; the message names the place."""


class NestingError(NestedCagesError):
    """The wanted levels cannot be built or certified; the message says which level and what to change."""


class NestedCagesWarning(UserWarning):
    """Something was repaired or left out; the message says what and where."""


invalid_setting = functools.partial(NestedCagesError, code="setting.invalid")
unreadable = functools.partial(InvalidMeshError, code="mesh.unreadable")
invalid_file = functools.partial(NestedCagesError, code="file.invalid")
no_outline = functools.partial(InvalidMeshError, code="file.invalid")
"""The errors, with a sentence, for a parameter that no method has, for what is no shape, for what is not as a reader or
a writer needs it, and for a file without a valid outline."""
