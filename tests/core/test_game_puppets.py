"""Game puppets: certified hulls, weights and ranges by independent means, and every engine's own runtime as judge."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from benchmarks.engines.judge import PACKAGES, by_godot, by_node, drawn_by_godot, swinging, written
from nestedcages_core import Mesh, NestedCagesError
from nestedcages_core.checker import check
from nestedcages_core.command import main
from nestedcages_core.exchange.layers import PicturePart
from nestedcages_core.exchange.pictures import boundary_of_pixels, encode_png, read_png
from nestedcages_core.game import (
    Animation,
    GamePuppet,
    PartMesh,
    from_puppet_json,
    game_puppet,
    repainted,
    to_puppet_json,
    with_hand_weights,
    write_puppet,
)
from nestedcages_core.game.atlas import atlas_of, region_points
from nestedcages_core.game.islands import MOST_ISLANDS, certify, islands_of
from nestedcages_core.game.vector import coverage, parts_of_svg
from nestedcages_core.puppet import PartChoice, idle
from nestedcages_core.puppet.puppet import LEAST_TURN

SIZE = (420, 300)
WITHIN = 0.1
"""Pixels that an engine may be off."""

DIFFERENT = 1e-3
"""Part of the pixels that may differ from what an engine draws."""


def limb(*points: tuple[float, float], width: float) -> np.ndarray:
    """(H, W, 4) the canvas with a round line, in a colour that differs from pixel to pixel."""
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    line = shapely.linestrings(points)
    away = shapely.distance(line, shapely.points(x, y))
    out = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
    out[..., 3] = 255 * np.clip(0.5 * width - away, 0, 1)
    out[..., 0], out[..., 1], out[..., 2] = x % 256, y % 256, 90
    return out


def part(name: str, pixels: np.ndarray, **more: object) -> PicturePart:
    rows, columns = np.nonzero(pixels[..., 3])
    top, left = rows.min(), columns.min()
    cut = pixels[top : rows.max() + 1, left : columns.max() + 1]
    identity = str(more.pop("identity", ""))
    return PicturePart(name, (), identity, int(left), int(top), np.ascontiguousarray(cut), **more)  # type: ignore


@pytest.fixture(scope="module")
def parts() -> list[PicturePart]:
    """A tail behind a body, an arm before it, a ring of two islands on it, and what is drawn by other blend modes."""
    ring = limb((200, 110), (201, 110), width=44)
    ring[..., 3] &= ~limb((200, 110), (201, 110), width=30)[..., 3]
    ring[105:115, 195:206] = limb((200, 110), (201, 110), width=44)[105:115, 195:206]
    spots = limb((150, 160), (151, 160), width=14) | limb((240, 160), (241, 160), width=10)
    return [
        part("tail", limb((270, 170), (310, 160), (350, 110), (360, 40), width=26)),
        part("body", limb((140, 170), (260, 170), width=90)),
        part('arm "R".001', limb((150, 180), (110, 230), (40, 240), width=30), opacity=0.5),
        part("ring", ring, is_visible=False),
        part("spots", spots, blend="multiply"),
        part("shine", limb((180, 140), (220, 140), width=12), blend="add"),
    ]


@pytest.fixture(scope="module")
def puppet(parts: list[PicturePart]) -> GamePuppet:
    return game_puppet(parts, SIZE, name="puppet", vertices=12)


@pytest.mark.slow
def test_hulls_hold_every_opaque_pixel(puppet: GamePuppet, parts: list[PicturePart]) -> None:
    """The independent checker judges the numbers as they are written, and islands share out the pixels."""
    assert [mesh.name for mesh in puppet.meshes] == [
        "tail", "body", 'arm "R".001', "ring", "spots", "spots.island2", "shine",
    ]  # fmt: skip
    for mesh in puppet.meshes:
        hull = puppet.place.down(mesh.points[: mesh.hull])
        opaque = np.pad(mesh.pixels[..., 3] > 0, 1)
        outline = boundary_of_pixels(opaque)
        fine = Mesh(outline.vertices + np.array([mesh.left - 1, mesh.top - 1]), outline.edges)
        verdict = check(fine.rings, [[hull]], 0.9, same_loops=False)
        assert not verdict.problems
        assert (np.float32(mesh.points) == mesh.points).all()
        area = np.sum(np.abs(np.linalg.det(mesh.points[mesh.triangles][:, 1:] - mesh.points[mesh.triangles][:, :1])))
        assert area == pytest.approx(2 * shapely.Polygon(hull).area)
    for drawn in parts:
        alpha = np.zeros((SIZE[1], SIZE[0]), int)
        for mesh in puppet.meshes:
            if mesh.part == drawn.path:
                h, w = mesh.pixels.shape[:2]
                alpha[mesh.top : mesh.top + h, mesh.left : mesh.left + w] += mesh.pixels[..., 3]
        h, w = drawn.pixels.shape[:2]
        wanted = np.round(drawn.pixels[..., 3] * drawn.opacity)
        np.testing.assert_array_equal(alpha[drawn.top : drawn.top + h, drawn.left : drawn.left + w], wanted)


def test_thousands_of_specks_have_few_hulls() -> None:
    """Each within its margins, and each opaque pixel in one of them, at the canvas's edges too."""
    alpha = np.where(np.random.default_rng(5).random((200, 300)) > 0.97, 255, 0)
    pixels = np.dstack([np.arange(60_000).reshape(200, 300) % 251] * 3 + [alpha]).astype(np.uint8)
    islands, seen = islands_of(pixels, 7, -3, 12), np.zeros_like(pixels)
    assert 1 <= len(islands) <= MOST_ISLANDS
    for island in islands:
        certify(island.loop, island.pixels, island.left, island.top)
        height, width = island.pixels.shape[:2]
        place = slice(island.top + 3, island.top + 3 + height), slice(island.left - 7, island.left - 7 + width)
        assert not (seen[place][..., 3] & island.pixels[..., 3]).any()
        seen[place] |= island.pixels
    assert (seen == np.where(alpha[..., None] > 0, pixels, 0)).all()


