"""Cages with options: within a distance, inside, on grids, convex, symmetric, and with constraints."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from itertools import combinations, count

import numpy as np
import shapely

import nestedcages_core as core
from bound import lower_bound
from common import DETAILS, FAILED, Options, forget, parts, table
from nestedcages_core import Mesh, NestedCagesError, Within, inner_cages, nested_cages, verify
from peers import corners, polygon_hull, solid
from random_shapes import random_shape
from shapes import drawn, ring


def run(options: Options) -> str:
    made = {"within": within, "inner": inner, "grids": grids, "convex": convex,
            "symmetry": symmetry, "constraints": constraints}  # fmt: skip
    return parts({name: make(options) for name, make in made.items() if options.wants(name)})


def timed(make: Callable[[], object]) -> tuple[object, float]:
    """What was made, or None where that is an error, and CPU seconds."""
    forget()
    begin = time.process_time()
    try:
        made = make()
    except NestedCagesError:
        made = None
    return made, time.process_time() - begin


def told(summary: str, heads: tuple[str, ...], rows: list, wrong: int) -> str:
    """A sentence, what is wrong, and the rows."""
    return f"{summary}{f'{chr(10)}{FAILED}: {wrong}' if wrong else ''}\n{DETAILS}\n{table(heads, rows)}"


# within a distance

DISTANCES = (0.1, 0.03, 0.01, 0.003)
"""In diagonals."""


def within(options: Options) -> str:
    """Vertices next to the lower bound, and to two recipes at the same tolerance."""
    rows, close, far, wrong = [], 0, 0, 0
    for name, fine in drawn(options.quick).items():
        shape = solid(fine)
        for part in DISTANCES:
            distance = part * fine.diagonal
            made, seconds = timed(lambda d=distance, f=fine: nested_cages(f, [Within(distance=d)])[0])
            half = 0.5 * distance
            recipes = (
                shape.buffer(half, join_style="mitre").simplify(half, preserve_topology=True),
                shape.buffer(half, quad_segs=64).simplify(half, preserve_topology=False),
            )
            others = [recipe_said(fine, shape, result, distance) for result in recipes]
            if made is None:
                rows.append((name, part, None, "none", None, *others, f"{seconds:.2f}"))
                continue
            most, fewest = len(made.cage.vertices), made.report.fewest
            wrong += not verify(made.cage, fine, made.report.wanted_clearance).holds
            close, far = close + (most - fewest <= len(fine.loops)), max(far, most - fewest)
            rows.append((name, part, fewest, most, f"{100 * made.report.excess:.2f}", *others, f"{seconds:.2f}"))
    summary = f"{close} of {len(rows)} are within one vertex per loop of the bound; the largest difference is {far}."
    heads = ("shape", "distance", "bound", "ours", "excess %", "buffer, simplify", "offset, Douglas-Peucker", "CPU s")
    return told(summary, heads, rows, wrong)


def recipe_said(fine: Mesh, shape: shapely.Geometry, result: shapely.Geometry, distance: float) -> str:
    """Vertices of a recipe's result, and what it does not keep."""
    wrong = [] if result.is_valid and result.covers(shape) else ["leaks"]
    wrong += [] if shape.buffer(distance * (1.0 + 1e-4), quad_segs=256).covers(result) else ["too far"]
    wrong += [] if len(shapely.get_rings(shapely.get_parts(result))) == len(fine.loops) else ["other loops"]
    return ", ".join([str(corners(result)), *wrong])


# inside

COUNTS = (16, 32, 64)
CLEARANCE_POINTS = 0.03
"""Added to both losses of a ratio: what the clearance costs; GEOS's hulls touch the shape."""


def inner(options: Options) -> str:
    """Area lost by cages inside, next to GEOS's inner hulls with as many vertices."""
    rows, found, wrong = [], [], 0
    for name, fine in drawn(options.quick).items():
        for most in COUNTS:
            made, seconds = timed(lambda f=fine, n=most: inner_cages(f, n)[0])
            wrong += made is not None and not verify(fine, made.cage, made.report.wanted_clearance).holds
            lost = None if made is None else f"{-100 * made.report.excess:.2f}"
            peer, alike = polygon_hull(fine, most, inside=True), None
            if peer is not None:
                again, _ = timed(lambda f=fine, n=peer.vertices: inner_cages(f, n)[0])
                alike = None if again is None else -100 * again.report.excess
            if alike is not None:
                found.append((alike + CLEARANCE_POINTS) / (CLEARANCE_POINTS - peer.excess))
            cells = (None,) * 3 if peer is None else (peer.vertices, f"{-peer.excess:.2f}", peer.verdict)
            rows.append((name, most, lost, *cells, None if alike is None else f"{alike:.2f}", f"{seconds:.2f}"))
    summary = (
        f"With as many vertices, ours lose {np.median(found):.2f} times the area of GEOS's polygon hulls, in the "
        f"median of {len(found)}, and at most {max(found):.2f} times."
    )
    heads = ("shape", "asked", "lost %", "GEOS", "lost %", "verdict", "ours, as many", "CPU s")
    return told(summary, heads, rows, wrong)


