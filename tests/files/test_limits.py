"""Every reader keeps every limit that applies to what it reads, to the last one of what is counted."""

import re
import tracemalloc
from collections.abc import Callable
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import Limits, Settings, collision_outline, from_svg, read_geojson, read_png, read_svg
from support.documents import collection, feature, png, refusal, svg
from support.sources import ROOT

SQUARES = [[[x, 0], [x + 2, 0], [x + 2, 2], [x, 2]] for x in (0, 5, 10)]
MAP = collection(*(feature([[*ring, ring[0]]]) for ring in SQUARES))
DRAWING = svg("".join(f'<path d="M{x} 0h2v2h-2z"/>' for x in (0, 5, 10))).encode()
CHESS = np.indices((6, 6)).sum(axis=0) % 2 == 0

PICTURE = png(CHESS)
COPIES = svg('<g id="a"><path d="M0 0h2v2h-2z"/></g><use href="#a" x="3"/><use href="#a" x="6"/>')

CASES: list[tuple[Callable[..., Any], Any, dict[str, int]]] = [
    (from_svg, DRAWING, {"bytes": len(DRAWING), "elements": 4, "points": 15}),
    (from_svg, COPIES, {"elements": 9}),
    *(
        (read, MAP, {"bytes": len(MAP), "elements": 3, "points": 15})
        for read in (core.from_geojson, core.features_from_geojson)
    ),
    (core.boundary_of_pixels, CHESS, {"points": 72}),
    (partial(collision_outline, vertices=12), CHESS.astype(float), {"points": 40}),
    (
        partial(collision_outline, vertices=6, padding=90.0, settings=Settings(loops="keep")),
        np.eye(6)[[0, 5]],
        {"pixels": 184 * 188},
    ),
    (read_svg, DRAWING, {"bytes": len(DRAWING)}),
    (read_geojson, MAP.encode(), {"bytes": len(MAP)}),
    (read_png, PICTURE, {"bytes": len(PICTURE), "pixels": 36}),
]


def exceeded(what: str, *work: Any, **options: Any) -> None:
    error = refusal(*work, **options)
    assert (error.code, error.data["what"]) == ("limit.exceeded", what)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(("read", "given", "used"), CASES)
def test_what_reaches_a_limit_is_read_and_one_more_is_not(
    read: Any, given: Any, used: dict[str, int], tmp_path: Path
) -> None:
    if read in (read_svg, read_geojson, read_png):
        (tmp_path / "given").write_bytes(given)
        given = tmp_path / "given"
    for what, number in used.items():
        assert read(given, limits=Limits(**{what: number})) is not None
        exceeded(what, read, given, limits=Limits(**{what: number - 1}))


@pytest.mark.parametrize("value", [0, -1, 1.5, True, None, 10**19, 10**400, "9"])
def test_limits_are_whole_numbers_that_fit(value: Any) -> None:
    for field in fields(Limits):
        assert refusal(Limits, **{field.name: value}).code == "file.invalid"


@pytest.mark.slow
def test_reading_ends_when_its_time_is_over() -> None:
    bars = "".join(f'<path d="M{k} 0h1v9000h-1zM0 {k}h9000v1h-9000z"/>' for k in range(0, 900, 2))
    exceeded("seconds", from_svg, svg(bars), limits=Limits(seconds=1))


@pytest.mark.slow
def test_points_of_curves_are_counted_before_they_take_memory() -> None:
    """Long arcs through a small drawing: they have 24 million chords."""
    arcs = " ".join(f"A1e5 1e-5 {k} 1 0 {k % 90} {k % 70}" for k in range(1000))
    tracemalloc.start()
    try:
        exceeded("points", from_svg, svg(f'<path d="M0 0{arcs}z"/>', 'viewBox="0 0 100 100"'))
        assert tracemalloc.get_traced_memory()[1] < 2**26
    finally:
        tracemalloc.stop()


def test_the_page_on_security_has_the_limits_that_there_are() -> None:
    page = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `(\w+)`(.*)$", page, re.MULTILINE))
    assert rows.keys() == {field.name for field in fields(Limits)}
    for name, row in rows.items():
        known = {"bytes": "128 MB", "pixels": "2²⁶"}.get(name, f"{getattr(Limits(), name):,}")
        assert row.split("|")[1].strip() == known
    assert (Limits().bytes, Limits().pixels) == (128 * 2**20, 2**26)
