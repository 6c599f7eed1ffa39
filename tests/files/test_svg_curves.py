"""Curves and strokes of drawings against themselves: points on them lie in what is read."""

import math

import numpy as np
import pytest
import shapely
from scipy.interpolate import BPoly

from nestedcages_core import from_svg
from support.documents import solid, svg

DEGREES = {"L": 1, "Q": 2, "C": 3}
ALONG = np.linspace(0.0, 1.0, 13)


def arc(here: np.ndarray, rng: np.random.Generator, scale: float) -> tuple[str, np.ndarray]:
    """Path data of an elliptical arc, and (13, 2) points on it."""
    (rx, ry), turn, begin, angle = rng.uniform(0.5, 8.0, 2) * scale, rng.uniform(0, 90), *rng.uniform(-6, 6, 2)
    t, c, s = begin + angle * ALONG, math.cos(math.radians(turn)), math.sin(math.radians(turn))
    around = np.stack((rx * np.cos(t), ry * np.sin(t)), axis=1) @ [(c, s), (-s, c)]
    points = around - around[0] + here
    return f"A{rx} {ry} {turn} {int(abs(angle) > math.pi)} {int(angle > 0)} {points[-1, 0]} {points[-1, 1]}", points


def random_path(rng: np.random.Generator, scale: float) -> tuple[str, list[np.ndarray]]:
    """Path data of wild curves with cusps, loops, arcs and a spike, and points on each from end to end."""
    first = here = rng.integers(-64, 64, 2) / 8.0 * scale
    data, curves = f"M{here[0]} {here[1]}", []
    for kind in [*rng.choice(["L", "Q", "C", "C", "A"], rng.integers(2, 8)), "L"]:
        if len(curves) == 1:
            spike = rng.integers(-64, 64, 2) / 8.0 * scale
            data += "L" + " ".join(map(str, [*spike.tolist(), *here.tolist()]))
            curves.append(np.vstack((here, spike)))
        if kind == "A":
            text, points = arc(here, rng, scale)
            data += text
        else:
            control = np.vstack((here, rng.integers(-64, 64, (DEGREES[kind], 2)) / 8.0 * scale))
            if kind == "C" and rng.random() < 0.3:
                control[1] = here if rng.random() < 0.5 else control[3]
            data += kind + " ".join(map(str, control[1:].ravel().tolist()))
            points = np.asarray(BPoly(control[:, None], [0.0, 1.0])(ALONG))
            points[-1] = control[-1]
        curves.append(points)
        here = points[-1]
    return data + "Z", [*curves, np.vstack((here, first))]


@pytest.mark.parametrize("seed", [*range(8), *(pytest.param(k, marks=pytest.mark.slow) for k in range(8, 24))])
def test_every_point_of_a_path_lies_in_what_it_fills(seed: int) -> None:
    data, curves = random_path(np.random.default_rng(seed), [1.0, 1e-5, 2.0**20][seed % 3])
    found = from_svg(svg(f'<path fill-rule="{["nonzero", "evenodd"][seed % 2]}" d="{data}"/>'))
    points = shapely.points(np.concatenate(curves))
    assert shapely.distance(solid(found), points).max() < 1e-12 * found.diagonal
    assert shapely.covers(solid(found), shapely.points(np.concatenate([curve[[0, -1]] for curve in curves]))).all()


