"""Puppets in the runtimes of Spine and Godot: how far vertices are off in random poses.

A character of the cast a line, or the layered files that `--only` names: opaque pixels outside of hulls, and what the
engines say with each bone turned by up to 110 degrees. The runtime of Spine comes by npm; Godot is the
program of that name, or GODOT in the environment; with a display it draws too.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import shapely

from common import HERE, ROOT, Options, table
from nestedcages_core import NestedCagesError, read_png
from nestedcages_core.puppets import Animation, GamePuppet, game_puppet, read_painting, write_puppet

SCRIPTS = HERE / "engines"
PACKAGES = ("@esotericsoftware/spine-core@4.2.100",)
CHARACTERS = ("cat", "snake", "octopus", "dragon", "robot", "spider", "fairy", "minotaur")
FILES = {"godot": "puppet.tscn", "spine": "puppet.json"}
TURN, POSES, SECONDS = 110.0, 8, 120
"""Degrees of a bone in a pose, poses, and how long an engine may take."""


def swinging(puppet: GamePuppet) -> GamePuppet:
    """The puppet with an animation in which all bones turn at random and some move."""
    random, times = np.random.default_rng(1), np.array([0.0, 0.25, 1.0, 1.5])
    turned = {bone.name: random.uniform(-TURN, TURN, len(times)) for bone in puppet.bones}
    shifted = {bone.name: random.uniform(-40.0, 40.0, (len(times), 2)) for bone in puppet.bones[::3]}
    return replace(puppet, animations=(Animation("swing", times, turned, shifted),))


def expected(puppet: GamePuppet) -> dict[str, Any]:
    """Random poses, the first at rest, moments of animations, and where our skinning puts all vertices then."""
    random = np.random.default_rng(2)
    turns = [{}] + [{b.name: random.uniform(-TURN, TURN) for b in puppet.bones} for _ in range(POSES)]
    moments = [
        {"name": animation.name, "time": at, "meshes": at_time(puppet, animation, at)}
        for animation in puppet.animations
        for at in random.uniform(0.0, animation.times[-1], 3)
    ]
    side = 2 * (int(2 * np.abs(np.concatenate([mesh.points for mesh in puppet.meshes])).max()) + 50)
    poses = [{"turned": turned, "meshes": [p.tolist() for p in puppet.posed(turned)]} for turned in turns]
    return {"name": puppet.name, "poses": poses, "moments": moments, "window": [side, side], "origin": side // 2}


def at_time(puppet: GamePuppet, animation: Animation, time: float) -> list[Any]:
    """Vertices at a time of an animation, whose bones may also move: by matrices, written apart from the core."""
    matrices: list[np.ndarray] = []
    for bone in puppet.bones:
        angle = np.deg2rad(np.interp(time, animation.times, animation.turned.get(bone.name, 0 * animation.times)))
        shift = animation.shifted.get(bone.name, np.zeros((len(animation.times), 2)))
        dx, dy = (np.interp(time, animation.times, shift[:, axis]) for axis in (0, 1))
        c, s, (x, y) = np.cos(angle), np.sin(angle), bone.head
        own = np.array([[c, -s, x - c * x + s * y + dx], [s, c, y - s * x - c * y + dy], [0, 0, 1]])
        matrices.append(own if bone.parent is None else matrices[bone.parent] @ own)
    flat = [np.concatenate((mesh.points, np.ones((len(mesh.points), 1))), axis=1) for mesh in puppet.meshes]
    return [
        np.einsum("nb,bij,nj->ni", mesh.weights, np.array(matrices), points)[:, :2].tolist()
        for mesh, points in zip(puppet.meshes, flat, strict=True)
    ]


def said(command: list[str], folder: Path) -> dict[str, Any]:
    """The verdict that a program prints as its last line of JSON."""
    done = subprocess.run(command, cwd=folder, timeout=SECONDS, capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or not lines:
        raise RuntimeError(f"{command[0]} failed: {done.stdout[-1000:]} {done.stderr[-2000:]}")
    return dict(json.loads(lines[-1]))


def drawn_otherwise(folder: Path, godot: str, puppet: GamePuppet, wanted: dict[str, Any]) -> float:
    """The part of the pixels that Godot draws otherwise than triangles at our vertices, in the worst pose."""
    command = [godot, "--display-driver", "x11", "--rendering-driver", "opengl3", "--audio-driver", "Dummy"]
    command += ["--path", str(folder), "--script", "draw.gd", "--", "plain"]
    subprocess.run(command, timeout=SECONDS, capture_output=True, check=True)
    found = []
    for number, pose in enumerate(wanted["poses"]):
        ours = filled(pose["meshes"], puppet, wanted["window"], wanted["origin"])
        pixels = read_png(folder / f"pose_{number}.png")
        theirs = np.where(pixels[..., 3] > 0, pixels[..., 0].astype(int), 0)
        found.append(float((ours != theirs).sum() / max((ours > 0).sum(), 1)))
    return max(found)


def filled(meshes: list[Any], puppet: GamePuppet, window: list[int], origin: int) -> np.ndarray:
    """(H, W) the number of the topmost mesh at the centre of each pixel, from 1; 0 for none."""
    out = np.zeros((window[1], window[0]), int)
    for number, (points, mesh) in enumerate(zip(meshes, puppet.meshes, strict=True), 1):
        for corners in (np.array(points) * (1, -1) + (window[0] / 2, origin))[
            mesh.triangles if mesh.is_visible else []
        ]:
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


def corners_of(opaque: np.ndarray) -> np.ndarray:
    """(P, 2) the corners of all opaque pixels."""
    rows, columns = np.nonzero(opaque)
    return np.unique(np.concatenate([np.stack((columns + i, rows + j), 1) for i in (0, 1) for j in (0, 1)]), axis=0)


def outside(puppet: GamePuppet) -> int:
    """Corners of opaque pixels that are not within the hulls of their meshes."""
    found = 0
    for mesh in puppet.meshes:
        hull = shapely.Polygon(puppet.place.down(mesh.points[: mesh.hull]))
        shapely.prepare(hull)
        corners = corners_of(mesh.pixels[..., 3] > 0) + np.array([mesh.left, mesh.top])
        found += int((~shapely.contains_xy(hull, corners)).sum())
    return found


def judged(puppet: GamePuppet, modules: Path | None, godot: str | None) -> list[str | None]:
    """How far each engine is off in pixels, and the part of the pixels that Godot draws otherwise."""
    with tempfile.TemporaryDirectory() as name:
        folder, moving = Path(name), swinging(puppet)
        for engine, file in FILES.items():
            write_puppet(folder / file, moving, engine)
        wanted = expected(moving)
        (folder / "expected.json").write_text(json.dumps(wanted), encoding="utf-8")
        (folder / "project.godot").write_text(
            'config_version=5\n[application]\nconfig/name="judge"\n', encoding="utf-8"
        )
        row: list[str | None] = [
            f"{said(['node', str(SCRIPTS / 'spine.mjs'), name], modules)['worst']:.0e}" if modules else None
        ]
        if not godot:
            return [*row, None, None]
        for script in ("pose.gd", "draw.gd"):
            shutil.copy(SCRIPTS / script, folder)
        words = [godot, "--headless", "--path", name]
        subprocess.run([*words, "--import"], timeout=SECONDS, capture_output=True, check=False)
        row.append(f"{said([*words, '--script', 'pose.gd'], folder)['worst']:.0e}")
        drawn = drawn_otherwise(folder, godot, moving, wanted) if os.environ.get("DISPLAY") else None
        return [*row, drawn and f"{100.0 * drawn:.4f} %"]


def node_modules() -> Path | None:
    """The folder with the runtime in JavaScript, installed when first needed; none without npm."""
    folder = ROOT / "build" / "engines"
    if shutil.which("npm") is None or shutil.which("node") is None:
        return None
    if not (folder / "node_modules").exists():
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run(["npm", "install", "--silent", "--prefix", str(folder), *PACKAGES], check=True)
    return folder


def run(options: Options) -> str:
    """A line for each character or file; distances in pixels."""
    modules, godot = node_modules(), os.environ.get("GODOT") or shutil.which("godot")
    files = [Path(word) for word in options.only] or [HERE / "cast" / f"{name}.svg" for name in CHARACTERS]
    rows: list[list[object]] = []
    for file in files[: 1 if options.quick else None]:
        start = process_time()
        try:
            parts, size, _ = read_painting(file)
            puppet = game_puppet(parts, size, name="puppet")
        except NestedCagesError as error:
            rows.append([file.stem, *[None] * 8, error.code])
            continue
        seconds = process_time() - start
        turns = [min(-each.low, each.high) for each in puppet.ranges if each.low > -180.0]
        counts = len(puppet.meshes), len(puppet.bones), f"{min(turns):.0f}°" if turns else None, outside(puppet)
        rows.append([file.stem, len(parts), *counts, *judged(puppet, modules, godot), f"{seconds:.1f}", ""])
    head = ("file", "layers", "meshes", "bones", "least range", "outside", "Spine px", "Godot px")
    return table((*head, "drawn otherwise", "CPU s", "refused"), rows)