def test_what_bends_has_joints_and_weights(puppet: GamePuppet) -> None:
    for mesh in puppet.meshes:
        assert (mesh.weights.sum(axis=1) == 1.0).all()
        assert ((mesh.weights > 0).sum(axis=1) <= 4).all()
    tail = puppet.meshes[0]
    used = np.flatnonzero(tail.weights.any(axis=0))
    assert len(used) >= 2
    assert len(tail.points) > tail.hull
    for bone in used[1:]:  # points inside at both sides of each joint, and on the hull
        joint, direction = np.array(puppet.bones[bone].head), np.array(puppet.bones[bone].tail)
        side = np.sign((tail.points - joint) @ (direction - joint))
        near = np.hypot(*(tail.points - joint).T) < 26
        for rows in (slice(0, tail.hull), slice(tail.hull, None)):
            assert {-1.0, 1.0} <= set(side[rows][near[rows]].tolist())
    assert all(min(-each.low, each.high) >= LEAST_TURN for each in puppet.ranges)


@pytest.mark.parametrize("end", ["low", "high"])
def test_no_triangle_flips_within_the_ranges(puppet: GamePuppet, end: str) -> None:
    """Against poses at the ends and at random in between; a little further out, one does flip."""
    rng, bending = np.random.default_rng(4), [k for k, r in enumerate(puppet.ranges) if r.low > -180 or r.high < 180]
    assert bending

    def flipped(turned: dict[str, float]) -> bool:
        return any(
            (np.linalg.det(p[m.triangles][:, 1:] - p[m.triangles][:, :1]) <= 0).any()
            for m, p in zip(puppet.meshes, puppet.posed(turned), strict=True)
        )

    for k in bending:
        limit = getattr(puppet.ranges[k], end)
        assert abs(limit) > 75
        assert not flipped({puppet.bones[k].name: limit})
        beyond = [limit * (1 + step) for step in np.linspace(0.0, 0.9, 40) if abs(limit * (1 + step)) < 179]
        assert abs(limit) > 150 or any(flipped({puppet.bones[k].name: angle}) for angle in beyond)
    for _ in range(50):
        turned = {puppet.bones[k].name: rng.uniform(puppet.ranges[k].low, puppet.ranges[k].high) for k in bending}
        assert not flipped(turned)


