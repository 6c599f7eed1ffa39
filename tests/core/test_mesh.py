"""The mesh: what comes in stays as it is, what is derived from it is right, and bad input gets its sentence."""

from __future__ import annotations

import copy
import dataclasses
import itertools
import math
import pickle
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.geometry
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core.errors import InvalidMeshError
from nestedcages_core.geometry.mesh import Mesh
from support.shapes import jagged, ring

polygon_of = shapely.geometry.shape

SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])


def target() -> list[np.ndarray]:
    """Outer loop, hole, island, hole in the island, and a second component; directions at random."""
    return [
        ring(9, 0.5)[::-1],
        ring(12, 2.0),
        ring(5, 0.2),
        ring(17, 4.0)[::-1],
        ring(4, 1.0, centre=(9.0, 0.0)),
    ]


# What comes in


def test_vertices_and_edges_keep_their_order_and_values() -> None:
    vertices = np.array([[4.0, 4.0], [0.1, -0.0], [4.0, 0.0], [0.0, 4.0]])
    edges = np.array([[3, 0], [1, 2], [0, 2], [1, 3]])
    mesh = Mesh(vertices, edges)
    assert mesh.vertices.tobytes() == vertices.tobytes()
    assert mesh.edges.tolist() == [[0, 3], [1, 2], [2, 0], [3, 1]]
    assert mesh.successor.tolist() == [3, 2, 0, 1]
    assert mesh.predecessor.tolist() == [2, 3, 1, 0]


def test_input_is_neither_changed_nor_shared() -> None:
    vertices, edges = SQUARE[::-1].copy(), np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    before = vertices.copy(), edges.copy()
    mesh = Mesh(vertices, edges)
    assert np.array_equal(vertices, before[0])
    assert np.array_equal(edges, before[1])
    moved = mesh.moved(vertices)
    vertices[0], edges[0] = 99.0, 2
    assert mesh.vertices.max() == moved.vertices.max() == 4.0
    assert not np.shares_memory(mesh.edges, edges)


def test_nothing_of_a_mesh_can_be_written_to() -> None:
    mesh = Mesh.from_loops(target())
    for own in (mesh, mesh.moved(mesh.vertices), pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh)):
        arrays = [own.vertices, own.edges, own.successor, own.predecessor, own.loop_of_vertex, own.edge_lengths]
        for array in (*arrays, own.loop_signs, own.component_of_loop, own.loop_areas, *own.loops):
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 0
    with pytest.raises(dataclasses.FrozenInstanceError):
        mesh.vertices = SQUARE  # type: ignore[misc]


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int16, np.uint8, object, ">f8"])
def test_numbers_of_any_type_are_taken(dtype: Any) -> None:
    mesh = Mesh(SQUARE.astype(dtype), np.array([[0, 1], [1, 2], [2, 3], [3, 0]], dtype=np.uint16))
    assert mesh.vertices.dtype == np.float64
    assert mesh.vertices.dtype.isnative
    assert mesh.edges.dtype == np.int64
    assert mesh.area == Mesh(SQUARE.tolist(), [[0.0, 1.0], [1.0, 2.0], [2.0, 3.0], [3.0, 0.0]]).area == 16.0


def test_fractions_and_strided_arrays_are_taken() -> None:
    points = [(Fraction(1, 4), 0), (Fraction(5, 2), Fraction(1, 8)), (1, 3)]
    assert Mesh.from_loops([points]).vertices[1].tolist() == [2.5, 0.125]
    wide = np.zeros((8, 4))
    wide[::2, ::2] = SQUARE
    assert Mesh.from_loops([wide[::2, ::2]]).vertices.flags.c_contiguous


# Loops


def test_loops_are_oriented_by_nesting_depth() -> None:
    mesh = Mesh.from_loops(target())
    assert mesh.loop_signs.tolist() == [1, -1, -1, 1, 1]
    assert mesh.component_of_loop.tolist() == [0, 1, 0, 1, 2]
    assert np.array_equal(mesh.vertices, np.concatenate(target()))
    for sign, loop in zip(mesh.loop_signs, mesh.loops, strict=True):
        assert shapely.LinearRing(mesh.vertices[loop]).is_ccw == (sign > 0)
    sizes = [9, 12, 5, 17, 4]
    assert [len(loop) for loop in mesh.loops] == sizes
    assert [loop[0] for loop in mesh.loops] == [0, 9, 21, 26, 43]
    assert mesh.loop_of_vertex.tolist() == np.repeat(np.arange(5), sizes).tolist()


