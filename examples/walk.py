"""A character walks, and the two cages of each of its parts walk with it: certified at every instant.

Run as ``python examples/walk.py``; writes a picture, a GIF, and the hitboxes of each frame as JSON for game engines.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from PIL import Image

from nestedcages_core import Mesh, MovingCages, Settings, animated_cages, frames_to_engine_json, verify_motion
from plot import BLUE, BODY, GREEN, INK, QUIET, arguments, fill, line, save

FRAMES, LEVELS = 24, [20, 8]
CLEARANCE = 0.004
SHOWN = 6  # frames of the picture
VIEW = (-0.95, 1.05, -1.5, 1.25)  # left, right, lower and upper end of what is drawn
FAR, NEAR = "#a9b8cc", BODY


def bent(start: np.ndarray, angles: np.ndarray, length: float) -> np.ndarray:
    """A line (k, 2) from a point on, whose pieces have these directions, 0 pointing down."""
    steps = np.stack((np.sin(angles), -np.cos(angles)), axis=1) * (length / len(angles))
    return np.concatenate((start[None], start + np.cumsum(steps, axis=0)))


def limb(start: np.ndarray, swing: float, bend: float, length: float, width: tuple[float, float]) -> np.ndarray:
    """The outline of an arm or a leg: it swings about its start and bends in its middle."""
    along = np.linspace(0.0, 1.0, 36)
    middle = bent(start, swing + bend / (1.0 + np.exp(-16.0 * (along - 0.5))), length)
    onward = np.gradient(middle, axis=0)
    across = np.stack((-onward[:, 1], onward[:, 0]), axis=1) / np.hypot(*onward.T)[:, None]
    along = np.linspace(0.0, 1.0, len(middle))
    radius = width[0] + (width[1] - width[0]) * along + 0.02 * np.sin(3.0 * np.pi * along)
    left, right = middle + radius[:, None] * across, middle - radius[:, None] * across
    turn = np.linspace(0.0, np.pi, 10)[1:-1, None]
    forward = onward / np.hypot(*onward.T)[:, None]
    foot = middle[-1] + radius[-1] * (np.sin(turn) * forward[-1] - np.cos(turn) * across[-1])
    top = middle[0] + radius[0] * (np.cos(turn) * across[0] - np.sin(turn) * forward[0])
    return np.concatenate((right, foot, left[::-1], top))


def trunk(sway: float) -> np.ndarray:
    """Body, neck and head with a nose."""
    turn = np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False)
    x, y = np.cos(turn), np.sin(turn)
    nose = 0.1 * np.exp(-((turn - 0.75) ** 2) / 0.008)
    neck = 1.0 - 0.55 * np.exp(-((y - 0.28) ** 2) / 0.012)
    points = np.stack((x * (0.27 * neck + nose), 0.35 + 0.78 * y), axis=1)
    lean = 0.06 + sway * points[:, 1]
    return np.stack((points[:, 0] + lean * points[:, 1], points[:, 1]), axis=1)


def parts(phase: float) -> dict[str, np.ndarray]:
    """The outlines of a pose, from the back to the front."""
    a = 2.0 * np.pi * phase
    lift = np.array([0.0, 0.04 * np.cos(2.0 * a)])
    hip, shoulder = np.array([0.0, -0.25]) + lift, np.array([0.1, 0.45]) + lift
    outlines = {}
    for name, lag in (("far", np.pi), ("near", 0.0)):
        s = np.sin(a + lag)
        knee = -0.55 * (1.0 + np.sin(a + lag + 1.1))
        outlines[f"{name} arm"] = limb(shoulder, -0.7 * s, 0.5 + 0.3 * s, 0.85, (0.10, 0.06))
        outlines[f"{name} leg"] = limb(hip, 0.55 * s + 0.15, knee, 1.05, (0.15, 0.08))
    body = trunk(0.03 * np.cos(2.0 * a)) + lift
    return {
        "far arm": outlines["far arm"],
        "far leg": outlines["far leg"],
        "body": body,
        "near leg": outlines["near leg"],
        "near arm": outlines["near arm"],
    }


def draw(axes: plt.Axes, cycle: dict[str, tuple[Mesh, np.ndarray, MovingCages]], frame: int) -> None:
    """One frame with both cages of every part."""
    for name, (fine, poses, moving) in cycle.items():
        fill(axes, fine.moved(poses[frame]), FAR if name.startswith("far") else NEAR)
        line(axes, fine.moved(poses[frame]), INK if not name.startswith("far") else QUIET, 1.0)
        for level, colour in zip(moving.levels, (GREEN, BLUE), strict=True):
            cage = level.cage_steps[np.searchsorted(level.times, frame)]
            line(axes, level.cage.moved(cage), colour, 1.3, 5.0)
    axes.axis("off")
    axes.set_aspect("equal")
    axes.set_xlim(*VIEW[:2])
    axes.set_ylim(*VIEW[2:])


def clip(cycle: dict[str, tuple[Mesh, np.ndarray, MovingCages]], frames: int, path: Path) -> None:
    """An animated GIF of one step and the next."""
    pictures = []
    for frame in range(frames):
        figure, axes = plt.subplots(figsize=(3.2, 3.4), dpi=90)
        figure.subplots_adjust(0, 0, 1, 1)
        draw(axes, cycle, frame)
        figure.canvas.draw()
        pictures.append(Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB"))
        plt.close(figure)
    palette = pictures[0].quantize(48, dither=Image.Dither.NONE)
    few = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    few[0].save(path, save_all=True, append_images=few[1:], duration=60, loop=0, optimize=True)
    print(f"Wrote {path}")


def main() -> None:
    given = arguments(__doc__)
    frames = 8 if given.small else FRAMES
    poses = [parts(frame / frames) for frame in range(frames)]
    cycle = {}
    for name in poses[0]:
        outlines = np.array([pose[name] for pose in poses])
        fine = Mesh.from_loops([outlines[0]])
        moving = animated_cages(fine, outlines, LEVELS, Settings(clearance=CLEARANCE), cyclic=True)
        for level, inner in zip(moving.levels, (fine, moving.levels[0].cage), strict=True):
            assert verify_motion(level.cage, inner, level.cage_steps, level.fine_steps)
        outer = moving.levels[-1]
        print(f"{name}: {outer.report}")
        text = frames_to_engine_json([outer.cage.moved(step) for step in outer.cage_steps], outer.times / frames)
        (given.output / f"walk_{name.replace(' ', '_')}.json").write_text(text, encoding="utf-8")
        cycle[name] = fine, outlines, moving

    shown = min(SHOWN, frames)
    figure, axes = plt.subplots(1, shown, figsize=(2.6 * shown, 2.8), layout="constrained")
    for each, frame in zip(axes, np.linspace(0, frames, shown, endpoint=False).astype(int), strict=True):
        draw(each, cycle, int(frame))
    save(figure, given.output / "walk.png")
    clip(cycle, frames, given.output / "walk.gif")


if __name__ == "__main__":
    main()
