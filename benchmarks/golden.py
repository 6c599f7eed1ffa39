"""460 requests of 21 kinds next to another commit: bit-equal, equal, tighter, looser, lost. For every move of code."""

from __future__ import annotations

import hashlib
import time
from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np
import shapely

import nestedcages_core as core
from common import DETAILS, FAILED, Options, Server, ServerError, forget, ratios, table
from nestedcages_core import Mesh
from random_shapes import random_shape

FIRST_SEED = 870_000
SHAPES, QUICK_SHAPES = 46, 3
FEWEST, MOST = 12, 400  # vertices of the shapes
ROUND_OFF = 1e-9  # distance in diagonals up to which cages are called equal
FLOOR = 3e-4  # added to both excesses of a ratio: below that the clearance decides
LOOSER = 1.01  # ratio of excesses from which a case is named
SLOWER, SLACK = 1.5, 0.02  # how many times as long a case may take, and how many seconds longer, before it is named
NAMED = 30  # most cases that are named


def simplified(fine: Mesh, count: int) -> Mesh:
    """A coarse mesh as a user would hand it in: by Douglas and Peucker, neither around the shape nor within it."""
    shape = shapely.geometry.shape(fine.__geo_interface__)
    low, high = 1e-6 * fine.diagonal, fine.diagonal
    best = shape.simplify(high)
    for _ in range(20):
        middle = (low * high) ** 0.5
        simple = shape.simplify(middle)
        if len(Mesh.from_geometry(simple).vertices) > count:
            low = middle
        else:
            high, best = middle, simple
    return Mesh.from_geometry(best)


def swayed(fine: Mesh) -> np.ndarray:
    """(4, n, 2): the shape sheared to one side."""
    middle = fine.vertices.mean(axis=0)
    offset = (fine.vertices - middle)[:, 1:] * [1.0, 0.0]
    return np.stack([fine.vertices + 0.1 * step * offset for step in range(4)])


def sized(name: str, fraction: float) -> Callable[[Mesh, int], object]:
    """A setting that is this fraction of the diagonal."""
    return lambda f, n: core.nested_cages(f, n, **{name: fraction * f.diagonal})


