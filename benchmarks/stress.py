"""Random shapes that must all get certified cages, random requests over all settings, and an exact judge of results."""

from __future__ import annotations

import time
from collections import Counter
from fractions import Fraction
from typing import Any

import numpy as np

import nestedcages_core as core
from common import DETAILS, FAILED, Options, Server, ServerError, forget, parts, spread, table
from nestedcages_core import Mesh, NestedCagesError, animated_cages, check, inner_cages, nested_cages, verify_motion
from random_shapes import random_shape
from shapes import glyph

SHAPES, QUICK_SHAPES, LARGEST, PATIENCE = 1_000, 30, 1_500, 300.0
REQUESTS, QUICK_REQUESTS, FIRST_SEED = 2_000, 40, 4_500_000
MOST = 400.0  # largest multiple of the time of a plain cage that a request of at most 12 vertices a loop may take
SHOWN = 12
LEVELS, QUICK_LEVELS, MOTIONS, QUICK_MOTIONS, LARGEST_JUDGED = 1_000, 20, 40, 2, 250
MOST_REQUESTS = 5  # for each result that is wanted: most requests have one
FACES = [f"DejaVu {face}:{style}" for face in ("Sans", "Serif", "Sans Mono") for style in ("normal", "bold", "oblique")]
CHARACTERS = "aeghkmsxABDGKMQRSWX&@#%?$§ßæøåçñöüθφψβδξλωЖФЯШЮ359ÆŒ"
STARTS = ("LineCycles", "OnCurve", "ArcLength")  # decimations that cages start from


def run(options: Options) -> str:
    made = {"shapes": shapes, "requests": requests, "judged": judged_levels, "motions": judged_motions}
    return parts({name: make(options) for name, make in made.items() if options.wants(name)})


# shapes


def caged(seed: int) -> dict[str, Any] | None:
    """In a server: one to three levels around a random shape; None where the seed draws none of the right size."""
    drawn = random_shape(seed)
    if drawn is None or len(drawn[1].vertices) > LARGEST:
        return None
    (kind, fine), random = drawn, np.random.default_rng([seed, 1])
    fewest, most = 3 * len(fine.loops), max(3 * len(fine.loops), min(len(fine.vertices), 100))
    counts = {int(c) for c in random.integers(fewest, most + 1, random.integers(1, 4))}
    levels, start = sorted(counts, reverse=True), STARTS[random.integers(len(STARTS))]
    found = {"kind": kind, "asked": f"{len(fine.vertices)} in {levels} from {start}", "fault": ""}
    forget()
    begin = time.process_time()
    try:
        hierarchy = nested_cages(fine, levels, decimation=getattr(core, start)())
    except NestedCagesError as error:
        return {**found, "code": error.code, "seconds": time.process_time() - begin, "excess": np.nan}
    seconds = time.process_time() - begin
    fault = "; ".join(str(problem) for problem in check(fine, hierarchy).problems)
    for level in hierarchy.levels:
        way = level.reinflation
        if not verify_motion(level.cage, level.fine, way.cage_steps, way.fine_steps):
            fault += " the motion is not certified"
    excess = 100.0 * hierarchy.levels[0].report.excess
    return {**found, "code": "", "fault": fault, "seconds": seconds, "excess": excess}


def shapes(options: Options) -> str:
    wanted, lines, details = QUICK_SHAPES if options.quick else SHAPES, [], []
    for name, tree in options.trees().items():
        found: list[dict[str, Any]] = []
        seed = options.seed - 1
        with Server(tree, "stress:caged") as server:
            while len(found) < wanted:
                seed += 1
                try:
                    one = server(seed, patience=PATIENCE)
                except ServerError as error:  # a crash is a failure too
                    one = {"kind": "?", "asked": "", "code": "", "fault": str(error), "seconds": np.nan,
                           "excess": np.nan}  # fmt: skip
                if one is not None:
                    found.append({**one, "seed": seed})
        codes = Counter(one["code"] for one in found if one["code"])
        wrong = [one for one in found if one["fault"]]
        lines.append(
            f"{name}: {len(found) - len(wrong) - codes.total()} of {len(found)} certified, errors {dict(codes)}, "
            f"CPU seconds {spread([one['seconds'] for one in found])}"
        )
        lines += [f"{FAILED}: seed {one['seed']}, {one['asked']}: {one['fault']}" for one in wrong]
        for kind in sorted({one["kind"] for one in found}):
            ones = [one for one in found if one["kind"] == kind]
            seconds, excess = ([one[key] for one in ones] for key in ("seconds", "excess"))
            told = spread(seconds), f"{max(seconds):.2f}", spread(excess, 1)
            details.append((kind, name, len(ones), sum(bool(one["code"]) for one in ones), *told))
    heads = ("kind", "of", "cases", "errors", "CPU s (10 … 90 %)", "slowest", "excess % (10 … 90 %)")
    return "\n".join([*lines, DETAILS, table(heads, details)])


