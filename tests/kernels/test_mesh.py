"""The mesh: what comes in stays as it is, what is derived is that of shapely and fractions, bad input is refused."""

import copy
import dataclasses
import itertools
import math
import pickle
import warnings
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.geometry
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import GeometryCollection, MultiPolygon, Polygon, box

from nestedcages_core import InvalidMeshError, Mesh, from_geojson, nested_cages, verify, verify_motion
from nestedcages_core.errors import NestedCagesWarning
from nestedcages_core.geometry.mesh import Nesting
from support.judging import rejected
from support.marks import slow_after
from support.shapes import jagged, polygon, ring

polygon_of = shapely.geometry.shape

SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])


def target() -> list[np.ndarray]:
    """Outer loop, hole, island, hole in the island, and a second component; directions at random."""
    return [ring(9, 0.5)[::-1], ring(12, 2.0), ring(5, 0.2), ring(17, 4.0)[::-1], ring(4, 1.0, centre=(9.0, 0.0))]


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


def test_a_repeated_closing_point_is_dropped() -> None:
    mesh = Mesh.from_loops([np.concatenate((SQUARE, SQUARE[:1])), ring(5, 0.5, centre=(2.0, 2.0))])
    assert len(mesh.vertices) == 9
    assert mesh.loop_signs.tolist() == [1, -1]


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


