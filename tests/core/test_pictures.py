"""Pictures pixel by pixel: PNG decoding against an encoder, boundaries and outlines against shapely's squares."""

from __future__ import annotations

import struct
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.ndimage import distance_transform_edt, label

from nestedcages_core import InvalidMeshError, Mesh, NestedCagesError, Settings, collision_outline
from nestedcages_core.exchange import Limits
from nestedcages_core.exchange.pictures import HALF, alpha_channel, boundary_of_pixels, decode_png, read_png
from support.shapes import polygon

# PNG: an encoder that filters pixel by pixel, as the standard words it

ADAM7 = [(0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4), (2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1)]


def chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def paeth(a: int, b: int, c: int) -> int:
    p = a + b - c
    return min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]


def filtered(rows: list[bytes], pixel: int, kinds: list[int]) -> bytes:
    out = bytearray()
    above = bytes(len(rows[0])) if rows else b""
    for y, row in enumerate(rows):
        kind = kinds[y % len(kinds)]
        out.append(kind)
        for i, value in enumerate(row):
            a = row[i - pixel] if i >= pixel else 0
            b, c = above[i], above[i - pixel] if i >= pixel else 0
            predicted = (0, a, b, (a + b) // 2, paeth(a, b, c))[kind]
            out.append((value - predicted) % 256)
        above = row
    return bytes(out)


def packed(samples: np.ndarray, depth: int) -> list[bytes]:
    rows = []
    for line in samples.reshape(len(samples), -1).tolist():
        bits = "".join(f"{value:0{depth}b}" for value in line)
        bits += "0" * (-len(bits) % 8)
        rows.append(int(bits, 2).to_bytes(len(bits) // 8, "big"))
    return rows


def encoded(
    samples: np.ndarray, depth: int, colour: int, kinds: list[int], interlaced: bool = False, extra: bytes = b""
) -> bytes:
    height, width, channels = samples.shape
    pixel = max(channels * depth // 8, 1)
    parts = [samples[r::down, c::across] for r, c, down, across in ADAM7] if interlaced else [samples]
    data = b"".join(filtered(packed(part, depth), pixel, kinds) for part in parts if part.size)
    header = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, int(interlaced))
    middle = zlib.compress(data)
    split = len(middle) // 2
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + extra
        + chunk(b"IDAT", middle[:split])
        + chunk(b"IDAT", middle[split:])
        + chunk(b"IEND", b"")
    )


CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
DEPTHS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
FORMATS = [(colour, depth) for colour, depths in DEPTHS.items() for depth in depths]


@pytest.mark.parametrize("interlaced", [False, True])
@pytest.mark.parametrize(("colour", "depth"), FORMATS)
def test_every_kind_of_png_is_read(colour: int, depth: int, interlaced: bool) -> None:
    rng = np.random.default_rng(depth * 7 + colour)
    samples = rng.integers(0, 2**depth, (11, 13, CHANNELS[colour]))
    palette = rng.integers(0, 256, (2 ** min(depth, 8), 3), dtype=np.uint8)
    clear = rng.integers(0, 256, 2, dtype=np.uint8)
    extra = b""
    if colour == 3:
        extra = chunk(b"PLTE", palette.tobytes()) + chunk(b"tRNS", clear.tobytes())
    picture = decode_png(encoded(samples, depth, colour, [0, 1, 2, 3, 4], interlaced, extra))
    assert picture.shape == (11, 13, 4)
    assert picture.dtype == np.uint8
    if depth == 16:
        samples, depth = samples >> 8, 8  # the upper byte
    most = 255
    if colour == 3:
        alpha = np.full(256, 255)
        alpha[:2] = clear
        expected = np.dstack((palette[samples[:, :, 0]], alpha[samples[:, :, 0]]))
    else:
        scaled = samples * (most // (2**depth - 1))
        opaque = np.full((11, 13, 1), most)
        rgb = np.repeat(scaled[:, :, :1], 3, axis=2) if colour in (0, 4) else scaled[:, :, :3]
        expected = np.dstack((rgb, scaled[:, :, -1:] if colour in (4, 6) else opaque))
    assert (picture == expected).all()


def test_one_colour_may_be_transparent() -> None:
    samples = np.array([[[1, 2, 3], [4, 5, 6]]])
    picture = decode_png(encoded(samples, 8, 2, [0], extra=chunk(b"tRNS", struct.pack(">HHH", 4, 5, 6))))
    assert picture[0, :, 3].tolist() == [255, 0]
    grey = decode_png(encoded(np.array([[[3], [0]]]), 2, 0, [0], extra=chunk(b"tRNS", struct.pack(">H", 3))))
    assert grey[0].tolist() == [[255, 255, 255, 0], [0, 0, 0, 255]]


def test_bad_pngs_get_a_sentence(tmp_path: Path) -> None:
    good = encoded(np.zeros((4, 4, 4), dtype=int), 8, 6, [0])
    cases = {
        b"": "not a PNG",
        b"GIF89a": "not a PNG",
        good[:40]: "PNG is damaged",
        good[:-6]: "PNG is damaged",
        good[:29] + b"\0\0\0\0" + good[33:]: "PNG is damaged",
        encoded(np.zeros((4, 4, 4), dtype=int), 8, 6, [0])[:8] + chunk(b"IEND", b""): "has no size",
    }
    short = struct.pack(">IIBBBBB", 9, 9, 8, 6, 0, 0, 0)
    cases[good[:8] + chunk(b"IHDR", short) + chunk(b"IDAT", zlib.compress(b"\0")) + chunk(b"IEND", b"")] = (
        "PNG is damaged"
    )
    odd = struct.pack(">IIBBBBB", 9, 9, 3, 6, 0, 0, 0)
    cases[good[:8] + chunk(b"IHDR", odd) + chunk(b"IDAT", b"") + chunk(b"IEND", b"")] = "PNG is damaged"
    huge = struct.pack(">IIBBBBB", 2**20, 2**20, 8, 6, 0, 0, 0)
    cases[good[:8] + chunk(b"IHDR", huge) + chunk(b"IDAT", b"") + chunk(b"IEND", b"")] = (
        "more than the 67,108,864 allowed"
    )
    cases[good[:33] + chunk(b"IDAT", b"junk") + chunk(b"IEND", b"")] = "PNG is damaged"
    for data, sentence in cases.items():
        with pytest.raises(NestedCagesError, match=sentence):
            decode_png(data)
    (tmp_path / "a.png").write_bytes(good)
    assert not read_png(tmp_path / "a.png").any()


@pytest.mark.slow
def test_data_beyond_the_size_of_a_picture_are_never_unpacked() -> None:
    packer = zlib.compressobj()
    data = b"".join(packer.compress(bytes(10**7)) for _ in range(15)) + packer.flush()
    header = struct.pack(">IIBBBBB", 1, 1, 8, 6, 0, 0, 0)
    bomb = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")
    tracemalloc.start()
    try:
        picture = decode_png(bomb)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert picture.tolist() == [[[0, 0, 0, 0]]]
    assert peak < 20 * len(bomb)


@pytest.mark.parametrize("given", [None, 5, "text", ["a"]])
def test_a_png_is_read_from_bytes(given: object) -> None:
    with pytest.raises(NestedCagesError, match="read from bytes, not from a"):
        decode_png(given)
    with pytest.raises(NestedCagesError, match="16 pixels, more than the 15 allowed"):
        decode_png(encoded(np.zeros((4, 4, 4), dtype=int), 8, 6, [0]), limits=Limits(pixels=15))


def test_alpha_channels_of_every_type() -> None:
    whole = np.zeros((2, 3, 4), dtype=np.uint8)
    whole[0, 1, 3] = 255
    assert alpha_channel(whole)[0].tolist() == [0.0, 1.0, 0.0]
    assert alpha_channel(whole[:, :, 3]).max() == 1.0
    assert alpha_channel(np.full((2, 2), 65535, dtype=np.uint16)).min() == 1.0
    assert alpha_channel(np.eye(3, dtype=bool)).sum() == 3.0
    assert alpha_channel(np.full((2, 2, 2), 0.25))[0, 0] == 0.25
    for bad in (np.zeros((2, 2, 3)), np.zeros(4), np.array([["a"]])):
        with pytest.raises(NestedCagesError, match="no alpha channel"):
            alpha_channel(bad)


# Boundaries


def squares(opaque: np.ndarray) -> np.ndarray:
    y, x = np.nonzero(opaque)
    return shapely.box(x, y, x + 1, y + 1)


def assert_boundary(opaque: np.ndarray, mesh: Mesh) -> None:
    """Every opaque square inside, nothing added but cut corners, 8-connected parts, 4-connected holes."""
    solid = polygon(mesh)
    pixels = shapely.union_all(squares(opaque))
    assert solid.covers(pixels)
    padded = np.pad(opaque, 1)
    crossed = padded[:-1, :-1] & padded[1:, 1:] & ~padded[:-1, 1:] & ~padded[1:, :-1]
    crossed |= ~padded[:-1, :-1] & ~padded[1:, 1:] & padded[:-1, 1:] & padded[1:, :-1]
    assert solid.area == pytest.approx(pixels.area + crossed.sum() / 16.0)
    assert (mesh.loop_signs > 0).sum() == label(opaque, np.ones((3, 3)))[1]
    assert (mesh.loop_signs < 0).sum() == label(~padded)[1] - 1


@pytest.mark.slow
@settings(max_examples=80, deadline=None)
@given(arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9))).filter(np.any))
def test_the_boundary_follows_the_pixels(opaque: np.ndarray) -> None:
    assert_boundary(opaque, boundary_of_pixels(opaque))