# requests


def small(random: np.random.Generator) -> Mesh:
    """A random shape with few vertices a loop."""
    while True:
        drawn = random_shape(int(random.integers(1 << 30)))
        if drawn is not None and len(drawn[1].vertices) <= 12 * len(drawn[1].loops):
            return drawn[1]


def settings(random: np.random.Generator, fine: Mesh) -> dict[str, Any]:
    """Up to three settings at random values."""
    size, pick = float(np.ptp(fine.vertices, axis=0).max()), random.choice
    low, high = fine.vertices.min(axis=0) - 0.01 * size, fine.vertices.max(axis=0) + 0.01 * size
    options: dict[str, Any] = {
        "clearance": size * 10.0 ** random.uniform(-8.0, 0.0),
        "grid": size * 10.0 ** random.uniform(-4.0, 0.0),
        "stored": str(pick(["float32", "float16"])),
        "symmetry": [core.DetectSymmetry(), core.Mirror(None, (1.0, 0.0)), core.Rotation(None, int(pick([2, 3, 6])))][
            pick(3)
        ],
        "convex": True,
        "loops": str(pick(["keep", "one"])),
        "constraints": [
            [
                core.LeastEdge(size * 10.0 ** random.uniform(-2.0, 0.0)),
                core.LeastAngle(float(random.uniform(5.0, 60.0))),
                core.Box(tuple(low), tuple(high)),
            ][pick(3)]
        ],
        "weights": np.where(fine.vertices[:, 0] > fine.vertices[:, 0].mean(), 100.0, 1.0),
    }
    names = pick(list(options), size=int(random.integers(0, 4)), replace=False).tolist()
    return {name: options[name] for name in names}


