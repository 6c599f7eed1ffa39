"""Every kind of bad input gets one clear sentence with its place, and nothing ever crashes the door."""

from __future__ import annotations

import re
import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from nestedcages_core.errors import InvalidMeshError
from nestedcages_core.geometry.mesh import Mesh

SQUARE = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
AROUND = [[0, 1], [1, 2], [2, 3], [3, 0]]
SMALL = [[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]]


def with_point(index: int, point: list[float]) -> list[list[float]]:
    return [point if k == index else p for k, p in enumerate(SQUARE)]


class Broken:
    """Refuses to become an array in its own way."""

    def __array__(self, *arguments: Any, **options: Any) -> Any:
        raise RuntimeError("no array today")


VERTICES_AND_EDGES: list[tuple[Any, Any, str]] = [
    # numbers that are none
    (None, AROUND, "The vertices have shape (), but (n, 2) is needed; give two coordinates per vertex."),
    ([], AROUND, "The mesh is empty: it has no vertices; give at least one loop of three vertices."),
    ([[0.0, 0.0, 1.0]] * 4, AROUND, "The vertices have shape (4, 3), but (n, 2) is needed"),
    ([[0, 0], [1, 0], [1]], AROUND, "The vertices cannot be read as an array ("),
    (Broken(), AROUND, "The vertices cannot be read as an array (no array today); give one row of two numbers each."),
    ([["a", "b"]] * 4, AROUND, "The vertices are not all real numbers (they are of type <U1); give numbers only."),
    ([[1j, 0]] * 4, AROUND, "The vertices are not all real numbers (they are of type complex128); give numbers only."),
    ([[{}, 0]] * 4, AROUND, "The vertices are not all real numbers ("),
    ([[10**400, 0]] * 4, AROUND, "The vertices are not all real numbers ("),
    (with_point(2, [np.nan, 4.0]), AROUND, "Vertex 2 has the coordinates (nan, 4); give finite numbers, or remove the"),
    (with_point(3, [0.0, -np.inf]), AROUND, "Vertex 3 has the coordinates (0, -inf); give finite numbers"),
    (with_point(1, [1e151, 0.0]), AROUND, "Vertex 1 at (1e+151, 0) is farther out than 1e+150, where areas leave the"),
    ((np.array(SQUARE) * 1e-160).tolist(), AROUND, "The whole shape around (0, 0) is smaller than 1e-150, where areas"),
    # indices that are none
    (SQUARE, None, "The edges have shape (), but (m, 2) is needed; give two vertex indices per edge."),
    (SQUARE, [], "The mesh has no edges; join the vertices into closed loops."),
    (SQUARE, [[0, 1, 2]], "The edges have shape (1, 3), but (m, 2) is needed"),
    (SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0.5]], "Edge 3 joins (3, 0.5), but vertex indices are whole numbers"),
    (SQUARE, [[0, 1], [1, np.nan], [2, 3], [3, 0]], "Edge 1 joins (1, nan), but vertex indices are whole numbers"),
    (SQUARE, [["0", "1"]], "The edges are not all real numbers (they are of type <U1); give numbers only."),
    (SQUARE, [[True, False]], "The edges are not all real numbers (they are of type bool); give numbers only."),
    (SQUARE, [[0, 1], [1, 2], [2, 4], [4, 0]], "Edge 2 joins vertices 2 and 4, but the 4 vertices are numbered from 0"),
    (SQUARE, [[0, 1], [1, 2], [2, 3], [3, -1]], "Edge 3 joins vertices 3 and -1, but the 4 vertices are numbered"),
    (SQUARE, np.array([[0, 2**64 - 1]], np.uint64), "Edge 0 joins vertices 0 and 18446744073709551615, but the 4"),
    (SQUARE, [[0, 1e300]], "Edge 0 joins vertices 0 and "),
    # edges that are no loops
    (SQUARE, AROUND[:3], "The loop is open at vertex 0, where only one edge ends; close it with an edge."),
    (SQUARE, [[0, 1], [1, 2], [2, 0]], "Vertex 3 belongs to no edge; remove it, or join it into a loop."),
    (SQUARE, [*AROUND, [1, 3]], "At vertex 1 meet 3 edges, but loops pass each vertex once; split the vertex"),
    (SQUARE, [[0, 1], [1, 2], [2, 2], [3, 0]], "Edge 2 joins vertex 2 to itself; remove the edge."),
    (SQUARE, [*AROUND, [2, 1]], "Edges 1 and 4 both join vertices 1 and 2; remove one: a loop has each edge once"),
    (SQUARE, [[0, 1], [1, 0], [2, 3], [3, 2]], "Edges 0 and 1 both join vertices 0 and 1; remove one"),
    # loops that bound nothing
    (with_point(1, [0.0, 0.0]), AROUND, "Vertices 0 and 1 follow each other in loop 0 and both lie at (0, 0); remove"),
    (with_point(2, [4.0, -0.0]), AROUND, "Vertices 1 and 2 follow each other in loop 0 and both lie at (4, 0); remove"),
    ([[0, 0], [1, 1], [3, 3]], [[0, 1], [1, 2], [2, 0]], "Loop 0 turns back over its own edge at vertex 2, (3, 3)"),
    ([[0, 0], [4, 0], [2, 0], [2, 3]], AROUND, "Loop 0 turns back over its own edge at vertex 1, (4, 0); move"),
    ([SQUARE[k] for k in (0, 2, 1, 3)], AROUND, "Loop 0 crosses itself near (2, 2): edge 0-1 of loop 0 meets edge 2-3"),
    (
        [[0.3, 0.7], [0.3, 0.7], [0.3, 0.7], [0.3, 0.7]],
        AROUND,
        "Vertices 0 and 1 follow each other in loop 0 and both lie at (0.3, 0.7); remove one of them.",
    ),
]

