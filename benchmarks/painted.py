"""Whether what is read of public drawings is what people see, pixel by pixel.

    python benchmarks/painted.py [--sets feather-icons twemoji …] [--files 50] [--seed 0] [--overlays FOLDER]

Icons, emoji, flags and clip-art come from packages, fetched once into build/painted; rsvg-convert (Debian's
librsvg2-bin) draws each file and, in the same frame, the mesh that was read of it. A file is right if at most 2 % of
its painted pixels lie outside the mesh and at most 2 % of the mesh's pixels are unpainted. Text and pictures inside a
drawing are left out on both sides. Needs npm and apt-get for the packages; --overlays writes pictures to look at.
"""

from __future__ import annotations

import argparse
import random
import re
import subprocess
import sys
import tarfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

import clone  # noqa: F401
from nestedcages_core import NestedCagesError
from nestedcages_core.exchange import Frame, svg_drawing, to_svg
from nestedcages_core.exchange.pictures import decode_png
from nestedcages_core.exchange.svg.writing import path_data

ROOT = Path(__file__).resolve().parents[1]
STORE = ROOT / "build" / "painted"

NPM, DEBIAN = "npm", "Debian"

SETS = {
    # strokes
    "feather-icons": NPM,
    "lucide-static": NPM,
    "@tabler/icons": NPM,
    "eva-icons": NPM,
    "heroicons": NPM,
    "ionicons": NPM,
    # filled paths
    "bootstrap-icons": NPM,
    "@fortawesome/fontawesome-free": NPM,
    "simple-icons": NPM,
    "remixicon": NPM,
    "boxicons": NPM,
    # opacity in two steps
    "@phosphor-icons/core": NPM,
    # clips, masks, gradients, references
    "@twemoji/svg": NPM,
    "devicon": NPM,
    "cryptocurrency-icons": NPM,
    "@lobehub/icons-static-svg": NPM,
    "super-tiny-icons": NPM,
    "flag-icons": NPM,
    "circle-flags": NPM,
    "payment-icons": NPM,
    "material-icon-theme": NPM,
    "@bybas/weather-icons": NPM,
    "@streetmix/illustrations": NPM,
    # clip-art and desktop icons, drawn by hand with shadows that fade away
    "openclipart-svg": DEBIAN,
    "tango-icon-theme": DEBIAN,
    "elementary-icon-theme": DEBIAN,
    "papirus-icon-theme": DEBIAN,
    "sugar-icon-theme": DEBIAN,
    "adwaita-icon-theme": DEBIAN,
}
"""Packages and where they come from."""

PIXELS = 512
"""Longer side of the pictures that are compared."""

WRONG = 0.02
"""Share of pixels above which a file is not right."""

SECONDS = 60
"""Time that the judge may take for a file."""

UNREAD = ("text", "image", "foreignObject")
"""Elements that neither side draws."""


@dataclass(frozen=True)
class Verdict:
    """One file: shares of pixels, and why there is none."""

    path: Path
    outside: float = 1.0
    unpainted: float = 1.0
    seconds: float = 0.0
    reason: str = ""

    @property
    def right(self) -> bool:
        return not self.reason and max(self.outside, self.unpainted) <= WRONG


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sets", nargs="+", choices=SETS, default=list(SETS), metavar="SET", help=", ".join(SETS))
    parser.add_argument("--files", type=int, default=50, help="of each set")
    parser.add_argument("--seed", type=int, default=0, help="which files")
    parser.add_argument("--opacity", type=float, default=0.0, help="above which paint counts, on both sides")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--overlays", type=Path, help="folder for pictures: red is missed, blue is too much")
    given = parser.parse_args()
    wrong: list[Verdict] = []
    total = 0
    print("| set | files | right | median outside | median unpainted | seconds a file |\n|---|---|---|---|---|---|")
    with ProcessPoolExecutor(given.jobs) as pool:
        for name in given.sets:
            files = chosen(fetched(name, SETS[name]), given.files, given.seed)
            count = len(files)
            found = list(pool.map(judged, files, [given.opacity] * count, [given.overlays] * count))
            found = [verdict for verdict in found if verdict.reason != EMPTY]
            total += len(found)
            bad = [verdict for verdict in found if not verdict.right]
            wrong += bad
            outside, unpainted, seconds = (
                np.median([getattr(verdict, key) for verdict in found]) for key in ("outside", "unpainted", "seconds")
            )
            print(
                f"| {name} | {len(found)} | {len(found) - len(bad)} | {100 * outside:.2f} % | {100 * unpainted:.2f} % "
                f"| {seconds:.2f} |",
                flush=True,
            )
    print(f"\n{total - len(wrong)} of {total} files are right, {100 * (1 - len(wrong) / total):.1f} %. The others:\n")
    for verdict in wrong:
        shares = f"outside {100 * verdict.outside:.1f} %, unpainted {100 * verdict.unpainted:.1f} %"
        print(f"* {verdict.path.relative_to(STORE)}: {verdict.reason or shares}")
    return 0


