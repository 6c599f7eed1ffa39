"""Cages that follow a moving drawing: ten motions under three counts, one table and one picture.

    python benchmarks/motions.py [--plot docs/motions.png] [--frames 24] [--counts 16 24 48]

Per motion and count: keys added, certified poses and intervals, area beside a cage made for the pose alone (median and
largest of every fourth pose), jitter (mean second difference of the cage beside the drawing's own), and time a pose.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from clone import ROOT
from nestedcages_core import (
    Mesh,
    NestedCagesError,
    animated_cages,
    nested_cages,
    read_svg,
    verify_motion,
)

Motion = Callable[[float], np.ndarray]
"""Phase from 0 to 1 -> vertices (n, 2); the loops of pose 0 give the topology."""


def turned(points: np.ndarray, angle: float | np.ndarray) -> np.ndarray:
    """Points (n, 2) turned about the origin, each by its angle."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]), axis=1)


def of_unit_size(points: np.ndarray) -> np.ndarray:
    """Points centred, with a bounding box of diagonal 1."""
    low, high = points.min(axis=0), points.max(axis=0)
    return (points - 0.5 * (low + high)) / np.hypot(*(high - low))


def blob(seed: int, count: int = 300) -> np.ndarray:
    """A smooth star-shaped outline."""
    random = np.random.default_rng(seed)
    angle = 2.0 * np.pi * np.arange(count) / count
    radius = 1.0 + sum(0.25 / k * random.normal() * np.cos(k * angle + random.uniform(0, 7)) for k in range(2, 10))
    return of_unit_size(np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=1))


def coast(seed: int, halvings: int = 7) -> np.ndarray:
    """A square whose edges are halved and displaced again and again."""
    random = np.random.default_rng(seed)
    points = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    for _ in range(halvings):
        onward = np.roll(points, -1, axis=0)
        length = np.hypot(*(onward - points).T)[:, None]
        middle = 0.5 * (points + onward) + 0.11 * length * random.normal(size=points.shape)
        points = np.stack((points, middle), axis=1).reshape(-1, 2)
    return of_unit_size(points)


def strip(middle: np.ndarray, width: float) -> np.ndarray:
    """The outline of a band (2k, 2) along a line (k, 2)."""
    along = np.gradient(middle, axis=0)
    normal = np.stack((-along[:, 1], along[:, 0]), axis=1) / np.hypot(*along.T)[:, None]
    return np.concatenate((middle - width * normal, (middle + width * normal)[::-1]))


def limb(phase: float, lag: float) -> np.ndarray:
    """The middle of a leg (40, 2) that swings and bends at the knee."""
    along, swing = np.linspace(0.0, 1.0, 40), 2.0 * np.pi * phase + lag
    angle = 0.6 * np.sin(swing) - 0.45 * (1.0 + np.sin(swing + 1.0)) / (1.0 + np.exp(-14.0 * (along - 0.5)))
    steps = np.stack((np.sin(angle), -np.cos(angle)), axis=1) / 39.0
    return np.concatenate((np.zeros((1, 2)), np.cumsum(steps, axis=0)[:-1]))


def mouth(phase: float) -> np.ndarray:
    """A disc with a mouth that opens and closes."""
    gape = 0.35 + 0.25 * np.cos(2.0 * np.pi * phase)
    angle = np.linspace(gape, 2.0 * np.pi - gape, 160)
    rim, lip = np.stack((np.cos(angle), np.sin(angle)), axis=1), np.linspace(1.0, 0.15, 40)[1:-1, None]
    return 0.35 * np.concatenate((rim, lip * rim[-1], [[-0.15, 0.0]], lip[::-1] * rim[0]))


def curl(phase: float) -> np.ndarray:
    """A strip that rolls up and unrolls."""
    along, bend = np.linspace(-0.5, 0.5, 150), 2.2 * (1.0 - np.cos(2.0 * np.pi * phase)) + 1e-3
    return strip(np.stack((np.sin(bend * along), 1.0 - np.cos(bend * along)), axis=1) / bend, 0.04)


def worm(phase: float) -> np.ndarray:
    """A strip with a wave that travels along it."""
    along = np.linspace(-0.5, 0.5, 150)
    height = 0.12 * np.sin(2.0 * np.pi * phase + 9.0 * along) * (0.6 + along)
    return np.concatenate([np.stack((along, height - 0.03), axis=1), np.stack((along, height + 0.03), axis=1)[::-1]])


