"""A puppet as JSON, without its pictures: what a repainted one keeps, and what scripts read."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..character import Bone
from ..errors import invalid_file
from ..formats import Limits
from ..formats.geojson import loaded_json
from ..geometry.arrays import FloatArray
from ..puppet import Hold, JointRange
from .animation import Animation
from .atlas import Atlas, page_points
from .mesh import PartMesh, Placement
from .puppet import GamePuppet, PartRecord

FORMAT, VERSION = "nested-cages puppet", 1
"""Name of the format, and a version that counts incompatible changes."""

KEPT_LIMITS = Limits(bytes=2**28, elements=10_000)
"""Maximum of what is read by default: bytes, and bones, parts and meshes."""


def to_puppet_json(puppet: GamePuppet, atlas: Atlas | None = None, picture: str = "") -> str:
    """A puppet without its pictures: places in pixels, y pointing up; weights by number of the bone.

    atlas: then the name of its picture and texture coordinates in pixels, y pointing down, for scripts that draw it.
    """
    ranges = ((r.low, r.high, r.simple_low, r.simple_high) for r in puppet.ranges)
    document: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "name": puppet.name,
        "canvas": [puppet.place.width, puppet.place.height],
        "bones": [
            {"name": b.name, "parent": b.parent, "head": b.head, "tail": b.tail, "range": r}
            for b, r in zip(puppet.bones, ranges, strict=True)
        ],
        "parts": [{**vars(part), "hold": part.hold.value, "joint": part.joint} for part in puppet.parts],
        "meshes": [_mesh_entry(mesh, puppet.hand.get(mesh.name)) for mesh in puppet.meshes],
        "animations": [
            {
                "name": animation.name,
                "times": animation.times.tolist(),
                "turned": {name: np.asarray(values).tolist() for name, values in animation.turned.items()},
                "shifted": {name: np.asarray(values).tolist() for name, values in animation.shifted.items()},
                "loops": animation.loops,
            }
            for animation in puppet.animations
        ],
    }
    if atlas is not None:
        document["picture"] = picture
        for entry, mesh, region in zip(document["meshes"], puppet.meshes, atlas.regions, strict=True):
            entry["uv"] = page_points(mesh.points, region, puppet.place).tolist()
    return json.dumps(document, ensure_ascii=False, allow_nan=False)


def _mesh_entry(mesh: PartMesh, hand: FloatArray | None) -> dict[str, Any]:
    entry = {
        "name": mesh.name,
        "part": mesh.part,
        "identity": mesh.identity,
        "place": [mesh.left, mesh.top],
        "hull": mesh.hull,
        "points": mesh.points.tolist(),
        "triangles": mesh.triangles.tolist(),
        "weights": _sparse(mesh.weights),
        "blend": mesh.blend,
        "visible": mesh.is_visible,
    }
    return entry if hand is None else {**entry, "hand": _sparse(hand)}


def _sparse(rows: FloatArray) -> list[list[list[float]]]:
    """For each row, the numbers of the columns that are not 0, with their values."""
    return [[[int(k), float(row[k])] for k in np.flatnonzero(row)] for row in rows]


def from_puppet_json(text: str | bytes, *, limits: Limits = KEPT_LIMITS) -> GamePuppet:
    """The puppet of a JSON by `to_puppet_json`; its meshes have empty pictures. Raises NestedCagesError."""
    document = loaded_json(text, "a puppet", limits)
    try:
        if not isinstance(document, Mapping) or document.get("format") != FORMAT:
            raise invalid_file(f'This is no puppet: its format is not "{FORMAT}".')
        if document.get("version") != VERSION:
            raise invalid_file(f"The puppet is of another version than {VERSION}; make it again.")
        limits.check("elements", sum(len(document[key]) for key in ("bones", "parts", "meshes")))
        return _puppet_of(document)
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        raise invalid_file(f"The puppet is damaged ({type(error).__name__}: {error}); make it again.") from error


def _puppet_of(document: Mapping[str, Any]) -> GamePuppet:
    bones = tuple(_bone_of(entry, number) for number, entry in enumerate(document["bones"]))
    if len({bone.name for bone in bones}) != len(bones):
        raise ValueError("names of bones repeat")
    width, height = (int(side) for side in document["canvas"])
    puppet = GamePuppet(
        str(document["name"]),
        Placement(width, height),
        bones,
        tuple(_part_mesh_of(entry, len(bones)) for entry in document["meshes"]),
        tuple(JointRange(*map(float, entry["range"])) for entry in document["bones"]),
        tuple(_animation_of(entry) for entry in document["animations"]),
        (),
        tuple(_part_of(entry) for entry in document["parts"]),
        {
            entry["name"]: _dense(entry["hand"], len(entry["points"]), len(bones))
            for entry in document["meshes"]
            if "hand" in entry
        },
    )
    for animation in puppet.animations:
        animation.check(bones)
    return puppet


def _bone_of(entry: Mapping[str, Any], number: int) -> Bone:
    parent = entry["parent"]
    if parent is not None and not 0 <= parent < number:
        raise ValueError("a bone comes before its parent")
    head, tail = _numbers_of(entry["head"], (2,)).tolist(), _numbers_of(entry["tail"], (2,)).tolist()
    return Bone((head[0], head[1]), (tail[0], tail[1]), parent, str(entry["name"]))


def _part_of(entry: Mapping[str, Any]) -> PartRecord:
    x, y = _numbers_of(entry["joint"], (2,)).tolist()
    return PartRecord(
        str(entry["name"]),
        str(entry["path"]),
        str(entry["identity"]),
        str(entry["parent"]),
        Hold(entry["hold"]),
        (x, y),
        [str(name) for name in entry["bones"]],
        int(entry["checksum"]),
    )


def _part_mesh_of(entry: Mapping[str, Any], bones: int) -> PartMesh:
    points = _numbers_of(entry["points"], (-1, 2))
    triangles = np.array(entry["triangles"], dtype=np.int64).reshape(-1, 3)
    if triangles.size and not (triangles.min() >= 0 and triangles.max() < len(points)):
        raise ValueError("a triangle has a corner that is no point")
    left, top = (int(value) for value in entry["place"])
    return PartMesh(
        str(entry["name"]),
        str(entry["part"]),
        str(entry["identity"]),
        points,
        int(entry["hull"]),
        triangles,
        _dense(entry["weights"], len(points), bones),
        left,
        top,
        np.zeros((0, 0, 4), np.uint8),
        str(entry["blend"]),
        bool(entry["visible"]),
    )


def _animation_of(entry: Mapping[str, Any]) -> Animation:
    def keys(name: str, make: Callable[[Any], FloatArray]) -> dict[str, FloatArray]:
        return {str(bone): make(values) for bone, values in entry[name].items()}

    return Animation(
        str(entry["name"]),
        _numbers_of(entry["times"], (-1,)),
        keys("turned", lambda values: _numbers_of(values, (-1,))),
        keys("shifted", lambda values: _numbers_of(values, (-1, 2))),
        bool(entry["loops"]),
    )


def _dense(rows: Any, count: int, bones: int) -> FloatArray:
    """(count, bones) the numbers of `_sparse`."""
    out = np.zeros((count, bones))
    if len(rows) != count:
        raise ValueError("weights and points differ in number")
    for row, entries in zip(out, rows, strict=True):
        for bone, value in entries:
            if not 0 <= bone < bones:
                raise ValueError("a weight is of no bone")
            row[bone] = value
    if not np.isfinite(out).all():
        raise ValueError("a weight is not finite")
    return out


def _numbers_of(values: Any, shape: tuple[int, ...]) -> FloatArray:
    found = np.array(values, dtype=np.float64).reshape(shape)
    if not np.isfinite(found).all():
        raise ValueError("a number is not finite")
    return found
