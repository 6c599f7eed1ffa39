"""Time and tightness of default cages around random shapes, next to another commit."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator
from itertools import count as numbers

import numpy as np

from common import DETAILS, FAILED, Options, Server, ServerError, forget, ratios, spread, table
from nestedcages_core import Mesh, nested_cages
from random_shapes import KINDS, random_shape

FEWEST, MOST = 100, 1000
"""Vertices of the shapes."""
COUNTS = (16, 24, 32, 48, 64)
LARGEST_SHARE = 0.5
"""Cage vertices per vertex of the shape, at most."""
CASES, QUICK_CASES, REPEATS = 48, 8, 2
FLOOR = 3e-4
"""Added to both excesses: below that the clearance decides, not the method."""


def cases(number: int, seed: int) -> Iterator[tuple[str, list[np.ndarray], int]]:
    """(name, loops, count) of random shapes from the seed on, about as many of each kind."""
    kinds: Counter[str] = Counter()
    for turn in numbers(seed):
        if kinds.total() == number:
            return
        drawn = random_shape(turn)
        if drawn is None or not FEWEST <= len(drawn[1].vertices) <= MOST:
            continue
        kind, fine = drawn
        fits = [c for c in COUNTS if 4 * len(fine.loops) <= c <= LARGEST_SHARE * len(fine.vertices)]
        # kinds that seldom have so many vertices must not hold up the others
        if fits and (kinds[kind] < -(-number // len(KINDS)) or (turn + 1) % (10 * len(KINDS)) == 0):
            kinds[kind] += 1
            count = int(np.random.default_rng([turn + 1, 2]).choice(fits))
            yield f"{kind} {turn}", [fine.vertices[loop] for loop in fine.loops], count


def measure(loops: list[np.ndarray], count: int) -> tuple[float, float]:
    """In a server: CPU seconds and excess of a cage, with nothing remembered."""
    fine = Mesh.from_loops(loops)
    forget()
    begin = time.process_time()
    excess = nested_cages(fine, [count])[0].report.excess
    return time.process_time() - begin, excess


def run(options: Options) -> str:
    rows, lost = [], 0
    servers = {name: Server(tree, "speed:measure") for name, tree in options.trees().items()}
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in servers}
    try:
        for name, loops, count in cases(QUICK_CASES if options.quick else CASES, options.seed):
            best = {}
            for _ in range(REPEATS):  # in turns, so that whatever else the machine does slows both
                for each, server in servers.items():
                    try:
                        seconds, excess = server(loops, count)
                        best[each] = min(seconds, best.get(each, (np.inf,))[0]), excess
                    except ServerError:
                        best[each] = np.nan, np.nan
            cells = [value for each in servers for value in (best[each][0], 100.0 * best[each][1])]
            rows.append((name, sum(map(len, loops)), len(loops), count, *cells))
            lost += np.isnan(best["now"][0]) and not np.isnan(best[next(iter(servers))][0])
            for each, value in best.items():
                found[each].append(value)
    finally:
        for server in servers.values():
            server.close()
    heads = [f"{what}, {each}" for each in servers for what in ("CPU s", "excess %")]
    lines = []
    for each, values in found.items():
        seconds, excess = np.array(values).T
        lines.append(f"{each}: CPU seconds {spread(seconds)}, excess {spread(100.0 * excess, 2)} %")
    if options.against:
        before, now = (np.array(values) for values in found.values())
        both = np.isfinite(before[:, 0] + now[:, 0])
        lines.append(f"CPU time {ratios(now[both, 0] / before[both, 0])}")
        lines.append(f"excess   {ratios((now[both, 1] + FLOOR) / (before[both, 1] + FLOOR), 4)}")
    lines += [f"{FAILED}: {lost} cages lost"] if lost else []
    summary = (
        f"{len(rows)} random shapes of {FEWEST} to {MOST} points under {COUNTS[0]} to {COUNTS[-1]}: median (10 … 90 %)"
    )
    return "\n".join([summary, *lines, DETAILS, table(("shape", "points", "loops", "cage", *heads), rows)])
