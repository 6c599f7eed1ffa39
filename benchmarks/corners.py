"""The requests that could be slow, compared with the default one and with other commits, in the same run.

    python benchmarks/corners.py --against bb3b310 837f1d56
    python benchmarks/corners.py --only within loops --patience 60

Each commit runs in a process of its own, with everything forgotten before each timing. CPU seconds, the least of the
repeats; the ratios are those to the other commits, and to the case a line is compared with. A case that takes longer
than the patience is given up. Exit status 1 if a case of this commit fails.
"""

from __future__ import annotations

import argparse
import sys
from contextlib import ExitStack
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from clone import ROOT
from speed import Worker, checkout, forgetting

SHAPES = """
import sys
import numpy as np
from nestedcages_core import *
import nestedcages_core as core

def loop(n, x=0.0, y=0.0, r=1.0, waves=59):
    random, angle = np.random.default_rng(0), 2.0 * np.pi * np.arange(n) / n
    radius = np.ones(n)
    for k in range(2, waves + 1):
        radius += 0.35 * random.standard_normal() / k**1.1 * np.cos(k * angle + 2.0 * np.pi * random.random())
    return np.column_stack([x + r * radius * np.cos(angle), y + r * radius * np.sin(angle)])

def blob(n): return Mesh.from_loops([loop(n)])

def islands(k):
    side = int(np.ceil(k**0.5))
    return Mesh.from_loops([loop(24, 4.0 * (j % side), 4.0 * (j // side), waves=5) for j in range(k)])

def pulled(n):
    angle = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    radius = 1.6 + 0.4 * np.cos(6.0 * angle)
    fine = Mesh.from_loops([radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])])
    return fine, np.exp(-(((angle - 0.5) / 0.2) ** 2))[:, None] * 1.6 * np.array([0.005, 0.011])

def circles(n):
    angle = 2.0 * np.pi * np.arange(32) / 32
    place = np.random.default_rng(0).uniform(0.0, 1.0, (n, 2))
    ring = 0.02 * np.column_stack([np.cos(angle), np.sin(angle)])
    return '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1">' + "".join(
        f'<circle cx="{x:.5f}" cy="{y:.5f}" r="0.02"/>' for x, y in place) + "</svg>"

def strokes(seed):
    import shapely
    t, ends = np.linspace(0.0, 1.0, 40)[:, None], np.random.default_rng(seed).normal(size=(4, 2, 2))
    lines = [shapely.LineString(2.0 * t * (1.0 - t) * a + t**2 * b) for a, b in ends]  # from the origin
    joined = shapely.union_all([line.buffer(0.1) for line in lines])
    return Mesh.from_loops([np.array(joined.exterior.coords)[:-1]])

sizes = iter(1.01 ** np.arange(1000.0))  # of the drawings that are bound, so that nothing is remembered

def with_cages(n):
    global bpy
    size = next(sizes)
    if "bpy" not in sys.modules:
        import bpy
        sys.path.insert(0, "benchmarks")
        from binding import extension
        extension().register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for k in range(n):
        data = bpy.data.curves.new(f"Drawing {k}", "CURVE")
        spline, points = data.splines.new("POLY"), loop(24, 4.0 * (k % 10), 4.0 * (k // 10), size, waves=5)
        spline.points.add(len(points) - 1)
        spline.points.foreach_set("co", np.column_stack([points, np.zeros(len(points)), np.ones(len(points))]).ravel())
        spline.use_cyclic_u = True
        made = bpy.data.objects.new(data.name, data)
        bpy.context.scene.collection.objects.link(made)
        bpy.context.view_layer.objects.active = made
    for step in (lambda: bpy.ops.object.nested_cages_generate(levels="12"), lambda: None):
        for each in bpy.data.objects:
            each.select_set(each.type == "CURVE")
        step()

def path(n):
    points = " ".join(f"{x:.6f},{y:.6f}" for x, y in loop(n))
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-2 -2 4 4"><path d="M {points} z"/></svg>'
"""
"""What the cases are made of; blobs are those of data/drawn.py."""


