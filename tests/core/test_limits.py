"""Every reader keeps every limit that applies to what it reads, and stops with a sentence."""

from __future__ import annotations

import json
import re
import tracemalloc
from collections.abc import Callable
from dataclasses import fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from benchmarks.hostile.attacks import star_polygon, svg
from nestedcages_core import (
    Mesh,
    NestedCagesError,
    Settings,
    boundary_of_pixels,
    collision_outline,
    features_from_geojson,
    from_engine_json,
    from_geojson,
    from_svg,
    read_geojson,
    read_png,
    read_svg,
    to_engine_json,
)
from nestedcages_core.command import main
from nestedcages_core.exchange import (
    DRAWING_LIMITS,
    Limits,
    crossings,
    limits,
    read_map,
    svg_drawing,
)
from nestedcages_core.exchange.pictures import decode_png
from nestedcages_core.exchange.svg import selectors
from support.documents import png_of

SQUARES = [[[x, 0], [x + 2, 0], [x + 2, 2], [x, 2]] for x in (0, 5, 10)]
STAR = star_polygon(13)
"""Crosses itself 65 times."""

BARS = "".join(
    f'<rect x="{2 * k}" width="1" y="-1" height="9"/><rect x="-1" y="{2 * k}" height="1" width="9"/>' for k in (0, 1)
)
"""Outlines that cross each other 16 times."""


def polygons(rings: list[Any]) -> dict[str, Any]:
    return {"type": "MultiPolygon", "coordinates": [[[*ring, ring[0]]] for ring in rings]}


def path(points: list[Any]) -> str:
    return "M" + " ".join(f"{x} {y}" for x, y in points) + "Z"


def collection(rings: list[Any]) -> str:
    features = [{"type": "Feature", "properties": {}, "geometry": polygons([ring])} for ring in rings]
    return json.dumps({"type": "FeatureCollection", "features": features})


MESH = Mesh.from_loops(SQUARES)
MAP, CROSSED = collection(SQUARES), collection([STAR])
OVERLAPPING = collection([[[x, 0], [x + 2, 0], [x + 2, 2], [x, 2]] for x in (0, 1, 2)])
OUTLINE = to_engine_json(MESH)
DRAWING = svg("".join(f'<path d="{path(square)}"/>' for square in SQUARES))
PICTURE = png_of(np.full((4, 4, 4), 255, np.uint8))
CHESS = np.indices((6, 6)).sum(axis=0) % 2 == 0

KEEP = Settings(loops="keep")
Reader = Callable[[Any, Limits], Any]
CASES: list[tuple[Reader, Any, dict[str, int]]] = [
    (lambda given, limits: from_svg(given, limits=limits), DRAWING,
     {"bytes": len(DRAWING), "elements": 4, "points": 15}),
    (lambda given, limits: svg_drawing(given, limits=limits), svg(f'<polygon points="{path(STAR)[1:-1]}"/>'),
     {"points": 14, "seconds": 65}),
    (lambda given, limits: from_svg(given, limits=limits), svg(f'<path d="{path(STAR)}" fill="none" stroke="red"/>'),
     {"seconds": 65}),
    (lambda given, limits: from_svg(given, limits=limits), svg(BARS), {"seconds": 16}),
    (lambda given, limits: from_geojson(given, limits=limits), MAP, {"bytes": len(MAP), "elements": 3, "points": 15}),
    (lambda given, limits: from_geojson(given, limits=limits), OVERLAPPING, {"seconds": 4}),
    (lambda given, limits: features_from_geojson(given, limits=limits), MAP,
     {"bytes": len(MAP), "elements": 3, "points": 15}),
    (lambda given, limits: read_map(given, limits), CROSSED, {"seconds": 65}),
    (lambda given, limits: from_engine_json(given, limits=limits), OUTLINE,
     {"bytes": len(OUTLINE), "elements": 3, "points": 12}),
    (lambda given, limits: decode_png(given, limits=limits), PICTURE, {"bytes": len(PICTURE), "pixels": 16}),
    (lambda given, limits: boundary_of_pixels(given, limits=limits), CHESS, {"points": 72}),
    (lambda given, limits: collision_outline(given, 12, limits=limits), CHESS.astype(float), {"points": 40}),
    (lambda given, limits: collision_outline(given, 6, padding=90.0, limits=limits, settings=KEEP), np.eye(6)[[0, 5]],
     {"pixels": 184 * 188}),
]  # fmt: skip