def motions() -> dict[str, tuple[list[int], Motion]]:
    """Name -> sizes of the loops, and the motion."""
    letter = read_svg(ROOT / "examples" / "letter_a.svg", tolerance=0.5)
    order = np.concatenate(letter.loops)
    a, round_, rough = of_unit_size(letter.vertices[order]), blob(0), coast(1)
    sizes = [len(loop) for loop in letter.loops]

    def bend(phase: float) -> np.ndarray:
        wave = np.sin(2.0 * np.pi * phase + 4.0 * a[:, 1])
        leaning = np.stack((a[:, 0] + 0.08 * wave, a[:, 1]), axis=1)
        return turned(leaning, 0.5 * np.sin(2.0 * np.pi * phase) * (0.5 - a[:, 1]))

    def cloth(phase: float) -> np.ndarray:
        shift = [np.sin(2.0 * np.pi * phase + 6.0 * rough[:, 1]), np.cos(2.0 * np.pi * phase + 5.0 * rough[:, 0])]
        return rough + 0.04 * np.stack(shift, axis=1)

    def walk(phase: float) -> np.ndarray:
        legs = [strip(limb(phase, lag) + np.array([away, 0.0]), 0.07) for lag, away in ((0.0, 0.0), (np.pi, 1.6))]
        return np.concatenate(legs)

    def breathe(phase: float) -> np.ndarray:
        return round_ * (1.0 + 0.3 * np.sin(2.0 * np.pi * phase)) * [1.0 + 0.1 * np.cos(2.0 * np.pi * phase), 1.0]

    def twist(phase: float) -> np.ndarray:
        return turned(rough, 1.2 * np.sin(2.0 * np.pi * phase) * np.hypot(*rough.T))

    def roll(phase: float) -> np.ndarray:
        return turned(round_, -2.0 * np.pi * phase) + np.array([0.8 * np.pi * phase, 0.0])

    return {
        "letter bends": (sizes, bend),
        "blob breathes": ([len(round_)], breathe),
        "blob turns": ([len(round_)], lambda phase: turned(round_, 2.0 * np.pi * phase)),
        "blob rolls": ([len(round_)], roll),
        "coast in waves": ([len(rough)], cloth),
        "coast twists": ([len(rough)], twist),
        "mouth": ([len(mouth(0.0))], mouth),
        "legs walk": ([80, 80], walk),
        "strip curls": ([300], curl),
        "worm": ([300], worm),
    }


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--frames", type=int, default=24)
    options.add_argument("--counts", type=int, nargs="+", default=[16, 24, 48])
    options.add_argument("--plot", type=Path)
    chosen = options.parse_args()
    columns = ["motion", "vertices", "count", "poses", "keys added", "intervals", "area, median", "area, most"]
    columns += ["jitter", "ms a pose"]
    print(f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}")
    drawn, failures = {}, 0
    areas, times, certified_all, keys_all, free_all = [], [], 0, 0, 0
    for name, (sizes, motion) in motions().items():
        poses = np.array([motion(frame / chosen.frames) for frame in range(chosen.frames + 1)])
        fine = Mesh.from_loops(np.split(poses[0], np.cumsum(sizes)[:-1]))
        for count in chosen.counts:
            began = time.process_time()
            try:
                level = animated_cages(fine, poses, [count]).levels[0]
            except NestedCagesError as error:
                print(f"| {name} | {len(poses[0])} | {count} | failed: {error} |", flush=True)
                failures += 1
                continue
            spent = 1e3 * (time.process_time() - began) / len(poses)
            cages = level.cage_steps[level.report.given]
            ratio = [
                level.cage.moved(cages[k]).area / nested_cages(fine.moved(poses[k]).validated(), [count]).cages[0].area
                for k in range(0, len(poses), 4)
            ]
            free = verify_motion(level.cage, fine, level.cage_steps, level.fine_steps)
            shaken = np.abs(np.diff(cages, 2, axis=0)).mean() / np.abs(np.diff(poses, 2, axis=0)).mean()
            certified, added = sum(map(bool, level.report.certificates)), level.report.keys_added
            areas.append(float(np.median(ratio)))
            times.append(spent)
            certified_all, keys_all, free_all = (
                certified_all + certified,
                keys_all + len(level.times),
                free_all + bool(free),
            )
            cells = [name, len(poses[0]), count, f"{certified} of {len(level.times)}", added]
            cells += ["all" if free else "not all", f"{np.median(ratio):.3f}", f"{max(ratio):.3f}"]
            cells += [f"{shaken:.2f}", f"{spent:.0f}"]
            print(f"| {' | '.join(map(str, cells))} |", flush=True)
            drawn.setdefault(name, (fine, poses, level))
    if areas:
        print(
            f"\n{certified_all} of {keys_all} keys and all motion between them in {free_all} of {len(areas)} rows are "
            f"certified; area, median of a row: {np.median(areas):.3f} in the median, {max(areas):.3f} at most; "
            f"{np.median(times):.0f} ms a pose in the median, {max(times):.0f} at most"
        )
    if chosen.plot:
        plot(drawn, chosen.plot)
    return failures


def plot(drawn: dict, path: Path) -> None:
    """Four poses of each motion with their cages."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    shown = 4
    figure, axes = plt.subplots(len(drawn), shown, figsize=(2.2 * shown, 2.2 * len(drawn)))
    for row, (name, (fine, poses, level)) in zip(np.atleast_2d(axes), drawn.items(), strict=True):
        for axis, k in zip(row, np.linspace(0, len(poses) - 1, shown + 1).astype(int)[:-1], strict=True):
            for loop in fine.loops:
                axis.fill(*poses[k][loop].T, color="0.75")
            cage = level.cage_steps[level.report.given[k]]
            for loop in level.cage.loops:
                axis.plot(*cage[np.append(loop, loop[0])].T, color="tab:red", marker=".", markersize=3, linewidth=1)
            axis.set_aspect("equal")
            axis.axis("off")
        row[0].set_title(name, fontsize=9, loc="left")
    figure.tight_layout()
    figure.savefig(path, dpi=80)


if __name__ == "__main__":
    sys.exit(main())
