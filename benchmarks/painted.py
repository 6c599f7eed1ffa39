"""Whether public drawings get cages, and whether these hold what people see, pixel by pixel.

    python benchmarks/painted.py [--sets feather-icons twemoji …] [--files 36] [--seed 0] [--overlays FOLDER]

Icons, emoji, flags, clip-art and themes of games come from packages, fetched once into build/painted; the command makes
a cage of 8 % of the vertices around each file, and rsvg-convert (Debian's librsvg2-bin) draws the file, its cage and
what was read of it in one frame. Told are the files that got a cage, the ink outside of cages, the CPU time and the
memory; a file is right if at most 2 % of its painted pixels lie outside of what was read and at most 2 % of that is
unpainted. Text and pictures inside a drawing are left out on both sides. Needs npm and apt-get for the packages.
"""

from __future__ import annotations

import argparse
import io
import random
import re
import signal
import subprocess
import sys
import tarfile
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

import clone  # noqa: F401
from nestedcages_core.command import main as command
from nestedcages_core.exchange import Frame
from nestedcages_core.exchange.pictures import decode_png

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
    # themes of games, whose view box is not always the page
    "gnome-mines": DEBIAN,
    "gnome-mahjongg": DEBIAN,
    "five-or-more": DEBIAN,
    "iagno": DEBIAN,
    "gnome-taquin": DEBIAN,
}
"""Packages and where they come from."""

PIXELS = 512
"""Longer side of the pictures that are compared."""

WRONG = 0.02
"""Share of pixels above which a file is not right."""

SECONDS = 60
"""Time that the judge may take for a file."""

LEVEL = "8%"
"""What the cages may have."""

GREATEST_SECONDS = 300
"""CPU time that a cage may take."""

MADE, INK = 0.995, 0.001
"""Least share of files with a cage, and greatest share of their ink outside of it, all files alike."""

CRISP = "*{shape-rendering:crispEdges!important}"
"""The judge paints or leaves pixels, by their centres: blended edges of shapes on top of each other would add up to
more ink than one edge of a cage in the same place has."""

UNREAD = ("text", "image", "foreignObject")
"""Elements that neither side draws."""


@dataclass(frozen=True)
class Verdict:
    """One file: shares of pixels and of ink, and why there is none."""

    path: Path
    outside: float = 1.0
    unpainted: float = 1.0
    ink: float = 0.0
    """Share of the ink outside of the cage."""
    seconds: float = 0.0
    """CPU time of reading, caging and writing."""
    memory: float = 0.0
    """Largest memory of the process so far, in MB."""
    reason: str = ""

    @property
    def right(self) -> bool:
        return not self.reason and max(self.outside, self.unpainted) <= WRONG


