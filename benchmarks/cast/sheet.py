"""A sheet to draw a character on, part by part, from the lowest to the highest; y points down, as in SVG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import groupby
from math import atan2, cos, hypot, pi, sin

Point = tuple[float, float]

INK = "#2b2433"
"""Colour of outlines."""


@dataclass
class Sheet:
    """Parts in stacking order, each with the part that a rigger would hang it on."""

    width: float
    height: float
    ink: float = 2.5
    """Width of outlines; 0 for none."""
    on: dict[str, str | None] = field(default_factory=dict)
    """The parent of each part; None for the root."""
    rides: set[str] = field(default_factory=set)
    """Parts that lie on their parent rather than turn on it."""
    _drawn: list[tuple[str, str]] = field(default_factory=list)
    _defs: list[str] = field(default_factory=list)
    _group: str = ""

    def group(self, name: str) -> None:
        """What is drawn from now on is in a group, or in none if the name is empty."""
        self._group = name

    def gradient(self, name: str, top: str, bottom: str) -> str:
        """A paint that goes from one colour to another, from top to bottom."""
        self._defs.append(
            f'<linearGradient id="{name}" x1="0" y1="0" x2="0" y2="1"><stop offset="0" stop-color="{top}"/>'
            f'<stop offset="1" stop-color="{bottom}"/></linearGradient>'
        )
        return f"url(#{name})"

    def add(
        self, name: str, on: str | None, element: str, attributes: str, fill: str, ink: float | None = None
    ) -> None:
        """A part as an element of SVG."""
        width = self.ink if ink is None else ink
        outline = f' stroke="{INK}" stroke-width="{width:g}" stroke-linejoin="round"' if width else ""
        self._drawn.append((self._group, f'<{element} id="{name}" {attributes} fill="{fill}"{outline}/>'))
        self.on[name] = on

    def detail(self, name: str, on: str) -> None:
        """Say that a part rides on its parent."""
        assert self.on[name] == on
        self.rides.add(name)

    def ellipse(self, name: str, on: str | None, at: Point, rx: float, ry: float, fill: str, **more: float) -> None:
        turn = more.pop("turn", 0.0)
        turned = f' transform="rotate({turn:g} {at[0]:g} {at[1]:g})"' if turn else ""
        shape = f'cx="{at[0]:g}" cy="{at[1]:g}" rx="{rx:g}" ry="{ry:g}"{turned}'
        self.add(name, on, "ellipse", shape, fill, more.get("ink"))

    def circle(self, name: str, on: str | None, at: Point, r: float, fill: str, **more: float) -> None:
        self.ellipse(name, on, at, r, r, fill, **more)

    def box(self, name: str, on: str | None, at: Point, w: float, h: float, fill: str, r: float = 4.0) -> None:
        """A rectangle around a point, with round corners."""
        shape = f'x="{at[0] - w / 2:g}" y="{at[1] - h / 2:g}" width="{w:g}" height="{h:g}" rx="{r:g}"'
        self.add(name, on, "rect", shape, fill)

    def polygon(self, name: str, on: str | None, points: Sequence[Point], fill: str) -> None:
        self.add(name, on, "polygon", 'points="' + " ".join(f"{x:g},{y:g}" for x, y in points) + '"', fill)

    def blob(self, name: str, on: str | None, points: Sequence[Point], fill: str, ink: float | None = None) -> None:
        """A smooth closed shape through points."""
        self.add(name, on, "path", f'd="{smooth(points, closed=True)}"', fill, ink)

    def line(self, name: str, on: str | None, points: Sequence[Point], width: float, colour: str) -> None:
        """A smooth line, drawn as a stroke."""
        self._drawn.append(
            (
                self._group,
                f'<path id="{name}" d="{smooth(points)}" fill="none" stroke="{colour}" stroke-width="{width:g}" '
                'stroke-linecap="round"/>',
            )
        )
        self.on[name] = on

    def limb(self, name: str, on: str | None, a: Point, b: Point, widths: Point, fill: str) -> None:
        """A straight limb with round ends that gets thinner, from joint to joint."""
        r, s = widths[0] / 2, widths[1] / 2
        away = hypot(b[0] - a[0], b[1] - a[1])
        along, lean = atan2(b[1] - a[1], b[0] - a[0]), pi / 2 - (r - s) / away
        one, other = along + lean, along - lean
        d = (
            f"M{a[0] + r * cos(one):.2f} {a[1] + r * sin(one):.2f}"
            f"A{r:g} {r:g} 0 1 1 {a[0] + r * cos(other):.2f} {a[1] + r * sin(other):.2f}"
            f"L{b[0] + s * cos(other):.2f} {b[1] + s * sin(other):.2f}"
            f"A{s:g} {s:g} 0 0 1 {b[0] + s * cos(one):.2f} {b[1] + s * sin(one):.2f}Z"
        )
        self.add(name, on, "path", f'd="{d}"', fill)

    def tail(self, name: str, on: str | None, points: Sequence[Point], widths: Sequence[float], fill: str) -> None:
        """A smooth curved limb through points, as wide as given at each of them."""
        left, right = [], []
        for k, (x, y) in enumerate(points):
            before, after = points[max(k - 1, 0)], points[min(k + 1, len(points) - 1)]
            dx, dy = after[0] - before[0], after[1] - before[1]
            long, half = hypot(dx, dy), widths[k] / 2
            left.append((x - dy / long * half, y + dx / long * half))
            right.append((x + dy / long * half, y - dx / long * half))
        self.blob(name, on, [*left, *right[::-1]], fill)

    def eye(self, name: str, on: str, at: Point, r: float, look: Point = (0.0, 0.0), white: str = "#fff") -> None:
        """An eye with a pupil that rides on it."""
        self.circle(name, on, at, r, white, ink=self.ink * 0.7)
        pupil = name.replace("eye", "pupil")
        self.circle(pupil, name, (at[0] + look[0] * r, at[1] + look[1] * r), 0.5 * r, INK, ink=0.0)
        self.rides |= {name, pupil}

    def group_of(self, name: str) -> str:
        """The group that an artist might put a part into: a limb with all on it, or the trunk with what is no limb."""
        limb, above = name, self.on[name]
        while above is not None and self.on[above] is not None:
            limb, above = above, self.on[above]
        return limb if limb in self.on.values() or above is None else above

    def svg(self) -> str:
        """The drawing, with ids as the names of its parts."""
        body = ""
        for group, drawn in groupby(self._drawn, key=lambda each: each[0]):
            parts = "\n".join(part for _, part in drawn)
            body += f'<g id="{group}">\n{parts}\n</g>\n' if group else parts + "\n"
        defs = f"<defs>{''.join(self._defs)}</defs>\n" if self._defs else ""
        size = f'width="{self.width:g}" height="{self.height:g}" viewBox="0 0 {self.width:g} {self.height:g}"'
        return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n{defs}{body}</svg>\n'


def smooth(points: Sequence[Point], *, closed: bool = False) -> str:
    """Path data of a smooth curve through points, after Catmull and Rom (1974)."""
    count = len(points)

    def at(k: int) -> Point:
        return points[k % count] if closed else points[min(max(k, 0), count - 1)]

    d = f"M{points[0][0]:.2f} {points[0][1]:.2f}"
    for k in range(count if closed else count - 1):
        (x0, y0), (x1, y1), (x2, y2), (x3, y3) = (at(k + i) for i in (-1, 0, 1, 2))
        d += f"C{x1 + (x2 - x0) / 6:.2f} {y1 + (y2 - y0) / 6:.2f} {x2 - (x3 - x1) / 6:.2f} {y2 - (y3 - y1) / 6:.2f} "
        d += f"{x2:.2f} {y2:.2f}"
    return d + ("Z" if closed else "")
