"""Every kind of bad input is refused with a code and its place, and nothing ever crashes the door."""

import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from nestedcages_core import InvalidMeshError, Mesh
from support.judging import rejected
from support.shapes import ring

SQUARE = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
AROUND = [[0, 1], [1, 2], [2, 3], [3, 0]]
SMALL = [[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]]


def with_point(index: int, point: list[float]) -> list[list[float]]:
    return [point if k == index else p for k, p in enumerate(SQUARE)]


class Broken:
    """Refuses to become an array in its own way."""

    def __array__(self, *arguments: Any, **options: Any) -> Any:
        raise RuntimeError("no array today")


UNREADABLE = "mesh.unreadable"
NO_POINTS = (
    *(None, [[0.0, 0.0, 1.0]] * 4, [[0, 0], [1, 0], [1]], Broken(), [["a", "b"]] * 4, [[1j, 0]] * 4, [[{}, 0]] * 4),
    [[10**400, 0]] * 4,
)
VERTICES_AND_EDGES: list[tuple[Any, Any, str, dict[str, Any]]] = [
    # numbers that are none
    *((points, AROUND, UNREADABLE, {}) for points in NO_POINTS),
    ([], AROUND, "mesh.empty", {}),
    (with_point(2, [np.nan, 4.0]), AROUND, "mesh.not_finite", {"vertex": 2}),
    (with_point(3, [0.0, -np.inf]), AROUND, "mesh.not_finite", {"vertex": 3}),
    (with_point(1, [1e151, 0.0]), AROUND, "mesh.out_of_range", {"vertex": 1, "place": (1e151, 0.0)}),
    ((np.array(SQUARE) * 1e-160).tolist(), AROUND, "mesh.out_of_range", {"place": (0.0, 0.0)}),
    # indices that are none
    *((SQUARE, edges, UNREADABLE, {}) for edges in (None, [[0, 1, 2]], [["0", "1"]], [[True, False]])),
    (SQUARE, [], "mesh.empty", {}),
    (SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0.5]], "mesh.edge_index", {"edges": (3,)}),
    (SQUARE, [[0, 1], [1, np.nan], [2, 3], [3, 0]], "mesh.edge_index", {"edges": (1,)}),
    (SQUARE, [[0, 1], [1, 2], [2, 4], [4, 0]], "mesh.edge_index", {"edges": (2,)}),
    (SQUARE, [[0, 1], [1, 2], [2, 3], [3, -1]], "mesh.edge_index", {"edges": (3,)}),
    (SQUARE, np.array([[0, 2**64 - 1]], np.uint64), "mesh.edge_index", {"edges": (0,)}),
    (SQUARE, [[0, 1e300]], "mesh.edge_index", {"edges": (0,)}),
    # edges that are no loops
    (SQUARE, AROUND[:3], "mesh.open", {"vertices": (0,)}),
    (SQUARE, [[0, 1], [1, 2], [2, 0]], "mesh.open", {"vertices": (3,)}),
    (SQUARE, [*AROUND, [1, 3]], "mesh.open", {"vertices": (1,)}),
    (SQUARE, [[0, 1], [1, 2], [2, 2], [3, 0]], "mesh.edge_index", {"edges": (2,)}),
    (SQUARE, [*AROUND, [2, 1]], "mesh.edge_index", {"edges": (1, 4)}),
    (SQUARE, [[0, 1], [1, 0], [2, 3], [3, 2]], "mesh.edge_index", {"edges": (0, 1)}),
    # loops that bound nothing
    (with_point(1, [0.0, 0.0]), AROUND, "mesh.repeated_vertex", {"vertices": (0, 1), "place": (0.0, 0.0)}),
    (with_point(2, [4.0, -0.0]), AROUND, "mesh.repeated_vertex", {"vertices": (1, 2), "place": (4.0, 0.0)}),
    ([[0.3, 0.7]] * 4, AROUND, "mesh.repeated_vertex", {"vertices": (0, 1), "place": (0.3, 0.7)}),
    ([[0, 0], [1, 1], [3, 3]], [[0, 1], [1, 2], [2, 0]], "mesh.spike", {"vertices": (2,), "place": (3.0, 3.0)}),
    ([[0, 0], [4, 0], [2, 0], [2, 3]], AROUND, "mesh.spike", {"vertices": (1,), "place": (4.0, 0.0)}),
    ([SQUARE[k] for k in (0, 2, 1, 3)], AROUND, "mesh.crossing", {"vertices": (0, 1, 2, 3), "place": (2.0, 2.0)}),
]

LOOPS: list[tuple[Any, str, dict[str, Any]]] = [
    *((loops, UNREADABLE, {}) for loops in (None, 7, [Broken()], SQUARE, [SQUARE, []], [SQUARE, [["a", "b"]] * 3])),
    *(([SQUARE, loop], UNREADABLE, {}) for loop in ([["a", "b"]], np.array(SQUARE).astype("M8[s]"))),
    ([], "mesh.empty", {}),
    ([np.zeros((0, 2))], "mesh.open", {}),
    ([SQUARE, [[7.0, 8.0]]], "mesh.open", {}),
    ([SQUARE, [[7.0, 8.0], [9.0, 8.0]]], "mesh.open", {}),
    ([[[0, 0], [1, 0], [0, 0]]], "mesh.open", {}),
    ([[*SQUARE, [np.nan, 0.0]]], "mesh.not_finite", {"vertex": 4}),
    ([SQUARE, [[1.0, 1.0], [9.0, 2.0], [1.0, 3.0]]], "mesh.crossing",
     {"loops": (0, 1), "vertices": (1, 2, 4, 5), "place": (4.0, 1.375)}),
    ([SQUARE, [[4.0, 2.0], [9.0, 1.0], [9.0, 3.0]]], "mesh.crossing",
     {"loops": (1, 0), "vertices": (4, 1, 2), "place": (4.0, 2.0)}),
    ([SQUARE, [[4.0, 4.0], [9.0, 4.0], [9.0, 9.0]]], "mesh.repeated_vertex",
     {"loops": (0, 1), "vertices": (2, 4), "place": (4.0, 4.0)}),
    ([SQUARE, SQUARE], "mesh.repeated_vertex", {"loops": (0, 1), "vertices": (0, 4), "place": (0.0, 0.0)}),
    ([[[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]]], "mesh.crossing", {"vertices": (3, 0, 1), "place": (2.0, 0.0)}),
    ([[[0, 0], [2, 2], [4, 0], [4, 4], [2, 2], [0, 4]]], "mesh.repeated_vertex",
     {"vertices": (1, 4), "place": (2.0, 2.0)}),
    ([SQUARE, SMALL, [[1.2, 1.2], [3.0, 1.2], [1.2, 3.0]]], "mesh.crossing", {"loops": (1, 2)}),
    ([[[0.0, 0.0], [1e-140, 0.0], [1e-140, 1e-200]]], "mesh.out_of_range", {}),  # an area too small for doubles
]  # fmt: skip


