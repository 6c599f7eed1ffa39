"""Outcomes of searches on small shapes, as recorded: what changes one by more than round-off is seen, and is meant.

Better and worse cages are both certified, so that no other test tells them apart. With each outcome goes, for each file
of the rooms below, how often its functions answered, and sums over their first answers. To record those of today, run
``PYTHONPATH=.:tests python tests/core/test_outcomes.py``: the differences tell which cages become better or worse.
Then run it with ``agree`` on other versions of Python and numpy, and as other processors calculate
(``OPENBLAS_CORETYPE=Prescott``, ``Haswell``; ``NPY_DISABLE_CPU_FEATURES``), to drop answers that round-off decides.
"""

from __future__ import annotations

import functools
import importlib
import inspect
import json
import pkgutil
import platform
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import product
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
import pytest

from nestedcages_core import (
    IPC,
    BoundaryARAP,
    InitialDisplacement,
    LineCycles,
    Mesh,
    Mirror,
    NestedCagesError,
    NestingError,
    OuterHull,
    Progress,
    Rotation,
    Settings,
    ShapeKeeping,
    Within,
    animated_cages,
    inner_cages,
    nested_cages,
)
from nestedcages_core.cache import forget
from nestedcages_core.constraints import AxisAligned, Box, Constraint, LeastAngle, LeastEdge, LoopClearance, Outside
from nestedcages_core.constraints.convex import Convex
from nestedcages_core.constraints.pins import Pins
from nestedcages_core.constraints.symmetric import Symmetric
from nestedcages_core.contact.pairs import Bodies
from nestedcages_core.decimation.base import Kept, Outline
from nestedcages_core.decimation.importance import Importance
from nestedcages_core.decimation.line_cycles.candidates import candidates
from nestedcages_core.decimation.line_cycles.chain import Chain
from nestedcages_core.decimation.line_cycles.least_areas import least_areas
from nestedcages_core.decimation.line_cycles.places import NormalFrame
from nestedcages_core.decimation.request import Request
from nestedcages_core.errors import Fault
from nestedcages_core.level.counts import with_least
from nestedcages_core.level.gate import Way
from nestedcages_core.level.report import STAGES, LevelProgress
from nestedcages_core.level.settling import _paths
from nestedcages_core.level.tightest_place import too_narrow
from nestedcages_core.level.units import SolverUnits
from nestedcages_core.motion.animated import certified_still
from nestedcages_core.motion.between import Instant, Straightener
from nestedcages_core.motion.between import around as keys_from
from nestedcages_core.motion.following import Follower, followed
from nestedcages_core.motion.poses import Pose
from nestedcages_core.motion.promises import Promises
from nestedcages_core.tasks import drain
from nestedcages_core.tolerance.minimal_nested import Band
from nestedcages_core.tolerance.reach import beyond, reach
from support.shapes import annulus, comb, jagged, letter_a, letter_a_coarse, ring
from support.shapes import star as star_of

ROOMS = ("decimation.line_cycles", "tolerance", "level", "motion", "constraints")
UNWATCHED = {"_cross", "_dot", "meets", "_passes", "_gate", "_side", "rows", "short", "settled", "_level"}
"""Functions that are called often, or as often as a solver needs steps, or answer with the time they took."""
MOST_ANSWERS = 40
"""Answers of a function that are added up; further ones are only counted."""
FAR = 1e3
"""Size of numbers that are only counted: nothing is that far away."""
RECORD = Path(__file__).with_name("outcomes.json")
Outcome = list[Any]


def spiral() -> Mesh:
    turn = np.linspace(0.0, 6.0 * np.pi, 90)
    ray = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    middle = (0.2 + 0.8 * turn / turn[-1])[:, None] * ray
    return Mesh.from_loops([np.concatenate([middle + 0.05 * ray, (middle - 0.05 * ray)[::-1]])])


def random(seed: int, count: int = 24) -> Mesh:
    return Mesh.from_loops([jagged(np.random.default_rng(seed), count)])


def parts(*placed: tuple[int, int, float, float, float]) -> Mesh:
    """Random loops by seed, count, size and place."""
    return Mesh.from_loops([size * random(seed, count).vertices + [x, y] for seed, count, size, x, y in placed])


def of_mesh(mesh: Mesh) -> Outcome:
    """Numbers that differ wherever two cages do."""
    lengths = mesh.edge_lengths
    return [len(mesh.vertices), mesh.area, float(lengths.sum()), float((lengths**2).sum())]


def around(fine: Mesh, count: Any, *, clearance: float = 0.0, side: int = 1, **kept: Any) -> Callable[[], Outcome]:
    """Line cycles that keep something."""

    def run() -> Outcome:
        method = LineCycles() if side > 0 else LineCycles().inside
        starts = drain(method.starts_keeping(fine, count, Kept(**kept), clearance=clearance))
        return [[start.source, *of_mesh(start.coarse)] for start in starts]

    return run


