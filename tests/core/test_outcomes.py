"""Outcomes on small shapes, as recorded: vertices, loops and area of each cage. Better and worse cages are both
certified, so that no other test tells them apart; what changes one is meant. This file, run, prints today's table.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import AxisAligned, LineCycles, Mesh, Rotation, ShapeKeeping, Within, inner_cages, nested_cages
from support.marks import slow_after
from support.shapes import annulus, comb, jagged, letter_a, letter_a_coarse, resampled, ring, star

Outcome = list[tuple[int, int, float]] | str
TIGHT = 1e-3
"""Relative difference of an area that counts."""


def random(seed: int, count: int = 24) -> Mesh:
    return Mesh.from_loops([jagged(np.random.default_rng(seed), count)])


def parts(*placed: tuple[int, int, float, float, float]) -> Mesh:
    """Random loops by seed, count, size and place."""
    return Mesh.from_loops([size * random(seed, count).vertices + [x, y] for seed, count, size, x, y in placed])


def bent(mesh: Mesh) -> Mesh:
    """A drawing without symmetry, so that no two cages are as good as each other and round-off decides nothing."""
    x, y = mesh.vertices.T
    return mesh.moved(np.stack([x + 0.07 * np.sin(2.0 * y + 1.0), y + 0.05 * np.sin(3.0 * x + 0.4)], axis=1))


def moving(fine: Mesh, count: int, size: float) -> np.ndarray:
    """Poses that wave, turn and grow."""
    poses = []
    for phase in np.arange(count) / (count - 1.0) * 1.5 * np.pi:
        c, s = np.cos(size * np.sin(phase)), np.sin(size * np.sin(phase))
        points = fine.vertices * (1.0 + 0.1 * np.sin(phase)) + size * 0.3 * np.sin(phase + 3.0 * fine.vertices[:, ::-1])
        poses.append(points @ np.array([[c, s], [-s, c]]))
    return np.array(poses)


SHAPES = {
    "letter": bent(letter_a(1)), "star": bent(star(5, 20)), "random 0": random(0), "random 5": random(5, 20),
    "ring": parts((7, 15, 1.0, 0.1, 0.0), (8, 7, 0.3, 0.0, 0.1)), "few": random(3, 12),
    "two": parts((1, 15, 1.0, 0.0, 0.0), (2, 12, 1.0, 1.9, 0.3)), "comb": bent(comb(3, 0.05, 0.5, 12)),
    "islands": parts((9, 15, 1.0, 0.0, 0.0), (10, 9, 0.7, 1.9, 0.2), (11, 7, 0.3, 1.0, 1.1)),
    "large": bent(star(7, 300)),
}  # fmt: skip
LEVEL, OBSTACLE = core.Mirror((0.0, 0.0), (1.0, 0.0)), Mesh.from_loops([0.1 * ring(9) + (1.2, 0.1)])
NAMES = ["star", "random 0", "ring", "random 5"]
SETTINGS: dict[str, tuple[dict[str, Any], Outcome]] = {
    "default": ({}, [(14, 1, 3.2758)]),
    "clearance": ({"clearance": 0.02}, [(14, 1, 1.992)]),
    "keep": ({"loops": "keep"}, [(14, 2, 3.3456)]),
    "one": ({"loops": "one"}, [(14, 1, 3.4268)]),
    "grid": ({"grid": 0.05}, [(14, 1, 3.4125)]),
    "coarse grid": ({"grid": 0.2}, [(12, 1, 2.36)]),
    "float16": ({"stored": np.float16, "clearance": 0.001}, [(14, 2, 1.6401)]),
    "convex": ({"convex": True}, [(9, 1, 2.0333)]),
    "auto": ({"loops": "auto"}, [(14, 2, 3.3456)]),
    "convex grid": ({"convex": True, "grid": 0.1}, [(7, 1, 2.38)]),
    "mirror": ({"symmetry": LEVEL}, [(14, 1, 1.8955)]),
    "axes": ({"constraints": [AxisAligned()]}, [(14, 1, 2.036)]),
    "mirror grid": ({"symmetry": LEVEL, "grid": 0.05}, [(14, 1, 3.6525)]),
    "turns": ({"symmetry": Rotation((0.0, 0.0), 3)}, [(12, 1, 2.5697)]),
    "turns grid": ({"symmetry": Rotation((0.0, 0.0), 4), "grid": 0.05}, [(12, 1, 2.94)]),
    "pins": ({"pins": [1, 7]}, [(14, 1, 1.5865)]),
    "joints": ({"joints": [(0.2, 0.1)]}, [(14, 1, 3.323)]),
    "edge": ({"min_edge": 0.3}, [(14, 1, 1.8683)]),
    "angle": ({"min_angle": 40.0}, [(14, 2, 1.6295)]),
    "edge grid": ({"min_edge": 0.3, "grid": 0.05}, [(14, 1, 1.7262)]),
    "box": ({"constraints": [core.Box((-9.0, -9.0), (1.5, 9.0))]}, [(14, 1, 3.2758)]),
    "oblique": ({"constraints": [AxisAligned((0.0, 60.0, 120.0))]}, [(14, 1, 2.1284)]),
    "wide loops": ({"constraints": [core.LoopClearance(0.03, 0.01)]}, [(14, 2, 3.6693)]),
    "obstacle": ({"constraints": [core.Outside(OBSTACLE, 0.02)]}, [(14, 2, 3.3456)]),
    "outside": ({"decimation": LineCycles(on_curve=False)}, [(14, 1, 3.2758)]),
    "shape grid": ({"energy": ShapeKeeping(), "grid": 0.08}, [(14, 1, 2.0608)]),
    "pins grid": ({"pins": [2], "grid": 0.08}, [(14, 2, 1.8176)]),
    "wishes": ({"min_angle": 59.0}, [(14, 1, 1.5845)]),
    "too clear": ({"clearance": 1e7}, "clearance.too_large"),
}  # fmt: skip
OF_TWO = ("keep", "one", "auto", "wide loops", "obstacle")


def caged(make: Any, name: str, wanted: Any, **options: Any) -> Callable[[], Any]:
    return lambda: make(SHAPES[name], wanted, **options)


def moved(name: str, count: int, size: float, wanted: Any, **options: Any) -> Callable[[], Any]:
    return lambda: core.animated_cages(SHAPES[name], moving(SHAPES[name], count, size), wanted, **options).levels


CASES: dict[str, tuple[Callable[[], Any], Outcome]] = {
    **{
        name: (caged(nested_cages, "two" if name in OF_TWO else NAMES[number % 4], 14, **options), outcome)
        for number, (name, (options, outcome)) in enumerate(SETTINGS.items())
    },
    "letter of 24": (lambda: nested_cages(letter_a(6), 24), [(24, 1, 7.0838)]),
    "star of 18": (lambda: nested_cages(star(), 18), [(18, 1, 3.874)]),
    "large": (caged(nested_cages, "large", [48, 20]), [(48, 1, 3.3806), (20, 1, 3.6453)]),
    "comb": (caged(nested_cages, "comb", 17), [(17, 1, 0.55156)]),
    "islands": (caged(nested_cages, "islands", 17), [(17, 3, 3.1722)]),
    "islands of 30": (caged(nested_cages, "islands", 30), [(30, 3, 2.8701)]),
    "levels": (
        caged(nested_cages, "star", ["90%", 12, 8], stored=np.float32),
        [(18, 1, 3.1502), (12, 1, 3.3459), (8, 1, 3.6963)],
    ),
    "levels around two": (caged(nested_cages, "two", [18, 12, 8]), [(18, 2, 3.2574), (12, 2, 3.4375), (8, 1, 4.175)]),
    "own mesh": (lambda: nested_cages(SHAPES["letter"], bent(letter_a_coarse())), [(23, 2, 7.2055)]),
    "own mesh, grid": (lambda: nested_cages(SHAPES["letter"], bent(letter_a_coarse()), grid=0.05), [(23, 2, 7.4588)]),
    "own mesh of islands": (caged(nested_cages, "islands", resampled(SHAPES["islands"], 18)), [(19, 3, 3.1761)]),
    "shrunk mesh": (caged(nested_cages, "star", [0.8 * SHAPES["star"].vertices]), [(20, 1, 3.0909)]),
    "no room": (lambda: nested_cages(annulus(24, 0.995), 12, loops="keep"), [(12, 2, 0.83326)]),
    "boundary energy": (caged(nested_cages, "random 5", 9, energy=core.BoundaryARAP()), [(9, 1, 1.9084)]),
    "displacement": (caged(nested_cages, "random 5", 9, energy=core.InitialDisplacement()), [(9, 1, 1.8542)]),
    "shape keeping": (caged(nested_cages, "random 5", 9, energy=ShapeKeeping()), [(9, 1, 1.832)]),
    "IPC": (caged(nested_cages, "star", 12, contact=core.IPC()), [(12, 1, 3.3456)]),
    "inside": (caged(inner_cages, "letter", 20), [(20, 2, 5.8237)]),
    "inside a ring": (caged(inner_cages, "ring", 12), [(12, 2, 1.4807)]),
    "inside, grid": (caged(inner_cages, "letter", 20, grid=0.05), [(20, 2, 5.615)]),
    "inside, mirror": (caged(inner_cages, "star", 12, symmetry=LEVEL, clearance=0.01), [(12, 1, 2.4144)]),
    "far": (caged(nested_cages, "star", Within(distance=0.2)), [(10, 1, 3.4218)]),
    "near": (caged(nested_cages, "random 0", Within(distance=0.03)), [(21, 1, 1.8317)]),
    "near, outside": (
        caged(nested_cages, "random 0", Within(distance=0.05), decimation=LineCycles(on_curve=False)),
        [(20, 1, 1.8948)],
    ),
    "near, grid": (caged(nested_cages, "random 0", Within(distance=0.1), grid=0.02), [(18, 1, 1.8328)]),
    "excess": (caged(nested_cages, "random 5", Within(excess=0.3)), [(9, 1, 1.8247)]),
    "excess of two": (caged(nested_cages, "two", Within(excess=0.5)), [(7, 2, 4.4897)]),
    "excess, grid": (caged(nested_cages, "few", Within(excess=0.3), grid=0.1), [(5, 1, 1.855)]),
    "far inside": (caged(inner_cages, "random 5", Within(distance=0.2)), [(17, 1, 1.3885)]),
    "excess inside": (caged(inner_cages, "ring", Within(excess=0.25)), [(7, 2, 1.1866)]),
    "tolerances": (caged(nested_cages, "star", "0.05u 0.3u +150%"), [(20, 1, 3.0909), (8, 1, 3.6959), (3, 1, 7.3875)]),
    "slow": (moved("few", 3, 0.2, [8, 5]), [(8, 1, 1.2291), (5, 1, 1.5268)]),
    "wild": (moved("few", 3, 0.5, [7], pins=[2]), [(7, 1, 2.0561)]),
    "cyclic": (moved("star", 3, 0.2, [7], cyclic=True, clearance=0.01), [(7, 1, 3.8579)]),
    "two that move": (moved("two", 2, 0.2, [9], grid=0.01), [(9, 2, 3.1867)]),
}  # fmt: skip
FAST = 20


def outcome_of(work: Callable[[], Any]) -> Outcome:
    """Vertices, loops and area of each cage, of a moving one at its last pose; or the code of the error."""
    try:
        levels = list(work())
    except core.NestedCagesError as error:
        return error.code
    cages = [getattr(level, "cage_steps", [level.cage.vertices])[-1] for level in levels]
    meshes = [level.cage.moved(cage) for level, cage in zip(levels, cages, strict=True)]
    return [(len(mesh.vertices), len(mesh.loops), float(f"{mesh.area:.5g}")) for mesh in meshes]


@pytest.mark.parametrize(("work", "expected"), slow_after(FAST, CASES.values()), ids=CASES.keys())
def test_outcomes_are_the_recorded_ones(work: Callable[[], Any], expected: Outcome) -> None:
    if not isinstance(expected, str):
        expected = [(vertices, loops, pytest.approx(area, rel=TIGHT)) for vertices, loops, area in expected]
    assert outcome_of(work) == expected


if __name__ == "__main__":
    for name, (work, _) in CASES.items():
        print(f"{name:20} {outcome_of(work)}")
