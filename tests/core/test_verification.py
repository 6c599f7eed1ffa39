"""The certificate against shapely, exact fractions and the cases that other programs get wrong."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import shapely
import shapely.geometry
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core.errors import InvalidMeshError
from nestedcages_core.geometry.mesh import Mesh
from nestedcages_core.verification import Certificate, verify
from support.shapes import jagged, ring

polygon_of = shapely.geometry.shape


def square(half: float, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """An upright square, (4, 2)."""
    return np.array([[-half, -half], [half, -half], [half, half], [-half, half]]) + np.array(centre)


def mesh(*loops: np.ndarray) -> Mesh:
    return Mesh.from_loops(loops)


def is_one_sentence_each(certificate: Certificate) -> bool:
    return all(text[0].isupper() and text.endswith(".") for text in certificate.problems)


# Cages that hold


def test_a_square_in_a_square() -> None:
    certificate = verify(mesh(square(2.0)), mesh(square(1.0)), 1.0)
    assert certificate == Certificate(True, True, True, 1.0, 3.0, ())
    assert certificate.holds
    assert certificate


def test_holes_islands_and_components() -> None:
    fine = mesh(ring(40, 5.0), ring(30, 3.0), ring(20, 2.0), ring(10, 1.0), ring(9, 1.0, centre=(9.0, 0.0)))
    cage = mesh(ring(4, 1.6, centre=(9.0, 0.0)), ring(8, 2.2), ring(16, 5.5), ring(6, 2.9), ring(3, 0.9))
    certificate = verify(cage, fine)
    assert certificate.holds
    assert certificate.simple
    assert certificate.strict
    assert certificate.loops_kept
    assert certificate.excess == pytest.approx(polygon_of(cage).area / polygon_of(fine).area - 1)
    assert certificate.clearance == pytest.approx(polygon_of(cage).boundary.distance(polygon_of(fine).boundary))


def test_a_moved_cage_is_judged_where_it_is() -> None:
    fine, coarse = mesh(ring(50)), mesh(square(9.0))
    assert verify(coarse.moved(square(1.1)), fine).holds
    assert not verify(coarse.moved(square(0.9)), fine).strict


# Cages that do not


def expect(certificate: Certificate, sentence: str, **verdicts: bool) -> None:
    assert not certificate
    assert {name: getattr(certificate, name) for name in verdicts} == verdicts
    assert any(text.startswith(sentence) for text in certificate.problems), certificate.problems
    assert is_one_sentence_each(certificate)


def test_a_thin_ring_around_the_boundary_is_no_cage() -> None:
    cage, fine = mesh(ring(40, 1.01), ring(40, 0.99)), mesh(ring(40))
    expect(verify(cage, fine), "Loop 1 of the cage near (0.99, 0) lies inside the fine mesh", simple=True, strict=False)
    both = mesh(ring(40, 1.01), ring(40, 0.99), ring(40, 0.49), ring(40, 0.51))
    expect(verify(both, mesh(ring(40), ring(40, 0.5))), "Loop 1 of the cage", simple=True, strict=False)


def test_a_component_left_out_is_found() -> None:
    fine = mesh(ring(9), ring(9, 1.0, centre=(5.0, 0.0)))
    certificate = verify(mesh(ring(9, 1.5)), fine)
    expect(certificate, "Loop 1 of the fine mesh near (6, 0) lies outside the cage.", strict=False, loops_kept=False)
    decoy = verify(mesh(ring(9, 1.5), ring(9, 1.5, centre=(9.0, 0.0))), fine)
    expect(decoy, "Loop 1 of the fine mesh near (6, 0) lies outside", strict=False, loops_kept=False)


def test_a_component_in_a_hole_of_the_cage_is_outside() -> None:
    fine = mesh(ring(9, 1.0), ring(9, 5.0), ring(9, 3.0))
    cage = mesh(ring(9, 6.0), ring(9, 2.5))
    expect(verify(cage, fine), "Loop 0 of the fine mesh near (1, 0) lies outside the cage.", simple=True, strict=False)


def test_a_cage_inside_and_a_cage_beside() -> None:
    fine = mesh(ring(40))
    expect(verify(mesh(square(0.3)), fine), "Loop 0 of the fine mesh", simple=True, strict=False, loops_kept=False)
    expect(verify(mesh(square(0.3)), fine), "Loop 0 of the cage near (-0.3, -0.3) lies inside the fine mesh")
    expect(verify(mesh(square(2.0, (9.0, 9.0))), fine), "Loop 0 of the fine mesh near (1, 0) lies outside the cage.")


def test_a_covered_hole_is_strict_but_not_the_same_loops() -> None:
    cage, fine = mesh(square(2.0)), mesh(ring(40), ring(40, 0.5))
    expect(verify(cage, fine), "The cage has 1 outer loop and no holes, but", strict=True, loops_kept=False)
    relaxed = verify(cage, fine, same_loops=False)
    assert relaxed.holds
    assert not relaxed.loops_kept


def test_wrapped_components_are_strict_but_not_the_same_loops() -> None:
    fine = mesh(ring(9), ring(9, 1.0, centre=(5.0, 0.0)))
    cage = mesh(square(9.0))
    expect(verify(cage, fine), "The cage has 1 outer loop and no holes, but", strict=True, loops_kept=False)
    assert verify(cage, fine, same_loops=False).holds


def test_as_many_loops_in_other_places_are_not_kept() -> None:
    two = mesh(ring(9), ring(9, 1.0, centre=(5.0, 0.0)))
    wrapped = mesh(square(9.0), square(1.0, (20.0, 0.0)))
    expect(verify(wrapped, two), "Loop 0 of the fine mesh near (1, 0) matches no loop", strict=True, loops_kept=False)
    pierced = mesh(square(9.0), square(0.5, (2.5, 2.5)))
    expect(verify(pierced, two), "The cage has 1 outer loop and 1 hole, but", strict=True, loops_kept=False)
    beside = mesh(square(9.0), square(0.5, (5.0, 5.0)))
    expect(verify(beside, mesh(ring(40), ring(40, 0.5))), "Loop 1 of the cage", strict=True, loops_kept=False)
    apart = mesh(square(9.0), square(1.0, (20.0, 0.0)))
    sentence = "The cage has 2 outer loops and no holes, but the fine mesh has 1 outer loop and 1 hole."
    expect(verify(apart, mesh(ring(40), ring(40, 0.5))), sentence, strict=True, loops_kept=False)
    # an island alone in the fine hole and a cage's hole alone in a cage's loop; a cage's hole alone in the fine solid
    far = mesh(square(9.0), square(4.0, (20.0, 0.0)), square(3.0, (20.0, 0.0)))
    island = mesh(square(5.0), square(3.0), square(1.0))
    expect(verify(far, island), "Loop 2 of the cage near (17, -3) matches", strict=True, loops_kept=False)
    wide = mesh(square(9.0), square(2.0))
    expect(verify(wide, mesh(square(5.0), square(1.0))), "Loop 1 of the cage near", strict=False, loops_kept=False)
    # each hole of the fine mesh must have its own
    holes = mesh(square(9.0), square(1.0), square(1.0, (5.0, 0.0)))
    crowded = mesh(square(9.5), square(0.2, (-0.5, 0.0)), square(0.2, (0.5, 0.0)))
    expect(
        verify(crowded, holes), "Loop 1 of the cage near (-0.7, -0.2) matches no loop", strict=True, loops_kept=False
    )


def test_contact_is_found() -> None:
    fine = mesh(square(1.0))
    expect(verify(mesh(square(1.0)), fine), "The cage meets the fine mesh near", simple=True, strict=False)
    expect(verify(mesh(square(2.0, (1.0, 0.0))), fine), "The cage meets the fine mesh near (-1, ", strict=False)
    touching = np.array([[-9.0, -9.0], [9.0, -9.0], [1.0, 1.0], [-9.0, 9.0]])
    certificate = verify(mesh(touching), fine)
    expect(certificate, "The cage meets the fine mesh near (1, 1)", simple=True, strict=False, loops_kept=False)
    assert certificate.clearance == 0.0
    crossed = verify(mesh(np.array([[-9.0, -9.0], [0.0, -9.0], [0.0, 9.0], [-9.0, 9.0]])), fine).problems[0]
    assert crossed.data["vertices"] in ((1, 2, 0, 1), (1, 2, 2, 3))
    assert (crossed.code, verify(fine, fine.moved(square(3.0)), 0.1).problems[0].code) == (
        "cage.meets",
        "cage.leaves_out",
    )


def test_a_cage_that_crosses_itself() -> None:
    coarse = mesh(square(3.0))
    certificate = verify(coarse.moved(square(3.0)[[0, 2, 1, 3]]), mesh(ring(9)))
    expect(certificate, "The cage is not a valid mesh: Loop 0 crosses itself near (0, 0)", simple=False, strict=False)
    assert math.isnan(certificate.clearance)


def test_a_cage_turned_inside_out() -> None:
    coarse = mesh(square(3.0))
    certificate = verify(coarse.moved(square(3.0)[::-1]), mesh(ring(9)))
    expect(certificate, "Loop 0 of the cage near (-3, 3) is turned inside out.", strict=True, loops_kept=False)
    assert not verify(coarse.moved(square(3.0)[::-1]), mesh(ring(9)), same_loops=False).holds


def test_loops_that_change_roles() -> None:
    coarse = mesh(square(3.0), square(0.2))
    swapped = coarse.moved(np.concatenate((square(0.2), square(3.0)[::-1])))
    certificate = verify(swapped, mesh(ring(9), ring(9, 0.5)))
    expect(certificate, "Loop 0 of the cage near (-0.2, -0.2) is turned inside out.", simple=True, loops_kept=False)


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e200])
def test_numbers_that_are_none(value: float) -> None:
    coarse, fine = mesh(square(3.0)), mesh(ring(9))
    broken = square(3.0)
    broken[2, 1] = value
    certificate = verify(coarse.moved(broken), fine)
    expect(certificate, "The cage is not a valid mesh: Vertex 2", simple=False, strict=False, loops_kept=False)
    assert certificate.problems[0].code == "cage.invalid"
    inner = ring(9)
    inner[2, 1] = value
    certificate = verify(coarse, fine.moved(inner))
    expect(certificate, "The fine mesh is not a valid mesh: Vertex 2", simple=True, strict=False, loops_kept=False)
    assert certificate.problems[0].code == "fine.invalid"


def test_a_fine_mesh_that_crosses_itself() -> None:
    fine = mesh(square(1.0))
    certificate = verify(mesh(square(3.0)), fine.moved(square(1.0)[[0, 2, 1, 3]]))
    expect(certificate, "The fine mesh is not a valid mesh: Loop 0 crosses itself", simple=True, strict=False)


# Clearance


def test_clearance_is_asked_for_to_a_billionth() -> None:
    cage, fine = mesh(square(2.0)), mesh(square(1.0))
    assert verify(cage, fine, 1.0 + 5e-10).holds
    certificate = verify(cage, fine, 1.0 + 2e-9)
    expect(certificate, "The cage comes as near as 1 to the fine mesh; 1 is asked for.", simple=True, strict=True)
    assert certificate.loops_kept
    expect(verify(cage, fine, float("nan")), "The cage comes as near as 1 to the fine mesh; nan is asked for.")


@pytest.mark.parametrize("seed", range(12))
def test_clearance_against_shapely(seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = mesh(jagged(random, int(random.integers(5, 2000))))
    cage = mesh(ring(int(random.integers(5, 300)), random.uniform(1.3, 3.0)))
    expected = polygon_of(cage).boundary.distance(polygon_of(fine).boundary)
    for a, b in ((cage, fine), (fine, cage)):
        assert verify(a, b).clearance == pytest.approx(expected, rel=1e-12)


def test_cages_at_a_constant_distance_are_measured() -> None:
    angle = np.linspace(0, 2 * np.pi, 5000, endpoint=False)[:, None]
    circle = np.concatenate((np.cos(angle), np.sin(angle)), axis=1)
    assert verify(mesh(1.001 * circle), mesh(circle)).clearance == pytest.approx(1e-3, rel=1e-3)


# Exactness


def test_one_double_decides() -> None:
    a, b, c = (Fraction(x) for x in (0.1, 0.7, 1.3))
    cage = mesh(np.array([[0.1, 0.1], [1.3, 0.7], [0.3, 1.9]]))
    verdicts = []
    for share in np.linspace(0.05, 0.95, 60):
        x = 0.1 + share * 1.2
        height = a + (Fraction(x) - a) * (b - a) / (c - a)  # of the lower edge at x, exactly
        y = float(height)
        for corner in (np.nextafter(y, -1.0), y, np.nextafter(y, 9.0)):
            fine = mesh(np.array([[x, corner], [0.5, 0.9], [0.45, 0.9]]))
            certificate = verify(cage, fine)
            assert certificate.strict == (Fraction(float(corner)) > height)
            verdicts.append(certificate.strict)
    assert len(set(verdicts)) == 2


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1))
@settings(max_examples=150, deadline=None)
def test_random_pairs_against_shapely(seed: int) -> None:
    random = np.random.default_rng(seed)

    def shape(size: float) -> Mesh:
        loops = [jagged(random, int(random.integers(8, 40))) * size]
        if random.random() < 0.6:
            loops.append(jagged(random, int(random.integers(3, 20))) * size * random.uniform(0.1, 0.25))
        if random.random() < 0.3:
            loops.append(jagged(random, 5) * 0.3 + np.array([size * 1.4, 0.0]))
        return mesh(*loops)

    fine, cage = shape(1.0), shape(random.uniform(0.5, 5.0))
    inner, outer = polygon_of(fine), polygon_of(cage)
    certificate = verify(cage, fine)
    assert certificate.strict == outer.contains_properly(inner)
    assert certificate.simple
    assert certificate.excess == pytest.approx(outer.area / inner.area - 1)
    assert certificate.clearance == pytest.approx(outer.boundary.distance(inner.boundary), rel=1e-9, abs=1e-12)
    if certificate.strict:
        between = outer.difference(inner)
        rings = [between] if between.geom_type == "Polygon" else list(between.geoms)
        kept = len(rings) == len(fine.loops) and all(len(part.interiors) == 1 for part in rings)
        assert certificate.loops_kept == (kept and len(cage.loops) == len(fine.loops))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["outer", "hole"])
def test_strict_pairs_occur(kind: str) -> None:
    random = np.random.default_rng(3)
    for _ in range(30):
        fine_loop = jagged(random, 30)
        loops = [fine_loop] if kind == "outer" else [fine_loop, 0.3 * fine_loop]
        grown = shapely.geometry.mapping(polygon_of(mesh(*loops)).buffer(0.02, join_style="mitre"))
        cage = Mesh.from_geometry(grown)
        certificate = verify(cage, mesh(*loops), 0.02 * (1 - 1e-6))
        assert certificate.holds, certificate.problems


@pytest.mark.parametrize("exponent", [-450, -60, -1, 1, 60, 450])
def test_the_verdict_does_not_depend_on_the_unit(exponent: int) -> None:
    random = np.random.default_rng(abs(exponent))
    inner, outer = [jagged(random, 50), 0.3 * jagged(random, 20)], [ring(7, 1.3), 0.05 * ring(5)]
    for cage in (outer, [ring(7, 0.9), 0.05 * ring(5)], outer[:1]):
        here = verify(mesh(*cage), mesh(*inner))
        there = verify(mesh(*(np.ldexp(p, exponent) for p in cage)), mesh(*(np.ldexp(p, exponent) for p in inner)))
        assert (here.simple, here.strict, here.loops_kept) == (there.simple, there.strict, there.loops_kept)
        assert there.clearance == math.ldexp(here.clearance, exponent)
        assert there.excess == here.excess


@pytest.mark.slow
def test_crowded_pairs_are_no_trouble() -> None:
    random = np.random.default_rng(5)
    spikes = jagged(random, 10_000)
    certificate = verify(mesh(1.001 * spikes), mesh(spikes))
    assert certificate.strict == polygon_of(mesh(1.001 * spikes)).contains_properly(polygon_of(mesh(spikes)))
    scribble = mesh(ring(10_000)).moved(random.uniform(-1, 1, size=(10_000, 2)))
    expect(verify(scribble, mesh(ring(9))), "The cage is not a valid mesh: Loop 0 crosses itself", simple=False)


def test_anything_that_describes_a_shape_can_be_verified() -> None:
    cage, fine = Mesh.from_loops([ring(16), ring(16, 0.4)]), Mesh.from_loops([0.9 * ring(16), 0.5 * ring(16)])
    wanted = verify(cage, fine)
    assert wanted
    for read in (
        polygon_of,
        lambda mesh: mesh.__geo_interface__,
        lambda mesh: [mesh.vertices[k] for k in mesh.loops],
    ):
        found = verify(read(cage), read(fine))
        assert (found.holds, found.clearance, found.excess) == (True, wanted.clearance, pytest.approx(wanted.excess))
    crossed = verify([[(0, 0), (1, 1), (1, 0), (0, 1)]], fine)
    assert not crossed.simple
    assert "The cage is not a valid mesh: Loop 0 crosses itself" in crossed.problems[0]


@pytest.mark.parametrize("thing", [None, 5, "square", Mesh, {1, 2}, object()])
def test_what_is_no_shape_is_rejected(thing: object) -> None:
    for pair in ((thing, [ring(8)]), ([ring(8)], thing)):
        with pytest.raises(
            InvalidMeshError,
            match=r"must be a Mesh, an object with __geo_interface__, an array \(k, 2\), or a list of loops",
        ):
            verify(*pair)  # type: ignore[arg-type]
