"""The command: every kind of file in and out, what it says, and its exit status."""

from __future__ import annotations

import errno
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pytest
import shapely
from test_pictures import encoded

from nestedcages_core import (
    Mesh,
    Progress,
    from_engine_json,
    from_svg,
    nested_cages,
    read_geojson,
    to_svg,
    verify,
)
from nestedcages_core.command import main
from nestedcages_core.command.making import _processes
from nestedcages_core.command.progress import ProgressLine, tell
from nestedcages_core.errors import NestingError
from nestedcages_core.exchange import features_from_geojson
from support.engine_json import frames_of, pieces_of
from support.marks import slow_after
from support.shapes import letter_a, polygon, ring, star

ROOT = Path(__file__).resolve().parents[2]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}  # on Windows no program starts without the system's own


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    path = tmp_path / "letter.svg"
    path.write_text(to_svg(letter_a(1)))
    return path


def region(left: float, name: str | None, count: int = 40) -> dict:
    points = star(5, count).vertices + np.array([left, 0.0])
    known = {"name": name, "people": 7} if name else None
    geometry = {"type": "Polygon", "coordinates": [[*points.tolist(), points[0].tolist()]]}
    return {"type": "Feature", "properties": known, "geometry": geometry, "id": name}


def png(opaque: np.ndarray) -> bytes:
    return encoded(np.stack((opaque * 0, opaque * 255), axis=2), 8, 4, [0])


