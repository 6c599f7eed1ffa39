"""Filters that blur, move and fade, as far as they change the painted area (Filter Effects 1, section 9)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import scipy

from ...errors import NestedCagesError
from ...geometry.arrays import FloatArray
from .lengths import Viewport, measure, name_of, numbers, share
from .style import Styles
from .transforms import moved

BOX = 3.0 * np.sqrt(2.0 * np.pi) / 4.0
"""Width of each of the three successive boxes that approximate a blur, in standard deviations."""

BLUR_SEGMENTS = 16
"""Chords of a quarter circle around a blurred corner."""

FADING_REACH = 0.55
"""Reach of the blur of a shape that fades towards its edge, relative to one that does not (measured)."""

MAX_LAYERS = 256
"""Maximum number of layers of a filter; each merge can double them."""

LEAST_RATIO = 1e-3
"""Smallest ratio of the two standard deviations of a blur; replaces a zero."""


@dataclass(frozen=True, eq=False)
class Layer:
    """A region in the units of the filtered element, as opaque as `alpha` inside and blurred at its edge."""

    region: Any
    alpha: float
    blur: FloatArray = field(default_factory=lambda: np.zeros(2))
    """(2,) standard deviations along x and y."""
    fades: bool = False
    """Whether it fades away towards its edge, so that blurring widens it less."""
    within: Any = None
    """Region kept after blurring; all if None."""

    def seen(self, shapely: Any, faintest: float) -> Any:
        """The region where it is more opaque than `faintest`; exact for straight edges."""
        if not self.alpha > faintest:
            return shapely.Polygon()
        region = self.region
        largest = float(self.blur.max())
        if largest > 0.0:
            unit = np.maximum(self.blur, LEAST_RATIO * largest)
            region = shapely.transform(region, lambda xy: xy / unit)
            reach = _reach(faintest / self.alpha) * (FADING_REACH if self.fades else 1.0)
            region = shapely.buffer(region, reach, quad_segs=BLUR_SEGMENTS)
            region = shapely.transform(region, lambda xy: xy * unit)
        return region if self.within is None else shapely.intersection(region, self.within)

    def kept(self, shapely: Any, within: Any, alpha: float) -> Layer:
        """The part of it that lies within a region, faded."""
        both = within if self.within is None else shapely.intersection(within, self.within)
        return replace(self, within=both, alpha=self.alpha * alpha)


def _reach(share: float) -> float:
    """Distance from a straight edge at which a blur has fallen to a share, in standard deviations."""
    if share < 1.0 / 6.0:  # in the tail of the third box
        return float(BOX * (1.5 - np.cbrt(6.0 * share)))
    return float(scipy.special.ndtri(1.0 - share))


Layers = list[Layer]

OPERATORS = ("over", "in", "out")
"""Supported ways to composite."""


@dataclass(frozen=True, eq=False)
class Filter:
    """A filter on a group."""

    item: ET.Element
    styles: Styles
    matrix: FloatArray
    """From the units of the group to those of the document."""
    viewport: Viewport


def is_known(item: ET.Element) -> bool:
    """Whether all parts of a filter are supported: those that five of 20,000 public drawings use are not."""
    parts = [child for child in item if name_of(child).startswith("fe")]
    return all(name_of(part) in KNOWN and part.get("operator", "over") in OPERATORS for part in parts)


def filtered(shapely: Any, source: Layer, by: Filter, matrix: FloatArray, faintest: float) -> Any:
    """The area that a filter paints in the document; matrix: from the units of the filtered group to it."""
    if np.linalg.det(matrix[:2, :2]) == 0.0 or source.region.is_empty:
        return source.region
    inverse = np.asarray(np.linalg.inv(matrix), np.float64)
    region = shapely.transform(source.region, lambda xy: moved(xy, inverse))
    x0, y0, x1, y1 = shapely.bounds(region)
    whole = shapely.box(*_region(by, (x0, y0, x1 - x0, y1 - y0)))
    step = _Step(shapely, by.styles, whole, faintest, {"SourceGraphic": [replace(source, region=region)]})
    step.results["SourceAlpha"] = step.results["SourceGraphic"]
    step.last = step.results["SourceGraphic"]
    children = [child for child in by.item if name_of(child) in KNOWN]
    for child in children:
        step.last = KNOWN[name_of(child)](step, child)
        if len(step.last) > MAX_LAYERS:
            raise NestedCagesError(
                f"A filter merges more than {MAX_LAYERS} layers; simplify it.", code="limit.exceeded"
            )
        if child.get("result"):
            step.results[child.get("result", "")] = step.last
    seen = shapely.union_all([layer.seen(shapely, faintest) for layer in step.last] if children else [])
    return shapely.transform(shapely.intersection(seen, whole), lambda xy: moved(xy, matrix))


def _region(by: Filter, box: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """Corners of the filter region, given the box of the source."""
    of_box = by.item.get("filterUnits", "objectBoundingBox") == "objectBoundingBox"
    viewport = by.viewport.sized(1.0, 1.0) if of_box else by.viewport
    default = {"x": "-10%", "y": "-10%", "width": "120%", "height": "120%"}
    x, y, width, height = (
        measure(by.item.get(key) or default[key], key, f"{key} of the filter", viewport) for key in default
    )
    if of_box:
        x, y, width, height = box[0] + x * box[2], box[1] + y * box[3], width * box[2], height * box[3]
    return x, y, x + width, y + height


@dataclass(eq=False)
class _Step:
    """State between two parts of a filter."""

    shapely: Any
    styles: Styles
    whole: Any
    faintest: float
    results: dict[str, Layers]
    last: Layers = ()  # type: ignore[assignment]

    @property
    def size(self) -> float:
        """The longer side of the whole; larger blurs or offsets make things invisible."""
        x0, y0, x1, y1 = self.shapely.bounds(self.whole)
        return float(max(x1 - x0, y1 - y0))

    def input(self, item: ET.Element, key: str = "in") -> Layers:
        name = item.get(key, "")
        if name in ("BackgroundImage", "BackgroundAlpha"):
            return []
        return self.results.get(name, self.last)

    def seen(self, layers: Layers) -> Any:
        return self.shapely.union_all([layer.seen(self.shapely, self.faintest) for layer in layers])


def _pair(item: ET.Element, key: str) -> FloatArray:
    given = np.nan_to_num(numbers(item.get(key, "0"))[:2] or [0.0])
    return np.array([given[0], given[-1]])


def _number(item: ET.Element, key: str, missing: float) -> float:
    found = (numbers(item.get(key, "")) or [missing])[0]
    return found if np.isfinite(found) else missing


def _blur(step: _Step, item: ET.Element) -> Layers:
    added = np.clip(_pair(item, "stdDeviation"), 0.0, step.size)
    return [replace(layer, blur=np.hypot(layer.blur, added)) for layer in step.input(item)]


def _offset(step: _Step, item: ET.Element) -> Layers:
    by = np.array([_number(item, key, 0.0) for key in ("dx", "dy")])
    return [
        replace(
            layer,
            region=_moved(step, layer.region, by),
            within=_moved(step, layer.within, by),
        )
        for layer in step.input(item)
    ]


def _moved(step: _Step, region: Any, by: FloatArray) -> Any:
    return None if region is None else step.shapely.transform(region, lambda xy: xy + by)


def _shadow(step: _Step, item: ET.Element) -> Layers:
    own = step.styles.own(item)
    opacity = share(own.get("flood-opacity"))
    source = step.input(item)
    blur = np.clip(_pair(item, "stdDeviation") if item.get("stdDeviation") else np.full(2, 2.0), 0.0, step.size)
    by = np.array([_number(item, key, 2.0) for key in ("dx", "dy")])
    shadows = [
        Layer(_moved(step, layer.region, by), layer.alpha * opacity, np.hypot(layer.blur, blur)) for layer in source
    ]
    return [*shadows, *source]


def _flood(step: _Step, item: ET.Element) -> Layers:
    return [Layer(step.whole, share(step.styles.own(item).get("flood-opacity")))]


def _colour_matrix(step: _Step, item: ET.Element) -> Layers:
    """Layers with another opacity; what the matrix makes of nothing covers the whole."""
    values = numbers(item.get("values", ""))
    if item.get("type", "matrix") != "matrix" or len(values) != 20:
        return step.input(item)
    nothing = min(max(values[19], 0.0), 1.0)
    found = [
        replace(layer, alpha=min(max(values[18] * layer.alpha + values[19], 0.0), 1.0)) for layer in step.input(item)
    ]
    return [Layer(step.whole, nothing), *found] if nothing > step.faintest else found


def _composite(step: _Step, item: ET.Element) -> Layers:
    first, second = step.input(item), step.input(item, "in2")
    operator = item.get("operator", "over")
    if operator in ("in", "out"):
        within, alpha = step.seen(second), 1.0
        if operator == "in":
            alpha = max((layer.alpha for layer in second), default=0.0)
        else:
            within = step.shapely.difference(step.whole, within)
        return [layer.kept(step.shapely, within, alpha) for layer in first]
    return [*second, *first]


def _merge(step: _Step, item: ET.Element) -> Layers:
    return [layer for node in item if name_of(node) == "feMergeNode" for layer in step.input(node)]


def _blend(step: _Step, item: ET.Element) -> Layers:
    return [*step.input(item, "in2"), *step.input(item)]


KNOWN: dict[str, Callable[[_Step, ET.Element], Layers]] = {
    "feGaussianBlur": _blur,
    "feOffset": _offset,
    "feDropShadow": _shadow,
    "feFlood": _flood,
    "feColorMatrix": _colour_matrix,
    "feComposite": _composite,
    "feMerge": _merge,
    "feBlend": _blend,
}
"""Supported parts of filters."""