def main(words: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sets", nargs="+", choices=SETS, default=list(SETS), metavar="SET", help=", ".join(SETS))
    parser.add_argument("--files", type=int, default=36, help="of each set")
    parser.add_argument("--seed", type=int, default=0, help="which files")
    parser.add_argument("--opacity", type=float, default=0.0, help="above which paint counts, on both sides")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--overlays", type=Path, help="folder for pictures: red is missed, blue is too much")
    given = parser.parse_args(words)
    every: list[Verdict] = []
    print(
        "| set | files | with a cage | ink outside | read right | CPU median | worst |\n|---|---|---|---|---|---|---|"
    )
    with ProcessPoolExecutor(given.jobs) as pool:
        for name in given.sets:
            files = chosen(fetched(name, SETS[name]), given.files, given.seed)
            count = len(files)
            judgements = pool.map(judged, files, [given.opacity] * count, [given.overlays] * count)
            found = [verdict for verdict in judgements if verdict.reason != EMPTY]
            every += found
            print(row(name, found), flush=True)
            for verdict in found:
                said = fault(verdict)
                if said:
                    print(said, file=sys.stderr, flush=True)
    print(row("all", every))
    made = [verdict for verdict in every if not verdict.reason]
    ink = float(np.mean([verdict.ink for verdict in made]))
    print(f"\nLargest memory of a process: {max(verdict.memory for verdict in every):.0f} MB.")
    return 0 if len(made) >= MADE * len(every) and ink <= INK else 1


def fault(verdict: Verdict) -> str:
    """What is not right with a file."""
    shares = f"read wrongly: outside {100 * verdict.outside:.1f} %, unpainted {100 * verdict.unpainted:.1f} %"
    wrong = "" if verdict.right else verdict.reason or shares
    outside = f"ink outside {100 * verdict.ink:.2f} %" if verdict.ink > INK else ""
    words = ", ".join(filter(None, (wrong, outside)))
    return f"* {verdict.path.relative_to(STORE)}: {words}" if words else ""


def row(name: str, found: list[Verdict]) -> str:
    """A line of the table."""
    made = [verdict for verdict in found if not verdict.reason]
    ink, median, worst = (
        float(number([getattr(verdict, key) for verdict in some] or [0.0]))
        for number, key, some in ((np.mean, "ink", made), (np.median, "seconds", found), (np.max, "seconds", found))
    )
    right = sum(verdict.right for verdict in found)
    return f"| {name} | {len(found)} | {len(made)} | {100 * ink:.4f} % | {right} | {median:.2f} s | {worst:.1f} s |"


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
    start = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        document, reason = caged(path, Path(folder) / "out.svg", "--opacity", str(opacity))
    seconds = time.process_time() - start
    memory = largest_memory()
    if reason:
        try:
            if not painted(without_text(path, Frame()), opacity).any():
                return Verdict(path, reason=EMPTY)
        except subprocess.SubprocessError:
            return Verdict(path, reason=EMPTY)
        return Verdict(path, reason=reason, seconds=seconds, memory=memory)
    root, paths = document[: document.index(">") + 1], dict(PATH.findall(document))
    shown = [f'{root}<path fill-rule="evenodd" d="{paths[key]}"/></svg>'.encode() for key in ("drawing", "cage-1")]
    box = re.search(r'viewBox="([^"]*)"', root)
    frame = Frame(tuple(map(float, box[1].split()))) if box else Frame()  # type: ignore[arg-type]
    try:
        original, read, cage = (drawn(text) for text in (without_text(path, frame), *shown))
    except subprocess.SubprocessError as error:
        return Verdict(path, reason=f"not drawn by the judge: {error}", seconds=seconds, memory=memory)
    seen, kept = original > opacity, read > opacity
    if not seen.any():
        return Verdict(path, reason=EMPTY)
    if overlays is not None:
        overlay(seen, kept, overlays / f"{path.parent.name}_{path.stem}.ppm")
    return Verdict(
        path,
        float((seen & ~kept).sum() / seen.sum()),
        float((kept & ~seen).sum() / max(kept.sum(), 1)),
        float(np.maximum(original - cage, 0.0).sum() / original.sum()),
        seconds,
        memory,
    )


def largest_memory() -> float:
    """The largest memory of this process so far, in MB; 0 where the system has no /proc."""
    status = Path("/proc/self/status")
    found = re.search(r"VmHWM:\s*(\d+)", status.read_text(encoding="ascii")) if status.exists() else None
    return int(found[1]) / 1024.0 if found else 0.0


PATH = re.compile(r'<path id="([^"]*)"[^>]*?\sd="([^"]*)"')


def caged(path: Path, out: Path, *options: str) -> tuple[str, str]:
    """What the command writes, or why it writes nothing."""
    said = io.StringIO()

    def stop(*_: object) -> None:
        raise TimeoutError(f"no cage within {GREATEST_SECONDS} s of CPU")

    signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, GREATEST_SECONDS)
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(said):
            if command([str(path), "--levels", LEVEL, "--quiet", "-o", str(out), *options]) == 0:
                return out.read_text(encoding="utf-8"), ""
    except Exception as error:  # a traceback is what this looks for
        return "", f"{type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    return "", " ".join(line.removeprefix("error: ") for line in said.getvalue().splitlines() if "error: " in line)


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
    return np.asarray(drawn(document) > opacity)


def drawn(document: bytes) -> np.ndarray:
    """(h, w) the opacity that the judge paints, from 0 to 1."""
    style = STORE / "crisp.css"
    if not style.exists():
        style.write_text(CRISP, encoding="utf-8")
    size = ["-w", str(PIXELS), "-h", str(PIXELS)]
    judge = ["rsvg-convert", "--keep-aspect-ratio", "--unlimited", "--stylesheet", str(style), *size]
    shown = subprocess.run(judge, input=document, capture_output=True, check=True, timeout=SECONDS).stdout
    return np.asarray(decode_png(shown)[:, :, 3] / 255.0)


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