LOOPS: list[tuple[Any, str]] = [
    (None, "The loops cannot be read as arrays ("),
    (7, "The loops cannot be read as arrays ("),
    ([Broken()], "The loops cannot be read as arrays (no array today); give a list of loops, each with rows (x, y)."),
    ([], "The mesh is empty: there are no loops; give at least one loop of three points."),
    (SQUARE, "Loop 0 has shape (2,), but (k, 2) is needed; give a list of loops, each with rows (x, y)."),
    ([SQUARE, []], "Loop 1 has shape (0,), but (k, 2) is needed"),
    ([np.zeros((0, 2))], "Loop 0 has 0 of the three vertices that a loop needs; add some, or remove it."),
    ([SQUARE, [[7.0, 8.0]]], "Loop 1 at (7, 8) has 1 of the three vertices that a loop needs"),
    ([SQUARE, [[7.0, 8.0], [9.0, 8.0]]], "Loop 1 at (7, 8) has 2 of the three vertices that a loop needs"),
    ([[[0, 0], [1, 0], [0, 0]]], "Loop 0 at (0, 0) has 2 of the three vertices that a loop needs"),
    ([SQUARE, [["a", "b"]] * 3], "The vertices are not all real numbers ("),
    ([SQUARE, [["a", "b"]]], "The vertices are not all real numbers ("),
    ([[*SQUARE, [np.nan, 0.0]]], "Vertex 4 has the coordinates (nan, 0)"),
    ([SQUARE, [[1.0, 1.0], [9.0, 2.0], [1.0, 3.0]]], "Loops 0 and 1 cross near (4, 1.375): edge 1-2 of loop 0 meets"),
    ([SQUARE, [[4.0, 2.0], [9.0, 1.0], [9.0, 3.0]]], "Vertex 4 of loop 1 lies on edge 1-2 of loop 0 at (4, 2)"),
    ([SQUARE, [[4.0, 4.0], [9.0, 4.0], [9.0, 9.0]]], "Vertices 2 of loop 0 and 4 of loop 1 both lie at (4, 4)"),
    ([SQUARE, SQUARE], "Vertices 0 of loop 0 and 4 of loop 1 both lie at (0, 0); move one of them"),
    ([[[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]]], "Vertex 3 of loop 0 lies on edge 0-1 of loop 0 at (2, 0)"),
    (
        [[[0, 0], [2, 2], [4, 0], [4, 4], [2, 2], [0, 4]]],
        "Vertices 1 of loop 0 and 4 of loop 0 both lie at (2, 2); move one of them, so that the boundary does",
    ),
    ([SQUARE, SMALL, [[1.2, 1.2], [3.0, 1.2], [1.2, 3.0]]], "Loops 1 and 2 cross near"),
]


def sentence_of(error: pytest.ExceptionInfo[InvalidMeshError]) -> str:
    """The message, which must be one sentence that says what to do."""
    text = str(error.value)
    assert text[0].isupper()
    assert text.endswith(".")
    assert "\n" not in text
    assert not re.search(r"\. [A-Z]", re.sub(r"\(.*?\)", "", text))
    assert "; " in text or ", so " in text
    return text


@pytest.mark.parametrize(("vertices", "edges", "sentence"), VERTICES_AND_EDGES)
def test_bad_vertices_and_edges(vertices: Any, edges: Any, sentence: str) -> None:
    with pytest.raises(InvalidMeshError) as error:
        Mesh(vertices, edges)
    assert sentence_of(error).startswith(sentence)


@pytest.mark.parametrize(("loops", "sentence"), LOOPS)
def test_bad_loops(loops: Any, sentence: str) -> None:
    with pytest.raises(InvalidMeshError) as error:
        Mesh.from_loops(loops)
    assert sentence_of(error).startswith(sentence)


