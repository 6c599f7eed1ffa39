"""Cages that follow ten motions under three counts: certificates, area next to a cage for the pose alone, time."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from common import DETAILS, FAILED, ROOT, Options, Server, ServerError, ratios, table
from nestedcages_core import Mesh, animated_cages, nested_cages, read_svg, verify_motion
from shapes import fractal, smooth

Motion = Callable[[float], np.ndarray]
"""Phase from 0 to 1 -> vertices (n, 2)."""
FRAMES, COUNTS = 24, (16, 24, 48)
QUICK = ("mouth", "worm")


def turned(points: np.ndarray, angle: float | np.ndarray) -> np.ndarray:
    """Points (n, 2) turned about the origin, each by its angle."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]), axis=1)


def of_unit_size(points: np.ndarray) -> np.ndarray:
    """Points centred, with a bounding box of diagonal 1."""
    low, high = points.min(axis=0), points.max(axis=0)
    return (points - 0.5 * (low + high)) / np.hypot(*(high - low))


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
    a, round_, rough = (
        of_unit_size(letter.vertices[np.concatenate(letter.loops)]),
        of_unit_size(smooth(300).vertices),
        of_unit_size(fractal(512).vertices),
    )

    def bend(phase: float) -> np.ndarray:
        leaning = np.stack((a[:, 0] + 0.08 * np.sin(2.0 * np.pi * phase + 4.0 * a[:, 1]), a[:, 1]), axis=1)
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
        "letter bends": ([len(loop) for loop in letter.loops], bend),
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


def measure(sizes: list[int], poses: np.ndarray, count: int) -> dict[str, float]:
    """In a server: cages of all poses, judged and compared with cages made for every fourth pose alone."""
    fine = Mesh.from_loops(np.split(poses[0], np.cumsum(sizes)[:-1]))
    begin = time.process_time()
    level = animated_cages(fine, poses, [count]).levels[0]
    seconds = time.process_time() - begin
    cages = level.cage_steps[level.report.given]
    alone = [
        nested_cages(Mesh(poses[k], fine.edges), [count])[0].cage.area for k in range(0, len(poses), 4)
    ]  # fmt: skip
    area = [Mesh(cages[4 * k], level.cage.edges).area / one for k, one in enumerate(alone)]
    shaken = np.abs(np.diff(cages, 2, axis=0)).mean() / np.abs(np.diff(poses, 2, axis=0)).mean()
    return {
        "keys": len(level.times), "certified": sum(map(bool, level.report.certificates)),
        "free": bool(verify_motion(level.cage, fine, level.cage_steps, level.fine_steps)),
        "area": float(np.median(area)), "largest": max(area), "jitter": float(shaken),
        "seconds": seconds / len(poses),
    }  # fmt: skip


def run(options: Options) -> str:
    rows, found = [], {name: [] for name in options.trees()}
    frames = FRAMES // 3 if options.quick else FRAMES
    for name, tree in options.trees().items():
        with Server(tree, "motion:measure") as server:
            for what, (sizes, motion) in motions().items():
                if not options.wants(what) or (options.quick and what not in QUICK):
                    continue
                poses = np.array([motion(frame / frames) for frame in range(frames + 1)])
                for count in COUNTS[:1] if options.quick else COUNTS:
                    try:
                        made = server(sizes, poses, count)
                    except ServerError as error:
                        rows.append((what, name, count, *["-"] * 6, f"{FAILED}: {error}"))
                        found[name].append(None)
                        continue
                    found[name].append(made)
                    cells = (f"{made[key]:.3f}" for key in ("area", "largest", "jitter"))
                    rows.append((what, name, count, made["keys"], made["certified"], *cells,
                                 f"{1e3 * made['seconds']:.0f}", "all" if made["free"] else FAILED))  # fmt: skip
    lines = []
    for name, results in found.items():
        made = [one for one in results if one is not None]
        keys, certified = (sum(one[key] for one in made) for key in ("keys", "certified"))
        area, ms = [one["area"] for one in made], [1e3 * one["seconds"] for one in made]
        lines.append(
            f"{name}: {certified} of {keys} keys and all motion between them in {sum(one['free'] for one in made)} of "
            f"{len(results)} rows are certified;\narea, median of a row: {np.median(area):.3f} in the median, "
            f"{max(area):.3f} at most; {np.median(ms):.0f} ms a pose in the median, {max(ms):.0f} at most"
        )
    if options.against:
        pairs = [(b, n) for b, n in zip(*found.values(), strict=True) if b is not None and n is not None]
        lines.append(f"CPU time {ratios([n['seconds'] / b['seconds'] for b, n in pairs])}")
        lines.append(f"area     {ratios([n['area'] / b['area'] for b, n in pairs], 4)}")
    heads = ("motion", "of", "count", "keys", "certified", "area, median", "most", "jitter", "ms a pose", "intervals")
    return "\n".join([*lines, DETAILS, table(heads, rows)])
