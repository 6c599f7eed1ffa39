"""Maps as they are published: what is repaired and named, against GEOS; exact coordinates; what belongs to a map."""

import json
import math
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import nestedcages_core as core
from nestedcages_core import Feature, Mesh, features_from_geojson, from_geojson, read_geojson, read_map, to_geojson
from support.command import run
from support.documents import closed, collection, feature, refusal, same, solid
from support.shapes import islands, polygon, ring

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
BOW_TIE = [[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]]


def moved(points: list[list[float]], x: float, y: float = 0.0) -> list[list[float]]:
    return [[a + x, b + y] for a, b in points]


def by_geos(polygons: Any) -> shapely.Geometry:
    shape = shapely.geometry.shape({"type": "MultiPolygon", "coordinates": polygons})
    return shapely.make_valid(shape, method="structure", keep_collapsed=False)


REPAIRED = {
    "a crossing": ([BOW_TIE], (0.5, 0.5)),
    "a slight crossing": ([[[0, 0], [4, 0], [4, 4], [3.999, 3.9], [4.001, 3.8], [0, 3.8], [0, 0]]], None),
    "a hole that touches": ([SQUARE, [[0, 0], [1, 2], [2, 1], [0, 0]]], (0, 0)),
    "a hole on an edge": ([SQUARE, [[2, 0], [3, 1], [1, 1], [2, 0]]], (2, 0)),
    "a ring that meets itself": ([[[0, 0], [4, 0], [4, 4], [2, 0], [0, 4], [0, 0]]], (2, 0)),
    "a spike": ([[[0, 0], [4, 0], [4, 4], [2, 4], [2, 9], [2, 4], [0, 4], [0, 0]]], (2, 9)),
    "half a spike": ([[[0, 0], [4, 0], [4, 4], [-3, 4], [0, 4], [0, 0]]], None),
    "a hole of zero area": ([SQUARE, [[5, 1], [6, 2], [7, 3], [5, 1]]], None),
    "a hole of one point": ([SQUARE, [[1, 1], [1, 1], [1, 1]]], None),
    "a hole that crosses": ([SQUARE, [[3, 1], [5, 1], [5, 2], [3, 2], [3, 1]]], (4, 1)),
    "a hole outside": ([SQUARE, moved(SQUARE, 9)], (9, 0)),
    "a hole in a hole": ([SQUARE, [[1, 1], [3, 1], [3, 3], [1, 1]], [[2, 1.5], [2.5, 1.5], [2.5, 2], [2, 1.5]]], None),
}


@pytest.mark.parametrize("name", REPAIRED)
def test_faults_are_united_as_geos_does_and_named_and_all_rings_are_held(name: str) -> None:
    rings, place = REPAIRED[name]
    text = collection(feature(rings, name="Isle"))
    with pytest.warns(UserWarning, match="Isle"):
        (found,) = features_from_geojson(text)
    with pytest.warns(UserWarning):
        whole = from_geojson(text)
    lines = [shapely.LineString(ring) for ring in rings]
    assert found.mesh.area == whole.area
    assert polygon(found.mesh).symmetric_difference(by_geos([rings])).area < 2e-4
    assert all(polygon(found.mesh).buffer(1e-9).covers(line) for line in lines)
    assert shapely.union_all([by_geos([rings]), *lines]).buffer(3e-5 * found.mesh.diagonal).covers(polygon(found.mesh))
    assert place is None or any(f"({place[0]}, {place[1]})" in repair for repair in found.repairs)


def test_repeated_points_change_nothing() -> None:
    rings = [[[0, 0], [4, 0], [4, 0], [4, 0], [4, 4], [0, 4], [0, 0], [0, 0]]]
    (found,) = read_map(collection(feature(rings))).features
    assert (found.mesh.vertices.tolist(), found.repairs) == (SQUARE[:-1], ())