@pytest.mark.parametrize("seed", range(8))
def test_any_numbering_and_direction_of_the_edges_gives_the_same_solid(seed: int) -> None:
    random = np.random.default_rng(seed)
    ordered = Mesh.from_loops(target())
    number = random.permutation(len(ordered.vertices))
    vertices = np.empty_like(ordered.vertices)
    vertices[number] = ordered.vertices
    edges = number[ordered.edges][random.permutation(len(number))]
    turned = random.random(len(edges)) < 0.5
    edges[turned] = edges[turned, ::-1]
    mesh = Mesh(vertices, edges)
    assert np.array_equal(mesh.successor[number], number[ordered.successor])
    assert np.array_equal(np.sort(mesh.edges, axis=1), np.sort(edges, axis=1))
    assert [loop[0] for loop in mesh.loops] == sorted(loop.min() for loop in mesh.loops)
    loop_map = mesh.loop_of_vertex[number[[loop[0] for loop in ordered.loops]]]
    assert np.array_equal(mesh.loop_signs[loop_map], ordered.loop_signs)
    outers = np.flatnonzero(mesh.loop_signs > 0)
    assert mesh.component_of_loop[outers].tolist() == list(range(len(outers)))
    for k, m in itertools.combinations(range(5), 2):
        same = ordered.component_of_loop[k] == ordered.component_of_loop[m]
        assert (mesh.component_of_loop[loop_map[k]] == mesh.component_of_loop[loop_map[m]]) == same
    assert mesh.area == pytest.approx(ordered.area, rel=1e-14)


