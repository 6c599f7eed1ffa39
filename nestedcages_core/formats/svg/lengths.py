"""Numbers, lengths and viewports of SVG."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from xml.etree import ElementTree as ET

from .elements import Faults, name_of, quoted

INCH = 96.0
UNITS_OF_LENGTH = {"": 1.0, "px": 1.0, "in": INCH, "cm": INCH / 2.54, "mm": INCH / 25.4, "q": INCH / 101.6,
                   "pt": INCH / 72.0, "pc": INCH / 6.0}  # fmt: skip
"""User units of an inch, and of each unit of length (CSS)."""

ACROSS, DOWN = ("x", "width", "cx", "rx", "x1", "x2"), ("y", "height", "cy", "ry", "y1", "y2")
"""Attributes whose percentages refer to the viewport's width, and to its height; others refer to its diagonal."""

LENGTH = re.compile(r"([+-]?(?:\d+(?:[.,]\d*)?|\.\d+)(?:e[+-]?\d+)?)\s*([a-z%]*)", re.IGNORECASE)
"""A number, where people write it so with a decimal comma, and its unit."""

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

NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")


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


def numbers(text: str) -> list[float]:
    """All numbers in a list."""
    return [float(number) for number in NUMBER.findall(text)]


def parse_length(text: str, key: str, what: str, viewport: Viewport, missing: float = 0.0) -> float:
    """A length in user units; `missing` if there is none, or none that can be read, which the viewport's faults say."""
    if not text.strip() or text.strip() == "auto":
        return missing
    value = viewport.length(text, key)
    if value is None:
        viewport.faults.add(f"The {what} is {quoted(text)}, which is not a length: {missing:g} is used")
    return missing if value is None else value


def attribute(item: ET.Element, key: str, viewport: Viewport, missing: float = 0.0) -> float:
    """A length in user units, `missing` if the attribute is not there or cannot be read."""
    return parse_length(item.get(key, ""), key, f"{key} of the {name_of(item)}", viewport, missing)


def share(text: str | None, missing: float = 1.0) -> float:
    """A number or percentage as a fraction from 0 to 1."""
    found = LENGTH.fullmatch(text.strip()) if text else None
    if found is None or found[2] not in ("", "%"):
        return missing
    return min(max(float(found[1].replace(",", ".")) / (100.0 if found[2] else 1.0), 0.0), 1.0)
