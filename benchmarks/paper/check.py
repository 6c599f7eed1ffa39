"""Each peer on a tiny case with a known value."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec

import numpy as np
import shapely

from common import FAILED, Options, table
from nestedcages_core import Mesh, as_published
from nestedcages_core.contact.ccd import impacts
from nestedcages_core.contact.pairs import Bodies, Pairs, find_pairs
from paper.li_2020 import SquaredBarrier, StiffnessBounds
from paper.methods import CONTACTS, NESTED_CAGES_2015, alone, letter_a, letter_a_coarse, measured
from paper.sacht_2015 import SEPARATION_RATE, Impulses, InelasticZones, SachtFlow
from paper.sellan_2022 import edge_collapse, level_set
from paper.table1 import optimum
from peers import solid
from shapes import annulus, divided, ring


def check(options: Options) -> str:
    tests = [test for source in (flow, impulses, barrier, coarse_meshes, cages) for test in source()]
    return table(("check", ""), [(name, "good" if good else FAILED) for name, good in tests])


Test = tuple[str, bool]


def flow() -> Iterator[Test]:
    fine, coarse = letter_a(), letter_a_coarse()
    result = SachtFlow().run(fine, coarse, tick=lambda done: None)
    moved = np.hypot(*np.diff(result.steps, axis=0).transpose(2, 0, 1))
    side = float(np.ptp(np.concatenate([fine.vertices, coarse.vertices]), axis=0).max())
    yield (
        "2015: a step of the flow is at most a thousandth of the longest side",
        moved.max() <= 1e-3 * side * (1 + 1e-12),
    )
    yield "2015: the flow ends inside", solid(coarse).contains_properly(shapely.MultiPoint(result.steps[-1]))


def under_an_edge(*points: tuple[float, float]) -> tuple[Pairs, np.ndarray, list[int]]:
    """A square cage of side 2, fine vertices inside, and all pairs; the upper edge runs from vertex 2 to 3."""
    cage = Mesh.from_loops([np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)])
    fine = Mesh.from_loops([np.array([*points, (-0.5, -0.5), (0.5, -0.5)])])
    x = np.concatenate([cage.vertices, fine.vertices])
    places = [int(np.flatnonzero((x == point).all(axis=1))[0]) for point in points]
    return find_pairs(Bodies.of(cage, fine), x, 4.0), x, places


def impulses() -> Iterator[Test]:
    t = 0.375  # of the upper edge, where x = 0.25
    pairs, x, (point,) = under_an_edge((0.25, 0.98))
    wished = np.zeros_like(x)
    wished[point] = 0.0, 0.05
    v, done = Impulses(pairs, 4, 1e-3).collisions(x, wished, 1.0)
    met = (1 - t) * v[2, 1] + t * v[3, 1]
    shares = v[2, 1] / v[3, 1]
    good = done and np.isclose(met, 0.05) and np.isclose(shares, (1 - t) / t) and not v[:2].any()
    yield (
        "El Topo: a collision loses its normal velocity, shared by leverage",
        bool(good and (v[4:] == wished[4:]).all()),
    )
    pairs, x, _ = under_an_edge((0.25, 1.0 - 4e-4))
    v = Impulses(pairs, 4, 1e-3).apart(x, np.zeros_like(x), 1.0)
    gap = (1 - t) * v[2, 1] + t * v[3, 1]
    yield "El Topo: pairs that are too close separate slowly", bool(np.isclose(gap, SEPARATION_RATE * 6e-4))
    pairs, x, both = under_an_edge((0.5, 0.99), (-0.5, 0.99))
    wished = np.zeros_like(x)
    wished[both, 1] = 0.02, 0.04
    found, _ = InelasticZones(pairs, 4).nearest(x, wished, 1.0)
    free = found is not None and len(impacts(pairs, x, found, pairs.measure(x).distance, 1e-6)[0]) == 0
    yield "El Topo: a zone follows two speeds at once", bool(free and found[2, 1] < found[3, 1])
    pairs, x, three = under_an_edge((0.5, 0.99), (0.0, 0.99), (-0.5, 0.99))
    wished = np.zeros_like(x)
    wished[three, 1] = 0.05, 0.02, 0.05
    yield "El Topo: a zone of three collisions fails", InelasticZones(pairs, 4).nearest(x, wished, 1.0)[0] is None


def barrier() -> Iterator[Test]:
    """Derivatives next to finite differences and, where it is installed, to IPC Toolkit of the same authors."""
    cage, fine, random = Mesh.from_loops([ring(6, 1.2)]), Mesh.from_loops([ring(10)]), np.random.default_rng(0)
    bodies, d_hat = Bodies.of(cage, fine), 0.2
    x = np.concatenate([cage.vertices, fine.vertices]) + 0.01 * random.normal(size=(16, 2))
    pairs = find_pairs(bodies, x, 2.0 * d_hat)

    def at(points: np.ndarray) -> SquaredBarrier:
        return SquaredBarrier.at(points, pairs, d_hat)

    step, gradient, hessian = 1e-6 * np.eye(32), at(x).gradient().ravel(), at(x).hessian(projected=False).toarray()
    moved = [(x + e.reshape(-1, 2), x - e.reshape(-1, 2)) for e in step]
    slope = np.array([at(a).value - at(b).value for a, b in moved]) / 2e-6
    bend = np.array([(at(a).gradient() - at(b).gradient()).ravel() for a, b in moved]) / 2e-6
    yield "IPC: the gradient is that of the value", bool(np.allclose(gradient, slope, atol=1e-6 * abs(gradient).max()))
    yield "IPC: the Hessian is that of the gradient", bool(np.allclose(hessian, bend, atol=1e-5 * abs(hessian).max()))
    bounds = StiffnessBounds(1.0, 3.0)
    grown = [bounds.raised(1.0, {5: 2e-10}, {5: 1e-10}), bounds.raised(2.0, {5: 2e-10}, {5: 1e-10})]
    grown.append(bounds.raised(1.0, {5: 1e-10}, {5: 2e-10}))
    yield "IPC: the stiffness grows while close pairs come closer", grown == [2.0, 3.0, 1.0]
    if find_spec("ipctk"):
        import ipctk

        edges = np.stack([np.arange(16), bodies.successor], axis=1)
        mesh, potential, collisions = ipctk.CollisionMesh(0.0 * x, edges), ipctk.BarrierPotential(d_hat, 1.0), None
        mesh.can_collide = ipctk.make_static_obstacle_filter(6)
        collisions = ipctk.NormalCollisions()
        collisions.build(mesh, x, d_hat)
        theirs = potential(collisions, mesh, x), potential.hessian(collisions, mesh, x, ipctk.PSDProjectionMethod.CLAMP)
        same = np.isclose(at(x).value, theirs[0], rtol=1e-12)
        own = at(x).hessian(projected=True).toarray()
        yield (
            "IPC: value and Hessian are IPC Toolkit's",
            bool(same and np.allclose(own, theirs[1].toarray(), rtol=1e-9)),
        )


def coarse_meshes() -> Iterator[Test]:
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    found = edge_collapse(Mesh.from_loops([divided(square, [7, 5, 6, 4])]), 4)
    away = np.abs(found.vertices[:, None] - square).max(axis=2).min(axis=1)
    yield "edge collapse: a divided square is its corners, nearly", bool(away.max() < 0.02)
    around = level_set(letter_a(), 30)
    held = solid(around).contains_properly(solid(letter_a()))
    yield "2022, level sets: 30 vertices enclose the letter A", held and around.area < 1.6 * letter_a().area


def cages() -> Iterator[Test]:
    """Whole runs on a disc of Table 1, whose optimum is known in closed form."""
    fine, coarse = annulus(48), annulus(16)
    least = optimum(48)
    for name, contact in CONTACTS.items():
        one = measured(alone(contact, fine), fine, coarse, 60.0)
        yield f"{name}: certified on a disc, above the optimum", not one.failed and least < one.excess < 45.0
    one = measured(NESTED_CAGES_2015, fine, coarse, 60.0)
    yield "Nested Cages 2015: its final pass nears the optimum", not one.failed and least < one.excess < least + 2.0
    result = as_published(annulus(16), coarse)
    excess = 100.0 * (result.cage.area / annulus(16).area - 1.0)
    yield "2022 as written: the C++ program's 19.379 % on the first disc", abs(excess - 19.379204) < 1e-4
