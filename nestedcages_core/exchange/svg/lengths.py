"""Numbers, lengths and viewports of SVG."""

from __future__ import annotations

import ast
import math
import re
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import invalid_file
from ...geometry.arrays import FloatArray

UNITS_OF_LENGTH = {
    "": 1.0,
    "px": 1.0,
    "in": 96.0,
    "cm": 96.0 / 2.54,
    "mm": 96.0 / 25.4,
    "q": 96.0 / 101.6,
    "pt": 96.0 / 72.0,
    "pc": 16.0,
}
"""User units of each unit of length (CSS: 96 px to the inch)."""

ACROSS, DOWN = ("x", "width", "cx", "rx", "x1", "x2"), ("y", "height", "cy", "ry", "y1", "y2")
"""Attributes whose percentages refer to the viewport's width, and to its height; others refer to its diagonal."""

LENGTH = re.compile(r"([+-]?(?:\d+(?:[.,]\d*)?|\.\d+)(?:e[+-]?\d+)?)\s*([a-z%]*)", re.IGNORECASE)
"""A number, where people write it so with a decimal comma, and its unit."""

ALIGNED = {"xmin": 0.0, "xmid": 0.5, "xmax": 1.0, "ymin": 0.0, "ymid": 0.5, "ymax": 1.0}
"""Fraction of the empty space before the view box, for each part of preserveAspectRatio."""

SHARES_OF_VIEW = ("%", "vw", "vh", "vmin", "vmax")
"""Units that are hundredths of the viewport."""
VIEW_SIDES = {"vw": "width", "vh": "height"}

FONT_SIZE = 16.0
"""Size of the font where none is given, in user units, as in browsers."""

OPERATORS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: float.__add__,
    ast.Sub: float.__sub__,
    ast.Mult: float.__mul__,
    ast.Div: float.__truediv__,
}

MAX_CALCULATED = 200
"""Longest `calc()` that is read, in characters."""

MAX_NAMED = 6
"""Largest number of attributes that notes name."""

MAX_SHOWN = 30
"""Maximum length of a value in a message."""

CALL = re.compile(r"[\s,]*([A-Za-z]+)\s*\(([^)]*)\)[\s,]*")
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")

VALUE = re.compile(rf"({NUMBER.pattern})(deg|rad|grad|turn|px)?")
DEGREES = {"": 1.0, "px": 1.0, "deg": 1.0, "rad": 180.0 / math.pi, "grad": 0.9, "turn": 360.0}
"""Units of angles and lengths, in style sheets only."""

MAX_TRANSFORM_SHOWN = 60
"""Maximum length of a transform in a message."""


