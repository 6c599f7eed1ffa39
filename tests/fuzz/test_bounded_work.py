"""Small drawings that ask for much work are refused, and busy ones that are drawings are read."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely

from nestedcages_core import Limits, NestedCagesError, from_svg
from support.documents import svg

pytestmark = pytest.mark.thorough

RECT, RED = "<rect width='1' height='1'/>", "{fill:red}"


def chain(kind: str, link: str) -> str:
    """Clips or masks that are themselves clipped by the next one, 300 deep."""
    links = [f"<{kind} id='c{k}' {link}='url(#c{k + 1})'>{RECT}</{kind}>" for k in range(300)]
    return "".join(links) + f"<rect width='1' height='1' {link}='url(#c0)'/>"


def ring(k: int) -> str:
    """A square around the last one, closer than what is seen."""
    return "M{0} {0}H{1}V{1}H{0}z".format(-1e-6 * k, 1.0 + 1e-6 * k)


REFUSED = [
    (f"*:not(*:nth-child(2n+1)) > * ~ *{RED}" * 400, RECT * 400),
    (f"*:nth-of-type(2n+1):last-of-type:only-of-type{RED}" * 400, RECT * 1300),
    (f"*:has(*:has(*:has(a))){RED}" * 200, "<g>" * 100 + RECT * 100 + "</g>" * 100),
    (",".join(["*[a]"] * 2500) + RED, RECT * 2000),
    ("*" + ":not([a])" * 6500 + RED, RECT * 650),
    (f"*{RED}" * 50_000, RECT * 10),
    ("a " * 400 + RED, RECT),
    (":not(*:is(" * 100 + "a" + "))" * 100 + RED, RECT),
    ("@media {" * 3000, RECT),
    ("svg{" + "".join(f"--{a}:{f'var(--{b})' * 40};" for a, b in pairwise("abcdefghi")) + "fill:var(--a)}", RECT),
    ("", "".join(f"<path d='M{k} 0h99v9h-99z'/>" for k in range(9000))),
    ("", f"<path fill-rule='evenodd' d='{''.join(map(ring, range(4000)))}'/>"),
    ("", chain("clipPath", "clip-path")),
    ("", chain("mask", "mask")),
]


@pytest.mark.parametrize(("sheet", "body"), REFUSED, ids=range(len(REFUSED)))
def test_small_drawings_take_bounded_work(sheet: str, body: str) -> None:
    with pytest.raises(NestedCagesError) as caught:
        from_svg(svg(f"<style>{sheet}</style>{body}"))
    assert caught.value.code in ("limit.exceeded", "file.invalid")


@pytest.mark.parametrize(
    ("sheet", "body"),
    [
        (f"*:not(*:nth-child(2n+1)) > * ~ *{RED}" * 60, RECT),
        (f"[*|a]{RED} b::first-line{RED} ,{RED}", RECT),
        ("", RECT * 400),
        ("", f"<path d='{''.join(map(ring, range(201)))}'/>"),
    ],
    ids=range(4),
)
def test_busy_drawings_are_read(sheet: str, body: str) -> None:
    assert from_svg(svg(f"<style>{sheet}</style>{body}")).area == pytest.approx(1.0, rel=1e-3)


def test_circles_may_cross_each_other_a_hundred_thousand_times() -> None:
    places = 1000.0 * np.random.default_rng(3).random((3200, 2))
    drawing = svg("".join(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="29"/>' for x, y in places))
    united = shapely.union_all(shapely.buffer(shapely.points(places.round(2)), 29.0, quad_segs=32))
    assert from_svg(drawing).area == pytest.approx(united.area, rel=1e-3)
    with pytest.raises(NestedCagesError) as caught:
        from_svg(drawing, limits=Limits(seconds=1))
    assert (caught.value.code, caught.value.data["what"]) == ("limit.exceeded", "seconds")
