"""Requests that could be slow, next to the plain one and to another commit."""

from __future__ import annotations

import operator
import time

from common import DETAILS, FAILED, Options, Server, ServerError, forget, ratios, table

PATIENCE, REPEATS, ENOUGH = 120.0, 3, 3.0
"""Seconds for a case, its repeats, and seconds after which there are no more."""
Case = tuple[str, str, str, str, int]
"""Name, what is made ready before the clock starts, what is timed, the case it is compared with, and how often it is
timed in a row: of several, the slowest counts."""


def cases() -> list[Case]:
    """All requests, the plain ones before those that are compared with them."""
    found: list[Case] = []

    def add(name: str, ready: str, timed: str, plain: str = "", steps: int = 1) -> None:
        found.append((name, ready, timed, plain, steps))

    for n in (1_000, 10_000):
        add(f"{n:,} at 32", f"f = blob({n})", "nested_cages(f, 32)")
        add(
            f"{n:,} within 1 %", f"f = blob({n})", "nested_cages(f, Within(distance=0.01 * f.diagonal))", f"{n:,} at 32"
        )
        add(f"{n:,} inside", f"f = blob({n})", "core.inner_cages(f, 32)", f"{n:,} at 32")
    add("1,000 at 32 again", "f = blob(1000); nested_cages(f, 32)", "nested_cages(f, 32)", "1,000 at 32")
    for n in (100, 300, 1_000):
        add(f"{n:,} loops", f"f = islands({n})", f"nested_cages(f, {6 * n})")
    add("300 loops at 300", "f = islands(300)", "nested_cages(f, 300)", "300 loops")
    for count in (128, 130, 320, 321):
        add(f"1,000 at {count}", "f = blob(1000)", f"nested_cages(f, {count})", "1,000 at 32")
    add("100,000 at 32", "f = smooth(100000)", "nested_cages(f, 32)")
    add("100,000 at 1,000", "f = smooth(100000)", "nested_cages(f, 1000)", "100,000 at 32")
    for count in (16, 64):
        add(f"1,000 at {count}", "f = blob(1000)", f"nested_cages(f, {count})")
        for part in (0.002, 0.01, 0.02):
            add(f"1,000 at {count}, grid {part:g}", "f = blob(1000)",
                f"nested_cages(f, {count}, grid={part} * f.diagonal)", f"1,000 at {count}")  # fmt: skip
    for n in (1_000, 5_000):
        add(f"following {n:,}, worst of 20", f"f, move = pulled({n}); c = nested_cages(f, 32)[0].cage",
            "g = Mesh(f.vertices + move, f.edges); c = core.followed(c, f, g, 1e-5 * f.diagonal); f = g",
            f"{n:,} at 32", 20)  # fmt: skip
        add(f"convex pieces of {n:,}", f"f = blob({n})", "core.convex_pieces(f)")
    square = "f = Mesh.from_loops([[(0, 0), (1, 0), (1, 1), (0, 1)]])"
    add("rotation of order 200", square, "nested_cages(f, 200, symmetry=core.Rotation((.5, .5), 200))")
    add("SVG of 100,000 points", "s = path(100000)", "core.from_svg(s)")
    return found


PREPARED = """
import numpy as np
import nestedcages_core as core
from nestedcages_core import Mesh, Within, nested_cages
from shapes import blob, islands, smooth

def pulled(n):
    angle = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    radius = 1.6 + 0.4 * np.cos(6.0 * angle)
    fine = Mesh.from_loops([radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])])
    return fine, np.exp(-(((angle - 0.5) / 0.2) ** 2))[:, None] * 1.6 * np.array([0.005, 0.011])

def path(n):
    points = " ".join(f"{x:.6f},{y:.6f}" for x, y in blob(n).vertices)
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-2 -2 4 4"><path d="M {points} z"/></svg>'
"""
"""What the requests are made of."""


def measure(ready: str, timed: str, steps: int, repeats: int) -> float:
    """In a server: CPU seconds of a request, everything forgotten before it is made ready."""
    names: dict[str, object] = {}
    exec(PREPARED, names)
    found = []
    for _ in range(repeats):
        forget()
        exec(ready, names)
        clock = [time.process_time()]
        for _ in range(steps):
            exec(timed, names)
            clock.append(time.process_time())
        found.append(max(map(operator.sub, clock[1:], clock)))
        if clock[-1] - clock[0] > ENOUGH:
            break
    return min(found)


def run(options: Options) -> str:
    wanted = [case for case in cases() if options.wants(case[0])]
    wanted = [case for case in wanted if "000" not in case[0].replace("1,000", "")] if options.quick else wanted
    servers = {name: Server(tree, "corners:measure") for name, tree in options.trees().items()}
    seconds: dict[str, dict[str, float]] = {name: {} for name in servers}
    rows, failed = [], False
    try:
        for server in servers.values():
            server("f = blob(100)", "nested_cages(f, 8)", 1, 1)  # what the first cage imports
        for case, ready, timed, plain, steps in wanted[: 6 if options.quick else None]:
            cells: list[object] = []
            for name, server in servers.items():
                try:
                    seconds[name][case] = server(ready, timed, steps, REPEATS, patience=PATIENCE)
                    cells.append(f"{seconds[name][case]:.3f}")
                except ServerError as error:
                    failed |= name == "now"
                    cells.append(str(error)[:30])
            now, before = seconds["now"], seconds[next(iter(servers))]
            own = now.get(case)
            cells += [f"{own / before[case]:.2f}" if own and case in before else None] if options.against else []
            cells.append(f"{own / now[plain]:.2f}" if own and plain in now else None)
            rows.append((case, *cells))
    finally:
        for server in servers.values():
            server.close()
    heads = (
        "request",
        *(f"CPU s, {name}" for name in servers),
        *(["ratio"] if options.against else []),
        "to the plain one",
    )
    text = table(heads, rows) + (f"\n{FAILED}: a request has no result" if failed else "")
    if options.against:
        before, now = seconds[options.commit], seconds["now"]
        text = f"CPU time {ratios([now[case] / before[case] for case in now if case in before])}\n{DETAILS}\n{text}"
    return text
