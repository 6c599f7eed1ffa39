"""A painted cat becomes a puppet of Godot 4 that walks: cat.ora, cat.tscn, cat.png, and pictures for the guide.

    python examples/cat_to_godot.py [OUT] [--godot PROGRAM]

OUT: a folder, which becomes a project of Godot. With a Godot 4 and a display, such as by xvfb-run, the walk is drawn
by Godot: walk.gif. Needs Pillow and shapely.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]

import painted_cat  # noqa: E402
from benchmarks.engines.judge import draw  # noqa: E402
from nestedcages_core.game import Animation, GamePuppet, Painting, game_puppet, read_painting, write_puppet  # noqa: E402
from nestedcages_core.puppet import walk  # noqa: E402

SECONDS, FRAMES = 1.2, 24
BONE_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")


def picture_of_meshes(puppet: GamePuppet, painting: Painting) -> Image.Image:
    """The painting, pale, with the triangles of all meshes in the colours of their bones, and the bones."""
    page = Image.new("RGBA", painting.size, "white")
    for part in painting.parts:
        page.alpha_composite(Image.fromarray(part.pixels, "RGBA"), (part.left, part.top))
    page = Image.blend(page, Image.new("RGBA", page.size, "white"), 0.55)
    pen = ImageDraw.Draw(page)
    for mesh in puppet.meshes:
        places = puppet.place.down(mesh.points)
        for corners in places[mesh.triangles]:
            colour = BONE_COLOURS[mesh.strongest % len(BONE_COLOURS)]
            pen.line([tuple(point) for point in (*corners, corners[0])], fill=colour, width=1)
        pen.line([tuple(point) for point in (*places[: mesh.hull], places[0])], fill="black", width=2)
    for bone in puppet.bones:
        head, tail = puppet.place.down(np.array([bone.head, bone.tail]))
        pen.line([tuple(head), tuple(tail)], fill="#c00000", width=4)
        pen.ellipse([*(head - 6), *(head + 6)], fill="#c00000")
    return page.convert("RGB").quantize(64)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("out", nargs="?", type=Path, default=ROOT / "build" / "cat")
    options.add_argument("--godot")
    given = options.parse_args()
    folder = given.out
    folder.mkdir(parents=True, exist_ok=True)
    painted_cat.save(folder / "cat.ora")
    painting = read_painting(folder / "cat.ora")
    puppet = game_puppet(painting.parts, painting.size, name="cat")
    puppet = replace(puppet, animations=(Animation.of(walk(puppet.puppet, seconds=SECONDS, frames=FRAMES)),))
    for file in write_puppet(folder / "cat.tscn", puppet):
        print(f"Wrote {file}")
    (folder / "project.godot").write_text('config_version=5\n[application]\nconfig/name="cat"\n', encoding="utf-8")
    picture_of_meshes(puppet, painting).save(folder / "meshes.png", optimize=True)
    if given.godot:
        (folder / "puppet.tscn").write_text((folder / "cat.tscn").read_text(encoding="utf-8"), encoding="utf-8")
        angles = puppet.animations[0].turned
        poses = [{"turned": {name: keys[frame] for name, keys in angles.items()}} for frame in range(FRAMES)]
        wanted = {"poses": poses, "window": list(painted_cat.SIZE), "origin": painted_cat.SIZE[1]}
        (folder / "expected.json").write_text(json.dumps(wanted), encoding="utf-8")
        subprocess.run([given.godot, "--headless", "--path", folder, "--import"], capture_output=True, check=False)
        frames = [Image.open(file) for file in draw(folder, given.godot, FRAMES)]
        pages = [Image.new("RGBA", frame.size, "white") for frame in frames]
        for page, frame in zip(pages, frames, strict=True):
            page.alpha_composite(frame.convert("RGBA"))
        small = [page.convert("RGB").resize((360, 280), Image.Resampling.LANCZOS).quantize(32) for page in pages[::2]]
        small[0].save(folder / "walk.gif", save_all=True, append_images=small[1:], duration=100, loop=0)


if __name__ == "__main__":
    main()