def request(random: np.random.Generator, fine: Mesh, most: int | None = None) -> tuple[Any, list[Any], dict[str, Any]]:
    """A function, its levels and its settings."""
    given = settings(random, fine)
    most = 2 * len(fine.vertices) + 3 if most is None else most
    size, count = float(np.ptp(fine.vertices, axis=0).max()), int(random.integers(3, most))
    limit = 10.0 ** random.uniform(-3.0, 0.5)
    levels = [[count], [count, max(3, count // 2)], [core.Within(excess=limit)], [core.Within(distance=limit * size)]]
    which = levels[int(random.choice(len(levels), p=[0.6, 0.2, 0.1, 0.1]))]
    return inner_cages if random.random() < 0.15 else nested_cages, which, given


def in_words(make: Any, fine: Mesh, which: list[Any], given: dict[str, Any]) -> str:
    words = ", ".join([*map(str, which), *(f"{key}={value!r:.40}" for key, value in given.items())])
    return f"{make.__name__}({'+'.join(str(len(each)) for each in fine.loops)}: {words})"


def asked(seed: int) -> tuple[float, str, str]:
    """In a server: CPU seconds of a random request, what it was, and how it ended."""
    random = np.random.default_rng(seed)
    fine = small(random)
    make, which, given = request(random, fine)
    what = in_words(make, fine, which, given)
    forget()
    begin, end = time.process_time(), "made"
    try:
        make(fine, which, **given)
    except NestedCagesError as error:
        end = error.code or f"{FAILED}: an error without a code"
    except Exception as error:  # what no request may end with
        end = f"{FAILED}: {type(error).__name__}: {error}"
    return time.process_time() - begin, what, end


def plain() -> float:
    """In a server: CPU seconds of a plain cage."""
    wheel = Mesh.from_loops([[(np.cos(t), np.sin(t)) for t in np.linspace(0.0, 6.0, 30)]])
    found = []
    for _ in range(20):
        forget()
        begin = time.process_time()
        nested_cages(wheel, [8])
        found.append(time.process_time() - begin)
    return float(np.median(found))


def requests(options: Options) -> str:
    lines, details = [], []
    seeds = range(
        FIRST_SEED + options.seed, FIRST_SEED + options.seed + (QUICK_REQUESTS if options.quick else REQUESTS)
    )
    for name, tree in options.trees().items():
        with Server(tree, "stress:plain") as server:
            unit = server()
        found: list[tuple[float, str, int, str]] = []
        with Server(tree, "stress:asked") as server:
            for seed in seeds:
                try:
                    seconds, what, end = server(seed, patience=4.0 * MOST * unit)
                except ServerError as error:
                    seconds, what, end = np.inf, "?", f"{FAILED}: {error}"
                found.append((seconds / unit, end, seed, what))
        found.sort(reverse=True)
        multiples = np.array([ratio for ratio, *_ in found])
        ends = Counter(end for _, end, *_ in found)
        lines.append(
            f"{name}: {len(found)} requests take {np.median(multiples):.1f} plain cages in the median, "
            f"{np.quantile(multiples, 0.99):.0f} in 99 of 100, {multiples.max():.0f} at most; {ends['made']} made"
        )
        lines += [f"{FAILED}: more than {MOST:.0f}"] if multiples.max() > MOST else []
        lines += [f"seed {seed}: {end}: {what}" for _, end, seed, what in found if end.startswith(FAILED)]
        details += [(f"{ratio:.1f}", name, seed, end, what) for ratio, end, seed, what in found[:SHOWN]]
    return "\n".join([*lines, DETAILS, table(("plain cages", "of", "seed", "ended", "request"), details)])


# an exact judge


def drawing(random: np.random.Generator, largest: int = LARGEST_JUDGED) -> Mesh:
    """A letter or a random shape."""
    while True:
        if random.random() < 0.4:
            face, style = str(random.choice(FACES)).split(":")
            letter = str(random.choice(list(CHARACTERS)))
            try:
                fine = glyph(letter, int(random.integers(2, 9)), face, style)
            except NestedCagesError:  # overlapping strokes
                continue
        else:
            drawn = random_shape(int(random.integers(1 << 30)))
            if drawn is None:
                continue
            fine = drawn[1]
        if len(fine.vertices) <= largest:
            return fine


def judged(seed: int) -> tuple[int, str, str, str]:
    """In a server: the levels of a random request, the code of its error, its fault, and what it was."""
    random = np.random.default_rng([seed, 2])
    fine = drawing(random)
    make, which, given = request(random, fine, max(20, len(fine.vertices) // 2))
    what = in_words(make, fine, which, given)
    try:
        made = make(fine, which, **given)
    except NestedCagesError as error:
        made, code = error.partial, error.code or f"{FAILED}: an error without a code"
    else:
        code = ""
    if not made:
        return 0, code, "", what
    symmetry = given.get("symmetry")
    found = check(
        fine,
        made,
        given.get("clearance"),
        grid=given.get("grid"),
        symmetry=None if isinstance(symmetry, core.DetectSymmetry) or "stored" in given else symmetry,
        distance=getattr(which[0], "distance", None),
    )
    faults = [*map(str, found.problems)]
    for level in made:
        faults += wishes_missed(fine, level, which, given)
    return len(made), code, "; ".join(faults), what


def wishes_missed(fine: Mesh, level: Any, which: list[Any], given: dict[str, Any]) -> list[str]:
    """What a level does not keep though no note says so."""
    cage, codes = level.cage, {note.code for note in level.report.notes}
    faults, rings = [], [cage.vertices[loop] for loop in cage.loops]
    numbers = [each for each in which if isinstance(each, int)]
    count = max(map(len, rings)) if given.get("convex") else len(cage.vertices)
    if numbers and count > max(numbers) and "note.count" not in codes:
        faults.append(f"{count} vertices")
    limit = getattr(which[0], "excess", None)
    if limit is not None and abs(cage.area / fine.area - 1.0) > limit:
        faults.append(f"an excess of {cage.area / fine.area - 1.0:.6g}")
    if given.get("convex") and not level.inside and not all(map(turns_left, rings)):
        faults.append("not convex")
    if given.get("loops") == "one" and numbers and not level.inside and len(rings) > 1:
        faults.append(f"{len(rings)} loops")
    for constraint in given.get("constraints", ()):
        if isinstance(constraint, core.Box):
            low, high = np.array(constraint.low), np.array(constraint.high)
            if not ((cage.vertices >= low) & (cage.vertices <= high)).all():
                faults.append("outside of the box")
        shortest = constraint.length * (1.0 - 1e-9) if isinstance(constraint, core.LeastEdge) else 0.0
        if cage.edge_lengths.min() < shortest and "edge.short" not in codes:
            faults.append(f"an edge of {cage.edge_lengths.min():.6g}")
    return faults


def turns_left(ring: np.ndarray) -> bool:
    """Whether a ring turns left at each vertex, or not at all, by fractions."""
    points = [(Fraction(x), Fraction(y)) for x, y in ring.tolist()]
    triples = zip(points, points[1:] + points[:1], points[2:] + points[:2], strict=True)
    return all((b[0] - a[0]) * (c[1] - b[1]) >= (b[1] - a[1]) * (c[0] - b[0]) for a, b, c in triples)


def judged_motion(seed: int) -> tuple[int, str, str, str]:
    """In a server: the keys of cages that follow a random motion, and so on."""
    random = np.random.default_rng([seed, 3])
    fine = drawing(random, 120)
    middle, size = fine.vertices.mean(axis=0), float(np.ptp(fine.vertices, axis=0).max())
    bend, grow, drift = random.uniform(-1.0, 1.0, (3, 2)) * [[1.5], [0.3], [0.5]]
    poses = []
    for phase in np.linspace(0.0, 1.0, int(random.integers(3, 9))):
        x, y = ((fine.vertices - middle) / size * np.exp(phase * grow)).T
        angle = phase * (bend[0] + bend[1] * y)
        turned = np.stack([np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y], axis=1)
        poses.append(middle + size * (turned + phase * drift))
    loops = 3 * len(fine.loops)
    counts = [max(loops, int(random.integers(loops, 40)))]
    counts += [max(loops, counts[0] // 2)] if random.random() < 0.4 else []
    given: dict[str, Any] = [{}, {"clearance": 1e-3 * size}, {"stored": "float32"}, {"loops": "keep"}][
        int(random.integers(4))
    ]
    what = in_words(animated_cages, fine, counts, given)
    try:
        made = animated_cages(fine, poses, counts, cyclic=bool(random.random() < 0.3), **given)
    except NestedCagesError as error:
        return 0, error.code or f"{FAILED}: an error without a code", "", what
    alike = None if given.get("loops") == "keep" else False  # parts may share a loop
    fault = "; ".join(map(str, check(fine, made, given.get("clearance"), same_loops=alike).problems))
    return sum(len(level.times) for level in made.levels), "", fault, what


def judged_levels(options: Options) -> str:
    return told_of(options, "judged", "levels", QUICK_LEVELS if options.quick else LEVELS)


def judged_motions(options: Options) -> str:
    return told_of(options, "judged_motion", "motions", QUICK_MOTIONS if options.quick else MOTIONS)


def told_of(options: Options, function: str, what: str, wanted: int) -> str:
    """How many results of random requests an exact judge has looked at, and what is wrong with them."""
    lines, details = [], []
    for name, tree in options.trees().items():
        judged, requests, results, codes = 0, 0, 0, Counter[str]()
        wrong = []
        with Server(tree, f"stress:{function}") as server:
            while (results if what == "motions" else judged) < wanted and requests < MOST_REQUESTS * wanted:
                seed = options.seed + requests
                requests += 1
                try:
                    number, code, fault, request = server(seed, patience=PATIENCE)
                except ServerError as error:  # a crash is a fault too
                    number, code, fault, request = 0, "", str(error), "?"
                judged, results = judged + number, results + (number > 0)
                codes.update([code] if code else [])
                wrong += [f"{FAILED}: seed {seed}: {request}: {fault}"] if fault or FAILED in code else []
        pieces = "keys" if what == "motions" else "levels"
        lines.append(f"{name}: {judged} {pieces} of {requests} requests judged in exact arithmetic: {len(wrong)} wrong")
        details.append((name, requests, results, codes.total(), ", ".join(f"{k} {v}" for k, v in codes.most_common())))
        lines += wrong
    return "\n".join([*lines, DETAILS, table(("of", "requests", "results", "errors", "codes"), details)])
