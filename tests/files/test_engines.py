"""Puppets for game engines: what is written is posed by other code, with certified hulls, weights and ranges."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

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
    """The figure for all engines: cat.json and cat.tscn."""
    place = tmp_path_factory.mktemp("engines")
    openraster(place / "cat.ora", figure(), SIZE)
    done = run("puppet", "cat.ora", "-o", "cat.tscn", "cat.json", "--hidden", "--vertices", 12,
               "--bones", "tail=3", cwd=place)  # fmt: skip
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
        "cat.ora", "cat.tscn", "cat.png", "cat.json", "cat.atlas", "said.txt"
    }  # fmt: skip
    said = (folder / "said.txt").read_text()
    assert all(name in said for name in rigs[1].names)


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
     (["cat.ora", "-o", "cat.json", "--bones", "wing=2"], 1), (["cat.ora", "-o", "cat.json", "--vertices", "2"], 2)],
)  # fmt: skip
def test_what_goes_wrong_ends_with_a_sentence_and_its_status(
    words: list[str], status: int, folder: Path, tmp_path: Path
) -> None:
    (tmp_path / "cat.ora").write_bytes((folder / "cat.ora").read_bytes())
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    done = run("puppet", *words, cwd=tmp_path)
    assert done.status == status and "error: " in done.err and "Traceback" not in done.err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


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
