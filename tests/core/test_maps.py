"""Maps as they are published: what is repaired and how it is said, against GEOS; what is no map gets a sentence."""

from __future__ import annotations

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

from nestedcages_core import InvalidMeshError, Mesh, NestedCagesError, nested_cages
from nestedcages_core.command import main
from nestedcages_core.errors import NestedCagesWarning
from nestedcages_core.exchange import (
    Feature,
    Map,
    features_from_geojson,
    from_geojson,
    from_svg,
    read_geojson,
    read_map,
    to_geojson,
    to_svg,
    write_geojson,
)
from nestedcages_core.exchange.gis_files import map_document
from nestedcages_core.exchange.limits import Limits
from support.shapes import polygon, ring

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
SLIM = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.01], [0.0, 0.01]])
BOW_TIE = [[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]]


def moved(points: list[list[float]], x: float, y: float = 0.0) -> list[list[float]]:
    return [[a + x, b + y] for a, b in points]


def feature(*polygons: Any, name: str | None = None, **properties: Any) -> dict[str, Any]:
    known = {"name": name, **properties} if name else properties
    geometry = {"type": "MultiPolygon", "coordinates": polygons}
    return {"type": "Feature", "properties": known, "geometry": geometry}


def collection(*members: Any, **other: Any) -> str:
    return json.dumps({"type": "FeatureCollection", **other, "features": members})


def by_geos(polygons: Any) -> shapely.Geometry:
    shape = shapely.geometry.shape({"type": "MultiPolygon", "coordinates": polygons})
    return shapely.make_valid(shape, method="structure", keep_collapsed=False)


REPAIRED = {
    "repeated points": (
        [[[0, 0], [4, 0], [4, 0], [4, 0], [4, 4], [0, 4], [0, 0], [0, 0]]],
        r"3 repeated points.*\(4, 0\)",
    ),
    "a spike": ([[[0, 0], [4, 0], [4, 4], [2, 4], [2, 9], [2, 4], [0, 4], [0, 0]]], r"1 spike, the first to \(2, 9\)"),
    "half a spike": ([[[0, 0], [4, 0], [4, 4], [-3, 4], [0, 4], [0, 0]]], r"1 spike, the first to \(-3, 4\)"),
    "a hole of zero area": ([SQUARE, [[1, 1], [2, 2], [3, 3], [1, 1]]], r"a hole of zero area at \(1, 1\)"),
    "a hole of one point": ([SQUARE, [[1, 1], [1, 1], [1, 1]]], r"a hole of zero area at \(1, 1\)"),
    "a hole back and forth": ([SQUARE, [[1, 1], [2, 1], [1, 1], [2, 1], [1, 1]]], "a hole of zero area"),
    "a crossing": ([BOW_TIE], r"self-intersection at \(0.5, 0.5\)"),
    "a slight crossing": (
        [[[0, 0], [4, 0], [4, 4], [3.999, 3.9], [4.001, 3.8], [0, 3.8], [0, 0]]],
        "self-intersection",
    ),
    "a hole that crosses": ([SQUARE, [[3, 1], [5, 1], [5, 2], [3, 2], [3, 1]]], "self-intersection|hole"),
    "a hole outside": ([SQUARE, moved(SQUARE, 9)], r"hole lies outside shell at \(9, 0\)"),
    "a hole in a hole": (
        [SQUARE, [[1, 1], [3, 1], [3, 3], [1, 1]], [[2, 1.5], [2.5, 1.5], [2.5, 2], [2, 1.5]]],
        "nested",
    ),
    "a hole that touches": ([SQUARE, [[0, 0], [1, 2], [2, 1], [0, 0]]], r"touch are joined.*\(0, 0\)"),
    "a hole on an edge": ([SQUARE, [[2, 0], [3, 1], [1, 1], [2, 0]]], r"touch are joined.*\(2, 0\)"),
    "a ring that meets itself": (
        [[[0, 0], [4, 0], [4, 4], [2, 0], [0, 4], [0, 0]]],
        r"ring self-intersection at \(2, 0\)",
    ),
}


