"""Puppets as game engines read and pose them: Spine's JSON and Godot's scenes, written out with numpy alone."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from PIL import Image


@dataclass
class Part:
    """A textured mesh of a rig: points (n, 2) at rest and their places (n, 2) on the page, y pointing down."""

    name: str
    points: np.ndarray
    page_points: np.ndarray
    triangles: np.ndarray
    weights: np.ndarray
    hull: int
    blend: str = "normal"
    is_visible: bool = True

    @property
    def solid(self) -> Any:
        """The hull on the page."""
        return shapely.Polygon(self.page_points[: self.hull])


@dataclass
class Rig:
    """Bones with their parents and matrices, and parts in drawing order, the lowest first; y points down."""

    names: list[str]
    parents: list[int | None]
    local: list[np.ndarray]
    """(3, 3) of each bone in its parent."""
    parts: list[Part]
    page: np.ndarray
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    """Degrees from rest within which nothing folds, clockwise as displayed, of bones that have some."""
    animations: dict[str, Any] = field(default_factory=dict)

    def world(self, turned: Mapping[str, float]) -> np.ndarray:
        """(B, 3, 3) of all bones, with some turned by degrees, clockwise as displayed."""
        found: list[np.ndarray] = []
        for name, parent, own in zip(self.names, self.parents, self.local, strict=True):
            matrix = own @ turn(turned.get(name, 0.0))
            found.append(matrix if parent is None else found[parent] @ matrix)
        return np.array(found)

    def posed(self, turned: Mapping[str, float]) -> list[np.ndarray]:
        """Points of each part, blended linearly as engines do."""
        moves = self.world(turned) @ np.linalg.inv(self.world({}))
        flat = [np.column_stack([part.points, np.ones(len(part.points))]) for part in self.parts]
        return [
            np.einsum("nb,bij,nj->ni", part.weights, moves, points)[:, :2]
            for part, points in zip(self.parts, flat, strict=True)
        ]

    def folds(self, turned: Mapping[str, float]) -> bool:
        """Whether a triangle turns over."""
        signs = [
            (np.sign(areas(part.points, part.triangles)) * areas(points, part.triangles)).min()
            for part, points in zip(self.parts, self.posed(turned), strict=True)
        ]
        return min(signs) <= 0.0

    def picture_of(self, part: Part, size: tuple[int, int]) -> np.ndarray:
        """(H, W, 4) a part at rest on a canvas of a width and height; 0 lies below its middle."""
        shift = part.points - part.page_points + np.array([0.5 * size[0], size[1]])
        assert np.abs(shift - shift[0]).max() < 1e-3 and np.abs(shift[0] - np.round(shift[0])).max() < 1e-3
        dx, dy = np.round(shift[0]).astype(int)
        low = np.floor(part.page_points.min(axis=0) + 1e-6).astype(int)
        high = np.ceil(part.page_points.max(axis=0) - 1e-6).astype(int)
        out = np.zeros((size[1] + 200, size[0] + 200, 4), np.uint8)  # with a margin for what is beyond the canvas
        region = self.page[low[1] : high[1], low[0] : high[0]]
        out[low[1] + dy + 100 : high[1] + dy + 100, low[0] + dx + 100 : high[0] + dx + 100] = region
        return out[100:-100, 100:-100]

    def seen(self, size: tuple[int, int]) -> np.ndarray:
        """(H, W, 4) what is displayed at rest."""
        return composed([(self.picture_of(part, size), part.blend) for part in self.parts if part.is_visible])


def areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Twice the signed areas."""
    a, b, c = points[triangles].transpose(1, 2, 0)
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def turn(degrees: float, x: float = 0.0, y: float = 0.0) -> np.ndarray:
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[c, -s, x], [s, c, y], [0.0, 0.0, 1.0]])


def composed(layers: list[tuple[np.ndarray, str]]) -> np.ndarray:
    """(H, W, 4) pictures with their blend modes, the lowest first."""
    light, alpha = np.zeros((*layers[0][0].shape[:2], 3)), np.zeros(layers[0][0].shape[:2])
    for pixels, blend in layers:
        own, colour = pixels[..., 3] / 255.0, pixels[..., :3] / 255.0
        below = light / np.maximum(alpha, 1e-9)[..., None]
        mixed = {"multiply": below * colour, "add": np.minimum(below + colour, 1.0),
                 "screen": below + colour - below * colour}.get(blend, colour)  # fmt: skip
        source = (1.0 - alpha)[..., None] * colour + alpha[..., None] * mixed
        light = light * (1.0 - own)[..., None] + own[..., None] * source
        alpha = alpha + own - alpha * own
    return np.dstack([255.0 * light / np.maximum(alpha, 1e-9)[..., None], 255.0 * alpha])