# grids

GRIDS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""In diagonals, rounded to one digit, as people write them."""


def grids(options: Options) -> str:
    """Excess on grids next to that of a free cage."""
    rows, found, wrong = [], 0, 0
    for name, fine in drawn(options.quick).items():
        for most in COUNTS:
            free, seconds = timed(lambda f=fine, n=most: nested_cages(f, n)[0])
            cells, spent = [], 0.0
            for part in GRIDS:
                spacing = float(f"{part * fine.diagonal:.0e}")
                made, took = timed(lambda f=fine, n=most, s=spacing: nested_cages(f, n, grid=s)[0])
                spent += took
                cells.append("none" if made is None else f"{100 * made.report.excess:.2f}")
                if made is not None:
                    found += 1
                    steps = made.cage.vertices / spacing
                    on = np.abs(steps - np.rint(steps)).max() <= 1e-9 * np.abs(steps).max()
                    wrong += not (verify(made.cage, fine, made.report.wanted_clearance).holds and on)
            rows.append((name, most, f"{100 * free.report.excess:.2f}", *cells, f"{seconds:.2f}",
                         f"{spent / len(GRIDS):.2f}"))  # fmt: skip
    summary = f"Cages were found on {found} of {len(GRIDS) * len(rows)} grids."
    heads = ("shape", "cage", "free %", *map(str, GRIDS), "CPU s", "on grids")
    return told(summary, heads, rows, wrong)


# convex

CONVEX_COUNTS = (3, 4, 5, 6, 8, 12)


def convex(options: Options) -> str:
    """Area beyond the convex hull's, and in brackets how far it is at most above the optimum."""
    rows, above, wrong = [], [], 0
    for name, fine in drawn(options.quick).items():
        hull = Mesh.from_geometry(shapely.MultiPoint(fine.vertices).convex_hull.simplify(1e-9 * fine.diagonal))
        cells = []
        for most in CONVEX_COUNTS:
            if most >= len(hull.vertices):
                cells.append(None)
                continue
            made, _ = timed(lambda f=fine, n=most: nested_cages(f, n, convex=True, clearance=1e-6 * f.diagonal)[0])
            wrong += not verify(made.cage, fine, 1e-6 * fine.diagonal, same_loops=False).holds
            area = made.cage.area
            above.append(100 * (area / lower_bound(hull, most, area, target=1e-4, seconds=5.0).area - 1.0))
            cells.append(f"{100 * (area / hull.area - 1.0):.2f} ({above[-1]:.2f})")
        rows.append((name, len(hull.vertices), *cells))
    summary = (
        f"{sum(x <= 0.02 for x in above)} of {len(above)} are at most 0.02 % above the optimum, all at most "
        f"{max(above):.2f} %, by the lower bound."
    )
    heads = ("shape", "hull", *(f"{most} vertices" for most in CONVEX_COUNTS))
    return told(summary, heads, rows, wrong)


# symmetry