def bent(mesh: Mesh) -> Mesh:
    """A drawing without symmetry, so that no two cages are as good as each other and round-off decides nothing."""
    x, y = mesh.vertices.T
    return mesh.moved(np.stack([x + 0.07 * np.sin(2.0 * y + 1.0), y + 0.05 * np.sin(3.0 * x + 0.4)], axis=1))


SHAPES = {
    "letter": bent(letter_a(2)), "star": bent(star_of(5, 60)), "comb": bent(comb(3, 0.05, 0.5, 12)),
    "ring": parts((7, 24, 1.0, 0.1, 0.0), (8, 9, 0.3, 0.0, 0.1)), "spiral": bent(spiral()),
    "islands": parts((9, 15, 1.0, 0.0, 0.0), (10, 9, 0.7, 1.9, 0.2), (11, 7, 0.3, 1.0, 1.1)),
    **{f"random {k}": random(k) for k in range(4)},
}  # fmt: skip
NO_PINS = np.zeros((0, 2))


def line_cycles() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    for number, (name, fine) in enumerate(SHAPES.items()):
        loops, x = len(fine.loops), fine.vertices[:, 0]
        for count in (17, 30 if number % 2 else 9):
            yield f"{name}, {count}", around(fine, max(count, 3 * loops))
        options: list[tuple[Any, dict[str, Any]]] = [
            (20, {"clearance": 0.02 * fine.diagonal}),
            (18, {"side": -1}),
            ([5 + k for k in range(loops)], {}),
            (17, {"importance": Importance(fine, 1.0 + 9.0 * (x > 0.0), NO_PINS)}),
            (17, {"importance": Importance(fine, None, fine.vertices[[2, 11, 19]])}),
            *((18, {"rules": (rule,)}) for rule in RULES),
        ]
        for k in range(number, number + 3):
            wanted, each = options[3 * k % 10 % len(options)]
            yield f"{name}, {3 * k % 10 % len(options)}", around(fine, wanted, **each)


RULES = LeastEdge(0.2), LeastAngle(50.0), AxisAligned(), LoopClearance(0.02, 0.01)


def flower(leaves: int, *, loops: int = 1, count: int = 60, twist: float = 0.0) -> Mesh:
    """Leaves around the origin, the first one to the right, in rings that are smaller and smaller."""
    turn = 2.0 * np.pi * np.arange(count) / count
    radius = 1.0 + 0.3 * np.cos(leaves * turn) + 0.07 * np.cos(2 * leaves * turn + twist)
    return Mesh.from_loops([0.6**k * radius[:, None] * ring(count) for k in range(loops)])


def symmetric_cycles() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    level, pair = Mirror((0.0, 0.0), (1.0, 0.0)), Mesh.from_loops([0.5 * ring(13) + (0, 1), 0.5 * ring(13) - (0, 1)])
    for name, (fine, *orders) in {
        "1": (flower(1, count=23),), "2": (flower(2, loops=2, count=40, twist=1.0), 2), "3": (flower(3), 3),
        "4": (flower(4, twist=0.5), 2, 4), "5": (flower(5, count=65), 5), "pair": (pair,), "6": (flower(6), 3),
    }.items():  # fmt: skip
        for count in (12, 17):
            yield f"{name}, mirror, {count}", around(fine, count, symmetry=level)
        yield f"{name}, preferred", around(fine, 15, preferred=level)
        for order in orders:
            yield f"{name}, {order} times", around(fine, 15, symmetry=Rotation((0.0, 0.0), order))
        yield (
            f"{name}, pins",
            around(fine, 16, symmetry=level, importance=Importance(fine, None, fine.vertices[[3, 7]])),
        )


def counts_of_cycles() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    def fewest(fine: Mesh, excess: float) -> Callable[[], Outcome]:
        return lambda: [drain(LineCycles().fewest(fine, 24, (1.0 + excess) * fine.area))]

    def least(fine: Mesh) -> Callable[[], Outcome]:
        def run() -> Outcome:
            found = drain(least_areas(fine, 24, Kept(), range(len(fine.loops)), 0.01 * fine.diagonal))
            return [[k, [area for area in areas.tolist() if np.isfinite(area)]] for k, areas in sorted(found.items())]

        return run

    for number, (name, fine) in enumerate(SHAPES.items()):
        excess = (0.05, 0.4, 2.0)[number % 3]
        yield f"{name}, {excess}", fewest(fine, excess)
        yield f"{name}, all counts", least(fine)


