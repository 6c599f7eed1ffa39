"""Every reader against attacks that are known and documents that are nearly right: a result or one sentence, in bounded
time and memory."""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

import nestedcages_core as core
from nestedcages_core import ArcLength, Limits, Mesh, NestedCagesError, OnCurve, Settings, from_svg, nested_cages
from support import hostile
from support.attacks import ATTACKS, png_bombs
from support.command import run
from support.documents import archive, png_of, solid, svg
from support.hostile import outcome
from support.judging import rejected
from support.shapes import letter_a, letter_a_coarse

pytestmark = [pytest.mark.thorough, pytest.mark.timeout(1800)]

MANY = 1500
"""Examples of each grammar."""

DATA = Path(__file__).resolve().parents[1] / "data"


def try_many(check: Callable[[Any], None], strategy: Any, amount: int = MANY) -> None:
    """Run a check on so many examples."""
    quiet = settings(
        max_examples=amount, deadline=None, database=None, suppress_health_check=list(HealthCheck), derandomize=False
    )
    seed(20_260_101)(quiet(given(strategy)(check)))()


def check_result(result: Any) -> None:
    """What a reader returns: pictures, features, or meshes whose loops neither cross nor touch."""
    if isinstance(result, np.ndarray):
        assert result.ndim == 3 and result.shape[2] == 4
    elif not isinstance(result, NestedCagesError):
        for mesh in [each.mesh for each in result] if isinstance(result, list) else [result]:
            assert isinstance(mesh, Mesh)
            assert outcome(mesh.validated) is not None
            scale = np.ldexp(mesh.vertices, -np.frexp(np.abs(mesh.vertices).max())[1])  # exact: nothing is rounded
            assert not (1e-100 < mesh.diagonal < 1e100) or solid(mesh.moved(scale)).is_valid


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    ("ending", "read"),
    [
        (".svg", from_svg),
        (".svg", lambda text: core.svg_drawing(text, each=True).mesh),
        (".geojson", core.from_geojson),
        (".geojson", core.features_from_geojson),
    ],
)
def test_documents_that_are_nearly_right(ending: str, read: Callable[[Any], Any]) -> None:
    try_many(lambda document: check_result(outcome(lambda: read(document))), hostile.DOCUMENTS[ending])


def test_pictures_that_are_nearly_right(tmp_path: Path) -> None:
    def check(document: bytes) -> None:
        (tmp_path / "a.png").write_bytes(document)
        check_result(outcome(lambda: core.read_png(tmp_path / "a.png")))

    try_many(check, hostile.DOCUMENTS[".png"])


def test_cages_around_extreme_loops() -> None:
    """Every decimation, from coordinates at the limits of float64: certified, or refused."""

    def check(drawn: tuple[Any, int, Any]) -> None:
        loops, more, decimation = drawn
        mesh = outcome(lambda: Mesh.from_loops(loops))
        if isinstance(mesh, Mesh):
            count = min(len(mesh.vertices), 3 * len(mesh.loops) + more)
            outcome(lambda: nested_cages(mesh, [count], Settings(decimation=decimation)))

    decimations = st.sampled_from([core.LineCycles(on_curve=False), OnCurve(), ArcLength()])
    try_many(check, st.tuples(hostile.loops, st.integers(0, 4), decimations))


def test_the_command_says_what_is_wrong(tmp_path: Path) -> None:
    """Exit status 0, 1 or 2; never a traceback; a sentence wherever it is not 0; outputs whole or not there."""
    statuses: set[int] = set()

    def check(drawn: tuple[str, bytes, list[str]]) -> None:
        ending, content, options = drawn
        path, written = tmp_path / f"in{ending}", tmp_path / "out.svg"
        path.write_bytes(content)
        written.unlink(missing_ok=True)
        done = outcome(lambda: run(path, *options, "-o", written))
        statuses.add(done.status)
        assert done.status in (0, 1, 2)
        assert ("error: " in done.err) == bool(done.status) and "error: None" not in done.err
        assert done.status or "</svg>" in written.read_text()

    try_many(check, hostile.commands(), 500)
    assert {0, 1} <= statuses


@pytest.mark.parametrize("kind", ["psd", "kra", "ora"])
def test_damaged_paintings_end_in_a_sentence(kind: str, tmp_path: Path) -> None:
    stack = '<image w="9" h="9"><stack><layer name="a" src="a.png" x="3"/><layer name="b" src="a.png"/></stack></image>'
    ora = archive({"stack.xml": stack, "a.png": png_of(np.full((4, 4, 4), 255, np.uint8))})
    good = ora if kind == "ora" else (DATA / f"layers.{kind}").read_bytes()
    rng, statuses = np.random.default_rng(11), set()
    for _ in range(150):
        bad = bytearray(good)
        for place in rng.integers(0, len(good), rng.integers(1, 9)):
            bad[place] = rng.integers(0, 256)
        if rng.random() < 0.3:
            del bad[rng.integers(0, len(bad)) :]
        (tmp_path / f"a.{kind}").write_bytes(bad)
        done = run("puppet", tmp_path / f"a.{kind}", "-o", tmp_path / "a.json")
        assert done.status in (0, 1) and ("error: " in done.err) == bool(done.status)
        statuses.add(done.status)
    assert statuses == {0, 1}


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("name", [*ATTACKS, "png_bombs"])
def test_known_attacks_are_held(name: str, tmp_path: Path) -> None:
    for call in png_bombs(tmp_path / "a.png") if name == "png_bombs" else ATTACKS[name]():
        found = outcome(call)
        if isinstance(found, Mesh) and len(found.vertices) < 300:
            check_result(found)


