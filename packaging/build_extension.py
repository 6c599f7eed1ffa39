"""Builds the extension's zips, one per platform, with the scipy wheels that Blender lacks, and validates them.

    python packaging/build_extension.py [--output dist]

Blender brings numpy but not scipy; its extension system installs wheels that a zip carries and picks those that match
its Python. Needs Blender as a Python module (``pip install bpy``) for Blender's own build and validate commands, and
pip for the wheels, which are never committed.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from manual_pages import write_pages

ROOT = Path(__file__).resolve().parents[1]

SHIPPED = ("__init__.py", "addon", "nestedcages_core", "LICENSE", "README.md", "CHANGELOG.md")
"""What goes into the zip beside the manifest and the wheels."""


@dataclass(frozen=True)
class Python:
    """A Python that some Blender brings, and the scipy for it."""

    version: str
    scipy: str


PYTHONS = (
    Python("3.11", "1.15.3"),  # Blender 4.2 to 5.0; works with their numpy 1.24 and 1.26
    Python("3.13", "1.17.1"),  # Blender 5.1 and 5.2
)

PLATFORMS = {
    "windows-x64": ("win_amd64",),
    "macos-arm64": ("macosx_12_0_arm64",),
    "macos-x64": ("macosx_10_14_x86_64", "macosx_10_13_x86_64"),
    "linux-x64": ("manylinux_2_27_x86_64", "manylinux_2_17_x86_64", "manylinux2014_x86_64"),
}
"""Blender's names of platforms, and the tags of wheels that fit them, newest first."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=ROOT / "dist", help="folder for the zips")
    options = parser.parse_args()
    work = ROOT / "build" / "extension"
    wheels = fetch_wheels(ROOT / "build" / "wheels")
    source = stage(work / "source", wheels)
    options.output.mkdir(parents=True, exist_ok=True)
    for old in options.output.glob("nested_cages-*.zip"):
        old.unlink()
    command = [sys.executable, str(blender_command())]
    subprocess.run(
        [*command, "build", "--split-platforms", f"--source-dir={source}", f"--output-dir={options.output}"], check=True
    )
    zips = sorted(options.output.glob("nested_cages-*.zip"))
    for path in zips:
        subprocess.run([*command, "validate", str(path)], check=True)
        print(f"{path}  {path.stat().st_size / 1e6:.0f} MB, valid")
    if len(zips) != len(PLATFORMS):
        print(f"Expected a zip for each of {len(PLATFORMS)} platforms, found {len(zips)}.", file=sys.stderr)
        return 1
    return 0


def fetch_wheels(folder: Path) -> list[Path]:
    """One scipy wheel per platform and Python, downloaded by pip where they are not there yet."""
    folder.mkdir(parents=True, exist_ok=True)
    wheels = []
    for python in PYTHONS:
        abi = "cp" + python.version.replace(".", "")
        for tags in PLATFORMS.values():
            pattern = f"scipy-{python.scipy}-{abi}-{abi}-*"
            found = next((w for w in sorted(folder.glob(pattern)) if any(tag in w.name for tag in tags)), None)
            if found is None:
                found = download(folder, python, abi, tags)
            wheels.append(found)
    return wheels


def download(folder: Path, python: Python, abi: str, tags: tuple[str, ...]) -> Path:
    """Download the wheel for one platform."""
    before = set(folder.glob("*.whl"))
    platforms = [argument for tag in tags for argument in ("--platform", tag)]
    subprocess.run(
        [
            *(sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"),
            *("--only-binary", ":all:", "--python-version", python.version, "--implementation", "cp", "--abi", abi),
            *platforms,
            *("--dest", str(folder), f"scipy=={python.scipy}"),
        ],
        check=True,
    )
    (wheel,) = set(folder.glob("*.whl")) - before
    return wheel


def stage(folder: Path, wheels: list[Path]) -> Path:
    """A copy of what is shipped, with the guide as pages, whose manifest names the wheels and platforms."""
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "wheels").mkdir(parents=True)
    for name in SHIPPED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, folder / name)
    write_pages(folder / "manual")
    for wheel in wheels:
        shutil.copy(wheel, folder / "wheels" / wheel.name)
    manifest = (ROOT / "blender_manifest.toml").read_text(encoding="utf-8")
    names = "".join(f'  "./wheels/{wheel.name}",\n' for wheel in wheels)
    platforms = ", ".join(f'"{platform}"' for platform in PLATFORMS)
    keys, table, tables = manifest.partition("\n[")
    listed = f"platforms = [{platforms}]\nwheels = [\n{names}]\n"
    (folder / "blender_manifest.toml").write_text(keys + listed + table + tables, encoding="utf-8")
    return folder


def blender_command() -> Path:
    """Blender's command for extensions, from the bpy module of this Python."""
    try:
        import bpy
    except ImportError as error:
        raise SystemExit(f"Building needs Blender as a Python module: pip install bpy ({error}).") from error
    scripts = Path(bpy.utils.resource_path("LOCAL")) / "scripts"
    return scripts / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"


if __name__ == "__main__":
    sys.exit(main())
