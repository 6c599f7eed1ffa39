"""Puppets for game engines: what is written is posed by other code, with certified hulls, weights and ranges."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image

from support.command import run
from support.documents import squares
from support.engines import Rig, areas, read_godot, read_spine
from support.paintings import openraster

pytestmark = pytest.mark.slow

SIZE = (420, 300)
MARGIN = 0.9
"""Pixels between what is opaque and its hull."""


def line(*points: tuple[float, float], width: float) -> np.ndarray:
    """(H, W, 4) the canvas with a round line, in a colour that differs from pixel to pixel."""
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    out = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    out[..., 3] = 255 * np.clip(0.5 * width - shapely.distance(shapely.linestrings(points), shapely.points(x, y)), 0, 1)
    out[..., 0], out[..., 1], out[..., 2] = x % 256, y % 256, 90
    return out


def figure() -> list[dict[str, Any]]:
    """A tail behind a body, an arm before it, a ring of two islands on it, and what is drawn by other blend modes."""
    ring = line((200, 110), (201, 110), width=44)
    ring[..., 3] &= ~line((200, 110), (201, 110), width=30)[..., 3]
    spots = line((150, 160), (151, 160), width=14) | line((240, 160), (241, 160), width=10)
    return [
        {"name": "tail", "pixels": line((270, 170), (310, 160), (350, 110), (360, 40), width=26)},
        {"name": "body", "pixels": line((140, 170), (260, 170), width=90)},
        {"name": 'arm "R".001', "pixels": line((150, 180), (110, 230), (40, 240), width=30), "opacity": 0.5},
        {"name": "ring", "pixels": ring, "visible": False},
        {"name": "spots", "pixels": spots, "blend": "multiply"},
        {"name": "shine", "pixels": line((180, 140), (220, 140), width=12), "blend": "plus"},
    ]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The figure for all engines: cat.json, cat.tscn, cat_ske.json, and what is kept of it."""
    place = tmp_path_factory.mktemp("engines")
    openraster(place / "cat.ora", figure(), SIZE)
    done = run("puppet", "cat.ora", "-o", "cat.tscn", "cat.json", "cat_ske.json", "--hidden", "--vertices", 12,
               "--bones", "tail=3", "--keep", "kept.json", cwd=place)  # fmt: skip
    assert done.status == 0, done
    (place / "said.txt").write_text(done.out)
    return place


@pytest.fixture(scope="module")
def rigs(folder: Path) -> tuple[Rig, Rig]:
    return read_spine(folder / "cat.json"), read_godot(folder / "cat.tscn")


def of_layer(rig: Rig, name: str) -> list[Any]:
    return [part for part in rig.parts if part.name == name or part.name.startswith(f"{name}.island")]


def test_all_files_of_an_engine_are_written(folder: Path, rigs: tuple[Rig, Rig]) -> None:
    assert {path.name for path in folder.iterdir()} == {
        "cat.ora", "cat.tscn", "cat.png", "cat.json", "cat.atlas", "cat_ske.json", "cat_tex.json", "kept.json",
        "said.txt",
    }  # fmt: skip
    said = (folder / "said.txt").read_text()
    assert all(name in said for name in rigs[1].names)
    skeleton = json.loads((folder / "cat_ske.json").read_text())
    (armature,) = skeleton["armature"]
    assert [bone["name"] for bone in armature["bone"]] == rigs[1].names
    assert [slot["name"] for slot in armature["slot"]] == [part.name for part in rigs[0].parts]
    display = armature["skin"][0]["slot"][1]["display"][0]
    points = np.reshape(display["vertices"], (-1, 2))
    np.testing.assert_allclose(points, rigs[0].parts[1].points, atol=1e-4)


def test_hulls_hold_every_opaque_pixel_and_islands_share_them_out(rigs: tuple[Rig, Rig]) -> None:
    for rig in rigs:
        for part in rig.parts:
            low, high = np.floor(part.page_points.min(axis=0)), np.ceil(part.page_points.max(axis=0))
            alpha = np.zeros(rig.page.shape[:2], bool)
            box = np.s_[int(low[1]) : int(high[1]), int(low[0]) : int(high[0])]
            alpha[box] = rig.page[box][..., 3] > 0
            opaque = squares(alpha)
            assert shapely.covers(part.solid, opaque).all()
            assert shapely.distance(part.solid.boundary, opaque).min() >= MARGIN
            assert np.abs(areas(part.points, part.triangles)).sum() == pytest.approx(2 * part.solid.area, rel=1e-5)
    for layer in figure():
        name = layer["name"]
        parts = of_layer(rigs[0], name)
        assert parts and {part.is_visible for part in parts} == {layer.get("visible", True)}
        found = [rigs[0].picture_of(part, SIZE)[..., 3].astype(int) for part in parts]
        wanted = np.round(layer["pixels"][..., 3] * layer.get("opacity", 1.0))
        np.testing.assert_array_equal(sum(found), wanted)
    assert len(of_layer(rigs[0], "spots")) == 2
    blends = [part.blend for part in of_layer(rigs[0], "spots") + of_layer(rigs[0], "shine")]
    assert blends == ["multiply", "multiply", "add"]


