"""DragonBones 5.5: a skeleton and its atlas, both as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..geometry.arrays import FloatArray
from .animation import Animation
from .atlas import Atlas, Region, region_points
from .local import Frames, few_decimals, in_parent, local_bones, unique_names
from .mesh import PartMesh
from .puppet import GamePuppet

VERSION = "5.5"

RATES = (24, 25, 30, 60, 120, 240)
"""Frames per second: keys lie on whole frames."""

ON_FRAME = 1e-3
"""How far off a frame a key may be, in frames."""

BLENDS = {"multiply": "multiply", "screen": "screen", "add": "add"}
"""Names of blend modes."""


def to_dragonbones(puppet: GamePuppet, atlas: Atlas) -> str:
    """The text of a skeleton (_ske.json)."""
    slots = unique_names((mesh.name for mesh in puppet.meshes), "")
    rate = _rate(puppet.animations)
    entries: list[dict[str, Any]] = []
    displays: list[dict[str, Any]] = []
    for mesh, slot, region in zip(puppet.meshes, slots, atlas.regions, strict=True):
        entry: dict[str, Any] = {"name": slot, "parent": puppet.bones[mesh.strongest].name}
        if not mesh.is_visible:
            entry["displayIndex"] = -1
        if mesh.blend in BLENDS:
            entry["blendMode"] = BLENDS[mesh.blend]
        entries.append(entry)
        displays.append({"name": slot, "display": [_display(puppet, mesh, slot, region)]})
    points = np.concatenate([mesh.points for mesh in puppet.meshes]) * (1.0, -1.0)
    x, y, width, height = few_decimals(np.concatenate((points.min(axis=0), np.ptp(points, axis=0))))
    armature = {
        "type": "Armature",
        "name": puppet.name,
        "frameRate": rate,
        "aabb": {"x": x, "y": y, "width": width, "height": height},
        "bone": [_dragonbones_bone(puppet, k) for k in range(len(puppet.bones))],
        "slot": entries,
        "skin": [{"name": "", "slot": displays}],
        "animation": [_dragonbones_animation(puppet, animation, rate) for animation in puppet.animations],
        "defaultActions": [],
    }
    document = {
        "frameRate": rate,
        "name": puppet.name,
        "version": VERSION,
        "compatibleVersion": VERSION,
        "armature": [armature],
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False)


def to_dragonbones_atlas(puppet: GamePuppet, atlas: Atlas, picture: str) -> str:
    """The text of an atlas (_tex.json). picture: name of the page's file."""
    names = unique_names((mesh.name for mesh in puppet.meshes), "")
    regions = [
        {"name": name, "x": region.x, "y": region.y, "width": region.width, "height": region.height}
        for name, region in zip(names, atlas.regions, strict=True)
    ]
    width, height = atlas.size
    document = {"name": puppet.name, "imagePath": picture, "width": width, "height": height, "SubTexture": regions}
    return json.dumps(document, ensure_ascii=False)


def _dragonbones_bone(puppet: GamePuppet, number: int) -> dict[str, Any]:
    bone, local, proved = puppet.bones[number], local_bones(puppet.bones)[number], puppet.ranges[number]
    x, y, degrees, length = few_decimals(np.array(local) * (1.0, -1.0, -1.0, 1.0))
    entry = {"name": bone.name, "length": length, "transform": {"x": x, "y": y, "skX": degrees, "skY": degrees}}
    if bone.parent is not None:
        entry["parent"] = puppet.bones[bone.parent].name
    if proved.low > -180.0 or proved.high < 180.0:
        entry["userData"] = {"floats": [-proved.high, -proved.low]}  # y points down, so angles turn over
    return entry


def _display(puppet: GamePuppet, mesh: PartMesh, name: str, region: Region) -> dict[str, Any]:
    frames = Frames.of(puppet.bones)
    used = np.flatnonzero(mesh.weights.any(axis=0)).tolist()
    pose: list[float] = []
    for bone in used:  # the matrix of each bone at rest, y pointing down
        angle, (x, y) = -float(frames.angles[bone]), frames.heads[bone]
        c, s = np.cos(angle), np.sin(angle)
        pose += [bone, *few_decimals(np.array([c, s, -s, c, x, -y]))]
    weights: list[float] = []
    for row in mesh.weights:
        own = np.flatnonzero(row).tolist()
        weights.append(len(own))
        for bone in own:
            weights += [bone, float(row[bone])]
    ring = np.arange(mesh.hull)
    uv = region_points(mesh.points, region, puppet.place) / (region.width, region.height)
    return {
        "type": "mesh",
        "name": name,
        "width": region.width,
        "height": region.height,
        "vertices": few_decimals(mesh.points * (1.0, -1.0)),
        "uvs": few_decimals(uv),
        "triangles": mesh.triangles[:, ::-1].ravel().tolist(),
        "weights": weights,
        "slotPose": [1, 0, 0, 1, 0, 0],
        "bonePose": pose,
        "edges": np.stack((ring, np.roll(ring, -1)), axis=1).ravel().tolist(),
        "userEdges": [],
    }


def _rate(animations: Sequence[Animation]) -> int:
    """The fewest frames per second that have all keys on frames."""
    times = np.concatenate([animation.times for animation in animations]) if animations else np.zeros(1)
    for rate in RATES:
        if np.abs(times * rate - np.round(times * rate)).max() < ON_FRAME:
            return rate
    return RATES[-1]


def _dragonbones_animation(puppet: GamePuppet, animation: Animation, rate: int) -> dict[str, Any]:
    frames = np.round(animation.times * rate).astype(int)
    durations = [*np.diff(frames).tolist(), 0]

    def keys(values: FloatArray, names: Sequence[str]) -> list[dict[str, Any]]:
        rows = [few_decimals(row) for row in values.reshape(len(durations), -1)]
        return [
            {"duration": duration, "tweenEasing": 0, **dict(zip(names, row, strict=True))}
            for duration, row in zip(durations, rows, strict=True)
        ]

    number = {bone.name: k for k, bone in enumerate(puppet.bones)}
    bones: dict[str, Any] = {}
    for name, degrees in animation.turned.items():
        bones.setdefault(name, {"name": name})["rotateFrame"] = keys(-np.asarray(degrees), ["rotate"])
    for name, shifts in animation.shifted.items():
        moves = in_parent(puppet.bones, number[name], shifts) * (1.0, -1.0)
        bones.setdefault(name, {"name": name})["translateFrame"] = keys(moves, ["x", "y"])
    return {
        "name": animation.name,
        "duration": int(frames[-1]),
        "playTimes": 0 if animation.loops else 1,
        "bone": list(bones.values()),
    }
