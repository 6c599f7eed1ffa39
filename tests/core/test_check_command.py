"""`nested-cages check` on files of every kind: exit 0 where all holds, 1 and a sentence where something does not."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from nestedcages_core import (
    animated_cages,
    features_from_geojson,
    frames_to_engine_json,
    from_svg,
    inner_cages,
    nested_cages,
    to_engine_json,
    to_geojson,
    to_svg,
)
from nestedcages_core.command import main
from shapes import letter_a, star
from test_command import png, region

CURVED = '<svg viewBox="0 0 9 9"><path d="M1 1 C 4 0 8 1 8 5 S 5 8 4 8 S 1 4 1 1"/><path d="M6 6h2v2h-2z"/></svg>'


def checked(capsys: pytest.CaptureFixture, *words: object) -> tuple[int, str]:
    """Exit status, and all that is printed."""
    capsys.readouterr()
    status = main(["check", *map(str, words)])
    said = capsys.readouterr()
    assert bool(said.out) == (status == 0)
    assert bool(said.err) == (status != 0)
    return status, said.out + said.err


def test_drawings_and_outlines(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    drawing, svg, outline = tmp_path / "in.svg", tmp_path / "out.svg", tmp_path / "out.json"
    drawing.write_text(CURVED)
    assert main([str(drawing), "--levels", "16", "8", "--grid", "0.01", "-o", str(svg), "-o", str(outline)]) == 0
    assert checked(capsys, drawing, svg, "--decimals", "2") == (0, "2 cages: everything holds.\n")
    assert checked(capsys, svg, outline)[0] == 0
    fine = from_svg(CURVED)
    for cage, options, fault in (
        (nested_cages(fine, [16]).cages[0], ["--grid", "0.01"], "not multiples of 0.01"),
        (nested_cages(fine, [16]).cages[0], ["--clearance", "0.1"], "the distance is"),
        (nested_cages(fine, [16]).cages[0], ["--distance", "0.001"], "farther than 0.001"),
        (nested_cages(fine, [16]).cages[0], ["--symmetry", "x"], "no image"),
        (fine.moved(fine.vertices * 0.9), [], "meets the fine mesh"),
    ):
        outline.write_text(to_engine_json(cage))
        status, said = checked(capsys, drawing, outline, *options)
        assert status == 1
        assert fault in said
    both = {"D": fine, "C": nested_cages(fine, [16]).cages[0], "I": inner_cages(fine, [16]).cages[0]}
    svg.write_text(to_svg(both, levels=[0, 1, -1]))
    assert checked(capsys, svg, svg) == (0, "2 cages: everything holds.\n")
    named = {f"{owner} {what}": both[key] for owner in "ab" for what, key in (("Fine", "D"), ("Cage 1", "C"))}
    svg.write_text(to_svg(named, levels=[0, 1, 0, 1]))
    assert checked(capsys, svg, svg) == (0, "2 cages: everything holds.\n")
    svg.write_text(to_svg({**both, "I": both["C"]}, levels=[0, 1, 1]))
    assert "has the level of another" in checked(capsys, svg, svg)[1]
    svg.write_text(to_svg({**both, "I": both["C"]}, levels=[0, 1, -1]))
    assert checked(capsys, svg, svg)[0] == 1
    svg.write_text(to_svg(both["C"]))
    assert "there is no cage" in checked(capsys, drawing, svg)[1]


def test_maps(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    drawing, result = tmp_path / "in.geojson", tmp_path / "out.geojson"
    drawing.write_text(json.dumps({"type": "FeatureCollection", "features": [region(0.0, "a"), region(5.0, None)]}))
    assert main([str(drawing), "--levels", "16", "8", "-o", str(result)]) == 0
    assert checked(capsys, drawing, result) == (0, "4 cages: everything holds.\n")
    features = list(features_from_geojson(result.read_text()))
    swapped = [features[k] for k in (0, 1, 3, 2)]
    result.write_text(to_geojson(swapped[:2]))
    assert "2 shapes" in checked(capsys, drawing, result)[1]
    result.write_text(to_geojson([features[k] for k in (2, 3, 0, 1)]))
    assert "shape 1: level 1: " in checked(capsys, drawing, result)[1]


@pytest.mark.slow
def test_pictures_and_motions(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    picture, result, frames = tmp_path / "in.png", tmp_path / "out.json", tmp_path / "frames.json"
    rows, columns = np.mgrid[:20, :24]
    picture.write_bytes(png(np.abs(np.hypot(rows - 9.5, columns - 11.5) - 6.0) < 2.0))
    assert main([str(picture), "--levels", "10", "-o", str(result)]) == 0
    assert checked(capsys, picture, result)[0] == 0

    fine, moves = star(5, 40), np.linspace(0.0, 0.4, 4)
    poses = [fine.vertices + np.array([x, 0.0]) for x in moves]
    moving = animated_cages(fine, poses, [12]).levels[0]
    frames.write_text(frames_to_engine_json([fine.moved(x) for x in moving.fine_steps]))
    result.write_text(frames_to_engine_json([moving.cage.moved(x) for x in moving.cage_steps]))
    assert checked(capsys, frames, result)[0] == 0
    far = np.stack([fine.vertices, fine.vertices * (-1.0, -1.0)])  # nested before and after, and turned inside out
    frames.write_text(frames_to_engine_json([fine.moved(x) for x in far]))
    result.write_text(frames_to_engine_json([fine.moved(1.2 * x) for x in far]))
    assert "between steps 0 and 1" in checked(capsys, frames, result)[1]
    result.write_text(frames_to_engine_json([nested_cages(fine, [count]).cages[0] for count in (20, 22)]))
    assert "numbers of vertices" in checked(capsys, frames, result)[1]


def test_what_cannot_be_read(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    good, bad = tmp_path / "good.svg", tmp_path / "bad.json"
    good.write_text(to_svg(letter_a()))
    for content in ("[", "[1]", "{}", '{"polygons": 3}', '{"features": [{"type": "Polygon"}]}'):
        bad.write_text(content)
        assert checked(capsys, good, bad)[0] == 1
    assert "No such file" in checked(capsys, good, tmp_path / "none.json")[1]
    with pytest.raises(SystemExit, match="2"):
        main(["check", str(good)])