@pytest.mark.parametrize("name", REPAIRED)
def test_faults_are_repaired_as_geos_does_and_named(name: str) -> None:
    rings, sentence = REPAIRED[name]
    text = collection(feature(rings, name="Isle"))
    with pytest.warns(NestedCagesWarning, match=rf"feature 0 \(Isle\): .*{sentence}"):
        (found,) = features_from_geojson(text)
    with pytest.warns(NestedCagesWarning, match=sentence):
        whole = from_geojson(text)
    expected = by_geos([rings])
    assert found.mesh.area == whole.area == pytest.approx(expected.area, rel=1e-6)
    assert polygon(found.mesh).symmetric_difference(expected).area < 1e-6 * expected.area
    assert len([repair for repair in found.repairs if not repair.startswith("narrower")]) == 1
    given = {tuple(map(float, point)) for each in rings for point in each}
    assert {tuple(point) for point in found.mesh.vertices.tolist()} & given


@pytest.mark.parametrize("size", [1e-285, 1e-300])
def test_shapes_too_small_for_a_repair_get_a_sentence(size: float) -> None:
    """GEOS leaves nothing of a rectangle with a hole that begins at its corner, or can't read a ring of few numbers."""
    for rings in (np.array([SLIM, 0.4 * SLIM]) * size, [size * (1.0 + 1e-15 * ring(40))]):
        with pytest.raises(NestedCagesError, match=r"no inside|cannot be repaired|encloses an area"):
            from_geojson(collection(feature([each.tolist() for each in rings])))


def test_polygons_that_touch_overlap_or_lie_in_each_other() -> None:
    for second, sentence in (
        (moved(SQUARE, 4, 4), "touch"),
        (moved(SQUARE, 4), "self-intersection"),
        (moved(SQUARE, 3, 3), "self-intersection"),
        ([[1, 1], [2, 1], [2, 2], [1, 1]], "nested shells"),
        (SQUARE, "duplicate|self-intersection|nested"),
    ):
        with pytest.warns(NestedCagesWarning, match=sentence):
            (found,) = features_from_geojson(collection(feature([SQUARE], [second])))
        assert found.mesh.area == pytest.approx(by_geos([[SQUARE], [second]]).area, rel=1e-6)


def test_every_fault_of_a_document_is_named_at_once() -> None:
    twice = feature([BOW_TIE], [moved(BOW_TIE, 9)], name="Twice")
    members = [twice, feature([SQUARE]), feature([["no", "points"]], name="Text"), 7, feature([moved(BOW_TIE, 0, 5)])]
    found = read_map(collection(*members))
    assert [each.name for each in found.features] == ["feature 0 (Twice)", "feature 1", "feature 4"]
    assert [len(each.repairs) for each in found.features] == [2, 0, 1]
    assert "(0.5, 0.5)" in found.notes[0]
    assert "(9.5, 0.5)" in found.notes[1]
    assert "(0.5, 5.5)" in found.notes[2]
    assert found.refused == (
        "feature 2 (Text): Point 0 of ring 0 of polygon 0 is 'no', not two numbers.",
        "feature 3: It is 7, not an object with a type.",
    )
    with pytest.warns(NestedCagesWarning) as said:
        features = features_from_geojson(collection(*members))
    assert len(features) == 3
    assert len(str(said[0].message).splitlines()) == 5


BAD = {
    "strings": ([["0", "0"], [1, 0], [1, 1]], r"Point 0 of ring 0 of polygon 0 is \['0', '0'\], not two numbers"),
    "an object": ([[0, 0], {"x": 1}, [1, 1]], r"Point 1 of .* is \{'x': 1\}, not two numbers"),
    "a large number": ([[0, 0], [1e200, 0], [1, 1]], r"Point 1 of .* is \(1e\+200, 0\)"),
    "a text": ("SQUARE", "Ring 0 of polygon 0 is 'SQUARE', not a list"),
    "no area": ([[0, 0], [1, 1], [2, 2], [0, 0]], "No polygon encloses an area"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_polygon_is_said_with_its_place_by_every_reader(name: str, tmp_path: Path) -> None:
    points, sentence = BAD[name]
    text = collection(feature([points], name="Isle"))
    (tmp_path / "a.geojson").write_text(text)
    for read in (from_geojson, features_from_geojson, lambda _: read_geojson(tmp_path / "a.geojson")):
        with pytest.raises(InvalidMeshError, match=rf"Feature 0 \(Isle\): {sentence}"):
            read(text)
    for read in (from_geojson, features_from_geojson):
        with pytest.warns(NestedCagesWarning, match=sentence):  # the others are not lost
            read(collection(feature([points]), feature([SQUARE])))


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("", "not GeoJSON"),
        ("[1]", "not an object with a type"),
        ('{"type": 5}', "not an object with a type"),
        ('{"type": "FeatureCollection"}', "has None where its list"),
        ('{"type": "FeatureCollection", "features": "all"}', "has 'all' where its list"),
        ('{"type": "Topology", "objects": {}}', "TopoJSON; give its file"),
        ('{"type": "Polygn", "coordinates": []}', "type 'Polygn' has no inside"),
        ('{"type": "Point", "coordinates": [0, 0]}', "no polygons"),
        ('{"type": "Polygon"}', "Polygon 0 is None, not a list"),
        ('{"type": "Polygon", "coordinates": {"a": 1}}', "not a list"),
        ('{"type": "GeometryCollection", "geometries": 3}', "list of geometries is 3"),
        (b"\xff\xfe\x00", "not GeoJSON"),
        ("1" * 9999, "not GeoJSON: a whole number in it has thousands of digits"),
        (None, "from text or bytes, not from NoneType"),
        (5, "from text or bytes, not from int"),
        (Path("a.geojson"), "from text or bytes, not from"),
    ],
)
def test_what_is_no_map_gets_a_sentence(source: Any, sentence: str) -> None:
    with pytest.raises(NestedCagesError, match=sentence):
        from_geojson(source)


