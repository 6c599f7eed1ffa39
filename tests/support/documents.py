"""Documents that tests of files write and read: SVG, maps and pictures, and how their meshes compare."""

import io
import json
import struct
import zipfile
import zlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image

from nestedcages_core import Mesh, NestedCagesError, from_svg


def svg(body: str, attributes: str = "") -> str:
    """A document around elements."""
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>'


def area_of(body: str, attributes: str = "", **options: Any) -> float:
    """The area that a document paints."""
    return from_svg(svg(body, attributes), **options).area


def refusal(call: Callable[..., Any], *arguments: Any, **options: Any) -> NestedCagesError:
    """The error that a call ends with."""
    with pytest.raises(NestedCagesError) as caught:
        call(*arguments, **options)
    return caught.value


def same(one: Mesh, other: Mesh) -> bool:
    """Whether both have the same loops, as closed sequences of the very same points."""

    def canonical(mesh: Mesh) -> list[tuple[tuple[float, ...], ...]]:
        loops = []
        for ring in mesh.rings:
            rows = [tuple(row) for row in ring.tolist()]
            first = rows.index(min(rows))
            loops.append(tuple(rows[first:] + rows[:first]))
        return sorted(loops)

    return canonical(one) == canonical(other)


def solid(mesh: Any) -> Any:
    """What has a `__geo_interface__` as shapely sees it."""
    return shapely.geometry.shape(mesh.__geo_interface__)


def feature(*polygons: Any, name: str | None = None, identity: Any = None, **properties: Any) -> dict[str, Any]:
    """A feature of a map; each polygon is a list of closed rings."""
    known = {"name": name, **properties} if name else properties
    made = {"type": "Feature", "properties": known, "geometry": {"type": "MultiPolygon", "coordinates": polygons}}
    return made if identity is None else {**made, "id": identity}


def collection(*members: Any, **other: Any) -> str:
    """The text of a map."""
    return json.dumps({"type": "FeatureCollection", **other, "features": members})


def closed(points: Any) -> list[list[float]]:
    """A ring as maps have it: the first point again at the end."""
    rows = np.asarray(points, dtype=float).tolist()
    return [*rows, rows[0]]


def png(opaque: Any) -> bytes:
    """A picture whose pixels are opaque where an array (H, W) is True; numbers from 0 to 1 are opacities."""
    alpha = np.round(255.0 * np.asarray(opaque, dtype=float)).astype(np.uint8)
    pixels = np.dstack([np.full((*alpha.shape, 3), 90, np.uint8), alpha])
    return png_of(pixels)


def png_of(pixels: np.ndarray) -> bytes:
    """A picture (H, W, 4)."""
    out = io.BytesIO()
    Image.fromarray(pixels, "RGBA").save(out, "PNG")
    return out.getvalue()


def png_chunk(kind: bytes, content: bytes) -> bytes:
    """A part of a PNG with its right check sum."""
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def png_header(width: int, height: int, depth: int = 8, colour: int = 6, interlaced: int = 0) -> bytes:
    """How a PNG begins."""
    size = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlaced)
    return b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", size)


def archive(files: Mapping[str, bytes | str]) -> bytes:
    """A zip."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as made:
        for name, content in files.items():
            made.writestr(name, content)
    return out.getvalue()


def squares(opaque: np.ndarray) -> Any:
    """The squares of the pixels that are True."""
    y, x = np.nonzero(opaque)
    return shapely.box(x, y, x + 1, y + 1)
