"""Krita (.kra): an archive with an XML document and tiles of pixels, after `kis_tiled_data_manager.cc` of Krita."""

from __future__ import annotations

import re
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import invalid_file
from ...formats.limits import Quota
from ...geometry.arrays import AnyArray
from .archive import Archive, whole
from .layer import NORMAL, Layer, LayeredPicture, LayerMask, Notes, check_depth

DOCUMENT = "maindoc.xml"

SPACES = {"RGBA": (4, 1), "RGBA16": (4, 2), "GRAYA": (2, 1), "GRAYAU16": (2, 2)}
"""Colour spaces that are read: numbers of channels, and bytes of each. Colours are blue, green, red, or grey."""

HEAD = re.compile(rb"VERSION 2\nTILEWIDTH 64\nTILEHEIGHT 64\nPIXELSIZE (\d{1,2})\nDATA (\d{1,9})\n")
TILE = re.compile(rb"(-?\d{1,7}),(-?\d{1,7}),LZF,(\d{1,6})\n")
"""Lines before all tiles, and before each."""

SIDE = 64
"""Pixels of a side of a tile."""


def read_krita(archive: Archive, quota: Quota) -> LayeredPicture:
    """The layers of a Krita file of 8 or 16 bits, in grey or RGB."""
    image = next(node for node in archive.document(DOCUMENT).iter() if _tag(node) == "IMAGE")
    width, height, notes = whole(image, "width"), whole(image, "height"), Notes()
    folder = next(name.partition("/layers/")[0] for name in archive.names if "/layers/" in name)

    def layers(parent: ET.Element, depth: int = 0) -> tuple[Layer, ...]:
        check_depth(depth)
        lists = [node for node in parent if _tag(node) in ("LAYERS", "layers")]
        return tuple(layer(node, depth) for nodes in lists for node in reversed(nodes) if _tag(node) == "layer")

    def layer(node: ET.Element, depth: int) -> Layer:
        quota.spend("elements", 1)
        name, kind = node.get("name", ""), node.get("nodetype")
        left, top, pixels = 0, 0, None
        if kind == "paintlayer":
            space = node.get("colorspacename", "")
            if space not in SPACES:
                raise invalid_file(f"The layer {name!r} has the colour space {space!r}; convert it to RGB with 8 bits.")
            channels, size = SPACES[space]
            left, top, found, _ = tiles(node, "", channels * size)
            values = found if size == 1 else np.round(found.view("<u2") / 257.0).astype(np.uint8)
            pixels = values[..., [2, 1, 0, 3] if channels == 4 else [0, 0, 0, 1]]
        elif kind != "grouplayer":
            notes.add("Layers that are not painted, such as vector, filter and file layers, are left out: {}.", name)
        return Layer(
            name,
            left,
            top,
            pixels,
            is_visible=node.get("visible") != "0",
            opacity=min(max(whole(node, "opacity", 255), 0), 255) / 255,
            blend=node.get("compositeop", NORMAL),
            is_clipped=node.get("channelflags", "").endswith("0"),  # the last is alpha, which then is inherited
            masks=masks_of(node, name),
            children=layers(node, depth + 1) if kind == "grouplayer" else None,
        )

    def masks_of(node: ET.Element, name: str) -> tuple[LayerMask, ...]:
        shown = [mask for nodes in node if _tag(nodes) == "masks" for mask in nodes if mask.get("visible") != "0"]
        masks = [mask for mask in shown if mask.get("nodetype") == "transparencymask"]
        if len(masks) < len(shown):
            notes.add("Masks other than transparency masks are left out: {}.", name)
        found = (tiles(mask, ".pixelselection", 1) for mask in masks)
        return tuple(LayerMask(left, top, opacities[..., 0], outside[0]) for left, top, opacities, outside in found)

    def tiles(node: ET.Element, ending: str, size: int) -> tuple[int, int, AnyArray, bytes]:
        """Left, top and (h, w, size) bytes of the pixels of a node, and the bytes of one that no tile has."""
        path = f"{folder}/layers/{node.get('filename')}{ending}"
        default = archive.read(f"{path}.defaultpixel") if f"{path}.defaultpixel" in archive.names else bytes(size)
        data, at, found = archive.read(path), 0, dict[tuple[int, int], bytes]()
        head = HEAD.match(data)
        if head is None or int(head[1]) != size:
            raise invalid_file(f"The file is damaged: '{path}' has no tiles of known pixels. Save it again.")
        for _ in range(int(head[2])):
            tile = TILE.match(data, at or head.end())
            assert tile is not None
            at = tile.end() + int(tile[3])
            found[int(tile[1]), int(tile[2])] = data[tile.end() : at]
        whole_canvas = [(0, 0), (max(width - SIDE, 0), max(height - SIDE, 0))] if any(default) else []
        corners = np.array([*found, *whole_canvas], dtype=np.int64).reshape(-1, 2)
        (left, top), (right, bottom) = (f(corners, axis=0, initial=0).tolist() for f in (np.min, np.max))
        quota.spend("pixels", (bottom - top + SIDE) * (right - left + SIDE))
        out = np.empty((bottom - top + SIDE, right - left + SIDE, size), np.uint8)
        out[:] = np.frombuffer(default, np.uint8)
        for (x, y), packed in found.items():
            out[y - top : y - top + SIDE, x - left : x - left + SIDE] = _tile(packed, size)
        return left + whole(node, "x"), top + whole(node, "y"), out, default

    return LayeredPicture(width, height, layers(image), notes.sentences)


def _tag(node: ET.Element) -> str:
    """The name of an element without its namespace."""
    return node.tag.rpartition("}")[2]


def _tile(packed: bytes, size: int) -> AnyArray:
    """(64, 64, size) bytes of a tile; one packed by LZF, which its first byte says, has one plane after the other."""
    if packed[:1] != b"\1":
        return np.frombuffer(packed[1:], np.uint8).reshape(SIDE, SIDE, size)
    return (
        np.frombuffer(_unpacked(packed[1:], SIDE * SIDE * size), np.uint8).reshape(size, SIDE, SIDE).transpose(1, 2, 0)
    )


def _unpacked(packed: bytes, size: int) -> bytes:
    """Bytes that LibLZF packed: runs of new ones, and copies of what came before."""
    out, at = bytearray(), 0
    while at < len(packed) and len(out) < size:
        control, at = packed[at], at + 1
        if control < 32:
            out += packed[at : at + control + 1]
            at += control + 1
            continue
        length, at = (7 + packed[at], at + 1) if control >> 5 == 7 else (control >> 5, at)
        start, at = len(out) - ((control & 31) << 8) - packed[at] - 1, at + 1
        for k in range(start, start + length + 2):  # may overlap what it writes
            out.append(out[k])
    return bytes(out)