def test_the_atlas_has_each_picture_once(puppet: GamePuppet) -> None:
    atlas = atlas_of(puppet.meshes, puppet.place)
    owner = np.zeros(atlas.page.shape[:2], int)
    for number, (mesh, region) in enumerate(zip(puppet.meshes, atlas.regions, strict=True), 1):
        box = owner[region.y - 1 : region.y + region.height + 1, region.x - 1 : region.x + region.width + 1]
        assert not box.any()
        box[...] = number
        places = region_points(mesh.points, region, puppet.place)
        assert (places >= 0).all()
        assert (places <= (region.width, region.height)).all()
        x, y = region.x + mesh.left - region.left, region.y + mesh.top - region.top
        h, w = mesh.pixels.shape[:2]
        shown = atlas.page[y : y + h, x : x + w]
        np.testing.assert_array_equal(shown[..., 3], mesh.pixels[..., 3])
        np.testing.assert_array_equal(shown[shown[..., 3] > 0], mesh.pixels[mesh.pixels[..., 3] > 0])
    blue = {mesh.pixels[mesh.pixels[..., 3] > 0][0, 2] for mesh in puppet.meshes}
    assert set(np.unique(atlas.page[1:-1, 1:-1][owner[1:-1, 1:-1] > 0][:, 2])) <= blue | {0}


@pytest.mark.slow
def test_a_part_is_told_where_to_hang(parts: list[PicturePart]) -> None:
    made = game_puppet(parts, SIZE, choices={"tail": PartChoice(parent='arm "R".001', bones=1)})
    tail = next(k for k, bone in enumerate(made.bones) if bone.name == "tail")
    assert made.bones[made.bones[tail].parent or 0].name.startswith("arm")
    with pytest.raises(NestedCagesError, match="no visible layer"):
        game_puppet([], SIZE)


# Judges that nobody here wrote

ENGINES = Path(os.environ.get("NESTED_CAGES_ENGINES", Path.home() / ".cache" / "nested-cages-engines"))
"""Folder for packages of npm, which are fetched once."""


@pytest.fixture(scope="session")
def modules() -> Path:
    if not (shutil.which("node") and shutil.which("npm")):
        pytest.skip("the runtimes of engines need Node.js with npm")
    if not all((ENGINES / "node_modules" / package.rpartition("@")[0]).exists() for package in PACKAGES):
        ENGINES.mkdir(parents=True, exist_ok=True)
        command = [shutil.which("npm"), "install", "--no-audit", "--no-fund", "--prefix", str(ENGINES), *PACKAGES]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        if done.returncode:
            pytest.skip(f"npm cannot fetch the runtimes of engines: {done.stderr.strip()[-200:]}")
    return ENGINES