def test_an_area_too_small_for_doubles_is_refused() -> None:
    sliver = np.array([[0.0, 0.0], [1e-140, 0.0], [1e-140, 1e-200]])
    with pytest.raises(InvalidMeshError) as error:
        Mesh.from_loops([sliver])
    assert sentence_of(error).startswith("The area inside the loops around (0, 0) is too small")


def test_the_place_is_that_of_the_crossing() -> None:
    random = np.random.default_rng(1)
    for _ in range(50):
        angle = np.arange(60) / 60 * 2 * np.pi
        loop = np.stack((np.cos(angle), np.sin(angle)), axis=1)
        k = int(random.integers(5, 55))
        loop[[k, k + 1]] = loop[[k + 1, k]]
        with pytest.raises(InvalidMeshError) as error:
            Mesh.from_loops([loop])
        found = re.search(r"near \((.*), (.*)\)", str(error.value))
        assert found
        assert np.hypot(*(np.array([float(x) for x in found.groups()]) - loop[k])) < 0.2
        assert f"edge {k - 1}-{k} " in str(error.value)


# Garbage: the result is a mesh or a sentence, whatever comes in

numbers = st.one_of(
    st.floats(),
    st.floats(-2, 2),
    st.sampled_from([0.0, -0.0, 1.0, 2.0, 3.0, 1e300, -1e300, 1e150, 1e-150, 5e-324, 2.5e-310, np.nan, np.inf]),
)
kinds = st.sampled_from(["f8", "f4", ">f2", "i1", "i8", "u8", "?", "c16", "O", "U3", "S2", "M8[s]", "m8[D]"])


def check(make: Any) -> None:
    """Whatever `make` makes is a sound mesh or an InvalidMeshError."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            mesh = make()
        except InvalidMeshError as error:
            text = str(error)
            assert text[0].isupper()
            assert text.endswith(".")
            return
    assert mesh.area > 0.0
    assert np.isfinite(mesh.diagonal)
    assert (mesh.edge_lengths >= 0.0).all()
    assert np.array_equal(mesh.predecessor[mesh.successor], np.arange(len(mesh.vertices)))
    assert sum(len(loop) for loop in mesh.loops) == len(mesh.vertices)


@pytest.mark.slow
@given(hnp.arrays(np.float64, st.tuples(st.integers(0, 12), st.just(2)), elements=numbers))
@settings(max_examples=400, deadline=None)
def test_any_loop_of_doubles(points: np.ndarray) -> None:
    check(lambda: Mesh.from_loops([points]))


@pytest.mark.slow
@given(st.data())
@settings(max_examples=200, deadline=None)
def test_any_edges(data: st.DataObject) -> None:
    count = data.draw(st.integers(1, 8))
    vertices = np.random.default_rng(count).integers(0, 9, size=(count, 2))
    edges = data.draw(hnp.arrays(np.int64, st.tuples(st.integers(0, 9), st.just(2)), elements=st.integers(-1, count)))
    check(lambda: Mesh(vertices, edges))


@pytest.mark.slow
@given(st.data())
@settings(max_examples=200, deadline=None)
def test_arrays_of_any_kind(data: st.DataObject) -> None:
    def array() -> np.ndarray:
        shape = data.draw(hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4))
        raw = np.random.default_rng(data.draw(st.integers(0, 99))).integers(0, 5, size=shape)
        with np.errstate(all="ignore"):
            return raw.astype(data.draw(kinds))

    vertices, edges = array(), array()
    check(lambda: Mesh(vertices, edges))
    check(lambda: Mesh(SQUARE, edges))
    check(lambda: Mesh(vertices, AROUND))
    check(lambda: Mesh.from_loops([vertices, edges]))
    check(lambda: Mesh.from_loops(vertices))


def test_loops_of_different_kinds_are_named() -> None:
    with pytest.raises(InvalidMeshError, match=r"different kinds of values \(float64, datetime64\[s\]\); give numbers"):
        Mesh.from_loops([np.array(SQUARE), np.array(SQUARE).astype("M8[s]")])


@pytest.mark.slow
@given(st.recursive(st.none() | numbers | st.text(max_size=3) | st.integers(), st.lists, max_leaves=20))
@settings(max_examples=200, deadline=None)
def test_lists_of_anything(garbage: Any) -> None:
    check(lambda: Mesh.from_loops(garbage))
    check(lambda: Mesh(garbage, AROUND))
    check(lambda: Mesh(SQUARE, garbage))
    check(lambda: Mesh.from_geometry(garbage))
    check(lambda: Mesh.from_geometry({"type": "Polygon", "coordinates": garbage}))
    check(lambda: Mesh.from_geometry({"type": "GeometryCollection", "geometries": garbage}))