def bands() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    def of(fine: Mesh, distance: float) -> Callable[[], Outcome]:
        def run() -> Outcome:
            outcome: Outcome = []
            for loop in range(len(fine.loops)):
                band = Band(fine, loop, distance)
                for number in range(2):
                    walks = band.walks(1e-3 * distance, share=1.0 - 0.01 * number, enough=4 * number)
                    outcome.append([len(band.places), band.fewest_links(0.0), *map(of_loop, walks)])
                    band.add(fine.vertices[:2] + distance)
            return outcome

        return run

    cases = [("letter", 0.2), ("star", 0.02), ("spiral", 0.03), ("comb", 0.1)]
    cases += [(f"random {k}", distance) for k in range(4) for distance in ((0.003, 0.06) if k % 2 else (0.02,))]
    for name, distance in cases:
        yield f"{name}, {distance}", of(SHAPES[name], distance * SHAPES[name].diagonal)


def of_loop(loop: np.ndarray) -> Outcome:
    return of_mesh(Mesh.from_loops([loop]))


def reaches() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    def of(fine: Mesh, count: int) -> Callable[[], Outcome]:
        def run() -> Outcome:
            cage = LineCycles().decimate(fine, count)
            taken = reach(cage, fine)
            rough, places = beyond(cage, fine, 0.5 * taken, 0.1 * taken)
            return [taken, rough, len(places), float(np.abs(places).sum())]

        return run

    for name in ("letter", "star", "ring", "random 0", "random 1", "random 2"):
        yield name, of(SHAPES[name], 9)


def of_motion(steps: np.ndarray) -> Outcome:
    return [len(steps), float(np.abs(np.diff(steps, axis=0)).sum()), float((steps * np.arange(1.0, 3.0)).sum())]


def of_notes(notes: Any) -> Outcome:
    return [
        [note.code, *(value for value in note.data.values() if isinstance(value, str | int | float))] for note in notes
    ]


def caged(make: Any, fine: Mesh, wanted: Any, **options: Any) -> Callable[[], Outcome]:
    """Levels of a whole run."""

    def run() -> Outcome:
        outcome: Outcome = []
        for level in make(fine, wanted, **options):
            report, moving = level.report, level.reinflation
            outcome += [[report.start, report.fewest, report.clearance, *of_mesh(level.cage)]]
            outcome += [of_motion(moving.cage_steps), of_motion(moving.moving_steps), of_notes(report.notes)]
        return outcome

    return run


SMALL = {
    "letter": bent(letter_a(1)), "star": bent(star_of(5, 20)), "random 0": random(0),
    "ring": parts((7, 15, 1.0, 0.1, 0.0), (8, 7, 0.3, 0.0, 0.1)),
    "two": parts((1, 15, 1.0, 0.0, 0.0), (2, 12, 1.0, 1.9, 0.3)), "random 5": random(5, 20),
}  # fmt: skip
LEVEL, OBLIQUE = Mirror((0.0, 0.0), (1.0, 0.0)), AxisAligned((0.0, 60.0, 120.0))
OBSTACLE = Mesh.from_loops([0.1 * ring(9) + (1.2, 0.1)])
SETTINGS: dict[str, dict[str, Any]] = {
    "nothing": {}, "clearance": {"clearance": 0.02}, "more clearance": {"clearance": 0.1}, "keep": {"loops": "keep"},
    "one": {"loops": "one"}, "grid": {"grid": 0.05}, "coarse grid": {"grid": 0.2}, "float32": {"stored": np.float32},
    "float16": {"stored": np.float16, "clearance": 0.001}, "convex": {"convex": True}, "merge": {"merge": 0.3},
    "convex grid": {"convex": True, "grid": 0.1}, "mirror": {"symmetry": LEVEL},
    "axes": {"constraints": [AxisAligned()]}, "mirror grid": {"symmetry": LEVEL, "grid": 0.05},
    "turns": {"symmetry": Rotation((0.0, 0.0), 3)}, "mirror float32": {"symmetry": LEVEL, "stored": np.float32},
    "turns grid": {"symmetry": Rotation((0.0, 0.0), 4), "grid": 0.05}, "pins": {"pins": [1, 7]},
    "joints": {"joints": [(0.2, 0.1)]}, "edge": {"min_edge": 0.3}, "angle": {"min_angle": 40.0},
    "edge grid": {"min_edge": 0.3, "grid": 0.05}, "box": {"constraints": [Box((-9.0, -9.0), (1.5, 9.0))]},
    "oblique": {"constraints": [OBLIQUE]}, "loops": {"constraints": [LoopClearance(0.03, 0.01)]},
    "obstacle": {"constraints": [Outside(OBSTACLE, 0.02)]}, "hull": {"decimation": OuterHull()},
    "shape grid": {"energy": ShapeKeeping(), "grid": 0.08}, "pins grid": {"pins": [2], "grid": 0.08},
    "short edges": {"min_edge": 0.9, "grid": 0.3}, "wishes": {"min_angle": 59.0},
    "turns of squares": {"symmetry": Rotation((0.03, 0.0), 4), "grid": 0.1}, "too clear": {"clearance": 1e7},
}  # fmt: skip