class Faults:
    """Attributes that cannot be read, and what is done instead, as browsers do; each sentence once."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()

    def add(self, sentence: str) -> None:
        self.counts[sentence] += 1

    def notes(self) -> list[str]:
        """The first sentences, and how many others there are."""
        named = [f"{text} ({count} times)." if count > 1 else f"{text}." for text, count in self.counts.items()]
        more = len(named) - MAX_NAMED
        return [*named[:MAX_NAMED], *([f"{more} more attributes cannot be read."] if more > 0 else [])]


@dataclass(frozen=True)
class Viewport:
    """What lengths refer to: its size in user units, None if the document has none, and that of the font."""

    width: float | None = None
    height: float | None = None
    em: float = FONT_SIZE
    faults: Faults = field(default_factory=Faults, compare=False)

    def sized(self, width: float | None, height: float | None) -> Viewport:
        """The same with another size."""
        return replace(self, width=width, height=height)

    def reference(self, key: str) -> float | None:
        """The value of 100 % of an attribute."""
        if key == "font-size":
            return self.em
        if self.width is None or self.height is None:
            return None
        if key in ACROSS:
            return self.width
        return self.height if key in DOWN else math.hypot(self.width, self.height) / math.sqrt(2.0)

    def length(self, text: str, key: str) -> float | None:
        """A length in user units, or a sum or product of some by `calc()`; None for anything else."""
        text = text.strip().lower()
        found = LENGTH.fullmatch(text)
        value = self._scaled(found, key) if found else None
        if text.startswith("calc(") and len(text) <= MAX_CALCULATED:
            lengths = LENGTH.sub(lambda found: repr(self._scaled(found, key)), text.replace("calc(", "("))
            with suppress(KeyError, TypeError, ValueError, SyntaxError, ArithmeticError):
                value = _calculated(ast.parse(lengths, mode="eval").body)
        return value if value is not None and math.isfinite(value) else None

    def _scaled(self, found: re.Match[str], key: str) -> float | None:
        unit = found[2].lower()
        of_font = {"em": self.em, "rem": FONT_SIZE, "ex": self.em / 2.0, "ch": self.em / 2.0}
        scale = {**UNITS_OF_LENGTH, **of_font}.get(unit)
        if unit in SHARES_OF_VIEW:
            sides = [size for size in (self.width, self.height) if size is not None]
            extreme = {"vmin": min(sides, default=None), "vmax": max(sides, default=None)}
            reference = extreme[unit] if unit in extreme else self.reference(VIEW_SIDES.get(unit, key))
            scale = reference / 100.0 if reference is not None else None
        return float(found[1].replace(",", ".")) * scale if scale is not None else None


def _calculated(term: ast.expr) -> float:
    """The value of numbers, + - * / and parentheses. Raises an error for anything else."""
    if isinstance(term, ast.BinOp):
        return OPERATORS[type(term.op)](_calculated(term.left), _calculated(term.right))
    if isinstance(term, ast.UnaryOp):
        return -_calculated(term.operand) if isinstance(term.op, ast.USub) else _calculated(term.operand)
    return float(ast.literal_eval(term))


def quoted(text: str) -> str:
    """A value, shortened for messages."""
    return f"'{text}'" if len(text) <= MAX_SHOWN else f"'{text[:MAX_SHOWN]}…'"


def numbers(text: str) -> list[float]:
    """All numbers in a list."""
    return [float(number) for number in NUMBER.findall(text)]


def measure(text: str, key: str, what: str, viewport: Viewport, missing: float = 0.0) -> float:
    """A length in user units; `missing` if there is none, or none that can be read, which the viewport's faults say."""
    if not text.strip() or text.strip() == "auto":
        return missing
    value = viewport.length(text, key)
    if value is None:
        viewport.faults.add(f"The {what} is {quoted(text)}, which is not a length: {missing:g} is used")
    return missing if value is None else value


def attribute(item: ET.Element, key: str, viewport: Viewport, missing: float = 0.0) -> float:
    """A length in user units, `missing` if the attribute is not there or cannot be read."""
    return measure(item.get(key, ""), key, f"{key} of the {name_of(item)}", viewport, missing)


def measured_box(item: ET.Element, viewport: Viewport, what: str) -> FloatArray:
    """(2, 2) corners of the region of a mask, by default a tenth wider than what it belongs to."""
    defaults = {"x": "-10%", "y": "-10%", "width": "120%", "height": "120%"}
    x, y, width, height = (
        measure(item.get(key) or default, key, f"{key} of the {what}", viewport) for key, default in defaults.items()
    )
    return np.array([(x, y), (x + width, y + height)])


def share(text: str | None, missing: float = 1.0) -> float:
    """A number or percentage as a fraction from 0 to 1."""
    found = LENGTH.fullmatch(text.strip()) if text else None
    if found is None or found[2] not in ("", "%"):
        return missing
    return min(max(float(found[1].replace(",", ".")) / (100.0 if found[2] else 1.0), 0.0), 1.0)


def name_of(item: ET.Element) -> str:
    """The tag without its namespace; comments have none."""
    return item.tag.rpartition("}")[2] if isinstance(item.tag, str) else ""


def title_of(item: ET.Element) -> str:
    """An element in messages: its tag and its id."""
    return f"{name_of(item)} {quoted(item.get('id', ''))}" if item.get("id") else f"{name_of(item)} without an id"


