"""Builds the extension's zips, one per platform and Python, with the wheels that Blender lacks, and validates them.

    python packaging/build_extension.py [--output dist]

Blender brings numpy, but not scipy and the libraries of file formats. A Blender has one Python, so a zip has wheels for
one. With REPOSITORY_URL, such as https://host/owner/name, the manifest names it as the website. Needs Blender as a
Python module (``pip install bpy``) for Blender's own build and validate commands, pip for the wheels, which are never
committed, and markdown-it-py for the manual.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from licences import licences
from manual_pages import write_pages

ROOT = Path(__file__).resolve().parents[1]

SHIPPED = ("__init__.py", "addon", "nestedcages_core", "LICENSE")
"""What goes into the zip beside the manifest and the wheels."""


PLATFORMS = {
    "windows-x64": ("win_amd64",),
    "windows-arm64": ("win_arm64",),
    "macos-arm64": ("macosx_12_0_arm64", "macosx_11_0_arm64"),
    "macos-x64": ("macosx_10_14_x86_64", "macosx_10_13_x86_64", "macosx_10_10_x86_64", "macosx_10_9_x86_64"),
    "linux-x64": ("manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux_2_17_x86_64", "manylinux2014_x86_64"),
}
"""Blender's names of platforms, and the tags of wheels that fit them, newest first."""

X64_AND_MAC = tuple(platform for platform in PLATFORMS if platform != "windows-arm64")
"""Those with wheels for Python 3.11."""

MAX_ZIP = 56_000_000
"""Largest size of a zip in bytes: a download that users wait for."""


@dataclass(frozen=True)
class Bundle:
    """The packages, as `package==version`, for one Python of some Blenders: from the first to before the second one."""

    name: str
    python: str
    blenders: tuple[str, str | None]
    packages: tuple[str, ...]
    platforms: tuple[str, ...]


STYLE_SHEETS = ("tinycss2==1.5.1", "cssselect2==0.10.1", "webencodings==0.6.1")
"""Packages of Python alone that drawings with style sheets need."""

LAYERS = ("psd-tools==1.26.0", "attrs==26.1.0", "pillow==13.0.0")
"""What layered paintings need."""

NEWER = ("scipy==1.17.1", "shapely==2.2.0", *STYLE_SHEETS, *LAYERS)
"""From Python 3.13 on."""

OLDER = ("scipy==1.15.3", "shapely==2.1.2", *STYLE_SHEETS, *LAYERS)
"""That work with the numpy of Blender before 5.1, 1.24 and 1.26."""

BUNDLES = (
    Bundle("blender4.2", "3.11", ("4.2.0", "5.1.0"), OLDER, X64_AND_MAC),
    Bundle("blender5.1", "3.13", ("5.1.0", None), NEWER, tuple(PLATFORMS)),
    # as Linux distributions build Blender, with their own Python
    Bundle("python3.13", "3.13", ("4.2.0", "5.1.0"), NEWER, ("linux-x64",)),
    Bundle("python3.14", "3.14", ("5.1.0", None), NEWER, ("linux-x64",)),
)