@pytest.mark.slow
def test_a_drawing_becomes_all_kinds_of_files(drawing: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    svg, geojson, outline = (tmp_path / f"out{kind}" for kind in (".svg", ".geojson", ".json"))
    status = main([str(drawing), "--levels", "48", "24", "-o", str(svg), "-o", str(geojson), "-o", str(outline)])
    said = capsys.readouterr()
    assert status == 0
    assert "Level 2: 24 vertices, strictly nested: yes, simple: yes" in said.out
    assert f"Wrote {svg}" in said.out
    assert "level 1, tightening" in said.err
    fine, inner, outer = (from_svg(svg.read_text(), element=name) for name in ("drawing", "cage-1", "cage-2"))
    assert verify(inner, fine)
    assert verify(outer, inner)
    features = features_from_geojson(geojson.read_bytes())
    assert [feature.properties["level"] for feature in features] == [1, 2]
    assert [feature.properties["vertices"] for feature in features] == [48, 24]
    assert polygon(features[1].mesh).equals(polygon(outer))
    assert polygon(from_engine_json(outline.read_bytes())).equals(polygon(outer))


def test_without_an_output_the_cages_are_certified_only(drawing: Path, capsys: pytest.CaptureFixture) -> None:
    assert main([str(drawing), "--levels", "24", "--clearance", "0.01"]) == 0
    found = re.search(r"clearance ([\d.e-]+) \(wanted 0.01\)", capsys.readouterr().out)
    assert found
    assert float(found[1]) >= 0.01


@pytest.mark.slow
def test_a_picture_becomes_an_outline(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    y, x = np.indices((60, 80))
    opaque = np.hypot(x - 40, y - 25) < 20
    opaque[23:27, 38:42] = False
    (tmp_path / "a.png").write_bytes(png(opaque))
    rows, columns = np.nonzero(opaque)
    squares = shapely.box(columns, rows, columns + 1, rows + 1)
    for options, flip, loops in (
        (["--padding", "2"], None, 1),
        (["--holes", "--flip-y", "--triangles", "--pieces", "6"], 60.0, 2),
    ):
        out = tmp_path / "a.json"
        assert main([str(tmp_path / "a.png"), "--levels", "12", "-o", str(out), *options]) == 0
        outline = from_engine_json(out.read_text(), flip_y=flip)
        assert len(outline.loops) == loops
        assert shapely.covers(polygon(outline), squares).all()
        assert ("triangles" in json.loads(out.read_text())) == (flip is not None)
    pieces = pieces_of(out.read_text(), flip_y=60.0)
    assert max(map(len, pieces)) <= 6
    assert sum(shapely.Polygon(piece).area for piece in pieces) == pytest.approx(outline.area)
    assert "12 vertices" in capsys.readouterr().out


@pytest.mark.slow
def test_pictures_become_the_frames_of_an_animation(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    y, x = np.indices((40, 60))
    for frame in range(3):
        turned = 0.3 * frame + 0.2
        u = (x - 30) * np.cos(turned) + (y - 20) * np.sin(turned)
        v = (y - 20) * np.cos(turned) - (x - 30) * np.sin(turned)
        (tmp_path / f"walk_{frame}.png").write_bytes(png((np.abs(u) < 14) & (np.abs(v) < 6)))
    out = tmp_path / "walk.json"
    assert main([str(tmp_path / "walk_*.png"), "--levels", "8", "-o", str(out), "--flip-y"]) == 0
    assert f"Wrote {out}" in capsys.readouterr().out
    frames = frames_of(out.read_text(), flip_y=40.0)
    assert [time for time, _ in frames] == [0.0, 1.0, 2.0]
    assert {len(outline.vertices) for _, outline in frames} == {8}
    (tmp_path / "walk_3.png").write_bytes(png(np.zeros((40, 60), bool)))
    out.unlink()
    assert main([str(tmp_path / "walk_*.png"), "--levels", "8", "-o", str(out)]) == 1
    assert "not written, since walk_3.png has no outline" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("jobs", slow_after(1, ["1", "2"]))
def test_features_of_a_map_get_their_own_cages(tmp_path: Path, capsys: pytest.CaptureFixture, jobs: str) -> None:
    members = [region(0.0, "West"), region(2.0, None, 12), region(4.0, "East")]
    (tmp_path / "map.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": members}))
    out = tmp_path / "simple.geojson"
    assert main([str(tmp_path / "map.geojson"), "--levels", "15", "--jobs", jobs, "-o", str(out)]) == 0
    features = features_from_geojson(out.read_bytes())
    assert [feature.id for feature in features] == ["West", None, "East"]
    assert [feature.properties["vertices"] for feature in features] == [15, 12, 15]
    assert features[2].properties["people"] == 7
    for member, feature in zip(members, features, strict=True):
        assert verify(feature.mesh, Mesh.from_geometry(member))
    said = capsys.readouterr()
    assert "feature 2 (East): 40 vertices, 1 loop" in said.out
    assert "3 of 3 features" in said.err


def test_features_that_fail_do_not_lose_the_others(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    lost = region(9.0, "Lost")
    ring = lost["geometry"]["coordinates"][0]
    rings = {"type": "MultiPolygon", "coordinates": [[[[x + k, y] for x, y in ring]] for k in (0.0, 5.0)]}
    members = [region(0.0, "West"), {**lost, "geometry": rings}]
    (tmp_path / "map.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": members}))
    out = tmp_path / "out.geojson"
    assert main([str(tmp_path / "map.geojson"), "--levels", "5", "-o", str(out), "--quiet", "--loops", "keep"]) == 1
    assert "error: feature 1 (Lost): Level 1 asks for 5 vertices" in capsys.readouterr().err
    assert len(read_geojson(out).vertices) == 5
    assert main([str(tmp_path / "map.geojson"), "--levels", "6", "-o", str(tmp_path / "out.json"), "--quiet"]) == 1
    said = capsys.readouterr()
    assert "is made of one feature, but map.geojson has 2" in said.err
    assert said.out == ""  # before any cage is made


def test_a_feature_that_is_no_shape_does_not_lose_the_others(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    crossed, bad = region(0.0, "Crossed"), region(0.0, "Bad")
    crossed["geometry"]["coordinates"] = [[[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]]]
    bad["geometry"]["coordinates"] = [[["0", "0"], [1, 1], [1, 0]]]
    members = [crossed, bad, region(2.0, "East")]
    (tmp_path / "map.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": members}))
    out = tmp_path / "out.geojson"
    assert main([str(tmp_path / "map.geojson"), "--levels", "15", "-o", str(out), "--quiet"]) == 1
    said = capsys.readouterr().err
    assert "error: feature 1 (Bad): Point 0 of ring 0" in said
    assert "note: Feature 0 (Crossed): self-intersection at (0.5, 0.5): repaired." in said
    assert "note: The map names no coordinate reference system" in said
    assert [feature.id for feature in features_from_geojson(out.read_bytes())] == ["Crossed", "East"]


