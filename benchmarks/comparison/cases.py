"""What the methods are compared on: the discs of Table 1, the figures, the drawn shapes, and random shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from comparison.drawings import drawings, letter_a, letter_a_coarse
from data import COARSE_RING_VERTICES, Table1Row, annulus, read_shape, read_table1, shape, shape_names
from nestedcages_core import Mesh, NestedCagesError, OnCurve
from random_shapes import random_shape

COUNT = 32  # vertices of the coarse meshes of the drawn shapes
PAPER_PAIRS = (("A", "A_guy_fine", "A_guy_coarse"), ("octagon", "octagon_hole_hand", "square_hole_hand"))

FIRST_SEED, RANDOM_CASES = 0, 60  # random shapes: seeds from the first on, until there are so many
MOST_RANDOM_VERTICES = 400  # of a fine mesh: all pairs, a hundred times a step, are slow
VERTICES_PER_COARSE = 6  # fine vertices of a random shape for each coarse one
LEAST_PER_LOOP = 5  # coarse vertices

Pair = tuple[Mesh, Mesh]
"""A fine and a coarse mesh."""


@dataclass(frozen=True)
class Inputs:
    """What the comparison runs on."""

    table1: tuple[Table1Row, ...]
    shapes: dict[str, Mesh]
    paper: dict[str, Pair]
    """The paper's own pairs of meshes, where they are there."""

    @property
    def figures(self) -> dict[str, Pair]:
        """The shapes of the paper's figures: its own meshes, and our drawings of them."""
        return self.paper | drawings()


def read_inputs(folder: Path | None = None, only: Sequence[str] | None = None) -> Inputs:
    """Table 1, the drawn shapes or those named, and the paper's meshes as far as they are in `folder`."""
    paper = {
        f"the paper's {title}": (read_shape(folder, fine), read_shape(folder, coarse))
        for title, fine, coarse in PAPER_PAIRS
        if folder and (folder / f"{fine}_V.csv").is_file()
    }
    return Inputs(read_table1(), {name: shape(name) for name in shape_names(only=only)}, paper)


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


def random_cases() -> dict[str, Pair]:
    """Random shapes of ten kinds with coarse meshes on their curves; seeds that give none are passed over."""
    found: dict[str, Pair] = {}
    seed = FIRST_SEED - 1
    while len(found) < RANDOM_CASES:
        seed += 1
        drawn = random_shape(seed)
        if drawn is None or len(drawn[1].vertices) > MOST_RANDOM_VERTICES:
            continue
        kind, fine = drawn
        count = max(LEAST_PER_LOOP * len(fine.loops), len(fine.vertices) // VERTICES_PER_COARSE)
        if count >= len(fine.vertices):
            continue
        try:
            found[f"{kind} {seed}"] = fine, OnCurve().decimate(fine, count)
        except NestedCagesError:  # the decimation finds no simple loops with so few vertices
            continue
    return found
