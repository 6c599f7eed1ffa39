"""What the methods are compared on: the discs of Table 1, the figures, the drawn shapes, and random shapes."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from comparison.drawings import letter_a, letter_a_coarse
from data import COARSE_RING_VERTICES, Table1Row, annulus, read_shape, read_table1, shape, shape_names
from data.drawn import glyph
from nestedcages_core import Mesh, NestedCagesError, OnCurve
from random_shapes import random_shape

COUNT = 32  # vertices of the coarse meshes of the drawn shapes
PAPER_PAIRS = (
    ("A", "A_guy_fine", "A_guy_coarse"),
    ("octagon", "octagon_hole_hand", "square_hole_hand"),
    ("octagon in a full square", "octagon_hole_hand", "square_hand"),
)

MOST_RANDOM_VERTICES = 400  # of a fine mesh: all pairs, a hundred times a step, are slow
VERTICES_PER_COARSE = 6  # fine vertices of a random shape for each coarse one
LEAST_PER_LOOP = 5  # coarse vertices

FONTS = ("DejaVu Sans", "DejaVu Serif", "STIXGeneral")
CHARACTERS = "agQ&8$BeR@36CDGJOPSUbcdfhjmnopqrstu059?%§ßæøåçñäöüéâîûŒÆØÅΩθφψαβγδεζηλμξπρσω"
PER_CURVE = 6  # vertices of a glyph's curve
LEAST_GLYPH_VERTICES = 20

Pair = tuple[Mesh, Mesh]
"""A fine and a coarse mesh."""


@dataclass(frozen=True)
class Sizes:
    """How many shapes, and how large."""

    first_seed: int = 0
    """Random shapes have seeds from this on, until there are so many."""
    random: int = 16
    """Random shapes for whole methods."""
    contact_random: int = 130
    """Random shapes for contacts alone."""
    contact_glyphs: int = 70
    """Glyphs for contacts alone."""
    sweep: int = 10
    """Random shapes, and as many glyphs, for sweeps."""
    scaling: tuple[int, ...] = (500, 1500, 5000, 15000, 50000)
    """Fine vertices."""

    def larger(self, factor: int) -> Sizes:
        """So many times as many shapes."""
        return replace(
            self, random=factor * self.random, contact_random=factor * self.contact_random,
            contact_glyphs=factor * self.contact_glyphs, sweep=factor * self.sweep,
        )  # fmt: skip


@dataclass(frozen=True)
class Inputs:
    """What the comparison runs on."""

    sizes: Sizes
    table1: tuple[Table1Row, ...]
    shapes: dict[str, Mesh]
    paper: dict[str, Pair]
    """The paper's own pairs of meshes, where they are there."""


def read_inputs(folder: Path | None = None, only: Sequence[str] | None = None, sizes: Sizes | None = None) -> Inputs:
    """Table 1, the drawn shapes or those named, and the paper's meshes as far as they are in `folder`."""
    paper = {
        f"the paper's {title}": (read_shape(folder, fine), read_shape(folder, coarse))
        for title, fine, coarse in PAPER_PAIRS
        if folder and (folder / f"{fine}_V.csv").is_file()
    }
    return Inputs(sizes or Sizes(), read_table1(), {name: shape(name) for name in shape_names(only=only)}, paper)


def disc(fine_vertices: int) -> Pair:
    """A row of Table 1: annuli."""
    return annulus(fine_vertices // 2), annulus(COARSE_RING_VERTICES)


def on_curve(shapes: dict[str, Mesh], names: Sequence[str]) -> dict[str, Pair]:
    """Drawn shapes in coarse meshes with their vertices on the curve, so that the flow has work to do."""
    return {name: (shapes[name], OnCurve().decimate(shapes[name], COUNT)) for name in names if name in shapes}


def flow_cases(shapes: dict[str, Mesh]) -> dict[str, Pair]:
    """A few cases in which the flow has work to do, from small to large."""
    own = {"annulus 512": disc(512), "letter A": (letter_a(), letter_a_coarse())}
    return own | on_curve(shapes, ("glyph_g", "blob_500", "blob_2000"))


def random_pair(seed: int) -> tuple[str, Pair] | None:
    """A random shape and its kind, with a coarse mesh on its curve; None if the seed gives none of the right size."""
    drawn = random_shape(seed)
    if drawn is None or len(drawn[1].vertices) > MOST_RANDOM_VERTICES:
        return None
    pair = _with_coarse(drawn[1])
    return (f"{drawn[0]} {seed}", pair) if pair is not None else None


def glyph_pair(place: int) -> tuple[str, Pair] | None:
    """A letter, digit or sign of a font that comes with matplotlib, as it comes; None for those of few vertices, and
    those that are no valid mesh."""
    character, family = CHARACTERS[place // len(FONTS)], FONTS[place % len(FONTS)]
    try:
        fine = glyph(character, per_curve=PER_CURVE, family=family)
    except NestedCagesError:  # overlapping strokes
        return None
    pair = _with_coarse(fine) if len(fine.vertices) >= LEAST_GLYPH_VERTICES else None
    return (f"{family} {character}", pair) if pair is not None else None


def random_cases(count: int, first_seed: int = 0) -> dict[str, Pair]:
    """Random shapes of ten kinds; seeds that give none are passed over."""
    found: dict[str, Pair] = {}
    seeds = itertools.count(first_seed)
    while len(found) < count:
        made = random_pair(next(seeds))
        if made is not None:
            found[made[0]] = made[1]
    return found


def _with_coarse(fine: Mesh) -> Pair | None:
    """The shape with a coarse mesh on its curve, None if there is none."""
    count = max(LEAST_PER_LOOP * len(fine.loops), len(fine.vertices) // VERTICES_PER_COARSE)
    if count >= len(fine.vertices):
        return None
    try:
        return fine, OnCurve().decimate(fine, count)
    except NestedCagesError:  # the decimation finds no simple loops with so few vertices
        return None