def read_spine(path: Path) -> Rig:
    """A skeleton with its .atlas and picture."""
    document = json.loads(path.read_text(encoding="utf-8"))
    assert document["skeleton"]["spine"].startswith("4.2")
    lines = path.with_suffix(".atlas").read_text(encoding="utf-8").splitlines()
    page = np.array(Image.open(path.with_name(lines[0])).convert("RGBA"))
    assert lines[1] == f"size: {page.shape[1]}, {page.shape[0]}"
    regions = {
        lines[k]: [*map(int, lines[k + 1].removeprefix("bounds: ").split(", "))] for k in range(3, len(lines), 2)
    }
    names = [bone["name"] for bone in document["bones"]]
    parents = [names.index(bone["parent"]) if "parent" in bone else None for bone in document["bones"]]
    flip = np.diag([1.0, -1.0, 1.0])
    local = [
        flip @ turn(bone.get("rotation", 0.0), bone.get("x", 0.0), bone.get("y", 0.0)) @ flip
        for bone in document["bones"]
    ]
    ranges = {
        bone["name"]: (-bone["proved_degrees"][1], -bone["proved_degrees"][0])
        for bone in document["bones"]
        if "proved_degrees" in bone
    }
    rig = Rig(names, parents, local, [], page, ranges, document["animations"])
    world = rig.world({})
    (skin,) = document["skins"]
    for slot in document["slots"]:
        ((attachment, mesh),) = skin["attachments"][slot["name"]].items()
        x, y, width, height = regions[attachment]
        uv = np.reshape(mesh["uvs"], (-1, 2)) * (width, height) + (x, y)
        weights, points = np.zeros((len(uv), len(names))), np.zeros((len(uv), 2))
        entries = list(mesh["vertices"])
        if len(entries) == 2 * len(uv):
            bone = names.index(slot["bone"])
            weights[:, bone] = 1.0
            points = _at(world[bone], np.reshape(entries, (-1, 2)) * (1, -1))
        else:
            for row in range(len(uv)):
                for _ in range(entries.pop(0)):
                    bone, u, v, weight = (entries.pop(0) for _ in range(4))
                    weights[row, bone] = weight
                    points[row] += weight * _at(world[bone], np.array([[u, -v]]))[0]
            assert not entries
        triangles = np.reshape(mesh["triangles"], (-1, 3))
        blend = slot.get("blend", "normal").replace("additive", "add")
        shown = slot.get("attachment") == attachment
        rig.parts.append(Part(slot["name"], points, uv, triangles, weights, mesh["hull"], blend, shown))
    return rig


def _at(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    return points @ matrix[:2, :2].T + matrix[:2, 2]


def read_godot(path: Path) -> Rig:
    """A scene with its picture."""
    text = path.read_text(encoding="utf-8")
    heads = [*re.finditer(r"^\[(\w+) ?([^\n]*)\]$", text, re.MULTILINE)]
    ends = [head.start() for head in heads[1:]] + [len(text)]
    nodes = [
        (head[1], _header(head[2]), _members(text[head.end() : end])) for head, end in zip(heads, ends, strict=True)
    ]
    picture = next(head["path"] for kind, head, _ in nodes if kind == "ext_resource")
    page = np.array(Image.open(path.parent / picture.removeprefix("res://")).convert("RGBA"))
    rig = Rig([], [], [], [], page)
    paths: list[str] = []
    for kind, head, members in nodes:
        if kind == "node" and head["type"] == "Bone2D":
            above = head["parent"].partition("/")[2]
            paths.append(f"{above}/{head['name']}" if above else head["name"])
            rig.names.append(json.loads(members["metadata/bone"]))
            rig.parents.append(paths.index(above) if above else None)
            rig.local.append(turn(np.rad2deg(float(members["rotation"])), *_numbers(members["position"])))
            rest = np.reshape(_numbers(members["rest"]), (3, 2)).T  # columns: axes and origin
            np.testing.assert_allclose(rest, rig.local[-1][:2], atol=1e-4)
            if "metadata/proved_degrees" in members:
                low, high = _numbers(members["metadata/proved_degrees"])
                rig.ranges[rig.names[-1]] = (low, high)
        if kind == "node" and head["type"] == "Polygon2D":
            points, uv = (np.reshape(_numbers(members[name]), (-1, 2)) for name in ("polygon", "uv"))
            triangles = np.reshape(_numbers(members["polygons"]), (-1, 3)).astype(int)
            weights = np.zeros((len(points), len(paths)))
            for bone, row in re.findall(r'NodePath\("([^"]*)"\), PackedFloat32Array\(([^)]*)\)', members["bones"]):
                weights[:, paths.index(bone)] = _numbers(row)
            material = members.get("material", "")
            blend = next((name for name in ("multiply", "add") if name in material), "normal")
            hull = len(points) - int(members["internal_vertex_count"])
            shown = members.get("visible") != "false"
            rig.parts.append(Part(head["name"], points, uv, triangles, weights, hull, blend, shown))
        if kind == "sub_resource" and head["type"] == "Animation":
            rig.animations[json.loads(members["resource_name"])] = members
    return rig


def _header(text: str) -> dict[str, str]:
    return {name: value.replace('\\"', '"') for name, value in re.findall(r'(\w+)="((?:[^"\\]|\\.)*)"', text)}


def _members(text: str) -> dict[str, str]:
    parts = re.split(r"^([\w/]+) = ", text, flags=re.MULTILINE)
    return {name: value.strip() for name, value in zip(parts[1::2], parts[2::2], strict=True)}


def _numbers(text: str) -> list[float]:
    inside = re.sub(r"\w+\(", "(", text)
    return [float(number) for number in re.findall(r"-?\d[\d.eE+-]*", inside)]