def test_many_small_loops() -> None:
    frame = ring(4, 1e4)
    islands = [ring(3, 0.2, centre=(k % 50 - 25.0, k // 50 - 25.0)) for k in range(2500)]
    mesh = Mesh.from_loops([*islands[:1000], frame, *islands[1000:]])
    assert mesh.loop_signs.tolist() == [-1] * 1000 + [1] + [-1] * 1500
    assert not mesh.component_of_loop.any()


def test_deep_nesting() -> None:
    mesh = Mesh.from_loops([ring(5, 1.0 + k) for k in range(60)])
    assert mesh.loop_signs.tolist() == [-1, 1] * 30
    assert mesh.component_of_loop.tolist() == [k // 2 for k in range(60)]


def test_a_repeated_closing_point_is_dropped() -> None:
    mesh = Mesh.from_loops([np.concatenate((SQUARE, SQUARE[:1])), ring(5, 0.5, centre=(2.0, 2.0))])
    assert len(mesh.vertices) == 9
    assert mesh.loop_signs.tolist() == [1, -1]


# Measures


def test_measures_against_shapely() -> None:
    mesh = Mesh.from_loops(target())
    polygon = polygon_of(mesh)
    assert mesh.area == pytest.approx(polygon.area, rel=1e-14)
    assert mesh.edge_lengths.sum() == pytest.approx(polygon.length, rel=1e-14)
    x0, y0, x1, y1 = polygon.bounds
    assert mesh.diagonal == pytest.approx(math.hypot(x1 - x0, y1 - y0), rel=1e-15)
    for area, loop in zip(mesh.loop_areas, mesh.loops, strict=True):
        assert abs(area) == pytest.approx(shapely.Polygon(mesh.vertices[loop]).area, rel=1e-14)
    v = 13
    assert mesh.edge_lengths[v] == math.dist(mesh.vertices[v], mesh.vertices[mesh.successor[v]])


def exact_area(points: np.ndarray) -> Fraction:
    corners = [(Fraction(x), Fraction(y)) for x, y in points.tolist()]
    products = (a * d - b * c for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1], strict=True))
    return sum(products, Fraction(0)) / 2


@pytest.mark.parametrize("offset", [0.0, 0.1, 1e6 + 0.1])
def test_area_of_slivers_is_right(offset: float) -> None:
    low, high = np.array([offset, offset]), np.array([offset + 1.0, offset + 1.0])
    middle = np.nextafter(0.5 * (low + high), [np.inf, -np.inf])
    sliver = np.stack((low, middle, high))
    mesh = Mesh.from_loops([sliver])
    assert mesh.area == pytest.approx(float(abs(exact_area(sliver))), rel=1e-12)
    assert mesh.area > 0.0


def test_area_of_a_thin_ring_is_right() -> None:
    outer = ring(64, 1.0)
    inner = outer * (1.0 - 1e-15)
    mesh = Mesh.from_loops([outer, inner])
    assert mesh.area == pytest.approx(float(exact_area(outer) - exact_area(inner)), rel=1e-9)


# Moved meshes


def test_moved_keeps_edges_and_roles() -> None:
    mesh = Mesh.from_loops(target())
    turned = mesh.moved(-2.0 * mesh.vertices[:, ::-1])
    assert turned.edges is mesh.edges
    assert turned.loops is mesh.loops
    assert turned.loop_signs is mesh.loop_signs
    assert turned.component_of_loop is mesh.component_of_loop
    assert np.array_equal(turned.loop_of_vertex, mesh.loop_of_vertex)
    assert turned.area == pytest.approx(-4.0 * mesh.area)  # a reflection
    assert turned.diagonal == pytest.approx(2.0 * mesh.diagonal)
    assert turned.edge_lengths == pytest.approx(2.0 * mesh.edge_lengths)
    assert not turned.is_validated


def test_moved_does_not_judge_but_validated_does() -> None:
    mesh = Mesh.from_loops([SQUARE])
    crossed = mesh.moved(SQUARE[[0, 2, 1, 3]])
    with pytest.raises(InvalidMeshError, match="crosses itself"):
        crossed.validated()
    assert mesh.validated() is mesh
    assert mesh.moved(SQUARE + 1.0).validated().is_validated
    with pytest.raises(InvalidMeshError, match=r"shape \(3, 2\)"):
        mesh.moved(SQUARE[:3])


def test_copies_are_meshes() -> None:
    mesh = Mesh.from_loops(target())
    for other in (pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh)):
        assert other.is_validated
        assert np.array_equal(other.vertices, mesh.vertices)
        assert np.array_equal(other.edges, mesh.edges)
        assert np.array_equal(other.moved(other.vertices).loops[1], mesh.loops[1])
        assert other.area == mesh.area
    assert repr(mesh) == "Mesh(47 vertices, 5 loops)"


# Geometries of other programs


def test_geometry_round_trip() -> None:
    mesh = Mesh.from_loops(target())
    polygons = polygon_of(mesh)
    assert polygons.is_valid
    assert [len(polygon.interiors) for polygon in polygons.geoms] == [1, 1, 0]
    again = Mesh.from_geometry(polygons)
    assert polygon_of(again).equals_exact(polygons, 0.0)
    assert Mesh.from_geometry(again).area == again.area
    assert sorted(again.vertices.tolist()) == sorted(mesh.vertices.tolist())


def test_one_component_is_a_polygon() -> None:
    geometry = Mesh.from_loops([SQUARE, ring(7, 1.0, centre=(2.0, 2.0))]).__geo_interface__
    assert geometry["type"] == "Polygon"
    outer, hole = geometry["coordinates"]
    assert outer == ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0))
    assert len(hole) == 8
    assert not shapely.LinearRing(hole).is_ccw


class Carrier:
    """Anything with the attribute."""

    def __init__(self, geometry: Any) -> None:
        self.__geo_interface__ = geometry


def test_every_kind_of_geometry_is_read() -> None:
    square = shapely.Polygon(SQUARE, [ring(5, 1.0, centre=(2.0, 2.0))])
    other = shapely.Polygon(ring(6, 1.0, centre=(9.0, 9.0)))
    empty = shapely.Polygon()
    mapping = shapely.geometry.mapping
    feature = {"type": "Feature", "geometry": mapping(square), "properties": {"name": "square"}}
    nothing = {"type": "Feature", "geometry": None, "properties": {}}
    both = square.area + other.area
    cases = [
        (square, square.area),
        (mapping(square), square.area),
        (shapely.MultiPolygon([square, other]), both),
        (shapely.GeometryCollection([square, empty, shapely.MultiPolygon([other])]), both),
        (Carrier(feature), square.area),
        (Carrier({"type": "FeatureCollection", "features": [feature, nothing, Carrier(mapping(other))]}), both),
        (shapely.Polygon([(x, y, 7.0) for x, y in SQUARE]), 16.0),
        (
            {
                "type": "Polygon",
                "coordinates": iter([[(Decimal(x), Fraction(y)) for x, y in np.array(SQUARE).tolist()]]),
            },
            16.0,
        ),
    ]
    for geometry, area in cases:
        assert Mesh.from_geometry(geometry).area == pytest.approx(area, rel=1e-14)


