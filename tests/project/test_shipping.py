"""What is shipped: the README for package indexes, the wheels in the zips, and the versions that must agree."""

import ast
import importlib
import re
import runpy
import struct
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

import nestedcages_core
from support.sources import ROOT

README = """# Title

![A picture](docs/a.png)

See [the guide](docs/guide.md#part), [below](#title) and [the web](https://example.org/a).
"""
MANIFEST = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
TAGS = (
    "3D View, Add Curve, Add Mesh, Animation, Bake, Camera, Compositing, Development, Game Engine, Geometry Nodes, "
    "Grease Pencil, Import-Export, Lighting, Material, Modeling, Mesh, Node, Object, Paint, Pipeline, Physics, Render, "
    "Rigging, Scene, Sculpt, Sequencer, System, Text Editor, Tracking, User Interface, UV"
)
"""Tags that extensions.blender.org has for add-ons."""


@pytest.fixture
def build(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "packaging"))
    return importlib.import_module("build_extension")


def test_an_index_gets_absolute_links_or_none() -> None:
    pytest.importorskip("setuptools")
    script = runpy.run_path(str(ROOT / "setup.py"))
    text = script["for_an_index"](README, "https://host/owner/name")
    assert "![A picture](https://host/owner/name/raw/main/docs/a.png)" in text
    assert "[the guide](https://host/owner/name/blob/main/docs/guide.md#part)" in text
    assert "[below](#title) and [the web](https://example.org/a)" in text
    assert script["links"]("https://host/owner/name")["Issues"] == "https://host/owner/name/issues"
    assert script["links"](None) == {}
    text = script["for_an_index"](README, None)
    assert text == "# Title\n\nSee the guide, [below](#title) and [the web](https://example.org/a).\n"
    whole = script["for_an_index"]((ROOT / "README.md").read_text(encoding="utf-8"), None)
    assert re.findall(r"\]\((?!https?:|#)[^)]*\)", whole) == []


def test_project_extension_and_citation_have_one_version() -> None:
    cited = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert MANIFEST["version"] == nestedcages_core.__version__
    assert MANIFEST["license"] == [f"SPDX:{PROJECT['project']['license']}"]
    assert f"version: {nestedcages_core.__version__}\n" in cited and "license: GPL-3.0-or-later\n" in cited


def test_the_zips_bring_the_packages_that_the_tests_ran_with(build: ModuleType) -> None:
    extras = PROJECT["project"]["optional-dependencies"]
    for scipy, python in re.findall(r"(scipy==[\d.]+); python_version == '([\d.]+)'", "\n".join(extras["blender"])):
        bundle = next(bundle for bundle in build.BUNDLES if bundle.python == python)
        assert scipy in bundle.packages
        assert f"SCIPY_{python} := {scipy.removeprefix('scipy==')}\n" in MAKEFILE
        assert set(bundle.platforms) >= {"windows-x64", "macos-arm64", "macos-x64", "linux-x64"}


def test_wheels_and_actions_are_pinned(build: ModuleType, tmp_path: Path) -> None:
    names = [line.split()[1] for line in build.HASHES.read_text(encoding="utf-8").splitlines()]
    for bundle in build.BUNDLES:
        tags = f"cp{bundle.python.replace('.', '')}-", "py3-none-any", "abi3"
        for package in bundle.packages:
            fits = [name for name in names if name.startswith(package.replace("-", "_").replace("==", "-"))]
            assert any(tag in name for name in fits for tag in tags), package
    (wrong := tmp_path / names[0]).write_bytes(b"")
    with pytest.raises(SystemExit):
        build.check_hash(wrong)
    workflows = [path.read_text(encoding="utf-8") for path in (ROOT / ".github" / "workflows").glob("*.yml")]
    used = re.findall(r"uses: (\S+)", "\n".join(workflows))
    assert used and [action for action in used if not re.fullmatch(r"[\w/-]+@[0-9a-f]{40}", action)] == []


def wheel(folder: Path, package: str, tag: str = "py3-none-any", licence: str = "License-Expression: MIT") -> Path:
    """A wheel with nothing but its texts."""
    name, _, version = package.partition("==")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}-{version}-{tag}.whl"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(f"{name}.dist-info/METADATA", f"Name: {name}\nVersion: {version}\n{licence}\n\ntext")
        archive.writestr(f"{name}.dist-info/LICENSE.txt", "Name: GEOS\nFiles: a.so\nLicense: LGPL-2.1\n")
    return path


@pytest.mark.slow
def test_staged_extensions_name_their_wheels_and_share_no_blender(build: ModuleType, monkeypatch, tmp_path) -> None:
    def pretend(folder: Path, python: str, tags: tuple[str, ...], package: str) -> Path:
        return wheel(folder, package, f"cp{python.replace('.', '')}-none-{tags[0]}")

    monkeypatch.setattr(build, "wheel", pretend)
    monkeypatch.setenv("REPOSITORY_URL", "https://host/owner/name/")
    reached, taken = "4.2.0", set()
    for bundle in build.BUNDLES[:2]:
        wheels = build.fetch_wheels(tmp_path / "wheels", bundle)
        source = build.stage(tmp_path / "source", bundle, wheels)
        manifest = tomllib.loads((source / "blender_manifest.toml").read_text(encoding="utf-8"))
        assert manifest["website"] == "https://host/owner/name"
        assert manifest["blender_version_min"] == reached
        reached = manifest.get("blender_version_max")
        assert tuple(manifest["platforms"]) == bundle.platforms
        assert {Path(name).name for name in manifest["wheels"]} == {path.name for path in wheels}
        for path in wheels:  # Blender's manual: wheels must be bundled unmodified
            assert (source / "wheels" / path.name).read_bytes() == path.read_bytes()
        zips = {(manifest["version"], platform) for platform in bundle.platforms}
        assert not taken & zips, "extensions.blender.org takes one zip per version and platform"
        taken |= zips
        licences = (source / "licences.txt").read_text(encoding="utf-8").splitlines()
        packages = sorted(f"{package.replace('==', ' ')}: MIT" for package in bundle.packages)
        assert licences == [line for package in packages for line in (package, "  in it GEOS: LGPL-2.1")]
        assert (source / "manual" / "docs" / "guide" / "README.html").is_file()
        assert not (source / "tests").exists()
    assert reached is None  # every Blender has a zip


