"""The command: every kind of file in and out, what is written, and its exit status."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Mesh, features_from_geojson, from_svg, read_geojson, to_svg, verify
from support.command import run, run_alone
from support.documents import closed, collection, feature, png, squares
from support.marks import slow_after
from support.shapes import letter_a, polygon, ring, star
from support.sources import ROOT


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    path = tmp_path / "letter.svg"
    path.write_text(to_svg(letter_a(1)))
    return path


def region(left: float, name: str | None, count: int = 40) -> dict[str, Any]:
    points = star(5, count).vertices + np.array([left, 0.0])
    return feature([closed(points)], name=name, identity=name, **({"people": 7} if name else {}))


def reported(path: Path) -> list[dict[str, Any]]:
    """The entries of a report."""
    document = json.loads(path.read_text(encoding="utf-8"))
    assert (document["format"], document["version"]) == ("nested-cages report", 2)
    return document["inputs"]


@pytest.mark.slow
def test_a_drawing_becomes_all_kinds_of_files(drawing: Path, tmp_path: Path) -> None:
    svg, geojson = (tmp_path / f"out{kind}" for kind in (".svg", ".geojson"))
    done = run(
        *(drawing, "--levels", 48, 24, "--loops", "keep"),
        *("-o", svg, "-o", geojson, "--report", tmp_path / "r.json"),
    )
    assert done.status == 0 and all(str(path) in done.out for path in (svg, geojson))
    fine, inner, outer = (from_svg(svg.read_text(), element=name) for name in ("drawing", "cage-1", "cage-2"))
    assert fine.area == letter_a(1).area
    assert verify(inner, fine) and verify(outer, inner)
    features = features_from_geojson(geojson.read_bytes())
    assert [each.properties["level"] for each in features] == [1, 2]
    assert [each.properties["vertices"] for each in features] == [48, 24]
    assert polygon(features[1].mesh).equals(polygon(outer))
    (entry,) = reported(tmp_path / "r.json")
    assert (entry["file"], entry["kind"], entry["errors"]) == (str(drawing), "drawing", [])
    assert entry["written"] == [str(path) for path in (svg, geojson)]
    (shape,) = entry["shapes"]
    assert (shape["vertices"], shape["loops"]) == (len(fine.vertices), 2)
    for level, cage, inside, each in zip(shape["levels"], (inner, outer), (fine, inner), features, strict=True):
        assert (level["vertices"], level["strict"], level["simple"]) == (len(cage.vertices), True, True)
        assert level["excess"] == each.properties["excess"] == pytest.approx(cage.area / inside.area - 1.0)
        distance = polygon(cage).boundary.distance(polygon(inside).boundary)
        assert level["clearance"] == each.properties["clearance"] == pytest.approx(distance)
        assert level["wanted_clearance"] <= distance * (1 + 1e-9)


def test_without_an_output_the_cages_are_certified_only(drawing: Path, tmp_path: Path) -> None:
    done = run(drawing, "--levels", 24, "--clearance", 0.01, "--report", tmp_path / "r.json")
    assert done.status == 0 and "24" in done.out
    (level,) = reported(tmp_path / "r.json")[0]["shapes"][0]["levels"]
    assert level["clearance"] >= level["wanted_clearance"] == 0.01
    assert {path.name for path in tmp_path.iterdir()} == {"letter.svg", "r.json"}


@pytest.mark.slow
def test_features_of_a_map_get_their_own_cages(tmp_path: Path) -> None:
    members = [region(0.0, "West"), region(2.0, None, 12), region(4.0, "East")]
    (tmp_path / "map.geojson").write_text(collection(*members))
    out = tmp_path / "simple.geojson"
    texts = []
    for jobs in (1, 2):
        done = run(tmp_path / "map.geojson", "--levels", 15, "--jobs", jobs, "-o", out)
        assert done.status == 0 and "East" in done.out
        texts.append(out.read_text())
    assert texts[0] == texts[1]
    features = features_from_geojson(out.read_bytes())
    assert [each.id for each in features] == ["West", None, "East"]
    assert [each.properties["vertices"] for each in features] == [15, 12, 15]
    assert features[2].properties["people"] == 7
    for member, each in zip(members, features, strict=True):
        assert verify(each.mesh, Mesh.from_geometry(member))


def test_features_that_fail_do_not_lose_the_others(tmp_path: Path) -> None:
    crossed, bad = region(0.0, "Crossed"), region(0.0, "Bad")
    crossed["geometry"]["coordinates"] = [[[[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]]]]
    bad["geometry"]["coordinates"] = [[[["0", "0"], [1, 1], [1, 0]]]]
    two = [region(left, None)["geometry"]["coordinates"][0] for left in (5.0, 9.0)]
    (tmp_path / "map.geojson").write_text(collection(crossed, bad, region(2.0, "East"), feature(*two, name="Lost")))
    out, report = tmp_path / "out.geojson", tmp_path / "r.json"
    command = [tmp_path / "map.geojson", "--levels", 5, "--loops", "keep", "--quiet"]
    done = run(*command, "-o", out, "--report", report)
    assert (done.status, done.err.count("error: ")) == (1, 2)
    assert [each.id for each in features_from_geojson(out.read_bytes())] == ["Crossed", "East"]
    (entry,) = reported(report)
    for name, said in (("Bad", entry["errors"][0]), ("Lost", entry["errors"][1]), ("Crossed", entry["notes"][0])):
        assert name in said and said in done.err
    assert run(*command, "-o", out, "--flip-y").status == 1  # a map has the north up


def test_the_crs_of_a_map_is_kept(tmp_path: Path) -> None:
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3857"}}
    (tmp_path / "map.geojson").write_text(collection(region(0.0, "West"), crs=crs))
    assert run("map.geojson", "--levels", 8, "-o", "out.geojson", "--quiet", cwd=tmp_path).status == 0
    assert json.loads((tmp_path / "out.geojson").read_text())["crs"] == crs


def test_a_map_has_the_north_up_and_a_picture_its_frame(tmp_path: Path) -> None:
    (tmp_path / "map.geojson").write_text(json.dumps(region(0.0, "West")))
    out = tmp_path / "out.svg"
    assert run(tmp_path / "map.geojson", "--levels", 8, "-o", out, "--quiet").status == 0
    north = Mesh.from_geometry(region(0.0, "West"))
    assert from_svg(out.read_text(), element="drawing").vertices[:, 1].max() == -north.vertices[:, 1].min()
    (tmp_path / "full.png").write_bytes(png(np.pad(np.ones((5, 7), bool), 2)))
    assert run(tmp_path / "full.png", "--levels", 4, "-o", out, "--quiet").status == 0
    assert 'viewBox="0 0 11 9"' in out.read_text()
    assert np.ravel(from_svg(out.read_text(), element="drawing").bounds).tolist() == [2, 2, 9, 7]
    assert run("full.png", "map.geojson", "--levels", 8, "--inside", cwd=tmp_path).err.count("error: ") == 1
    (tmp_path / "opaque.png").write_bytes(png(np.ones((5, 7), bool)))
    assert run(tmp_path / "opaque.png", "--levels", 4, "--quiet").err.count("note: ") == 1  # all may be background


@pytest.mark.slow
def test_a_picture_becomes_an_outline(tmp_path: Path) -> None:
    y, x = np.indices((60, 80))
    opaque = np.hypot(x - 40, y - 25) < 20
    opaque[23:27, 38:42] = False
    (tmp_path / "a.png").write_bytes(png(opaque))
    out = tmp_path / "a.geojson"
    assert run(tmp_path / "a.png", "--levels", 12, "--loops", "keep", "-o", out, "--quiet").status == 0
    assert len(read_geojson(out).loops) == 2
    assert run(tmp_path / "a.png", "--levels", 12, "-o", out, "--flip-y", "--pieces", 6, "--quiet").status == 0
    found = core.read_map(out.read_bytes())
    assert found.pixels == {"y": "up", "width": 80, "height": 60}
    outline, *pieces = (
        shapely.transform(polygon(each.mesh), lambda p: p * (1, -1) + (0, 60)) for each in found.features
    )
    assert len(outline.interiors) == 0 and shapely.covers(outline, squares(opaque)).all()
    assert found.features[0].properties["centroid"] == pytest.approx([outline.centroid.x, 60 - outline.centroid.y])
    assert found.features[0].properties["area"] == pytest.approx(outline.area)
    assert [each.properties["piece"] for each in found.features[1:]] == [*range(1, len(pieces) + 1)]
    assert max(len(piece.exterior.coords) for piece in pieces) <= 7
    assert all(piece.convex_hull.area == pytest.approx(piece.area) for piece in pieces)
    assert sum(piece.area for piece in pieces) == pytest.approx(outline.area)
    assert shapely.union_all(pieces).symmetric_difference(outline).area < 1e-9
    assert run(tmp_path / "a.png", "--levels", 12, "-o", out, "--clearance", 2, "--threshold", 0.2).status == 0
    assert shapely.distance(polygon(read_geojson(out)).boundary, squares(opaque)).min() >= 2 - 1e-9


@pytest.mark.slow
def test_several_files_patterns_and_percentages(drawing: Path, tmp_path: Path) -> None:
    (tmp_path / "star.svg").write_text(to_svg(star(5, 60)))
    (tmp_path / "broken.svg").write_text("<svg")
    (tmp_path / "cages").mkdir()
    command = ["*.svg", "--levels", "50%", "20%", "-o", "cages/{stem}.svg", "--report", "r.json", "--quiet"]
    done = run(*command, cwd=tmp_path)
    assert done.status == 1 and "broken.svg" in done.err  # and loses none of the others
    broken, letter, spiky = reported(tmp_path / "r.json")
    assert len(broken["errors"]) == 1 and broken["written"] == broken["shapes"] == []
    assert [each["vertices"] for each in spiky["shapes"][0]["levels"]] == [30, 12]
    assert letter["errors"] == [] and spiky["written"] == [str(Path("cages") / "star.svg")]
    assert verify(from_svg((tmp_path / "cages" / "star.svg").read_text(), element="cage-2"), star(5, 60))
    assert all(name in done.out for name in ("star.svg", "letter.svg"))


@pytest.mark.slow
@pytest.mark.parametrize("name", slow_after(0, ["a.svg", "b.svg", "c.geojson", "d.png"], thorough_after=2))
def test_a_count_is_a_promise(name: str, tmp_path: Path) -> None:
    rings = [ring(20) + np.array([3.0 * k, 0.0]) for k in range(8)]
    opaque = np.zeros((9, 40), bool)
    opaque[3:6, ::5] = True
    content: dict[str, str | bytes] = {
        "a.svg": to_svg(Mesh.from_loops(rings)),
        "b.svg": to_svg(Mesh.from_loops([4.0 * ring(40), 3.9 * ring(40), 3.8 * ring(40)])),  # triangles would cross
        "c.geojson": collection(feature(*[[closed(each)] for each in rings]), region(99.0, "West")),
        "d.png": png(opaque),
    }
    given = content[name]
    (tmp_path / name).write_bytes(given if isinstance(given, bytes) else given.encode())
    command = [tmp_path / name, "--levels", 10, 5, "--quiet"]
    done = run(*command, "--report", tmp_path / "r.json")
    assert done.status == 0
    first, second = reported(tmp_path / "r.json")[0]["shapes"][0]["levels"]
    assert first["vertices"] <= 10 and second["vertices"] <= 5
    assert any(first["lost"].values()) and all(note in done.out for note in first["notes"])
    assert run(*command, "--loops", "keep").status == 1


def test_levels_are_made_from_the_finest_to_the_coarsest(drawing: Path, tmp_path: Path) -> None:
    assert run(drawing, "--levels", "40%", "60%", "--quiet", "--report", tmp_path / "r.json").status == 0
    first, second = (level["vertices"] for level in reported(tmp_path / "r.json")[0]["shapes"][0]["levels"])
    assert first > second


def test_levels_before_one_that_fails_are_written(drawing: Path, tmp_path: Path) -> None:
    """No triangle fits between a drawing and a box around it."""
    low, high = letter_a(1).vertices.min(axis=0) - 0.05, letter_a(1).vertices.max(axis=0) + 0.05
    box = f"--box={low[0]},{low[1]},{high[0]},{high[1]}"
    out = tmp_path / "out.geojson"
    assert run(drawing, "--levels", 24, 3, box, "-o", out, "--quiet").status == 1
    assert [each.properties["vertices"] for each in features_from_geojson(out.read_bytes())] == [24]


@pytest.mark.parametrize("symmetry", ["x", *slow_after(0, ["found", "2"])])
def test_symmetric_cages_and_limits_of_edges(symmetry: str, drawing: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.geojson"
    command = [drawing, "--levels", 24, "--symmetry", symmetry, "--min-edge", 0.1, "--min-angle", 45, "--quiet"]
    assert run(*command, "-o", out).status == 0
    cage = read_geojson(out)
    assert cage.edge_lengths.min() >= 0.1
    before, after = (cage.vertices[way] - cage.vertices for way in (cage.predecessor, cage.successor))
    cosine = (before * after).sum(axis=1) / np.hypot(*before.T) / np.hypot(*after.T)
    assert np.degrees(np.arccos(cosine)).min() >= 45.0 - 1e-6
    rows = cage.vertices - (0.0 if symmetry != "2" else cage.vertices.mean(axis=0))
    image = rows * ((-1.0, -1.0) if symmetry == "2" else (-1.0, 1.0))
    assert shapely.MultiPoint(image).hausdorff_distance(shapely.MultiPoint(rows)) < 1e-6


@pytest.mark.parametrize("directions", ["axes", *slow_after(0, ["transit", "30,120"])])
def test_edges_along_directions_in_a_box(directions: str, drawing: Path, tmp_path: Path) -> None:
    room = 3.0 if directions == "30,120" else 0.01
    low, high = letter_a(1).vertices.min(axis=0) - room, letter_a(1).vertices.max(axis=0) + room
    corners = ",".join(map(str, (*low.tolist(), *high.tolist())))
    out = tmp_path / "out.geojson"
    command = [drawing, "--levels", 24, "--directions", directions, f"--box={corners}", "--quiet", "-o", out]
    assert run(*command).status == 0
    cage = read_geojson(out)
    edge = cage.edge_ends - cage.vertices
    angle = np.degrees(np.arctan2(edge[:, 1], edge[:, 0])) - (30.0 if directions == "30,120" else 0.0)
    turns = 45.0 if directions == "transit" else 90.0
    assert np.abs((angle + 0.5 * turns) % turns - 0.5 * turns).max() < 1e-5
    assert (cage.vertices >= low - 1e-9).all() and (cage.vertices <= high + 1e-9).all()


def parts_of(directory: Path) -> Path:
    """Three discs, two of them close to each other."""
    path = directory / "parts.svg"
    path.write_text(to_svg(Mesh.from_loops([ring(24), *(ring(24) + np.array([x, 0.0]) for x in (2.1, 6.0))])))
    return path


@pytest.mark.parametrize(
    ("options", "loops"), [(["--loops", "one"], 1), (["--convex"], 3), *slow_after(0, [(["--loops", "auto"], 2)])]
)
def test_parts_share_a_loop_as_asked_for(options: list[str], loops: int, tmp_path: Path) -> None:
    out = tmp_path / "out.geojson"
    assert run(parts_of(tmp_path), "--levels", 8, "--quiet", "-o", out, *options).status == 0
    cage = read_geojson(out)
    assert len(cage.loops) == loops
    assert "--convex" not in options or shapely.unary_union(
        [polygon(Mesh.of(each)) for each in cage.rings]
    ).area == pytest.approx(sum(polygon(Mesh.of(each)).convex_hull.area for each in cage.rings))


@pytest.mark.parametrize(
    ("options", "area"),
    [
        ([], 136.0),  # of the square at the right, half is seen
        (["--no-strokes"], 132.0),
        (["--element", "b"], 32.0),
        (["--layers", "top"], 32.0),
        (["--no-crop"], 168.0),
    ],
)
def test_options_of_drawings_say_what_is_read(options: list[str], area: float, tmp_path: Path) -> None:
    body = '<rect id="a" width="10" height="10"/><g id="top"><rect id="b" x="20" width="8" height="8"/></g>'
    body += '<path d="M14 5h2" stroke="red" stroke-width="2"/>'
    page = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 24 12">{body}</svg>'
    (tmp_path / "a.svg").write_text(page)
    assert run("a.svg", "--levels", 12, *options, "-o", "out.svg", "--quiet", cwd=tmp_path).status == 0
    read = from_svg((tmp_path / "out.svg").read_text(), element="drawing", crop=False)
    assert read.area == pytest.approx(area)


# Streams, names and interruptions


@pytest.mark.slow
def test_streams_in_and_out(drawing: Path) -> None:
    def piped(given: str | bytes, *options: object) -> Any:
        return run("-", "--quiet", "--levels", 8, "-o", "-", *options, stdin=given)

    done = run_alone("-", "--quiet", "--levels", 24, "-o", "-", input=drawing.read_text(encoding="utf-8"))
    assert done.returncode == 0 and "24" in done.stderr
    assert len(from_svg(done.stdout, element="cage-1").vertices) == 24
    west = json.dumps(region(0.0, "West"))
    assert features_from_geojson(piped(west).out)[0].properties["name"] == "West"
    assert len(features_from_geojson(piped(png(np.eye(5))).out)[0].mesh.vertices) == 8
    strange = piped(b"hello")
    assert (strange.status, strange.out) == (1, "") and "error: " in strange.err


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="pipes of POSIX")
def test_closed_streams_lose_no_work(drawing: Path, tmp_path: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    command = ["letter.svg", "--levels", 24, "-o", "out.svg", "--quiet"]
    with os.fdopen(writing, "wb") as gone:
        done = run_alone(*command, "--report", "r.json", cwd=tmp_path, capture_output=False, stdout=gone)
    assert done.returncode == 0
    assert len(from_svg((tmp_path / "out.svg").read_text(), element="cage-1").vertices) == 24
    assert reported(tmp_path / "r.json")[0]["written"] == ["out.svg"]
    shell = f"{sys.executable} -m nestedcages_core letter.svg --levels 24 -o out.svg --report"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    for closing, status in ((" r.json >&- 2>&-", 0), (" - >&-", 1)):
        (tmp_path / "out.svg").unlink()
        ended = subprocess.run(
            shell + closing, shell=True, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, check=False
        )
        assert ended.returncode == status and b"Traceback" not in ended.stderr
        assert (tmp_path / "out.svg").is_file()


def test_an_interrupt_ends_with_its_status(drawing: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.fsync", Mock(side_effect=KeyboardInterrupt))
    done = run(drawing, "--levels", 24, "-o", drawing.with_name("out.svg"))
    assert done.status == 130 and "Traceback" not in done.err and done.err.strip()
    assert [*drawing.parent.iterdir()] == [drawing]


@pytest.mark.slow
def test_names_that_the_console_cannot_write(tmp_path: Path) -> None:
    names = ["Łódź", "half \ud83d a character", "two\nlines", "East"]
    (tmp_path / "map.geojson").write_text(collection(*(region(3.0 * k, name) for k, name in enumerate(names))))
    command = ["map.geojson", "--levels", 8, "-o", "out.geojson", "-o", "out.svg", "--report", "r.json"]
    done = run_alone(*command, cwd=tmp_path, env={"PYTHONIOENCODING": "cp1252"}, encoding="cp1252")
    assert done.returncode == 0, done.stderr
    features = features_from_geojson((tmp_path / "out.geojson").read_bytes())
    assert [each.properties["name"] for each in features] == names
    assert ["East" in shape["name"] for shape in reported(tmp_path / "r.json")[0]["shapes"]] == [False] * 3 + [True]


def test_a_terminal_gets_a_bar_and_others_lines(drawing: Path) -> None:
    done = run(drawing, "--levels", 24, terminal=True)
    assert done.status == 0 and "\r[" in done.err and done.err.endswith("\n")
    plain = run(drawing, "--levels", 23)
    assert "\r" not in plain.err and plain.err.count("%") >= 2
    assert run(drawing, "--levels", 30, "--quiet").err == ""


def test_help_names_every_option_and_status() -> None:
    short, everything = run("--help"), run("--help", "all")
    assert short.status == everything.status == 0
    assert max(map(len, short.out.splitlines())) < 80 and "%%" not in everything.out
    assert re.fullmatch(r"nested-cages \d+\.\d+.*\n", run("--version").out)
    assert "--jobs" in run("--help", "maps").out
    options = "levels output report limit clearance quiet tolerance element jobs threshold flip-y layers no-strokes "
    options += "no-crop pieces inside symmetry directions box grid seconds loops"
    for option in options.split():
        assert re.search(rf"--{option}\b.*\s+\w", everything.out), option
    for words in (["check", "--help"], ["puppet", "--help"]):
        assert run(*words).status == 0 and "usage" in run(*words).out.lower()
    assert run().status == run("check").status == run("puppet").status == 2


SVG = ["letter.svg", "--levels", "24"]


@pytest.mark.parametrize(
    ("command", "status"),
    [(["letter.svg"], 2), (["letter.svg", "--levels", "0"], 2), (["letter.svg", "--levels", "7.5"], 2),
     (["letter.svg", "--levels", ","], 2), (["letter.svg", "--levels", "120%"], 2),
     (["letter.svg", "--levels", "24", "2m"], 2), ([*SVG, "--clearance", "-1"], 2), ([*SVG, "--clearance", "inf"], 2),
     ([*SVG, "--threshold", "2"], 2), ([*SVG, "--threshold", "0.5"], 2), ([*SVG, "--jobs", "2"], 2),
     (["fake.png", "--levels", "24", "--element", "a"], 2), ([*SVG, "--flip-y"], 2), ([*SVG, "--pieces", "8"], 2),
     ([*SVG, "--pieces", "2", "-o", "out.json"], 2), ([*SVG, "--limit", "size=3"], 2), ([*SVG, "--symmetry", "z"], 2),
     ([*SVG, "--symmetry", "1"], 2), ([*SVG, "--min-angle", "70"], 2), ([*SVG, "--convex", "--min-edge", "1"], 2),
     ([*SVG, "--convex", "--inside"], 1), ([*SVG, "--directions", "up"], 2), ([*SVG, "--directions", "0"], 2),
     ([*SVG, "--box", "1,2,3"], 2), ([*SVG, "--box", "1,1,1,2"], 2), ([*SVG, "--box", "a,b,c,d"], 2),
     (["empty.geojson", "--levels", "24", "--inside", "--jobs", "2"], 2), ([*SVG, "-o", "-", "--report", "-"], 2),
     ([*SVG, "--clearance", "5km"], 1),
     (["letter.svg", *SVG, "link.svg", "-o", "-"], 2),
     (["letter.svg", "LETTER.geojson", "--levels", "24", "-o", "{stem}-cages.svg"], 2),  # one file on Windows
     (["letter.svg", "fake.png", "--levels", "24", "-o", "out.svg"], 2), (["letter.txt", "--levels", "24"], 2),
     ([*SVG, "-o", "out.pdf"], 2), ([*SVG, "-o", "no/out.svg"], 2), ([*SVG, "-o", "o.svg", "--report", "./o.svg"], 2),
     ([*SVG, "-o", "letter.svg"], 2), ([*SVG, "-o", "link.svg"], 2), ([*SVG, "-o", "{stem}.svg"], 2),
     (["*.svgz", "--levels", "24"], 2), (["none.svg", "--levels", "24"], 1),
     (["letter.svg", "--levels", "5", "--loops", "keep"], 1),
     (["deep.geojson", "--levels", "24", "--limit", "bytes=10"], 1), ([*SVG, "--limit", "points=10"], 1),
     ([*SVG, "--element", "x"], 1), (["empty.geojson", "--levels", "24"], 1), (["fake.png", "--levels", "24"], 1),
     (["deep.geojson", "--levels", "24"], 1)],
)  # fmt: skip
def test_what_goes_wrong_ends_with_a_sentence_and_its_status(drawing: Path, command: list[str], status: int) -> None:
    folder = drawing.parent
    (folder / "link.svg").symlink_to("letter.svg")
    (folder / "fake.png").write_bytes(b"GIF89a")
    (folder / "deep.geojson").write_text("[" * 100_000)
    (folder / "LETTER.geojson").write_text(core.to_geojson(ring(9)))
    (folder / "empty.geojson").write_text('{"type": "FeatureCollection", "features": []}')
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    done = run(*command, cwd=folder)
    assert done.status == status
    assert "error: " in done.err and "Traceback" not in done.err and "error: None" not in done.err
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
