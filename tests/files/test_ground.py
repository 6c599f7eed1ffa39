"""Clearances in metres around polygons in degrees, judged by points in space on WGS84."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from nestedcages_core import Mesh, features_from_geojson
from support.command import run
from support.documents import closed, collection, feature
from support.marks import slow_after

ISLET = [[-1.3, 60.0], [-1.2, 60.02], [-1.15, 60.1], [-1.22, 60.2], [-1.33, 60.12]]
UNIT = {"m": 1.0, "km": 1000.0, "mi": 1609.344}


def in_space(mesh: Mesh, spacing: float) -> Any:
    """(n, 3) places in metres of points on the edges, which are straight in degrees, at most about so far apart."""
    found = []
    for start, end in zip(mesh.vertices, mesh.edge_ends, strict=True):
        count = int(np.hypot(*(end - start)) * 111_700.0 / spacing) + 2
        found.append(start + np.linspace(0.0, 1.0, count)[:, None] * (end - start))
    longitude, latitude = np.radians(np.concatenate(found)).T
    flattening = 1.0 / 298.257223563
    normal = 6_378_137.0 / np.sqrt(1.0 - flattening * (2.0 - flattening) * np.sin(latitude) ** 2)
    around = normal * np.cos(latitude)
    height = (1.0 - flattening) ** 2 * normal * np.sin(latitude)
    return np.stack((around * np.cos(longitude), around * np.sin(longitude), height), axis=1)


def least_distance(one: Mesh, other: Mesh, metres: float) -> float:
    """Straight through the earth, which is shorter than on the ground by less than 1e-5 of 100 km."""
    return float(cKDTree(in_space(other, metres / 200)).query(in_space(one, metres / 20))[0].min())


def caged(rings: Any, clearance: str, folder: Path, *options: object) -> tuple[int, list[Mesh], str]:
    """Exit status, cages, and messages."""
    (folder / "map.geojson").write_text(collection(feature(*[[closed(np.array(ring))] for ring in rings])))
    command = ["map.geojson", "--clearance", clearance, "--quiet", "-o", "out.geojson", *options]
    done = run(*command, cwd=folder)
    made = features_from_geojson((folder / "out.geojson").read_bytes()) if done.status == 0 else []
    return done.status, [each.mesh for each in made], done.err


def island(rng: np.random.Generator, at: tuple[float, float], size: float) -> Any:
    """A star-shaped polygon (k, 2) about a place, about as wide as high on the ground."""
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, 24))
    radius = size * rng.uniform(0.3, 1.0, 24)
    wide = radius / np.cos(np.radians(at[1]))
    return np.stack((at[0] + wide * np.cos(angle), at[1] + radius * np.sin(angle)), axis=1)


@pytest.mark.parametrize(
    ("count", "clearance"), [(8, "5km"), (60, "5000m"), *slow_after(0, [(3, "1mi"), (20, "90km")])]
)
def test_an_islet_at_sixty_degrees(count: int, clearance: str, tmp_path: Path) -> None:
    metres = float(clearance.rstrip("kmi")) * UNIT[clearance.lstrip("0123456789")]
    status, (cage,), _ = caged([ISLET], clearance, tmp_path, "--levels", count, "--report", "r.json")
    away = least_distance(cage, Mesh.of(ISLET), metres)
    assert status == 0 and away >= metres
    assert count < 60 or away < 1.01 * metres
    (level,) = json.loads((tmp_path / "r.json").read_text())["inputs"][0]["shapes"][0]["levels"]
    assert level["clearance"] == metres and level["excess"] == pytest.approx(cage.area / Mesh.of(ISLET).area - 1.0)
    assert run("check", "map.geojson", "out.geojson", cwd=tmp_path).status == 0
    if metres < 6000.0:  # the clearance alone exceeds the least of these tolerances
        for level, right in (("+400%", 0), ("+5%", 1), ("0.1u", 1)):
            assert caged([ISLET], clearance, tmp_path, "--levels", level)[0] == right
        assert run("check", "map.geojson", "out.geojson", "--levels", "+400%", cwd=tmp_path).status == 0


@pytest.mark.parametrize("number", slow_after(6, range(40), thorough_after=24))
def test_islands_anywhere(number: int, tmp_path: Path) -> None:
    """At all latitudes, across the 180th meridian in either way of writing it, several parts, around and inside."""
    rng = np.random.default_rng(number)
    at = (float(rng.choice([rng.uniform(-180, 180), 179.9, -179.95])), float(rng.uniform(-84, 84)))
    size, inside = float(10.0 ** rng.uniform(-2, 0.5)), number % 5 == 4
    rings = [island(rng, at, size)]
    if number % 3 == 1 and not inside:
        rings.append(island(rng, (at[0] + 2.2 * size / np.cos(np.radians(at[1])), at[1]), size))
    metres = 111_000.0 * size * (0.05 if inside else float(10.0 ** rng.uniform(-1.5, 0.3)))
    given = [np.where(ring > [180.0, 99.0], ring - [360.0, 0.0], ring) if number % 2 else ring for ring in rings]
    options = ["--levels", 8 if number % 4 else "40%", *(["--inside"] if inside else [])]
    status, cages, said = caged(given, f"{metres}m", tmp_path, *options)
    if status:
        assert at[1] + size + metres / 111_000.0 > 88.0 or inside, said
        return
    assert min(least_distance(cage, Mesh.of(ring), metres) for cage in cages for ring in rings) >= metres


def test_where_metres_have_no_place_a_sentence_says_so(tmp_path: Path) -> None:
    pole = [[0, 89.97], [9, 89.98], [4, 89.99]]
    polar = caged([pole], "5km", tmp_path, "--levels", 4)
    around = [[*([x, 0] for x in range(-179, 180, 2)), *([x, 1] for x in range(179, -180, -2))]]
    belt = caged(around, "300km", tmp_path, "--levels", 4)
    plane = caged([[[0, 0], [5000, 0], [0, 5000]]], "5km", tmp_path, "--levels", 4)
    assert polar[0] == belt[0] == plane[0] == 1
    assert all("error: " in said for *_, said in (polar, belt, plane))
    assert "error: " in run("-", "--levels", 3, "--clearance", "5km", stdin="<svg/>").err


def test_a_projected_map_takes_metres_as_its_units(tmp_path: Path) -> None:
    square = [[[0, 0], [5000, 0], [5000, 5000], [0, 5000], [0, 0]]]
    for system, unit, status in (("EPSG::32633", "5km", 0), ("EPSG::3857", "5000", 0), ("US survey foot", "5km", 1)):
        crs = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:{system}"}}
        (tmp_path / "map.geojson").write_text(collection(feature(square), crs=crs))
        command = ["map.geojson", "--levels", 8, "--clearance", unit, "-o", "out.geojson", "--quiet"]
        assert run(*command, cwd=tmp_path).status == status
        if status == 0:
            cage = features_from_geojson((tmp_path / "out.geojson").read_bytes())[0].mesh
            assert (cage.bounds[0], cage.bounds[2]) <= (-5000.0, 10_100.0)
