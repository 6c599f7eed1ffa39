"""The painted parts of a layered picture: what an artist sees of each layer, with masks and clipping applied."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...formats.pictures.png import Pixels
from ...geometry.arrays import FloatArray
from .layer import NORMAL, PASS_THROUGH, Layer, LayeredPicture, LayerMask, Notes, Opacities

BLENDS = (NORMAL, "multiply", "screen", "add")
"""Blend modes that game engines have too; others become normal."""

COVERED = 0.99
"""Smallest fraction of the canvas that an opaque background covers."""

FAINTEST = 1e-9
"""Opacity below which a colour means nothing."""


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
    masks: tuple[LayerMask, ...] = ()


def parts_of(picture: LayeredPicture, *, hidden: bool = False) -> tuple[tuple[PicturePart, ...], tuple[str, ...]]:
    """The parts, the lowest first, and notes on what was left out or merged.

    A layer that is clipped is painted onto the one below it. The lowest one is left out if it covers the whole canvas.
    hidden: whether hidden layers become hidden parts.
    """
    notes = Notes()
    found = list(_parts(picture.layers, _Inherited(), notes))
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


def _parts(layers: tuple[Layer, ...], inherited: _Inherited, notes: Notes) -> Iterator[PicturePart]:
    """The parts of layers in a group, the lowest first; what is clipped to a group is painted onto its layers."""
    number = 0
    while number < len(layers):
        layer, number = layers[number], number + 1
        clipped = list[Layer]()
        while number < len(layers) and layers[number].is_clipped and not layer.is_clipped:
            clipped += _shown(layers[number])
            number += 1
        own = [_part(layer, inherited, notes)] if layer.children is None else _inside(layer, inherited, notes)
        for part in own:
            if part is not None:
                for above in clipped:
                    notes.add("Clipped layers are painted onto those below them: {}.", above.name)
                yield _with(part, clipped, notes) if clipped else part


def _shown(layer: Layer) -> Iterator[Layer]:
    """A layer that is seen, or those of a group."""
    if layer.is_visible and layer.pixels is not None and layer.pixels.size:
        yield layer
    for child in layer.children or () if layer.is_visible else ():
        yield from _shown(child)


def _inside(group: Layer, inherited: _Inherited, notes: Notes) -> Iterator[PicturePart]:
    """The parts of the layers in a group."""
    if group.blend not in (NORMAL, PASS_THROUGH):
        notes.add("Blend modes of groups are left out: {}.", group.name)
    if group.opacity < 1.0:
        notes.add("The opacity of a group becomes that of each of its layers: {}.", group.name)
    within = _Inherited(
        (*inherited.groups, group.name),
        inherited.opacity * group.opacity,
        inherited.is_visible and group.is_visible,
        (*inherited.masks, *group.masks),
    )
    return _parts(group.children or (), within, notes)


def _part(layer: Layer, inherited: _Inherited, notes: Notes) -> PicturePart | None:
    """The part of a layer; None if nothing is painted."""
    pixels, opacity = layer.pixels, layer.opacity * inherited.opacity
    masked = None if pixels is None else _masked(pixels, layer, (*layer.masks, *inherited.masks))
    if masked is None or not (np.round(masked[..., 3] * opacity) > 0.0).any():
        notes.add("Layers without pixels are left out: {}.", layer.name)
        return None
    opaque = np.round(masked[..., 3] * opacity) > 0.0
    rows, columns = np.flatnonzero(opaque.any(axis=1)), np.flatnonzero(opaque.any(axis=0))
    return PicturePart(
        layer.name,
        inherited.groups,
        layer.left + int(columns[0]),
        layer.top + int(rows[0]),
        np.ascontiguousarray(masked[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]),
        opacity,
        _known(layer, notes),
        layer.is_visible and inherited.is_visible,
    )


def _known(layer: Layer, notes: Notes) -> str:
    if layer.blend in BLENDS:
        return layer.blend
    notes.add(f"The blend mode {layer.blend} becomes normal: {{}}.", layer.name)
    return NORMAL


def _masked(pixels: Pixels, layer: Layer, masks: Sequence[LayerMask]) -> Pixels:
    """Pixels of a layer where masks show them."""
    out = np.array(pixels)
    for mask in masks:
        out[..., 3] = _multiplied(out[..., 3], mask.over(layer.left, layer.top, *pixels.shape[:2]))
    return out


def _multiplied(first: Opacities, second: Opacities) -> Opacities:
    return ((first.astype(np.uint16) * second + 127) // 255).astype(np.uint8)


def _with(part: PicturePart, clipped: Sequence[Layer], notes: Notes) -> PicturePart:
    """A part with layers painted onto it, where it is opaque."""
    pixels = np.array(part.pixels)
    for above in clipped:
        assert above.pixels is not None
        seen = _masked(above.pixels, above, above.masks)
        above = replace(above, pixels=seen, blend=_known(above, notes))
        paint_onto(pixels, part.left, part.top, above, is_clipped=True)
    return replace(part, pixels=pixels)


def paint_onto(pixels: Pixels, left: int, top: int, above: Layer, *, is_clipped: bool = False) -> None:
    """Paint a layer onto pixels (h, w, 4) whose upper left corner is at (left, top); if clipped, where these are opaque
    (W3C Compositing and Blending: source over, source atop)."""
    assert above.pixels is not None
    x, y = above.left - left, above.top - top
    height, width = above.pixels.shape[:2]
    box = np.s_[max(y, 0) : max(y + height, 0), max(x, 0) : max(x + width, 0)]
    below = pixels[box] / 255.0
    source = above.pixels[max(-y, 0) : max(-y, 0) + below.shape[0], max(-x, 0) : max(-x, 0) + below.shape[1]] / 255.0
    covered, under = source[..., 3:] * above.opacity, np.ones_like(below[..., 3:]) if is_clipped else below[..., 3:]
    mixed = (1.0 - under) * source[..., :3] + under * _blended(below[..., :3], source[..., :3], above.blend)
    light = covered * mixed + (1.0 - covered) * under * below[..., :3]
    alpha = covered + under * (1.0 - covered)
    pixels[box][..., :3] = np.round(255.0 * light / np.maximum(alpha, FAINTEST))
    if not is_clipped:
        pixels[box][..., 3:] = np.round(255.0 * alpha)


def _blended(below: FloatArray, above: FloatArray, blend: str) -> FloatArray:
    """Colours where both are opaque."""
    if blend == "multiply":
        return below * above
    if blend == "screen":
        return below + above - below * above
    return np.minimum(below + above, 1.0) if blend == "add" else above
