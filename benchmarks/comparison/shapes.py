"""The shapes: random ones, glyphs, held-out families, the paper's discs and our drawings of its figures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import count as numbers
from typing import NamedTuple

from comparison.drawings import caught_hole, drawings
from comparison.held_out import held_out
from comparison.measure import Started
from data import COARSE_RING_VERTICES, annulus
from data.drawn import glyph
from nestedcages_core import Mesh, NestedCagesError, OnCurve, TwoSidedFlow
from nestedcages_core.level.units import SolverUnits
from nestedcages_core.tasks import drain
from random_shapes import random_shape

RANDOM, GLYPHS, HELD_OUT, FIGURES, DISCS = "random", "glyphs", "held out", "figures", "discs"

MOST_VERTICES = 400  # of a fine mesh: all pairs, a hundred times a step, are slow
VERTICES_PER_COARSE = 6  # fine vertices for each coarse one
LEAST_PER_LOOP = 5  # coarse vertices
FONTS = ("DejaVu Sans", "DejaVu Serif", "STIXGeneral")
CHARACTERS = "agQ&8$BeR@36CDGJOPSUbcdfhjmnopqrstu059?%§ßæøåçñäöüéâîûŒÆØÅΩθφψαβγδεζηλμξπρσω"
PER_CURVE = 6  # vertices of a glyph's curve
LEAST_GLYPH_VERTICES = 20


@dataclass(frozen=True)
class Sizes:
    """How many shapes of each family: for contacts alone, and for whole methods."""

    contacts: tuple[tuple[str, int], ...] = ((RANDOM, 60), (GLYPHS, 36), (HELD_OUT, 36))
    methods: tuple[tuple[str, int], ...] = ((RANDOM, 20), (GLYPHS, 12), (HELD_OUT, 18))
    flows: tuple[tuple[str, int], ...] = ((RANDOM, 20), (GLYPHS, 8), (HELD_OUT, 12))

    def smaller(self, part: int) -> Sizes:
        """A part of the shapes, to try it out."""
        return replace(self, **{name: tuple((family, max(2, count // part)) for family, count in getattr(self, name))
                                for name in ("contacts", "methods", "flows")})  # fmt: skip


class Case(NamedTuple):
    """A fine mesh with its coarse mesh."""

    family: str
    number: int
    shape: str
    fine: Mesh
    coarse: Mesh


def case(family: str, number: int) -> Case | None:
    """The case of a number in a family; None if it gives none of the right size."""
    drawn = _drawn(family, number)
    if drawn is None or len(drawn[1].vertices) > MOST_VERTICES:
        return None
    name, fine = drawn
    count = max(LEAST_PER_LOOP * len(fine.loops), len(fine.vertices) // VERTICES_PER_COARSE)
    if count >= len(fine.vertices):
        return None
    try:
        return Case(family, number, f"{name} {number}", fine, OnCurve().decimate(fine, count))
    except NestedCagesError:  # no simple loops with so few vertices on the curve
        return None


def _drawn(family: str, number: int) -> tuple[str, Mesh] | None:
    if family == RANDOM:
        return random_shape(number)
    if family == HELD_OUT:
        return held_out(number)
    if number >= len(CHARACTERS) * len(FONTS):
        return None
    character, font = CHARACTERS[number // len(FONTS)], FONTS[number % len(FONTS)]
    try:
        fine = glyph(character, per_curve=PER_CURVE, family=font)
    except NestedCagesError:  # overlapping strokes
        return None
    return (f"{font} {character}", fine) if len(fine.vertices) >= LEAST_GLYPH_VERTICES else None


def cases(sizes: tuple[tuple[str, int], ...]) -> Iterator[Case]:
    """So many cases of each family; numbers that give none are passed over."""
    for family, wanted in sizes:
        found = 0
        for number in numbers():
            made = case(family, number)
            if made is not None:
                yield made
                found += 1
            if found == wanted:
                break


def start(made: Case) -> Started | None:
    """The coarse mesh and the steps of the two-sided flow; None where it fails or the fine mesh is inside already."""
    units = SolverUnits.of(made.fine)
    try:
        steps = drain(TwoSidedFlow().run(units.from_input(made.fine), units.from_input(made.coarse))).steps
    except NestedCagesError:
        return None
    return Started(made.coarse, steps) if len(steps) > 1 else None


def figures() -> list[Case]:
    """Our drawings of the paper's figures; the last is a very coarse mesh."""
    drawn = drawings() | {"disc with a hole in a very coarse mesh": caught_hole()}
    return [Case(FIGURES, number, name, *pair) for number, (name, pair) in enumerate(drawn.items())]


def disc(ring_vertices: int) -> Case:
    """A row of Table 1: annuli."""
    fine = annulus(ring_vertices)
    return Case(DISCS, ring_vertices, str(len(fine.vertices)), fine, annulus(COARSE_RING_VERTICES))