@pytest.mark.parametrize(
    ("geometry", "sentence"),
    [
        (shapely.LineString([(0, 0), (1, 1)]), "A geometry of type 'LineString' has no inside"),
        (shapely.Polygon(), "The geometry is empty"),
        (shapely.MultiPolygon(), "The geometry is empty"),
        (7, "The geometry is 7, not an object with a type; give an object with __geo_interface__"),
        (None, "The geometry is None, not an object with a type"),
        ({}, "A geometry of type None has no inside"),
        ({"type": "Polygon"}, "Polygon 0 is None, not a list."),
        ({"type": "Polygon", "coordinates": [[1, 2, 3]]}, "Point 0 of ring 0 of polygon 0 is 1, not two numbers."),
        (
            {"type": "Polygon", "coordinates": [[(0, 0), (1, 0), (1,)]]},
            "Point 2 of ring 0 of polygon 0 is (1,), not two numbers.",
        ),
        ({"type": "Polygon", "coordinates": np.array(5)}, "Polygon 0 is array(5), not a list."),
        ({"type": "Polygon", "coordinates": "rings"}, "Polygon 0 is 'rings', not a list."),
        (
            {"type": "Polygon", "coordinates": [[(True, 0)]]},
            "Point 0 of ring 0 of polygon 0 is (True, 0), not two numbers.",
        ),
        ({"type": "Polygon", "coordinates": [[(10**400, 0)]]}, "Point 0 of ring 0 of polygon 0 is out of range"),
        (
            {"type": "Polygon", "coordinates": [[(0, np.nan)]]},
            "Point 0 of ring 0 of polygon 0 is (0, nan); finite numbers",
        ),
        ({"type": "MultiPolygon"}, "The list of polygons is None, not a list."),
        ({"type": "FeatureCollection", "features": 3}, "The list of features is 3, not a list."),
        (
            shapely.GeometryCollection([shapely.Polygon(ring(5, 9.0)), shapely.Polygon(ring(5, 1.0))]),
            "Polygon 1 near (1, 0) lies inside another polygon",
        ),
        (
            shapely.GeometryCollection([shapely.Polygon(ring(5, 1.0), [ring(5, 1.0, centre=(5.0, 0.0))])]),
            "A hole of polygon 0 near (1, 0) is not directly inside it",
        ),
        (shapely.Polygon([(0, 0), (2, 2), (2, 0), (0, 2)]), "Loop 0 crosses itself near (1, 1)"),
    ],
)
def test_geometries_that_are_refused(geometry: Any, sentence: str) -> None:
    with pytest.raises(InvalidMeshError) as caught:
        Mesh.from_geometry(geometry)
    assert str(caught.value).startswith(sentence)


def test_a_collection_that_contains_itself_is_refused() -> None:
    loop: dict[str, Any] = {"type": "GeometryCollection"}
    loop["geometries"] = [loop]
    with pytest.raises(InvalidMeshError, match="collections within collections, more than 64 deep"):
        Mesh.from_geometry(loop)


# Validity against shapely


def is_valid_ring(points: np.ndarray) -> bool:
    """Simple, not flat, no point twice in a row: shapely, and the one thing that it lets pass."""
    return bool((points != np.roll(points, -1, axis=0)).any(axis=1).all()) and shapely.Polygon(points).is_valid


def is_accepted(loops: list[np.ndarray]) -> bool:
    try:
        Mesh.from_loops(loops)
    except InvalidMeshError:
        return False
    return True


@pytest.mark.slow
@pytest.mark.parametrize("corners", [3, 4, 5, 6, 7])
def test_loops_on_a_grid_are_accepted_if_and_only_if_they_are_simple(corners: int) -> None:
    random = np.random.default_rng(corners)
    accepted = 0
    for _ in range(500):
        points = random.integers(0, 5, size=(corners, 2)).astype(float)
        if (points[0] == points[-1]).all():
            continue
        assert is_accepted([points]) == is_valid_ring(points), points.tolist()
        accepted += is_valid_ring(points)
    assert accepted > 5


