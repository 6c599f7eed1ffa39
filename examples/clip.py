"""The demo's animation as a short clip: the drawing shrinks, grows back, and pushes its cages out.

Run as ``python examples/clip.py``: renders pictures into build/clip and joins them to build/clip/letter_a.gif, or to
another file: ``python examples/clip.py FILE.gif``. Needs Blender as a Python module, and Pillow from the extra
``examples``.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

from check_animation import played
from demo import BODY, CAGE_AREAS, CAGES, CLEARANCE, COARSE, DOT, GHOST, INK, LEVELS, LINE, import_drawing, loops_at
from extension import registered
from picture import Fill, Outline, Panel, extent, render

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "build" / "clip"
PIXELS = 436  # width of the drawing; with its margins a picture is a tenth wider
SAMPLES = 6  # per pixel
SHRINKING, GROWING, TIGHTENING, NEXT = 14, 22, 16, 18  # pictures of each phase
MOMENT, HOLD, END = 160, 1600, 3600  # milliseconds that pictures are shown: in motion, where a phase ends, at the end
COLOURS = 48  # of the palette that all pictures share

Still = tuple[Panel, int]  # a picture and how long it is shown, in milliseconds


def first_cage(fine: bpy.types.Object, cage: bpy.types.Object, frames: tuple[int, ...]) -> Iterator[Still]:
    """The drawing shrinks into the coarse mesh, grows back and pushes it out."""
    start, inside, tight, end = frames
    ghost = Fill(loops_at(fine, start), GHOST)
    for text, paint, begin, until, count in (
        ("a drawing and a coarse mesh", COARSE, start, start, 0),
        ("the drawing shrinks into the mesh", COARSE, start, inside, SHRINKING),
        ("it grows back and pushes the mesh out", CAGES[0], inside, tight, GROWING),
        ("the cage becomes tight", CAGES[0], tight, end, TIGHTENING),
    ):
        for frame in np.linspace(begin, until, count + 1)[min(count, 1) :]:
            body = loops_at(fine, frame)
            shapes = [
                ghost,
                Fill(body, BODY),
                Outline(body, INK, LINE),
                Outline(loops_at(cage, frame), paint, LINE, DOT),
            ]
            yield Panel(text, shapes), HOLD if frame == until else MOMENT


def second_cage(
    fine: bpy.types.Object, inner: bpy.types.Object, cage: bpy.types.Object, frames: tuple[int, ...]
) -> Iterator[Still]:
    """A coarser cage around the first one, which stands still."""
    start, *_, end = frames
    for frame in np.linspace(start, end, NEXT):
        body, middle, outer = (loops_at(item, frame) for item in (fine, inner, cage))
        shapes = [Fill(outer, CAGE_AREAS[1]), Fill(middle, CAGE_AREAS[0]), Fill(body, BODY), Outline(body, INK, LINE)]
        shapes += [Outline(outer, CAGES[1], LINE, DOT), Outline(middle, CAGES[0], LINE, DOT)]
        yield Panel("a coarser cage encloses the first", shapes), END if frame == end else MOMENT


def join(pictures: Sequence[Path], times: Sequence[int], target: Path) -> None:
    """Writes an animated GIF that repeats, all of its pictures in the colours of one palette."""
    opened = [Image.open(path).convert("RGB") for path in pictures]
    sheet = Image.new("RGB", (opened[0].width, 2 * opened[0].height))
    sheet.paste(opened[0], (0, 0))
    sheet.paste(opened[-1], (0, opened[0].height))
    palette = sheet.quantize(COLOURS, dither=Image.Dither.NONE)
    few = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in opened]
    few[0].save(target, save_all=True, append_images=few[1:], duration=list(times), loop=0, optimize=True)


def main(arguments: list[str]) -> int:
    began = time.monotonic()
    FOLDER.mkdir(parents=True, exist_ok=True)
    target = Path(arguments[0]).resolve() if arguments else FOLDER / "letter_a.gif"
    import_drawing()
    with registered():
        bpy.ops.object.nested_cages_generate(levels=LEVELS, clearance=CLEARANCE)
        (made,) = played()
    first, second = made.cages
    stills = [*first_cage(made.fine, first, made.frames[0]), *second_cage(made.fine, first, second, made.frames[1])]
    corners = extent([panel for panel, _ in stills])
    pictures = [FOLDER / f"{number:03}.png" for number in range(len(stills))]
    for path, (panel, _) in zip(pictures, stills, strict=True):
        render(path, [panel], corners=corners, pixels=PIXELS, samples=SAMPLES)
    join(pictures, [shown for _, shown in stills], target)
    print(f"Wrote {os.path.relpath(target)}: {len(stills)} pictures, {target.stat().st_size / 1e6:.2f} MB")
    print(f"Done in {time.monotonic() - began:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