def levels() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    names = ["star", "random 0", "ring", "random 5"]
    for number, (setting, options) in enumerate(SETTINGS.items()):
        name = "two" if setting in ("one", "merge", "loops", "obstacle", "keep") else names[number % 4]
        name = "random 0" if setting in ("coarse grid", "more clearance", "short edges") else name
        yield f"{name}, {setting}", caged(nested_cages, SMALL[name], 14, **options)
    for number, (name, fine) in enumerate(SMALL.items()):
        if number % 2:
            yield f"{name}, levels", caged(nested_cages, fine, ["90%", 12, 8], stored=np.float32)
        yield f"{name}, inside", caged(inner_cages, fine, [12])
    star, letter = SMALL["star"], SMALL["letter"]
    yield "own mesh", caged(nested_cages, letter, bent(letter_a_coarse()))
    yield "own mesh, grid", caged(nested_cages, letter, bent(letter_a_coarse()), grid=0.05)
    yield "shrunk mesh", caged(nested_cages, star, star.moved(0.8 * star.vertices), stored=np.float32)
    yield "inside, grid", caged(inner_cages, letter, 20, grid=0.05)
    yield "inside, mirror", caged(inner_cages, star, 12, symmetry=LEVEL, clearance=0.01)
    yield "no room", caged(nested_cages, annulus(24, 0.995), 12, loops="keep")
    for energy in (BoundaryARAP(), InitialDisplacement(), ShapeKeeping()):
        yield f"{type(energy).__name__}", caged(nested_cages, SMALL["random 5"], 9, energy=energy)
    yield "IPC", caged(nested_cages, star, 12, contact=IPC())


