"""The shapes: random ones, glyphs, held-out families, the paper's discs and our drawings of its figures."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from itertools import count as numbers
from typing import NamedTuple

from comparison.drawings import drawings
from comparison.held_out import held_out
from comparison.measure import Started
from comparison.methods import STARTS
from data import COARSE_RING_VERTICES, annulus
from data.drawn import glyph
from nestedcages_core import Mesh, NestedCagesError, TwoSidedFlow
from nestedcages_core.level.units import SolverUnits
from nestedcages_core.tasks import drain
from random_shapes import random_shape

RANDOM, GLYPHS, HELD_OUT, FIGURES, DISCS = "random", "glyphs", "held out", "figures", "discs"

MOST_VERTICES = 150  # of a fine mesh: all pairs, a hundred times a step, are slow
VERTICES_PER_COARSE = 6  # fine vertices for each coarse one
LEAST_PER_LOOP = 5  # coarse vertices
FONTS = ("DejaVu Sans", "DejaVu Serif", "STIXGeneral")
CHARACTERS = "agQ&8$BeR@36CDGJOPSUbcdfhjmnopqrstu059?%§ßæøåçñäöüéâîûŒÆØÅΩθφψαβγδεζηλμξπρσω"
PER_CURVE = 6  # vertices of a glyph's curve
LEAST_GLYPH_VERTICES = 20


@dataclass(frozen=True)
class Sizes:
    """How many shapes of each family: for contacts alone, and for whole methods."""

    contacts: tuple[tuple[str, int], ...] = ((RANDOM, 12), (GLYPHS, 12), (HELD_OUT, 24))
    methods: tuple[tuple[str, int], ...] = ((RANDOM, 10), (GLYPHS, 10), (HELD_OUT, 20))
    flows: tuple[tuple[str, int], ...] = ((RANDOM, 8), (GLYPHS, 4), (HELD_OUT, 8))

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
    start: str = "drawn"
    """What made the coarse mesh: a key of `STARTS`."""


def case(family: str, number: int) -> list[Case] | None:
    """A case of a number in a family from each start; None if it gives none of the right size."""
    drawn = _drawn(family, number)
    if drawn is None or len(drawn[1].vertices) > MOST_VERTICES:
        return None
    name, fine = drawn
    count = max(LEAST_PER_LOOP * len(fine.loops), len(fine.vertices) // VERTICES_PER_COARSE)
    if count >= len(fine.vertices):
        return None
    try:
        return [
            Case(family, number, f"{name} {number}", fine, decimation.decimate(fine, count), start)
            for start, decimation in STARTS.items()
        ]
    except NestedCagesError:  # a start has no simple loops with so few vertices
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


def cases(sizes: tuple[tuple[str, int], ...], starts: Collection[str] = STARTS) -> Iterator[Case]:
    """So many shapes of each family from each start; numbers that give none are passed over."""
    for family, wanted in sizes:
        found = 0
        for number in numbers():
            made = case(family, number)
            if made is not None:
                yield from (one for one in made if one.start in starts)
                found += 1
            if found == wanted or (family == HELD_OUT and held_out(number) is None):
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
    """Our drawings of the paper's figures, and others of the same kind."""
    return [Case(FIGURES, number, name, *pair) for number, (name, pair) in enumerate(drawings().items())]


def disc(ring_vertices: int) -> Case:
    """A row of Table 1: annuli."""
    fine = annulus(ring_vertices)
    return Case(DISCS, ring_vertices, str(len(fine.vertices)), fine, annulus(COARSE_RING_VERTICES))
