"""PSD and PSB, after Adobe's "Photoshop File Formats Specification"."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from ..errors import invalid_file
from ..formats.limits import Limits, Quota
from .byte_reader import ByteReader
from .layer import NORMAL, PASS_THROUGH, Layer, LayeredPicture, LayerMask, Notes, Opacities, check_depth
from .psd_pixels import MODES, coloured, plane

SIGNATURE = b"8BPS"

LONG_KEYS = {b"LMsk", b"Lr16", b"Lr32", b"Layr", b"Mt16", b"Mt32", b"Mtrn", b"Alph", b"FMsk", b"lnk2", b"FEid"} | {
    b"FXid",
    b"PxSD",
    b"lnkE",
    b"extd",
    b"cinf",
}
"""Tagged blocks whose lengths have eight bytes in a PSB."""

LAYERS_OF_DEEP_FILES = (b"Lr16", b"Lr32", b"Layr")
"""Tagged blocks with the layers of files of 16 and 32 bits."""

BLENDS = {
    "norm": NORMAL,
    "pass": PASS_THROUGH,
    "mul": "multiply",
    "scrn": "screen",
    "lddg": "add",
    "over": "overlay",
    "dark": "darken",
    "lite": "lighten",
    "sLit": "soft light",
    "hLit": "hard light",
    "diff": "difference",
    "div": "colour dodge",
    "idiv": "colour burn",
}
"""Names of blend modes; others keep their keys."""

HIDDEN, MASK_OFF, MASK_HAS_PARAMETERS = 2, 2, 16
"""Bits of flags of a layer and of its mask."""

COLOUR, ALPHA, MASK = 0, -1, -2
"""Numbers of channels."""

LAYER, OPEN_GROUP, CLOSED_GROUP, END_OF_GROUP = range(4)
"""Kinds of records: a group is its layers between an end, which comes first, and its own record."""

EFFECTS, VECTOR_MASKS = {b"lrFX", b"lfx2", b"lmfx"}, {b"vmsk", b"vsms"}
"""Tagged blocks that are not read, but told."""

FLAGS_OF_MASK_PARAMETERS = {1: 1, 2: 8, 4: 1, 8: 8}
"""Lengths of the parameters of masks by their bits: density and feather, of the mask and of a vector mask."""


@dataclass
class _Record:
    """What the file says of a layer before its pixels."""

    layer: Layer
    kind: int
    size: tuple[int, int]
    """Height and width."""
    channels: list[tuple[int, int]]
    """Their numbers and lengths in bytes."""
    mask_place: tuple[int, int, int, int, int] | None = None
    """Left, top, height, width and the opacity outside."""
    mask_density: int = 255
    tags: set[bytes] = field(default_factory=set)


def read_psd(data: bytes, limits: Limits) -> LayeredPicture:
    """The layers of a PSD or PSB: 8, 16 or 32 bits, in grey, RGB or CMYK. Raises NestedCagesError."""
    file = ByteReader(data)
    if bytes(file.take(4)) != SIGNATURE:
        raise invalid_file("This is not a PSD.")
    version, _, _, height, width, depth, mode = file.numbers("H6sHIIHH")
    big = version == 2
    if mode not in MODES or depth not in (8, 16, 32):
        raise invalid_file(f"Colour mode {mode} with {depth} bits is not read. Convert the picture to RGB with 8 bits.")
    file.block()  # colour table
    file.block()  # resources
    section = file.block("Q" if big else "I") if file.left else ByteReader(b"")
    info = section.block("Q" if big else "I") if section.left else section
    if not info.left and section.left:
        section.block()  # global mask
        for key, block in _tagged(section, big):
            if key in LAYERS_OF_DEEP_FILES:
                info = ByteReader(block)
    notes = Notes()
    records = _all_layers(info, big, depth, mode, Quota(limits), notes) if info.left else []
    return LayeredPicture(width, height, _nested(records), notes.sentences)


def _tagged(file: ByteReader, big: bool) -> Iterator[tuple[bytes, memoryview]]:
    """Tagged blocks, as far as they go."""
    while file.left >= 12:
        signature, key = bytes(file.take(4)), bytes(file.take(4))
        if signature not in (b"8BIM", b"8B64"):
            return
        length = file.number("Q" if big and key in LONG_KEYS else "I")
        yield key, file.take(length)
        while length % 4 and file.left and file.data[file.at] == 0:  # padded by some programs, not by all
            length += 1
            file.take(1)


def _all_layers(
    info: ByteReader, big: bool, depth: int, mode: int, quota: Quota, notes: Notes
) -> list[tuple[Layer, int]]:
    """Layers with their kinds, the lowest first."""
    records = []
    for _ in range(abs(info.number("h"))):
        quota.spend("elements", 1)
        records.append(_record(info, big))
        height, width = records[-1].size
        quota.spend("pixels", height * width)
        if records[-1].mask_place is not None:
            quota.spend("pixels", records[-1].mask_place[2] * records[-1].mask_place[3])
    return [(_with_pixels(record, info, big, depth, mode, notes), record.kind) for record in records]


def _record(info: ByteReader, big: bool) -> _Record:
    top, left, bottom, right, count = info.numbers("iiiiH")
    channels = [info.numbers("hQ" if big else "hI") for _ in range(count)]
    _, blend, opacity, clipping, flags, _ = info.numbers("4s4sBBBB")
    extra = info.block()
    mask = extra.block()
    extra.block()  # ranges of blending
    name = bytes(extra.take(extra.number("B"))).decode("macroman")
    extra.take(min(-(len(name) + 1) % 4, extra.left))
    identity, kind, fill, tags = "", LAYER, 255, set()
    for key, block in _tagged(extra, big):
        tags.add(key)
        if key == b"luni":
            text = ByteReader(block)
            name = bytes(text.take(2 * text.number("I"))).decode("utf-16-be", errors="replace").rstrip("\0")
        elif key == b"lyid":
            identity = str(ByteReader(block).number("I"))
        elif key in (b"lsct", b"lsdk"):
            found = ByteReader(block).number("I")
            kind = found if found in (OPEN_GROUP, CLOSED_GROUP, END_OF_GROUP) else LAYER
        elif key == b"iOpa":
            fill = ByteReader(block).number("B")
    layer = Layer(
        name,
        identity,
        left,
        top,
        is_visible=not flags & HIDDEN,
        opacity=(opacity / 255) * (fill / 255),
        blend=BLENDS.get(blend.decode("latin-1").strip(), blend.decode("latin-1").strip()),
        is_clipped=bool(clipping),
    )
    size = (max(bottom - top, 0), max(right - left, 0))
    record = _Record(layer, kind, size, channels, tags=tags)
    if mask.left >= 18:
        m_top, m_left, m_bottom, m_right, outside, m_flags = mask.numbers("iiiiBB")
        if not m_flags & MASK_OFF:
            record.mask_place = (m_left, m_top, max(m_bottom - m_top, 0), max(m_right - m_left, 0), outside)
            record.mask_density = _density_of_mask(mask) if m_flags & MASK_HAS_PARAMETERS else 255
    return record


def _density_of_mask(mask: ByteReader) -> int:
    """How much a mask hides, up to 255, from the parameters at its end."""
    bits = mask.number("B") if mask.left else 0
    for bit, length in FLAGS_OF_MASK_PARAMETERS.items():
        if bits & bit and mask.left >= length:
            parameter = mask.take(length)
            if bit == 1:
                return parameter[0]
    return 255


def _with_pixels(record: _Record, info: ByteReader, big: bool, depth: int, mode: int, notes: Notes) -> Layer:
    """The layer of a record, with the channels that come next in the file."""
    height, width = record.size
    planes: dict[int, Opacities] = {}
    mask = None
    for number, length in record.channels:
        block = info.take(length)
        if number == MASK and record.mask_place is not None:
            left, top, rows, columns, outside = record.mask_place
            shown = np.zeros((rows, columns), np.uint8)
            if shown.size:
                shown = plane(block, (rows, columns), depth, big=big, is_colour=False)
            mask = LayerMask(left, top, shown, outside).thinned(record.mask_density)
        elif number >= ALPHA and height and width and record.kind == LAYER:
            planes[number] = plane(block, record.size, depth, big=big, is_colour=number >= COLOUR)
    if record.kind == LAYER:
        for tags, sentence in (
            (EFFECTS, "Effects of layers, such as shadows and outlines, are left out: {}."),
            (VECTOR_MASKS, "Vector masks are left out: {}."),
        ):
            if tags & record.tags:
                notes.add(sentence, record.layer.name)
    pixels = coloured(planes, height, width, mode) if planes else None
    return replace(record.layer, pixels=pixels, mask=mask)


def _nested(records: list[tuple[Layer, int]]) -> tuple[Layer, ...]:
    """Layers in their groups."""
    stack: list[list[Layer]] = [[]]
    for layer, kind in records:
        if kind == END_OF_GROUP:
            check_depth(len(stack))
            stack.append([])
        elif kind in (OPEN_GROUP, CLOSED_GROUP):
            inside = stack.pop() if len(stack) > 1 else []
            stack[-1].append(replace(layer, pixels=None, children=tuple(inside)))
        else:
            stack[-1].append(layer)
    while len(stack) > 1:
        unclosed = stack.pop()
        stack[-1] += unclosed
    return tuple(stack[0])