HASHES = Path(__file__).with_name("wheels.sha256")
"""SHA-256 and name of every wheel of the bundles, as `sha256sum --check` reads them."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=ROOT / "dist", help="folder for the zips")
    parser.add_argument("--renew-hashes", action="store_true", help="write the SHA-256 of the wheels, and nothing else")
    options = parser.parse_args()
    if options.renew_hashes:
        renew_hashes()
        return 0
    work = ROOT / "build" / "extension"
    options.output.mkdir(parents=True, exist_ok=True)
    for old in options.output.glob("nested_cages-*.zip"):
        old.unlink()
    command = [sys.executable, str(blender_command())]
    for bundle in BUNDLES:
        source, made = stage(work / bundle.name, bundle, fetch_wheels(ROOT / "build" / "wheels", bundle)), work / "made"
        shutil.rmtree(made, ignore_errors=True)
        made.mkdir()
        build = ["build", "--split-platforms", f"--source-dir={source}", f"--output-dir={made}"]
        subprocess.run([*command, *build], check=True)
        zips = sorted(made.glob("*.zip"))
        if len(zips) != len(bundle.platforms):
            raise SystemExit(f"Expected a zip for each of {', '.join(bundle.platforms)}, found {len(zips)}.")
        for path in zips:
            subprocess.run([*command, "validate", str(path)], check=True)
            size = path.stat().st_size
            print(f"{path.name}, {bundle.name}: {size / 1e6:.0f} MB, valid")
            if size > MAX_ZIP:
                raise SystemExit(f"{path.name} for {bundle.name} has {size:,} bytes, more than {MAX_ZIP:,}.")
            path.rename(options.output / path.name)
    return 0


def fetch_wheels(folder: Path, bundle: Bundle) -> list[Path]:
    """The wheels of a bundle, downloaded by pip where they are not there yet; one that fits any platform once."""
    found = [
        wheel(folder / bundle.python / platform, bundle.python, PLATFORMS[platform], package)
        for platform in bundle.platforms
        for package in bundle.packages
    ]
    return list({path.name: path for path in found}.values())


def wheel(folder: Path, python: str, tags: tuple[str, ...], package: str) -> Path:
    """The wheel of a package, `name==version`, in `folder`. Raises SystemExit if there is none for these tags."""
    name, _, version = package.partition("==")
    pattern = f"{name.replace('-', '_')}-{version}-*.whl"
    if not any(folder.glob(pattern)):
        platforms = [argument for tag in tags for argument in ("--platform", tag)]
        download = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        only = ["--only-binary", ":all:", "--python-version", python, "--implementation", "cp"]
        if subprocess.run([*download, *only, *platforms, "--dest", str(folder), package], check=False).returncode:
            raise SystemExit(f"There is no wheel of {package} for Python {python} and any of {', '.join(tags)}.")
    (found,) = folder.glob(pattern)
    check_hash(found)
    return found


def check_hash(path: Path) -> None:
    """Raise SystemExit if a wheel is not the one whose SHA-256 is on record."""
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    known = dict(line.split()[::-1] for line in HASHES.read_text(encoding="utf-8").splitlines())
    if known.get(path.name) != digest:
        raise SystemExit(
            f"{path} has the SHA-256 {digest}, not the one in {HASHES.name}; remove it, or run build_extension.py "
            "--renew-hashes if a bundle has changed."
        )


def renew_hashes() -> None:
    """Write the SHA-256 that the package index gives for every wheel; nothing is downloaded where it gives metadata."""
    found: dict[str, str] = {}
    for bundle in BUNDLES:
        for platform in bundle.platforms:
            tags = [argument for tag in PLATFORMS[platform] for argument in ("--platform", tag)]
            look = [sys.executable, "-m", "pip", "install", "--quiet", "--dry-run", "--ignore-installed", "--no-deps"]
            only = ["--only-binary", ":all:", "--python-version", bundle.python, "--implementation", "cp"]
            command = [*look, *only, *tags, "--target", str(ROOT / "build"), "--report", "-", *bundle.packages]
            report = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
            for each in report["install"]:
                info = each["download_info"]
                found[info["url"].rpartition("/")[2]] = info["archive_info"]["hashes"]["sha256"]
    HASHES.write_text("".join(f"{found[name]}  {name}\n" for name in sorted(found)), encoding="utf-8", newline="\n")


def stage(folder: Path, bundle: Bundle, wheels: list[Path]) -> Path:
    """A copy of what is shipped, with the guide as pages, whose manifest names Blenders, wheels and platforms.

    extensions.blender.org takes one zip per version and platform, so the version of each bundle carries its name.
    """
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "wheels").mkdir(parents=True)
    for name in SHIPPED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, folder / name)
    write_pages(folder / "manual")
    for path in wheels:
        shutil.copy(path, folder / "wheels")
    (folder / "licences.txt").write_text("\n".join(licences(wheels)) + "\n", encoding="utf-8")
    manifest = (ROOT / "blender_manifest.toml").read_text(encoding="utf-8")
    names = "".join(f'  "./wheels/{path.name}",\n' for path in wheels)
    platforms = ", ".join(f'"{platform}"' for platform in bundle.platforms)
    keys, table, tables = manifest.partition("\n[")
    first, before = bundle.blenders
    keys = re.sub(r'(?m)^(blender_version_min = )".*"$', rf'\1"{first}"', keys)
    keys = re.sub(r'(?m)^(version = ".*)"$', rf'\1+{bundle.name}"', keys)
    listed = f"platforms = [{platforms}]\nwheels = [\n{names}]\n"
    if before is not None:
        listed += f'blender_version_max = "{before}"\n'
    if website := os.environ.get("REPOSITORY_URL", "").rstrip("/"):
        listed += f'website = "{website}"\n'
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
