"""Several hulls of one outline, by a tree of greedy runs: one down to a medium size, some from there, each of which
ends in several ways."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import exp, log
from typing import TypeAlias

from ...tasks import Stage, mapped
from ..outline import Outline
from .hull_moves import Weights
from .progressive_hull import ProgressiveHull

Greedy: TypeAlias = Callable[[Outline, Weights, Sequence[int]], ProgressiveHull]
"""Makes the state of a run from an outline, weights and the vertices that each loop keeps."""

EVEN_WEIGHTS = Weights()
"""Equal cost per area: best on smooth shapes with few features."""

ROUGH_WEIGHTS = Weights(drop=0.55, extend=1.1, slide=0.8, pivot=1.1, spike=0.03)
"""Cheap notches: best on rough shapes, where notches should be filled before bumps are extended."""

RESTART_WEIGHTS = (
    Weights(drop=0.73, extend=0.97, slide=0.91, pivot=0.71, spike=0.002),
    Weights(drop=0.63, extend=0.76, slide=0.5, pivot=1.77, spike=0.054, noise=0.25),
    Weights(drop=0.38, extend=1.02, slide=0.57, pivot=1.67, spike=0.011),
    Weights(drop=1.29, extend=1.0, slide=0.77, pivot=1.73, spike=0.081),
    Weights(drop=0.47, extend=0.84, slide=0.54, pivot=0.78, spike=0.056),
)
"""Weights that complement each other: of 44, those with the tightest cages over 124 random shapes and 52
glyphs (docs/ablation.md: restarts)."""

ENDING_WEIGHTS = RESTART_WEIGHTS
"""Weights with which every restart ends, once each (docs/ablation.md: endings)."""

STAGE_SHARE = 0.4
"""Approximate fraction of the time before the restarts; only for the progress bar."""

MIN_STAGE_SIZE, STAGE_SIZE_FACTOR, MIDDLE_SIZE_FACTOR = 100, 3.0, 2.0
"""Size of the outline to restart from: a minimum, and a multiple of the wanted number of vertices; the multiple from
which restarts end in several ways."""

SIZE_RATIO = 1.25
"""Ratio of sizes next to each other, to which they are rounded: close numbers of vertices share their runs."""

MOVES_PER_RESTART = 200
"""Moves of a restart, some 5 ms, up to which all restarts are made. Of longer ones there are fewer, with as many moves
in total: where many vertices are wanted, further ones gain less."""

EXTRA_RESTARTS_PER_LOOP, MAX_RESTART_FACTOR = 2, 2
"""Additional restarts per loop after the second, since vertices can be distributed in many ways; maximum number of
restarts, as a multiple of that of one loop (docs/ablation.md: further restarts for loops)."""

MIN_RESTARTS = 2
"""Minimum number of restarts, whatever the moves."""

MAX_RESCUES = 40
"""Maximum number of runs with widely varied weights if no restart reaches the wanted number; they reach smaller numbers
(docs/ablation.md: rescues)."""

MAX_RESCUE_MOVES, MIN_RESCUES = 8_000, 8
"""Moves of all rescues together, about two seconds, and the minimum number of rescues."""


HOPELESS_SHARE, HOPELESS_NUMBER = 0.2, 5
"""Vertices beyond the wanted number, as a fraction of it and at least, of the smallest hull of one restart, or of the
first rescues, from which no other run follows: in 350 drawings of islands whose first restart is too large, no search
that began above a fraction of 0.09 succeeded, and 40 rescues reached at most 4 % less than 8 (docs/ablation.md: early
end of hopeless hull searches)."""


@dataclass(frozen=True)
class Variation:
    """Ranges of random weights: uniform in the natural logarithm; the noise itself uniform."""

    drop: tuple[float, float]
    extend: tuple[float, float]
    slide: tuple[float, float]
    spike: tuple[float, float]
    noise: tuple[float, float]
    reach: tuple[float, float] = (0.4, 0.4)
    loops: float = 0.0
    """Standard deviation of the logarithm of a random factor per loop."""

    def draw(self, rng: random.Random, loops: int) -> Weights:
        """Random weights; pivots vary like extensions."""
        return Weights(
            drop=exp(rng.uniform(*self.drop)),
            extend=exp(rng.uniform(*self.extend)),
            slide=exp(rng.uniform(*self.slide)),
            pivot=exp(rng.uniform(*self.extend)),
            spike=exp(rng.uniform(*self.spike)),
            noise=rng.uniform(*self.noise),
            reach=exp(rng.uniform(*self.reach)),
            loops=tuple(exp(rng.gauss(0.0, self.loops)) for _ in range(loops)) if self.loops else (),
            seed=rng.getrandbits(32),
        )


RESTART_VARIATION = Variation(
    drop=(-1.2, 0.2), extend=(-0.4, 0.6), slide=(-0.6, 0.3), spike=(-5.8, -1.2), noise=(0.0, 0.4)
)
"""Between even and rough; tuned on glyphs, blobs and a snowflake for the area after tightening."""

RESCUE_VARIATION = Variation(
    drop=(-1.0, 1.0),
    extend=(-1.0, 1.0),
    slide=(-1.0, 1.0),
    spike=(-7.0, 0.0),
    noise=(0.0, 1.5),
    reach=(-1.0, 3.5),
    loops=2.0,
)
"""For loops that block each other: wide ranges."""


def search_hulls(
    outline: Outline,
    count: int,
    minimum: Sequence[int],
    *,
    restarts: int,
    seed: int,
    prepare: Callable[[Outline], Outline] = lambda outline: outline,
    greedy: Greedy = ProgressiveHull,
) -> Stage[float, list[Outline]]:
    """Hulls of an outline with at most `count` vertices, least area first; the smallest first if none is small enough.

    A generator: yields the fraction done and returns the hulls.

    minimum: vertices that each loop keeps. restarts: runs for one or two loops. prepare: applied to each outline to
    restart from. greedy: makes the state of a run. Deterministic for a seed.
    """
    stage = yield from mapped(_stage(outline, count, minimum, ROUGH_WEIGHTS, greedy), lambda done: STAGE_SHARE * done)
    stage = prepare(stage)
    size, middle = len(stage.vertices), middle_size(count)
    moves = max(1, size - middle) + len(ENDING_WEIGHTS) * max(1, min(size, middle) - count)
    further = EXTRA_RESTARTS_PER_LOOP * max(0, len(outline.sizes) - 2)
    wanted = min(restarts + further, MAX_RESTART_FACTOR * restarts)
    runs = max(1, min(wanted, max(MIN_RESTARTS, MOVES_PER_RESTART * restarts // moves)))
    rng = random.Random(seed)
    weights = list(RESTART_WEIGHTS[:runs])
    weights += [RESTART_VARIATION.draw(rng, len(outline.sizes)) for _ in range(runs - len(weights))]
    hulls: list[Outline] = []
    for number, chosen in enumerate(weights):
        begun = stage
        if size > middle:
            run = greedy(stage, chosen, minimum).steps(middle)
            begun = yield from mapped(run, partial(_fraction, number, runs, 0.0))
        for ending, other in enumerate(ENDING_WEIGHTS):
            finished = (ending + 1.0) / (len(ENDING_WEIGHTS) + 1.0)
            run = greedy(begun, other, minimum).steps(count)
            hulls.append((yield from mapped(run, partial(_fraction, number, runs, finished))))
        if begun is stage or _is_hopeless(hulls, count):
            break  # the other runs would end the same outline, or as far off
    if _smallest(hulls) > count:
        hulls = yield from _rescues(outline, count, minimum, seed, prepare, greedy)
    return sorted(hulls, key=lambda hull: (max(count, len(hull.vertices)), hull.area))


def _fraction(number: int, runs: int, finished: float, done: float) -> float:
    """Fraction of the search that is done, given those of a restart and of its next part."""
    return STAGE_SHARE + (1.0 - STAGE_SHARE) * (number + finished + done / (len(ENDING_WEIGHTS) + 1.0)) / runs


def _stage(
    outline: Outline, count: int, minimum: Sequence[int], weights: Weights, greedy: Greedy
) -> Stage[float, Outline]:
    """The outline to restart from, made without pivots, which would cost area and a third of the time."""
    run = greedy(outline, replace(weights, pivot=None), minimum)
    yield 0.0
    return (yield from run.steps(stage_size(count)))


def stage_size(count: int) -> int:
    """Size of the outline to restart from for a number of vertices: the same for numbers close to each other."""
    return max(MIN_STAGE_SIZE, _rounded(STAGE_SIZE_FACTOR * count))


def middle_size(count: int) -> int:
    """Size of the outlines from which restarts end in several ways."""
    return _rounded(MIDDLE_SIZE_FACTOR * count)


def _rounded(size: float) -> int:
    """A size rounded to a power of the ratio."""
    return round(SIZE_RATIO ** round(log(size, SIZE_RATIO)))


def _rescues(
    outline: Outline,
    count: int,
    minimum: Sequence[int],
    seed: int,
    prepare: Callable[[Outline], Outline],
    greedy: Greedy,
) -> Stage[float, list[Outline]]:
    """Hulls from runs that do not depend on the count, so that a request for the smallest one found succeeds."""
    stage = prepare((yield from _stage(outline, sum(minimum), minimum, EVEN_WEIGHTS, greedy)))
    moves = len(stage.vertices) - sum(minimum)
    runs = max(MIN_RESCUES, min(MAX_RESCUES, MAX_RESCUE_MOVES // max(1, moves)))
    rng = random.Random(seed)
    hulls: list[Outline] = []
    while len(hulls) < runs:
        chosen = RESCUE_VARIATION.draw(rng, len(outline.sizes))
        hulls.append((yield from greedy(stage, chosen, minimum).steps(count)))
        if _smallest(hulls) <= count or (len(hulls) >= MIN_RESCUES and _is_hopeless(hulls, count)):
            break
    return hulls


def _smallest(hulls: Sequence[Outline]) -> int:
    """The smallest number of vertices of the hulls."""
    return min(len(hull.vertices) for hull in hulls)


def _is_hopeless(hulls: Sequence[Outline], count: int) -> bool:
    """Whether the hulls are so far from a number of vertices that others like them will not come close."""
    return _smallest(hulls) - count > max(HOPELESS_SHARE * count, HOPELESS_NUMBER)
