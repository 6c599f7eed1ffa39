"""OpenRaster (.ora): an archive with a stack of PNG pictures."""

from __future__ import annotations

from xml.etree import ElementTree as ET

from ...errors import invalid_file
from ...formats.limits import Quota
from ...formats.pictures.png import decode_png
from .archive import Archive, number, whole
from .layer import NORMAL, Layer, LayeredPicture, Notes, check_depth

STACK = "stack.xml"

BLENDS = {"src-over": NORMAL, "src-atop": NORMAL, "plus": "add"}
"""Names of composite operations; others keep theirs."""

CLIPPED = "src-atop"
"""The operation of a layer that shows only where what is below is opaque."""


def read_openraster(archive: Archive, quota: Quota) -> LayeredPicture:
    """The layers of an OpenRaster file."""
    image = archive.document(STACK)
    stack = image.find("stack")
    if stack is None:
        raise invalid_file("The file is damaged: it has no stack of layers. Save it again.")
    notes = Notes()

    def layers(node: ET.Element, dx: int, dy: int, depth: int = 0) -> tuple[Layer, ...]:
        check_depth(depth)
        return tuple(made for child in reversed(node) if (made := layer(child, dx, dy, depth)) is not None)

    def layer(node: ET.Element, dx: int, dy: int, depth: int) -> Layer | None:
        if node.tag not in ("stack", "layer"):
            return None
        quota.spend("elements", 1)
        left, top = dx + whole(node, "x"), dy + whole(node, "y")
        operation = node.get("composite-op", "svg:src-over").removeprefix("svg:")
        name, source, pixels = node.get("name", ""), node.get("src"), None
        if node.tag == "layer" and source and source.lower().endswith(".png"):
            pixels = decode_png(archive.read(source), limits=quota.limits)
            quota.spend("pixels", pixels.shape[0] * pixels.shape[1])
        elif node.tag == "layer":
            notes.add("Layers without pixels are left out: {}.", name)
        return Layer(
            name,
            left,
            top,
            pixels,
            is_visible=node.get("visibility") != "hidden",
            opacity=min(max(number(node, "opacity", 1.0), 0.0), 1.0),
            blend=BLENDS.get(operation, operation),
            is_clipped=operation == CLIPPED,
            children=layers(node, left, top, depth + 1) if node.tag == "stack" else None,
        )

    return LayeredPicture(whole(image, "w"), whole(image, "h"), layers(stack, 0, 0), notes.sentences)