def test_straight_runs_have_no_vertices() -> None:
    opaque = np.zeros((40, 50), dtype=bool)
    opaque[5:30, 10:45] = True
    opaque[10:20, 20:30] = False
    mesh = boundary_of_pixels(opaque)
    assert sorted(map(tuple, mesh.vertices.tolist())) == sorted(
        (float(x), float(y)) for xs, ys in (((10, 45), (5, 30)), ((20, 30), (10, 20))) for x in xs for y in ys
    )
    assert mesh.loop_signs.tolist() == [1, -1]


def test_an_empty_picture_is_refused() -> None:
    with pytest.raises(InvalidMeshError, match="no opaque pixel"):
        boundary_of_pixels(np.zeros((5, 5), dtype=bool))
    with pytest.raises(InvalidMeshError, match="lower threshold"):
        collision_outline(np.full((5, 5), 0.3), 4, threshold=0.5)


# Outlines


def sprite(size: int = 96) -> np.ndarray:
    """Opacity of a fish with a soft edge, an eye hole and a loose bubble."""
    y, x = (np.indices((size, size)) + 0.5) / size
    body = 0.09 - ((x - 0.42) ** 2 + 1.9 * (y - 0.5) ** 2)
    tail = np.minimum(np.minimum(x - 0.62, 0.92 - x), 0.9 * (x - 0.6) - np.abs(y - 0.5) + 0.02)
    eye = 0.0012 - ((x - 0.3) ** 2 + (y - 0.45) ** 2)
    bubble = 0.002 - ((x - 0.12) ** 2 + (y - 0.2) ** 2)
    solid = np.maximum(np.maximum(np.minimum(body, -40 * eye), 0.3 * tail), 2 * bubble)
    return (solid * size).clip(0.0, 1.0)