def link_of(item: ET.Element) -> str:
    """The target of a reference, with its `#`."""
    return (item.get("href") or item.get("{http://www.w3.org/1999/xlink}href") or "").strip()


def view_box_of(item: ET.Element) -> tuple[float, float, float, float] | None:
    """x, y, width and height of a view box that has an inside."""
    box = numbers(item.get("viewBox", ""))
    if len(box) != 4 or not np.isfinite(box).all() or not (box[2] > 0.0 and box[3] > 0.0):
        return None
    return box[0], box[1], box[2], box[3]


def fitted(
    box: tuple[float, float, float, float] | None, x: float, y: float, width: float, height: float, aspect: str
) -> FloatArray:
    """The matrix from a view box to the rectangle that it is fitted into (SVG 1.1, section 7.8)."""
    if box is None:
        return translation(x, y)
    across, down = width / box[2], height / box[3]
    words = aspect.lower().replace("defer", "").split() or ["xmidymid"]
    if words[0] != "none":
        across = down = max(across, down) if "slice" in words else min(across, down)
        x += (width - across * box[2]) * ALIGNED.get(words[0][:4], 0.5)
        y += (height - down * box[3]) * ALIGNED.get(words[0][4:], 0.5)
    return translation(x, y) @ scaling(across, down) @ translation(-box[0], -box[1])


def read_transform(text: str) -> FloatArray:
    """The product of a list of transforms; the identity for an empty one. Raises NestedCagesError."""
    product = np.eye(3)
    place = 0
    text = text.rstrip()
    while place < len(text) and text != "none":
        found = CALL.match(text, place)
        values = [float(x) * DEGREES[unit] for x, unit in VALUE.findall(found[2])] if found else []
        whole = found is not None and not VALUE.sub("", found[2]).strip(" ,\t\r\n") and np.isfinite(values).all()
        try:
            product = product @ MATRICES[found[1] if found and whole else ""](*values)
            place = found.end() if found else place
        except (KeyError, TypeError, ValueError):  # another name, or a wrong number of values
            raise invalid_file(
                f"The transform '{text[:MAX_TRANSFORM_SHOWN]}' cannot be read; use matrix, translate, scale, "
                "rotate, skewX and skewY with finite numbers."
            ) from None
    return product


def translation(x: float, y: float) -> FloatArray:
    return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])


def scaling(x: float, y: float) -> FloatArray:
    return np.diag([x, y, 1.0])


def turned(degrees: float) -> FloatArray:
    matrix = np.eye(3)
    angle = math.radians(degrees)
    matrix[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    return matrix


def moved(points: FloatArray, matrix: FloatArray) -> FloatArray:
    """Points (..., 2) under a matrix."""
    return np.asarray(points @ matrix[:2, :2].T + matrix[:2, 2])


def _rotation(degrees: float, *about: float) -> FloatArray:
    x, y = about or (0.0, 0.0)
    return translation(x, y) @ turned(degrees) @ translation(-x, -y)


def _skew(degrees: float, row: int) -> FloatArray:
    matrix = np.eye(3)
    matrix[row, 1 - row] = math.tan(math.radians(degrees))
    return matrix


MATRICES: dict[str, Callable[..., FloatArray]] = {
    "matrix": lambda a, b, c, d, e, f: np.array([(a, c, e), (b, d, f), (0.0, 0.0, 1.0)]),
    "translate": lambda x, y=0.0: translation(x, y),
    "translateX": lambda x: translation(x, 0.0),
    "translateY": lambda y: translation(0.0, y),
    "scale": lambda x, y=None: scaling(x, x if y is None else y),
    "scaleX": lambda x: scaling(x, 1.0),
    "scaleY": lambda y: scaling(1.0, y),
    "rotate": _rotation,
    "skewX": lambda degrees: _skew(degrees, 0),
    "skewY": lambda degrees: _skew(degrees, 1),
}
"""The matrix of each transform, from its numbers."""