EMPTY = "nothing is painted"
"""Reason why a file does not count: the judge's picture is empty."""


def fetched(name: str, source: str) -> Path:
    """The folder of a package, downloaded if it is not there yet."""
    folder = STORE / re.sub(r"\W+", "_", name)
    if not (folder / "ready").exists():
        folder.mkdir(parents=True, exist_ok=True)
        if source == NPM:
            subprocess.run(["npm", "pack", "--silent", name], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            with tarfile.open(next(folder.glob("*.tgz"))) as archive:
                archive.extractall(folder, filter="data")
        else:
            subprocess.run(["apt-get", "download", name], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            subprocess.run(["dpkg-deb", "-x", next(folder.glob("*.deb")), folder], check=True)
        (folder / "ready").touch()
    return folder


def chosen(folder: Path, count: int, seed: int) -> list[Path]:
    """Some of the drawings in a folder, by chance; links to others are not counted."""
    files = sorted(path for path in folder.rglob("*.svg") if path.is_file() and not path.is_symlink())
    return random.Random(seed).sample(files, min(count, len(files)))


def judged(path: Path, opacity: float, overlays: Path | None) -> Verdict:
    """What the judge says of one file."""
    start = time.perf_counter()
    try:
        drawing = svg_drawing(path.read_bytes(), opacity=opacity)
    except NestedCagesError as error:
        try:
            if not painted(without_text(path, Frame()), opacity).any():
                return Verdict(path, reason=EMPTY)
        except subprocess.SubprocessError:
            return Verdict(path, reason=EMPTY)
        return Verdict(path, reason=str(error), seconds=time.perf_counter() - start)
    seconds = time.perf_counter() - start
    frame = drawing.frame
    if frame.page is None:  # the judge would frame each by what it draws
        low, high = drawing.mesh.vertices.min(axis=0), drawing.mesh.vertices.max(axis=0)
        frame = Frame((*low, *(high - low)))
    document = to_svg(drawing.mesh, frame=frame)
    root = document[: document.index(">") + 1]
    mesh = f'{root}<path fill-rule="evenodd" d="{path_data(drawing.mesh)}"/></svg>'
    try:
        seen, read = painted(without_text(path, frame), opacity), painted(mesh.encode(), opacity)
    except subprocess.SubprocessError as error:
        return Verdict(path, reason=f"not drawn by the judge: {error}", seconds=seconds)
    if not seen.any():
        return Verdict(path, reason=EMPTY)
    if overlays is not None:
        overlay(seen, read, overlays / f"{path.parent.name}_{path.stem}.ppm")
    outside = float((seen & ~read).sum() / seen.sum())
    return Verdict(path, outside, float((read & ~seen).sum() / max(read.sum(), 1)), seconds)


def without_text(path: Path, frame: Frame) -> bytes:
    """A document without what is not read, in a frame if it has none."""
    text = path.read_bytes()
    framed = re.search(rb"<svg[^>]*\sviewBox=|<svg[^>]*\swidth=", text)
    if framed and not any(f"<{name}".encode() in text for name in UNREAD):
        return text
    root = ET.fromstring(text)
    for parent in root.iter():
        for child in list(parent):
            if isinstance(child.tag, str) and child.tag.rpartition("}")[2] in UNREAD:
                parent.remove(child)
    if not framed and frame.view_box is not None:
        root.set("viewBox", " ".join(map(repr, map(float, frame.view_box))))
    return ET.tostring(root)


def painted(document: bytes, opacity: float) -> np.ndarray:
    """(h, w) which pixels the judge paints."""
    command = ["rsvg-convert", "--keep-aspect-ratio", "--unlimited", "-w", str(PIXELS), "-h", str(PIXELS)]
    shown = subprocess.run(command, input=document, capture_output=True, check=True, timeout=SECONDS).stdout
    return decode_png(shown)[:, :, 3] > 255.0 * opacity


def overlay(seen: np.ndarray, read: np.ndarray, path: Path) -> None:
    """A picture: grey where both agree, red where the mesh misses paint, blue where it is too much."""
    picture = np.full((*seen.shape, 3), 255, dtype=np.uint8)
    picture[seen & read] = (160, 160, 160)
    picture[seen & ~read] = (220, 30, 30)
    picture[read & ~seen] = (30, 60, 220)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"P6 %d %d 255\n" % (seen.shape[1], seen.shape[0]) + picture.tobytes())


if __name__ == "__main__":
    sys.exit(main())
