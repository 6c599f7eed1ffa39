"""Pictures pixel by pixel: PNG against PIL and an encoder, boundaries and outlines against the squares of pixels."""

import struct
import zlib
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image
from scipy.ndimage import label

import nestedcages_core as core
from nestedcages_core import InvalidMeshError, Limits, alpha_channel, boundary_of_pixels, collision_outline, read_png
from support.command import run
from support.documents import png, png_chunk, png_header, refusal, squares
from support.marks import slow_after
from support.shapes import polygon

ADAM7 = [(0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4), (2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1)]
CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
DEPTHS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}


def paeth(a: int, b: int, c: int) -> int:
    p = a + b - c
    return min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]


def filtered(rows: list[bytes], pixel: int) -> Iterable[int]:
    """Each row by the next of the five filters, as the standard words them."""
    above = bytes(len(rows[0])) if rows else b""
    for y, row in enumerate(rows):
        yield y % 5
        for i, value in enumerate(row):
            a = row[i - pixel] if i >= pixel else 0
            b, c = above[i], above[i - pixel] if i >= pixel else 0
            yield (value - (0, a, b, (a + b) // 2, paeth(a, b, c))[y % 5]) % 256
        above = row


def packed(samples: np.ndarray, depth: int) -> list[bytes]:
    rows = []
    for line in samples.reshape(len(samples), -1).tolist():
        bits = "".join(f"{value:0{depth}b}" for value in line)
        bits += "0" * (-len(bits) % 8)
        rows.append(int(bits, 2).to_bytes(len(bits) // 8, "big"))
    return rows


def encoded(samples: np.ndarray, depth: int, colour: int, interlaced: bool = False, extra: bytes = b"") -> bytes:
    """Samples (H, W, C) of a depth, their data in two chunks."""
    pixel = max(samples.shape[2] * depth // 8, 1)
    parts = [samples[r::down, c::across] for r, c, down, across in ADAM7] if interlaced else [samples]
    data = zlib.compress(b"".join(bytes(filtered(packed(part, depth), pixel)) for part in parts if part.size))
    split = len(data) // 2
    middle = png_chunk(b"IDAT", data[:split]) + png_chunk(b"IDAT", data[split:])
    head = png_header(samples.shape[1], samples.shape[0], depth, colour, interlaced)
    return head + extra + middle + png_chunk(b"IEND", b"")


@pytest.mark.parametrize("interlaced", [False, True])
@pytest.mark.parametrize(("colour", "depth"), [(colour, depth) for colour, all_ in DEPTHS.items() for depth in all_])
def test_every_kind_of_png_is_read(colour: int, depth: int, interlaced: bool, tmp_path: Path) -> None:
    rng = np.random.default_rng(depth * 7 + colour)
    samples = rng.integers(0, 2**depth, (11, 13, CHANNELS[colour]))
    palette = rng.integers(0, 256, (2**depth, 3), dtype=np.uint8) if colour == 3 else None
    alpha = np.append(rng.integers(0, 256, 2), np.full(254, 255)).astype(np.uint8)
    extra = b"" if palette is None else png_chunk(b"PLTE", palette.tobytes()) + png_chunk(b"tRNS", alpha[:2].tobytes())
    path = tmp_path / "a.png"
    path.write_bytes(encoded(samples, depth, colour, interlaced, extra))
    found = read_png(path)
    if palette is not None:
        expected = np.dstack((palette[samples[:, :, 0]], alpha[samples[:, :, 0]]))
    else:
        values = samples >> 8 if depth == 16 else samples * (255 // (2**depth - 1))  # of 16 bits the upper ones
        rgb = np.repeat(values[:, :, :1], 3, axis=2) if colour in (0, 4) else values[:, :, :3]
        expected = np.dstack((rgb, values[:, :, -1:] if colour in (4, 6) else np.full((11, 13, 1), 255)))
    assert found.dtype == np.uint8
    np.testing.assert_array_equal(found, expected)
    if depth < 16:
        np.testing.assert_array_equal(found, np.array(Image.open(path).convert("RGBA")))


def test_one_colour_may_be_transparent(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    clear = png_chunk(b"tRNS", struct.pack(">HHH", 4, 5, 6))
    path.write_bytes(encoded(np.array([[[1, 2, 3], [4, 5, 6]]]), 8, 2, extra=clear))
    assert read_png(path)[0].tolist() == [[1, 2, 3, 255], [4, 5, 6, 0]]
    path.write_bytes(encoded(np.array([[[3], [0]]]), 2, 0, extra=png_chunk(b"tRNS", struct.pack(">H", 3))))
    assert read_png(path)[0].tolist() == [[255, 255, 255, 0], [0, 0, 0, 255]]


GOOD = encoded(np.zeros((4, 4, 4), dtype=int), 8, 6)
END = png_chunk(b"IEND", b"")


@pytest.mark.parametrize(
    "data",
    [b"", b"GIF89a", GOOD[:40], GOOD[:-6], GOOD[:8] + END, GOOD[:33] + png_chunk(b"IDAT", b"junk") + END,
     GOOD[:29] + b"\0\0\0\0" + GOOD[33:],  # a wrong check sum
     png_header(9, 9) + png_chunk(b"IDAT", zlib.compress(b"\0")) + END,
     png_header(9, 9, 3) + png_chunk(b"IDAT", b"") + END, png_header(2**20, 2**20) + png_chunk(b"IDAT", b"") + END],
)  # fmt: skip
def test_damaged_pngs_are_an_error(data: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(data)
    large = data.startswith(png_header(2**20, 2**20))
    assert refusal(read_png, tmp_path / "a.png").code == ("limit.exceeded" if large else "file.invalid")


def test_alpha_channels_of_every_type() -> None:
    whole = np.zeros((2, 3, 4), dtype=np.uint8)
    whole[0, 1, 3] = 255
    assert alpha_channel(whole)[0].tolist() == [0.0, 1.0, 0.0]
    assert alpha_channel(whole[:, :, 3]).max() == 1.0
    assert alpha_channel(np.full((2, 2), 65535, dtype=np.uint16)).min() == 1.0
    assert alpha_channel(np.eye(3, dtype=bool)).sum() == 3.0
    assert alpha_channel(np.full((2, 2, 2), 0.25))[0, 0] == 0.25
    for bad in (np.zeros((2, 2, 3)), np.zeros(4), np.array([["a"]])):
        assert refusal(alpha_channel, bad).code == "file.invalid"


# Boundaries


@pytest.mark.slow
@settings(max_examples=80, deadline=None)
@given(arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9))).filter(np.any))
def test_the_boundary_follows_the_pixels(opaque: np.ndarray) -> None:
    """Every opaque square inside, nothing added but cut corners, 8-connected parts, 4-connected holes."""
    mesh = boundary_of_pixels(opaque)
    solid, pixels = polygon(mesh), shapely.union_all(squares(opaque))
    assert solid.covers(pixels)
    padded = np.pad(opaque, 1)
    crossed = padded[:-1, :-1] & padded[1:, 1:] & ~padded[:-1, 1:] & ~padded[1:, :-1]
    crossed |= ~padded[:-1, :-1] & ~padded[1:, 1:] & padded[:-1, 1:] & padded[1:, :-1]
    assert solid.area == pytest.approx(pixels.area + crossed.sum() / 16.0)
    assert (mesh.loop_signs > 0).sum() == label(opaque, np.ones((3, 3)))[1]
    assert (mesh.loop_signs < 0).sum() == label(~padded)[1] - 1


def test_straight_runs_have_no_vertices() -> None:
    opaque = np.zeros((40, 50), dtype=bool)
    opaque[5:30, 10:45] = True
    opaque[10:20, 20:30] = False
    mesh = boundary_of_pixels(opaque)
    assert sorted(map(tuple, mesh.vertices.tolist())) == sorted(
        (float(x), float(y)) for xs, ys in (((10, 45), (5, 30)), ((20, 30), (10, 20))) for x in xs for y in ys
    )
    assert mesh.loop_signs.tolist() == [1, -1]
    error = refusal(boundary_of_pixels, opaque, limits=Limits(points=99))
    assert (error.code, error.data["what"]) == ("limit.exceeded", "points")


def test_an_empty_picture_has_no_outline() -> None:
    for make in (
        lambda: boundary_of_pixels(np.zeros((5, 5), dtype=bool)),
        lambda: collision_outline(np.full((5, 5), 0.3), 4, threshold=0.5),
    ):
        with pytest.raises(InvalidMeshError) as error:
            make()
        assert error.value.code == "file.invalid"


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


def assert_wrapped(alpha: np.ndarray, outline: core.Mesh, padding: float, threshold: float = 0.0) -> None:
    solid, pixels = polygon(outline), squares(alpha > threshold)
    assert solid.is_valid
    assert shapely.covers(solid, pixels).all()
    assert shapely.distance(solid.boundary, pixels).min() >= padding * (1 - 1e-9)


@pytest.mark.parametrize(
    ("padding", "threshold", "holes"),
    slow_after(1, [(0.5, 0.5, True), (0.0, 0.0, False), (1.5, 0.0, True), (1.5, 0.0, False)], thorough_after=3),
)
def test_an_outline_misses_no_opaque_pixel(padding: float, threshold: float, holes: bool) -> None:
    alpha = sprite()
    outline = collision_outline(alpha, 20, padding=padding, threshold=threshold, holes=holes)
    assert len(outline.vertices) == 20
    assert_wrapped(alpha, outline, padding, threshold)
    assert (outline.loop_signs < 0).any() == holes


def test_pixels_count_from_half_opacity() -> None:
    y, x = np.indices((32, 32))
    fading = np.clip(1.2 - np.hypot(x - 16, y - 16) / 12.0, 0.0, 1.0)
    assert_wrapped(fading, collision_outline(fading, 16), 0.0, 0.5)
    areas = [collision_outline(fading, 16, threshold=each).area for each in (0.0, 0.5, 0.9)]
    assert areas[0] > 1.5 * areas[1] > 3.0 * areas[2]
    assert collision_outline(fading, 16).area == areas[1]


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
    assert (len(apart.loops), len(apart.vertices)) == (2, 8)  # two rectangles have no use for more


@pytest.mark.slow
def test_a_sprite_of_4096_boundary_pixels_in_16_vertices() -> None:
    y, x = np.indices((1500, 1500)) - 750.0
    turn, far = np.arctan2(y, x), np.hypot(x, y)
    opaque = far < 560.0 + 60.0 * np.cos(5 * turn) + 25.0 * np.cos(17 * turn + 1.0)
    outline = collision_outline(opaque, 16, padding=1.0)
    assert len(outline.vertices) == 16
    solid, fine = polygon(outline), polygon(boundary_of_pixels(opaque))
    assert solid.covers(fine) and solid.boundary.distance(fine) >= 1.0 - 1e-9
    assert solid.area < 1.25 * opaque.sum()


@pytest.mark.slow
def test_settings_are_passed_on_and_bad_padding_is_an_error() -> None:
    for padding in (-1.0, float("nan")):
        refusal(collision_outline, sprite(), 12, padding=padding)
    assert len(collision_outline(sprite(), 4).vertices) == 4
    assert refusal(collision_outline, sprite(), 2).code == "count.too_small"
    assert_wrapped(sprite(), collision_outline(sprite(), 12, settings=core.Settings(clearance=2.0)), 2.0, 0.5)


# Frames


@pytest.mark.slow
def test_corners_correspond_from_frame_to_frame(tmp_path: Path) -> None:
    """Of two bars that turn; a frame with another number of vertices begins anew."""
    y, x = np.indices((40, 80))
    angles = (0.2, 0.4, 0.6)
    for frame, angle in enumerate(angles):
        bars = np.zeros((40, 80), bool)
        for middle, long in ((20, 14), (62, 11)):
            u = (x - middle) * np.cos(angle) + (y - 20) * np.sin(angle)
            v = (y - 20) * np.cos(angle) - (x - middle) * np.sin(angle)
            bars |= (np.abs(u) < long) & (np.abs(v) < 5)
        (tmp_path / f"walk_{frame}.png").write_bytes(png(bars))
    out = tmp_path / "walk.geojson"
    assert run("walk_*.png", "--levels", 8, "-o", out, "--flip-y", "--quiet", cwd=tmp_path).status == 0
    frames = core.features_from_geojson(out.read_bytes())
    assert [each.properties["time"] for each in frames] == [0, 1, 2]
    meshes = [core.Mesh.from_loops([ring * (1, -1) + (0, 40) for ring in each.mesh.rings]) for each in frames]
    for angle, mesh, after in zip(angles, meshes, meshes[1:], strict=False):
        assert [len(ring) for ring in mesh.rings] == [4, 4] == [len(ring) for ring in after.rings]
        for ring, then in zip(mesh.rings, after.rings, strict=True):
            middle = np.array([20.0 if ring[:, 0].mean() < 41 else 62.0, 20.0])
            turn = np.array([[np.cos(0.2), np.sin(0.2)], [-np.sin(0.2), np.cos(0.2)]])
            assert np.hypot(*((ring - middle) @ turn + middle - then).T).max() < 4.0, angle  # pixels are rough
    (tmp_path / "walk_3.png").write_bytes(png(np.zeros((40, 80), bool)))
    out.unlink()
    failed = run("walk_*.png", "--levels", 8, "-o", out, cwd=tmp_path)
    assert failed.status == 1 and "walk_3.png" in failed.err
    assert not out.exists()
