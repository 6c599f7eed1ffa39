"""What readers of layered pictures return: layers with pixels, places, groups and masks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...errors import invalid_file
from ...formats.limits import Limits
from ...formats.pictures.png import Pixels

Opacities = NDArray[np.uint8]

LAYERED_LIMITS = Limits(bytes=2**30, elements=10_000, pixels=2**28)
"""Maximum input by default: size of a file, layers (Photoshop allows 8,000), and pixels of all layers together."""

MOST_DEPTH = 64
"""Maximum depth of groups in groups; Photoshop allows 10."""

MOST_NAMES = 5
"""Maximum number of names in a sentence."""

NORMAL, PASS_THROUGH = "normal", "pass through"
"""Blend modes: of layers, and of groups whose layers blend with what is below the group."""


@dataclass(frozen=True, eq=False)
class LayerMask:
    """Opacities that hide parts of a layer."""

    left: int
    top: int
    opacities: Opacities = field(repr=False)
    """(h, w), 255 where the layer shows."""
    outside: int = 0
    """Opacity beyond them."""

    def over(self, left: int, top: int, height: int, width: int) -> Opacities:
        """(height, width) opacities of the rectangle whose upper left corner is at (left, top)."""
        out = np.full((height, width), self.outside, np.uint8)
        rows, columns = self.opacities.shape
        x, y = self.left - left, self.top - top
        low, high = max(y, 0), min(y + rows, height)
        first, last = max(x, 0), min(x + columns, width)
        if low < high and first < last:
            out[low:high, first:last] = self.opacities[low - y : high - y, first - x : last - x]
        return out

    def thinned(self, density: int) -> LayerMask:
        """A mask that hides less: a density from 0 to 255."""
        if density == 255:
            return self
        opacities = 255 - (255 - self.opacities.astype(np.uint16)) * density // 255
        return LayerMask(self.left, self.top, opacities.astype(np.uint8), 255 - (255 - self.outside) * density // 255)


@dataclass(frozen=True, eq=False)
class Layer:
    """A layer or a group of layers."""

    name: str
    left: int = 0
    top: int = 0
    """Place of the upper left pixel on the canvas; y pointing down."""
    pixels: Pixels | None = field(default=None, repr=False)
    """(h, w, 4) red, green, blue and alpha, without the mask; None for groups and layers without pixels."""
    is_visible: bool = True
    opacity: float = 1.0
    blend: str = NORMAL
    is_clipped: bool = False
    """Whether it shows only where the layer below it is opaque."""
    masks: tuple[LayerMask, ...] = ()
    """Each hides a part of it."""
    children: tuple[Layer, ...] | None = None
    """Of a group, the lowest first; None for layers."""

    def walk(self) -> Iterator[Layer]:
        """This layer and all layers in it, the lowest first."""
        yield self
        for child in self.children or ():
            yield from child.walk()


@dataclass(frozen=True, eq=False)
class LayeredPicture:
    """A painting in layers."""

    width: int
    height: int
    layers: tuple[Layer, ...]
    """The lowest first."""
    notes: tuple[str, ...] = ()
    """Sentences about what was left out."""

    def walk(self) -> Iterator[Layer]:
        """All layers and groups, the lowest first."""
        for layer in self.layers:
            yield from layer.walk()


def check_depth(depth: int) -> None:
    """Raise NestedCagesError for groups in too many groups."""
    if depth > MOST_DEPTH:
        raise invalid_file(f"Groups lie in groups more than {MOST_DEPTH} deep; merge some.")


class Notes:
    """Sentences about layers: one for each thing that is to be said, with the names of the layers."""

    def __init__(self) -> None:
        self._names: dict[str, list[str]] = {}

    def add(self, sentence: str, name: str) -> None:
        """Say something of a layer. sentence: with {} where the names go."""
        self._names.setdefault(sentence, []).append(name)

    @property
    def sentences(self) -> tuple[str, ...]:
        """The sentences, each with at most a few names."""
        return tuple(sentence.format(_some_of(names)) for sentence, names in self._names.items())


def _some_of(names: list[str]) -> str:
    shown = ", ".join(names[:MOST_NAMES])
    return shown if len(names) <= MOST_NAMES else f"{shown} and {len(names) - MOST_NAMES} more"
