"""Contacts and whole methods, published and ours, from the same coarse meshes of three kinds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import count
from typing import NamedTuple

import numpy as np

from common import DETAILS, Options, parts, spread, table
from nestedcages_core import Mesh, NestedCagesError, Tightening
from paper.check import check as check
from paper.methods import CONTACTS, STARTS, WHOLE, Run, alone, measured, replace
from random_shapes import random_shape
from shapes import glyph, held_out

MOST_VERTICES, VERTICES_PER_COARSE, LEAST_PER_LOOP = 150, 6, 5
"""Of a fine mesh, since all pairs, a hundred times a step, are slow; fine vertices for each coarse one."""
FONTS = ("DejaVu Sans", "DejaVu Serif")
CHARACTERS = "agQ&8$BeR@36CDGJOPSUbcdfhjmnopqrstu059?%§ßæøåçñäöüéâîûŒÆØÅΩθφψαβγδεζηλμξπρσω"
FAMILIES = {"random": 10, "glyphs": 10, "held out": 20}  # shapes of each; held-out ones took no part in tuning


class Case(NamedTuple):
    """A fine mesh with a coarse mesh from each start."""

    family: str
    name: str
    fine: Mesh
    coarse: dict[str, Mesh]


def drawn(family: str) -> Iterator[tuple[str, Mesh]]:
    if family == "random":
        yield from (found for seed in count() if (found := random_shape(seed)) is not None)
    elif family == "held out":
        yield from held_out()
    for character in CHARACTERS if family == "glyphs" else "":
        for font in FONTS:
            try:
                yield f"{font} {character}", glyph(character, per_curve=6, family=font)
            except NestedCagesError:  # overlapping strokes
                continue


def cases(quick: bool) -> list[Case]:
    found = []
    for family, number in FAMILIES.items():
        made: list[Case] = []
        for name, fine in drawn(family):
            most = max(LEAST_PER_LOOP * len(fine.loops), len(fine.vertices) // VERTICES_PER_COARSE)
            if len(fine.vertices) <= MOST_VERTICES and most < len(fine.vertices):
                try:
                    coarse = {start: decimation.decimate(fine, most) for start, decimation in STARTS.items()}
                except NestedCagesError:  # a start has no simple loops with so few vertices
                    continue
                made.append(Case(family, name, fine, coarse))
            if len(made) == (1 if quick else number):
                break
        found += made
    return found


Runs = dict[str, list[Run]]  # method -> its run of each case


def solved(made: list[Case], runs: Runs, name: str) -> list[str]:
    """How many of each family a method solves."""
    right = [(case.family, not one.failed) for case, one in zip(made, runs[name], strict=True)]
    return [f"{sum(good for of, good in right if of == family)} of {sum(of == family for of, _ in right)}"
            for family in FAMILIES]  # fmt: skip


def shared(runs: Runs, names: Iterable[str]) -> list[int]:
    """Cases that all of some methods solve."""
    return [
        k for k, row in enumerate(zip(*(runs[name] for name in names), strict=True)) if not any(r.failed for r in row)
    ]


def contacts(made: list[Case], starts: Iterable[str]) -> str:
    """Each contact from the same flow, lowering the area as it goes, and with the same tightening after it."""
    rows = []
    for start in starts:
        runs: Runs = {}
        for name, contact in CONTACTS.items():
            runs[name] = [measured(alone(contact, case.fine), case.fine, case.coarse[start]) for case in made]
            ended = [replace(alone(contact, case.fine), tightening=Tightening()) for case in made]
            runs[f"{name}+"] = [measured(s, case.fine, case.coarse[start]) for s, case in zip(ended, made, strict=True)]
        all_solve = shared(runs, runs)
        for name in CONTACTS:
            mine, after = ([runs[each][k] for k in all_solve] for each in (name, f"{name}+"))
            rows.append((
                f"{start}: {name}", *solved(made, runs, name), len(mine), spread([one.excess for one in mine], 1),
                spread([one.excess for one in after], 2), spread([1e3 * one.contact_seconds for one in mine], 1),
                f"{np.median([one.distance for one in mine]) if mine else np.nan:.0e}",
            ))  # fmt: skip
    heads = ("start: contact, d̂", *FAMILIES, "shared", "excess %", "tightened %", "ms", "distance left")
    return "median (10 … 90 %) of the shapes that all contacts of a start solve\n" + table(heads, rows)


def methods(made: list[Case], starts: Iterable[str]) -> str:
    """Whole methods from one coarse mesh, and one attempt but for the default."""
    rows, details = [], []
    for start in starts:
        runs = {name: [measured(s, case.fine, case.coarse[start]) for case in made] for name, s in WHOLE.items()}
        all_solve = shared(runs, runs)
        for name in WHOLE:
            mine = [runs[name][k] for k in all_solve]
            rows.append((f"{start}: {name}", *solved(made, runs, name), len(mine),
                         spread([one.excess for one in mine], 1), spread([one.seconds for one in mine])))  # fmt: skip
        for k, case in enumerate(made):
            told = [runs[name][k].failed or f"{runs[name][k].excess:.2f}" for name in WHOLE]
            details.append((f"{start}: {case.name}", len(case.fine.vertices), len(case.coarse[start].vertices), *told))
    heads = ("start: method", *FAMILIES, "shared", "excess %", "CPU s")
    text = "median (10 … 90 %) of the shapes that all methods of a start solve\n" + table(heads, rows)
    return f"{text}\n{DETAILS}\n{table(('start: shape', 'points', 'coarse', *WHOLE), details)}"


def run(options: Options) -> str:
    made, starts = cases(options.quick), list(STARTS)[-1:] if options.quick else list(STARTS)
    tables = {"contacts": contacts, "methods": methods}
    return parts({name: make(made, starts) for name, make in tables.items() if options.wants(name)})