@pytest.mark.slow
def test_several_files_patterns_and_percentages(drawing: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (drawing.parent / "star.svg").write_text(to_svg(star(5, 60)))
    (drawing.parent / "broken.svg").write_text("<svg")
    (tmp_path / "cages").mkdir()
    options = [
        "--levels",
        "50%",
        "20%",
        "-o",
        str(tmp_path / "cages" / "{stem}.svg"),
        "--report",
        str(tmp_path / "r.json"),
    ]
    assert main([str(tmp_path / "*.svg"), *options, "--quiet"]) == 1  # broken.svg loses none of the others
    said = capsys.readouterr()
    assert "broken.svg: This is not an SVG document" in said.err
    report = json.loads((tmp_path / "r.json").read_text())
    assert (report["format"], report["version"]) == ("nested-cages report", 1)
    broken, letter, spiky = report["inputs"]
    assert "not an SVG" in broken["errors"][0]
    assert [each["vertices"] for each in spiky["shapes"][0]["levels"]] == [30, 12]
    assert letter["errors"] == []
    measures = spiky["shapes"][0]["levels"][0]
    assert re.search(r"star\.svg +1 +60 +30, 12 +[\d.]+ %, [\d.]+ % +[\d.]+\n", said.out)
    assert re.search(r"broken\.svg +0 +0 .*1 failed", said.out)
    assert measures["strict"]
    assert measures["excess"] > 0.0
    assert spiky["written"] == [str(tmp_path / "cages" / "star.svg")]
    read = from_svg((tmp_path / "cages" / "star.svg").read_text(), element="cage-2")
    assert verify(read, star(5, 60))


@pytest.mark.slow
def test_a_count_is_a_promise(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    rings = [ring(20) + np.array([3.0 * k, 0.0]) for k in range(8)]
    (tmp_path / "a.svg").write_text(to_svg(Mesh.from_loops(rings)))
    combs = [4.0 * ring(40), 3.9 * ring(40), 3.8 * ring(40)]  # triangles would cross each other
    (tmp_path / "b.svg").write_text(to_svg(Mesh.from_loops(combs)))
    member = {"type": "MultiPolygon", "coordinates": [[each.tolist()] for each in rings]}
    (tmp_path / "c.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [
        {"type": "Feature", "geometry": member, "properties": {}}, region(99.0, "West")]}))  # fmt: skip
    opaque = np.zeros((9, 40), bool)
    opaque[3:6, ::5] = True
    (tmp_path / "d.png").write_bytes(png(opaque))
    for name in ("a.svg", "b.svg", "c.geojson", "d.png"):
        report = tmp_path / "report.json"
        command = [str(tmp_path / name), "--levels", "10", "5", "--quiet"]
        assert main([*command, "--report", str(report)]) == 0
        assert re.search(r"hole is filled|parts share", capsys.readouterr().err)
        shape = json.loads(report.read_text())["inputs"][0]["shapes"][0]
        first, second = shape["levels"]
        assert first["vertices"] <= 10 and second["vertices"] <= 5
        assert first["filled"] or first["joined"]
        assert main([*command, "--loops", "keep"]) == 1
        assert re.search(r"at least \d+", capsys.readouterr().err)


def test_levels_are_made_from_the_finest_to_the_coarsest(drawing: Path, capsys: pytest.CaptureFixture) -> None:
    report = drawing.with_name("report.json")
    assert main([str(drawing), "--levels", "40%", "60%", "--quiet", "--report", str(report)]) == 0
    assert "note: The levels are made from the finest to the coarsest" in capsys.readouterr().err
    (shape,) = json.loads(report.read_text())["inputs"][0]["shapes"]
    first, second = (level["vertices"] for level in shape["levels"])
    assert first > second
    assert main([str(drawing), "--levels", "60%", "40%", "--quiet"]) == 0
    assert "finest" not in capsys.readouterr().err


@pytest.mark.slow
def test_a_closed_output_loses_no_work(drawing: Path, tmp_path: Path) -> None:
    command = f"{sys.executable} -m nestedcages_core letter.svg --levels 24 -o out.svg --report"
    for closing in (" r.json >&- 2>&-", " - >&-"):
        done = subprocess.run(
            command + closing,
            shell=True,
            cwd=tmp_path,
            env=ENVIRONMENT,
            stderr=subprocess.PIPE,
            timeout=120,
            check=False,
        )
        assert done.returncode == ("- >&-" in closing)
        assert b"Traceback" not in done.stderr
        assert (tmp_path / "out.svg").is_file()