@pytest.mark.filterwarnings("ignore::nestedcages_core.errors.NestedCagesWarning")
@pytest.mark.parametrize(("number", "name"), [(k, name) for k, case in enumerate(CASES) for name in case[2]])
def test_what_reaches_a_limit_is_read_and_one_more_is_not(
    number: int, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    read, given, used = CASES[number]
    for each in ("CROSSINGS_PER_SECOND", "SELF_CROSSINGS_PER_SECOND") if name == "seconds" else ():
        monkeypatch.setattr(limits, each, 1)
    for each in (
        "PAIRS_PER_SECOND",
        "MEETINGS_PER_SECOND",
        "NESTINGS_PER_SECOND",
    ):  # boxes that meet count parts of a second
        monkeypatch.setattr(crossings, each, np.inf)
    assert read(given, replace(Limits(), **{name: used[name]})) is not None
    with pytest.raises(NestedCagesError, match=f"raise the limit for {name}, or make the input smal"):
        read(given, replace(Limits(), **{name: used[name] - 1}))


def test_parts_of_a_second_count() -> None:
    quota = limits.Quota(Limits(seconds=1))
    quota.spend("seconds", 1.0)
    with pytest.raises(NestedCagesError, match="in the 1 seconds allowed"):
        quota.spend("seconds", 1e-3)


RECT, RED = "<rect width='1' height='1'/>", "{fill:red}"
TOO_LONG, TOO_DEEP = "selectors of the style sheets, .* take too long", "too deeply"


def chain(kind: str, link: str) -> str:
    """Clips or masks that are themselves clipped by the next one, 300 deep."""
    links = [f"<{kind} id='c{k}' {link}='url(#c{k + 1})'>{RECT}</{kind}>" for k in range(300)]
    return "".join(links) + f"<rect width='1' height='1' {link}='url(#c0)'/>"


def ring(k: int) -> str:
    """A square around the last one, closer than what is seen."""
    return "M{0} {0}H{1}V{1}H{0}z".format(-1e-6 * k, 1.0 + 1e-6 * k)


@pytest.mark.parametrize(
    ("sheet", "body", "fault"),
    [
        (f"*:not(*:nth-child(2n+1)) > * ~ *{RED}" * 60, RECT * 60, TOO_LONG),
        (f"*:not(*:nth-child(2n+1)) > * ~ *{RED}" * 60, RECT, None),
        (f"*:nth-of-type(2n+1):last-of-type:only-of-type{RED}" * 60, RECT * 200, TOO_LONG),
        (f"*:has(*:has(*:has(a))){RED}" * 30, "<g>" * 20 + RECT * 20 + "</g>" * 20, TOO_LONG),
        (",".join(["*[a]"] * 400) + RED, RECT * 300, TOO_LONG),
        ("*" + ":not([a])" * 1000 + RED, RECT * 100, TOO_LONG),
        (f"*{RED}" * 1200, RECT, TOO_LONG),
        ("a " * 400 + RED, RECT, TOO_DEEP),
        (":not(*:is(" * 100 + "a" + "))" * 100 + RED, RECT, TOO_DEEP),
        ("@media {" * 3000, RECT, TOO_DEEP),
        (f"[*|a]{RED} b::first-line{RED} ,{RED}", RECT, None),
        ("svg{" + "".join(f"--{a}:{f'var(--{b})' * 40};" for a, b in pairwise("abcdefghi")) + "fill:var(--a)}", RECT,
         "values of more than 100,000 characters"),
        ("", RECT * 400, None),
        ("", "".join(f"<path d='M{k} 0h9v9h-9z'/>" for k in range(60)), "the 10 seconds allowed"),
        ("", f"<path fill-rule='evenodd' d='{''.join(map(ring, range(500)))}'/>", "the 10 seconds allowed"),
        ("", "".join(f"<path d='{ring(k)}' fill='none' stroke='red'/>" for k in range(350)), "the 10 seconds allowed"),
        ("", f"<path d='{''.join(map(ring, range(201)))}'/>", None),
        ("", chain("clipPath", "clip-path"), TOO_DEEP),
        ("", chain("mask", "mask"), TOO_DEEP),
    ],
    ids=range(19),
)  # fmt: skip
def test_small_drawings_take_bounded_work(
    sheet: str, body: str, fault: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a fortieth of the budget."""
    monkeypatch.setattr(selectors, "MOST_WORK", selectors.MOST_WORK // 40)
    monkeypatch.setattr(crossings, "PAIRS_PER_SECOND", 100)
    for name in ("MEETINGS_PER_SECOND", "NESTINGS_PER_SECOND"):
        monkeypatch.setattr(crossings, name, 20_000)
    drawing = svg(f"<style>{sheet}</style>{body}")
    if fault is None:
        assert from_svg(drawing).area == pytest.approx(1.0, rel=1e-3)
        return
    with pytest.raises(NestedCagesError, match=fault):
        from_svg(drawing)


@pytest.mark.slow
def test_circles_may_cross_each_other_a_hundred_thousand_times() -> None:
    places = 1000.0 * np.random.default_rng(3).random((3200, 2))
    drawing = svg("".join(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="29"/>' for x, y in places))
    united = shapely.union_all(shapely.buffer(shapely.points(places.round(2)), 29.0, quad_segs=32))
    assert from_svg(drawing).area == pytest.approx(united.area, rel=1e-3)


@pytest.mark.parametrize("value", [0, -1, 1.5, True, None, 10**19, 10**400, "9"])
def test_limits_are_whole_numbers_that_fit(value: Any) -> None:
    with pytest.raises(NestedCagesError, match=r"bytes must be a whole number from 1 to 10+, not ") as raised:
        Limits(bytes=value)
    assert len(str(raised.value)) < 150


def test_every_limit_is_tried() -> None:
    assert {name for _, _, used in CASES for name in used} == {field.name for field in fields(Limits)}


def test_the_page_on_security_has_the_limits_that_there_are() -> None:
    page = (Path(__file__).resolve().parents[2] / "SECURITY.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `(\w+)`(.*)$", page, re.MULTILINE))
    assert rows.keys() == {field.name for field in fields(Limits)}
    for name, row in rows.items():
        for column, given in enumerate((Limits(), DRAWING_LIMITS)[: 1 if name == "pixels" else 2], 1):
            known = {"bytes": "128 MB", "pixels": "2²⁶"}.get(name, f"{getattr(given, name):,}")
            assert row.split("|")[column].strip() == known
    assert (Limits().bytes, Limits().pixels) == (128 * 2**20, 2**26)
    assert f"{selectors.MOST_WORK:,} visits" in page


@pytest.mark.parametrize(
    ("ending", "content", "read"),
    [(".svg", DRAWING, read_svg), (".geojson", MAP.encode(), read_geojson), (".png", PICTURE, read_png)],
)
def test_files_are_read_no_further_than_the_limit(ending: str, content: bytes, read: Any, tmp_path: Path) -> None:
    file = tmp_path / f"given{ending}"
    file.write_bytes(content)
    read(file, limits=Limits(bytes=len(content)))
    with pytest.raises(NestedCagesError, match="raise the limit for bytes"):
        read(file, limits=Limits(bytes=len(content) - 1))


def test_the_command_limits_drawings_as_the_reader_does(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "star.svg"
    file.write_bytes(svg(f'<path d="{path(STAR)}"/>'))
    assert main([str(file), "--levels", "12", "--limit", "points=13"]) == 1
    assert "more than the 13 points allowed" in capsys.readouterr().err
    assert main([str(file), "--levels", "12", "--limit", "points=14"]) == 0
    many = DRAWING_LIMITS.elements // 100
    file.write_bytes(svg('<g id="g">' + "<g/>" * many + "</g>" + '<use href="#g"/>' * 100))
    assert main([str(file), "--levels", "12"]) == 1
    assert f"more than the {DRAWING_LIMITS.elements:,} elements allowed" in capsys.readouterr().err


def test_points_of_curves_are_counted_before_they_take_memory() -> None:
    """Long arcs through a small drawing: they have 24 million chords."""
    arcs = " ".join(f"A1e5 1e-5 {k} 1 0 {k % 90} {k % 70}" for k in range(1000))
    tracemalloc.start()
    try:
        with pytest.raises(NestedCagesError, match="points allowed"):
            from_svg(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path d="M0 0{arcs}z"/></svg>')
        assert tracemalloc.get_traced_memory()[1] < 2**26
    finally:
        tracemalloc.stop()
