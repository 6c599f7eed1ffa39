"""Documents by chance from the grammar of SVG: whatever comes in, a mesh comes out, or a sentence."""

from __future__ import annotations

import os
import warnings

from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st

from nestedcages_core import NestedCagesError
from nestedcages_core.exchange import Limits, svg_drawing

EXAMPLES = int(os.environ.get("FUZZ_EXAMPLES", "8"))
"""Documents that are tried; thousands with FUZZ_EXAMPLES=5000."""

LIMITS = Limits(bytes=100_000, elements=2000, points=50_000)

ODD = "0 1 -1 2.5 10 100 -0 .5 1. 1e-9 1e9 1e-320 1e308 1e999 -1e999 nan inf + - e5 1e 0x1"
NUMBERS = st.sampled_from([*ODD.split(), "", "9" * 400, "\u0661"]) | st.integers(-20, 40).map(str)
UNITS = st.sampled_from(["", "", "", "px", "%", "mm", "pt", "em", "deg", "furlongs", "!"])
LENGTHS = st.builds(str.__add__, NUMBERS, UNITS)
LINKS = st.sampled_from(["none", *(f"url(#{name}) red" for name in "abcdefgh"), "url(#", "url(#none)"])
COLOURS = st.sampled_from(
    ["red", "none", "#fff", "#0000", "#12345", "rgba(1,2,3,.5)", "hsl(0 0% 0% / 0)", "currentColor", "transparent", "",
     "context-fill", "rgb(", "inherit"]
)  # fmt: skip
CALLS = st.builds(
    lambda name, values: f"{name}({' '.join(values)})",
    st.sampled_from(["matrix", "translate", "scale", "rotate", "skewX", "skewY", "turn"]),
    st.lists(NUMBERS, max_size=6),
)
COMMANDS = st.builds(
    lambda command, values: command + " ".join(values),
    st.sampled_from("MmLlHhVvCcSsQqTtAaZzX"),
    st.lists(NUMBERS, max_size=8),
)
GOOD_COMMANDS = st.sampled_from(["M0 0", "L10 0", "h5v5", "l-3 4", "C1 2 3 4 5 0", "A5 3 20 0 1 6 1", "z", "Q2 4 5 0"])
PATHS = st.lists(COMMANDS | GOOD_COMMANDS, max_size=8).map(lambda parts: "M0 0" + "".join(parts))

