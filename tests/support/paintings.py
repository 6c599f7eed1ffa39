"""Layered paintings that tests write, and the pixels of the puppets that the command makes of them."""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from support.command import run
from support.documents import png_of
from support.engines import Rig, read_spine


def rig_of(painting: Path, *options: object) -> tuple[Rig, str]:
    """The rig that Spine gets, and the notes."""
    out = painting.with_name("rig.json")
    done = run("puppet", painting, "-o", out, *options)
    assert done.status == 0, done
    return read_spine(out), done.err


def shown(rig: Rig, name: str, size: tuple[int, int]) -> np.ndarray:
    """(H, W, 4) the pixels of a layer on the canvas, all its meshes together; transparent ones are 0."""
    pictures = [
        rig.picture_of(part, size) for part in rig.parts if part.name == name or part.name.startswith(f"{name}.island")
    ]
    whole = np.zeros_like(pictures[0])
    for picture in pictures:
        whole = np.where(picture[..., 3:] > 0, picture, whole)
    return np.where(whole[..., 3:] > 0, whole, 0)


def on_canvas(pixels: np.ndarray, left: int, top: int, size: tuple[int, int], opacity: float = 1.0) -> np.ndarray:
    """(H, W, 4) a picture on a canvas, cut off at its edges; transparent pixels are 0."""
    image = Image.fromarray(pixels, "RGBA")
    canvas = Image.new("RGBA", size)
    canvas.paste(image, (left, top))
    out = np.array(canvas)
    out[..., 3] = np.round(out[..., 3] * opacity)
    return np.where(out[..., 3:] > 0, out, 0)


def picture(seed: int, height: int, width: int) -> np.ndarray:
    """Pixels with runs, noise and transparency."""
    out = np.random.default_rng(seed).integers(0, 256, (height, width, 4), dtype=np.uint8)
    out[..., 3] = out[..., 3] // 2 + 128
    out[: height // 2, :, :3] = (200, 10, 30)
    out[:, : width // 3, 3] = 0
    return out


def psd_of(path: Path, size: tuple[int, int], layers: list[dict[str, Any]]) -> None:
    """A PSD by psd-tools, of layers with pixels, name, left, top and what else they have."""
    psd_tools = pytest.importorskip("psd_tools", reason="psd-tools writes PSD: pip install psd-tools")
    psd = psd_tools.PSDImage.new("RGB", size)
    groups: dict[str, Any] = {}
    for each in layers:
        image = Image.fromarray(each["pixels"], "RGBA")
        layer = psd.create_pixel_layer(image, each["name"], each.get("top", 0), each.get("left", 0))
        if "mask" in each:
            layer.remove_mask()
            layer.create_mask(Image.fromarray(each["mask"], "L"))
        layer.opacity, layer.visible = each.get("opacity", 255), each.get("visible", True)
        if "blend" in each:
            layer.blend_mode = each["blend"]
        if "group" in each:
            group = groups.setdefault(each["group"], None) or psd.create_group(name=each["group"])
            groups[each["group"]] = group
            group.append(layer)
            group.opacity = 128
        layer.clipping = each.get("clipped", False)
    psd.save(path)


def openraster(path: Path, layers: list[dict[str, Any]], size: tuple[int, int]) -> Path:
    """An OpenRaster file of layers, the lowest first."""
    image = [f'<image w="{size[0]}" h="{size[1]}"><stack>']
    with zipfile.ZipFile(path, "w") as archive:
        for number, each in reversed([*enumerate(layers)]):
            archive.writestr(f"data/{number}.png", png_of(each["pixels"]))
            name = each["name"].replace('"', "&quot;")
            shown = "visible" if each.get("visible", True) else "hidden"
            image.append(
                f'<layer name="{name}" src="data/{number}.png" opacity="{each.get("opacity", 1.0)}" '
                f'visibility="{shown}" composite-op="svg:{each.get("blend", "src-over")}"/>'
            )
        archive.writestr("stack.xml", "".join([*image, "</stack></image>"]))
    return path