@pytest.mark.parametrize("width", [1e-15, 1e-9, 3e-5])
def test_hairlines_are_closed_with_their_number(width: float) -> None:
    slit = [[1.0, 2.0], [3.0, 2.0], [3.0, 2.0 + width], [1.0, 2.0 + width], [1.0, 2.0]]
    spike = [[0, 0], [4, 0], [4, 1], [7, 1], [7, 1 + width], [4, 1 + width], [4, 4], [0, 4], [0, 0]]
    with pytest.warns(NestedCagesWarning, match=r"narrower than .*: 1 gap closed, 1 spike cut off"):
        (found,) = features_from_geojson(collection(feature([spike, slit])), tolerance=1e-3)
    assert len(found.mesh.loops) == 1
    assert found.mesh.area == pytest.approx(16.0, abs=1e-6)
    assert nested_cages(found.mesh, [5]).levels[0].report.strict


def test_what_was_written_is_read_as_it_was_however_narrow() -> None:
    spiky = Mesh.from_loops([[(0, 0), (4, 0), (4, 1), (7, 1), (7, 1 + 1e-7), (4, 1 + 1e-7), (4, 4), (0, 4)]])
    assert from_geojson(to_geojson(spiky)) == spiky
    assert from_svg(to_svg(spiky)) == spiky
    (cleaned,) = read_map(to_geojson(spiky), clean=True).features
    assert len(cleaned.mesh.vertices) == 6
    assert "1 spike cut off" in cleaned.repairs[0]


def test_valid_polygons_keep_every_bit() -> None:
    rng = np.random.default_rng(3)
    outer, hole = (ring(40) * size + rng.normal(0, 1e-3, (40, 2)) for size in (math.pi, 1.0))
    text = collection(feature([[*outer.tolist(), outer[0].tolist()], [*hole.tolist(), hole[0].tolist()]]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        (found,) = features_from_geojson(text)
        assert (from_geojson(text).vertices == found.mesh.vertices).all()
    assert (found.mesh.vertices == np.concatenate((outer, hole))).all()
    assert found.repairs == ()


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=0, max_size=9), min_size=1, max_size=4)
)
def test_any_rings_on_a_lattice_become_what_geos_makes_of_them(rings: list[list[tuple[int, int]]]) -> None:
    closed = [[*points, points[0]] for points in rings if points]
    found = read_map(collection(feature(*([points] for points in closed))))
    long_enough = [points for points in closed if len(set(points)) > 2]
    expected = by_geos([[points] for points in long_enough]).area if long_enough else 0.0
    if expected == 0.0:
        assert not found.features
    else:
        assert found.features[0].mesh.area == pytest.approx(expected, rel=1e-6)


# The 180th meridian