def test_lines_and_points_left_out_are_reported() -> None:
    line, points = ({"type": kind, "coordinates": [[5, 5], [9, 9]]} for kind in ("LineString", "MultiPoint"))
    mixed = {"type": "GeometryCollection", "geometries": [points, {"type": "Polygon", "coordinates": [SQUARE]}]}
    text = collection(feature([moved(SQUARE, 9)]), *({"type": "Feature", "geometry": each} for each in (line, mixed)))
    with pytest.warns(UserWarning, match="1 LineString, 1 MultiPoint"):
        assert from_geojson(text).area == 32.0
    with pytest.warns(UserWarning, match="1 MultiPoint"):
        assert Mesh.of(mixed).area == 16.0


@pytest.mark.parametrize("size", [1e-285, 1e-300])
def test_shapes_too_small_for_a_repair_are_an_error(size: float) -> None:
    """GEOS leaves nothing of a rectangle with a hole that begins at its corner, or can't read a ring of few numbers."""
    slim = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.01], [0.0, 0.01]])
    for rings in (np.array([slim, 0.4 * slim]) * size, [size * (1.0 + 1e-15 * ring(40))]):
        refusal(from_geojson, collection(feature([each.tolist() for each in rings])))


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=0, max_size=9), min_size=1, max_size=4)
)
def test_any_rings_on_a_lattice_become_what_geos_makes_of_them(rings: list[list[tuple[int, int]]]) -> None:
    given_rings = [[*points, points[0]] for points in rings if points]
    found = read_map(collection(feature(*([points] for points in given_rings))))
    long_enough = [points for points in given_rings if len(set(points)) > 2]
    expected = by_geos([[points] for points in long_enough]).area if long_enough else 0.0
    if expected == 0.0:
        assert not found.features
    else:
        assert found.features[0].mesh.area == pytest.approx(expected, abs=1e-3)  # lines are thin strips


def test_every_fault_of_a_document_is_named_at_once() -> None:
    twice = feature([BOW_TIE], [moved(BOW_TIE, 9)], name="Twice")
    members = [twice, feature([SQUARE]), feature([["no", "points"]], name="Text"), 7, feature([moved(BOW_TIE, 0, 5)])]
    found = read_map(collection(*members))
    assert ["Twice" in each.name for each in found.features] == [True, False, False]
    assert [bool(each.repairs) for each in found.features] == [True, False, True]
    assert all(any(place in note for note in found.notes) for place in ("(0.5, 0.5)", "(9.5, 0.5)", "(0.5, 5.5)"))
    assert ["Text" in refused for refused in found.refused] == [True, False]
    with pytest.warns(UserWarning) as said:
        features = features_from_geojson(collection(*members))
    assert (len(features), len(said)) == (3, 1)


@pytest.mark.parametrize(
    "points",
    [[["0", "0"], [1, 0], [1, 1]], [[0, 0], {"x": 1}, [1, 1]], [[0, 0], [1e200, 0], [1, 1]], "SQUARE",
     [[0, 0], [1, 1], [2, 2], [0, 0]]],
)  # fmt: skip
def test_what_is_no_polygon_is_named_by_every_reader(points: Any, tmp_path: Path) -> None:
    text = collection(feature([points], name="Isle"))
    (tmp_path / "a.geojson").write_text(text)
    for read in (from_geojson, features_from_geojson, lambda _: read_geojson(tmp_path / "a.geojson")):
        error = refusal(read, text)
        assert (type(error), error.code) == (core.InvalidMeshError, "file.invalid") and "Isle" in str(error)
    for reader in (from_geojson, features_from_geojson):
        with pytest.warns(UserWarning, match="Isle"):  # the others are not lost
            found = reader(collection(feature([points], name="Isle"), feature([SQUARE])))
        assert (found if isinstance(found, Mesh) else found[0].mesh).area == 16.0


@pytest.mark.parametrize(
    "source",
    ["", "[1]", '{"type": 5}', '{"type": "FeatureCollection"}', '{"type": "FeatureCollection", "features": "all"}',
     '{"type": "Topology", "objects": {}}', '{"type": "Polygn", "coordinates": []}',
     '{"type": "Point", "coordinates": [0, 0]}', '{"type": "Polygon"}', '{"type": "Polygon", "coordinates": {"a": 1}}',
     '{"type": "GeometryCollection", "geometries": 3}', b"\xff\xfe\x00", "1" * 9999, "[" * 100_000, None, 5,
     Path("a.geojson")],
)  # fmt: skip
def test_what_is_no_map_is_an_error(source: Any) -> None:
    assert refusal(from_geojson, source).code == "file.invalid"


