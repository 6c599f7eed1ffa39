"""Puppets of layered files, judged: opaque pixels outside, vertices where engines put them, and what Godot draws.

    python -m benchmarks.engines.judge FILE ... [--modules FOLDER] [--godot PROGRAM] [--draw] [--poses N]

A line for each layered picture: what its puppet has, corners of opaque pixels outside of hulls, and how far engines are
off in random poses with each bone turned by up to ±110°; or the sentence with which it ends. Modules: a folder in which
`npm install @esotericsoftware/spine-core@4.2.100 @cocos/dragonbones-js@1.0.2` was run. Godot: a Godot 4; drawing needs
a display, such as one by xvfb-run.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import shapely

from nestedcages_core import NestedCagesError
from nestedcages_core.exchange.pictures import read_png
from nestedcages_core.game import Animation, GamePuppet, game_puppet, read_painting, write_puppet
from nestedcages_core.puppet import JointRange

HERE = Path(__file__).parent
PACKAGES = ("@esotericsoftware/spine-core@4.2.100", "@cocos/dragonbones-js@1.0.2")
MOST_TURN = 110.0
"""Degrees of a bone in a pose."""

SECONDS = 120
"""An engine may take this long."""

NAMES = {"godot": "puppet.tscn", "spine": "puppet.json", "dragonbones": "puppet_ske.json"}


def swinging(puppet: GamePuppet, seed: int = 1) -> GamePuppet:
    """The puppet with an animation in which all bones turn at random and roots move."""
    rng = np.random.default_rng(seed)
    times = np.array([0.0, 0.25, 1.0, 1.5])
    turned = {bone.name: rng.uniform(-MOST_TURN, MOST_TURN, len(times)) for bone in puppet.bones}
    shifted = {bone.name: rng.uniform(-40.0, 40.0, (len(times), 2)) for bone in puppet.bones[::3]}
    return replace(puppet, animations=(Animation("swing", times, turned, shifted),))


def expected(puppet: GamePuppet, poses: int, seed: int = 2) -> dict[str, Any]:
    """Random poses, the first at rest, moments of animations, and where our skinning puts all vertices then."""
    rng = np.random.default_rng(seed)
    turns = [{}] + [{b.name: rng.uniform(-MOST_TURN, MOST_TURN) for b in puppet.bones} for _ in range(poses)]
    moments = []
    for animation in puppet.animations:
        for time in rng.uniform(0.0, animation.times[-1], 3):
            moments.append({"name": animation.name, "time": time, "meshes": _at(puppet, animation, time)})
    return {
        "name": puppet.name,
        "poses": [{"turned": t, "meshes": [p.tolist() for p in puppet.posed(t)]} for t in turns],
        "moments": moments,
    }


def _at(puppet: GamePuppet, animation: Animation, time: float) -> list[Any]:
    """Vertices at a time of an animation, whose bones may also move: by matrices, written apart from the core."""
    matrices: list[np.ndarray] = []
    for bone in puppet.bones:
        angle = np.deg2rad(np.interp(time, animation.times, animation.turned.get(bone.name, 0 * animation.times)))
        shift = animation.shifted.get(bone.name, np.zeros((len(animation.times), 2)))
        dx, dy = (np.interp(time, animation.times, shift[:, axis]) for axis in (0, 1))
        c, s, (x, y) = np.cos(angle), np.sin(angle), bone.head
        own = np.array([[c, -s, x - c * x + s * y + dx], [s, c, y - s * x - c * y + dy], [0, 0, 1]])
        matrices.append(own if bone.parent is None else matrices[bone.parent] @ own)
    found = []
    for mesh in puppet.meshes:
        flat = np.concatenate((mesh.points, np.ones((len(mesh.points), 1))), axis=1)
        found.append(np.einsum("nb,bij,nj->ni", mesh.weights, np.array(matrices), flat)[:, :2].tolist())
    return found


def written(puppet: GamePuppet, folder: Path, poses: int) -> dict[str, Any]:
    """Write the puppet for all engines with what is expected of it; returns that."""
    for engine, name in NAMES.items():
        write_puppet(folder / name, puppet, engine)
    points = np.concatenate([mesh.points for mesh in puppet.meshes])
    side = 2 * (int(2 * np.abs(points).max()) + 50)
    wanted = {**expected(puppet, poses), "window": [side, side], "origin": side // 2}
    (folder / "expected.json").write_text(json.dumps(wanted), encoding="utf-8")
    (folder / "project.godot").write_text('config_version=5\n[application]\nconfig/name="judge"\n', encoding="utf-8")
    return wanted


def by_node(script: str, folder: Path, modules: Path) -> dict[str, Any]:
    """The verdict of a runtime in JavaScript."""
    return _said(["node", str(HERE / script), str(folder)], modules)


def by_godot(folder: Path, godot: str) -> dict[str, Any]:
    """The verdict of Godot."""
    (folder / "pose.gd").write_bytes((HERE / "pose.gd").read_bytes())
    subprocess.run(
        [godot, "--headless", "--path", folder, "--import"], timeout=SECONDS, capture_output=True, check=False
    )
    return _said([godot, "--headless", "--path", str(folder), "--script", "pose.gd"], folder)


def _said(command: list[str], folder: Path) -> dict[str, Any]:
    done = subprocess.run(command, cwd=folder, timeout=SECONDS, capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or not lines:
        raise RuntimeError(f"{command[0]} failed: {done.stdout[-1000:]} {done.stderr[-2000:]}")
    result: dict[str, Any] = json.loads(lines[-1])
    return result | {"said": done.stderr}


def draw(folder: Path, godot: str, count: int, *words: str) -> list[Path]:
    """Pictures by Godot of the poses in a folder."""
    (folder / "draw.gd").write_bytes((HERE / "draw.gd").read_bytes())
    command = [godot, "--display-driver", "x11", "--rendering-driver", "opengl3", "--audio-driver", "Dummy"]
    command += ["--path", str(folder), "--script", "draw.gd", "--", *words]
    done = subprocess.run(command, timeout=SECONDS, capture_output=True, text=True, check=False)
    pictures = [folder / f"pose_{number}.png" for number in range(count)]
    if not all(picture.exists() for picture in pictures):
        raise RuntimeError(f"Godot drew nothing: {done.stdout[-500:]} {done.stderr[-1000:]}")
    return pictures


def drawn_by_godot(folder: Path, godot: str, wanted: dict[str, Any], puppet: GamePuppet) -> list[float]:
    """For each pose, the part of the drawn pixels that differ from triangles at our vertices."""
    found = []
    pictures = draw(folder, godot, len(wanted["poses"]), "plain")
    for picture, pose in zip(pictures, wanted["poses"], strict=True):
        ours = _filled(pose["meshes"], puppet, wanted["window"], wanted["origin"])
        pixels = read_png(picture)
        theirs = np.where(pixels[..., 3] > 0, pixels[..., 0].astype(int), 0)
        found.append(float((ours != theirs).sum() / max((ours > 0).sum(), 1)))
    return found


def _filled(meshes: list[Any], puppet: GamePuppet, window: list[int], origin: int) -> np.ndarray:
    """(H, W) the number of the topmost mesh at the centre of each pixel, from 1; 0 for none."""
    out = np.zeros((window[1], window[0]), int)
    for number, (points, mesh) in enumerate(zip(meshes, puppet.meshes, strict=True), 1):
        if not mesh.is_visible:
            continue
        places = np.array(points) * (1, -1) + (window[0] / 2, origin)
        for corners in places[mesh.triangles]:
            low = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0)
            high = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 1, window)
            y, x = np.mgrid[low[1] : high[1], low[0] : high[0]] + 0.5
            sides = [
                (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
                for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True)
            ]
            inside = np.all([s >= 0 for s in sides], axis=0) | np.all([s <= 0 for s in sides], axis=0)
            out[low[1] : high[1], low[0] : high[0]][inside] = number
    return out


def outside(puppet: GamePuppet) -> int:
    """Corners of opaque pixels that are not within the hulls of their meshes."""
    found = 0
    for mesh in puppet.meshes:
        hull = shapely.Polygon(puppet.place.down(mesh.points[: mesh.hull]))
        shapely.prepare(hull)
        corners = corners_of(mesh.pixels[..., 3] > 0) + np.array([mesh.left, mesh.top])
        found += int((~shapely.contains_xy(hull, corners)).sum())
    return found


def corners_of(opaque: np.ndarray) -> np.ndarray:
    """(P, 2) the corners of all opaque pixels."""
    rows, columns = np.nonzero(opaque)
    return np.unique(np.concatenate([np.stack((columns + i, rows + j), 1) for i in (0, 1) for j in (0, 1)]), axis=0)


def judged(puppet: GamePuppet, given: argparse.Namespace) -> list[str]:
    """How far engines are off, in pixels, and the part of pixels that Godot draws otherwise."""
    with tempfile.TemporaryDirectory() as name:
        folder, moving = Path(name), swinging(puppet)
        wanted = written(moving, folder, given.poses)
        said = []
        for script in ("spine.mjs", "dragonbones.mjs") if given.modules else ():
            verdict = by_node(script, folder, given.modules)
            said.append(f"{script.removesuffix('.mjs')} {verdict['version']} {verdict['worst']:.1e} px")
        if given.godot:
            verdict = by_godot(folder, given.godot)
            said.append(f"Godot {verdict['version']} {verdict['worst']:.1e} px")
        if given.godot and given.draw:
            parts = drawn_by_godot(folder, given.godot, wanted, moving)
            said.append(f"drawing {100 * max(parts):.4f} % of pixels differ at worst")
        return said


def told(file: Path, given: argparse.Namespace) -> str:
    """What becomes of a layered picture: its puppet with the verdicts on it, or the sentence with which it ends."""
    start = process_time()
    try:
        parts, size, _ = read_painting(file)
        puppet = game_puppet(parts, size, name="puppet")
    except NestedCagesError as error:
        return str(error)
    seconds = process_time() - start
    turns = [min(-each.low, each.high) for each in puppet.ranges if each != JointRange()]
    bends = f"{len(turns)} bends of ±{min(turns):.0f}° or more" if turns else "no bends"
    counts = f"{len(parts)} layers, {len(puppet.meshes)} meshes, {len(puppet.bones)} bones, {bends}"
    return ", ".join((counts, f"{outside(puppet)} outside", *judged(puppet, given), f"{seconds:.1f} s of CPU"))


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("files", nargs="+", type=Path)
    options.add_argument("--modules", type=Path)
    options.add_argument("--godot")
    options.add_argument("--draw", action="store_true")
    options.add_argument("--poses", type=int, default=8)
    given = options.parse_args()
    for file in given.files:
        print(f"{file.name}: {told(file, given)}", flush=True)


if __name__ == "__main__":
    main()
