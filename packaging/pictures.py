"""Makes the pictures of the README, the gallery and the guide again, each by the command that its page names.

    python packaging/pictures.py [NAME ...] [--blender COMMAND ...]

Without names all of them: the gallery from the examples, demo.png, and the clips. With --blender, a Blender 4.3 with a
window, those of the guide too; given once more with a 5.2, also the one that shows
it. Needs Blender as a Python module, and the extra `examples`.
"""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DOCS, STORIES = ROOT / "docs", ROOT / "build" / "stories"

CLIPS = {"demo": ("build/demo/letter_a.png", "demo.png"), "clip": ("build/clip/letter_a.gif", "letter_a.gif")}
"""Examples whose picture has another name in docs: the file that they make, and its name there."""

TEXTS = (b"tEXt", b"zTXt", b"iTXt")
"""Chunks of a PNG that hold texts."""

PLACES = {"character.gif": DOCS, "fox_walk.gif": DOCS, "waving.gif": DOCS}
"""Folders of pictures that are not in docs/gallery."""


def examples() -> list[str]:
    """Examples that make a picture of the documentation."""
    shown = {path.stem for path in (*DOCS.glob("*.gif"), *(DOCS / "gallery").glob("*.*"))}
    return sorted({*CLIPS, *(path.stem for path in (ROOT / "examples").glob("*.py") if path.stem in shown)})


def renew(name: str) -> list[Path]:
    """Run an example and copy the pictures that the documentation has of it."""
    subprocess.run([sys.executable, str(ROOT / "examples" / f"{name}.py")], cwd=ROOT, check=True)
    if name in CLIPS:
        made, target = CLIPS[name]
        return [without_paths(Path(shutil.copy(ROOT / made, DOCS / target)))]
    made_files = [STORIES / f"{name}{ending}" for ending in (".png", ".gif")]
    targets = [(path, PLACES.get(path.name, DOCS / "gallery") / path.name) for path in made_files if path.is_file()]
    return [without_paths(Path(shutil.copy(path, target))) for path, target in targets if target.is_file()]


def without_paths(picture: Path) -> Path:
    """The picture; of a PNG, texts such as the path that Blender rendered it to are left out."""
    data = picture.read_bytes()
    if data.startswith(b"\x89PNG"):
        kept, at = [data[:8]], 8
        while at < len(data):
            end = at + 12 + int.from_bytes(data[at : at + 4], "big")
            kept += [data[at:end]] if data[at + 4 : at + 8] not in TEXTS else []
            at = end
        picture.write_bytes(b"".join(kept))
    return picture


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"only these: {', '.join(examples())}")
    parser.add_argument("--blender", action="append", default=[], help="command of a Blender with a window")
    options = parser.parse_args()
    unknown = [name for name in options.names if name not in examples()]
    if unknown:
        parser.error(f"no picture is made by {unknown[0]!r}; there are {', '.join(examples())}")
    for name in options.names or examples():
        for path in renew(name):
            print(f"{path.relative_to(ROOT)} made", flush=True)
    for command in options.blender:
        window = [*shlex.split(command), "--factory-startup", "-p", "0", "0", "1280", "800"]
        script = str(ROOT / "packaging" / "guide_pictures.py")
        subprocess.run([*window, "--python", script], cwd=ROOT, env=dict(os.environ), check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
