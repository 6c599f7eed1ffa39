"""Edges along certain directions, exactly; with symmetries, in motion, around and inside."""

import numpy as np
import pytest

from nestedcages_core import (
    AxisAligned,
    LoopClearance,
    Mesh,
    Mirror,
    NestedCagesError,
    Rotation,
    animated_cages,
    check,
    inner_cages,
    nested_cages,
    verify,
)
from support.marks import slow_after
from support.shapes import annulus, letter_a, ring

FLOWER = Mesh.from_loops([ring(120) * (1.0 + 0.3 * np.sin(5.0 * np.linspace(0.0, 2.0 * np.pi, 120, False)))[:, None]])
"""Petals and bays, with a mirror at the y axis."""

TRANSIT = (0.0, 45.0, 90.0, 135.0)


def off_axes(cage: Mesh) -> float:
    """The most that an edge is off both axes."""
    return float(np.abs(cage.edge_ends - cage.vertices).min(axis=1).max())


@pytest.mark.parametrize("count", slow_after(1, [12, 4, 28, 40]))
@pytest.mark.parametrize("fine", [FLOWER, letter_a(), annulus(60)], ids=["flower", "letter", "ring"])
def test_edges_are_exactly_along_the_axes(fine: Mesh, count: int) -> None:
    level = nested_cages(fine, max(count, 4 * len(fine.loops)), constraints=[AxisAligned()])[0]
    lost = level.report.lost
    assert verify(level.cage, fine, same_loops=not any(lost)).lost == lost
    assert check(fine, level) and off_axes(level.cage) == 0.0
    for steps in level.reinflation.cage_steps:
        assert off_axes(level.cage.moved(steps)) == 0.0


@pytest.mark.slow
def test_more_vertices_make_them_tighter() -> None:
    excess = [nested_cages(FLOWER, count, constraints=[AxisAligned()])[0].excess for count in (4, 12, 20, 28, 40)]
    assert excess == sorted(excess, reverse=True) and excess[-1] < 0.15


def test_four_vertices_are_the_bounding_box() -> None:
    level = nested_cages(FLOWER, 4, constraints=[AxisAligned()])[0]
    assert level.cage.area == pytest.approx(float(np.prod(np.ptp(FLOWER.vertices, axis=0))), rel=1e-3)


@pytest.mark.parametrize("degrees", [TRANSIT, (0.0, 60.0, 120.0), (20.0, 110.0)])
def test_edges_may_have_other_directions(degrees: tuple[float, ...]) -> None:
    level = nested_cages(FLOWER, 20, constraints=[AxisAligned(degrees)], stored=np.float32)[0]
    edge = level.cage.edge_ends - level.cage.vertices
    turned = np.degrees(np.arctan2(edge[:, 1], edge[:, 0]))[:, None] - degrees
    assert np.abs((turned + 90.0) % 180.0 - 90.0).min(axis=1).max() < 1e-3
    assert verify(level.cage, FLOWER)


@pytest.mark.parametrize(
    ("symmetry", "exact"), [(Mirror((0.0, 0.0), (0.0, 1.0)), True), (Rotation((0.0, 0.0), 4), False)]
)
def test_symmetric_cages_keep_directions(symmetry: Mirror | Rotation, exact: bool) -> None:
    fine = Mesh.from_loops([ring(120) * (1.0 + 0.2 * np.cos(4.0 * np.linspace(0.0, 2.0 * np.pi, 120, False)))[:, None]])
    cage = nested_cages(fine, 20, constraints=[AxisAligned()], symmetry=symmetry)[0].cage
    assert off_axes(cage) <= (0.0 if exact else 1e-15)
    image = symmetry.image(cage.vertices)
    assert (np.abs(image[:, None] - cage.vertices).max(axis=2).min(axis=1) == 0.0).all()


@pytest.mark.slow
def test_each_level_and_the_side_within_keep_directions() -> None:
    for level in nested_cages(FLOWER, [40, 16], constraints=[AxisAligned(TRANSIT), LoopClearance(outer=0.02)]):
        assert AxisAligned(TRANSIT).fault(level.cage, FLOWER) is None
        assert level.report.clearance >= 0.02 * (1.0 - 1e-9)
    inner = inner_cages(FLOWER, 20, constraints=[AxisAligned()])[0]
    assert verify(FLOWER, inner.cage) and off_axes(inner.cage) == 0.0


@pytest.mark.slow
def test_moving_cages_keep_directions_at_every_key() -> None:
    poses = np.stack([FLOWER.vertices * (1.0 + 0.05 * t) + [0.03 * t * t, 0.1 * t] for t in range(4)])
    level = animated_cages(FLOWER, poses, 16, constraints=[AxisAligned()]).levels[0]
    assert max(off_axes(level.cage.moved(cage)) for cage in level.cage_steps) == 0.0


def test_own_meshes_are_kept_if_they_have_the_directions() -> None:
    square = Mesh.from_loops([[(-1.5, -1.5), (1.5, -1.5), (1.5, 1.5), (-1.5, 1.5)]])
    assert off_axes(nested_cages(FLOWER, [square], constraints=[AxisAligned()], fallback=None)[0].cage) == 0.0
    skew = square.moved(square.vertices + 0.1 * (np.arange(8) == 1).reshape(4, 2))
    with pytest.raises(NestedCagesError, match="along an axis") as caught:
        nested_cages(FLOWER, [skew], constraints=[AxisAligned()], fallback=None)
    assert caught.value.code == "edges.not_aligned"
    wish = nested_cages(FLOWER, [skew], constraints=[AxisAligned(must=False)])[0]
    assert "edges.not_aligned" in [note.code for note in wish.report.notes]


def test_what_cannot_be_is_an_error_with_a_code() -> None:
    with pytest.raises(NestedCagesError) as caught:
        nested_cages(FLOWER, 3, constraints=[AxisAligned()])
    assert caught.value.code == "edges.not_aligned"
    with pytest.raises(NestedCagesError) as caught:
        nested_cages(FLOWER, 20, constraints=[AxisAligned(), AxisAligned((30.0, 120.0))])
    assert caught.value.code == "edges.not_aligned"
    for degrees in ((0.0,), (0.0, 180.0), (0.0, 3.0), ("a", 1.0), 7.0, (0.0, np.nan)):
        with pytest.raises(NestedCagesError, match="AxisAligned: degrees must be"):
            AxisAligned(degrees)