DetectSymmetry = getattr(core, "DetectSymmetry", None) or core.Found  # in trees of other commits
Request = Callable[[Mesh, int], object]
PLAIN: dict[str, Request] = {
    "plain": lambda f, n: core.nested_cages(f, n),
    "clearance": sized("clearance", 0.004),
    "twice as many": lambda f, n: core.nested_cages(f, 2 * n),
}
"""Requests that every shape gets."""
OTHERS: dict[str, Request] = {
    "two levels": lambda f, n: core.nested_cages(f, [3 * n, n]),
    "inside": lambda f, n: core.inner_cages(f, n),
    "least edge": sized("min_edge", 0.02),
    "grid": sized("grid", 0.01),
    "stored": lambda f, n: core.nested_cages(f, n, stored=np.float32),
    "convex": lambda f, n: core.nested_cages(f, n, convex=True),
    "symmetry": lambda f, n: core.nested_cages(f, n, symmetry=DetectSymmetry()),
    "one loop": lambda f, n: core.nested_cages(f, n, loops="one"),
    "within": lambda f, n: core.nested_cages(f, core.Within(distance=0.02 * f.diagonal)),
    "excess": lambda f, n: core.nested_cages(f, core.Within(excess=0.3)),
    "own mesh": lambda f, n: core.nested_cages(f, simplified(f, n)),
    "arc length": lambda f, n: core.nested_cages(f, n, decimation=core.ArcLength()),
    "outside": lambda f, n: core.nested_cages(f, n, decimation=core.LineCycles(on_curve=False)),
    "IPC": lambda f, n: core.nested_cages(f, n, contact=core.IPC()),
    "displacement": lambda f, n: core.nested_cages(f, n, energy=core.InitialDisplacement()),
    "pins": lambda f, n: core.nested_cages(f, n, pins=[0, len(f.vertices) // 2]),
    "weights": lambda f, n: core.nested_cages(f, n, weights=np.linspace(0.5, 2.0, len(f.vertices))),
    "moving": lambda f, n: core.animated_cages(f, swayed(f), n),
}
"""Each shape gets some of these in turn."""
EACH = 7
REQUESTS = {**PLAIN, **OTHERS}


def cases(shapes: int, first: int = 0) -> Iterator[tuple[str, str, list[np.ndarray], int]]:
    """(shape, request, loops, count)."""
    names, turn, seed, drawn = list(OTHERS), 0, FIRST_SEED + first, 0
    while drawn < shapes:
        seed += 1
        found = random_shape(seed)
        if found is None or not FEWEST <= len(found[1].vertices) <= MOST:
            continue
        drawn += 1
        kind, fine = found
        count = min(max(12, 4 * len(fine.loops)), len(fine.vertices))
        loops = [fine.vertices[loop] for loop in fine.loops]
        for name in (*PLAIN, *(names[(turn + place) % len(names)] for place in range(EACH))):
            yield f"{kind}-{seed}", name, loops, count
        turn += EACH


def outcome(name: str, loops: list[np.ndarray], count: int) -> dict[str, object]:
    """In a server: CPU seconds, and cage, excess and digest of all steps, or the code of the error."""
    fine = Mesh.from_loops(loops)
    forget()
    begin = time.process_time()
    try:
        levels = REQUESTS[name](fine, count).levels  # type: ignore[attr-defined]
    except core.NestedCagesError as error:
        return {"seconds": time.process_time() - begin, "code": error.code}
    seconds, digest = time.process_time() - begin, hashlib.sha256()
    for level in levels:
        steps = level.reinflation if hasattr(level, "reinflation") else level
        cage = level.cage.vertices if isinstance(level.cage, Mesh) else level.cage_steps[-1]
        for array in (cage, steps.cage_steps, steps.fine_steps):
            digest.update(np.ascontiguousarray(array).tobytes())
    excess = abs(Mesh(cage, levels[-1].cage.edges).area / fine.area - 1.0)
    return {"seconds": seconds, "code": "", "cage": cage, "excess": excess, "digest": digest.hexdigest()}


def same(now: np.ndarray, before: np.ndarray) -> bool:
    size = np.ptp(before, axis=0).max()
    return now.shape == before.shape and bool(np.abs(now - before).max() <= ROUND_OFF * size)


def judged(now: dict, before: dict) -> tuple[str, float]:
    """What became of a request, and the ratio of excesses (nan without two cages)."""
    if now["code"] or before["code"]:
        if now["code"] == before["code"]:
            return "same error", np.nan
        return ("lost" if not before["code"] else "found" if not now["code"] else "other error"), np.nan
    ratio = (now["excess"] + FLOOR) / (before["excess"] + FLOOR)
    if now["digest"] == before["digest"]:
        return "bit-equal", ratio
    if same(now["cage"], before["cage"]):
        return "equal cage", ratio
    return ("looser" if ratio > LOOSER else "tighter" if ratio < 1.0 / LOOSER else "within 1 %"), ratio


CLASSES = ("bit-equal", "equal cage", "within 1 %", "tighter", "looser", "same error", "other error", "found", "lost")


def run(options: Options) -> str:
    wanted = [case for case in cases(QUICK_SHAPES if options.quick else SHAPES, options.seed) if options.wants(case[1])]
    servers = {name: Server(tree, "golden:outcome") for name, tree in options.trees().items()}
    found: list[list[dict]] = []
    try:
        for _, name, loops, count in wanted:
            found.append([])
            for server in servers.values():
                try:
                    found[-1].append(server(name, loops, count))
                except ServerError as error:
                    found[-1].append({"seconds": np.nan, "code": f"raised: {error}"})
    finally:
        for server in servers.values():
            server.close()
    return compared(wanted, found, options.commit) if options.against else alone(wanted, found)


def alone(wanted: list, found: list[list[dict]]) -> str:
    rows = []
    for name in REQUESTS:
        answers = [answer for case, (answer,) in zip(wanted, found, strict=True) if case[1] == name]
        if answers:
            codes = Counter(answer["code"] for answer in answers if answer["code"])
            cages = [answer for answer in answers if not answer["code"]]
            excess = 100.0 * float(np.median([answer["excess"] for answer in cages])) if cages else None
            errors = ", ".join(f"{many} {code}" for code, many in codes.items())
            rows.append((name, len(answers), len(cages), excess, sum(a["seconds"] for a in answers), errors))
    return table(("request", "asked", "cages", "median excess %", "CPU s", "errors"), rows)


def compared(wanted: list, found: list[list[dict]], commit: str) -> str:
    counts: dict[str, Counter[str]] = {name: Counter() for name in REQUESTS}
    excess, seconds, named, slow, lost = [], [], [], [], False
    for (shape, name, _, _), (before, now) in zip(wanted, found, strict=True):
        verdict, ratio = judged(now, before)
        counts[name][verdict] += 1
        if np.isfinite(ratio):
            excess.append(ratio)
            seconds.append(now["seconds"] / before["seconds"])
            if now["seconds"] > SLOWER * before["seconds"] + SLACK:
                slow.append((seconds[-1], shape, name, before["seconds"], now["seconds"]))
        if verdict in ("lost", "other error", "found"):
            named.append((np.inf if verdict == "lost" else 1.0, shape, name, verdict, before["code"], now["code"]))
        elif verdict in ("looser", "tighter"):
            sizes = (f"{100.0 * answer['excess']:.4g} %" for answer in (before, now))
            named.append((ratio, shape, name, f"excess x {ratio:.4f}", *sizes))
        lost |= verdict == "lost"
    used = [verdict for verdict in CLASSES if any(verdict in count for count in counts.values())]
    rows = [(name, *(count[verdict] or "" for verdict in used)) for name, count in counts.items() if count]
    rows.append(("all", *(sum(count[verdict] for count in counts.values()) for verdict in used)))
    named.sort(key=lambda row: -row[0])
    worst = table(("shape", "request", "change", commit, "now"), [row[1:] for row in named[:NAMED]])
    more = f"\nand {len(named) - NAMED} more" if len(named) > NAMED else ""
    parts = [f"{len(wanted)} requests, now next to {commit}", table(("request", *used), rows), ""]
    parts += [f"excess   {ratios(excess, 4)}", f"CPU time {ratios(seconds)}"]
    parts += [f"{FAILED}: cages were lost"] if lost else []
    parts += [DETAILS, f"most changed\n{worst}{more}"] if named else []
    slow.sort(reverse=True)
    parts += [f"slower\n{table(('times', 'shape', 'request', commit, 'now'), slow)}"] if slow else []
    return "\n".join(parts)
