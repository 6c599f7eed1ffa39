"""Draws a fox in side view as a layered SVG: limbs, tail, body and head overlap, as in a drawing that is to move.

Run as ``python examples/fox.py [FILE]``. It writes ``examples/fox.svg``, which other examples read.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

FILE = Path(__file__).with_name("fox.svg")
FUR, SHADE, CREAM, SOCK, INK, SCARF, FOLD = "#e87a3c", "#c05f2c", "#fff1e0", "#50302c", "#2a1c1b", "#3a8f8c", "#2c7371"

Shape = tuple[str, str]  # a fill, and the points that its smooth outline passes through, y upwards


def read(points: str) -> np.ndarray:
    """The points of a shape, (k, 2)."""
    return np.array([pair.split(",") for pair in points.split()], dtype=float)


def moved(shapes: list[Shape], x: float, fills: dict[str, str]) -> list[Shape]:
    """Shapes shifted along x, with other fills."""
    return [
        (fills.get(fill, fill), " ".join(f"{px + x:g},{py:g}" for px, py in read(points))) for fill, points in shapes
    ]


TAIL: list[Shape] = [
    (
        FUR,
        "-88,52 -112,66 -146,64 -184,64 -222,82 -246,120 -246,164 -232,192 -212,168 -186,150 -150,128 "
        "-118,104 -88,82 -76,66",
    ),
    (CREAM, "-249,140 -246,164 -232,192 -212,168 -197,157 -206,146 -216,148 -224,134 -238,138"),
]
HIND_LEG: list[Shape] = [
    (
        FUR,
        "-92,62 -62,58 -44,30 -50,-2 -66,-28 -68,-52 -62,-88 -48,-96 -38,-107 -44,-114 -84,-114 -92,-106 "
        "-92,-84 -97,-50 -108,-22 -118,6 -114,40",
    ),
    (SOCK, "-97,-50 -82,-46 -68,-52 -62,-88 -48,-96 -38,-107 -44,-114 -84,-114 -92,-106 -92,-84"),
]
FORELEG: list[Shape] = [
    (
        FUR,
        "64,60 88,56 100,30 95,-10 90,-52 92,-88 106,-96 114,-107 108,-114 70,-114 62,-106 64,-84 62,-50 58,-10 48,30",
    ),
    (SOCK, "62,-50 76,-46 90,-52 92,-88 106,-96 114,-107 108,-114 70,-114 62,-106 64,-84"),
]
BODY: list[Shape] = [
    (FUR, "-120,36 -108,66 -70,80 -20,74 30,76 72,94 104,96 122,66 112,26 84,0 36,-8 -20,2 -70,-10 -106,4"),
    (CREAM, "121,64 112,30 98,12 84,12 92,34 100,58 110,78"),
]
HEAD: list[Shape] = [
    (
        FUR,
        "70,110 74,146 96,174 132,182 164,168 182,146 208,124 226,112 220,100 192,92 162,82 132,70 104,70 80,84",
    ),
    (CREAM, "98,84 112,102 140,108 170,116 200,114 226,112 220,100 192,92 162,82 132,70 112,70"),
]
EAR: list[Shape] = [
    (FUR, "84,150 80,190 88,226 96,232 112,208 128,178 124,160 104,148"),
    (SOCK, "94,168 90,194 95,214 106,198 115,178 108,166"),
]
NOSE: list[Shape] = [
    (INK, "216,116 224,120 233,115 230,105 221,104"),
]
EYE: list[Shape] = [
    (INK, "146,142 153,150 160,143 158,130 151,126 146,132"),
    (CREAM, "152,144 155,146 157,143 154,140"),
]
SCARF_BAND: list[Shape] = [
    (SCARF, "54,90 58,112 72,120 100,104 132,86 144,70 138,54 122,50 96,60 68,74"),
]
SCARF_END: list[Shape] = [
    (SCARF, "60,98 80,84 74,58 72,30 62,20 42,30 42,58 46,82"),
    (FOLD, "72,30 62,20 42,30 41,40 56,34 72,41"),
]
FAR = {FUR: SHADE, SOCK: INK}
LAYERS = {  # from the lowest to the highest
    "tail": TAIL,
    "hind-leg-far": moved(HIND_LEG, 34, FAR),
    "foreleg-far": moved(FORELEG, -24, FAR),
    "body": BODY,
    "hind-leg-near": HIND_LEG,
    "foreleg-near": FORELEG,
    "scarf": SCARF_BAND + SCARF_END,
    "ear-far": moved(EAR, 26, FAR),
    "head": HEAD,
    "nose": NOSE,
    "eye": EYE,
    "ear-near": EAR,
}


def curves(points: str) -> np.ndarray:
    """(n, 4, 2) the smooth closed curve through points, as Béziers: a tangent is along the chord of the neighbours."""
    p = read(points)
    slope = (np.roll(p, -1, axis=0) - np.roll(p, 1, axis=0)) / 6.0
    after, leading = np.roll(p, -1, axis=0), np.roll(slope, -1, axis=0)
    return np.stack((p, p + slope, after - leading, after), axis=1)


def path(points: str) -> str:
    """The curve as path data of SVG, whose y points down."""
    beziers = curves(points) * (1.0, -1.0)
    x, y = beziers[0, 0]
    return f"M{x:g},{y:g} " + " ".join("C" + " ".join(f"{c:.1f}" for c in b[1:].ravel()) for b in beziers) + " Z"


def drawn() -> str:
    """The fox as a layered SVG: a group per part."""
    groups = (
        f'  <g id="{name}">'
        + "".join(f'<path fill="{fill}" d="{path(points)}"/>' for fill, points in shapes)
        + "</g>\n"
        for name, shapes in LAYERS.items()
    )
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-270 -250 530 380">\n{"".join(groups)}</svg>\n'


if __name__ == "__main__":
    Path(sys.argv[1] if len(sys.argv) > 1 else FILE).write_text(drawn(), encoding="utf-8")
