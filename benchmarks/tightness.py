"""Excess next to the best on record, to what others make of the same shapes, and to a proven lower bound."""

from __future__ import annotations

import csv
import time
from collections.abc import Iterable, Iterator
from itertools import combinations, count, islice

import numpy as np
import shapely

from bound import Bound, lower_bound
from common import DETAILS, FAILED, Options, forget, parts, ratios, table
from nestedcages_core import Mesh, nested_cages, verify
from peers import PEERS, Peer, shortcut_hull, solid
from random_shapes import random_shape
from shapes import DATA, drawn, held_out, ring

COUNTS = (16, 32, 64)
CLEARANCE = 0.03  # points of excess that the clearance may cost: the records were set without one
NEGLIGIBLE = 0.01  # records below this many per cent count as this: a ratio to nothing says nothing
FEWEST, MOST = 60, 1000  # vertices of the outlines that are bounded
OUTLINES, QUICK_OUTLINES, SECONDS, TARGET = 30, 2, 30.0, 0.01
"""Outlines of each source; CPU seconds of a bound, and x at which its search ends."""
GROUPS = (
    *(("held out", low, high) for low, high in ((60, 150), (150, 300), (300, 1001), (60, 1001))),
    ("random", 60, 1001),
)


def run(options: Options) -> str:
    made = {"records": records, "peers": peers, "bound": bounds}
    return parts({name: make(options) for name, make in made.items() if options.wants(name)})


def caged(fine: Mesh, most: int) -> tuple[float, float, float, bool]:
    """Area, excess in per cent and CPU seconds of a cage, and whether it is certified when looked at again."""
    forget()
    begin = time.process_time()
    level = nested_cages(fine, [most])[0]
    seconds = time.process_time() - begin
    good = verify(level.cage, fine, level.report.wanted_clearance).holds
    return level.cage.area, 100.0 * (level.cage.area / fine.area - 1.0), seconds, good


def records(options: Options) -> str:
    """Ours next to the least excess that other programs and prototypes reached, measured once."""
    with (DATA / "records.csv").open(newline="", encoding="utf-8") as file:
        known = {
            (row["shape"], int(row["cage_vertices"])): float(row["excess_percent"]) for row in csv.DictReader(file)
        }
    rows, found, good = [], [], True
    for name, fine in drawn(options.quick).items():
        for most in COUNTS:
            _, excess, seconds, certified = caged(fine, most)
            record, good = known[name, most], good and certified
            found.append(max(excess - CLEARANCE, NEGLIGIBLE) / max(record, NEGLIGIBLE))
            rows.append((name, len(fine.vertices), most, f"{excess:.3f}", f"{record:.3f}", f"{found[-1]:.3f}", seconds))
    summary = f"excess to the best on record: {ratios(found)}"
    lines = table(("shape", "points", "cage", "excess %", "record %", "ratio", "CPU s"), rows)
    return "\n".join([summary, *([] if good else [f"{FAILED}: not certified"]), DETAILS, lines])


def peers(options: Options) -> str:
    rows = []
    for name, fine in drawn(options.quick).items():
        for most in COUNTS[1:]:
            _, excess, seconds, _ = caged(fine, most)
            cells = [said(Peer(seconds, excess, most, "certified"), most)]
            rows.append(
                (name, f"{len(fine.vertices)} in {most}", *cells, *(said(f(fine, most), most) for f in PEERS.values()))
            )
    return "excess %, CPU seconds, and what is wrong\n" + table(("shape", "points", "ours", *PEERS), rows)


def said(peer: Peer | None, most: int) -> str:
    if peer is None:
        return "none"
    wrong = [] if peer.verdict == "certified" else [peer.verdict]
    wrong += [f"{peer.vertices} vertices"] if peer.vertices > most else []
    return ", ".join([f"{peer.excess:.2f} %", f"{peer.seconds:.2f} s", *wrong])


def bounds(options: Options) -> str:
    """x = area of our cage / bound - 1: how far it is at most above the optimum."""
    number = QUICK_OUTLINES if options.quick else OUTLINES
    random = (found for k in count(options.seed) if (found := random_shape(k)))
    rows: list[tuple[str, str, Mesh, int, float, Bound]] = []
    for kind, source in (("held out", held_out()), ("random", random)):
        for place, (name, fine) in enumerate(islice(outlines(source), number)):
            most = (8, 16, 24, 32)[place % 4]
            area = caged(fine, most)[0]
            found = lower_bound(fine, most, area, target=TARGET, seconds=SECONDS / 10 if options.quick else SECONDS)
            rows.append((kind, name, fine, most, 100.0 * (area / found.area - 1.0), found))
    groups = []
    for kind, low, high in GROUPS:
        mine = [row for row in rows if row[0] == kind and low <= len(row[2].vertices) < high]
        if mine:
            x, seconds = np.array([row[4] for row in mine]), [row[5].seconds for row in mine]
            groups.append((kind, f"{low} to {high - 1}", len(mine), f"{np.median(x):.2f} %", (x <= 1.0001).sum(),
                           (x <= 2.0).sum(), f"{x.max():.1f} %", f"{np.median(seconds):.1f}"))  # fmt: skip
    heads = ("outlines", "points", "cages", "x, median", "at most 1 %", "at most 2 %", "largest x", "s, median")
    lines = [(name, len(fine.vertices), most, f"{x:.3f}", found.rounds, f"{found.seconds:.2f}")
             for _, name, fine, most, x, found in rows]  # fmt: skip
    details = table(("outline", "points", "cage", "x %", "rounds", "s"), lines)
    return f"{table(heads, groups)}\n{DETAILS}\n{details}"


def outlines(source: Iterable[tuple[str, Mesh]]) -> Iterator[tuple[str, Mesh]]:
    """The largest loop of each shape, if it has the right number of vertices."""
    for name, mesh in source:
        loops = [mesh.vertices[loop] for loop in mesh.loops]
        largest = max(loops, key=lambda loop: shapely.Polygon(loop).area)
        if FEWEST <= len(largest) <= MOST:
            yield name, Mesh.from_loops([largest])


def check(options: Options) -> str:
    """The bound at an optimum in closed form and below a cage; shortcut hulls next to all choices of vertices."""
    tops = 4.0 * np.cos(np.pi / 12) ** 2  # a square around a 12-gon, flush with four of its edges
    found = lower_bound(Mesh.from_loops([ring(12)]), 4, tops, target=1e-3)
    star = Mesh.from_loops([np.tile([1.0, 0.6, 0.9, 0.7], 3)[:, None] * ring(12)])
    area = caged(star, 6)[0]
    below = lower_bound(star, 6, area, target=-0.02, seconds=0.3)  # asks for more than there can be
    loop = np.tile([1.0, 0.5], 4)[:, None] * ring(8)
    shape = Mesh.from_loops([loop])
    choices = (shapely.Polygon(loop[list(places)]) for places in combinations(range(8), 6))
    least = min(hull.area for hull in choices if hull.is_valid and hull.covers(solid(shape)))
    hull = shortcut_hull(shape, 6, solid(shape))
    tests = {
        "the bound reaches an optimum in closed form": found.proven and abs(found.area * 1.001 / tops - 1.0) < 1e-9,
        "the bound stays below a cage": not below.proven and 0.95 * area < below.area < area,
        "the shortcut hull is the best of all choices": hull is not None and abs(hull.area / least - 1.0) < 1e-12,
    }
    return table(("check", ""), [(name, "good" if good else FAILED) for name, good in tests.items()])
