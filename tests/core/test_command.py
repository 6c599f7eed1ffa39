"""The command: every kind of file in and out, what it says, and its exit status."""

from __future__ import annotations

import json
import re
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
import shapely

from nestedcages_core import Mesh, from_engine_json, from_svg, read_geojson, to_engine_json, to_svg, verify
from nestedcages_core.command import main
from nestedcages_core.exchange import features_from_geojson
from shapes import letter_a, polygon, star

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    path = tmp_path / "letter.svg"
    path.write_text(to_svg(letter_a(2)))
    return path


def region(left: float, name: str | None, count: int = 40) -> dict:
    points = star(5, count).vertices + np.array([left, 0.0])
    known = {"name": name, "people": 7} if name else None
    geometry = {"type": "Polygon", "coordinates": [[*points.tolist(), points[0].tolist()]]}
    return {"type": "Feature", "properties": known, "geometry": geometry, "id": name}


def png(opaque: np.ndarray) -> bytes:
    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    grey = np.stack((opaque * 0, opaque * 255), axis=2).astype(np.uint8)
    rows = b"".join(b"\0" + row.tobytes() for row in grey)
    header = struct.pack(">IIBBBBB", opaque.shape[1], opaque.shape[0], 8, 4, 0, 0, 0)
    parts = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + parts


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


@pytest.mark.slow
def test_the_module_runs_and_keeps_quiet(drawing: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "nestedcages_core", str(drawing), "--levels", "24", "--quiet", "-o", "out.svg"]
    done = subprocess.run(
        command, cwd=tmp_path, env={"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "out.svg").is_file()


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
    for options, flip, loops in ((["--padding", "2"], None, 1), (["--holes", "--flip-y", "--triangles"], 60.0, 2)):
        out = tmp_path / "a.json"
        assert main([str(tmp_path / "a.png"), "--levels", "12", "-o", str(out), *options]) == 0
        outline = from_engine_json(out.read_text(), flip_y=flip)
        assert len(outline.loops) == loops
        assert shapely.covers(polygon(outline), squares).all()
        assert ("triangles" in json.loads(out.read_text())) == (flip is not None)
    assert "12 vertices" in capsys.readouterr().out


@pytest.mark.parametrize("jobs", ["1", "2"])
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
    assert main([str(tmp_path / "map.geojson"), "--levels", "5", "-o", str(out), "--quiet"]) == 1
    assert "error: feature 1 (Lost): Level 1 asks for 5 vertices" in capsys.readouterr().err
    assert len(read_geojson(out).vertices) == 5
    assert main([str(tmp_path / "map.geojson"), "--levels", "6", "-o", str(tmp_path / "out.json"), "--quiet"]) == 1
    said = capsys.readouterr()
    assert "is made of one feature, but map.geojson has 2" in said.err
    assert said.out == ""  # before any cage is made


def test_a_feature_that_is_no_shape_does_not_lose_the_others(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    crossed = region(0.0, "Crossed")
    crossed["geometry"]["coordinates"] = [[[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]]]
    members = [crossed, region(2.0, "East")]
    (tmp_path / "map.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": members}))
    out = tmp_path / "out.geojson"
    assert main([str(tmp_path / "map.geojson"), "--levels", "15", "-o", str(out), "--quiet"]) == 1
    assert "error: feature 0 (Crossed): Loop 0 crosses itself" in capsys.readouterr().err
    assert [feature.id for feature in features_from_geojson(out.read_bytes())] == ["East"]


def test_a_collision_outline_is_read_too(tmp_path: Path) -> None:
    shape = letter_a(2)
    (tmp_path / "letter.json").write_text(to_engine_json(shape))
    out = tmp_path / "out.geojson"
    assert main([str(tmp_path / "letter.json"), "--levels", "24", "-o", str(out), "--quiet"]) == 0
    assert verify(read_geojson(out), shape)


def test_a_picture_without_transparency_is_remarked(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "full.png").write_bytes(png(np.ones((5, 7), bool)))
    assert main([str(tmp_path / "full.png"), "--levels", "4", "--quiet"]) == 0
    assert "note: no pixel is fully transparent" in capsys.readouterr().err


def test_help_names_every_option_and_status(capsys: pytest.CaptureFixture) -> None:
    with pytest.raises(SystemExit) as end:
        main(["--help"])
    assert end.value.code == 0
    text = capsys.readouterr().out
    options = "levels output clearance quiet tolerance element jobs padding threshold holes flip-y triangles"
    for option in options.split():
        assert re.search(rf"--{option}\b.*\s+\w", text), option
    assert all(f"\n  {status} " in text for status in (0, 1, 2, 130))


@pytest.mark.parametrize(
    ("options", "status", "sentence"),
    [
        (["letter.svg"], 2, "--levels"),
        (["letter.svg", "--levels", "0"], 2, "whole number of at least 1"),
        (["letter.svg", "--levels", "7.5"], 2, "whole number of at least 1"),
        (["letter.svg", "--levels", "24", "--clearance", "-1"], 2, "length above 0"),
        (["letter.svg", "--levels", "24", "--clearance", "inf"], 2, "length above 0"),
        (["letter.svg", "--levels", "24", "--threshold", "2"], 2, "from 0 to 1"),
        (["letter.svg", "--levels", "24", "--padding", "1", "--clearance", "1"], 2, "only one of them"),
        (["letter.txt", "--levels", "24"], 2, "a file is read if it ends in"),
        (["letter.svg", "--levels", "24", "-o", "out.pdf"], 2, "a file is written if it ends in"),
        (["letter.svg", "--levels", "24", "-o", "no/out.svg"], 2, "there is no folder"),
        (["none.svg", "--levels", "24"], 1, "none.svg: No such file"),
        (["letter.svg", "--levels", "5"], 1, "need at least 6"),
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

    monkeypatch.setattr("nestedcages_core.command.run.nested_cages", interrupted)
    assert main([str(drawing), "--levels", "24"]) == 130
    assert "interrupted" in capsys.readouterr().err


def test_a_terminal_gets_a_bar(drawing: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert main([str(drawing), "--levels", "24"]) == 0
    said = capsys.readouterr().err
    assert "\r[" in said
    assert "Level 1 of 1" in said
    assert said.endswith("\n")
