"""Equalities of motions are eliminated: the program in fewer unknowns is the program, and its motions keep them."""

import numpy as np
import pytest

from nestedcages_core import Mesh, Mirror
from nestedcages_core.energies import Blocks
from nestedcages_core.geometry.arrays import FloatArray
from nestedcages_core.geometry.group import Orbits
from nestedcages_core.solver.banded import Rows
from nestedcages_core.solver.elimination import Elimination
from nestedcages_core.solver.quadratic_program import InteriorPoint, QuadraticProgram

HOUSE = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.5), (-1.0, 1.0)]
STAIRS = [(0.0, 0.0), (1.0, 0.0), (3.0, 0.0), (3.0, 1.0), (2.0, 2.0), (2.0, 3.0), (0.0, 3.0)]
CROSS = [(-1, -3), (1, -3), (1, -1), (3, -1), (3, 1), (2, 1), (1, 2), (1, 3), (0, 3), (-1, 3), (-1, 2), (-2, 1)]
CROSS += [(-3, 1), (-3, -1), (-1, -1)]


def tangents_of(mesh: Mesh) -> FloatArray:
    """(m, 2) unit tangents of the edges."""
    edge = mesh.edge_ends - mesh.vertices
    return edge / np.hypot(*edge.T)[:, None]


def orbits_of(mesh: Mesh) -> Orbits:
    """Those of the mirror at the y axis."""
    orbits = Orbits.of(mesh.vertices, mesh.successor, Mirror(), 1e-9)
    assert orbits is not None
    return orbits


def elimination_of(name: str) -> tuple[Mesh, Elimination]:
    """A mesh and its unknowns: of its images, of its fixed edges, of some fixed edges, of both."""
    mesh = Mesh.from_loops([{"images": HOUSE, "both": CROSS}.get(name, STAIRS)])
    fixed = np.ones(len(mesh.vertices), bool)
    if name == "some lines":
        fixed[list(FREE)] = False
    images = Elimination.of_images(orbits_of(mesh), mesh.successor) if name in ("images", "both") else None
    if name == "images":
        assert images is not None
        return mesh, images
    return mesh, Elimination.of_lines(tangents_of(mesh), fixed, mesh.successor, images)


FREE = (1, 3, 6)
"""Edges without a fixed direction, in one case."""

NAMES = ("images", "lines", "some lines", "both")


def dense(elimination: Elimination) -> FloatArray:
    """S, by the motions of single unknowns."""
    unknowns = np.eye(2 * len(elimination.first[0])).reshape(-1, len(elimination.first[0]), 2)
    return np.stack([elimination.motion(one).ravel() for one in unknowns], axis=1)


def equalities(name: str, mesh: Mesh) -> FloatArray:
    """(E, 2m) what motions keep: n · (D_b - D_a) = 0 of fixed edges a-b; D of an image is the image of D."""
    m, rows = len(mesh.vertices), []
    if name in ("images", "both"):
        orbits = orbits_of(mesh)
        for vertex, image in enumerate(orbits.partner.tolist()):
            for axis, sign in enumerate((-1.0, 1.0)):
                row = np.zeros((m, 2))
                row[vertex, axis] += sign
                row[image, axis] -= 1.0
                rows.append(row)
    if name != "images":
        for vertex in range(m):
            if name != "some lines" or vertex not in FREE:
                row = np.zeros((m, 2))
                (x, y), end = tangents_of(mesh)[vertex], mesh.successor[vertex]
                row[end], row[vertex] = (-y, x), (y, -x)
                rows.append(row)
    return np.array(rows).reshape(-1, 2 * m)


@pytest.mark.parametrize("name", NAMES)
def test_motions_are_all_that_keep_the_equalities(name: str) -> None:
    mesh, elimination = elimination_of(name)
    motions, equal = dense(elimination), equalities(name, mesh)
    assert np.allclose(equal @ motions, 0.0, atol=1e-12)
    assert np.linalg.matrix_rank(motions) == 2 * len(mesh.vertices) - np.linalg.matrix_rank(equal)
    motion = elimination.motion(np.random.default_rng(1).normal(size=(len(elimination.first[0]), 2)))
    assert np.allclose(elimination.scaled(motion, np.full(len(motion), 0.5)), 0.5 * motion, atol=1e-14)
    assert np.allclose(elimination.longest(motion), motion, atol=1e-14)
    reduced = elimination.scaled(motion, np.where(np.arange(len(motion)) == 2, 0.25, 1.0))
    assert np.allclose(equal @ reduced.ravel(), 0.0, atol=1e-12)
    assert np.allclose(reduced[2], 0.25 * motion[2])


@pytest.mark.parametrize("name", NAMES)
def test_a_program_is_that_of_the_whole_in_fewer_unknowns(name: str) -> None:
    """Energy and rows along motions S d, by finite differences of the quadratic model, which are exact."""
    mesh, elimination = elimination_of(name)
    rng, m = np.random.default_rng(0), len(mesh.vertices)
    blocks = Blocks(np.arange(m), mesh.successor, rng.normal(size=(m, 2, 2)))
    blocks = Blocks.sum([(1.0, blocks), (9.0, Blocks(np.arange(m), np.arange(m), np.tile(np.eye(2), (m, 1, 1))))])
    rows = Rows(np.stack([np.arange(m), mesh.successor]), rng.normal(size=(2, m)), rng.normal(size=(2, m)))
    axes = np.tile(np.eye(2), (m, 1, 1))
    program = QuadraticProgram(rng.normal(size=(m, 2)), blocks, [rows], np.full(m, 0.1), np.full(m, 0.5), axes)
    reduced, motions = elimination.program(program), dense(elimination)
    whole, unknowns = blocks.dense(m), motions.shape[1]

    def model(d: FloatArray) -> float:
        step = motions @ d
        return float(program.gradient.ravel() @ step + 0.5 * step @ whole @ step)

    steps = 0.5 * np.eye(unknowns)
    slope = np.array([model(step) - model(-step) for step in steps])
    curvature = [[model(a + b) - model(a - b) - model(b - a) + model(-a - b) for b in steps] for a in steps]
    assert np.allclose(slope, reduced.gradient.ravel())
    assert np.allclose(np.array(curvature), reduced.hessian.dense(unknowns // 2))
    (group,) = reduced.rows
    of_rows = np.zeros((m, unknowns))
    for k in range(m):
        for j, block in enumerate(group.vertex[:, k]):
            of_rows[k, 2 * block : 2 * block + 2] += group.weight[j, k] * group.directions[k, j]
    by_rows = np.zeros((m, 2 * m))
    for k in range(m):
        for vertex, weight in zip(rows.vertex[:, k], rows.weight[:, k], strict=True):
            by_rows[k, 2 * vertex : 2 * vertex + 2] += weight * rows.direction[:, k]
    assert np.allclose(by_rows @ motions, of_rows)
    step = elimination.solve(InteriorPoint(), program, 0.0).step
    assert np.allclose(equalities(name, mesh) @ step.ravel(), 0.0, atol=1e-12)
    assert (np.full(m, 0.1) + by_rows @ step.ravel() > -1e-6).all()
    assert np.hypot(*step.T).max() <= 0.5 * np.sqrt(2.0) + 1e-6