@dataclass(frozen=True)
class Case:
    """A request: what is made ready before the clock starts, what is timed, and the case it is compared with."""

    name: str
    ready: str
    timed: str
    beside: str = ""
    steps: int = 1
    """How often it is timed in a row; of several, the slowest counts."""


def cases() -> list[Case]:
    """All requests, the plain ones before those that are compared with them."""
    plain = {n: Case(f"count {n:,}", f"f = blob({n})", "nested_cages(f, [32])") for n in (1_000, 10_000)}
    found = [*plain.values()]
    for n, case in plain.items():
        within = "nested_cages(f, [Within(distance=0.01 * f.diagonal)])"
        found.append(Case(f"within 1 %, {n:,}", f"f = blob({n})", within, case.name))
    again = "f = blob(1000); nested_cages(f, [32])"
    found.append(Case("the same again, 1,000", again, "nested_cages(f, [32])", plain[1_000].name))
    for number in (100, 300, 1_000, 3_000):
        found.append(Case(f"loops {number:,}", f"f = islands({number})", f"nested_cages(f, [{6 * number}])", ""))
    found += [Case(f"{n:,} at {n // 100}", f"f = blob({n})", f"nested_cages(f, [{n // 100}])") for n in (1_000, 10_000)]
    found += [Case(f"1,000 at {count}", "f = blob(1000)", f"nested_cages(f, [{count}])") for count in (128, 130)]
    large = Case("100,000 at 1,000", "f = blob(100000)", "nested_cages(f, [1000])")
    found += [large, Case("100,000 at 32", large.ready, "nested_cages(f, [32])", large.name)]
    for n in (1_000, 5_000):
        ready = f"f, move = pulled({n}); c = nested_cages(f, [32]).levels[0].cage; e = 1e-5 * f.diagonal"
        step = "g = f.moved(f.vertices + move).validated(); c = core.followed(c, f, g, e); f = g"
        alone = Case(f"the first of {n:,}", f"f, move = pulled({n})", "nested_cages(f, [32])")
        found += [alone, Case(f"following {n:,}, worst of 20 poses", ready, step, alone.name, steps=20)]
    for n in (1_000, 10_000):
        found.append(Case(f"convex pieces {n:,}", f"f = blob({n})", "core.convex_pieces(f)", ""))
    for n in (10_000, 100_000):
        found.append(Case(f"SVG of {n:,} points", f"s = path({n})", "core.from_svg(s)"))
    found.append(Case("SVG of 3,200 circles", "s = circles(3200)", "core.from_svg(s)"))
    square = "f = Mesh.from_loops([[(0, 0), (1, 0), (1, 1), (0, 1)]]); from nestedcages_core import Rotation"
    found.append(
        Case("rotation of order 200", square, "nested_cages(f, [200], Settings(symmetry=Rotation((.5, .5), 200)))")
    )
    for count in (16, 32, 64):
        alone = Case(f"1,000 at {count}, plain", "f = blob(1000)", f"nested_cages(f, [{count}])")
        found.append(alone)
        for part in (0.002, 0.01, 0.02):
            timed = f"nested_cages(f, [{count}], Settings(grid={part} * f.diagonal))"
            found.append(Case(f"grid {part:g} of the size, 1,000 at {count}", alone.ready, timed, alone.name))
    for seed in (0, 1, 2):
        found.append(Case(f"strokes {seed} at 16", f"f = strokes({seed})", "nested_cages(f, [16])"))
    if find_spec("bpy"):
        for n in (10, 20, 60):
            found.append(Case(f"bind {n} drawings", f"with_cages({n})", "bpy.ops.object.nested_cages_bind()"))
    return found


ENOUGH = 3.0
"""Seconds after which a case is not repeated."""

