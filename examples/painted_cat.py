"""Paints a cat in layers and saves it as OpenRaster, which Krita, GIMP and MyPaint open: cat.ora.

    python examples/painted_cat.py OUT.ora

It stands in side view: two legs are near and two far, the tail is behind. Needs Pillow.
"""

from __future__ import annotations

import io
import sys
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

SIZE = (900, 700)
FINER = 2
"""Shapes are drawn larger by this, then made smaller, for smooth edges."""

FUR, DARK, LIGHT, INK = (226, 142, 62), (171, 94, 40), (247, 221, 184), (64, 36, 22)

Point = tuple[float, float]


class Brush:
    """A layer under work."""

    def __init__(self) -> None:
        self.solid = Image.new("L", (SIZE[0] * FINER, SIZE[1] * FINER))
        self.draw = ImageDraw.Draw(self.solid)

    def stroke(self, points: Sequence[Point], widths: Sequence[float]) -> Brush:
        """A soft line through points, round, with a width at each."""
        path = np.array(points, float)
        along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
        for place in np.linspace(0.0, along[-1], 400):
            x, y = (np.interp(place, along, path[:, axis]) for axis in (0, 1))
            self.dot((x, y), np.interp(place, along, widths) / 2)
        return self

    def dot(self, middle: Point, radius: float, taller: float = 1.0) -> Brush:
        (x, y), ry = middle, radius * taller
        self.draw.ellipse([FINER * value for value in (x - radius, y - ry, x + radius, y + ry)], fill=255)
        return self

    def area(self, points: Sequence[Point]) -> Brush:
        self.draw.polygon([(FINER * x, FINER * y) for x, y in points], fill=255)
        return self

    def painted(self, colour: tuple[int, int, int], outline: int = 4, stripes: Sequence[Brush] = ()) -> Image.Image:
        """The layer: shaded from above, with an outline of ink and stripes on it."""
        inner = np.asarray(self.solid.filter(ImageFilter.MinFilter(2 * outline + 1)) if outline else self.solid) > 127
        shade = np.asarray(self.solid.filter(ImageFilter.GaussianBlur(12 * FINER)), float) / 255
        rows = np.linspace(1.08, 0.86, self.solid.height)[:, None]
        tone = (0.62 + 0.42 * shade) * rows
        pixels = np.zeros((*inner.shape, 4))
        pixels[..., :3] = INK
        pixels[inner, :3] = (np.clip(tone[..., None], 0, 1.1) * colour)[inner]
        for stripe in stripes:
            on = inner & (np.asarray(stripe.solid) > 127)
            pixels[on, :3] = 0.35 * pixels[on, :3] + 0.65 * np.array(DARK)
        pixels[..., 3] = np.asarray(self.solid)
        pixels[..., :3] *= pixels[..., 3:] / 255  # premultiplied while it is made smaller
        small = np.stack(
            [
                np.asarray(Image.fromarray(pixels[..., k].astype(np.float32)).resize(SIZE, Image.Resampling.BOX))
                for k in range(4)
            ],
            -1,
        )
        small[..., :3] /= np.maximum(small[..., 3:], 1e-6) / 255
        return Image.fromarray(np.clip(small, 0, 255).round().astype(np.uint8), "RGBA")


def leg(hip: Point, knee: Point, foot: Point) -> Brush:
    x, y = foot
    return Brush().stroke([hip, knee, foot], [84, 58, 44]).stroke([foot, (x - 26, y + 6)], [42, 36])


def stripes(*lines: Sequence[Point]) -> list[Brush]:
    return [Brush().stroke(line, [13] * len(line)) for line in lines]


def layers() -> Iterator[tuple[str, str, Image.Image]]:
    """Group, name and picture of each layer, the lowest first."""
    far = tuple(int(0.8 * value) for value in FUR)
    tail = Brush().stroke([(668, 330), (730, 300), (780, 230), (800, 150), (770, 90)], [46, 44, 42, 40, 34])
    bands = stripes([(745, 240), (800, 262)], [(770, 180), (825, 190)], [(765, 130), (820, 110)])
    yield "", "tail", tail.painted(FUR, stripes=bands)
    yield "far legs", "hind leg far", leg((600, 390), (640, 480), (612, 590)).painted(far)
    yield "far legs", "foreleg far", leg((330, 400), (318, 490), (322, 592)).painted(far)
    body = Brush().stroke([(330, 350), (420, 352), (520, 350), (622, 345)], [170, 168, 172, 158])
    backs = stripes(*[[(x, 262), (x + 8, 310), (x - 4, 345)] for x in (400, 450, 500, 550, 600)])
    yield "", "body", body.painted(FUR, stripes=backs)
    yield "near legs", "hind leg near", leg((628, 385), (664, 486), (640, 606)).painted(FUR)
    yield "near legs", "foreleg near", leg((300, 400), (286, 496), (292, 608)).painted(FUR)
    yield "head", "ear far", Brush().area([(268, 150), (300, 78), (322, 168)]).painted(far)
    yield (
        "head",
        "face",
        Brush()
        .dot((242, 232), 98, 0.9)
        .dot((180, 262), 46, 0.8)
        .painted(FUR, stripes=stripes([(230, 150), (232, 190)], [(256, 150), (256, 192)], [(282, 156), (278, 192)])),
    )
    yield "head", "ear near", Brush().area([(196, 170), (206, 84), (262, 152)]).painted(FUR)
    yield "head", "muzzle", Brush().dot((168, 268), 34, 0.75).painted(LIGHT, outline=0)
    yield "head", "nose", Brush().area([(136, 250), (160, 250), (146, 266)]).painted((190, 90, 90), outline=2)
    yield "head", "eye", Brush().dot((206, 220), 17, 1.15).painted((150, 200, 90))
    yield "head", "pupil", Brush().dot((201, 221), 6, 1.9).painted(INK, outline=0)


def save(path: Path) -> None:
    """Write the painting."""
    image = ET.Element("image", w=str(SIZE[0]), h=str(SIZE[1]))
    stack, folders = ET.SubElement(image, "stack"), {}
    merged = Image.new("RGBA", SIZE)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(zipfile.ZipInfo("mimetype"), "image/openraster")  # first, and not packed
        for number, (folder, name, picture) in enumerate(layers()):
            merged.alpha_composite(picture)
            left, top, right, bottom = picture.getbbox() or (0, 0, 1, 1)
            file = f"data/{number:02d}.png"
            archive.writestr(file, png(picture.crop((left, top, right, bottom))))
            if folder and folder not in folders:
                folders[folder] = ET.Element("stack", name=folder)
                stack.insert(0, folders[folder])  # the first is on top
            layer = ET.Element("layer", name=name, src=file, x=str(left), y=str(top))
            (folders[folder] if folder else stack).insert(0, layer)
        archive.writestr("stack.xml", ET.tostring(image))
        archive.writestr("mergedimage.png", png(merged))


def png(picture: Image.Image) -> bytes:
    data = io.BytesIO()
    picture.save(data, "PNG")
    return data.getvalue()


if __name__ == "__main__":
    save(Path(sys.argv[1] if len(sys.argv) > 1 else "cat.ora"))