def symmetry(options: Options) -> str:
    """Symmetric cages next to free ones, around shapes that are united with their images."""
    rows, found, wrong = [], [], 0
    for name, drawing in drawn(options.quick).items():
        low, high = drawing.vertices.min(axis=0), drawing.vertices.max(axis=0)
        shape = shapely.affinity.translate(solid(drawing), *(-0.5 * (low + high)))
        turn = [shapely.affinity.rotate(shape, 120.0 * k, origin=(0.0, 0.0)) for k in range(3)]
        flipped = shapely.affinity.scale(shape, -1.0, 1.0, origin=(0.0, 0.0))
        for kind, images, settings in (
            ("mirror", [shape, flipped], core.Mirror((0.0, 0.0), (0.0, 1.0))),
            ("order 3", turn, core.Rotation((0.0, 0.0), 3)),
        ):
            try:
                fine = Mesh.from_geometry(shapely.union_all(images))
            except NestedCagesError:
                continue
            cells = []
            for most in (12, 18, 36, 60):
                free, _ = timed(lambda f=fine, n=most: nested_cages(f, n)[0])
                made, _ = timed(lambda f=fine, n=most, s=settings: nested_cages(f, n, symmetry=s)[0])
                if free is None or made is None:
                    cells.append(None)
                    continue
                image = settings.image(made.cage.vertices, 1)
                alike = np.hypot(*(image[:, None] - made.cage.vertices[None]).transpose(2, 0, 1)).min(axis=1).max()
                wrong += alike > 1e-9 * fine.diagonal or not verify(made.cage, fine, same_loops=False).holds
                found.append(made.report.excess / free.report.excess)
                cells.append(f"{100 * free.report.excess:.2f} / {100 * made.report.excess:.2f}")
            rows.append((name, kind, *cells))
    ratio = np.array(found)
    summary = (
        f"In {(ratio <= 1.03).sum()} of {len(ratio)} the symmetric cage has at most 1.03 times the excess of the free "
        f"one, in {(ratio < 1.0).sum()} less; the median is {np.median(ratio):.3f} times, the most {ratio.max():.2f}."
    )
    return told(summary, ("shape", "free / symmetric %", *(f"{n} vertices" for n in (12, 18, 36, 60))), rows, wrong)


# constraints

CASES, QUICK_CASES = 30, 2
MAKERS: dict[str, Callable[[Mesh, int], object]] = {
    "box": lambda f, _: core.Box(tuple(f.vertices.min(axis=0) - 0.006 * f.diagonal),
                                 tuple(f.vertices.max(axis=0) + 0.006 * f.diagonal)),
    "loops": lambda f, _: core.LoopClearance(outer=0.001 * f.diagonal, holes=0.003 * f.diagonal),
    "axes": lambda *_: core.AxisAligned(),
    "transit": lambda *_: core.AxisAligned((0.0, 45.0, 90.0, 135.0)),
    "edge": lambda f, n: core.LeastEdge(0.25 * float(f.edge_lengths.sum()) / n),
    "angle": lambda *_: core.LeastAngle(30.0),
    "obstacle": lambda f, _: obstacle(f),
}  # fmt: skip


def obstacle(fine: Mesh) -> object:
    """An octagon right of the rightmost vertex."""
    at = fine.vertices[int(np.argmax(fine.vertices[:, 0]))] + [0.028 * fine.diagonal, 0.0]
    return core.Outside(Mesh.from_loops([at + ring(8, 0.02 * fine.diagonal)]), 0.002 * fine.diagonal)


def constraints(options: Options) -> str:
    """Alone and in pairs, around random shapes and inside: kept, or the codes of the errors."""
    several = [*((name,) for name in MAKERS), *(p for p in combinations(MAKERS, 2) if set(p) != {"axes", "transit"})]
    shapes: list[tuple[Mesh, int]] = []
    for seed in count(options.seed + 1):
        drawing = random_shape(seed)
        if drawing is not None and 30 <= len(drawing[1].vertices) <= 300 and len(drawing[1].loops) <= 3:
            most = max(16, 6 * len(drawing[1].loops))
            shapes += [(drawing[1], most)] if most <= 0.6 * len(drawing[1].vertices) else []
        if len(shapes) == (QUICK_CASES if options.quick else CASES):
            break
    rows, total = [], Counter[str]()
    for names in several[: 8 if options.quick else None]:
        for side, make in (("around", nested_cages), ("inside", inner_cages)):
            found: Counter[str] = Counter()
            for fine, most in shapes:
                wanted = [MAKERS[name](fine, most) for name in names]
                try:
                    cage = make(fine, most, constraints=wanted)[0].cage
                except NestedCagesError as error:
                    found[error.code or "WRONG"] += 1
                    continue
                outer, inside = (cage, fine) if side == "around" else (fine, cage)
                good = verify(outer, inside, same_loops=False).holds
                found["kept" if good and all(one.fault(cage, fine) is None for one in wanted) else "WRONG"] += 1
            total += found
            others = ", ".join(f"{code} {many}" for code, many in found.most_common() if code != "kept")
            rows.append((" + ".join(names), side, found["kept"], len(shapes), others))
    summary = f"{total['kept']} of {total.total()} requests are kept, the others are errors with a code."
    return told(summary, ("constraints", "", "kept", "of", "errors"), rows, total["WRONG"])
