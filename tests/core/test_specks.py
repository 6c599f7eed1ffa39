"""What is not seen is no loop: specks of files, and faint pixels."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from nestedcages_core import Mesh, collision_outline, nested_cages
from nestedcages_core.command import main
from nestedcages_core.exchange import features_from_geojson, from_geojson, read_svg_drawing, to_geojson
from nestedcages_core.exchange.pictures import encode_png
from nestedcages_core.exchange.specks import without_specks
from nestedcages_core.geometry.mesh import MeshLike
from support.shapes import ring


def speckled() -> list[np.ndarray]:
    """A disc with a speck beside it, and a hole and a hair too small to be seen, among others that are seen."""
    hair = np.array([[1.3, 0.0], [1.3 + 1e-3, 0.0], [1.3 + 1e-3, 1e-4], [1.3, 1e-4]])
    seen = [ring(40), 0.2 * ring(12), ring(8, 0.05) + np.array([1.4, 0.3])]
    return [*seen, ring(6, 2e-4) + np.array([1.2, 0.2]), ring(6, 2e-4) + 0.5, hair]


def test_loops_below_an_area_go_with_what_is_in_them() -> None:
    rings = [ring(40), 0.5 * ring(30), 0.2 * ring(20), 0.1 * ring(10)]
    mesh, said = without_specks(Mesh.from_loops(rings), 0.5)
    assert len(mesh.loops) == 2 and said == ["smaller than 0.5 in area: 1 part left out, 1 hole filled"]
    alone, said = without_specks(Mesh.from_loops(rings), 1e9)
    assert len(alone.loops) == 1 and np.array_equal(alone.vertices, rings[0])
    whole = Mesh.from_loops(rings)
    assert without_specks(whole, 0.0)[0] is whole


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.1, 2.0, 3.7])
def test_what_is_smaller_than_a_pixel_costs_no_vertices(angle: float, tmp_path: Path) -> None:
    turn = 100.0 * np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    outlines = [loop @ turn + 200.0 for loop in speckled()]
    path = " ".join("M" + " L".join(f"{x:.9f} {y:.9f}" for x, y in loop) + "Z" for loop in outlines)
    (tmp_path / "a.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="400" height="400"><path fill-rule="evenodd" d="{path}"/></svg>'
    )
    found = read_svg_drawing(tmp_path / "a.svg")
    assert len(found.mesh.loops) == 3
    assert any("in area: 2 parts left out, 1 hole filled" in note for note in found.notes)
    level = nested_cages(found.mesh, 40)[0]
    assert len(level.cage.vertices) <= 40 and not any(note.code == "note.loops" for note in level.report.notes)


def test_maps_lose_what_is_smaller_than_a_tenth_of_the_tolerance_both_ways() -> None:
    given: MeshLike = Mesh.from_loops(speckled())
    text = json.loads(to_geojson([given]))
    assert len(from_geojson(text).loops) == 6
    with pytest.warns(UserWarning, match="in area: 1 part left out"):
        (feature,) = features_from_geojson(text, tolerance=0.005)
    assert len(feature.mesh.loops) == 3


@pytest.mark.slow
def test_pixels_count_from_half_opacity(tmp_path: Path) -> None:
    y, x = np.indices((64, 64))
    alpha = np.clip(1.2 - np.hypot(x - 32, y - 32) / 24.0, 0.0, 1.0)  # fades over its whole radius
    faint = np.where((x + y) % 9 == 0, 0.02, 0.0)
    picture = np.maximum(alpha, faint)
    half, all_ = (collision_outline(picture, 16, **how).area for how in ({}, {"threshold": 0.0}))
    assert half < 0.5 * all_
    pixels = np.zeros((64, 64, 4), np.uint8)
    pixels[:, :, 3] = np.round(255.0 * picture)
    (tmp_path / "a.png").write_bytes(encode_png(pixels))
    out = tmp_path / "out.json"
    assert main([str(tmp_path / "a.png"), "--levels", "16", "--quiet", "-o", str(out)]) == 0
    assert main(["check", str(tmp_path / "a.png"), str(out)]) == 0
    assert main(["check", str(tmp_path / "a.png"), str(out), "--threshold", "0"]) == 1
