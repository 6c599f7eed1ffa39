"""Contacts as constraints: derivatives by differences, corners, and what the pruning leaves out."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core import Mesh
from nestedcages_core.contact.linearisation import (
    Contacts,
    constraint_rows,
    distance_change,
    measure,
    resolve_corners,
)
from nestedcages_core.contact.pairs import Bodies, CandidateList, Pairs, find_pairs
from nestedcages_core.contact.pruning import not_implied
from nestedcages_core.tightening.quadratic_model import EdgeLoads, contact_curvature
from support.shapes import letter_a, letter_a_coarse, ring


@pytest.fixture
def around() -> tuple[Bodies, np.ndarray, Pairs]:
    """A letter inside a wider copy of its coarse outline: contacts of all kinds."""
    fine, coarse = letter_a(3), letter_a_coarse()
    bodies = Bodies.of(coarse, fine)
    rng = np.random.default_rng(4)
    cage = coarse.vertices + 0.05 * rng.normal(size=coarse.vertices.shape)
    x = np.concatenate([cage, fine.vertices])
    return bodies, x, find_pairs(bodies, x, 0.5)


def rows_as_matrix(bodies: Bodies, pairs: Pairs, contacts: Contacts) -> np.ndarray:
    """(K, 2m) from the groups of rows."""
    lines = []
    for group in constraint_rows(pairs, contacts):
        matrix = np.zeros((group.count, bodies.m, 2))
        for vertex, weight in zip(group.vertex, group.weight, strict=True):
            np.add.at(matrix, (np.arange(group.count), vertex), (weight * group.direction).T)
        lines.append(matrix.reshape(group.count, -1))
    return np.concatenate(lines)


def test_rows_are_the_derivatives_of_the_distances(around: tuple[Bodies, np.ndarray, Pairs]) -> None:
    bodies, x, pairs = around
    rng = np.random.default_rng(0)
    motion = np.zeros_like(x)
    motion[: bodies.m] = rng.normal(size=(bodies.m, 2))
    h = 1e-6
    difference = (measure(pairs, x + h * motion).distance - measure(pairs, x - h * motion).distance) / (2 * h)
    contacts = measure(pairs, x)
    smooth = np.abs(contacts.parameter - 0.5) < 0.5 - 1e-4
    smooth |= np.abs(contacts.parameter - 0.5) == 0.5
    far = contacts.distance > 1e-3
    slope = rows_as_matrix(bodies, pairs, contacts) @ motion[: bodies.m].ravel()
    np.testing.assert_allclose(slope[smooth & far], difference[smooth & far], atol=2e-6)
    np.testing.assert_allclose(distance_change(pairs, contacts, motion), slope, atol=1e-12)


def test_change_includes_the_motion_of_the_fine_mesh(around: tuple[Bodies, np.ndarray, Pairs]) -> None:
    _, x, pairs = around
    motion = np.random.default_rng(1).normal(size=x.shape)
    h = 1e-6
    difference = (measure(pairs, x + h * motion).distance - measure(pairs, x - h * motion).distance) / (2 * h)
    contacts = measure(pairs, x)
    smooth = contacts.on_line & (np.abs(contacts.parameter - 0.5) < 0.5 - 1e-3) & (contacts.distance > 1e-2)
    assert smooth.sum() > 50
    np.testing.assert_allclose(distance_change(pairs, contacts, motion)[smooth], difference[smooth], atol=1e-4)


def test_curvature_is_the_second_derivative_of_the_loaded_distances(
    around: tuple[Bodies, np.ndarray, Pairs],
) -> None:
    bodies, x, pairs = around
    rng = np.random.default_rng(2)
    contacts = measure(pairs, x)
    inner = np.zeros(len(pairs), bool)
    inner[pairs.fine_cage] = True
    inner &= contacts.on_line & (contacts.side > 0) & (np.abs(contacts.parameter - 0.5) < 0.45)
    pairs, contacts = pairs.take(inner), contacts.take(inner)
    z = rng.uniform(0.1, 1.0, len(pairs))
    loads = EdgeLoads.of(pairs, contacts, z, bodies.m)
    H = contact_curvature(bodies, x[: bodies.m], loads, 0.0).dense(bodies.m)
    direction = rng.normal(size=2 * bodies.m)
    step = np.zeros_like(x)
    step[: bodies.m] = direction.reshape(-1, 2)
    h = 1e-4
    values = [float(z @ measure(pairs, x + s * step).distance) for s in (-h, 0.0, h)]
    second = (values[0] - 2.0 * values[1] + values[2]) / h**2
    assert direction @ H @ direction == pytest.approx(-second, rel=1e-4, abs=1e-4)


def test_a_point_that_changes_sides_has_a_negative_distance() -> None:
    coarse = Mesh.from_loops([ring(4, 2.0)])
    fine = Mesh.from_loops([ring(3, 0.5)])
    bodies = Bodies.of(coarse, fine)
    x = np.concatenate([coarse.vertices, fine.vertices])
    pairs = find_pairs(bodies, x, 10.0)
    before = measure(pairs, x)
    outside = x.copy()
    outside[4:] += [1.5, 1.5]  # the whole triangle through the edge from vertex 0 to 1
    after = measure(pairs, outside, before.side)
    through = (pairs.start == 0) & (pairs.point >= 4)
    assert np.all(before.distance > 0.0)
    assert np.all(after.distance[through & after.on_line & before.on_line] < 0.0)


def pocket() -> tuple[Bodies, np.ndarray]:
    """A fine mesh with a round pocket, and a cage whose one vertex dips into it."""
    arc = np.linspace(-0.15 * np.pi, -0.85 * np.pi, 15)
    hollow = np.stack([0.8 * np.cos(arc), 0.6 + 0.8 * np.sin(arc)], axis=1)
    fine = Mesh.from_loops([np.concatenate([[[1.0, -1.0], [1.0, 0.6]], hollow, [[-1.0, 0.6], [-1.0, -1.0]]])])
    coarse = Mesh.from_loops([np.array([[1.5, -1.5], [1.5, 1.0], [0.02, -0.13], [-1.5, 1.0], [-1.5, -1.5]])])
    return Bodies.of(coarse, fine), np.concatenate([coarse.vertices, fine.vertices])


def test_a_vertex_may_slide_along_a_pocket_past_the_ends_of_its_edges() -> None:
    bodies, x = pocket()
    deep = int(np.argmin(np.abs(x[: bodies.m, 1] + 0.13)))
    pairs = find_pairs(bodies, x, 0.6)
    pairs, contacts = resolve_corners(bodies, pairs, measure(pairs, x), x, 0.0)
    touching = pairs.point == deep
    assert touching.sum() > 3 and contacts.on_line[touching].all()
    # the linear constraints are those of the lines of the fine edges: exact for every motion inside the pocket
    a, b = x[pairs.start[touching]], x[pairs.end[touching]]
    normal = np.stack([(b - a)[:, 1], -(b - a)[:, 0]], axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    for motion in ([0.3, 0.1], [-0.4, 0.2], [0.0, 0.5]):
        exact = ((x[deep] + motion - a) * normal).sum(axis=1)
        linear = contacts.distance[touching] + contacts.normal[touching] @ np.array(motion)
        np.testing.assert_allclose(linear, exact, atol=1e-12)


def test_pruning_keeps_what_implies_the_rest(around: tuple[Bodies, np.ndarray, Pairs]) -> None:
    bodies, x, pairs = around
    contacts = measure(pairs, x)
    pairs, contacts = resolve_corners(bodies, pairs, contacts, x, 0.0)
    room = contacts.distance.copy()
    keep = not_implied(pairs, contacts, room)
    assert 0 < keep.sum() < len(pairs)
    J = rows_as_matrix(bodies, pairs, contacts)
    rng = np.random.default_rng(3)
    checked = 0
    for _ in range(2000):
        motion = 0.03 * rng.normal() * rng.normal(size=2 * bodies.m)
        after = room + J @ motion
        if after[keep].min() >= 0.0:
            assert after.min() >= -1e-12
            checked += 1
    assert checked > 20


@pytest.mark.slow
def test_a_kept_list_has_all_pairs_that_may_meet(around: tuple[Bodies, np.ndarray, Pairs]) -> None:
    bodies, x, _ = around
    rng = np.random.default_rng(7)
    everything = find_pairs(bodies, x, np.inf)
    candidates = CandidateList(bodies, thinnest_skin=0.1)
    distance, longest, kept = 0.02, 0.05, 0
    for _ in range(40):
        step = 0.01 * rng.normal(size=(bodies.m, 2))
        x = np.concatenate([x[: bodies.m] + step, x[bodies.m :]])
        motion = np.concatenate([rng.uniform(0.0, longest, bodies.m), np.zeros(bodies.n)])
        found = candidates.meeting(x, distance, motion, distance + 2.0 * longest, longest)
        names = {tuple(corners) for corners in found.corners.tolist()}
        for angle in rng.uniform(0.0, 2.0 * np.pi, (20, len(x))):
            moved = x + motion[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
            met = measure(everything, moved).distance < distance
            assert names >= {tuple(corners) for corners in everything.corners[met].tolist()}
        kept += len(names)
    assert candidates.builds < 20
    assert kept < 0.2 * 40 * len(everything)