def test_the_atlas_has_each_picture_once(rigs: tuple[Rig, Rig]) -> None:
    rig = rigs[0]
    owner = np.zeros(rig.page.shape[:2], int)
    for number, part in enumerate(rig.parts, 1):
        low = np.floor(part.page_points.min(axis=0) + 1e-6).astype(int)
        high = np.ceil(part.page_points.max(axis=0) - 1e-6).astype(int)
        assert (low >= 0).all() and (high <= rig.page.shape[1::-1]).all()
        box = owner[max(low[1] - 1, 0) : high[1] + 1, max(low[0] - 1, 0) : high[0] + 1]
        assert not box.any()
        box[...] = number
    assert (rig.page[..., 2][(owner > 0) & (rig.page[..., 3] > 0)] == 90).all()
    assert not rig.page[..., 3][owner == 0].any()


def test_engines_put_vertices_in_the_same_places(rigs: tuple[Rig, Rig]) -> None:
    """Spine's and Godot's files are posed by matrices alone; both turn each bone with what is parented to it."""
    spine, godot = rigs
    assert spine.names[1:] == godot.names and spine.ranges.keys() == godot.ranges.keys()
    assert len(spine.parts) == len(godot.parts)
    rng = np.random.default_rng(2)
    for turned in ({}, *({name: rng.uniform(-110, 110) for name in godot.names} for _ in range(6))):
        for one, other in zip(spine.posed(turned), godot.posed(turned), strict=True):
            assert np.abs(one - other).max() < 0.1
    arm = next(name for name in godot.names if name.startswith("arm"))
    moved = spine.posed({arm: 30.0})
    still = {part.name for part, points in zip(spine.parts, moved, strict=True) if np.allclose(points, part.points)}
    assert {"tail", "body"} <= still and not any(part.name in still for part in of_layer(spine, 'arm "R".001'))


def test_what_bends_has_joints_and_weights(rigs: tuple[Rig, Rig]) -> None:
    rig = rigs[0]
    for part in rig.parts:
        np.testing.assert_allclose(part.weights.sum(axis=1), 1.0, atol=1e-6)
        assert (part.weights >= 0).all() and ((part.weights > 0).sum(axis=1) <= 4).all()
    (tail,) = of_layer(rig, "tail")
    used = np.flatnonzero(tail.weights.any(axis=0))
    assert len(used) == 3 and [rig.parents[bone] for bone in used[1:]] == used[:-1].tolist()
    assert len(tail.points) > tail.hull
    world = rig.world({})
    for bone in used[1:]:  # points inside at both sides of each joint, and on the hull
        joint, direction = world[bone][:2, 2], world[bone][:2, 0]
        side = np.sign((tail.points - joint) @ direction)
        near = np.hypot(*(tail.points - joint).T) < 26
        for rows in (slice(0, tail.hull), slice(tail.hull, None)):
            assert {-1.0, 1.0} <= set(side[rows][near[rows]].tolist())


def test_no_triangle_flips_within_the_ranges(rigs: tuple[Rig, Rig]) -> None:
    """Against poses at the ends and at random in between; a little further out, one does flip."""
    rng = np.random.default_rng(4)
    for rig in rigs:
        assert len(rig.ranges) >= 2
        for name, (low, high) in rig.ranges.items():
            assert low <= -75 and high >= 75
            for end in (low, high):
                assert not rig.folds({name: end})
                beyond = [end * (1 + step) for step in np.linspace(0.0, 0.9, 40) if abs(end * (1 + step)) < 179]
                assert abs(end) > 150 or any(rig.folds({name: angle}) for angle in beyond)
        for _ in range(30):
            turned = {name: rng.uniform(*ends) for name, ends in rig.ranges.items()}
            assert not rig.folds(turned)