def test_polygons_across_the_meridian_are_shifted_and_it_is_said() -> None:
    fiji = [[177, -16], [-179, -16], [-179, -18], [177, -18], [177, -16]]
    lake = [[179.5, -16.5], [-179.5, -16.5], [-179.5, -17], [179.5, -17], [179.5, -16.5]]
    with pytest.warns(NestedCagesWarning, match=r"\(Fiji\): a polygon crosses the 180th meridian at \(177, -16\)"):
        (found,) = features_from_geojson(collection(feature([fiji, lake], [moved(SQUARE, 170)], name="Fiji")))
    assert found.mesh.area == pytest.approx(8.0 - 0.5 + 16.0)
    assert found.mesh.vertices[:, 0].max() == 181.0
    west = [[-177, 1], [179, 1], [179, 3], [-177, 3], [-178, 2], [-177, 1]]
    (found,) = read_map(collection(feature([west]))).features
    assert found.mesh.vertices[:, 0].min() == -181.0


def test_an_island_with_points_on_both_sides_of_the_meridian_is_no_ring_around_the_pole() -> None:
    wrangel = [[178.7, 71], [180, 71.5], [-180, 71.5], [-178, 71.2], [-179.9, 70.9], [180, 70.9], [178.7, 71]]
    (found,) = read_map(collection(feature([wrangel]))).features
    assert "crosses the 180th meridian" in found.repairs[0]
    assert np.ptp(found.mesh.vertices[:, 0]) == pytest.approx(3.3)
    assert found.mesh.area < 3.3


def test_a_ring_around_a_pole_is_cut_along_the_meridian() -> None:
    coast = [[x, -70.0 + x % 7] for x in range(-179, 180, 2)]
    (found,) = read_map(collection(feature([[*coast, coast[0]]], name="Antarctica"))).features
    assert found.repairs[0].startswith("a polygon runs around a pole")
    low, high = found.mesh.vertices.min(axis=0), found.mesh.vertices.max(axis=0)
    assert (*low, *high) == (-180.0, -90.0, 180.0, -64.0)
    assert found.mesh.area == pytest.approx(360.0 * 23.0, rel=1e-2)