@pytest.mark.parametrize(("vertices", "edges", "code", "data"), VERTICES_AND_EDGES)
def test_bad_vertices_and_edges(vertices: Any, edges: Any, code: str, data: dict[str, Any]) -> None:
    with rejected(code, InvalidMeshError, **data):
        Mesh(vertices, edges)


@pytest.mark.parametrize(("loops", "code", "data"), LOOPS)
def test_bad_loops(loops: Any, code: str, data: dict[str, Any]) -> None:
    with rejected(code, InvalidMeshError, **data):
        Mesh.from_loops(loops)


def test_the_place_is_that_of_the_crossing() -> None:
    random = np.random.default_rng(1)
    for _ in range(30):
        loop, k = ring(60), int(random.integers(5, 55))
        loop[[k, k + 1]] = loop[[k + 1, k]]
        with pytest.raises(InvalidMeshError) as caught:
            Mesh.from_loops([loop])
        data = caught.value.data
        assert np.hypot(*(np.array(data["place"]) - loop[k])) < 0.2
        assert {k - 1, k} <= set(data["vertices"])


numbers = st.one_of(
    st.floats(),
    st.floats(-2, 2),
    st.sampled_from([0.0, -0.0, 1.0, 2.0, 3.0, 1e300, -1e300, 1e150, 1e-150, 5e-324, 2.5e-310, np.nan, np.inf]),
)
kinds = st.sampled_from(["f8", "f4", ">f2", "i1", "i8", "u8", "?", "c16", "O", "U3", "S2", "M8[s]", "m8[D]"])


def assert_sound_or_refused(make: Any) -> None:
    """Whatever `make` makes is a sound mesh or an InvalidMeshError; nothing warns."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            mesh = make()
        except InvalidMeshError as error:
            assert error.code.startswith("mesh.")
            return
    assert mesh.area > 0.0 and np.isfinite(mesh.diagonal) and (mesh.edge_lengths >= 0.0).all()
    assert np.array_equal(mesh.predecessor[mesh.successor], np.arange(len(mesh.vertices)))
    assert sum(len(loop) for loop in mesh.loops) == len(mesh.vertices)


@pytest.mark.slow
@given(st.data())
@settings(max_examples=150, deadline=None)
def test_any_loop_of_doubles_and_any_edges(data: st.DataObject) -> None:
    points = data.draw(hnp.arrays(np.float64, st.tuples(st.integers(0, 12), st.just(2)), elements=numbers))
    assert_sound_or_refused(lambda: Mesh.from_loops([points]))
    count = data.draw(st.integers(1, 8))
    vertices = np.random.default_rng(count).integers(0, 9, size=(count, 2))
    edges = data.draw(hnp.arrays(np.int64, st.tuples(st.integers(0, 9), st.just(2)), elements=st.integers(-1, count)))
    assert_sound_or_refused(lambda: Mesh(vertices, edges))


@pytest.mark.slow
@given(st.data())
@settings(max_examples=100, deadline=None)
def test_arrays_of_any_kind(data: st.DataObject) -> None:
    def array() -> np.ndarray:
        shape = data.draw(hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4))
        raw = np.random.default_rng(data.draw(st.integers(0, 99))).integers(0, 5, size=shape)
        with np.errstate(all="ignore"):
            return raw.astype(data.draw(kinds))

    vertices, edges = array(), array()
    assert_sound_or_refused(lambda: Mesh(vertices, edges))
    assert_sound_or_refused(lambda: Mesh(SQUARE, edges))
    assert_sound_or_refused(lambda: Mesh(vertices, AROUND))
    assert_sound_or_refused(lambda: Mesh.from_loops([vertices, edges]))
    assert_sound_or_refused(lambda: Mesh.from_loops(vertices))


@pytest.mark.slow
@given(st.recursive(st.none() | numbers | st.text(max_size=3) | st.integers(), st.lists, max_leaves=20))
@settings(max_examples=100, deadline=None)
def test_lists_of_anything(garbage: Any) -> None:
    assert_sound_or_refused(lambda: Mesh.from_loops(garbage))
    assert_sound_or_refused(lambda: Mesh(garbage, AROUND))
    assert_sound_or_refused(lambda: Mesh(SQUARE, garbage))
    assert_sound_or_refused(lambda: Mesh.from_geometry(garbage))
    assert_sound_or_refused(lambda: Mesh.from_geometry({"type": "Polygon", "coordinates": garbage}))
    assert_sound_or_refused(lambda: Mesh.from_geometry({"type": "GeometryCollection", "geometries": garbage}))
