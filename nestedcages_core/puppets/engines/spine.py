"""Spine 4.2: a skeleton as JSON, and its atlas."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from .animation import Animation
from .atlas import Atlas, Region, region_points
from .puppet import GamePuppet
from .rig import Frames, few_decimals, in_parent, local_bones, unique_names
from .textured_mesh import PartMesh

VERSION = "4.2.22"

BLENDS = {"multiply": "multiply", "screen": "screen", "add": "additive"}
"""Names of blend modes."""

HALF_CIRCLE = 180.0
"""Degrees within which a range is free."""


def to_spine(puppet: GamePuppet, atlas: Atlas) -> str:
    """The text of a skeleton in Spine's JSON."""
    slots = unique_names((mesh.name for mesh in puppet.meshes), "\n\r")
    (root,) = unique_names(["root"], "", (bone.name for bone in puppet.bones))
    attachments: dict[str, Any] = {}
    entries: list[dict[str, Any]] = []
    for mesh, slot, region in zip(puppet.meshes, slots, atlas.regions, strict=True):
        entry = {"name": slot, "bone": puppet.bones[mesh.strongest].name}
        if mesh.is_visible:
            entry["attachment"] = slot
        if mesh.blend in BLENDS:
            entry["blend"] = BLENDS[mesh.blend]
        entries.append(entry)
        attachments[slot] = {slot: _attachment(puppet, mesh, region)}
    points = np.concatenate([mesh.points for mesh in puppet.meshes])
    x, y, width, height = few_decimals(np.concatenate((points.min(axis=0), np.ptp(points, axis=0))))
    document = {
        "skeleton": {"spine": VERSION, "x": x, "y": y, "width": width, "height": height, "images": "./"},
        "bones": [{"name": root}, *(_spine_bone(puppet, k, root) for k in range(len(puppet.bones)))],
        "slots": entries,
        "skins": [{"name": "default", "attachments": attachments}],
        "animations": {animation.name: _spine_animation(puppet, animation) for animation in puppet.animations},
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False)


def to_spine_atlas(puppet: GamePuppet, atlas: Atlas, picture: str) -> str:
    """The text of an .atlas. picture: name of the page's file."""
    names = unique_names((mesh.name for mesh in puppet.meshes), "\n\r")
    lines = [picture, f"size: {atlas.size[0]}, {atlas.size[1]}", "filter: Linear, Linear"]
    for name, region in zip(names, atlas.regions, strict=True):
        lines += [name, f"bounds: {region.x}, {region.y}, {region.width}, {region.height}"]
    return "\n".join(lines) + "\n"


def _spine_bone(puppet: GamePuppet, number: int, root: str) -> dict[str, Any]:
    bone, local, proved = puppet.bones[number], local_bones(puppet.bones)[number], puppet.ranges[number]
    x, y, degrees, length = few_decimals(np.array(local))
    entry = {
        "name": bone.name,
        "parent": root if bone.parent is None else puppet.bones[bone.parent].name,
        "length": length,
        "rotation": degrees,
        "x": x,
        "y": y,
    }
    if proved.low > -HALF_CIRCLE or proved.high < HALF_CIRCLE:
        entry["proved_degrees"] = [proved.low, proved.high]
    return entry


def _attachment(puppet: GamePuppet, mesh: PartMesh, region: Region) -> dict[str, Any]:
    frames = Frames.of(puppet.bones)
    inside = {int(bone): frames.inside(int(bone), mesh.points) for bone in np.flatnonzero(mesh.weights.any(axis=0))}
    vertices: list[float] = []
    if len(inside) == 1:  # moved by its slot's bone alone
        vertices = few_decimals(next(iter(inside.values())))
    else:
        for k, row in enumerate(mesh.weights):
            used = np.flatnonzero(row).tolist()
            vertices.append(len(used))
            for bone in used:
                vertices += [bone + 1, *few_decimals(inside[bone][k]), float(row[bone])]  # bone 0 is the root
    uv = region_points(mesh.points, region, puppet.place) / (region.width, region.height)
    ring = np.arange(mesh.hull)
    return {
        "type": "mesh",
        "uvs": few_decimals(uv),
        "triangles": mesh.triangles.ravel().tolist(),
        "vertices": vertices,
        "hull": mesh.hull,
        "edges": (2 * np.stack((ring, np.roll(ring, -1)), axis=1)).ravel().tolist(),  # places of coordinates
        "width": region.width,
        "height": region.height,
    }


def _spine_animation(puppet: GamePuppet, animation: Animation) -> dict[str, Any]:
    times = few_decimals(animation.times)
    bones: dict[str, Any] = {}
    number = {bone.name: k for k, bone in enumerate(puppet.bones)}
    for name, degrees in animation.turned.items():
        keys = [{"time": time, "value": value} for time, value in zip(times, few_decimals(degrees), strict=True)]
        bones.setdefault(name, {})["rotate"] = keys
    for name, shifts in animation.shifted.items():
        rows = [few_decimals(row) for row in in_parent(puppet.bones, number[name], shifts)]
        keys = [{"time": time, "x": x, "y": y} for time, (x, y) in zip(times, rows, strict=True)]
        bones.setdefault(name, {})["translate"] = keys
    return {"bones": bones}