def test_valid_polygons_keep_every_bit() -> None:
    rng = np.random.default_rng(3)
    outer, hole = (ring(40) * size + rng.normal(0, 1e-3, (40, 2)) for size in (math.pi, 1.0))
    text = collection(feature([closed(outer), closed(hole)]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        (found,) = features_from_geojson(text)
        assert same(from_geojson(text), found.mesh)
    assert same(found.mesh, Mesh.from_loops([outer, hole]))
    assert found.repairs == ()


# The 180th meridian


@pytest.mark.parametrize(
    ("polygons", "bounds", "area"),
    [
        ([[[[177, -16], [-179, -16], [-179, -18], [177, -18], [177, -16]],
           [[179.5, -16.5], [-179.5, -16.5], [-179.5, -17], [179.5, -17], [179.5, -16.5]]]], (177, -18, 181, -16), 7.5),
        ([[[[-177, 1], [179, 1], [179, 3], [-177, 3], [-178, 2], [-177, 1]]]], (-181, 1, -177, 3), 7.0),
        # an island with points on both sides is no ring around the pole
        ([[[[178.7, 71], [180, 71.5], [-180, 71.5], [-178, 71.2], [-179.9, 70.9], [180, 70.9], [178.7, 71]]]],
         (178.7, 70.9, 182.0, 71.5), 1.005),
    ],
)  # fmt: skip
def test_polygons_across_the_meridian_are_shifted_and_it_is_said(
    polygons: list[Any], bounds: tuple[float, ...], area: float
) -> None:
    with pytest.warns(UserWarning, match="Fiji"):
        (found,) = features_from_geojson(collection(feature(*polygons, name="Fiji")))
    assert np.ravel(found.mesh.bounds) == pytest.approx(np.array(bounds))
    assert found.mesh.area == pytest.approx(area)
    far = feature(*polygons, [moved(SQUARE, 170 if bounds[0] > 0 else -174)])
    assert read_map(collection(far)).features[0].mesh.area == pytest.approx(area + 16.0)


def test_a_ring_around_a_pole_is_cut_along_the_meridian() -> None:
    coast = [[x, -70.0 + x % 7] for x in range(-179, 180, 2)]
    (found,) = read_map(collection(feature([[*coast, coast[0]]], name="Antarctica"))).features
    assert found.repairs
    assert np.ravel(found.mesh.bounds).tolist() == [-180.0, -90.0, 180.0, -64.0]
    assert found.mesh.area == pytest.approx(360.0 * 23.0, rel=1e-2)


@pytest.mark.parametrize(
    ("points", "crs"),
    [
        ([[-180, -90], [180, -90], [180, -60], [-180, -60], [-180, -90]], None),
        ([[-100, -50], [100, -50], [100, 50], [-100, 50], [-100, -50]], None),
        ([[-179, -89], [179, -89], [179, -60], [0, -61], [-179, -60], [-179, -89]], None),  # inside the first
        ([[-170, 0], [170, 0], [170, 200], [-170, 200], [-170, 0]], None),
        ([[-170, 0], [170, 0], [170, 20], [-170, 20], [-170, 0]], "EPSG:3857"),
    ],
)
def test_what_only_looks_like_a_crossing_stays(points: list[list[float]], crs: str | None) -> None:
    other = {"crs": {"type": "name", "properties": {"name": crs}}} if crs else {}
    found = read_map(collection(feature([points]), **other))
    assert found.notes == []
    assert found.features[0].mesh.vertices.tolist() == points[:-1]


# What belongs to a map


def test_geojson_agrees_with_shapely_and_the_standard() -> None:
    mesh = islands()
    document = json.loads(to_geojson(Feature(mesh, {"excess": 0.1}, id="a")))
    assert [*document] == ["type", "features"] and document["type"] == "FeatureCollection"
    (member,) = document["features"]
    assert (member["type"], member["id"], member["properties"]) == ("Feature", "a", {"excess": 0.1})
    shape = shapely.geometry.shape(member["geometry"])
    assert shape.is_valid and shape.equals(polygon(mesh))
    for part in shape.geoms:  # RFC 7946: outer rings counter-clockwise, holes clockwise, closed
        assert part.exterior.is_ccw and not any(hole.is_ccw for hole in part.interiors)
    for polygons in member["geometry"]["coordinates"]:
        assert all(each[0] == each[-1] for each in polygons)


def test_crs_ids_and_properties_are_kept(tmp_path: Path) -> None:
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::2056"}}
    member = feature([SQUARE], name="Bern", people=7, identity=4)
    found = read_map(collection(member, {"type": "Feature", "geometry": None}, crs=crs))
    assert (found.crs, found.without_polygons) == (crs, 1)
    core.write_geojson(tmp_path / "a.geojson", found)
    document = json.loads((tmp_path / "a.geojson").read_text())
    assert document["crs"] == crs
    assert document["features"][0]["id"] == 4
    assert document["features"][0]["properties"] == {"name": "Bern", "people": 7}
    assert "crs" not in json.loads(to_geojson(list(found.features)))
    levels = json.loads(to_geojson(core.nested_cages(found.features[0].mesh, [4])))["features"]
    assert shapely.geometry.shape(levels[-1]["geometry"]).contains(shapely.geometry.shape(levels[0]["geometry"]))


def test_properties_that_json_cannot_hold_are_found_on_reading() -> None:
    found = read_map(collection(feature([SQUARE], name="Bern", people=math.nan, height=5.0)))
    assert found.features[0].properties == {"name": "Bern", "people": None, "height": 5.0}
    assert "people" in found.notes[0] and "height" not in found.notes[0]
    (member,) = json.loads(to_geojson(Feature(Mesh.of(ring(4)), {"n": np.int64(3), "a": np.arange(2)})))["features"]
    assert member["properties"] == {"n": 3, "a": [0, 1]}
    for wrong in (Feature(Mesh.of(ring(4)), {"what": object()}), ["a"], Feature(Mesh.of(ring(4)), {"x": math.inf})):
        assert refusal(to_geojson, wrong).code == "file.invalid"


def test_objects_with_a_geo_interface_are_maps_too() -> None:
    class Reader:
        """As readers of shapefiles offer it: tuples, numbers of numpy, arrays."""

        __geo_interface__ = {
            "type": "FeatureCollection",
            "features": [
                {"type": "Feature", "properties": {"NAME": "A"}, "geometry": shapely.box(0, 0, 1, 1).__geo_interface__},
                {"type": "Feature", "properties": {"h": np.nan}, "geometry": shapely.Point(0, 0).buffer(1)},
                {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [np.array(SQUARE)]}},
                {
                    "type": "Feature",
                    "geometry": {"type": "Polygon", "coordinates": [[(0, 0), (np.float32(1), 0), (1, 1)]]},
                },
            ],
        }

    found = read_map(Reader())
    assert found.refused == ()
    assert [each.mesh.area for each in found.features] == pytest.approx([1.0, math.pi, 16.0, 0.5], rel=1e-2)
    assert "A" in found.features[0].name
    mixed = {"type": "GeometryCollection", "geometries": [shapely.Point(0, 0), shapely.box(0, 0, 1, 1)]}
    assert from_geojson(mixed).area == 1.0
    again = from_geojson(found.features[2])
    assert solid(again).equals(solid(found.features[2].mesh))


ODD = {"digits": 10**5000, "bytes": b"x", "set": set(), "nan": math.nan, "list": [], "dict": {}, "object": object()}


@pytest.mark.parametrize("odd", ODD.values(), ids=ODD)
def test_odd_values_of_python_do_not_stop_a_reader(odd: object) -> None:
    member = {**feature([SQUARE], name="x"), "properties": {"name": odd}, "id": odd}
    found = read_map({"type": "FeatureCollection", "features": [member, odd], "crs": odd})
    assert [each.mesh.area for each in found.features] == [16.0]
    assert len(found.refused) == 1
    assert read_map({"type": "FeatureCollection", "features": [feature([[odd, [1, 0], [1, 1]]])]}).refused


def test_names_are_short_and_on_one_line() -> None:
    found = read_map(collection(feature([BOW_TIE], name="long\n" * 99)))
    assert len(found.features[0].name) < 100 and found.features[0].name.startswith("feature 0 (long long ")
    assert "\n" not in found.notes[0]


# Files of map programs

ARCS = [[[2, 0], [0, 2]], [[2, 2], [-2, 0], [0, -2], [2, 0]], [[2, 2], [3, 0], [0, -2], [-3, 0]]]


@pytest.mark.parametrize("suffix", [".shp", ".gpkg", ".topojson", ".json"])
def test_files_of_map_programs_are_read(suffix: str, tmp_path: Path) -> None:
    pyogrio = pytest.importorskip("pyogrio")
    path, out = tmp_path / f"land{suffix}", tmp_path / "out.geojson"
    if suffix in (".shp", ".gpkg"):
        boxes = [shapely.box(0, 0, 2, 2), shapely.box(2, 0, 5, 2)]
        table = {"name": np.array(["west", "east"], dtype=object), "people": np.array([3, 4])}
        driver = {".shp": "ESRI Shapefile", ".gpkg": "GPKG"}[suffix]
        pyogrio.raw.write(
            path, shapely.to_wkb(boxes), list(table.values()), list(table), geometry_type="Polygon", driver=driver,
            crs="EPSG:4326",
        )  # fmt: skip
    else:
        west, east = (
            {"type": "Polygon", "arcs": [[0, arc]], "properties": {"name": name, "people": people}}
            for name, people, arc in (("west", 3, 1), ("east", 4, 2))
        )
        land = {"type": "GeometryCollection", "geometries": [west, east]}
        topology = {"type": "Topology", "arcs": ARCS, "transform": {"scale": [1, 1], "translate": [0, 0]}}
        path.write_text(json.dumps({**topology, "objects": {"land": land}}))
    assert read_geojson(path).area == pytest.approx(10.0)
    assert run(path, "--levels", 6, "-o", out, "--quiet").status == 0
    read = features_from_geojson(out.read_bytes())
    assert [(each.properties["name"], each.properties["people"]) for each in read] == [("west", 3), ("east", 4)]
    failed = run(path, "--levels", 6, "--layers", "sea", "-o", out, "--quiet")
    assert failed.status == 1 and "sea" in failed.err and "land" in failed.err


@pytest.mark.filterwarnings("ignore:Non closed ring:RuntimeWarning")
def test_damaged_files_of_map_programs_are_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pyogrio = pytest.importorskip("pyogrio")
    path, box = tmp_path / "land.shp", shapely.to_wkb([shapely.box(0, 0, 2, 2)])
    pyogrio.raw.write(
        path, box, [np.arange(1)], ["id"], geometry_type="Polygon", driver="ESRI Shapefile", crs="EPSG:4326"
    )
    content = bytearray(path.read_bytes())
    content[156:164] = np.float64(9.0).tobytes()  # the first point, but not the last
    path.write_bytes(content)
    (tmp_path / "land.gpkg").write_bytes(b"")
    for name in ("land.shp", "land.gpkg"):
        error = refusal(read_geojson, tmp_path / name)
        assert error.code == "file.invalid" and name in str(error)
    monkeypatch.setitem(sys.modules, "pyogrio", None)
    error = refusal(read_geojson, tmp_path / "land.gpkg")
    assert (error.code, error.data["library"]) == ("dependency.missing", "pyogrio")


def test_polygons_that_share_arcs_count_their_points(tmp_path: Path) -> None:
    pytest.importorskip("pyogrio")
    lands = {"type": "GeometryCollection", "geometries": [{"type": "Polygon", "arcs": [[0]]}] * 20}
    path = tmp_path / "land.topojson"
    path.write_text(json.dumps({"type": "Topology", "arcs": [[*ring(50).tolist(), [1, 0]]], "objects": {"a": lands}}))
    command = [path, "--levels", 6, "--quiet", "--limit"]
    assert run(*command, "points=1100").status == 0
    failed = run(*command, "points=999")
    assert failed.status == 1 and "999" in failed.err