def assert_wrapped(alpha: np.ndarray, outline: Mesh, padding: float, threshold: float = 0.0) -> None:
    solid, pixels = polygon(outline), squares(alpha > threshold)
    assert solid.is_valid
    assert shapely.covers(solid, pixels).all()
    assert shapely.distance(solid.boundary, pixels).min() >= padding * (1 - 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("holes", [False, True])
@pytest.mark.parametrize(("padding", "threshold"), [(0.0, 0.0), (1.5, 0.0), (0.5, 0.5)])
def test_an_outline_misses_no_opaque_pixel(padding: float, threshold: float, holes: bool) -> None:
    alpha = sprite()
    outline = collision_outline(alpha, 20, padding=padding, threshold=threshold, holes=holes)
    assert len(outline.vertices) == 20
    assert_wrapped(alpha, outline, padding, threshold)
    assert (outline.loop_signs < 0).any() == holes


@pytest.mark.slow
def test_parts_without_room_for_the_padding_are_joined() -> None:
    alpha = np.zeros((40, 60))
    alpha[10:30, 5:25] = alpha[10:30, 28:50] = 1.0
    alpha[15:20, 10:14] = 0.0
    outline = collision_outline(alpha, 12, padding=4.0, holes=True)
    assert_wrapped(alpha, outline, 4.0)
    assert len(outline.loops) == 1
    apart = collision_outline(alpha, 12, padding=1.0, holes=False)
    assert_wrapped(alpha, apart, 1.0)
    assert len(apart.loops) == 2
    assert len(apart.vertices) == 8  # two rectangles have no use for more


@pytest.mark.slow
def test_a_sprite_of_4096_boundary_pixels_in_16_vertices() -> None:
    y, x = np.indices((1500, 1500)) - 750.0
    turn, far = np.arctan2(y, x), np.hypot(x, y)
    opaque = far < 560.0 + 60.0 * np.cos(5 * turn) + 25.0 * np.cos(17 * turn + 1.0)
    rim = opaque & (distance_transform_edt(opaque) < 1.5)
    assert rim.sum() >= 4096
    outline = collision_outline(opaque, 16, padding=1.0)
    assert len(outline.vertices) == 16
    solid = polygon(outline)
    shapely.prepare(solid)
    assert shapely.covers(solid, squares(rim)).all()
    assert shapely.distance(solid.boundary, shapely.union_all(squares(rim))) >= 1.0 - 1e-9
    assert solid.area < 1.25 * opaque.sum()


def test_settings_are_passed_on_and_bad_padding_is_refused() -> None:
    with pytest.raises(NestedCagesError, match="padding"):
        collision_outline(sprite(), 12, padding=-1.0)
    with pytest.raises(NestedCagesError, match="padding"):
        collision_outline(sprite(), 12, padding=float("nan"))
    assert len(collision_outline(sprite(), 4).vertices) == 4
    with pytest.raises(NestedCagesError, match="at least"):
        collision_outline(sprite(), 2)
    assert_wrapped(sprite(), collision_outline(sprite(), 12, settings=Settings(clearance=2.0)), 2.0, HALF)
