"""Layered pictures: against psd-tools, against files of Krita and ag-psd, and damaged in every place."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nestedcages_core import NestedCagesError
from nestedcages_core.exchange.layers import (
    LAYERED_LIMITS,
    Layer,
    LayeredPicture,
    LayerMask,
    layers_of,
    parts_of,
    read_layers,
)
from nestedcages_core.exchange.pictures import decode_png, encode_png

psd_tools = pytest.importorskip("psd_tools", reason="psd-tools judges the reader of PSD: pip install psd-tools")
from PIL import Image  # noqa: E402
from psd_tools.constants import BlendMode, Compression  # noqa: E402

DATA = Path(__file__).parents[1] / "data"
"""layers.psd: drawn by a script and written by ag-psd 31; layers.kra: the same, opened and saved by Krita 5.1.5."""


def read(data: bytes) -> LayeredPicture:
    return layers_of(data, LAYERED_LIMITS, decode_png)


def picture(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    """Pixels with runs, noise and transparency."""
    out = rng.integers(0, 256, (height, width, 4), dtype=np.uint8)
    out[: height // 2, :, :3] = (200, 10, 30)
    out[:, : width // 3, 3] = 0
    return out


def written(psd: Any) -> bytes:
    file = io.BytesIO()
    psd.save(file)
    return file.getvalue()


def in_order(layers: Iterable[Any]) -> Iterator[Any]:
    """Groups before their layers, as `LayeredPicture.walk`."""
    for layer in layers:
        yield layer
        if layer.is_group():
            yield from in_order(layer)


@pytest.mark.parametrize("compression", list(Compression))
@pytest.mark.parametrize("mode", ["RGB", "L", "CMYK"])
def test_psd_as_psd_tools_writes_and_reads_it(mode: str, compression: Compression) -> None:
    rng = np.random.default_rng(7)
    psd = psd_tools.PSDImage.new(mode, (90, 60))
    group = psd.create_group(name="head")
    for name, left, top, size in (("face é", 10, -5, (20, 31)), ("eye", 60, 50, (17, 40))):
        image = Image.fromarray(picture(rng, *size), "RGBA")
        layer = psd.create_pixel_layer(
            image.convert("LA" if mode == "L" else "RGBA"), name, top, left, compression=compression
        )
        group.append(layer)
    layer.blend_mode, layer.opacity, layer.visible = BlendMode.MULTIPLY, 77, False
    layer.clipping = True
    ours = list(read(written(psd)).walk())
    theirs = list(in_order(psd_tools.PSDImage.open(io.BytesIO(written(psd)))))
    assert [layer.name for layer in ours] == [layer.name for layer in theirs] == ["head", "face é", "eye"]
    assert ours[0].children is not None
    for one, other in zip(ours, theirs, strict=True):
        assert one.is_visible == other.visible
        if one.pixels is None:
            continue
        assert (one.left, one.top) == (other.left, other.top)
        assert one.opacity == pytest.approx(other.opacity / 255)
        assert one.is_clipped == other.clipping
        colour, alpha = other.numpy("color"), other.numpy("shape")
        if mode == "CMYK":
            colour = colour[..., :3] * colour[..., 3:]
        np.testing.assert_allclose(
            one.pixels[..., :3] / 255, np.broadcast_to(colour, (*alpha.shape[:2], 3)), atol=0.006
        )
        np.testing.assert_allclose(one.pixels[..., 3] / 255, alpha[..., 0], atol=0.002)
    assert [layer.blend for layer in ours[1:]] == ["normal", "multiply"]


@pytest.mark.parametrize("depth", [16, 32])
@pytest.mark.parametrize("big", [False, True])
def test_deep_layers(depth: int, big: bool) -> None:
    """Channels by hand, after the specification: 16 and 32 bits, with differences, in both sizes of lengths."""
    values = np.linspace(0.0, 1.0, 12).reshape(3, 4)
    if depth == 16:
        words = np.round(values * 65535).astype(np.uint16)
        packed = np.diff(words, axis=1, prepend=np.uint16(0)).astype(">u2").tobytes()
    else:
        ranked = values.astype(">f4").view(np.uint8).reshape(3, 4, 4).transpose(0, 2, 1).reshape(3, 16)
        packed = np.diff(ranked, axis=1, prepend=np.uint8(0)).astype(np.uint8).tobytes()
    channel = struct.pack(">H", 3) + zlib.compress(packed)
    long = "Q" if big else "I"
    heads = b"".join(struct.pack(f">h{long}", number, len(channel)) for number in (-1, 0, 1, 2))
    extra = struct.pack(">IIB", 0, 0, 3) + b"arm"
    layer = struct.pack(">iiiiH", 2, 1, 5, 5, 4) + heads + b"8BIMnorm" + struct.pack(">BBBBI", 255, 0, 0, 0, len(extra))
    info = struct.pack(">h", 1) + layer + extra + 4 * channel
    key = {16: b"Lr16", 32: b"Lr32"}[depth]
    tagged = (b"8B64" if big else b"8BIM") + key + struct.pack(f">{long}", len(info)) + info
    section = struct.pack(f">{long}I", 0, 0) + tagged
    head = b"8BPS" + struct.pack(">H6sHIIHH", 2 if big else 1, b"", 3, 9, 9, depth, 3) + struct.pack(">II", 0, 0)
    (found,) = read(head + struct.pack(f">{long}", len(section)) + section).layers
    assert (found.name, found.left, found.top) == ("arm", 1, 2)
    assert found.pixels is not None
    np.testing.assert_allclose(found.pixels[..., 3], 255 * values, atol=0.51)
    light = (
        np.where(values <= 0.0031308, 12.92 * values, 1.055 * values ** (1 / 2.4) - 0.055) if depth == 32 else values
    )
    np.testing.assert_allclose(found.pixels[..., 1], 255 * light, atol=0.51)


def test_krita_and_ag_psd_have_the_same_pixels() -> None:
    psd, kra = (read_layers(DATA / f"layers.{kind}") for kind in ("psd", "kra"))
    assert (psd.width, psd.height) == (kra.width, kra.height) == (70, 40)
    assert [layer.name for layer in psd.walk()] == [layer.name for layer in kra.walk()]
    assert [layer.name for layer in psd.walk()] == ["body", "head", "face 左", "eye", "arm"]
    assert len({layer.identity for layer in kra.walk()}) == 5
    (ours, notes), (theirs, _) = parts_of(psd, hidden=True), parts_of(kra, hidden=True)
    assert notes == ()
    assert [part.path for part in ours] == ["body", "head/face 左", "head/eye", "arm"]
    for one, other in zip(ours, theirs, strict=True):
        assert (one.path, one.left, one.top, one.blend) == (other.path, other.left, other.top, other.blend)
        assert (one.opacity, one.is_visible) == (pytest.approx(other.opacity), other.is_visible)
        np.testing.assert_array_equal(one.pixels, other.pixels)
    assert ours[3].pixels.shape == (8, 8, 4)  # as much as its mask shows
    assert ours[3].pixels[..., 3].ravel().tolist() == [(128 + 3 * k) % 256 for k in range(64)]


def archive(files: dict[str, bytes | str]) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as made:
        for name, content in files.items():
            made.writestr(name, content)
    return out.getvalue()


STACK = """<image w="40" h="30"><stack><stack name="head" x="2" y="1" opacity="0.5">
<layer name="hair" src="data/a.png" x="3" y="4" composite-op="svg:multiply"/>
<layer name="face" src="data/b.png" x="-1" visibility="hidden"/></stack>
<layer name="body" src="data/a.png" y="20"/><text name="words"/></stack></image>"""


def test_openraster() -> None:
    first, second = picture(np.random.default_rng(0), 5, 6), picture(np.random.default_rng(1), 3, 4)
    files = {"stack.xml": STACK, "data/a.png": encode_png(first), "data/b.png": encode_png(second)}
    found = read(archive(files))
    body, head = found.layers
    assert (found.width, found.height, body.name, body.top, head.opacity) == (40, 30, "body", 20, 0.5)
    face, hair = head.children or ()
    assert (face.left, face.top, face.is_visible) == (1, 1, False)
    assert (hair.left, hair.top, hair.blend) == (5, 5, "multiply")
    np.testing.assert_array_equal(hair.pixels, first)
    np.testing.assert_array_equal(face.pixels, second)


def test_a_folder_of_pictures(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    pictures = {name: picture(rng, 4 + k, 9) for k, name in enumerate(("10_arm.png", "2 body.png", "head/1-face.png"))}
    for name, pixels in pictures.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        data = encode_png(pixels)
        if "arm" in name:
            offset = b"oFFs" + struct.pack(">iiB", 5, 6, 0)
            data = data[:33] + struct.pack(">I", 9) + offset + struct.pack(">I", zlib.crc32(offset)) + data[33:]
        (tmp_path / name).write_bytes(data)
    found = read_layers(tmp_path, decode=decode_png)
    assert [layer.name for layer in found.walk()] == ["body", "arm", "head", "face"]
    arm = found.layers[1]
    assert (arm.left, arm.top, found.width, found.height) == (5, 6, 14, 10)
    np.testing.assert_array_equal(arm.pixels, pictures["10_arm.png"])
    (tmp_path / "empty").mkdir()
    with pytest.raises(NestedCagesError, match="no PNG pictures"):
        read_layers(tmp_path / "empty")


def test_masks_groups_and_clipping_are_applied() -> None:
    whole = np.full((4, 4, 4), 200, np.uint8)
    half = LayerMask(0, 0, np.full((2, 4), 255, np.uint8), outside=51)
    base = Layer("base", pixels=whole, mask=half)
    shade = Layer("shade", left=2, pixels=np.full((4, 4, 4), 255, np.uint8) // (1, 2, 1, 1), blend="multiply",
                  is_clipped=True, opacity=0.5)  # fmt: skip
    odd = Layer("odd", pixels=whole, blend="dissolve")
    group = Layer("group", opacity=0.5, mask=LayerMask(1, 0, np.full((4, 3), 255, np.uint8)), children=(base, shade))
    gone = Layer("gone", is_visible=False, children=(Layer("inside", pixels=whole),))
    found = LayeredPicture(9, 9, (group, odd, gone, Layer("nothing")))
    parts, notes = parts_of(found)
    assert [part.path for part in parts] == ["group/base", "odd"]
    seen = parts[0]
    assert (seen.left, seen.opacity, seen.pixels.shape) == (1, 0.5, (4, 3, 4))
    assert seen.pixels[:, 0, 3].tolist() == [200, 200, 40, 40]
    assert seen.pixels[0, :, 1].tolist() == [200, 150, 150]  # half of 200 times a half, half of 200
    assert seen.pixels[0, :, 0].tolist() == [200, 200, 200]
    for word in ("odd", "inside", "nothing", "shade", "dissolve", "opacity of a group"):
        assert any(word in note for note in notes), word
    assert [part.name for part in parts_of(found, hidden=True)[0]] == ["base", "odd", "inside"]


@pytest.mark.parametrize(
    ("left", "width", "is_left_out"), [(0, 10, True), (-3, 20, True), (0, 9, False), (4, 10, False)]
)
def test_a_background_is_no_part(left: int, width: int, is_left_out: bool) -> None:
    """What Photoshop and Krita begin a painting with."""
    paper = Layer("Background", left=left, top=-1, pixels=np.full((12, width, 4), 255, np.uint8))
    arm = Layer("arm", pixels=np.full((4, 4, 4), 255, np.uint8))
    parts, notes = parts_of(LayeredPicture(10, 10, (paper, arm)))
    assert [part.name for part in parts] == ["Background", "arm"][is_left_out:]
    assert bool(notes) == is_left_out
    assert len(parts_of(LayeredPicture(10, 10, (paper,)))[0]) == 1
    assert len(parts_of(LayeredPicture(10, 10, (arm, paper)))[0]) == 2


SAMPLES = {
    "psd": (DATA / "layers.psd").read_bytes(),
    "kra": (DATA / "layers.kra").read_bytes(),
    "ora": archive({"stack.xml": STACK, **{f"data/{k}.png": encode_png(np.zeros((3, 3, 4), "u1")) for k in "ab"}}),
    "kra unpacked": archive(
        {name: each.read(name) for each in [zipfile.ZipFile(DATA / "layers.kra")] for name in each.namelist()}
    ),
}


@pytest.mark.parametrize("kind", SAMPLES)
def test_damaged_files_end_in_a_sentence(kind: str) -> None:
    good, rng, said = SAMPLES[kind], np.random.default_rng(11), set()
    for _ in range(400):
        bad = bytearray(good)
        for place in rng.integers(0, len(good), rng.integers(1, 9)):
            bad[place] = rng.integers(0, 256)
        if rng.random() < 0.3:
            del bad[rng.integers(0, len(bad)) :]
        try:
            read(bytes(bad))
        except NestedCagesError as error:
            said.add(str(error))
    assert said
    assert all(sentence.endswith((".", "smaller.")) for sentence in said)


@pytest.mark.parametrize("kind", ["psd", "kra", "ora"])
@pytest.mark.parametrize("limit", ["pixels", "elements"])
def test_limits_of_layers(kind: str, limit: str) -> None:
    layers_of(SAMPLES[kind], LAYERED_LIMITS, decode_png)
    with pytest.raises(NestedCagesError, match=f"limit for {limit}"):
        layers_of(SAMPLES[kind], replace(LAYERED_LIMITS, **{limit: 2}), decode_png)


def test_bombs_and_strangers() -> None:
    with pytest.raises(NestedCagesError, match="limit for bytes"):
        layers_of(archive({"stack.xml": b" " * 10**6}), replace(LAYERED_LIMITS, bytes=10**5), decode_png)
    huge = archive({"stack.xml": '<image w="1" h="1"><stack><layer x="1e300"/></stack></image>'})
    with pytest.raises(NestedCagesError, match="not a number"):
        read(huge)
    deep = archive({"stack.xml": f'<image w="1" h="1">{"<stack>" * 900}{"</stack>" * 900}</image>'})
    with pytest.raises(NestedCagesError, match="more than 64 deep"):
        read(deep)
    for stranger in (b"", b"GIF89a", archive({"a.txt": "a"})):
        with pytest.raises(NestedCagesError, match="no layered picture"):
            read(stranger)
