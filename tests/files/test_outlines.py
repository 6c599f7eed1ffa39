"""Collision outlines and frames as our own JSON: as engines expect them, read back to the last bit."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Mesh, frames_to_engine_json, from_engine_json, is_engine_json, to_engine_json, to_geojson
from support.documents import refusal, same
from support.shapes import annulus, islands, polygon

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4]]


def outline(**changed: object) -> str:
    """A collision outline, some members of it changed."""
    sound = {"format": "nested-cages outline", "version": 1, "polygons": [{"outer": SQUARE, "holes": []}]}
    return json.dumps({**sound, **changed})


def test_outlines_turn_as_engines_expect() -> None:
    mesh = annulus(6)
    for flip in (None, 100.0):
        document = json.loads(to_engine_json(mesh, flip_y=flip, triangles=True))
        (part,) = document["polygons"]
        assert shapely.LinearRing(part["outer"]).is_ccw
        assert not shapely.LinearRing(part["holes"][0]).is_ccw
        corners = np.array(document["points"])[document["triangles"]]
        assert all(shapely.LinearRing(each).is_ccw for each in corners)
        union = shapely.union_all([shapely.Polygon(each) for each in corners])
        assert union.symmetric_difference(shapely.Polygon(part["outer"], part["holes"])).area < 1e-12
        assert sum(shapely.Polygon(each).area for each in corners) == pytest.approx(mesh.area)
        again = from_engine_json(json.dumps(document), flip_y=flip)
        assert polygon(again).symmetric_difference(polygon(mesh)).area < 1e-12
    flipped = np.array(json.loads(to_engine_json(mesh, flip_y=8.0))["polygons"][0]["outer"])
    assert sorted(flipped[:, 1].tolist()) == pytest.approx(sorted((8.0 - mesh.vertices[mesh.loops[0], 1]).tolist()))
    assert json.loads(to_engine_json(Mesh.of([(0, 0.1), (1, 0.3), (0, 0.7)]), flip_y=1.0))["polygons"][0]["outer"][0][
        1
    ] in (0.9, 0.7, 0.3)  # in decimals


@pytest.mark.parametrize("flip", [None, 100.0])
def test_convex_pieces_are_written(flip: float | None) -> None:
    mesh = islands()
    document = json.loads(to_engine_json(mesh, flip_y=flip, triangles=True, pieces=5))
    written = [np.array(document["points"])[piece] for piece in document["pieces"]]
    assert all(shapely.LinearRing(each).is_ccw and 3 <= len(each) <= 5 for each in written)
    wanted = core.convex_pieces(mesh, 5)
    assert len(written) == len(wanted) < len(document["triangles"])
    for found, piece in zip(written, wanted, strict=True):
        turned = piece if flip is None else np.stack([piece[:, 0], flip - piece[:, 1]], axis=1)[::-1]
        np.testing.assert_allclose(found, turned, atol=0 if flip is None else 1e-12)


def test_frames_have_times_and_outlines() -> None:
    frames = [annulus(6), annulus(6, 0.6)]
    document = json.loads(frames_to_engine_json(frames, [0.0, 0.5]))
    assert (document["format"], [each["time"] for each in document["frames"]]) == ("nested-cages frames", [0.0, 0.5])
    for mesh, each in zip(frames, document["frames"], strict=True):
        assert same(from_engine_json(outline(polygons=each["polygons"])), mesh)
    assert [each["time"] for each in json.loads(frames_to_engine_json(frames))["frames"]] == [0.0, 1.0]
    for meshes, times in (([], None), (frames, [0.0]), (frames, [0.0, math.nan])):
        refusal(frames_to_engine_json, meshes, times)


def test_outlines_are_told_from_other_json() -> None:
    text = to_engine_json(annulus(6))
    assert is_engine_json(text) and is_engine_json(text.encode())
    others = ("", "[1]", to_geojson(annulus(6)), '{"name": "nested-cages outline"}', text[:-1])
    assert not any(map(is_engine_json, others))


@pytest.mark.parametrize(
    "text",
    ["", "{}", "[" * 100_000, '{"polygons": [{"outer": [1, 2], "holes": []}]}', outline(polygons=3),
     outline(version=999), outline(version=True), outline(version="1"), outline(format="spine"), outline(polygons=[5]),
     outline(polygons=[{"outer": []}, {"holes": []}]), outline(polygons=[{"outer": [1, 2], "holes": []}]),
     outline(polygons=[{"outer": [[0, 0], ["1", 0], [1, 1]]}]),
     outline(polygons=[{"outer": SQUARE, "holes": [[[5, 5], [6, 5], [6, 6]]]}]),
     outline(polygons=[{"outer": SQUARE, "holes": [SQUARE]}]), outline(polygons=[]),
     None, 5, ["a"], {"format": "nested-cages outline"}, Path("a.json")],
)  # fmt: skip
def test_what_is_no_outline_is_an_error(text: Any) -> None:
    refusal(from_engine_json, text)