@pytest.mark.parametrize(
    ("points", "crs"),
    [
        ([[-180, -90], [180, -90], [180, -60], [-180, -60], [-180, -90]], None),
        ([[-100, -50], [100, -50], [100, 50], [-100, 50], [-100, -50]], None),
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


def test_crs_ids_and_properties_are_kept(tmp_path: Path) -> None:
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::2056"}}
    member = {**feature([SQUARE], name="Bern", people=7), "id": 4}
    found = read_map(collection(member, {"type": "Feature", "geometry": None}, crs=crs))
    assert (found.crs, found.without_polygons) == (crs, 1)
    write_geojson(tmp_path / "a.geojson", found)
    document = json.loads((tmp_path / "a.geojson").read_text())
    assert document["crs"] == crs
    assert document["features"][0]["id"] == 4
    assert document["features"][0]["properties"] == {"name": "Bern", "people": 7}
    assert "crs" not in json.loads(to_geojson(Map(found.features)))


def test_properties_that_json_cannot_hold_are_found_on_reading() -> None:
    found = read_map(collection(feature([SQUARE], name="Bern", people=math.nan, height=5.0)))
    assert found.features[0].properties == {"name": "Bern", "people": None, "height": 5.0}
    assert "not finite: 'people'; set to null" in found.notes[0]
    assert json.loads(to_geojson(found))
    assert json.loads(to_geojson(Feature(found.features[0].mesh, {"n": np.int64(3), "a": np.arange(2)})))
    with pytest.raises(NestedCagesError, match="cannot be written"):
        to_geojson(Feature(found.features[0].mesh, {"what": object()}))
    with pytest.raises(NestedCagesError, match="from meshes and features"):
        to_geojson(["a"])


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
    assert found.features[0].name == "feature 0 (A)"
    mixed = {"type": "GeometryCollection", "geometries": [shapely.Point(0, 0), shapely.box(0, 0, 1, 1)]}
    assert from_geojson(mixed).area == 1.0
    assert isinstance(from_geojson(shapely.box(0, 0, 2, 2)), Mesh)


ODD = {"digits": 10**5000, "bytes": b"x", "set": set(), "nan": math.nan, "list": [], "dict": {}, "object": object()}


@pytest.mark.parametrize("odd", ODD.values(), ids=ODD)
def test_odd_values_of_python_do_not_stop_a_reader(odd: object) -> None:
    member = {**feature([SQUARE], name=odd), "id": odd}
    found = read_map({"type": "FeatureCollection", "features": [member, odd], "crs": odd})
    assert [each.mesh.area for each in found.features] == [16.0]
    assert len(found.refused) == 1
    assert read_map({"type": "FeatureCollection", "features": [feature([[odd, [1, 0], [1, 1]]])]}).refused


def test_names_are_short_and_on_one_line() -> None:
    found = read_map(collection(feature([BOW_TIE], name="long\n" * 99)))
    assert len(found.features[0].name) < 100
    assert "\n" not in found.notes[0]


@pytest.mark.parametrize("suffix", [".shp", ".gpkg", ".topojson", ".json"])
def test_files_of_map_programs_are_read(suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    pyogrio = pytest.importorskip("pyogrio")
    path, out = tmp_path / f"land{suffix}", tmp_path / "out.geojson"
    if suffix in (".shp", ".gpkg"):
        squares = [shapely.box(0, 0, 2, 2), shapely.box(2, 0, 5, 2)]
        table = {"name": np.array(["west", "east"], dtype=object), "people": np.array([3, 4])}
        driver = {".shp": "ESRI Shapefile", ".gpkg": "GPKG"}[suffix]
        pyogrio.raw.write(
            path, shapely.to_wkb(squares), list(table.values()), list(table), geometry_type="Polygon", driver=driver,
            crs="EPSG:4326",
        )  # fmt: skip
    else:
        arcs = [[[2, 0], [0, 2]], [[2, 2], [-2, 0], [0, -2], [2, 0]], [[2, 2], [3, 0], [0, -2], [-3, 0]]]
        west, east = (
            {"type": "Polygon", "arcs": [[0, arc]], "properties": {"name": name, "people": people}}
            for name, people, arc in (("west", 3, 1), ("east", 4, 2))
        )
        land = {"type": "GeometryCollection", "geometries": [west, east]}
        topology = {"type": "Topology", "arcs": arcs, "transform": {"scale": [1, 1], "translate": [0, 0]}}
        path.write_text(json.dumps({**topology, "objects": {"land": land}}))
    assert read_geojson(path).area == pytest.approx(10.0)
    assert main([str(path), "--levels", "6", "--borders", "-o", str(out), "--quiet"]) == 0
    read = features_from_geojson(out.read_bytes())
    assert [(each.properties["name"], each.properties["people"]) for each in read] == [("west", 3), ("east", 4)]
    assert main([str(path), "--levels", "6", "--layers", "sea", "-o", str(out), "--quiet"]) == 1
    assert f"land{suffix} has no layer 'sea'; its layers: land" in capsys.readouterr().err


@pytest.mark.filterwarnings("ignore:Non closed ring:RuntimeWarning")
def test_a_shapefile_with_an_open_ring_gets_a_sentence(tmp_path: Path) -> None:
    pyogrio = pytest.importorskip("pyogrio")
    path, squares = tmp_path / "land.shp", shapely.to_wkb([shapely.box(0, 0, 2, 2)])
    pyogrio.raw.write(
        path, squares, [np.arange(1)], ["id"], geometry_type="Polygon", driver="ESRI Shapefile", crs="EPSG:4326"
    )
    content = bytearray(path.read_bytes())
    content[156:164] = np.float64(9.0).tobytes()  # the first point, but not the last
    path.write_bytes(content)
    with pytest.raises(NestedCagesError, match=r"land\.shp cannot be read by GDAL: .*closed"):
        read_geojson(path)


def test_polygons_that_share_arcs_count_their_points(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyogrio")
    lands = {"type": "GeometryCollection", "geometries": [{"type": "Polygon", "arcs": [[0]]}] * 20}
    path = tmp_path / "land.topojson"
    path.write_text(json.dumps({"type": "Topology", "arcs": [[*ring(50).tolist(), [1, 0]]], "objects": {"a": lands}}))
    monkeypatch.setattr(shapely.geometry, "mapping", pytest.fail)  # what takes the memory
    with pytest.raises(NestedCagesError, match="more than the 999 allowed"):
        map_document(path, Limits(points=999))


def test_without_pyogrio_one_sentence_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "land.gpkg").write_bytes(b"")
    monkeypatch.setitem(sys.modules, "pyogrio", None)
    with pytest.raises(NestedCagesError, match=r"Reading land\.gpkg needs pyogrio; install it with"):
        read_geojson(tmp_path / "land.gpkg")
    monkeypatch.undo()
    pytest.importorskip("pyogrio")
    with pytest.raises(NestedCagesError, match=r"land\.gpkg cannot be read by GDAL"):
        read_geojson(tmp_path / "land.gpkg")