@pytest.mark.parametrize("options", [{}, {"fallback": None}])
def test_coarse_meshes_half_outside_end_soon(options: dict[str, Any]) -> None:
    """In a sentence, or from an enclosing start instead."""
    fine, coarse = letter_a(), letter_a_coarse()
    half = Mesh(coarse.vertices + 0.35 * fine.diagonal * np.array([1.0, 0.0]), coarse.edges)
    found = outcome(lambda: nested_cages(fine, [half], Settings(**options)))
    assert isinstance(found, NestedCagesError) == ("fallback" in options)


def test_a_star_of_thousands_of_spikes_ends_soon() -> None:
    random, spikes = np.random.default_rng(1), 2000
    angles = np.arange(2 * spikes) / spikes * np.pi
    long, short = random.uniform(0.6, 1.0, 2 * spikes), random.uniform(0.2, 0.3, 2 * spikes)
    radii = np.where(np.arange(2 * spikes) % 2, short, long)
    fine = Mesh.from_loops([radii[:, None] * np.stack((np.cos(angles), np.sin(angles)), axis=1)])
    assert len(outcome(lambda: nested_cages(fine, [50])).cages[0].vertices) == 50


# Small drawings that ask for much work are refused, and busy ones that are drawings are read

RECT, RED = "<rect width='1' height='1'/>", "{fill:red}"


def chain(kind: str, link: str) -> str:
    """Clips or masks that are themselves clipped by the next one, 300 deep."""
    links = [f"<{kind} id='c{k}' {link}='url(#c{k + 1})'>{RECT}</{kind}>" for k in range(300)]
    return "".join(links) + f"<rect width='1' height='1' {link}='url(#c0)'/>"


def squares(count: int) -> str:
    """Each around the last one, closer than what is seen."""
    return "".join("M{0} {0}H{1}V{1}H{0}z".format(-1e-6 * k, 1.0 + 1e-6 * k) for k in range(count))


ARCS = "".join(f"a1 1 0 0 1 {k % 7} {k * k % 5 + 1}" for k in range(200_000))
REFUSED = [
    (f"*:not(*:nth-child(2n+1)) > * ~ *{RED}" * 400, RECT * 400),
    (f"*:nth-of-type(2n+1):last-of-type:only-of-type{RED}" * 400, RECT * 1300),
    (f"*:has(*:has(*:has(a))){RED}" * 200, "<g>" * 100 + RECT * 100 + "</g>" * 100),
    ("*" + ":not([a])" * 6500 + RED, RECT * 650),
    ("a " * 400 + RED, RECT),
    (":not(*:is(" * 100 + "a" + "))" * 100 + RED, RECT),
    ("@media {" * 3000, RECT),
    ("svg{" + "".join(f"--{a}:{f'var(--{b})' * 40};" for a, b in pairwise("abcdefghi")) + "fill:var(--a)}", RECT),
    ("", "".join(f"<path d='M{k} 0h99v9h-99z'/>" for k in range(9000))),
    ("", f"<path fill-rule='evenodd' d='{squares(4000)}'/>"),
    ("", chain("clipPath", "clip-path")),
    ("", chain("mask", "mask")),
    ("", f"<path d='M0 0{ARCS}Z'/>"),
    ("", f"<path d='M0 0{'h1v1' * 600_000}Z'/>"),
    ("", f"<polygon points='{'1 2 3 4 ' * 600_000}'/>"),
]


@pytest.mark.parametrize(("sheet", "body"), REFUSED, ids=range(len(REFUSED)))
def test_small_drawings_take_bounded_work(sheet: str, body: str) -> None:
    with pytest.raises(NestedCagesError) as caught:
        from_svg(svg(f"<style>{sheet}</style>{body}"))
    assert caught.value.code in ("limit.exceeded", "file.invalid")


READ = [
    (f"*:not(*:nth-child(2n+1)) > * ~ *{RED}" * 60, RECT),
    (f"[*|a]{RED} b::first-line{RED} ,{RED}", RECT),
    ("", RECT * 400),
    ("", f"<path d='{squares(201)}'/>"),
]


@pytest.mark.parametrize(("sheet", "body"), READ, ids=range(4))
def test_busy_drawings_are_read(sheet: str, body: str) -> None:
    assert from_svg(svg(f"<style>{sheet}</style>{body}")).area == pytest.approx(1.0, rel=1e-3)


def test_circles_may_cross_each_other_a_hundred_thousand_times() -> None:
    places = 1000.0 * np.random.default_rng(3).random((3200, 2))
    drawing = svg("".join(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="29"/>' for x, y in places))
    united = shapely.union_all(shapely.buffer(shapely.points(places.round(2)), 29.0, quad_segs=32))
    assert from_svg(drawing).area == pytest.approx(united.area, rel=1e-3)
    with rejected("limit.exceeded", what="seconds"):
        from_svg(drawing, limits=Limits(seconds=1))
