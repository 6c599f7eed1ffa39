"""Convex pieces tile a mesh exactly, have few vertices, and are as few as possible on small shapes."""

from fractions import Fraction

import numpy as np
import pytest
import shapely

from nestedcages_core import Mesh, convex_pieces
from support.shapes import islands, letter_a, polygon, ring, square_with_hole, star

L_SHAPE = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
PLUS = [[1, 0], [2, 0], [2, 1], [3, 1], [3, 2], [2, 2], [2, 3], [1, 3], [1, 2], [0, 2], [0, 1], [1, 1]]


@pytest.mark.parametrize("mesh", [star(), letter_a(), islands(), square_with_hole()])
@pytest.mark.parametrize("most", [3, 8])
def test_pieces_tile_the_mesh(mesh: Mesh, most: int) -> None:
    pieces = convex_pieces(mesh, most)
    own = {tuple(vertex) for vertex in mesh.vertices.tolist()}
    for piece in pieces:
        assert 3 <= len(piece) <= most
        assert {tuple(vertex) for vertex in piece.tolist()} <= own
        exact = np.vectorize(Fraction, otypes=[object])(piece)
        into, out = exact - np.roll(exact, 1, axis=0), np.roll(exact, -1, axis=0) - exact
        assert (into[:, 0] * out[:, 1] >= into[:, 1] * out[:, 0]).all()
    shapes = [shapely.Polygon(piece) for piece in pieces]
    assert sum(shape.area for shape in shapes) == pytest.approx(mesh.area, rel=1e-12)
    assert shapely.union_all(shapes).symmetric_difference(polygon(mesh)).area < 1e-9 * mesh.area


@pytest.mark.parametrize(("loop", "fewest"), [(L_SHAPE, 2), (PLUS, 3), (ring(8), 1), (ring(14), 2)])
def test_the_optimum_on_small_shapes(loop: object, fewest: int) -> None:
    assert len(convex_pieces(Mesh.from_loops([loop]))) == fewest