@pytest.mark.slow
def test_two_loops_on_a_grid_are_accepted_if_and_only_if_they_stay_apart() -> None:
    random = np.random.default_rng(2)
    verdicts = []
    for _ in range(800):
        loops = [random.integers(0, 7, size=(3, 2)).astype(float) for _ in range(2)]
        if not all(is_valid_ring(loop) for loop in loops):
            continue
        expected = shapely.LinearRing(loops[0]).disjoint(shapely.LinearRing(loops[1]))
        assert is_accepted(loops) == expected
        verdicts.append(expected)
        if expected:
            first, second = (shapely.Polygon(loop) for loop in loops)
            signs = [-1 if second.contains(first) else 1, -1 if first.contains(second) else 1]
            assert Mesh.from_loops(loops).loop_signs.tolist() == signs
    assert 50 < sum(verdicts) < len(verdicts) - 50


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1), st.sampled_from([3, 5, 30, 400]), st.integers(-130, 130), st.floats(0, 7))
@settings(max_examples=60, deadline=None)
def test_stars_are_accepted_at_every_scale(seed: int, count: int, exponent: int, turn: float) -> None:
    points = jagged(np.random.default_rng(seed), count)
    rotation = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    points = points @ rotation * 10.0**exponent
    expected = shapely.Polygon(points / 10.0**exponent)
    if not expected.is_valid:
        return
    mesh = Mesh.from_loops([points])
    assert mesh.loop_signs.tolist() == [1]
    assert mesh.area == pytest.approx(expected.area * 10.0 ** (2 * exponent), rel=1e-9)


@pytest.mark.parametrize("gap", [1, 2, 1000])
def test_walls_a_few_doubles_apart_are_told_from_walls_that_touch(gap: int) -> None:
    low, right = 0.1, 0.7
    for _ in range(gap):
        right = float(np.nextafter(right, 1.0))
    left = np.array([[low, 0.0], [0.7, 0.0], [0.7, 1.0], [low, 1.0]])
    other = np.array([[right, -0.5], [1.5, -0.5], [1.5, 1.5], [right, 1.5]])
    assert Mesh.from_loops([left, other]).loop_signs.tolist() == [1, 1]
    other[[0, 3], 0] = 0.7
    with pytest.raises(InvalidMeshError, match=r"lies on edge (4-7|7-4)"):
        Mesh.from_loops([left, other])


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["star", "slanted comb", "spiral", "straight", "crossing"])
def test_crowded_shapes_are_no_trouble(shape: str) -> None:
    random = np.random.default_rng(4)
    count = 20_000
    if shape == "star":
        loop = jagged(random, count)
    elif shape == "slanted comb":
        x = np.arange(count) / count
        comb = np.stack((x, np.where(np.arange(count) % 2, 1.0, 0.1)), axis=1)
        loop = np.concatenate((comb, [[1.1, 0.0], [-0.1, 0.0]])) @ np.array([[0.8, 0.6], [-0.6, 0.8]])
    elif shape == "spiral":
        angle = np.linspace(0, 200 * np.pi, count // 2)[:, None]
        arm = np.concatenate((np.cos(angle), np.sin(angle)), axis=1) * (1.0 + angle)
        loop = np.concatenate((arm, 1.001 * arm[::-1]))
    elif shape == "straight":
        corners = np.array([[0.1, 0.3], [1.3, 0.7], [0.9, 1.9]])
        side = np.linspace(0, 1, count // 3, endpoint=False)[:, None]
        loop = np.concatenate([a + side * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)])
    else:
        with pytest.raises(InvalidMeshError, match="crosses itself"):
            Mesh.from_loops([random.uniform(size=(count, 2))])
        return
    assert Mesh.from_loops([loop]).area == pytest.approx(shapely.Polygon(loop).area, rel=1e-11)


def test_the_extent_stays_when_a_mesh_is_turned_and_moved() -> None:
    angle = 0.8
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    assert Mesh.from_loops([square]).extent == pytest.approx(2.4 * np.sqrt(2.0))
    assert Mesh.from_loops([square @ turn + 5.0]).extent == pytest.approx(2.4 * np.sqrt(2.0))