@pytest.mark.parametrize("seed", range(6))
def test_points_of_ellipses_lie_in_them_and_not_in_what_is_read_for_inner_cages(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cx, cy, rx, ry = (rng.integers(8, 999, 4) / 8.0).tolist()
    hole = f"M{cx - rx / 2} {cy}A{rx / 2} {ry / 2} 0 1 0 {cx + rx / 2} {cy}A{rx / 2} {ry / 2} 0 1 0 {cx - rx / 2} {cy}"
    whole = f"M{cx - rx} {cy}A{rx} {ry} 0 1 {seed % 2} {cx + rx} {cy}A{rx} {ry} 0 1 {seed % 2} {cx - rx} {cy}"
    ring = svg(f'<path fill-rule="evenodd" d="{whole}{hole}"/>')
    covers, inside = solid(from_svg(ring)), solid(from_svg(ring, inside=True))
    angle = np.linspace(0.0, 7.0, 400)
    points = shapely.points([(cx + s * rx * math.cos(t), cy + s * ry * math.sin(t)) for s in (0.5, 1.0) for t in angle])
    assert shapely.covers(covers, points).all()
    assert not shapely.contains_properly(inside, points).any()
    assert covers.area == pytest.approx(inside.area, rel=0.02)


@pytest.mark.parametrize("turn", np.linspace(0.1, 3.0, 30))
def test_round_joins_are_covered_at_any_corner(turn: float) -> None:
    x, y, along = 10.0 * math.cos(turn), 10.0 * math.sin(turn), np.linspace(0.0, turn, 200)
    found = solid(from_svg(svg(f'<path fill="none" stroke="red" stroke-linejoin="round" d="M-9 0h9L{x} {y}"/>')))
    arc = 0.499999999 * np.stack((np.sin(along), -np.cos(along)), axis=1)
    assert shapely.covers(found, shapely.points(arc)).all()


MATRICES = [(1, 0, 0, 1, 0, 0), (-1, 0, 0, 2, 0, 0), (1, 0, 0.8, 1, 0, 0), (1e-3, 0, 5e-4, 2e-3, 9, 9)]


@pytest.mark.parametrize("seed", [*range(8), *(pytest.param(k, marks=pytest.mark.slow) for k in range(8, 32))])
def test_every_point_of_a_stroke_lies_in_what_is_read(seed: int) -> None:
    rng, (a, b, c, d, e, f) = np.random.default_rng(seed), MATRICES[seed % 4]
    curves = [rng.integers(-64, 64, (4, 2)) / 8.0]
    curves.append(np.vstack((curves[0][3], rng.integers(-64, 64, (3, 2)) / 8.0)))
    data = " ".join(map(str, np.vstack((curves[0], curves[1][1:])).ravel().tolist())).split(" ", 2)
    join, width = rng.choice(["miter", "round", "bevel"]), float(rng.choice([0.25, 1.0, 4.0]))
    style = (
        f'stroke-width="{width}" stroke-linecap="{rng.choice(["butt", "round", "square"])}" stroke-linejoin="{join}"'
    )
    path = f'<path fill="none" stroke="red" {style} d="M{data[0]} {data[1]}C{data[2]}"/>'
    found = solid(from_svg(svg(f'<g transform="matrix({a} {b} {c} {d} {e} {f})">{path}</g>')))
    t, points = np.linspace(0.0, 1.0, 200)[:, None], []
    for p in curves:
        along = 3.0 * ((1 - t) ** 2 * (p[1] - p[0]) + 2 * t * (1 - t) * (p[2] - p[1]) + t**2 * (p[3] - p[2]))
        on = (1 - t) ** 3 * p[0] + 3 * t * (1 - t) ** 2 * p[1] + 3 * t**2 * (1 - t) * p[2] + t**3 * p[3]
        normal = np.stack((-along[:, 1], along[:, 0]), axis=1) / np.hypot(*along.T)[:, None]
        points += [on + share * width * normal for share in (-0.5, 0.25, 0.5)]
    if join == "round":
        points.append(curves[1][0] + 0.5 * width * np.hstack((np.cos(7.0 * t), np.sin(7.0 * t))))
    where = np.concatenate(points) @ [(a, b), (c, d)] + (e, f)
    assert shapely.distance(found, shapely.points(where)).max() < 1e-11 * max(map(abs, found.bounds))


CUSPS = [(6, 6, 4.8, 8.4, 5.04, 7.2), (7, 7, 4.2, 9.1, 5.32, 6.3), (9, 9, 1.8, 9.9, 7.56, 2.7), (0, 6, 8, 10, 8, 10)]


@pytest.mark.parametrize("join", ["miter", "round", "bevel"])
@pytest.mark.parametrize("control", [*CUSPS, (0, 0, 4, 8, 8, 10)])  # two have handles of no length
def test_strokes_next_to_cusps_have_their_width(join: str, control: tuple[float, ...]) -> None:
    style = f'fill="none" stroke="red" stroke-width="2" stroke-linecap="round" stroke-linejoin="{join}"'
    drawing = svg(f'<path {style} d="M0 0C{" ".join(map(str, control))}"/>')
    covers, within = (solid(from_svg(drawing, inside=inside)) for inside in (False, True))
    curve = BPoly(np.reshape((0.0, 0.0, *control), (4, 1, 2)), [0.0, 1.0])
    true = shapely.LineString(curve(np.linspace(0.0, 1.0, 401))).buffer(1.0, quad_segs=16)
    assert covers.covers(true) and true.buffer(1e-3).covers(within)
    assert covers.area < 1.01 * true.area < 1.1 * within.area