ATTRIBUTES: dict[str, st.SearchStrategy[str]] = {
    **dict.fromkeys(
        (
            *("x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "x1", "x2", "y1", "y2", "fx", "fy", "offset"),
            *("stroke-width", "stroke-miterlimit", "stroke-dashoffset", "opacity", "fill-opacity", "stop-opacity"),
            *("markerWidth", "markerHeight", "refX", "refY", "orient", "dx", "dy", "stdDeviation", "radius", "k2"),
        ),
        LENGTHS,
    ),
    **dict.fromkeys(("fill", "stroke"), COLOURS | LINKS),
    **dict.fromkeys(("clip-path", "mask", "filter", "marker-start", "marker-mid", "marker"), LINKS),
    **dict.fromkeys(("transform", "gradientTransform"), st.lists(CALLS, max_size=3).map(" ".join)),
    **dict.fromkeys(("viewBox", "points", "stroke-dasharray", "values"), st.lists(NUMBERS, max_size=8).map(" ".join)),
    **dict.fromkeys(
        ("clipPathUnits", "maskUnits", "maskContentUnits", "gradientUnits", "filterUnits", "markerUnits"),
        st.sampled_from(["userSpaceOnUse", "objectBoundingBox", "?"]),
    ),
    "d": PATHS,
    "id": st.sampled_from("abcdefgh"),
    "class": st.sampled_from(["a", "b", "a b"]),
    "href": st.sampled_from([f"#{name}" for name in "abcdefgh"]),
    "style": st.sampled_from(["fill:none", "fill:red!important;;", "stroke:red;x", ":;:", "display:none", "opacity:0"]),
    "preserveAspectRatio": st.sampled_from(["none", "xMinYMax slice", "meet", "x"]),
    "stroke-linecap": st.sampled_from(["round", "square", "?"]),
    "stroke-linejoin": st.sampled_from(["round", "bevel", "miter"]),
    "vector-effect": st.just("non-scaling-stroke"),
    "fill-rule": st.sampled_from(["evenodd", "nonzero"]),
    "overflow": st.sampled_from(["visible", "hidden"]),
    "operator": st.sampled_from(["in", "out", "atop", "arithmetic", "dilate"]),
    "in": st.sampled_from(["SourceGraphic", "SourceAlpha", "a", "?"]),
}
HOLDING = ("g", "svg", "symbol", "use", "defs", "switch", "a", "clipPath", "mask", "marker", "filter", "linearGradient",
           "radialGradient", "pattern", "stop", "text", "feGaussianBlur", "feOffset", "feMerge", "feMergeNode",
           "feFlood", "feComposite", "feColorMatrix", "feMorphology", "feDropShadow")  # fmt: skip
SHEETS = st.lists(
    st.sampled_from(
        ["rect{fill:none}", ".a .b{stroke:red}", "#a>*{fill:blue", "}", "@media x{", "/*", ":not(.a){", "*"]
    ),
    max_size=5,
).map(lambda parts: f"<style><![CDATA[{''.join(parts)}]]></style>")


USUAL = {
    "path": {"d": "M0 0L9 0L9 7z"},
    "rect": {"width": "9", "height": "7"},
    "circle": {"r": "4"},
    "ellipse": {"rx": "3", "ry": "5"},
    "line": {"x2": "8", "stroke": "red"},
    "polyline": {"points": "0 0 5 0 5 5 2 -3"},
    "polygon": {"points": "1 1 5 0 5 5"},
}
"""Attributes with which an element has an outline."""


@st.composite
def attributes(draw: st.DrawFn, most: int = 6, name: str = "") -> str:
    keys = draw(st.lists(st.sampled_from(sorted(ATTRIBUTES)), unique=True, max_size=most))
    given = {**USUAL.get(name, {}), **{key: draw(ATTRIBUTES[key]) for key in keys}}
    return "".join(f' {key}="{value}"' for key, value in given.items())


SHAPES = st.sampled_from(sorted(USUAL)).flatmap(lambda name: attributes(3, name).map(lambda given: f"<{name}{given}/>"))
ELEMENTS = st.recursive(
    SHAPES,
    lambda inner: st.builds(
        lambda name, given, parts: f"<{name}{given}>{''.join(parts)}</{name}>",
        st.sampled_from(HOLDING),
        attributes(),
        st.lists(inner, max_size=4),
    ),
    max_leaves=12,
)
DOCUMENTS = st.builds(
    lambda given, sheet, parts: f'<svg{given}>{sheet}<rect id="a" width="5" height="5"/>{"".join(parts)}</svg>',
    attributes(3).filter(lambda given: "id=" not in given),
    SHEETS,
    st.lists(ELEMENTS, min_size=1, max_size=6),
)


@settings(max_examples=EXAMPLES, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    DOCUMENTS,
    st.sampled_from([{}, {}, {"strokes": False}, {"tolerance": 1e-300}, {"opacity": 0.5}, {"background": False}]),
)
def test_any_document_ends_in_a_mesh_or_a_sentence(text: str, options: dict[str, object]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        try:
            drawing = svg_drawing(text, limits=LIMITS, **options)
        except NestedCagesError as error:
            assert str(error).endswith(".")
            event(type(error).__name__)
        else:
            event("Mesh")
            assert drawing.mesh.area > 0.0


@settings(max_examples=EXAMPLES, deadline=None)
@given(st.binary(max_size=50), st.integers(0, 200), st.integers(0, 50))
def test_a_damaged_document_ends_in_a_mesh_or_a_sentence(damage: bytes, start: int, length: int) -> None:
    whole = b'<?xml version="1.0"?><svg viewBox="0 0 9 9"><g id="a" transform="scale(2)"><path d="M0 0L5 0L3 3z"/></g>'
    whole += b'<use href="#a" stroke="red"/><style>#a{fill:red}</style></svg>'
    text = whole[:start] + damage + whole[start + length :]
    try:
        assert svg_drawing(text, limits=LIMITS).mesh.area > 0.0
    except NestedCagesError as error:
        assert str(error).endswith(".")
