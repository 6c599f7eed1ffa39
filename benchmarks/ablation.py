"""What each mechanism buys: cages with it and without it, in three positions, which tell the noise."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from importlib import import_module
from math import inf
from typing import Any

import numpy as np

import nestedcages_core as core
from common import DETAILS, Options, forget, table
from nestedcages_core import ArcLength, Mesh, NestedCagesError, Settings, nested_cages, verify
from random_shapes import KINDS, random_shape
from shapes import GROWING

POSITIONS = ((0.0, 0.0), (0.7, 0.3), (2.1, -5.0))
"""Rotation in radians and shift in diagonals of each position; the first is as given."""
SHAPES, QUICK_SHAPES, SIZES = 6, 1, (300, 1_000)
COUNTS, OWN_COUNT = (16, 32), 24  # cage vertices, raised to four for every loop; those of coarse meshes that are given
WIDE_CLEARANCE, SMALL_EXCESS = 0.02, 3e-4
"""A clearance in diagonals that does not fit into narrow gaps; what is added to both excesses of a ratio."""
FIRST_SEED, LARGEST = 40_000, 300
NEEDLES = ("needles", "star")  # kinds whose excess is decided by round-off: they are apart


NEVER: Any = lambda *_, **__: False  # noqa: E731
NOTHING: Any = lambda *_, **__: None  # noqa: E731
ALL_KEPT: Any = lambda pairs, *_, **__: np.ones(len(pairs), bool)  # noqa: E731


@dataclass(frozen=True)
class Off:
    """How a mechanism is switched off: by settings, or by what takes the place of "module:name" in the core."""

    settings: Callable[[], Settings] = Settings
    patches: Mapping[str, Any] = field(default_factory=dict)


def contacts(*names: str) -> Callable[[], Settings]:
    return lambda: Settings(contact=[getattr(core, name)() for name in names])


def chosen_as(name: str, method: str, **options: object) -> Callable[[], Settings]:
    return lambda: Settings(**{name: getattr(core, method)(**options)})


CLEARANCE = "tightening.reach_clearance"
MECHANISMS: dict[str, Off] = {
    "the hull as fallback": Off(partial(Settings, fallback=None)),
    "line cycles (places by arc length)": Off(partial(Settings, decimation=ArcLength())),
    "the curve": Off(partial(Settings, steps=False)),
    "flow: steps with samples at vertices (6 to 1)": Off(chosen_as("flow", "TwoSidedFlow", vertex_limit=1)),
    "line cycles: searches through other lines": Off(
        patches={"decimation.ring_search:MAX_ACROSS": 0, "decimation.ring_search:MAX_MORE": 0}
    ),
    "line cycles: ways to clear crossings (3 to 1)": Off(patches={"decimation.line_cycles:CROSSING_RULES": (1.0,)}),
    "line cycles: places (3 to 2 per vertex)": Off(patches={"decimation.cycle_search:SAMPLES_PER_VERTEX": 2.0}),
    "the sequence of outlines": Off(partial(Settings, loops="keep")),
    "large clearances: the rounded offset": Off(patches={"decimation.starts:is_wide": NEVER}),
    "many points: coarse to fine": Off(patches={"decimation.line_cycles:ALL_POINTS": inf}),
    "sequential QPs first (IPC first)": Off(contacts("IPC", "SequentialQP")),
    "sequential QPs (IPC only)": Off(contacts("IPC")),
    "IPC behind sequential QPs": Off(contacts("SequentialQP")),
    "IPC: stiffening": Off(patches={"contact.ipc:MOST_ROUNDS": 1}),
    "pruning of implied constraints": Off(
        patches={"contact.contact_response:not_implied": ALL_KEPT, "tightening.quadratic_model:not_implied": ALL_KEPT}
    ),
    "escapes from saddles": Off(patches={"tightening.tightening:negative_curvature": NOTHING}),
    "trials of shortened steps (3 to 1)": Off(patches={"tightening.trust_region:MAX_ATTEMPTS": 1}),
    "overshoot of restoration": Off(patches={f"{CLEARANCE}:OVERSHOOT": 1.0}),
}
"""Name, and how it is switched off; "(a to b)" where it is not all or nothing. Names that are gone are told."""


@contextmanager
def switched_off(patches: Mapping[str, Any]) -> Iterator[None]:
    """Replace names of the core. Raises AttributeError and ImportError where they are gone."""
    undo: list[tuple[Any, str, Any]] = []
    try:
        for where, value in patches.items():
            module, _, path = where.partition(":")
            holder: Any = import_module(f"nestedcages_core.{module}")
            *outer, name = path.split(".")
            for part in outer:
                holder = getattr(holder, part)
            undo.append((holder, name, getattr(holder, name)))
            setattr(holder, name, value)
        yield
    finally:
        for holder, name, before in reversed(undo):
            setattr(holder, name, before)


@dataclass(frozen=True)
class Case:
    """A shape and a level."""

    name: str
    fine: Mesh
    level: int | Mesh
    clearance: float | None = None

    def placed(self, angle: float, shift: float) -> Case:
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        fine, level = (
            Mesh(part.vertices @ turn + shift * self.fine.diagonal, part.edges) if isinstance(part, Mesh) else part
            for part in (self.fine, self.level)
        )
        return replace(self, fine=fine, level=level)


def cases(shapes: int, sizes: Sequence[int]) -> list[Case]:
    """Random shapes at two counts, with a wide clearance and with a coarse mesh of their own; then larger shapes."""
    found: list[Case] = []
    kinds: Counter[str] = Counter()
    seed = FIRST_SEED
    while kinds.total() < shapes:
        drawn, seed = random_shape(seed), seed + 1
        if drawn is None or len(drawn[1].vertices) > LARGEST or kinds[drawn[0]] >= -(-shapes // len(KINDS)):
            continue
        kinds[drawn[0]] += 1
        name, fine = f"{drawn[0]} {seed - 1}", drawn[1]
        counts = sorted({min(len(fine.vertices), max(k, 4 * len(fine.loops))) for k in COUNTS})
        found += [Case(f"{name} at {k}", fine, k) for k in counts]
        found.append(Case(f"{name} with clearance", fine, counts[-1], WIDE_CLEARANCE * fine.diagonal))
        with suppress(NestedCagesError):
            coarse = ArcLength().decimate(fine, min(len(fine.vertices), max(OWN_COUNT, 6 * len(fine.loops))))
            found.append(Case(f"{name} and a coarse mesh", fine, coarse))
    kinds_of_size = [kind for kind in GROWING if kind != "islands"]
    return found + [
        Case(f"{kind} of {n}", GROWING[kind](n), min(n // 10, 256)) for n in sizes for kind in kinds_of_size
    ]


Made = tuple[float, float]  # excess, nan where there is no certified cage, and CPU seconds


def make(case: Case, off: Off) -> Made:
    forget()
    with switched_off(off.patches):
        begin = time.process_time()
        try:
            level = nested_cages(case.fine, case.level, replace(off.settings(), clearance=case.clearance))[0]
        except NestedCagesError:
            return np.nan, time.process_time() - begin
        seconds = time.process_time() - begin
    holds = verify(level.cage, level.fine, level.report.wanted_clearance).holds
    return level.report.excess if holds else np.nan, seconds


def row(name: str, chosen: Sequence[Case], base: np.ndarray, other: np.ndarray) -> tuple[object, ...]:
    """What changes from base to other, (C, P, 2); a ratio is the geometric mean over the positions of a case."""
    made, without = np.isfinite(base[..., 0]), np.isfinite(other[..., 0])
    both = made & without
    ratio = (other[..., 0] + SMALL_EXCESS) / (base[..., 0] + SMALL_EXCESS)
    logs = np.where(both, np.log(np.where(both, ratio, 1.0)), 0.0).sum(axis=1) / np.maximum(both.sum(axis=1), 1)
    needles = np.array([case.name.split()[0] in NEEDLES for case in chosen])
    plain, apart = (np.exp(logs[both.any(axis=1) & mask]) for mask in (~needles, needles))
    low, middle, high = np.quantile(plain, (0.25, 0.5, 0.75)) if len(plain) else (1.0, 1.0, 1.0)
    changed = (np.abs(ratio[both] - 1.0) > 1e-6).mean() if both.any() else 0.0
    seconds = other[both, 1].sum() / base[both, 1].sum()
    return (
        name, int(made.sum() - without.sum()), f"{100 * changed:.0f} %", f"{middle:.4f}", f"{low:.4f} … {high:.4f}",
        f"{plain.max(initial=1.0):.3f}", f"{apart.max(initial=1.0):.2f}", f"{seconds:.2f}",
    )  # fmt: skip


def run(options: Options) -> str:
    chosen = cases(QUICK_SHAPES, ()) if options.quick else cases(SHAPES, SIZES)
    placed = [[case.placed(*position) for position in POSITIONS] for case in chosen]
    base = np.array([[make(case, Off()) for case in positions] for positions in placed])
    rows, gone = [row("nothing, but turned", chosen, base[:, :1], base[:, 1:2])], []
    for name, off in MECHANISMS.items():
        if not options.wants(name):
            continue
        try:
            found = np.array([[make(case, off) for case in positions] for positions in placed])
            rows.append(row(name, chosen, base, found))
        except (AttributeError, ImportError):
            gone.append(name)
    heads = ("without", "lost", "changed", "median", "quartiles", "worst", "worst needles", "time")
    idle = [name for name, lost, _, _, _, worst, *_ in rows[1:] if lost == 0 and worst == "1.000"]
    text = f"{len(chosen)} cases in {len(POSITIONS)} positions\n"
    text += table(heads, [line for line in rows if line[0] not in idle])
    text += f"\nNone lost and none looser: {'; '.join(idle)}." if idle else ""
    return text + (f"\nNot in this code: {'; '.join(gone)}." if gone else "") + f"\n{DETAILS}\n{table(heads, rows)}"