@pytest.fixture(scope="module")
def folder(puppet: GamePuppet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("engines")
    written(swinging(puppet), place, 6)
    return place


@pytest.mark.slow
@pytest.mark.parametrize("script", ["spine.mjs", "dragonbones.mjs"])
def test_runtimes_put_vertices_where_we_do(script: str, folder: Path, modules: Path, puppet: GamePuppet) -> None:
    verdict = by_node(script, folder, modules)
    assert verdict["slots"] == len(puppet.meshes)
    assert verdict["worst"] < WITHIN, verdict


def test_godot_puts_vertices_where_we_do(folder: Path, puppet: GamePuppet) -> None:
    godot = os.environ.get("GODOT")
    if not godot:
        pytest.skip("set GODOT to the program of Godot 4")
    verdict = by_godot(folder, godot)
    assert (verdict["slots"], verdict["bones"]) == (len(puppet.meshes), len(puppet.bones))
    assert verdict["worst"] < WITHIN, verdict
    assert "ERROR" not in verdict["said"], verdict["said"]
    if not os.environ.get("DISPLAY"):
        pytest.skip("what Godot draws needs a display, such as xvfb-run gives")
    wanted = json.loads((folder / "expected.json").read_text(encoding="utf-8"))
    assert max(drawn_by_godot(folder, godot, wanted, puppet)) < DIFFERENT


# The command, and drawings without pixels


def test_coverage_is_that_of_shapely() -> None:
    rng = np.random.default_rng(3)
    shape = shapely.union_all([shapely.Point(*rng.uniform(4, 26, 2)).buffer(rng.uniform(2, 7), 4) for _ in range(5)])
    shape -= shapely.box(12.3, 9.1, 17.8, 16.4)
    rings = [np.array(r.coords)[:-1] for p in shapely.get_parts(shape) for r in (p.exterior, *p.interiors)]
    x, y = np.meshgrid(np.arange(30), np.arange(31))
    wanted = shapely.area(shapely.intersection(shapely.box(x, y, x + 1, y + 1), shape))
    np.testing.assert_allclose(coverage(rings, (31, 30)), wanted, atol=0.05)


SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="30" height="20"><g id="whole">
<rect id="body" x="4" y="6" width="20" height="10" fill="#f00" stroke="#00f" stroke-width="2"/>
<rect id="arm" x="20" y="8" width="9" height="4" fill="#0f0" fill-opacity="0.5"/></g></svg>"""


def test_layers_of_svg_become_pictures() -> None:
    found, size, _ = parts_of_svg(SVG, 260)
    assert size == (260, 120)  # ten pixels to the unit
    body, arm = found
    assert (body.name, arm.path, arm.left, arm.top) == ("body", "whole/arm", 170, 30)
    assert body.pixels[60, 100].tolist() == [255, 0, 0, 255]
    assert body.pixels[60, 10].tolist() == [0, 0, 255, 255]
    assert arm.pixels[20, 40].tolist() == [0, 255, 0, 128]
    limbs = "".join(f'<g id="limb{k}"><path d="M{k} 2h9v9h-9z"/><circle cx="{k}" cy="9" r="2"/></g>' for k in range(3))
    grouped = SVG.replace("</svg>", f"{limbs}</svg>")
    assert [each.path for each in parts_of_svg(grouped, 260)[0]] == ["whole", "limb0", "limb1", "limb2"]


@pytest.mark.slow
def test_the_command(tmp_path: Path, parts: list[PicturePart], capsys: pytest.CaptureFixture[str]) -> None:
    painting = tmp_path / "cat"
    painting.mkdir()
    for number, each in enumerate(parts):
        canvas = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
        h, w = each.pixels.shape[:2]
        canvas[each.top : each.top + h, each.left : each.left + w] = each.pixels
        (painting / f"{number} {each.name.replace(chr(34), '')}.png").write_bytes(encode_png(canvas))
    outputs = [str(tmp_path / name) for name in ("cat.tscn", "cat.json", "cat_ske.json")]
    assert main(["puppet", str(painting), "-o", *outputs, "--vertices", "10", "--bones", "tail=3"]) == 0
    said = capsys.readouterr()
    assert "tail.002 on tail.001: nothing folds from" in said.out
    assert {path.name for path in tmp_path.iterdir()} == {
        "cat", "cat.tscn", "cat.png", "cat.json", "cat.atlas", "cat_ske.json", "cat_tex.json",
    }  # fmt: skip
    assert read_png(tmp_path / "cat.png").shape[2] == 4
    scene = (tmp_path / "cat.tscn").read_text(encoding="utf-8")
    assert scene.count('type="Polygon2D"') == 7
    assert "Nothing folds between" in scene
    skeleton = json.loads((tmp_path / "cat.json").read_text(encoding="utf-8"))
    assert [slot["name"] for slot in skeleton["slots"]][:2] == ["tail", "body"]
    kept = ["--keep", str(tmp_path / "kept.json")]
    assert main(["puppet", str(painting), "-o", outputs[0], *kept]) == 0
    (painting / "4 spots.png").unlink()
    assert main(["puppet", str(painting), "-o", outputs[0], *kept]) == 0
    assert "note: Gone: spots." in capsys.readouterr().err
    assert main(["puppet", str(painting), "-o", str(tmp_path / "cat.fbx")]) == 1
    assert "no file of an engine" in capsys.readouterr().err
    assert main(["puppet", str(tmp_path / "none.psd"), "-o", outputs[0]]) == 1
    assert "none.psd" in capsys.readouterr().err


def test_animations_of_nothing_are_told(puppet: GamePuppet, tmp_path: Path) -> None:
    wrong = {"arm": np.zeros(2)}, {"body": np.zeros(3)}
    for turned in wrong:
        animated = replace(puppet, animations=(Animation("wave", np.array([0.0, 1.0]), turned),))
        with pytest.raises(NestedCagesError, match="wave"):
            write_puppet(tmp_path / "a.tscn", animated)
    assert not list(tmp_path.iterdir())
    repeating = Animation.of(idle(puppet.puppet, seconds=3.0))
    repeating.check(puppet.bones)
    assert repeating.turned and repeating.times[-1] == 3.0
    assert all(degrees[0] == degrees[-1] != degrees[9] for degrees in repeating.turned.values())


# Caps


def test_caps_keep_joints_painted_and_show_nothing_at_rest() -> None:
    """A bar with a square end opens at its joint: opaque pixels of it stay on its parent, under the bar."""
    ends = {"lower": (190, 260, 255), "upper": (100, 200, 255)}
    bars = []
    for name, (left, right, alpha) in ends.items():
        pixels = np.zeros((SIZE[1], SIZE[0], 4), np.uint8)
        pixels[100:140, left:right] = 90, 60, left % 256, alpha
        pixels[100, left:right, 3] //= 2
        bars.append(part(name, pixels))
    made = game_puppet(bars, SIZE, name="bars", choices={"upper": PartChoice(parent="")})
    assert made.name == "bars"
    cap, lower, upper = made.meshes
    assert (cap.name, lower.name, upper.name) == ("lower.cap1", "lower", "upper")
    assert made.bones[cap.strongest].name == "upper"
    held = cap.pixels[..., 3] > 0
    rows, columns = np.nonzero(held)
    under = lower.pixels[rows + cap.top - lower.top, columns + cap.left - lower.left]
    assert (cap.pixels[held] == under).all() and (under[:, 3] == 255).all()
    turned = shapely.affinity.rotate(shapely.box(190, 100, 260, 140), 90, origin=(195, 120))
    painted = shapely.union_all([turned, shapely.box(100, 100, 200, 140)])
    seen = shapely.union_all(
        [painted, *(shapely.box(x, y, x + 1, y + 1) for y, x in np.column_stack([rows + cap.top, columns + cap.left]))]
    )
    disc = shapely.Point(195, 120).buffer(18)
    assert disc.difference(seen).area < 0.02 * disc.area < disc.difference(painted).area


def test_caps_have_ink() -> None:
    """The line around a bar goes on where its cap was cut."""
    upper, lower = (np.zeros((SIZE[1], SIZE[0], 4), np.uint8) for _ in range(2))
    upper[100:140, 100:200] = 0, 200, 0, 255
    lower[100:140, 190:260] = 20, 10, 20, 255
    lower[104:136, 194:256] = 90, 60, 190, 255
    bars = [part("lower", lower), part("upper", upper)]
    cap = game_puppet(bars, SIZE, choices={"upper": PartChoice(parent="")}).meshes[0]
    rows, columns = np.nonzero(cap.pixels[..., 3])
    away = np.hypot(rows + cap.top + 0.5 - 120.0, columns + cap.left + 0.5 - 195.0)
    rim = away > away.max() - 3.0
    assert (cap.pixels[rows[rim], columns[rim]] == (20, 10, 20, 255)).all()
    assert (cap.pixels[rows[away < away.max() - 7.0], columns[away < away.max() - 7.0], 2] == 190).any()


def mesh_of(puppet: GamePuppet, name: str) -> PartMesh:
    return next(mesh for mesh in puppet.meshes if mesh.name == name)


# Repainted


def painted_again(parts: list[PicturePart]) -> list[PicturePart]:
    """The tail thicker, the arm renamed and in front, the spots gone, a hat new."""
    _, body, arm, ring, _, shine = [replace(each, identity=str(k)) for k, each in enumerate(parts)]
    thick = part("tail", limb((270, 170), (310, 160), (350, 110), (360, 40), width=34), identity="0")
    return [thick, body, ring, shine, replace(arm, name="left arm"), part("hat", limb((120, 90), (160, 140), width=40))]


@pytest.mark.slow
def test_a_repainted_puppet_keeps_its_bones(parts: list[PicturePart], puppet: GamePuppet) -> None:
    times = np.array([0.0, 1.0])
    first = [replace(each, identity=str(k)) for k, each in enumerate(parts)]
    old = game_puppet(first, SIZE, vertices=12)
    swing = Animation("swing", times, {bone.name: np.array([0.0, 20.0]) for bone in old.bones})
    old = from_puppet_json(to_puppet_json(replace(old, animations=(swing,))))
    new, changes = repainted(old, painted_again(parts), SIZE, vertices=12)
    before, after = ({bone.name: bone for bone in each.bones} for each in (old, new))
    assert changes.added == ("hat",)
    assert changes.removed == ("spots",)
    assert set(changes.repainted) == {"tail"}
    assert changes.renamed == ('arm "R".001',)
    assert changes.is_reordered
    assert len(changes.sentences) == 5
    kept = [name for record in old.parts if record.name != "spots" for name in record.bones]
    assert len(kept) >= 4
    for name in kept:
        assert (before[name].head, before[name].tail) == (after[name].head, after[name].tail)
        one, other = ((e.bones[k].name if k is not None else None) for e, k in (
            (old, before[name].parent), (new, after[name].parent)))  # fmt: skip
        assert one == other
    assert set(new.animations[0].turned) == set(kept)
    drawn = [mesh.name for mesh in new.meshes if ".cap" not in mesh.name]
    assert drawn == ["tail", "body", "ring", "shine", 'arm "R".001', "hat"]
    assert not np.array_equal(mesh_of(new, "tail").points, mesh_of(old, "tail").points)
    again, none = repainted(old, first, SIZE, vertices=12)
    assert none.sentences == ()
    for one, other in zip(old.meshes, again.meshes, strict=True):
        np.testing.assert_array_equal(one.points, other.points)
        np.testing.assert_array_equal(one.weights, other.weights)
    assert again.ranges == old.ranges


@pytest.mark.slow
def test_weights_painted_by_hand_are_carried_by_place(parts: list[PicturePart]) -> None:
    first = [replace(each, identity=str(k)) for k, each in enumerate(parts)]
    old = game_puppet(first, SIZE, vertices=12)
    tail = mesh_of(old, "tail")
    body = next(k for k, bone in enumerate(old.bones) if bone.name == "body")
    share = 0.4 * np.clip((tail.points[:, :1].max() - tail.points[:, :1]) / np.ptp(tail.points[:, 0]), 0, 1)
    painted = (1 - share) * tail.weights
    painted[:, [body]] += share
    kept = from_puppet_json(to_puppet_json(with_hand_weights(old, {"tail": painted})))
    np.testing.assert_array_equal(mesh_of(kept, "tail").weights, painted)
    new, _ = repainted(kept, painted_again(parts), SIZE, vertices=12)
    plain, _ = repainted(old, painted_again(parts), SIZE, vertices=12)
    column = next(k for k, bone in enumerate(new.bones) if bone.name == "body")
    mesh = mesh_of(new, "tail")
    inside = shapely.contains_xy(shapely.Polygon(tail.points[: tail.hull]), mesh.points)
    wanted = 0.4 * (tail.points[:, 0].max() - mesh.points[:, 0]) / np.ptp(tail.points[:, 0])
    np.testing.assert_allclose(mesh.weights[inside, column], wanted[inside], atol=0.05)
    assert (mesh.weights.sum(axis=1) == pytest.approx(1.0)) and (mesh.weights >= 0).all()
    assert ((mesh.weights > 0).sum(axis=1) <= 4).all()
    for one, other in zip(new.meshes, plain.meshes, strict=True):
        assert one is mesh or np.array_equal(one.weights, other.weights)
    touched = {new.bones[k].name for k in range(len(new.bones)) if new.ranges[k].low == new.ranges[k].high}
    assert touched >= {"tail"}
    assert "body" not in touched
    own = np.flatnonzero(tail.weights.any(axis=0))
    softer = tail.weights**1.05
    softer /= softer.sum(axis=1, keepdims=True)
    proved = with_hand_weights(old, {"tail": softer}).ranges
    assert all(proved[k].low < -20.0 and proved[k].high > 20.0 for k in own[1:])


def test_damaged_puppet_files_end_in_a_sentence(puppet: GamePuppet) -> None:
    text, rng = to_puppet_json(puppet), np.random.default_rng(8)
    for _ in range(150):
        start = rng.integers(0, len(text))
        cut = text[:start] + text[start + rng.integers(1, 9) :]
        try:
            from_puppet_json(cut)
        except NestedCagesError as error:
            assert str(error).endswith(".")
    with pytest.raises(NestedCagesError, match="no puppet"):
        from_puppet_json("{}")
    with pytest.raises(NestedCagesError, match="This is not a puppet: its brackets are nested too deeply"):
        from_puppet_json("[" * 200_000)
    with pytest.raises(NestedCagesError, match="damaged"):
        from_puppet_json(text.replace('"parent": 0', '"parent": 77'))