@pytest.mark.slow
def test_streams_in_and_out(
    drawing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    def piped(given: bytes, *options: str) -> tuple[int, bytes, bytes]:
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(given)))
        return (main(["-", "--quiet", "--levels", "8", *options]), *capsysbinary.readouterr())

    command = [sys.executable, "-m", "nestedcages_core", "-", "--quiet", "--levels", "24", "-o", "-"]
    options: dict[str, Any] = {"cwd": tmp_path, "env": ENVIRONMENT, "capture_output": True, "timeout": 120}
    done = subprocess.run(command, input=drawing.read_bytes(), check=True, **options)
    assert b"Level 1: 24 vertices" in done.stderr
    assert len(from_svg(done.stdout, element="cage-1").vertices) == 24
    west = json.dumps(region(0.0, "West")).encode()
    assert features_from_geojson(piped(west, "-o", "-")[1])[0].properties["name"] == "West"
    assert len(from_engine_json(piped(west, "-o", "-", "--format", "json", "--triangles")[1]).vertices) == 8
    status, written, said = piped(b"hello")
    assert (status, written) == (1, b"")
    assert b"error: The standard input is neither" in said


@pytest.mark.slow
def test_a_reader_that_goes_away_loses_no_file(drawing: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "nestedcages_core", "letter.svg", "--levels", "24", "-o", "out.svg", "--quiet"]
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "wb") as gone:
        done = subprocess.run(
            [*command, "--report", "report.json"],
            cwd=drawing.parent,
            env=ENVIRONMENT,
            stdout=gone,
            stderr=subprocess.PIPE,
            timeout=120,
            check=False,
        )
    assert (done.returncode, done.stderr) == (0, b"")
    assert len(from_svg((tmp_path / "out.svg").read_text(), element="cage-1").vertices) == 24
    assert json.loads((tmp_path / "report.json").read_text())["inputs"][0]["written"] == ["out.svg"]


@pytest.mark.slow
def test_names_that_the_console_cannot_write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = ["Łódź", "half \ud83d a character", "two\nlines", "East"]
    members = [region(3.0 * place, name) for place, name in enumerate(names)]
    (tmp_path / "map.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": members}))
    monkeypatch.chdir(tmp_path)
    for stream in ("stdout", "stderr"):
        monkeypatch.setattr(sys, stream, io.TextIOWrapper(io.BytesIO(), encoding="cp1252"))
    command = "map.geojson --levels 8 -o out.geojson -o out.svg --report report.json"
    assert main(command.split()) == 0
    features = features_from_geojson((tmp_path / "out.geojson").read_bytes())
    assert [feature.properties["name"] for feature in features] == names
    assert json.loads((tmp_path / "report.json").read_text())["inputs"][0]["shapes"][3]["name"] == "feature 3 (East)"


def test_the_crs_of_a_map_is_kept(tmp_path: Path) -> None:
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3857"}}
    document = {"type": "FeatureCollection", "crs": crs, "features": [region(0.0, "West")]}
    (tmp_path / "map.geojson").write_text(json.dumps(document))
    out = tmp_path / "out.geojson"
    assert main([str(tmp_path / "map.geojson"), "--levels", "8", "-o", str(out), "--quiet"]) == 0
    assert json.loads(out.read_text())["crs"] == crs


def test_a_map_has_the_north_up_and_a_picture_its_frame(tmp_path: Path) -> None:
    (tmp_path / "map.geojson").write_text(json.dumps(region(0.0, "West")))
    out = tmp_path / "out.svg"
    assert main([str(tmp_path / "map.geojson"), "--levels", "8", "-o", str(out), "--quiet"]) == 0
    north = Mesh.from_geometry(region(0.0, "West"))
    assert from_svg(out.read_text(), element="drawing").vertices[:, 1].max() == -north.vertices[:, 1].min()
    (tmp_path / "full.png").write_bytes(png(np.pad(np.ones((5, 7), bool), 2)))
    assert main([str(tmp_path / "full.png"), "--levels", "4", "-o", str(out), "--quiet"]) == 0
    assert 'viewBox="0 0 11 9"' in out.read_text()


