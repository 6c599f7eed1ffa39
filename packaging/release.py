"""Puts everything that a release needs into dist: zips of the extension and its listing, wheel, sdist, site, checksums.

    python packaging/release.py            # or: make release
    python packaging/release.py --listing  # only the texts and pictures for the extension's page, in build/listing

Needs what `build_extension.py` needs, and the packages build and matplotlib.
"""

from __future__ import annotations

import argparse
import hashlib
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
from licences import licences

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from nestedcages_core import Mesh, cage_coordinates, deform, nested_cages, read_svg  # noqa: E402

DIST = ROOT / "dist"
WHEELS = ROOT / "build" / "wheels"
SITE = ROOT / "build" / "site"
LISTING = ROOT / "build" / "listing"

ICON, FEATURED = (256, 256), (1920, 1080)
"""Sizes of the listing's pictures in pixels, as extensions.blender.org asks for."""

SCREENSHOTS = ("panel", "result", "posed", "playing", "cutout")
"""Pictures of the guide that the listing shows."""

LEVELS = 32, 16
"""Vertices of the cages in the pictures."""

CLEARANCE = 0.02
"""Clearance in the pictures, as a fraction of the drawing's diagonal, so that gaps can be seen."""

LINES_ACROSS = 150
"""Width of a drawing in the pictures, in widths of a line."""

LEAN = 0.45
"""Turn of the top of the posed letter, in radians."""

BACK, INK, CAGES = "#1d2736", "#f4f1ea", ("#56b4e9", "#e69f00")
"""Colours of background and drawing, and of the finer and the coarser cage."""

DPI = 100


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--listing", action="store_true", help="only the texts and pictures for the extension's page")
    options = parser.parse_args()
    if not options.listing:
        shutil.rmtree(DIST, ignore_errors=True)
        run(sys.executable, str(ROOT / "packaging" / "build_extension.py"))
        run(sys.executable, "-m", "build", "--outdir", str(DIST))
        if SITE.is_dir():
            shutil.make_archive(str(DIST / "nested_cages-site"), "zip", SITE)
    listing(LISTING, sorted(WHEELS.rglob("*.whl")))
    if options.listing:
        return 0
    shutil.make_archive(str(DIST / "nested_cages-listing"), "zip", LISTING)
    sums = checksums(DIST)
    (DIST / "SHA256SUMS").write_text(sums, encoding="utf-8")
    print(sums, end="")
    return 0


def run(*command: str) -> None:
    """Run a command of a release. Raises CalledProcessError if it fails."""
    subprocess.run(command, cwd=ROOT, check=True)


def listing(folder: Path, wheels: list[Path]) -> None:
    """Texts and pictures for the extension's page: description, permissions, licences, icon, featured picture."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    shutil.copy(ROOT / "packaging" / "listing.md", folder / "description.md")
    reasons = [f"{name}: {reason}" for name, reason in manifest["permissions"].items()]
    (folder / "permissions.txt").write_text("\n".join(reasons) + "\n", encoding="utf-8")
    (folder / "licences.txt").write_text("\n".join(licences(wheels)) + "\n", encoding="utf-8")
    for name in SCREENSHOTS:
        shutil.copy(ROOT / "docs" / "guide" / f"{name}.png", folder)
    pictures(folder)


def pictures(folder: Path) -> None:
    """The icon, a letter in a cage on a tile, and the featured picture: the letter, its cages, and a pose by them."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt
    from matplotlib.patches import FancyBboxPatch

    drawn = read_svg(ROOT / "examples" / "letter_a.svg")
    letter = Mesh.from_loops([ring * (1.0, -1.0) for ring in drawn.rings])
    made = nested_cages(letter, LEVELS, clearance=CLEARANCE * letter.diagonal)
    cage = made[-1].cage
    posed = leaning(cage)
    bent = letter.moved(deform(cage_coordinates(letter, cage), posed.vertices))
    stages = {"Draw": [letter], "Cage": made.meshes, "Pose": [bent, posed]}
    for name, size, shown in (("icon", ICON, {"": made.meshes[:2]}), ("featured", FEATURED, stages)):
        figure, axes = plt.subplots(
            1, len(shown), figsize=np.divide(size, DPI), squeeze=False, sharex=True, sharey=True
        )
        if name == "icon":
            tile = FancyBboxPatch(
                (0.12, 0.12), 0.76, 0.76, "round,pad=0.12", color=BACK, transform=figure.transFigure, zorder=-1
            )
            figure.patches.append(tile)
        else:
            figure.set_facecolor(BACK)
            figure.text(0.5, 0.88, "Nested Cages", size=54, color=INK, ha="center", weight="bold")
        for axis, (title, (shape, *cages)) in zip(axes[0], shown.items(), strict=True):
            for ring, fill in zip(shape.rings, (INK, BACK), strict=True):
                axis.fill(*ring.T, color=fill)
            width = size[0] / len(shown) / LINES_ACROSS
            for mesh, colour in zip(cages, CAGES[-len(cages) :], strict=False):
                for ring in mesh.rings:
                    closed = np.concatenate((ring, ring[:1]))
                    axis.plot(*closed.T, color=colour, linewidth=width, marker="o", markersize=2.5 * width)
            axis.set_aspect("equal")
            axis.set_axis_off()
            axis.set_title(title, y=-0.1, size=34, color=INK)
        figure.subplots_adjust(0.03, *((0.08, 0.97, 0.92) if name == "icon" else (0.08, 0.97, 0.86)), 0.03)
        figure.savefig(folder / f"{name}.png", dpi=DPI, transparent=name == "icon")
        plt.close(figure)


def leaning(cage: Mesh) -> Mesh:
    """A cage of which each vertex is turned about the middle of the bottom, the higher the more."""
    left, low, right, high = cage.bounds
    foot = np.array([(left + right) / 2.0, low])
    turn = LEAN * (cage.vertices[:, 1] - low) / (high - low)
    x, y = (cage.vertices - foot).T
    return cage.moved(
        foot + np.stack((x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)), axis=1)
    )


def checksums(folder: Path) -> str:
    """SHA-256 of every file of a folder, as `sha256sum --check` reads them."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != "SHA256SUMS")
    return "".join(f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files)


if __name__ == "__main__":
    sys.exit(main())
