"""The slowest of many small requests over all settings, by CPU time against one plain cage of the same run.

    python benchmarks/slowest.py --cases 2000
    python benchmarks/slowest.py --kept

Shapes of 3 to 12 vertices a loop at random and worst places: needles, slits, specks beside large parts, combs, points
that nearly meet, fine and coarse grids, symmetries, counts from the least to more than there are. Each line has the CPU
time as a multiple of the plain cage, the request and how it ended. A request beyond `MOST` is stopped and told.
"""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from time import process_time
from typing import Any

import numpy as np

import clone  # noqa: F401
from nestedcages_core import (
    Box,
    Found,
    LeastAngle,
    LeastEdge,
    Mesh,
    Mirror,
    NestedCagesError,
    Rotation,
    Settings,
    Within,
    inner_cages,
    nested_cages,
)
from nestedcages_core.cache import forget

FIRST_SEED = 4_500_000
PLAIN = 20
"""Cages that are timed to know what one takes."""

MOST = 400.0
"""Largest multiple of the CPU time of a plain cage that a request may take."""

KEPT = (4_501_111, 4_501_115, 4_501_112, 4_500_969, 4_501_047)
"""Seeds of the slowest requests so far, which a test makes: grids and clearances without room, distances on grids."""

SHOWN = 20
"""Number of requests that are listed."""


class TooSlowError(BaseException):
    """A request is beyond `MOST`."""


def loop(random: np.random.Generator) -> np.ndarray:
    """A closed polygon around the origin, of any width and direction."""
    count = int(random.integers(3, 13))
    angles = np.sort(random.random(count)) * 2.0 * np.pi
    radii = 10.0 ** random.uniform(-2.0 * random.random(), 0.0, count)
    points = radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    thin = 10.0 ** random.uniform(-3.0, 0.0) if random.random() < 0.5 else 1.0
    turn = random.uniform(0.0, np.pi)
    return points * [1.0, thin] @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]


def shape(random: np.random.Generator) -> Mesh | None:
    """A small shape of one to three loops; None if they cross."""
    loops = [loop(random) for _ in range(int(random.integers(1, 4)))]
    loops = [each + random.uniform(-2.0, 2.0, 2) * (k > 0) for k, each in enumerate(loops)]
    if random.random() < 0.2:
        loops = [loops[0], loops[0] * random.uniform(0.2, 0.999)]
    if random.random() < 0.2:
        loops = [each.round(int(random.integers(1, 4))) for each in loops]
    try:
        return Mesh.from_loops([10.0 ** random.integers(-3, 4) * each for each in loops])
    except NestedCagesError:
        return None


def request(random: np.random.Generator, fine: Mesh) -> tuple[Any, list[Any], dict[str, Any]]:
    """What to call, levels and settings."""
    size, pick = float(np.ptp(fine.vertices, axis=0).max()), random.choice
    count = int(random.integers(3, 2 * len(fine.vertices) + 3))
    limit = 10.0 ** random.uniform(-3.0, 0.5)
    levels: list[Any] = [[count], [count, max(3, count // 2)], [Within(excess=limit)], [Within(distance=limit * size)]]
    given: dict[str, Any] = {}
    options = {
        "clearance": size * 10.0 ** random.uniform(-8.0, 0.0),
        "grid": size * 10.0 ** random.uniform(-4.0, 0.0),
        "stored": pick(["float32", "float16"]),
        "symmetry": [Found(), Mirror(None, (1.0, 0.0)), Rotation(None, int(pick([2, 3, 6])))][pick(3)],
        "convex": True,
        "merge": size * 10.0 ** random.uniform(-2.0, 0.0),
        "constraints": [
            [
                LeastEdge(size * 10.0 ** random.uniform(-2.0, 0.0)),
                LeastAngle(float(random.uniform(5.0, 60.0))),
                Box(tuple(fine.vertices.min(axis=0) - 0.01 * size), tuple(fine.vertices.max(axis=0) + 0.01 * size)),
            ][pick(3)]
        ],
        "weights": np.where(fine.vertices[:, 0] > fine.vertices[:, 0].mean(), 100.0, 1.0),
    }
    for name in pick(list(options), size=int(random.integers(0, 4)), replace=False).tolist():
        given[name] = options[name]
    which = int(pick(len(levels), p=[0.6, 0.2, 0.1, 0.1]))
    return inner_cages if random.random() < 0.15 else nested_cages, levels[which], given


@contextmanager
def stopped_after(seconds: float) -> Iterator[None]:
    """Raises TooSlowError after so many seconds of CPU time."""

    def stop(*_: object) -> None:
        raise TooSlowError

    signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)


def taken(work: Any, fine: Mesh, levels: list[Any], given: dict[str, Any], most: float) -> tuple[float, str]:
    """CPU time of a request and how it ended, stopped after a most."""
    forget()
    began, end = process_time(), "made"
    try:
        with stopped_after(most):
            work(fine, levels, Settings.of(None, **given))
    except NestedCagesError as error:
        end = error.code
    except TooSlowError:
        end = "STOPPED"
    except Exception as error:  # what no request may end with
        end = f"RAISED {type(error).__name__}: {error}"
    return process_time() - began, end


def slowest(seeds: Iterable[int]) -> list[tuple[float, int, str]]:
    """Multiples of the time of a plain cage with the seed and the request, the slowest first."""
    wheel = Mesh.from_loops([[(np.cos(t), np.sin(t)) for t in np.linspace(0.0, 6.0, 30)]])
    nested_cages(wheel, [8])
    plain = float(np.median([taken(nested_cages, wheel, [8], {}, 60.0)[0] for _ in range(PLAIN)]))
    found = []
    for seed in seeds:
        random = np.random.default_rng(seed)
        fine = None
        while fine is None:
            fine = shape(random)
        work, levels, given = request(random, fine)
        seconds, end = taken(work, fine, levels, given, MOST * plain)
        words = ", ".join([*map(str, levels), *(f"{key}={value!r:.60}" for key, value in given.items())])
        loops = "+".join(str(len(each)) for each in fine.loops)
        found.append((seconds / plain, seed, f"{work.__name__}({loops}: {words}): {end}"))
    return sorted(found, reverse=True)


def main() -> int:
    """Run the command; exit status 1 if a request is beyond `MOST`, or ends in another error than ours."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--cases", type=int, default=2000)
    options.add_argument("--first", type=int, default=FIRST_SEED, help="the first seed")
    options.add_argument("--kept", action="store_true", help="make the slowest so far again")
    given = options.parse_args()
    seeds = KEPT if given.kept else range(given.first, given.first + given.cases)
    found = slowest(seeds)
    ratios = np.array([ratio for ratio, _, _ in found])
    print(f"{len(seeds)} requests from seed {seeds[0]}: {np.median(ratios):.1f} plain cages in the median,")
    print(f"{np.quantile(ratios, 0.99):.0f} in 99 of 100, {ratios.max():.0f} at most; {MOST:.0f} are allowed.")
    for ratio, seed, said in found[:SHOWN]:
        print(f"{ratio:7.1f}  {seed}  {said}")
    wrong = [f"{seed}  {said}" for _, seed, said in found if ": STOPPED" in said or ": RAISED" in said]
    print("\n".join(wrong), file=sys.stderr)
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