@pytest.mark.slow
def test_the_zip_has_what_the_addon_needs_and_no_more(build: ModuleType, tmp_path: Path) -> None:
    pytest.importorskip("bpy")
    path = tmp_path / "extension.zip"
    command = [sys.executable, str(build.blender_command()), "build", f"--source-dir={ROOT}"]
    subprocess.run([*command, f"--output-filepath={path}"], check=True, capture_output=True, timeout=60)
    whole = tmp_path / "nested_cages"
    with zipfile.ZipFile(path) as archive:
        archive.extractall(whole)
    assert {entry.name for entry in whole.iterdir()} == {
        "__init__.py", "addon", "blender_manifest.toml", "LICENSE", "nestedcages_core"
    }  # fmt: skip
    missing = {entry.name for entry in (ROOT / "nestedcages_core").iterdir()} - {"__pycache__"}
    missing -= {entry.name for entry in (whole / "nestedcages_core").iterdir()}
    assert missing == {"__main__.py", "batch", "command", "checker.py", "checker_distance.py"}
    assert not (whole / "addon" / "__main__.py").exists()
    processes = {"asyncio", "subprocess", "multiprocessing", "concurrent", "socket", "urllib", "threading"}
    for path in whole.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) and not node.level else []
            used = processes & {name.partition(".")[0] for name in names}
            assert path.name in ("memory.py", "run.py") or not used, path.name
    assert [path.name for path in whole.rglob("*.blend") if not Path(f"{path}.license").is_file()] == []
    cage = "import nestedcages_core as core; print(core.nested_cages([(0, 0), (2, 0), (2, 2), (1, 3), (0, 2)], 4)[0])"
    made = subprocess.run(
        [sys.executable, "-c", cage], cwd=whole, check=True, capture_output=True, text=True, timeout=60
    )
    assert made.stdout.startswith("Level(4 vertices")


def test_the_manifest_keeps_the_rules_of_the_extensions_site() -> None:
    for sentence in (MANIFEST["tagline"], *MANIFEST["permissions"].values()):
        assert len(sentence) <= 64 and sentence[-1].isalnum(), sentence
    assert set(MANIFEST["tags"]) <= set(TAGS.split(", "))
    assert "blender" not in MANIFEST["name"].lower()
    assert "network" not in MANIFEST["permissions"]
    holders = MANIFEST["copyright"]
    assert all(re.fullmatch(r"\d{4}(-\d{4})? \S.*", holder) for holder in holders)
    for bundled in (
        "SciPy",
        "OpenBLAS",
        "LAPACK",
        "libgfortran",
        "Shapely",
        "GEOS",
        "tinycss2",
        "cssselect2",
        "psd-tools",
        "attrs",
        "Pillow",
    ):
        assert bundled in " ".join(holders), bundled


@pytest.mark.check
def test_the_listing_names_what_is_bundled_and_has_pictures_of_the_right_size(
    build: ModuleType, tmp_path: Path
) -> None:
    pytest.importorskip("matplotlib")
    import release

    old = wheel(tmp_path, "old==1.0", licence="Classifier: License :: OSI Approved :: BSD License")
    new = wheel(tmp_path, "new==1.0", licence="License-Expression: BSD-3-Clause")
    assert release.licences([new, old, old])[::2] == ["new 1.0: BSD-3-Clause", "old 1.0: BSD License"]
    with pytest.raises(SystemExit):
        release.licences([wheel(tmp_path, "none==1.0", licence="Summary: x")])
    release.listing(tmp_path / "listing", [new, old])
    for name, size in (("icon", (256, 256)), ("featured", (1920, 1080))):
        head = (tmp_path / "listing" / f"{name}.png").read_bytes()[16:24]
        assert struct.unpack(">II", head) == size
    described = (tmp_path / "listing" / "description.md").read_text(encoding="utf-8")
    for bundle in build.BUNDLES:
        assert all(package.partition("==")[0] in described for package in bundle.packages)
    assert "  icon.png\n" in release.checksums(tmp_path / "listing")


def test_the_workflows_name_what_is_there_run_the_least_blender_and_build_the_docs() -> None:
    least = MANIFEST["blender_version_min"]
    assert re.search(rf"^BLENDERS_3\.11 .*\b{re.escape(least)}\b", MAKEFILE, re.MULTILINE)
    oldest, made = f"test-blender-3.11-{least}", set()
    for path in (ROOT / ".github" / "workflows").glob("*.yml"):
        text = path.read_text(encoding="utf-8")
        made |= set(re.findall(r"run: make (\S+)", text))
        assert [
            name for name in re.findall(r"(?:packaging|examples|tests)/[\w/.]+", text) if not (ROOT / name).exists()
        ] == []
    assert {oldest, "docs"} <= made <= {oldest, *re.findall(r"^([a-z-]+):", MAKEFILE, re.MULTILINE)}