def test_many_small_and_deeply_nested_loops() -> None:
    islands = [ring(3, 0.2, centre=(k % 50 - 25.0, k // 50 - 25.0)) for k in range(2500)]
    mesh = Mesh.from_loops([*islands[:1000], ring(4, 1e4), *islands[1000:]])
    assert mesh.loop_signs.tolist() == [-1] * 1000 + [1] + [-1] * 1500 and not mesh.component_of_loop.any()
    mesh = Mesh.from_loops([ring(5, 1.0 + k) for k in range(60)])
    assert mesh.loop_signs.tolist() == [-1, 1] * 30
    assert mesh.component_of_loop.tolist() == [k // 2 for k in range(60)]


@pytest.mark.parametrize("count", slow_after(1, [7, 80]))
def test_loops_lie_in_each_other_as_shapely_says(count: int) -> None:
    """Those of one mesh, and those of two meshes; few are compared with all, many by a tree."""
    random = np.random.default_rng(3)
    sizes = [0.45, 0.3, 0.2, 0.1]
    places = [(x, y) for x in range(9) for y in range(9)]
    loops = [ring(9, s, centre=at) for at in places for s in sizes[: int(random.integers(1, 5))]][:count]
    loops = [loops[k] for k in random.permutation(len(loops))]
    mesh = Mesh.from_loops(loops)
    solids = [shapely.Polygon(loop) for loop in loops]
    around = [[k for k, other in enumerate(solids) if other is not one and other.contains(one)] for one in solids]
    smallest = [min(outer, key=lambda k: solids[k].area, default=-1) for outer in around]
    assert mesh.parent_of_loop.tolist() == mesh.moved(mesh.vertices + 1.0).parent_of_loop.tolist() == smallest
    assert mesh.loop_signs.tolist() == [1 - 2 * (len(outer) % 2) for outer in around]
    shrunk = Mesh.from_loops([0.99 * loop + 0.003 for loop in loops])
    widened = [
        loop + 0.02 * sign * (loop - loop.mean(axis=0)) for loop, sign in zip(loops, mesh.loop_signs, strict=True)
    ]
    for other in (shrunk, mesh.moved(mesh.vertices), Mesh.from_loops(widened)):
        expected = polygon(other).contains_properly(polygon(mesh))
        assert Nesting(other, mesh).encloses() == expected
        assert Nesting(other, mesh).encloses_loop_by_loop() == expected
    assert Nesting(Mesh.from_loops(widened), mesh).encloses()


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
def test_areas_of_slivers_and_thin_rings_are_right(offset: float) -> None:
    low, high = np.array([offset, offset]), np.array([offset + 1.0, offset + 1.0])
    middle = np.nextafter(0.5 * (low + high), [np.inf, -np.inf])
    sliver = np.stack((low, middle, high))
    mesh = Mesh.from_loops([sliver])
    assert mesh.area == pytest.approx(float(abs(exact_area(sliver))), rel=1e-12)
    assert mesh.area > 0.0
    outer = ring(64)
    inner = outer * (1.0 - 1e-15)
    mesh = Mesh.from_loops([outer, inner])
    assert mesh.area == pytest.approx(float(exact_area(outer) - exact_area(inner)), rel=1e-9)


def test_the_extent_stays_when_a_mesh_is_turned_and_moved() -> None:
    angle = 0.8
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    assert Mesh.from_loops([square]).extent == pytest.approx(2.4 * np.sqrt(2.0))
    assert Mesh.from_loops([square @ turn + 5.0]).extent == pytest.approx(2.4 * np.sqrt(2.0))


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
    with rejected("mesh.crossing", InvalidMeshError):
        crossed.validated()
    assert mesh.validated() is mesh
    assert mesh.moved(SQUARE + 1.0).validated().is_validated
    with rejected("mesh.unreadable", InvalidMeshError):
        mesh.moved(SQUARE[:3])


# One mesh around another


FINE = Mesh.from_loops([ring(20), ring(12, 0.4)])
AROUND, WITHIN = ring(20, 1.1), ring(12, 0.3)
ASIDE = np.array([0.7, 0.0])


@pytest.mark.parametrize(
    "loops",
    [
        pytest.param([AROUND, ring(12, 0.5)], id="the hole cuts into the solid"),
        pytest.param([ring(20, 0.9), WITHIN], id="the solid sticks out"),
        pytest.param([AROUND, ring(12, 1.05)], id="a thin ring around the boundary only"),
        pytest.param([AROUND, ring(12, 0.05) + ASIDE], id="the hole is in the solid"),
        pytest.param([ring(20), WITHIN], id="touching"),
        pytest.param([AROUND * [0.9, 1.0], WITHIN], id="the solid sticks out on both sides only"),
    ],
)
def test_what_does_not_enclose_is_rejected(loops: list[np.ndarray]) -> None:
    nesting = Nesting(Mesh.from_loops(loops), FINE)
    assert not nesting.encloses()
    assert not nesting.encloses_loop_by_loop()


@pytest.mark.parametrize("others", [[], [WITHIN + 4.0 * ASIDE]], ids=["no other loop", "a component instead"])
def test_a_cage_that_fills_a_hole_encloses_but_not_loop_by_loop(others: list[np.ndarray]) -> None:
    assert Nesting(Mesh.from_loops([AROUND, WITHIN]), FINE).encloses_loop_by_loop()
    filled = Nesting(Mesh.from_loops([AROUND, *others]), FINE)
    assert filled.encloses()
    assert not filled.encloses_loop_by_loop()


def test_swapped_loops_are_told_from_lost_ones() -> None:
    fine = Mesh.from_loops([ring(12), ring(12) + 3.0])
    swapped = Nesting(Mesh.from_loops([ring(12, 1.2) + 3.0, ring(12, 1.2)]), fine)
    assert swapped.encloses()
    assert not swapped.encloses_loop_by_loop()
    assert Nesting(Mesh.from_loops([ring(12, 1.2), ring(12, 1.2) + 3.0]), fine).encloses_loop_by_loop()
    outside, inside = Nesting(Mesh.from_loops([ring(12, 1.2)]), fine).uncovered
    assert outside.tolist() == [1]
    assert inside.tolist() == []


def test_contact_names_the_edges() -> None:
    square = Mesh.from_loops([[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]])
    touching = Mesh.from_loops([[(0.2, 0.2), (0.8, 0.2), (0.5, 1.0)]])
    for other, edges in (
        (touching, {(2, 3, 1, 2), (2, 3, 2, 0)}),
        (square.moved(square.vertices + 0.5), {(1, 2, 0, 1), (2, 3, 3, 0)}),
    ):
        (problem,) = verify(square, other).problems
        assert problem.code == "cage.meets"
        assert tuple(problem.data["vertices"]) in edges
    assert verify(square, [[(0.2, 0.2), (0.8, 0.2), (0.5, 0.9)]])


# Geometries of other programs


def test_geometry_round_trip() -> None:
    mesh = Mesh.from_loops(target())
    polygons = polygon_of(mesh)
    assert polygons.is_valid
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert Mesh.of(polygons) == Mesh.from_geometry(polygons)
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
    exact = [(Decimal(x), Fraction(y)) for x, y in np.array(SQUARE).tolist()]
    both = square.area + other.area
    cases = [
        (square, square.area),
        (mapping(square), square.area),
        (shapely.MultiPolygon([square, other]), both),
        (shapely.GeometryCollection([square, empty, shapely.MultiPolygon([other])]), both),
        (Carrier(feature), square.area),
        (Carrier({"type": "FeatureCollection", "features": [feature, nothing, Carrier(mapping(other))]}), both),
        (shapely.Polygon([(x, y, 7.0) for x, y in SQUARE]), 16.0),
        ({"type": "Polygon", "coordinates": iter([exact])}, 16.0),
    ]
    for geometry, area in cases:
        assert Mesh.from_geometry(geometry).area == pytest.approx(area, rel=1e-14)


ENDLESS: dict[str, Any] = {"type": "GeometryCollection", "geometries": []}
ENDLESS["geometries"].append(ENDLESS)


@pytest.mark.parametrize(
    ("geometry", "code"),
    [
        *((geometry, "mesh.unreadable") for geometry in (shapely.LineString([(0, 0), (1, 1)]), 7, None, {})),
        *(({"type": "Polygon", **rings}, "mesh.unreadable") for rings in ({}, {"coordinates": np.array(5)})),
        *(
            ({"type": "Polygon", "coordinates": rings}, "mesh.unreadable")
            for rings in ([[1, 2, 3]], [[(0, 0), (1, 0), (1,)]], "rings", [[(True, 0)]])
        ),
        (shapely.Polygon(), "mesh.empty"),
        (shapely.MultiPolygon(), "mesh.empty"),
        ({"type": "Polygon", "coordinates": [[(10**400, 0)]]}, "mesh.out_of_range"),
        ({"type": "Polygon", "coordinates": [[(0, np.nan)]]}, "mesh.not_finite"),
        ({"type": "MultiPolygon"}, "mesh.unreadable"),
        ({"type": "FeatureCollection", "features": 3}, "mesh.unreadable"),
        (shapely.GeometryCollection([Polygon(ring(5, 9.0)), Polygon(ring(5, 1.0))]), "mesh.nesting"),
        (Polygon(ring(5, 1.0), [ring(5, 1.0, centre=(5.0, 0.0))]), "mesh.nesting"),
        (Polygon([(0, 0), (2, 2), (2, 0), (0, 2)]), "mesh.crossing"),
        (ENDLESS, "limit.exceeded"),
    ],
)
def test_geometries_that_are_refused(geometry: Any, code: str) -> None:
    with rejected(code, InvalidMeshError):
        Mesh.from_geometry(geometry)


FRAME = [(0, 0), (6, 0), (6, 6), (0, 6)]
VALID = {
    "parts that touch in a corner": MultiPolygon([box(0, 0, 1, 1), box(1, 1, 2, 2)]),
    "a hole at its shell": Polygon(FRAME, [[(0, 2), (2, 1), (2, 3)]]),
    "holes that touch": Polygon(FRAME, [box(1, 1, 2, 2).exterior, box(2, 2, 3, 3).exterior]),
    "a ring that touches itself": Polygon([(0, 0), (2, 1), (4, 0), (4, 4), (2, 1), (0, 4)]),
    "faces with an edge in common": GeometryCollection([box(0, 0, 1, 1), box(1, 0, 2, 1)]),
    "faces that overlap": GeometryCollection([box(0, 0, 1, 1), box(0.5, 0.5, 2, 2)]),
    "a face in another": GeometryCollection([box(0, 0, 5, 5), box(1, 1, 2, 2)]),
    "a line next to a face": GeometryCollection([box(0, 0, 1, 1), shapely.LineString([(1, 1), (2, 2)])]),
}


@pytest.mark.parametrize("name", VALID)
def test_geometries_of_shapely_are_shapes_and_a_warning_tells_of_repairs(name: str) -> None:
    geometry = VALID[name]
    with pytest.warns(NestedCagesWarning) as said:
        mesh = Mesh.of(geometry)
    assert len(said) == 1
    assert said[0].filename == __file__
    whole = shapely.union_all(shapely.get_parts(geometry)).buffer(0)
    assert mesh.area == pytest.approx(whole.area, rel=1e-9)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert Mesh.of(geometry.__geo_interface__) == mesh == from_geojson(geometry)
        (level,) = nested_cages(geometry, 12)
    assert shapely.area(shapely.difference(whole, shapely.geometry.shape(level.cage))) == 0.0
    assert verify(level.cage, mesh)


@pytest.mark.parametrize(
    ("wrong", "code"),
    [
        (Polygon([(0, 0), (2, 2), (2, 0), (0, 2)]), "mesh.crossing"),
        (Polygon(box(0, 0, 1, 1).exterior, [box(3, 0, 4, 1).exterior]), "mesh.nesting"),
        (Polygon([(0, 0), (1, 1), (2, 2)]), "mesh.empty"),
        (GeometryCollection([shapely.Point(0, 0)]), "mesh.empty"),
    ],
)
def test_geometries_that_no_repair_mends_are_refused(wrong: Any, code: str) -> None:
    with rejected(code, InvalidMeshError), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        Mesh.of(wrong)


def test_meshes_and_judges_stay_strict() -> None:
    geometry = VALID["parts that touch in a corner"]
    for read in (Mesh.from_geometry, lambda shape: Mesh.of(shape, strict=True)):
        with pytest.raises(InvalidMeshError):
            read(geometry)
    around = nested_cages(ring(9, 5.0, centre=(1.0, 1.0)), 5)[0].cage
    assert not verify(geometry, Mesh.from_loops([ring(5, 0.1, centre=(0.8, 0.4))]))
    with pytest.warns(NestedCagesWarning):
        assert verify(around, geometry, same_loops=False)
    with pytest.raises(InvalidMeshError):
        verify_motion(around, geometry, [around.vertices], np.zeros((1, 8, 2)))


def test_vertices_and_edges_are_no_two_loops() -> None:
    vertices, edges = ring(12, 1.0), np.stack((np.arange(12), np.roll(np.arange(12), -1)), axis=1)
    mesh = Mesh(vertices, edges)
    for pair in ((vertices, edges), [vertices, edges[::-1]], (vertices.tolist(), edges.astype(np.int32))):
        assert Mesh.of(pair).has_loops_like(mesh)
        assert Mesh.of(pair).area == mesh.area
    assert nested_cages((vertices, edges), 6)[0].fine == mesh
    with rejected("mesh.open", InvalidMeshError):
        Mesh.of((vertices, edges[:-1]))
    hole = np.array([(1, 1), (2, 1), (2, 2)])
    assert len(Mesh.of((np.array(FRAME, float), hole)).loops) == 2


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


@pytest.mark.parametrize("examples", slow_after(1, [60, 500, 20_000], thorough_after=2))
@pytest.mark.parametrize("corners", [3, 4, 5, 6, 7])
def test_loops_on_a_grid_are_accepted_if_and_only_if_they_are_simple(corners: int, examples: int) -> None:
    random = np.random.default_rng(corners)
    accepted = 0
    for _ in range(examples):
        points = random.integers(0, 5, size=(corners, 2)).astype(float)
        if (points[0] == points[-1]).all():
            continue
        assert is_accepted([points]) == is_valid_ring(points), points.tolist()
        accepted += is_valid_ring(points)
    assert accepted > 0 or examples < 500


@pytest.mark.parametrize("examples", slow_after(1, [150, 800, 20_000], thorough_after=2))
def test_two_loops_on_a_grid_are_accepted_if_and_only_if_they_stay_apart(examples: int) -> None:
    random = np.random.default_rng(2)
    verdicts = []
    for _ in range(examples):
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
    assert {True, False} == set(verdicts)


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
    with rejected("mesh.crossing", InvalidMeshError) as caught:
        Mesh.from_loops([left, other])
    assert {4, 7} <= set(caught.value.data["vertices"])


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
        with rejected("mesh.crossing", InvalidMeshError):
            Mesh.from_loops([random.uniform(size=(count, 2))])
        return
    assert Mesh.from_loops([loop]).area == pytest.approx(shapely.Polygon(loop).area, rel=1e-11)
