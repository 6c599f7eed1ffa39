"""The painted parts of a layered picture: what an artist sees of each layer, with masks and clipping applied."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ..formats.pictures.png import Pixels
from ..geometry.arrays import FloatArray
from .layer import NORMAL, PASS_THROUGH, Layer, LayeredPicture, Notes, Opacities

BLENDS = (NORMAL, "multiply", "screen", "add")
"""Blend modes that game engines have too; others become normal."""

COVERED = 0.99
"""Smallest fraction of the canvas that an opaque background covers."""


@dataclass(frozen=True, eq=False)
class PicturePart:
    """A painted part of a picture."""

    name: str
    groups: tuple[str, ...]
    """Names of the groups around it, the outermost first."""
    left: int
    top: int
    pixels: Pixels = field(repr=False)
    """(h, w, 4) as seen, without transparent margins."""
    opacity: float = 1.0
    blend: str = NORMAL
    is_visible: bool = True

    @property
    def seen(self) -> Pixels:
        """(h, w, 4) its pixels with its opacity in them."""
        if self.opacity == 1.0:
            return self.pixels
        pixels = self.pixels.copy()
        pixels[..., 3] = np.round(pixels[..., 3] * self.opacity)
        return pixels

    @property
    def path(self) -> str:
        """Groups and name."""
        return "/".join((*self.groups, self.name))


@dataclass(frozen=True)
class _Inherited:
    """What groups do to the layers in them."""

    groups: tuple[str, ...] = ()
    opacity: float = 1.0
    is_visible: bool = True
    masked: tuple[Layer, ...] = ()
    """Groups with masks."""


def parts_of(picture: LayeredPicture, *, hidden: bool = False) -> tuple[tuple[PicturePart, ...], tuple[str, ...]]:
    """The parts, the lowest first, and notes on what was left out or merged.

    A layer that is clipped is painted onto the one below it. The lowest one is left out if it covers the whole canvas.
    hidden: whether hidden layers become hidden parts.
    """
    notes = Notes()
    found = [part for part in _parts(picture.layers, _Inherited(), notes) if part is not None]
    if len(found) > 1 and _is_background(found[0], picture):
        notes.add("Backgrounds are left out: {}.", found.pop(0).name)
    if not hidden:
        for part in found:
            if not part.is_visible:
                notes.add("Hidden layers are left out: {}.", part.name)
        found = [part for part in found if part.is_visible]
    return tuple(found), (*picture.notes, *notes.sentences)


def _is_background(part: PicturePart, picture: LayeredPicture) -> bool:
    """Whether a part covers the canvas."""
    bottom, right = (max(end, 0) for end in (picture.height - part.top, picture.width - part.left))
    inside = part.seen[max(-part.top, 0) : bottom, max(-part.left, 0) : right]
    return bool(np.count_nonzero(inside[..., 3] == 255) >= COVERED * picture.width * picture.height)


def _parts(layers: tuple[Layer, ...], inherited: _Inherited, notes: Notes) -> Iterator[PicturePart | None]:
    """The parts of layers in a group, the lowest first."""
    number = 0
    while number < len(layers):
        layer, number = layers[number], number + 1
        if layer.children is not None:
            yield from _parts(layer.children, _inside_group(layer, inherited, notes), notes)
            continue
        clipped = []
        while number < len(layers) and layers[number].is_clipped:
            clipped.append(layers[number])
            number += 1
        yield _part(layer, clipped, inherited, notes)


def _inside_group(group: Layer, inherited: _Inherited, notes: Notes) -> _Inherited:
    """What a group and those around it do to its layers."""
    if group.blend not in (NORMAL, PASS_THROUGH):
        notes.add("Blend modes of groups are left out: {}.", group.name)
    if group.is_clipped:
        notes.add("Clipping of groups is left out: {}.", group.name)
    if group.opacity < 1.0:
        notes.add("The opacity of a group becomes that of each of its layers: {}.", group.name)
    return _Inherited(
        (*inherited.groups, group.name),
        inherited.opacity * group.opacity,
        inherited.is_visible and group.is_visible,
        (*inherited.masked, group) if group.mask is not None else inherited.masked,
    )


def _part(layer: Layer, clipped: list[Layer], inherited: _Inherited, notes: Notes) -> PicturePart | None:
    """The part of a layer and of those that are clipped to it; None if nothing is painted."""
    if layer.pixels is None or not layer.pixels.size:
        notes.add("Layers without pixels are left out: {}.", layer.name)
        return None
    pixels = np.array(layer.pixels)
    height, width = pixels.shape[:2]
    for masked in (layer, *inherited.masked):
        if masked.mask is not None:
            pixels[..., 3] = _multiplied(pixels[..., 3], masked.mask.over(layer.left, layer.top, height, width))
    for above in clipped:
        if above.is_visible and above.pixels is not None and above.pixels.size:
            _paint_onto(pixels, layer, above, notes)
            notes.add("Clipped layers are painted onto those below them: {}.", above.name)
    opacity = layer.opacity * inherited.opacity
    opaque = np.round(pixels[..., 3] * opacity) > 0.0
    if not opaque.any():
        notes.add("Layers without pixels are left out: {}.", layer.name)
        return None
    rows, columns = np.flatnonzero(opaque.any(axis=1)), np.flatnonzero(opaque.any(axis=0))
    blend = _known(layer, notes)
    return PicturePart(
        layer.name,
        inherited.groups,
        layer.left + int(columns[0]),
        layer.top + int(rows[0]),
        np.ascontiguousarray(pixels[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]),
        opacity,
        blend,
        layer.is_visible and inherited.is_visible,
    )


def _known(layer: Layer, notes: Notes) -> str:
    if layer.blend in BLENDS:
        return layer.blend
    notes.add(f"The blend mode {layer.blend} becomes normal: {{}}.", layer.name)
    return NORMAL


def _multiplied(first: Opacities, second: Opacities) -> Opacities:
    return ((first.astype(np.uint16) * second + 127) // 255).astype(np.uint8)


def _paint_onto(pixels: Pixels, base: Layer, above: Layer, notes: Notes) -> None:
    """Blend a clipped layer onto the pixels of its base, whose opacity stays."""
    height, width = pixels.shape[:2]
    painted = above.pixels
    assert painted is not None
    top, left = max(above.top - base.top, 0), max(above.left - base.left, 0)
    bottom = min(above.top - base.top + painted.shape[0], height)
    right = min(above.left - base.left + painted.shape[1], width)
    if top >= bottom or left >= right:
        return
    x, y = base.left - above.left, base.top - above.top
    source = painted[top + y : bottom + y, left + x : right + x].astype(np.float64) / 255.0
    alpha = source[..., 3:] * above.opacity
    if above.mask is not None:
        hidden = above.mask.over(base.left + left, base.top + top, bottom - top, right - left)
        alpha = alpha * (hidden[..., None] / 255.0)
    below = pixels[top:bottom, left:right, :3].astype(np.float64) / 255.0
    mixed = below + alpha * (_blended(below, source[..., :3], _known(above, notes)) - below)
    pixels[top:bottom, left:right, :3] = (255.0 * mixed + 0.5).astype(np.uint8)


def _blended(below: FloatArray, above: FloatArray, blend: str) -> FloatArray:
    """Colours where both are opaque."""
    if blend == "multiply":
        return below * above
    if blend == "screen":
        return below + above - below * above
    return np.minimum(below + above, 1.0) if blend == "add" else above
