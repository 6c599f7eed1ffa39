"""A puppet as JSON for scripts of users: all that its other files have, written out."""

from __future__ import annotations

import json
from collections.abc import Mapping

import numpy as np

from ...geometry.arrays import FloatArray
from .atlas import Atlas, page_points
from .puppet import GamePuppet

FORMAT, VERSION = "nested-cages puppet", 1
"""Name of the format, and a version that counts incompatible changes."""


def to_script(puppet: GamePuppet, atlas: Atlas, picture: str) -> str:
    """The text of a .puppet.json: places in pixels, y pointing up; weights by number of the bone; texture coordinates
    in pixels, y pointing down. picture: name of the atlas's file."""
    document = {
        "format": FORMAT,
        "version": VERSION,
        "name": puppet.name,
        "canvas": [puppet.place.width, puppet.place.height],
        "picture": picture,
        "bones": [
            {"name": bone.name, "parent": bone.parent, "head": bone.head, "tail": bone.tail, "range": [r.low, r.high]}
            for bone, r in zip(puppet.bones, puppet.ranges, strict=True)
        ],
        "meshes": [
            {
                "name": mesh.name,
                "part": mesh.part,
                "hull": mesh.hull,
                "points": mesh.points.tolist(),
                "uv": page_points(mesh.points, region, puppet.place).tolist(),
                "triangles": mesh.triangles.tolist(),
                "weights": [[[int(k), float(row[k])] for k in np.flatnonzero(row)] for row in mesh.weights],
                "blend": mesh.blend,
                "visible": mesh.is_visible,
            }
            for mesh, region in zip(puppet.meshes, atlas.regions, strict=True)
        ],
        "animations": [
            {
                "name": animation.name,
                "times": animation.times.tolist(),
                "turned": _lists(animation.turned),
                "shifted": _lists(animation.shifted),
                "loops": animation.loops,
            }
            for animation in puppet.animations
        ],
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False)


def _lists(keys: Mapping[str, FloatArray]) -> dict[str, object]:
    return {bone: np.asarray(values).tolist() for bone, values in keys.items()}