GROWTH = {
    "loops": {100: "loops 100", 300: "loops 300", 1_000: "loops 1,000", 3_000: "loops 3,000"},
    "drawings": {n: f"bind {n} drawings" for n in (10, 20, 60)},
    "vertices at 32": {1_000: "count 1,000", 10_000: "count 10,000", 100_000: "100,000 at 32"},
    "vertices at a hundredth": {1_000: "1,000 at 10", 10_000: "10,000 at 100", 100_000: "100,000 at 1,000"},
}
"""The cases of each size over which the growth is told, by power laws."""


def exponent(sizes: dict[int, str], seconds: dict[str, float]) -> str:
    """The power of the size that time grows with; empty if a case is missing."""
    points = [(size, seconds.get(name, np.nan)) for size, name in sizes.items()]
    power = np.polyfit(*np.log(points).T, 1)[0] if np.isfinite(points).all() else np.nan
    return f"n^{power:.2f}" if np.isfinite(power) else ""


def work(shapes: str, enough: float) -> None:
    """In a worker: CPU seconds of each case that comes in, everything forgotten before it is made ready."""
    import operator
    import os
    import pickle
    import sys
    import time

    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # Blender prints its reports
    names: dict = {}
    exec(shapes, names)
    forget = forgetting()
    while True:
        try:
            ready, timed, steps, repeats = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        seconds, why = [], ""
        try:
            for _ in range(repeats):
                forget()
                exec(ready, names)
                clock = [time.process_time()]
                for _ in range(steps):
                    exec(timed, names)
                    clock.append(time.process_time())
                seconds.append(max(map(operator.sub, clock[1:], clock)))
                if clock[-1] - clock[0] > enough:
                    break
        except Exception as error:
            why = str(error) or type(error).__name__
        pickle.dump((float("nan") if why else min(seconds), why), answers)
        answers.flush()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", nargs="+", default=["HEAD"], help="the other commits (%(default)s)")
    parser.add_argument("--only", nargs="*", default=[""], help="cases whose names have one of these words")
    parser.add_argument("--repeats", type=int, default=3, help="runs of each case (%(default)s)")
    parser.add_argument("--patience", type=float, default=120.0, help="seconds for a case (%(default)s)")
    options = parser.parse_args()
    wanted = [case for case in cases() if any(word in case.name for word in options.only)]
    failed = False
    names = [*options.against, "now"]
    heads = [*(f"{name}, s" for name in names), *(f"to {name}" for name in options.against), "to its plain request"]
    print(f"| | {' | '.join(heads)} |\n|{'---|' * (len(heads) + 1)}")
    with ExitStack() as stack:
        places = [*(stack.enter_context(checkout(commit)) for commit in options.against), ROOT]
        workers = [Worker(place, work, SHAPES, ENOUGH) for place in places]
        seconds: list[dict[str, float]] = [{} for _ in places]
        for case in wanted:
            cells = []
            for k, place in enumerate(places):
                answer = workers[k].run((case.ready, case.timed, case.steps, options.repeats), options.patience)
                if answer is None:  # a new process instead of the one that is still busy
                    workers[k].close()
                    workers[k] = Worker(place, work, SHAPES, ENOUGH)
                    answer = np.nan, f"more than {options.patience:.0f} s"
                seconds[k][case.name], why = answer
                cells.append(why[:40] if why else f"{answer[0]:.3f}")
            failed |= bool(why)
            now = seconds[-1][case.name]
            cells += [ratio(now, before[case.name]) for before in seconds[:-1]]
            cells.append(ratio(now, seconds[-1].get(case.beside, np.nan)))
            print(f"| {case.name} | {' | '.join(cells)} |", flush=True)
        for worker in workers:
            worker.close()
    print(f"\n| growth over | {' | '.join(names)} |\n|{'---|' * (len(names) + 1)}")
    for name, sizes in GROWTH.items():
        print(f"| {name} | {' | '.join(exponent(sizes, each) for each in seconds)} |")
    return 1 if failed else 0


def ratio(one: float, other: float) -> str:
    """Empty where one of them is missing."""
    return f"{one / other:.2f}" if np.isfinite(one) and np.isfinite(other) else ""


if __name__ == "__main__":
    sys.exit(main())
