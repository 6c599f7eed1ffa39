"""Paints of fills and strokes: colours and gradients, and whether they are visible."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from xml.etree import ElementTree as ET

import numpy as np

from ...geometry.arrays import FloatArray
from .colours import BLACK, CURRENT, Colour, colour_from, parsed_colour
from .document import Document
from .elements import link_of, name_of
from .gradients import Gradient, Stop
from .lengths import parse_length, share
from .style import Style, Styles

URL = re.compile(r"url\(\s*['\"]?\s*(#[^'\")\s]*)\s*['\"]?\s*\)\s*(.*)", re.DOTALL)
GRADIENTS = ("linearGradient", "radialGradient")
MAX_LINKS = 16
"""Maximum length of a chain of gradients that refer to each other."""


@dataclass(frozen=True)
class Paint:
    """A colour, or a gradient; `opacity` applies to both."""

    opacity: float
    colour: Colour = BLACK
    gradient: Gradient | None = None

    @property
    def alphas(self) -> FloatArray:
        """Opacities of the stops, or the one of a colour."""
        return self.gradient.alphas(self.opacity) if self.gradient else np.array([self.opacity])

    @property
    def rgba(self) -> tuple[float, float, float, float]:
        """Its sRGB and opacity; of a gradient, the mean of its stops."""
        colours = [stop.colour for stop in self.gradient.stops] if self.gradient else [self.colour]
        red, green, blue = np.mean([colour.rgb for colour in colours], axis=0).tolist()
        return red, green, blue, float(self.alphas.mean())


def link_in(value: str) -> tuple[str, str]:
    """The `#id` in a value such as "url(#id) none", and what comes after it; empty if there is none."""
    found = URL.match(value.strip())
    return (found[1], found[2].strip()) if found else ("", "")


def colour_of(text: str, style: Style) -> Colour | None:
    """A colour; None for none."""
    if text.strip().lower() == "none":
        return None
    found = parsed_colour(text)
    if found == CURRENT:
        found = parsed_colour(style.get("color", "black"))
    return found if isinstance(found, Colour) else Colour()


class Paints:
    """The paints of a document."""

    def __init__(self, document: Document, styles: Styles) -> None:
        self.document = document
        self.styles = styles
        self.gradients: dict[ET.Element, Gradient | None] = {}

    def paint(self, text: str, opacity: float, style: Style) -> Paint | None:
        """A visible paint; None for none."""
        link, instead = link_in(text)
        if not link:
            colour = colour_of(text, style)
            return Paint(opacity * colour.alpha, colour) if colour else None
        server = self.document.linked(link)
        if server is None:
            return self.paint(instead, opacity, style) if instead and "url(" not in instead else None
        if name_of(server) not in GRADIENTS:
            return self._pattern(server, opacity)
        if server not in self.gradients:
            self.gradients[server] = self._gradient(server)
        gradient = self.gradients[server]
        if gradient is None:
            return None
        if len({stop.colour for stop in gradient.stops}) == 1:
            colour = gradient.stops[0].colour
            return Paint(opacity * colour.alpha, colour)
        return Paint(opacity, gradient=gradient)

    def _pattern(self, item: ET.Element, opacity: float) -> Paint:
        """A pattern, which counts as a whole, in the mean colour of its fills, or else of its strokes."""
        styles = [self.styles.own(child) for child in item.iter() if child is not item]
        for key in ("fill", "stroke"):
            given = [colour_of(style[key], style) for style in styles if style.get(key)]
            found = np.array([colour.rgb for colour in given if colour is not None])
            if len(found):
                return Paint(opacity, colour_from(found.mean(axis=0)))
        return Paint(opacity)

    def _gradient(self, item: ET.Element) -> Gradient | None:
        """A gradient with the inherited attributes and stops; None without stops."""
        given: dict[str, str] = {}
        stops: list[Stop] = []
        link: ET.Element | None = item
        for _ in range(MAX_LINKS):
            if link is None or name_of(link) not in GRADIENTS:
                break
            given = {**link.attrib, **given}
            stops = stops or self._stops(link)
            link = self.document.linked(link_of(link))
        if not stops:
            return None
        of_box = given.get("gradientUnits", "") != "userSpaceOnUse"
        radial = name_of(item) == "radialGradient"
        return Gradient(
            radial,
            self._numbers(given, radial, of_box),
            of_box,
            self.document.transform(given.get("gradientTransform", ""), name_of(item)),
            tuple(stops),
            given.get("spreadMethod", "pad"),
        )

    def _numbers(self, given: Mapping[str, str], radial: bool, of_box: bool) -> tuple[float, ...]:
        """Lengths of a gradient; percentages refer to the box or the page."""
        viewport = self.document.viewport.sized(1.0, 1.0) if of_box else self.document.viewport

        def length(key: str, default: str) -> float:
            return parse_length(given.get(key) or default, key, f"{key} of the gradient", viewport)

        if not radial:
            return length("x1", "0%"), length("y1", "0%"), length("x2", "100%"), length("y2", "0%")
        cx, cy, r = length("cx", "50%"), length("cy", "50%"), length("r", "50%")
        return cx, cy, r, length("fx", repr(cx)), length("fy", repr(cy))

    def _stops(self, item: ET.Element) -> list[Stop]:
        stops: list[Stop] = []
        for child in item:
            if name_of(child) != "stop":
                continue
            own = self.styles.own(child)
            colour = colour_of(own.get("stop-color", "black"), own) or Colour(0.0)
            alpha = colour.alpha * share(own.get("stop-opacity"))
            before = stops[-1].offset if stops else 0.0
            stops.append(Stop(max(share(child.get("offset"), 0.0), before), replace(colour, alpha=alpha)))
        return stops