def test_a_part_is_told_where_to_hang_and_how_many_vertices_it_has(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "cat.json"
    options = ["--parent", 'tail=arm "R".001', "--bones", "tail=1", "--vertices", 24]
    done = run("puppet", folder / "cat.ora", "-o", out, *options)
    assert done.status == 0
    rig = read_spine(out)
    parent = rig.parents[rig.names.index("tail")]
    assert parent is not None and rig.names[parent].startswith("arm")
    assert not any(part.name.startswith("ring") for part in rig.parts)  # hidden
    (tail,) = of_layer(rig, "tail")
    assert 12 < tail.hull <= 24


@pytest.mark.parametrize(
    ("words", "status"),
    [(["cat.ora", "-o", "cat.fbx"], 1), (["none.psd", "-o", "cat.json"], 1), (["cat.ora"], 2),
     (["cat.ora", "-o", "cat.json", "--parent", "tail"], 2),
     (["cat.ora", "-o", "cat.json", "--parent", "tail=wing"], 1),
     (["cat.ora", "-o", "cat.json", "--bones", "wing=2"], 1), (["cat.ora", "-o", "cat.json", "--vertices", "2"], 2),
     (["cat.ora", "-o", "cat.json", "--keep", "bad.json"], 1),
     (["cat.ora", "-o", "cat.json", "--keep", "deep.json"], 1),
     (["cat.ora", "-o", "cat.json", "--keep", "circle.json"], 1)],
)  # fmt: skip
def test_what_goes_wrong_ends_with_a_sentence_and_its_status(
    words: list[str], status: int, folder: Path, tmp_path: Path
) -> None:
    (tmp_path / "cat.ora").write_bytes((folder / "cat.ora").read_bytes())
    (tmp_path / "bad.json").write_text("{}")
    (tmp_path / "deep.json").write_text("[" * 200_000)
    (tmp_path / "circle.json").write_text((folder / "kept.json").read_text().replace('"parent": 0', '"parent": 77'))
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    done = run("puppet", *words, cwd=tmp_path)
    assert done.status == status and "error: " in done.err and "Traceback" not in done.err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_joints_stay_painted_and_nothing_shows_at_rest(tmp_path: Path) -> None:
    """A bar with a square end opens at its joint: opaque pixels of it stay on its parent, under the bar, with ink."""
    layers = []
    for name, left, right, blue in (("lower", 190, 260, 190), ("upper", 100, 200, 90)):
        pixels = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
        pixels[100:140, left:right] = 20, 10, 20, 255
        pixels[104:136, left + 4 : right - 4] = 90, 60, blue, 255
        layers.append({"name": name, "pixels": pixels})
    openraster(tmp_path / "bars.ora", layers, SIZE)
    assert run("puppet", "bars.ora", "-o", "bars.json", "--parent", "upper=", cwd=tmp_path).status == 0
    rig = read_spine(tmp_path / "bars.json")
    below, above = (Image.fromarray(layer["pixels"], "RGBA") for layer in layers)
    np.testing.assert_allclose(rig.seen(SIZE), np.array(Image.alpha_composite(below, above)), atol=1.0)
    upper, lower = (rig.names.index(name) for name in ("upper", "lower"))
    assert rig.parents[lower] == upper
    head = rig.world({})[lower][:2, 2]
    disc = shapely.Point(head).buffer(18)
    turned = {"lower": 90.0}
    solids = [shapely.Polygon(points[: part.hull]) for part, points in zip(rig.parts, rig.posed(turned), strict=True)]
    assert disc.difference(shapely.union_all(solids)).area < 0.02 * disc.area
    (cap,) = [part for part in rig.parts if part.name not in ("lower", "upper")]
    pixels = rig.picture_of(cap, SIZE)
    rows, columns = np.nonzero(pixels[..., 3])
    away = np.hypot(columns + 0.5 - (head[0] + 210.0), rows + 0.5 - (head[1] + 300.0))
    rim = away > away.max() - 3.0
    assert (pixels[rows[rim], columns[rim]] == (20, 10, 20, 255)).all()
    assert (pixels[rows[away < away.max() - 7.0], columns[away < away.max() - 7.0], 2] == 190).any()


def test_thousands_of_specks_have_few_hulls(tmp_path: Path) -> None:
    alpha = np.where(np.random.default_rng(5).random((100, 150)) > 0.97, 255, 0)
    pixels = np.dstack([np.arange(15_000).reshape(100, 150) % 251] * 3 + [alpha]).astype(np.uint8)
    openraster(tmp_path / "specks.ora", [{"name": "specks", "pixels": pixels}], (150, 100))
    assert run("puppet", "specks.ora", "-o", "specks.json", cwd=tmp_path).status == 0
    rig = read_spine(tmp_path / "specks.json")
    assert 1 <= len(rig.parts) <= 64
    found = [rig.picture_of(part, (150, 100)) for part in rig.parts]
    assert sum((picture[..., 3] > 0).astype(int) for picture in found).max() == 1
    np.testing.assert_array_equal(sum(np.where(p[..., 3:] > 0, p, 0).astype(int) for p in found),
                                  np.where(alpha[..., None] > 0, pixels, 0))  # fmt: skip


# What is kept of a puppet when its painting changes


def animated(folder: Path, place: Path) -> dict[str, Any]:
    """What is kept of the figure, with an animation of all its bones."""
    kept = json.loads((folder / "kept.json").read_text())
    names = [bone["name"] for bone in kept["bones"]]
    turned = {name: [0.0, 20.0] for name in names}
    swing = {"name": "swing", "times": [0.0, 1.0], "turned": turned, "shifted": {names[0]: [[0, 0], [5, 7]]}}
    kept["animations"] = [{**swing, "loops": True}]
    place.write_text(json.dumps(kept), encoding="utf-8")
    return kept


def rig_ends(kept: dict[str, Any]) -> dict[str, tuple[Any, ...]]:
    """Head, tail and parent of each bone."""
    bones = kept["bones"]
    parents = [None if bone["parent"] is None else bones[bone["parent"]]["name"] for bone in bones]
    return {bone["name"]: (bone["head"], bone["tail"], above) for bone, above in zip(bones, parents, strict=True)}


def test_a_repainted_puppet_keeps_its_bones_and_keys(folder: Path, tmp_path: Path) -> None:
    """The tail thicker, the arm in front, the spots gone, a hat new."""
    before = animated(folder, tmp_path / "kept.json")
    tail, body, arm, ring, _, shine = figure()
    thick = {**tail, "pixels": line((270, 170), (310, 160), (350, 110), (360, 40), width=34)}
    hat = {"name": "hat", "pixels": line((120, 90), (160, 140), width=40)}
    openraster(tmp_path / "cat.ora", [thick, body, ring, shine, arm, hat], SIZE)
    command = ["puppet", "cat.ora", "-o", "cat.json", "cat.tscn", "--hidden", "--vertices", 12, "--keep", "kept.json"]
    done = run(*command, cwd=tmp_path)
    assert done.status == 0 and all(name in done.err for name in ("spots", "hat", "tail"))
    assert len(done.err.splitlines()) == 4  # the fourth is the order
    after = json.loads((tmp_path / "kept.json").read_text())
    ends, then = rig_ends(before), rig_ends(after)
    kept = {name for name in ends if not name.startswith("spots")}
    assert len(kept) >= 4 and {name: then[name] for name in kept} == {name: ends[name] for name in kept}
    spine, godot = read_spine(tmp_path / "cat.json"), read_godot(tmp_path / "cat.tscn")
    drawn = [part.name for part in spine.parts if ".cap" not in part.name and ".island" not in part.name]
    assert drawn == ["tail", "body", "ring", "shine", 'arm "R".001', "hat"]
    keys = spine.animations["swing"]["bones"]
    assert set(keys) == kept
    assert all([(key.get("time", 0), key.get("value", 0)) for key in each["rotate"]] == [(0, 0), (1, 20)]
               for each in keys.values())  # fmt: skip
    assert [*godot.animations] == ["swing"] and float(godot.animations["swing"]["length"]) == 1.0
    assert godot.animations["swing"]["loop_mode"] == "1"
    assert sum(line.endswith(':rotation")') for line in godot.animations["swing"].values()) == len(kept)
    assert sum(line.endswith(':position")') for line in godot.animations["swing"].values()) == 1
    again = run(*command, cwd=tmp_path)  # nothing has changed
    assert again.status == 0 and again.err == ""
    assert json.loads((tmp_path / "kept.json").read_text())["meshes"] == after["meshes"]


def test_weights_painted_by_hand_stay(folder: Path, tmp_path: Path) -> None:
    kept = json.loads((folder / "kept.json").read_text())
    mesh = next(mesh for mesh in kept["meshes"] if mesh["name"] == "tail")
    body = next(k for k, bone in enumerate(kept["bones"]) if bone["name"] == "body")
    mesh["hand"] = [[*([bone, -0.25 * weight] for bone, weight in row), [body, 0.25]] for row in mesh["weights"]]
    mesh["weights"] = [[*([bone, 0.75 * weight] for bone, weight in row), [body, 0.25]] for row in mesh["weights"]]
    (tmp_path / "kept.json").write_text(json.dumps(kept))
    (tmp_path / "cat.ora").write_bytes((folder / "cat.ora").read_bytes())
    command = ["puppet", "cat.ora", "-o", "cat.json", "--hidden", "--vertices", 12, "--keep", "kept.json"]
    assert run(*command, cwd=tmp_path).status == 0
    plain, painted = read_spine(folder / "cat.json"), read_spine(tmp_path / "cat.json")
    for one, other in zip(plain.parts, painted.parts, strict=True):
        wanted = one.weights
        if one.name == "tail":
            wanted = 0.75 * one.weights
            wanted[:, painted.names.index("body")] += 0.25
        np.testing.assert_allclose(other.weights, wanted, atol=1e-4)
    assert {name for name, (low, high) in painted.ranges.items() if low == high} >= {"tail"}  # nothing is proved
    assert not any(low == high for low, high in plain.ranges.values())
