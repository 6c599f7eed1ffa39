"""Whatever shapely holds for a valid geometry is a shape, and each repair is named; vertices with edges."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
import shapely
from shapely.geometry import GeometryCollection, MultiPolygon, Polygon, box

import nestedcages_core.exchange.repair as repairing
from nestedcages_core import InvalidMeshError, Mesh, from_geojson, nested_cages, verify, verify_motion
from nestedcages_core.errors import NestedCagesError, NestedCagesWarning
from support.shapes import ring

SQUARE = [(0, 0), (6, 0), (6, 6), (0, 6)]
VALID = {
    "parts that touch in a corner": (MultiPolygon([box(0, 0, 1, 1), box(1, 1, 2, 2)]), "parts that touch are joined"),
    "a hole at its shell": (Polygon(SQUARE, [[(0, 2), (2, 1), (2, 3)]]), "parts that touch are joined"),
    "holes that touch": (Polygon(SQUARE, [box(1, 1, 2, 2).exterior, box(2, 2, 3, 3).exterior]), "are joined"),
    "a repeated point": (Polygon([(0, 0), (1, 0), (1, 0), (1, 1)]), "1 repeated point, the first at (1, 0): left out"),
    "one in a hole": (Polygon(SQUARE, [[(1, 1), (2, 1), (2, 1), (2, 2)]]), "1 repeated point"),
    "faces with an edge in common": (GeometryCollection([box(0, 0, 1, 1), box(1, 0, 2, 1)]), "repaired"),
    "faces that overlap": (GeometryCollection([box(0, 0, 1, 1), box(0.5, 0.5, 2, 2)]), "repaired"),
    "a face in another": (GeometryCollection([box(0, 0, 5, 5), box(1, 1, 2, 2)]), "nested shells"),
    "a line beside a face": (
        GeometryCollection([box(0, 0, 1, 1), shapely.LineString([(1, 1), (2, 2)])]),
        "a LineString, which has no inside: left out",
    ),
}


@pytest.mark.parametrize("name", VALID)
def test_valid_geometries_are_shapes(name: str) -> None:
    geometry, note = VALID[name]
    assert geometry.is_valid
    with pytest.warns(NestedCagesWarning, match="The geometry was repaired: ") as said:
        mesh = Mesh.of(geometry)
    assert note in str(said[0].message)
    assert said[0].filename == __file__
    whole = shapely.union_all(shapely.get_parts(geometry))
    assert mesh.area == pytest.approx(whole.area, rel=1e-10)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert Mesh.of(geometry.__geo_interface__) == mesh == from_geojson(geometry)
        (level,) = nested_cages(geometry, 12)
    assert shapely.area(shapely.difference(whole, shapely.geometry.shape(level.cage))) == 0.0
    assert verify(level.cage, mesh)


def test_exact_geometries_stay_as_they_are() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = Mesh.of(MultiPolygon([box(0, 0, 1, 1), box(2, 0, 3, 1)]))
    assert mesh == Mesh.from_geometry(MultiPolygon([box(0, 0, 1, 1), box(2, 0, 3, 1)]))


def test_a_ring_that_touches_itself_is_read_and_one_that_crosses_itself_is_not() -> None:
    touching = Polygon([(0, 0), (2, 1), (4, 0), (4, 4), (2, 1), (0, 4)])
    with pytest.warns(NestedCagesWarning, match=r"ring self-intersection at \(2, 1\): repaired"):
        assert Mesh.of(touching).area == pytest.approx(touching.area, rel=1e-9)
    for wrong, fault in (
        (Polygon([(0, 0), (2, 2), (2, 0), (0, 2)]), "Loop 0 crosses itself near"),
        (Polygon(box(0, 0, 1, 1).exterior, [box(3, 0, 4, 1).exterior]), "A hole of polygon 0 near"),
        (Polygon([(0, 0), (1, 1), (2, 2)]), "Loop 0 turns back"),
        (GeometryCollection([shapely.Point(0, 0)]), "The geometry is empty"),
    ):
        with pytest.raises(InvalidMeshError, match=fault):
            Mesh.of(wrong)


@pytest.mark.parametrize("name", ["parts that touch in a corner", "a repeated point"])
def test_meshes_and_judges_stay_strict(name: str) -> None:
    geometry, _ = VALID[name]
    with pytest.raises(InvalidMeshError):
        Mesh.from_geometry(geometry)
    with pytest.raises(InvalidMeshError):
        Mesh.of(geometry, strict=True)
    around = nested_cages(ring(9, 5.0, centre=(1.0, 1.0)), 5)[0].cage
    assert not verify(geometry, Mesh.from_loops([ring(5, 0.1, centre=(0.8, 0.4))]))
    with pytest.warns(NestedCagesWarning):
        assert verify(around, geometry, same_loops=False)
    with pytest.raises(InvalidMeshError):
        verify_motion(around, geometry, [around.vertices], np.zeros((1, 8, 2)))


def test_without_shapely_repeated_points_are_left_out_and_the_rest_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(purpose: str) -> Any:
        raise NestedCagesError(f"{purpose} needs shapely.", code="dependency.missing", library="shapely")

    monkeypatch.setattr(repairing, "load_shapely", missing)
    with pytest.warns(NestedCagesWarning, match="1 repeated point"):
        assert len(Mesh.of(VALID["a repeated point"][0]).vertices) == 3
    with pytest.raises(NestedCagesError, match="Reading polygons that touch or cross needs shapely"):
        Mesh.of(VALID["a hole at its shell"][0])


def test_vertices_and_edges_are_no_two_loops() -> None:
    vertices, edges = ring(12, 1.0), np.stack((np.arange(12), np.roll(np.arange(12), -1)), axis=1)
    mesh = Mesh(vertices, edges)
    for pair in ((vertices, edges), [vertices, edges[::-1]], (vertices.tolist(), edges.astype(np.int32))):
        assert Mesh.of(pair).has_loops_like(mesh)
        assert Mesh.of(pair).area == mesh.area
    assert nested_cages((vertices, edges), 6)[0].fine == mesh
    with pytest.raises(InvalidMeshError, match="The loop is open at vertex"):
        Mesh.of((vertices, edges[:-1]))
    hole = np.array([(1, 1), (2, 1), (2, 2)])
    assert len(Mesh.of((np.array(SQUARE, float), hole)).loops) == 2
