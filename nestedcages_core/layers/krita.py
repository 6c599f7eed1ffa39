"""Krita (.kra): an archive with an XML document and tiles of pixels, after `kis_tiled_data_manager.cc` of Krita."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np

from ..errors import invalid_file
from ..formats.limits import Quota
from ..formats.pictures.png import Pixels
from ..geometry.arrays import AnyArray
from .archive import Archive, whole
from .layer import NORMAL, Layer, LayeredPicture, LayerMask, Notes, check_depth
from .lzf import unpacked
from .psd_pixels import narrowed

DOCUMENT = "maindoc.xml"

SPACES = {"RGBA": (4, 1), "RGBA16": (4, 2), "GRAYA": (2, 1), "GRAYAU16": (2, 2)}
"""Colour spaces that are read: numbers of channels, and bytes of each. Colours are blue, green, red, or grey."""

BLENDS = {"normal": NORMAL, "pass through": "pass through", "multiply": "multiply", "screen": "screen", "add": "add"}
"""Names of composite operations that have others here."""

HELD_ALPHA = "0"
"""Last of the channel flags of a layer that inherits alpha."""

MOST_IN_TILE = 2**16
"""Maximum number of pixels in a tile; Krita makes 64 by 64."""

MOST_IN_LINE = 100
"""Maximum number of bytes in a line before tiles."""


def read_krita(archive: Archive, quota: Quota) -> LayeredPicture:
    """The layers of a Krita file of 8 or 16 bits, in grey or RGB. Raises NestedCagesError."""
    image = next((node for node in archive.document(DOCUMENT).iter() if _tag(node) == "IMAGE"), None)
    if image is None:
        raise invalid_file("The file is damaged: it has no picture. Save it again.")
    return _Reading(archive, quota, whole(image, "width"), whole(image, "height")).picture(image)


def _tag(node: ET.Element) -> str:
    """The name of an element without its namespace."""
    return node.tag.rpartition("}")[2]


class _Reading:
    def __init__(self, archive: Archive, quota: Quota, width: int, height: int) -> None:
        self.archive, self.quota, self.width, self.height = archive, quota, width, height
        self.notes = Notes()
        self.folder = next((name.partition("/layers/")[0] for name in archive.names if "/layers/" in name), "")

    def picture(self, image: ET.Element) -> LayeredPicture:
        return LayeredPicture(self.width, self.height, self._layers(image), self.notes.sentences)

    def _layers(self, parent: ET.Element, depth: int = 0) -> tuple[Layer, ...]:
        check_depth(depth)
        lists = [node for node in parent if _tag(node) in ("LAYERS", "layers")]
        return tuple(self._layer(node, depth) for nodes in lists for node in reversed(nodes) if _tag(node) == "layer")

    def _layer(self, node: ET.Element, depth: int) -> Layer:
        self.quota.spend("elements", 1)
        operation = node.get("compositeop", "normal")
        flags = node.get("channelflags", "")
        layer = Layer(
            node.get("name", ""),
            node.get("uuid", ""),
            is_visible=node.get("visible") != "0",
            opacity=min(max(whole(node, "opacity", 255), 0), 255) / 255,
            blend=BLENDS.get(operation, operation),
            is_clipped=flags.endswith(HELD_ALPHA),
            mask=self._mask(node),
        )
        if node.get("nodetype") == "grouplayer":
            return replace(layer, children=self._layers(node, depth + 1))
        if node.get("nodetype") != "paintlayer":
            self.notes.add("Layers that are not painted, such as vector, filter and file layers, are left out: {}.",
                           layer.name)  # fmt: skip
            return layer
        space = node.get("colorspacename", "")
        if space not in SPACES:
            problem = f"The layer {layer.name!r} has the colour space {space!r}; convert it to RGB with 8 bits."
            raise invalid_file(problem)
        channels, depth = SPACES[space]
        left, top, found = self._tiles(f"{self.folder}/layers/{node.get('filename')}", channels * depth)
        left, top = left + whole(node, "x"), top + whole(node, "y")
        return replace(layer, left=left, top=top, pixels=_coloured(found, channels, depth))

    def _mask(self, node: ET.Element) -> LayerMask | None:
        """The transparency mask of a layer; several hide what any of them hides."""
        masks = [mask for nodes in node if _tag(nodes) == "masks" for mask in nodes if mask.get("visible") != "0"]
        both: LayerMask | None = None
        for mask in masks:
            if mask.get("nodetype") != "transparencymask":
                self.notes.add("Masks other than transparency masks are left out: {}.", node.get("name", ""))
                continue
            path = f"{self.folder}/layers/{mask.get('filename')}.pixelselection"
            left, top, found = self._tiles(path, 1)
            made = LayerMask(left + whole(mask, "x"), top + whole(mask, "y"), found[..., 0], self._default(path, 1)[0])
            if both is not None:
                whole_canvas = (0, 0, self.height, self.width)
                made = LayerMask(0, 0, np.minimum(both.over(*whole_canvas), made.over(*whole_canvas)))
            both = made
        return both

    def _default(self, path: str, size: int) -> bytes:
        """The pixel where there is no tile."""
        name = f"{path}.defaultpixel"
        found = self.archive.read(name) if name in self.archive.names else b""
        return found if len(found) == size else bytes(size)

    def _tiles(self, path: str, size: int) -> tuple[int, int, AnyArray]:
        """Left, top and (h, w, size) bytes of the pixels in a file of tiles."""
        data, default = self.archive.read(path), self._default(path, size)
        head, at = _head(data)
        width, height = head["TILEWIDTH"], head["TILEHEIGHT"]
        if head["PIXELSIZE"] != size or not 0 < width * height <= MOST_IN_TILE or min(width, height) < 1:
            raise invalid_file(f"The file is damaged: tiles of '{path}' have an unknown size. Save it again.")
        found = []
        for _ in range(head["DATA"]):
            words, at = _line(data, at, ",")
            if len(words) != 4 or not words[3].isdecimal() or at + int(words[3]) > len(data):
                raise invalid_file(f"The file is damaged: a tile of '{path}' can't be read. Save it again.")
            found.append((_coordinate(words[0]), _coordinate(words[1]), data[at : at + int(words[3])]))
            at += int(words[3])
        shown = [(0, 0, self.width, self.height)] if any(default) else []
        shown += [(x, y, x + width, y + height) for x, y, _ in found]
        if not shown:
            return 0, 0, np.zeros((0, 0, size), np.uint8)
        left, top, right, bottom = (
            int(f(column)) for f, column in zip((min, min, max, max), zip(*shown, strict=True), strict=True)
        )
        self.quota.spend("pixels", (right - left) * (bottom - top))
        out = np.empty((bottom - top, right - left, size), np.uint8)
        out[:] = np.frombuffer(default, np.uint8)
        for x, y, packed in found:
            out[y - top : y - top + height, x - left : x - left + width] = _tile(packed, height, width, size)
        return left, top, out


def _head(data: bytes) -> tuple[dict[str, int], int]:
    """The numbers at the beginning of a file of tiles, and where they end."""
    head, at = {"TILEWIDTH": 0, "TILEHEIGHT": 0, "PIXELSIZE": 0}, 0
    while "DATA" not in head:
        words, at = _line(data, at, " ")
        if len(words) != 2 or not words[1].isdecimal():
            raise invalid_file("The file is damaged: a layer has no tiles. Save it again.")
        head[words[0]] = int(words[1])
    return head, at


def _line(data: bytes, at: int, separator: str) -> tuple[list[str], int]:
    end = data.find(b"\n", at, at + MOST_IN_LINE)
    if end < 0:
        raise invalid_file("The file is damaged: tiles of a layer end early. Save it again.")
    return data[at:end].decode("latin-1").split(separator), end + 1


def _coordinate(word: str) -> int:
    if not word.removeprefix("-").isdecimal():
        raise invalid_file("The file is damaged: the place of a tile can't be read. Save it again.")
    return int(word)


def _tile(packed: bytes, height: int, width: int, size: int) -> AnyArray:
    """(height, width, size) bytes of a tile; packed ones keep one plane after the other."""
    is_packed = packed[:1] == b"\1"
    raw = unpacked(packed[1:], height * width * size) if is_packed else packed[1:]
    if len(raw) != height * width * size:
        raise invalid_file("The file is damaged: a tile ends early. Save it again.")
    values = np.frombuffer(raw, np.uint8)
    return values.reshape(size, height, width).transpose(1, 2, 0) if is_packed else values.reshape(height, width, size)


def _coloured(found: AnyArray, channels: int, depth: int) -> Pixels:
    """(h, w, 4) pixels from the bytes of all channels."""
    values = np.ascontiguousarray(found)
    if depth == 2:
        values = narrowed(values.view("<u2"))
    return np.ascontiguousarray(values[..., [2, 1, 0, 3] if channels == 4 else [0, 0, 0, 1]])