def tolerances() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    wanted = {"far": Within(distance=0.2), "near": Within(distance=0.03), "excess": Within(excess=0.3)}
    options: dict[str, dict[str, Any]] = {
        "nothing": {}, "grid": {"grid": 0.05}, "convex": {"convex": True}, "hull": {"decimation": OuterHull()},
    }  # fmt: skip
    names = ("star", "random 0", "random 5")
    for number, (need, each) in enumerate(product(wanted, options)):
        name = names[number // 4]
        if each != "grid" or need == "near":
            yield f"{name}, {need}, {each}", caged(nested_cages, SMALL[name], wanted[need], **options[each])
    yield "few, excess, grid", caged(nested_cages, random(3, 9), wanted["excess"], grid=0.1)
    yield "inside, far", caged(inner_cages, SMALL["random 5"], Within(distance=0.2))
    yield "inside", caged(inner_cages, SMALL["ring"], Within(excess=0.25))
    yield "two", caged(nested_cages, SMALL["two"], Within(excess=0.5))
    yield (
        "levels",
        caged(nested_cages, SMALL["star"], [Within(distance=0.05), Within(distance=0.3), Within(excess=1.5)]),
    )


def motions() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    def moved(fine: Mesh, poses: np.ndarray, wanted: Any, **options: Any) -> Callable[[], Outcome]:
        def run() -> Outcome:
            outcome: Outcome = []
            for level in animated_cages(fine, poses, wanted, **options).levels:
                outcome += [len(level.times), float(level.times.sum()), level.report.clearance.tolist()]
                outcome += [of_mesh(level.cage), of_motion(level.cage_steps), of_notes(level.report.notes)]
            return outcome

        return run

    few, star = random(3, 12), bent(star_of(3, 15))
    two = parts((4, 9, 1.0, 0.0, 0.0), (6, 9, 1.0, 2.0, 0.3))
    slow, wild = moving(few, 3, 0.2), moving(few, 3, 0.5)
    yield "slow", moved(few, slow, [8, 5])
    yield "wild", moved(few, wild, [7], weights=1.0 + 5.0 * (few.vertices[:, 0] > 0.0), pins=[2])
    yield "edge", moved(few, slow[:2], [7], min_edge=0.3, grid=0.01)
    yield "cyclic", moved(star, moving(star, 3, 0.2), [7], cyclic=True, clearance=0.01)
    yield "float16", moved(star, moving(star, 2, 0.3), [7], stored=np.float16, times=[1.0, 1.5])
    yield "two", moved(two, moving(two, 2, 0.2), [9])
    for options in SETTLED:
        yield ", ".join(map(str, options.values())), lambda options=options: settled(**options)
    yield "still", lambda: [list(parts_of(list(vars(stills(few, slow)).values())))]
    yield "followed", lambda: list(parts_of(follow(few, slow)))
    yield "shown", lambda: list(parts_of([animated_cages(few, slow[:2], [6]).frames]))
    for name, kept in {"convex": {"convex": True}, "tolerance": {}, "crossing": {}}.items():
        wanted = Within(distance=0.1) if name == "tolerance" else 7
        poses = np.stack([slow[0], slow[0] * [-0.2, 1.0]]) if name == "crossing" else slow
        yield name, moved(few, poses, wanted, **kept)
    yield "mirror", moved(star_of(4, 16), moving(star_of(4, 16), 2, 0.0), [8], symmetry=LEVEL)


def settled(refusals: int, handed: str, steps: int, *, period: float = 0.0, part: float = 1.0) -> Outcome:
    """What becomes of an interval between three keys whose motion is refused so many times."""
    fine = random(3, 9)
    poses = [fine.moved(each) for each in moving(fine, 3, 0.3)]
    cage, settings = LineCycles().decimate(poses[0], 6), Settings()
    follower = Follower.of(cage, poses[0], SolverUnits.of(poses[0]), 0.02, Promises.of(settings, poses[0]))
    asked: list[float] = []

    def is_free(begin: Instant, end: Instant) -> bool:
        asked.append(begin.part)
        return len(asked) > refusals

    straightener, keys = Straightener(follower, is_free, period), list[Instant]()
    for number, pose in enumerate(poses):
        own = LineCycles().decimate(pose, 6)
        time = 0.0 if period and number == 2 else 2.0 * number
        cages = [follower.units.points(own.vertices) * (1.0 + 0.03 * (steps - k)) for k in range(steps)]
        keys.append(straightener.instant(Pose(number, time, pose.vertices, True), cages))
        keys[-1].handed_out = str(number) in handed
        keys[-1].part = part
    keys[0].link(keys[1])
    keys[1].link(keys[2])
    code = ""
    try:
        straightener.settle(keys[1])
    except NestedCagesError as error:
        code = error.code
    after = list(keys_from(keys[0]))
    rest = [[key.pose.time, key.part, key.rounds, len(key.cages), *parts_of(key.cage)] for key in after]
    return [code, len(asked), float(np.sum(asked)), *rest]


SETTLED: list[dict[str, Any]] = [
    *({"refusals": count, "handed": "", "steps": 1} for count in (0, 1, 6)),
    *({"refusals": 2, "handed": handed, "steps": 1} for handed in ("1", "12")),
    *({"refusals": 7, "handed": handed, "steps": 1, "part": 1.0 / 32.0} for handed in ("", "1", "2", "0")),
    {"refusals": 3, "handed": "0", "steps": 5},
    {"refusals": 30, "handed": "", "steps": 1, "part": 1.0 / 32.0},
    {"refusals": 5, "handed": "", "steps": 4, "part": 0.5},
    {"refusals": 3, "handed": "", "steps": 1, "period": 6.0},
]


def stills(fine: Mesh, poses: np.ndarray) -> Any:
    union = Mesh.from_loops([1.6 * fine.vertices.max() * ring(7)])
    return drain(certified_still(union, fine, poses, clearance=0.01))


def follow(fine: Mesh, poses: np.ndarray) -> Mesh | None:
    before, after = fine.moved(poses[0]), fine.moved(poses[1])
    return followed(LineCycles().decimate(before, 7), before, after, 1e-4, Settings())


def constraints() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    """What each constraint answers to each of its questions, about a cage that keeps it and one that does not."""

    def of(given: Constraint, fine: Mesh, cage: Mesh, side: int) -> Callable[[], Outcome]:
        def run() -> Outcome:
            about = SolverUnits.of(fine)
            loops = Request.of(fine, 9).outline
            frame = NormalFrame.of(loops)
            chain = Chain(frame.into(loops.vertices))
            at, points = np.arange(chain.size), about.points(cage.vertices)
            lines = candidates(chain, at, 3.0, 0.01)
            own, outline = given, Outline(fine, fine)
            with suppress(NestedCagesError):
                own = given.of(fine, side)
            with suppress(NestedCagesError):
                outline = own.outline(outline, side)
            own = own.around(outline.mesh)
            bound = own.bound(about.from_input(cage), about.from_input(fine), about)

            def rows(radius: float) -> list[Any]:
                found = [(*terms.rows.__dict__.values(), terms.room) for terms in bound.rows(points, radius)]
                return [*map(list, found)]

            asked: list[Callable[[], Any]] = [
                lambda: outline.mesh, lambda: given.of(fine, side).must, lambda: own.turn_limits,
                lambda: own.distances(fine),
                lambda: [own.count(fine, count) for count in (3, 8, 13, 40)],
                lambda: own.candidates(chain, at, lines, frame, 0.01)[:3], lambda: own.free(lines, frame),
                lambda: own.reach(chain, own.candidates(chain, at, lines, frame, 0.01), 0.01),
                lambda: own.started(cage, side), lambda: own.restored(cage, cage.vertices[None]),
                lambda: list(own.faults(cage, fine)), lambda: own.mended(cage), lambda: bound.short(points),
                lambda: bound.settled(points, cage.successor), lambda: rows(0.0), lambda: rows(0.03), lambda: rows(0.5),
            ]  # fmt: skip
            return [answered(each) for each in asked]

        return run

    def answered(ask: Callable[[], Any]) -> Outcome:
        try:
            return list(parts_of(ask()))
        except NestedCagesError as error:
            return [error.code, letters(str(error)), *parts_of(error.data)]

    x = np.array([3.0, 2.0])
    for name, seed in {"tight": 1, "loose": 2}.items():
        fine = Mesh.from_loops([5.0 * random(seed, 12).vertices + x])
        cage = LineCycles().decimate(fine, 7)
        if name == "loose":
            cage = Mesh.from_loops([1.3 * (cage.vertices - x) + x])
        width, bay = fine.diagonal, Mesh.from_loops([0.4 * ring(5) + x + [6.2, 0.4]])
        places = fine.vertices[[1, 5]]
        for number, given in enumerate((
            AxisAligned(), AxisAligned((20.0, 80.0, 150.0)), LeastAngle(55.0), LeastEdge(0.25 * width),
            Box((-1.5, -3.0), (7.5, 7.2)), Box((-0.1, -0.1), (2.0, 2.0)), Outside(bay, 0.3), Outside(bay, 2.0),
            LoopClearance(0.1 * width, 0.2), LoopClearance(loops=(0.01,)), Convex(), Pins(places, 0.01),
            Pins(places, 0.4), Symmetric(Mirror(tuple(x.tolist()), (1.0, 0.3))),
            Symmetric(Rotation(tuple(x.tolist()), 3)),
        )):  # fmt: skip
            side = -1 if number % 4 == 1 and name == "tight" else 1
            yield f"{name}, {number} {type(given).__name__}", of(given, fine, cage, side)


def pieces() -> Iterator[tuple[str, Callable[[], Outcome]]]:
    """Parts of levels by themselves."""
    fine, two = SMALL["random 0"], parts((1, 9, 1.0, 0.0, 0.0), (2, 7, 0.5, 1.7, 0.3), (3, 5, 0.3, 0.1, 1.6))
    holes = parts((7, 15, 1.0, 0.1, 0.0), (8, 7, 0.2, 0.3, 0.1), (4, 5, 0.15, -0.2, -0.1))
    cage = LineCycles().decimate(fine, 6)
    for name, mesh in {"two": two, "holes": holes, "ring": SMALL["ring"], "one": fine}.items():
        for wanted in (0.01, 1.0):
            yield f"narrow {name}, {wanted}", lambda mesh=mesh, wanted=wanted: list(parts_of(too_narrow(mesh, wanted)))

    def shown() -> Outcome:
        progress = LevelProgress(1, 3)
        steps: list[float] = []
        for number, expected in enumerate((1, 3, 3)):
            progress.next_start(expected)
            for stage in STAGES:
                steps += [each.fraction for each in progress.begin(stage)]
                for done in (0.3, -1.0, 0.7, 2.0):
                    steps += [each.fraction for each in progress.show(done, f"step {number}")]
        return [*steps, progress.starts_so_far]

    def continued() -> Outcome:
        way = Way.at_rest(fine, cage)
        steps = [cage.vertices * (1.0 + 0.01 * k) for k in range(4)]
        way = way._replace(reinflation=way.reinflation.with_tightening(steps))
        bodies, outcome = Bodies.of(way.cage, fine), []
        for there in (way.cage.vertices, way.cage.vertices + 0.03):
            paths = list(_paths(way, there, bodies, 0.05))
            outcome.append([list(parts_of([path.moving_steps, path.cage_steps])) for path in paths])
        return outcome

    yield "settings", lambda: [refused(kind, *each) for kind, *given in REFUSED for each in given]
    yield "progress", shown
    yield "paths", continued
    for least, named in ((9, 14), (12, 13), (7, 30), (20, 20), (10, 24)):
        yield f"least {least} of {named}", fewer(fine, least, named)


REFUSED: list[tuple[Any, ...]] = [
    (LeastEdge, (0.0,), (1e-3,), (np.inf,), (np.nan,), ("1",), (-1.0,)),
    (LeastAngle, (0.0,), (0.5,), (59.5,), (60.0,), (60.5,), ("1",), (np.nan,)),
    (AxisAligned, ((),), ((0.0,),), ((10.0, 190.0),), ((0.0, 181.0),), ((np.nan, 1.0),), ((180.0, 90.0),)),
    (Box, ((0.0, 0.0), (0.0, 1.0)), ((0.0, 0.0), (1.0, 0.5)), ((0.0, 0.0), (1.0, -1.0)), ((np.nan, 0.0), (1.0, 1.0))),
    (LoopClearance, (), (-1.0,), (0.5,), (0.5, -0.5), (0.0, 0.5), (np.inf,), (0.0, 0.0, (1, 2.0)), (0.0, 0.0, (-1.0,))),
    (Within, (), (0.0,), (0.5,), (-1.0,), (0.5, 0.5), (None, 0.5), (np.inf,), (True,), ("1",)),
    (LineCycles, (), (False, -1), (True, 0), (1,)),
    (Outside, (OBSTACLE,), (OBSTACLE, -0.5), (OBSTACLE, 0.5), (OBSTACLE, np.inf)),
]


def refused(kind: Any, *given: Any) -> Outcome:
    try:
        return [repr(kind(*given))]
    except NestedCagesError as error:
        return [error.code, letters(str(error))]


class From(NamedTuple):
    """A decimation that works from a number of vertices on, and keeps what it was asked for."""

    least: int
    asked: list[int]

    def decimate(self, fine: Mesh, count: int, *, clearance: float = 0.0) -> Mesh:
        self.asked.append(count)
        if count < self.least:
            raise NestingError("Too few.", code="count.too_small", total=count, least=self.least + 1)
        return LineCycles().decimate(fine, min(count, 12))


def fewer(fine: Mesh, least: int, named: int) -> Callable[[], Outcome]:
    def run() -> Outcome:
        first, second = From(least, []), From(least + 1, [])
        error = NestingError("Too few.", code="count.too_small", total=4, least=named)
        settings = Settings(decimation=first, fallback=second)  # type: ignore[arg-type]
        found = drain(with_least([error], settings, fine, (1e-5,)))
        return [found is error, list(parts_of(found.data)), first.asked, second.asked]

    return run


def moving(fine: Mesh, count: int, size: float) -> np.ndarray:
    """Poses that wave, turn and grow."""
    poses = []
    for phase in np.arange(count) / (count - 1.0) * 1.5 * np.pi:
        c, s = np.cos(size * np.sin(phase)), np.sin(size * np.sin(phase))
        points = fine.vertices * (1.0 + 0.1 * np.sin(phase)) + size * 0.3 * np.sin(phase + 3.0 * fine.vertices[:, ::-1])
        poses.append(points @ np.array([[c, s], [-s, c]]))
    return np.array(poses)


GROUPS = {
    "line cycles": line_cycles, "symmetric cycles": symmetric_cycles, "counts of cycles": counts_of_cycles,
    "bands": bands, "reaches": reaches, "levels": levels, "tolerances": tolerances, "motions": motions,
    "constraints": constraints, "pieces": pieces,
}  # fmt: skip


class Answers:
    """Watches the functions of the rooms: how often those of each file answer, and a sum of their answers."""

    def __init__(self) -> None:
        self.sums: dict[str, list[Any]] = {}
        self.calls: dict[FunctionType, int] = {}
        self.places: list[tuple[Any, str, Any, Any]] = []
        """Objects with the name of an attribute, what it is, and what watches it."""
        modules = [
            importlib.import_module(found.name)
            for room in map("nestedcages_core.{}".format, ROOMS)
            for found in pkgutil.walk_packages(importlib.import_module(room).__path__, room + ".")
        ]
        watched: dict[FunctionType, Any] = {}
        for module in modules:
            classes = [each for each in vars(module).values() if isinstance(each, type)]
            for owner in (module, *(each for each in classes if each.__module__ == module.__name__)):
                for name, each in list(vars(owner).items()):
                    kind = type(each) if isinstance(each, classmethod | staticmethod) else None
                    true = each.__func__ if kind else each
                    if not isinstance(true, FunctionType) or true.__module__ != module.__name__ or name[:2] == "__":
                        continue
                    if name not in UNWATCHED:
                        watched[true] = self.watch(true, module.__name__.removeprefix("nestedcages_core."))
                        if owner is not module:
                            self.places.append((owner, name, each, kind(watched[true]) if kind else watched[true]))
        for module in [each for name, each in sys.modules.items() if name.startswith("nestedcages_core")]:
            for name, each in list(vars(module).items()):
                if isinstance(each, FunctionType) and each in watched:
                    self.places.append((module, name, each, watched[each]))

    def watch(self, true: FunctionType, file: str) -> Any:
        def generator(*args: Any, **options: Any) -> Any:
            steps, sent = true(*args, **options), None
            try:
                while True:
                    step = steps.send(sent)
                    self.add(file, true, step)
                    sent = yield step
            except StopIteration as stop:
                self.add(file, true, stop.value)
                return stop.value
            finally:
                steps.close()

        def function(*args: Any, **options: Any) -> Any:
            answer = true(*args, **options)
            self.add(file, true, answer)
            return answer

        return functools.wraps(true)(generator if inspect.isgeneratorfunction(true) else function)

    def add(self, file: str, function: FunctionType, answer: Any) -> None:
        entry = self.sums.setdefault(file, [0, 0, 0.0])
        entry[0] += 1
        self.calls[function] = number = self.calls.get(function, 0) + 1
        if number > MOST_ANSWERS:
            return
        for part in parts_of(answer):
            if isinstance(part, int):
                entry[1] = (31 * entry[1] + part) % 1_000_003
            else:
                entry[2] += (1.0 + number % 7) * part

    def during(self, run: Callable[[], Outcome]) -> Outcome:
        """The outcome and the answers of a run."""
        forget()
        self.sums, self.calls = {}, {}
        for owner, name, _, watching in self.places:
            setattr(owner, name, watching)
        try:
            outcome = run()
        except NestedCagesError as error:
            outcome = [error.code, letters(str(error))]
        finally:
            for owner, name, true, _ in self.places:
                setattr(owner, name, true)
        return [outcome, self.sums]


def letters(text: str) -> int:
    """A sum over the letters of a text, whatever its numbers are."""
    return sum((1 + k % 7) * ord(each) for k, each in enumerate(filter(str.isalpha, text)))


def parts_of(answer: Any) -> Iterator[int | float]:
    """Numbers that differ wherever two answers do; none for what has no numbers."""
    if isinstance(answer, bool | int | np.bool_ | np.integer):
        yield int(answer)
    elif isinstance(answer, float | np.floating):
        yield float(answer) if abs(answer) < FAR else 1
    elif isinstance(answer, np.ndarray) and answer.dtype.kind in "biuf":
        yield len(answer)
        weights = WEIGHTS[np.arange(answer.size) % len(WEIGHTS)]
        numbers = answer.astype(np.float64).ravel()
        if answer.dtype.kind != "f":
            yield int(numbers @ np.floor(1000.0 * weights))
        else:
            finite = np.abs(numbers) < FAR
            yield int(finite @ np.floor(1000.0 * weights))
            yield float(numbers[finite] @ weights[finite]) / max(1, len(numbers))
    elif isinstance(answer, Mesh):
        yield from parts_of(answer.vertices)
    elif isinstance(answer, Progress):
        yield answer.fraction
    elif isinstance(answer, Fault):
        yield letters(f"{answer.code} {answer}")
        yield from parts_of(answer.data)
    elif isinstance(answer, tuple | list | dict):
        for each in answer.values() if isinstance(answer, dict) else answer:
            yield from parts_of(each)


WEIGHTS = 1.0 + np.random.default_rng(0).random(997)


def near(outcome: Any) -> Any:
    if isinstance(outcome, dict):
        return {name: near(each) for name, each in outcome.items()}
    if isinstance(outcome, list):
        return [near(each) for each in outcome]
    return pytest.approx(outcome, rel=1e-6, abs=1e-7) if isinstance(outcome, float) else outcome


WHOLE_RUNS = "levels", "tolerances", "motions"
"""Groups that take most of the time."""
CASES = [(group, name, run) for group, cases in GROUPS.items() for name, run in cases()]


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="recorded on x86-64")
@pytest.mark.parametrize(
    ("group", "name", "run"),
    [pytest.param(*case, marks=pytest.mark.slow if case[0] in WHOLE_RUNS else ()) for case in CASES],
)
def test_outcomes_are_the_recorded_ones(group: str, name: str, run: Callable[[], Outcome]) -> None:
    outcome, answers = watching().during(run)
    expected, expected_answers = RECORDED[group][name]
    assert outcome == near(expected)
    assert {file: answers.get(file) for file in expected_answers} == near(expected_answers)


@functools.cache
def watching() -> Answers:
    return Answers()


RECORDED = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}


def rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: rounded(each) for name, each in sorted(value.items())}
    return (
        [rounded(each) for each in value]
        if isinstance(value, list | tuple)
        else (float(f"{value:.9g}") if isinstance(value, float) else value)
    )


def agreed(group: str, name: str, answers: dict[str, Any]) -> dict[str, Any]:
    """Those answers that are as recorded."""
    known = RECORDED[group][name][1]
    return {file: known[file] for file, each in answers.items() if file in known and each == near(known[file])}


if __name__ == "__main__":
    lines: dict[str, list[str]] = {group: [] for group in GROUPS}
    for group, name, run in CASES:
        outcome, answers = watching().during(run)
        if sys.argv[1:] == ["agree"]:
            outcome, answers = RECORDED[group][name][0], agreed(group, name, answers)
        lines[group].append(f"{json.dumps(name)}: {json.dumps(rounded([outcome, answers]), separators=(',', ':'))}")
    groups = [f"{json.dumps(group)}: {{\n" + ",\n".join(each) + "\n}" for group, each in lines.items()]
    RECORD.write_text("{\n" + ",\n".join(groups) + "\n}\n", encoding="utf-8")
