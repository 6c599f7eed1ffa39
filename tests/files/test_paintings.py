"""Layered paintings, read by the command `puppet` and judged in what it writes: by psd-tools, PIL, and each other."""

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from support.command import run
from support.documents import archive, png_of, svg
from support.engines import composed, read_godot
from support.marks import slow_after
from support.paintings import on_canvas, picture, psd_of, rig_of, shown

psd_tools = pytest.importorskip("psd_tools", reason="psd-tools judges the reader of PSD: pip install psd-tools")

DATA = Path(__file__).resolve().parents[1] / "data"
"""layers.psd: drawn by a script and written by ag-psd 31; layers.kra: the same, opened and saved by Krita 5.1.5."""

STACK = """<image w="40" h="30"><stack><stack name="head" x="2" y="1" opacity="0.5">
<layer name="hair" src="data/a.png" x="3" y="4" composite-op="svg:multiply"/>
<layer name="face" src="data/b.png" x="-1" visibility="hidden"/></stack>
<layer name="body" src="data/a.png" y="20"/><text name="words"/></stack></image>"""


@pytest.mark.parametrize(
    ("mode", "compression"),
    slow_after(
        0, [("RGB", 1), ("CMYK", 2), *((m, c) for m in ("L", "RGB", "CMYK") for c in range(4))], thorough_after=5
    ),
)
def test_psd_as_psd_tools_writes_and_reads_it(mode: str, compression: int, tmp_path: Path) -> None:
    size = (90, 60)
    psd = psd_tools.PSDImage.new(mode, size)
    group = psd.create_group(name="head")
    for number, (name, left, top, shape) in enumerate(
        (("face é", 10, -5, (20, 31)), ("eye", 60, 30, (17, 20)), ("hat", 40, 40, (9, 9)))
    ):
        image = Image.fromarray(picture(number, *shape), "RGBA").convert("LA" if mode == "L" else "RGBA")
        layer = psd.create_pixel_layer(image, name, top, left, compression=psd_tools.constants.Compression(compression))
        group.append(layer)
        if name == "eye":
            layer.blend_mode, layer.opacity = psd_tools.constants.BlendMode.MULTIPLY, 77
        layer.visible = name != "hat"
    psd.save(tmp_path / "a.psd")
    rig, _ = rig_of(tmp_path / "a.psd", "--hidden")
    theirs = {layer.name: layer for layer in psd_tools.PSDImage.open(tmp_path / "a.psd").descendants()}
    seen = [part for part in rig.parts if ".island" not in part.name]
    assert [(part.name, part.blend, part.is_visible) for part in seen] == [
        ("face é", "normal", True), ("eye", "multiply", True), ("hat", "normal", False)
    ]  # fmt: skip
    for part in seen:
        layer = theirs[part.name]
        colour, alpha = layer.numpy("color"), layer.numpy("shape") * layer.numpy("mask")  # alpha of PIL is a mask
        if mode == "CMYK":
            colour = colour[..., :3] * colour[..., 3:]
        rgba = np.dstack([np.broadcast_to(colour, (*alpha.shape[:2], 3)), alpha])
        wanted = on_canvas(np.round(255 * rgba).astype(np.uint8), layer.left, layer.top, size, layer.opacity / 255)
        np.testing.assert_allclose(shown(rig, part.name, size), wanted, atol=1.6)
    rest, notes = rig_of(tmp_path / "a.psd")
    assert "hat" not in {part.name for part in rest.parts} and "hat" in notes


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("depth", [16, 32])
def test_deep_layers(depth: int, big: bool, tmp_path: Path) -> None:
    """Channels by hand, after the specification: 16 and 32 bits, with differences, in both sizes of lengths."""
    values = np.linspace(0.25, 1.0, 12).reshape(3, 4)
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
    path = tmp_path / ("a.psb" if big else "a.psd")
    merged = bytes(2 + 3 * 9 * 9 * depth // 8)
    path.write_bytes(head + struct.pack(f">{long}", len(section)) + section + merged)
    rig, _ = rig_of(path)
    found = shown(rig, "arm", (9, 9))[2:5, 1:5]
    light = (
        values if depth == 16 else np.where(values <= 0.0031308, 12.92 * values, 1.055 * values ** (1 / 2.4) - 0.055)
    )
    np.testing.assert_allclose(found[..., 3], 255 * values, atol=0.51)
    np.testing.assert_allclose(found[..., 1], 255 * light, atol=0.51)


@pytest.mark.slow
def test_krita_and_ag_psd_have_the_same_pixels(tmp_path: Path) -> None:
    rigs = []
    for kind in ("psd", "kra"):
        (tmp_path / f"layers.{kind}").write_bytes((DATA / f"layers.{kind}").read_bytes())
        assert run("puppet", tmp_path / f"layers.{kind}", "-o", tmp_path / f"{kind}.tscn", "--hidden").status == 0
        rigs.append((read_godot(tmp_path / f"{kind}.tscn"), rig_of(tmp_path / f"layers.{kind}", "--hidden")[0]))
    (_, psd), (godot, kra) = rigs
    assert [part.name for part in psd.parts] == ["body", "face 左", "eye", "arm"]
    for one, other, third in zip(psd.parts, kra.parts, godot.parts, strict=True):
        assert (one.name, one.blend, one.is_visible) == (other.name, other.blend, other.is_visible)
        assert (third.blend, third.is_visible) == (other.blend, other.is_visible)
        np.testing.assert_array_equal(shown(psd, one.name, (70, 40)), shown(kra, one.name, (70, 40)))
    arm = shown(psd, "arm", (70, 40))[..., 3]
    rows, columns = np.nonzero(arm)
    arm = arm[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
    assert arm.ravel().tolist() == [(128 + 3 * k) % 256 for k in range(64)]  # as much as its mask shows


def test_openraster(tmp_path: Path) -> None:
    first, second = picture(0, 5, 6), picture(1, 3, 4)
    files = {"stack.xml": STACK, "data/a.png": png_of(first), "data/b.png": png_of(second)}
    (tmp_path / "a.ora").write_bytes(archive(files))
    rig, notes = rig_of(tmp_path / "a.ora", "--hidden")
    names = [(part.name, part.blend, part.is_visible) for part in rig.parts if ".island" not in part.name]
    assert names == [("body", "normal", True), ("face", "normal", False), ("hair", "multiply", True)]
    for name, pixels, left, top, opacity in (
        ("body", first, 0, 20, 1.0), ("face", second, 1, 1, 0.5), ("hair", first, 5, 5, 0.5)
    ):  # fmt: skip
        wanted = on_canvas(pixels, left, top, (40, 30), opacity)
        np.testing.assert_allclose(shown(rig, name, (40, 30)), wanted, atol=1)
    assert "head" in notes  # has an opacity, which becomes that of its layers


def test_groups_are_read_to_a_depth_that_no_program_makes(tmp_path: Path) -> None:
    for depth, status in ((64, 0), (65, 1)):
        groups = "<stack>" * depth + '<layer name="a" src="a.png"/>' + "</stack>" * depth
        files = {"stack.xml": f'<image w="9" h="9"><stack>{groups}</stack></image>', "a.png": png_of(picture(0, 9, 9))}
        (tmp_path / "a.ora").write_bytes(archive(files))
        assert run("puppet", tmp_path / "a.ora", "-o", tmp_path / "a.json").status == status, depth


def test_a_folder_of_pictures_is_ordered_by_numbers_and_placed_by_offsets(tmp_path: Path) -> None:
    place = tmp_path / "cat"
    pictures = {name: picture(k, 4 + k, 9) for k, name in enumerate(("10_arm.png", "2 body.png", "head/1-face.png"))}
    for name, pixels in pictures.items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        data = png_of(pixels)
        if "arm" in name:
            offset = b"oFFs" + struct.pack(">iiB", 5, 6, 0)
            data = data[:33] + struct.pack(">I", 9) + offset + struct.pack(">I", zlib.crc32(offset)) + data[33:]
        (place / name).write_bytes(data)
    rig, _ = rig_of(place)
    assert [part.name for part in rig.parts if ".island" not in part.name] == ["body", "arm", "face"]
    np.testing.assert_array_equal(shown(rig, "arm", (14, 10)), on_canvas(pictures["10_arm.png"], 5, 6, (14, 10)))
    (tmp_path / "empty").mkdir()
    assert run("puppet", tmp_path / "empty", "-o", tmp_path / "a.json").status == 1


def test_masks_groups_and_clipping_are_applied(tmp_path: Path) -> None:
    """Clipped layers are painted onto those below them, of which the alpha stays; masks and opacities are in alpha."""
    whole, half = np.full((8, 8, 4), 200, np.uint8), np.full((8, 8, 4), 255, np.uint8) // (1, 2, 1, 1)
    whole[..., 3] = 255
    mask = np.full((8, 8), 255, np.uint8)
    mask[:, 5:] = 51
    multiply = psd_tools.constants.BlendMode.MULTIPLY
    layers: list[dict[str, Any]] = [
        {"name": "base", "pixels": whole, "left": 2, "top": 3, "mask": mask, "group": "head"},
        {"name": "shade", "pixels": half.astype(np.uint8), "left": 6, "top": 3, "blend": multiply, "clipped": True,
         "opacity": 128, "group": "head"},
        {"name": "odd", "pixels": whole, "left": 16, "blend": psd_tools.constants.BlendMode.DISSOLVE,
         "mask": np.full((4, 8), 255, np.uint8)},
        {"name": "gone", "pixels": whole, "left": 16, "top": 14, "visible": False},
    ]  # fmt: skip
    psd_of(tmp_path / "a.psd", (30, 24), layers)
    rig, notes = rig_of(tmp_path / "a.psd")
    assert [part.name for part in rig.parts] == ["base", "odd"]
    base = shown(rig, "base", (30, 24))[3:11, 2:10]
    assert base[0, :, 3].tolist() == [128] * 5 + [26] * 3
    np.testing.assert_allclose(base[0, :, 1], [200] * 4 + [200 - 100 * 128 / 255] * 4, atol=1.1)
    assert (base[..., 0] == 200).all()
    assert (shown(rig, "odd", (30, 24))[..., 3] > 0).nonzero()[0].max() == 3  # beyond a mask nothing is seen
    assert all(name in notes for name in ("shade", "odd", "gone", "head"))


@pytest.mark.parametrize(
    ("left", "width", "is_left_out"), slow_after(1, [(-3, 20, True), (0, 10, True), (0, 9, False), (4, 10, False)])
)
def test_a_background_is_no_part(left: int, width: int, is_left_out: bool, tmp_path: Path) -> None:
    """What Photoshop and Krita begin a painting with; alone, or above a part, it is one, unless its name says so."""
    paper = {"name": "sheet", "pixels": np.full((12, width, 4), 255, np.uint8), "left": left, "top": -1}
    arm = {"name": "arm", "pixels": np.full((4, 4, 4), 255, np.uint8), "left": 3, "top": 3}
    for name, layers, names in (
        ("sheet", [paper, arm], ["sheet", "arm"][is_left_out:]), ("sheet", [paper], ["sheet"]),
        ("sheet", [arm, paper], ["arm", "sheet"]), ("Hintergrund", [arm, paper], ["arm"]),
    ):  # fmt: skip
        paper["name"] = name
        psd_of(tmp_path / "a.psd", (10, 10), layers)
        assert [part.name for part in rig_of(tmp_path / "a.psd")[0].parts] == names


def test_layers_of_one_limb_are_one_part_that_has_the_name_of_its_group(tmp_path: Path) -> None:
    """Lines around a colour, what lies between, a part that a group names, tags, and joints that the artist drew."""
    y, x = np.mgrid[:60, :60]
    disc, within = np.hypot(x - 30, y - 30) < 24, np.hypot(x - 30, y - 30) < 21
    kinds = {"colour": disc, "shade": within & (x > 40), "line": disc & ~within, "1": disc & (y < 30), "dot": within}
    drawn = {name: np.dstack([np.full((60, 60), 90), x * 3, y * 3, shown * 255]).astype(np.uint8)
             for name, shown in kinds.items()}  # fmt: skip
    groups = {
        "head [bone:x]": ("colour", "shade", "line"),
        "Arm": ("1",),
        "joints": ("dot",),
        "[ignore] old": ("line",),
    }
    stack = "".join(
        f'<stack name="{group}">' + "".join(f'<layer name="{n}" src="{n}.png"/>' for n in names[::-1]) + "</stack>"
        for group, names in reversed(groups.items())
    )
    files = {f"{name}.png": png_of(pixels) for name, pixels in drawn.items()}
    (tmp_path / "a.ora").write_bytes(
        archive({"stack.xml": f'<image w="200" h="60"><stack>{stack}</stack></image>', **files})
    )
    rig, notes = rig_of(tmp_path / "a.ora")
    assert [part.name for part in rig.parts] == ["head", "Arm"]
    head = shown(rig, "head", (200, 60))[:, :60]
    seen = np.array(
        Image.alpha_composite(Image.fromarray(drawn["colour"], "RGBA"), Image.fromarray(drawn["line"], "RGBA"))
    )
    np.testing.assert_allclose(head[disc & (x <= 40)], seen[disc & (x <= 40)], atol=1)
    assert all(name in notes for name in ("head", "dot", "line"))


def test_names_without_unicode_are_read_as_they_were_written(tmp_path: Path) -> None:
    """Pascal strings alone, in UTF-8, Shift-JIS and Mac Roman."""
    for name, encoding in (("胴体", "cp932"), ("tête", "utf-8"), ("tête", "macroman")):
        psd_of(tmp_path / "a.psd", (9, 9), [{"name": "x" * len(name.encode(encoding)), "pixels": picture(0, 9, 9)}])
        data = (tmp_path / "a.psd").read_bytes().replace(b"luni", b"lunx")
        written = name.encode(encoding)
        (tmp_path / "a.psd").write_bytes(
            data.replace(bytes([len(written)]) + b"x" * len(written), bytes([len(written)]) + written)
        )
        assert rig_of(tmp_path / "a.psd")[0].parts[0].name == name


@pytest.mark.slow
def test_drawings_become_pictures_of_their_paints(tmp_path: Path) -> None:
    body = """<g id="whole"><rect id="body" x="4" y="6" width="20" height="10" fill="#f00" stroke="#00f"
        stroke-width="2"/><rect id="arm" x="20" y="8" width="9" height="4" fill="#0f0" fill-opacity="0.5"/></g>"""
    (tmp_path / "a.svg").write_text(svg(body, 'width="30" height="20"'))
    rig, _ = rig_of(tmp_path / "a.svg", "--pixels", 260)  # ten to the unit
    size = (260, 120)
    whole = Image.new("RGBA", size)
    whole.paste((0, 0, 255, 255), (0, 0, 220, 120))
    whole.paste((255, 0, 0, 255), (20, 20, 200, 100))
    arm = Image.new("RGBA", size)
    arm.paste((0, 255, 0, 128), (170, 30, 260, 70))
    np.testing.assert_array_equal(shown(rig, "body", size), np.array(whole))
    np.testing.assert_array_equal(shown(rig, "arm", size), np.array(arm))
    seen = np.array(Image.alpha_composite(whole, arm))
    np.testing.assert_allclose(rig.seen(size), seen, atol=1.5)
    limbs = "".join(f'<g id="limb{k}"><path d="M{k} 2h9v9h-9z"/><circle cx="{k}" cy="9" r="2"/></g>' for k in range(3))
    (tmp_path / "a.svg").write_text(svg(body + limbs))
    grouped = {part.name for part in rig_of(tmp_path / "a.svg", "--pixels", 100)[0].parts}
    assert {"whole", "limb0", "limb1", "limb2"} <= grouped and "body" not in grouped


def test_edges_of_drawings_are_smooth(tmp_path: Path) -> None:
    """The alpha of a pixel is the part of it that is covered."""
    (tmp_path / "a.svg").write_text(svg('<path id="a" d="M0 0H20L0 10z"/>'))
    rig, _ = rig_of(tmp_path / "a.svg", "--pixels", 40)
    alpha = shown(rig, "a", (40, 20))[..., 3] / 255
    x, y = np.meshgrid(np.arange(40), np.arange(20))
    fine = (np.arange(16) + 0.5) / 16
    u, v = x[..., None, None] + fine, y[..., None, None] + fine[:, None]
    np.testing.assert_allclose(alpha, (u / 40 + v / 20 < 1.0).mean(axis=(2, 3)), atol=0.05)


def _through(x: Any, y: Any) -> Any:
    """How far from a focus a quarter left of the middle, as a fraction of the way on to a circle of radius a half."""
    length = np.hypot(x, y)
    ahead = 0.25 * x / length
    return length / (ahead + np.sqrt(ahead**2 + 0.25 - 0.25**2))


@pytest.mark.parametrize(
    ("kind", "t"),
    [('linearGradient id="g" x1="0.5"', lambda x, y: 2.0 * x - 1.0),
     ('linearGradient id="g" x2="0.4" spreadMethod="reflect"', lambda x, y: 1.0 - abs(x / 0.4 % 2.0 - 1.0)),
     ('radialGradient id="g" gradientTransform="scale(1 0.5)"', lambda x, y: 2.0 * np.hypot(x - 0.5, 2.0 * y - 0.5)),
     ('radialGradient id="g" fx="0.25"', lambda x, y: _through(x - 0.25, y - 0.5))],
)  # fmt: skip
def test_gradients_have_their_colours(kind: str, t: Any, tmp_path: Path) -> None:
    stops = '<stop offset="0" stop-color="#f00"/><stop offset="1" stop-color="#00f" stop-opacity="0.5"/>'
    name = kind.partition(" ")[0]
    (tmp_path / "a.svg").write_text(svg(f'<{kind}>{stops}</{name}><rect id="a" width="8" height="6" fill="url(#g)"/>'))
    seen = shown(rig_of(tmp_path / "a.svg", "--pixels", 80)[0], "a", (80, 60))
    x, y = np.meshgrid((np.arange(80) + 0.5) / 80, (np.arange(60) + 0.5) / 60)
    share = np.clip(t(x, y), 0.0, 1.0)[..., None]
    np.testing.assert_allclose(seen, (1.0 - share) * (255, 0, 0, 255) + share * (0, 0, 255, 127.5), atol=2.0)


@pytest.mark.parametrize(
    "content",
    [b"", b"GIF89a", archive({"a.txt": "a"}),
     archive({"stack.xml": '<image w="1" h="1"><stack><layer x="1e300"/></stack></image>'}),
     archive({"stack.xml": f'<image w="1" h="1">{"<stack>" * 900}{"</stack>" * 900}</image>'}),
     archive({"stack.xml": "<image/>"}), archive({"stack.xml": STACK}), (DATA / "layers.psd").read_bytes()[:3000],
     (DATA / "layers.kra").read_bytes()[:3000]],
)  # fmt: skip
def test_what_is_no_painting_is_an_error(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.ora").write_bytes(content)
    done = run("puppet", tmp_path / "a.ora", "-o", tmp_path / "a.json")
    assert done.status == 1 and done.err.startswith("error: ") and "Traceback" not in done.err
    assert [*tmp_path.iterdir()] == [tmp_path / "a.ora"]


@pytest.mark.slow
def test_at_rest_a_puppet_looks_like_its_painting(tmp_path: Path) -> None:
    """With opacities, hidden layers and blend modes, in both engines."""
    size = (60, 50)
    modes = {"normal": "NORMAL", "multiply": "MULTIPLY", "add": "LINEAR_DODGE"}
    layers, wanted = [], []
    for number, (blend, opacity) in enumerate((("normal", 255), ("normal", 120), ("multiply", 255), ("add", 200))):
        pixels = picture(number, 24, 30)
        pixels[:, :, 3] = np.where(np.hypot(*(np.indices((24, 30)) - 12)) < 11, 255, 0)
        left, top = 12 + 5 * number, 4 + 6 * number
        layers.append({"name": f"part{number}", "pixels": pixels, "left": left, "top": top, "opacity": opacity,
                       "blend": getattr(psd_tools.constants.BlendMode, modes[blend])})  # fmt: skip
        wanted.append((on_canvas(pixels, left, top, size, opacity / 255), blend))
    psd_of(tmp_path / "a.psd", size, [*layers, {"name": "x", "pixels": picture(9, 9, 9), "visible": False}])
    spine, _ = rig_of(tmp_path / "a.psd")
    assert run("puppet", tmp_path / "a.psd", "-o", tmp_path / "a.tscn").status == 0
    for rig in (spine, read_godot(tmp_path / "a.tscn")):
        seen, whole = rig.seen(size), composed(wanted)
        np.testing.assert_allclose(seen[..., 3], whole[..., 3], atol=1.5)
        opaque = whole[..., 3] > 100
        np.testing.assert_allclose(seen[opaque], whole[opaque], atol=2.5)