def test_of_several_files_those_with_newer_outputs_are_skipped(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.svg").write_text(to_svg(letter_a(1)))
    words = [str(tmp_path / "*.svg"), "--levels", "24", "--report", str(tmp_path / "report.json")]
    words += [*("-o", str(tmp_path / "{stem}.json")), *("-o", str(tmp_path / "{stem}.geojson"))]

    def made(*more: str) -> list[bool]:
        assert main([*words, *more]) == 0
        entries = json.loads((tmp_path / "report.json").read_text())["inputs"]
        assert [bool(entry["shapes"]) for entry in entries] == [not entry["skipped"] for entry in entries]
        return [bool(entry["written"]) for entry in entries]

    assert made() == [True, True]
    capsys.readouterr()
    assert made() == [False, False]
    said = capsys.readouterr()
    assert "b.svg: skipped, since its outputs are newer; --again makes them again" in said.err
    assert re.search(r"a\.svg .* skipped$", said.out, flags=re.MULTILINE)
    assert made("--again") == [True, True]
    os.utime(tmp_path / "b.svg")  # changed after its outputs
    os.utime(tmp_path / "b.geojson")  # of which one is newer again
    assert made() == [False, True]
    (tmp_path / "a.json").unlink()
    assert made() == [True, False]


def test_levels_before_one_that_fails_are_written(
    drawing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    def second_fails(fine: Mesh, levels: list[int], *_: object, **__: object) -> None:
        raise NestingError("Level 2 has no room.", partial=nested_cages(fine, levels[:1]))

    monkeypatch.setattr("nestedcages_core.command.making.nested_cages", second_fails)
    out = tmp_path / "out.geojson"
    assert main([str(drawing), "--levels", "24", "8", "-o", str(out), "--quiet"]) == 1
    assert "error: Level 2 has no room." in capsys.readouterr().err
    assert [each.properties["vertices"] for each in features_from_geojson(out.read_bytes())] == [24]


def test_a_full_disk_leaves_the_old_file(
    drawing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    out = tmp_path / "out.svg"
    out.write_text("before")
    monkeypatch.setattr("os.fsync", full)
    assert main([str(drawing), "--levels", "24", "-o", str(out), "--quiet"]) == 1
    assert f"error: {out}: No space left on device" in capsys.readouterr().err
    assert out.read_text() == "before"
    assert not list(tmp_path.glob(".*"))
    monkeypatch.setattr("os.fsync", lambda _: (_ for _ in ()).throw(OSError("odd")))
    assert main([str(drawing), "--levels", "24", "-o", str(out), "--quiet"]) == 1
    assert "None" not in capsys.readouterr().err


def test_a_picture_without_transparency_is_remarked(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "full.png").write_bytes(png(np.ones((5, 7), bool)))
    assert main([str(tmp_path / "full.png"), "--levels", "4", "--quiet"]) == 0
    assert "note: No pixel is fully transparent" in capsys.readouterr().err


def test_help_names_every_option_and_status(capsys: pytest.CaptureFixture) -> None:
    def said(*words: str) -> str:
        with pytest.raises(SystemExit) as end:
            main([*words])
        assert end.value.code == 0
        return capsys.readouterr().out

    short = said("--help")
    assert "%%" not in said("--help", "all")
    assert len(short.splitlines()) <= 29
    assert max(map(len, short.splitlines())) < 80
    assert "--borders" in said("--help", "maps")
    assert re.fullmatch(r"nested-cages \d+\.\d+.*\n", said("--version"))
    text = said("-h", "all")
    options = "levels output format report limit clearance quiet tolerance element jobs padding threshold holes flip-y"
    options += " layers no-strokes no-background no-crop opacity borders"
    for option in [*options.split(), "triangles", "pieces", "inside"]:
        assert re.search(rf"--{option}\b.*\s+\w", text), option
    assert all(f"\n  {status} " in text for status in (0, 1, 2, 130))


@pytest.mark.parametrize(
    ("options", "status", "sentence"),
    [
        (["letter.svg"], 2, "--levels"),
        (["letter.svg", "--levels", "0"], 2, "a number of vertices such as 24"),
        (["letter.svg", "--levels", "7.5"], 2, "a number of vertices such as 24"),
        (["letter.svg", "--levels", "24", "--clearance", "-1"], 2, "length above 0"),
        (["letter.svg", "--levels", "24", "--clearance", "inf"], 2, "length above 0"),
        (["letter.svg", "--levels", "24", "--threshold", "2"], 2, "from 0 to 1"),
        (["fake.png", "--levels", "24", "--padding", "1", "--clearance", "1"], 2, "only one of them"),
        (["letter.svg", "--levels", "24", "--padding", "2"], 2, "--padding is for a picture"),
        (["fake.png", "--levels", "24", "--element", "a"], 2, "--element is for a drawing"),
        (["letter.svg", "--levels", "24", "--flip-y"], 2, "--flip-y is for collision outlines"),
        (["letter.svg", "--levels", "24", "--pieces", "8"], 2, "--pieces is for collision outlines"),
        (["letter.svg", "--levels", "24", "--pieces", "2"], 2, "at least 3"),
        (["letter.svg", "--levels", "24", "2m"], 2, "a distance such as 2px"),
        (["letter.svg", "--levels", ","], 2, "at least one level"),
        (["letter.svg", "--levels", "24", "--format", "svg"], 2, "--format is for the standard output"),
        (["letter.svg", "fake.png", "--levels", "24", "-o", "out.svg"], 2, "put {stem} into the name"),
        (["letter.svg", "--levels", "120%"], 2, "a share of them such as 8%"),
        (["letter.svg", "--levels", "24", "--limit", "size=3"], 2, "can be limited"),
        (["letter.svg", "--levels", "24", "-o", "-", "--report", "-"], 2, "takes one of"),
        (["*.svgz", "--levels", "24"], 1, "no file that can be read"),
        (["deep.geojson", "--levels", "24", "--limit", "bytes=10"], 1, "more than the 10 allowed"),
        (["letter.txt", "--levels", "24"], 2, "a file is read if it ends in"),
        (["letter.svg", "--levels", "24", "-o", "out.pdf"], 2, "a file is written if it ends in"),
        (["letter.svg", "--levels", "24", "-o", "no/out.svg"], 2, "there is no folder"),
        (["none.svg", "--levels", "24"], 1, "none.svg: No such file"),
        (["letter.svg", "--levels", "5", "--loops", "keep"], 1, "need at least 6"),
        (
            ["letter.svg", "--levels", "24", "-o", "o.svg", "--report", "./o.svg"],
            2,
            "./o.svg is written twice, as o.svg",
        ),
        (["letter.svg", "--levels", "24", "-o", "letter.svg"], 2, "letter.svg is the input letter.svg"),
        (["letter.svg", "--levels", "24", "-o", "link.svg"], 2, "link.svg is the input letter.svg"),
        (["letter.svg", "--levels", "24", "-o", "{stem}.svg"], 2, "is the input letter.svg"),
        (["letter.svg", "--levels", "24", "--grid", "1", "--decimals", "2"], 2, "give only one of them"),
        (["letter.svg", "--levels", "24", "--element", "x"], 1, "no element with the id 'x'"),
        (["empty.geojson", "--levels", "24"], 1, "no polygons"),
        (["fake.png", "--levels", "24"], 1, "not a PNG"),
        (["deep.geojson", "--levels", "24"], 1, "not GeoJSON"),
    ],
)
def test_what_goes_wrong_is_said(
    drawing: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    options: list[str],
    status: int,
    sentence: str,
) -> None:
    monkeypatch.chdir(drawing.parent)
    Path("link.svg").symlink_to("letter.svg")
    Path("fake.png").write_bytes(b"GIF89a")
    Path("deep.geojson").write_text("[" * 100_000)
    Path("empty.geojson").write_text('{"type": "FeatureCollection", "features": []}')
    try:
        found = main(options)
    except SystemExit as end:
        found = end.code
    said = capsys.readouterr()
    assert found == status
    assert "error: " in said.err
    assert sentence in said.err
    assert "Traceback" not in said.err


def test_interrupting_ends_with_its_status(
    drawing: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("nestedcages_core.command.making.nested_cages", interrupted)
    assert main([str(drawing), "--levels", "24"]) == 130
    assert "interrupted" in capsys.readouterr().err


def test_a_terminal_gets_a_bar(drawing: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert main([str(drawing), "--levels", "24"]) == 0
    said = capsys.readouterr().err
    assert "\r[" in said
    assert "Level 1 of 1" in said
    assert said.endswith("\n")


@pytest.mark.slow
def test_symmetric_cages_and_limits(drawing: Path, tmp_path: Path) -> None:
    for what, note in (("x", None), ("found", "Found a mirror"), ("2", "cover")):
        report = tmp_path / "report.json"
        command = [str(drawing), "--levels", "24", "--symmetry", what, "--min-edge", "0.1", "--min-angle", "20",
                   "--quiet", "--report", str(report), "-o", str(tmp_path / "out.geojson")]  # fmt: skip
        assert main(command) == 0
        assert note is None or note in report.read_text()
        cage = read_geojson(tmp_path / "out.geojson")
        assert cage.edge_lengths.min() >= 0.1
        if what == "x":
            x = np.sort(cage.vertices[:, 0])
            assert np.array_equal(x, -x[::-1])


@pytest.mark.parametrize("directions", ["axes", "transit", "30,120"])
def test_edges_along_directions_in_a_box(directions: str, drawing: Path, tmp_path: Path) -> None:
    room = 3.0 if directions == "30,120" else 0.01
    low, high = letter_a(1).vertices.min(axis=0) - room, letter_a(1).vertices.max(axis=0) + room
    corners = ",".join(map(str, (*low.tolist(), *high.tolist())))
    out = tmp_path / "out.geojson"
    command = [
        str(drawing),
        "--levels",
        "24",
        "--directions",
        directions,
        f"--box={corners}",
        "--quiet",
        "-o",
        str(out),
    ]
    assert main(command) == 0
    cage = read_geojson(out)
    edge = cage.edge_ends - cage.vertices
    angle = np.degrees(np.arctan2(edge[:, 1], edge[:, 0])) - (30.0 if directions == "30,120" else 0.0)
    turns = 45.0 if directions == "transit" else 90.0
    assert np.abs((angle + 0.5 * turns) % turns - 0.5 * turns).max() < 1e-5
    assert (cage.vertices >= low - 1e-9).all() and (cage.vertices <= high + 1e-9).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("merge", "loops"),
    slow_after(2, [([], 2), (["--loops", "one"], 1), (["--merge", "all"], 1), (["--merge", "0.2"], 2)]),
)
def test_parts_that_share_a_loop(merge: list[str], loops: int, tmp_path: Path) -> None:
    parts = [ring(24), *(ring(24) + np.array([x, 0.0]) for x in (2.1, 6.0))]
    (tmp_path / "parts.svg").write_text(to_svg(Mesh.from_loops(parts)))
    out = tmp_path / "out.geojson"
    assert main([str(tmp_path / "parts.svg"), "--levels", "8", "--quiet", "-o", str(out), *merge]) == 0
    assert len(read_geojson(out).loops) == loops


@pytest.mark.parametrize(
    "wrong", [["--symmetry", "z"], ["--symmetry", "1"], ["--symmetry", "x", "--borders"], ["--min-angle", "70"],
              ["--convex", "--min-edge", "1"], ["--convex", "--inside"], ["--convex", "--borders"],
              ["--directions", "up"], ["--directions", "0"], ["--box", "1,2,3"], ["--box", "1,1,1,2"],
              ["--merge", "0"], ["--merge", "all", "--symmetry", "x"]]
)  # fmt: skip
def test_symmetries_and_limits_that_cannot_be_had(wrong: list[str], drawing: Path) -> None:
    with pytest.raises(SystemExit) as end:
        main([str(drawing), "--levels", "24", *wrong])
    assert end.value.code == 2


def test_names_that_differ_in_case_alone_do_not_share_an_output(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Windows and macOS would write both to one file."""
    monkeypatch.chdir(tmp_path)
    for name in ("a/star.svg", "b/STAR.svg"):
        Path(name).parent.mkdir()
        Path(name).write_text(to_svg(star(5, 60)), encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["a/star.svg", "b/STAR.svg", "--levels", "20", "-o", "{stem}-cages.svg"])
    assert "two input files are called star" in capsys.readouterr().err


class Gone(io.StringIO):
    """A stream whose reader has gone away, as Windows tells it."""

    def __init__(self, file: BinaryIO) -> None:
        super().__init__()
        self.file = file

    def write(self, text: str) -> int:
        raise OSError(errno.EINVAL, "Invalid argument")

    def fileno(self) -> int:
        return self.file.fileno()


def test_a_reader_that_goes_away_is_known_on_windows_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with (tmp_path / "stream").open("wb") as file:
        with pytest.raises(OSError, match="Invalid argument"):
            tell("words", Gone(file))
        monkeypatch.setattr("sys.platform", "win32")
        tell("words", Gone(file))
        line = ProgressLine(Gone(file), silent=False)
        line.of_run(Progress(0, "flow", 0.5, "half"))
        line.end()


def test_windows_gets_no_more_processes_than_it_can_wait_for(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _processes(100)._max_workers == 100  # type: ignore[attr-defined]
    monkeypatch.setattr("sys.platform", "win32")
    assert _processes(100)._max_workers == 61  # type: ignore[attr-defined]
    assert _processes(2)._max_workers == 2  # type: ignore[attr-defined]
