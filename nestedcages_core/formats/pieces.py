"""Convex pieces that tile a solid: triangles joined across diagonals while they stay convex."""

from __future__ import annotations

import random

import numpy as np

from ..errors import invalid_setting
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import orientation_sign
from ..geometry.triangulation import triangulate

ORDERS = 24
"""Maximum number of orders of the diagonals: by length, then random ones; the result with fewest pieces is kept."""

MAX_DIAGONALS = 50_000
"""Diagonals tried in all random orders together: many of them average out, and further orders save less than 0.2 %."""

Piece = list[int]


def convex_pieces(mesh: Mesh, most: int = 8) -> list[FloatArray]:
    """Convex polygons that tile a mesh exactly.

    The constrained Delaunay triangles are joined across diagonals while pieces stay convex, by exact predicates, after
    Hertel & Mehlhorn (1983): without a limit, at most four times as many pieces as necessary are left. The best of
    several orders is kept.

    Parameters
    ----------
    mesh : Mesh
        The solid.
    most : int, optional
        Maximum number of vertices of a piece, at least 3. Default: 8, the limit of Box2D.

    Returns
    -------
    list of (k, 2) array
        The pieces, counter-clockwise; their vertices are those of the mesh.

    Raises
    ------
    NestedCagesError
        If ``most`` is less than 3.
    """
    return [mesh.vertices[piece] for piece in piece_vertices(mesh, most)]


def piece_vertices(mesh: Mesh, most: int = 8) -> list[Piece]:
    """The same as numbers of vertices of the mesh."""
    if isinstance(most, bool) or not isinstance(most, int | np.integer) or most < 3:
        raise invalid_setting(f"Convex pieces have at least 3 vertices, so most must be at least 3, not {most!r}.")
    tiles = triangulate(mesh)
    triangles: list[Piece] = tiles.triangles.tolist()
    owner = {(a, b): k for k, t in enumerate(triangles) for a, b in zip(t, [*t[1:], t[0]], strict=True)}
    diagonals = [(a, b) for a, b in owner if a < b and (b, a) in owner]
    ends = tiles.vertices[np.array(diagonals, dtype=np.int64).reshape(-1, 2)]
    longest_first = np.argsort(-np.hypot(*(ends[:, 1] - ends[:, 0]).T), kind="stable")
    order = [diagonals[k] for k in longest_first.tolist()]
    places: list[tuple[float, float]] = [(float(x), float(y)) for x, y in tiles.vertices]
    rng = random.Random(0)
    best = _merged(triangles, owner, order, places, most)
    for _ in range(min(ORDERS - 1, max(MAX_DIAGONALS // max(len(order), 1), 1))):
        rng.shuffle(order)
        best = min(best, _merged(triangles, owner, order, places, most), key=len)
    return best


def _merged(
    triangles: list[Piece],
    owner: dict[tuple[int, int], int],
    order: list[tuple[int, int]],
    places: list[tuple[float, float]],
    most: int,
) -> list[Piece]:
    """The pieces after removing diagonals in a given order, wherever possible."""
    pieces: list[Piece | None] = list(triangles)
    into = list(range(len(triangles)))

    def root(k: int) -> int:
        while into[k] != k:
            into[k] = into[into[k]]
            k = into[k]
        return k

    for a, b in order:
        one, other = root(owner[a, b]), root(owner[b, a])
        p, q = pieces[one], pieces[other]
        if one == other or p is None or q is None or len(p) + len(q) - 2 > most:
            continue
        i, j = p.index(b), q.index(a)
        ring = p[i:] + p[:i]  # b ... a
        rest = q[j:] + q[:j]  # a ... b
        together = ring[:-1] + rest[:-1]
        if _turns_left(together, ring[0], places) and _turns_left(together, rest[0], places):
            pieces[one], pieces[other], into[other] = together, None, one
    return [piece for piece in pieces if piece is not None]


def _turns_left(piece: Piece, vertex: int, places: list[tuple[float, float]]) -> bool:
    """Whether a piece is convex or straight at a vertex; exact."""
    k = piece.index(vertex)
    return orientation_sign(*places[piece[k - 1]], *places[vertex], *places[piece[(k + 1) % len(piece)]]) >= 0
