"""The situations of the paper's figures 1 to 5, for a picture: our drawings, or the paper's own meshes."""

from __future__ import annotations

from pathlib import Path

from comparison import methods, shapes
from comparison.measure import Measurement, measure
from comparison.shapes import Case
from data import read_shape
from nestedcages_core import AUGMENTED_2022

SHOWN = {
    "figure 1: the A": "letter A, 45 + 6 in 32 + 3",
    "figure 2: a hole": "octagon with a hole in a square with a hole",
    "figure 3: a disc": "disc with a hole in an octagon",
    "figure 4: a hole left out": "disc with two holes, one covered",
    "figure 5: very coarse": "disc with a hole in a very coarse mesh",
}
"""Figure -> our drawing of it."""

PAPERS = {
    "figure 1: the A": ("A_guy_fine", "A_guy_coarse"),
    "figure 2: a hole": ("octagon_hole_hand", "square_hole_hand"),
    "figure 4: a hole left out": ("octagon_hole_hand", "square_hand"),
}
"""Figure -> the paper's meshes, as far as its program brings them."""

METHODS = {
    methods.ORIGINAL: methods.WHOLE[methods.ORIGINAL],
    methods.WRITTEN: methods.WHOLE[methods.WRITTEN],
    methods.OURS: methods.TIGHT,
}


def results(folder: Path | None = None) -> dict[str, dict[str, Measurement]]:
    """Figure -> method -> what became of it; of the paper's own meshes in a folder, with absolute lengths."""
    chosen = dict(METHODS)
    if folder is None:
        drawn = {made.shape: made for made in shapes.figures()}
        found = {figure: drawn[name] for figure, name in SHOWN.items()}
    else:
        chosen[methods.WRITTEN] = AUGMENTED_2022
        found = {figure: Case("paper", 0, figure, read_shape(folder, fine), read_shape(folder, coarse))
                 for figure, (fine, coarse) in PAPERS.items()}  # fmt: skip
    return {figure: {name: measure(settings, made.fine, made.coarse, 1) for name, settings in chosen.items()}
            for figure, made in found.items()}  # fmt: skip
