"""Every reader keeps every limit that applies to what it reads, to the last one of what is counted."""

from __future__ import annotations

import re
import tracemalloc
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nestedcages_core import (
    Limits,
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
    read_svg,
    to_engine_json,
)
from support.documents import collection, feature, svg
from support.sources import ROOT

SQUARES = [[[x, 0], [x + 2, 0], [x + 2, 2], [x, 2]] for x in (0, 5, 10)]
MAP = collection(*(feature([[*ring, ring[0]]]) for ring in SQUARES))
OUTLINE = to_engine_json(Mesh.from_loops(SQUARES))
DRAWING = svg("".join(f'<path d="M{x} 0h2v2h-2z"/>' for x in (0, 5, 10))).encode()
CHESS = np.indices((6, 6)).sum(axis=0) % 2 == 0

CASES: list[tuple[Callable[..., Any], Any, dict[str, int]]] = [
    (from_svg, DRAWING, {"bytes": len(DRAWING), "elements": 4, "points": 15}),
    (from_geojson, MAP, {"bytes": len(MAP), "elements": 3, "points": 15}),
    (features_from_geojson, MAP, {"bytes": len(MAP), "elements": 3, "points": 15}),
    (from_engine_json, OUTLINE, {"bytes": len(OUTLINE), "elements": 3, "points": 12}),
    (boundary_of_pixels, CHESS, {"points": 72}),
    (lambda given, limits: collision_outline(given, 12, limits=limits), CHESS.astype(float), {"points": 40}),
    (
        lambda given, limits: collision_outline(given, 6, padding=90.0, limits=limits, settings=Settings(loops="keep")),
        np.eye(6)[[0, 5]],
        {"pixels": 184 * 188},
    ),
]


def refused(work: Callable[[], Any], what: str) -> None:
    with pytest.raises(NestedCagesError) as caught:
        work()
    assert (caught.value.code, caught.value.data["what"]) == ("limit.exceeded", what)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(("read", "given", "used"), CASES)
def test_what_reaches_a_limit_is_read_and_one_more_is_not(read: Any, given: Any, used: dict[str, int]) -> None:
    for what, number in used.items():
        assert read(given, limits=Limits(**{what: number})) is not None
        refused(lambda what=what, number=number: read(given, limits=Limits(**{what: number - 1})), what)


@pytest.mark.parametrize(
    ("ending", "content", "read"), [(".svg", DRAWING, read_svg), (".geojson", MAP.encode(), read_geojson)]
)
def test_files_are_read_no_further_than_the_limit(ending: str, content: bytes, read: Any, tmp_path: Path) -> None:
    file = tmp_path / f"given{ending}"
    file.write_bytes(content)
    assert read(file, limits=Limits(bytes=len(content))).area == 12.0
    refused(lambda: read(file, limits=Limits(bytes=len(content) - 1)), "bytes")


@pytest.mark.parametrize("value", [0, -1, 1.5, True, None, 10**19, 10**400, "9"])
def test_limits_are_whole_numbers_that_fit(value: Any) -> None:
    with pytest.raises(NestedCagesError) as caught:
        Limits(bytes=value)
    assert caught.value.code == "file.invalid"


def test_points_of_curves_are_counted_before_they_take_memory() -> None:
    """Long arcs through a small drawing: they have 24 million chords."""
    arcs = " ".join(f"A1e5 1e-5 {k} 1 0 {k % 90} {k % 70}" for k in range(1000))
    tracemalloc.start()
    try:
        refused(lambda: from_svg(svg(f'<path d="M0 0{arcs}z"/>', 'viewBox="0 0 100 100"')), "points")
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
