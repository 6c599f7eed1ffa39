"""What is shipped: the README for package indexes, the wheels in the zips, and the versions that must agree."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import re
import struct
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]
README = """# Title

![A picture](docs/a.png)

See [the guide](docs/guide.md#part), [below](#title) and [the web](https://example.org/a).
"""


@pytest.fixture
def setup_script() -> ModuleType:
    pytest.importorskip("setuptools")
    spec = importlib.util.spec_from_file_location("setup_script", ROOT / "setup.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_an_index_gets_absolute_links(setup_script: ModuleType) -> None:
    text = setup_script.for_an_index(README, "https://host/owner/name")
    assert "![A picture](https://host/owner/name/raw/main/docs/a.png)" in text
    assert "[the guide](https://host/owner/name/blob/main/docs/guide.md#part)" in text
    assert "[below](#title) and [the web](https://example.org/a)" in text
    assert setup_script.links(None) == {}
    assert setup_script.links("https://host/owner/name")["Issues"] == "https://host/owner/name/issues"


def test_without_a_repository_an_index_gets_no_dead_links(setup_script: ModuleType) -> None:
    text = setup_script.for_an_index(README, None)
    assert text == "# Title\n\nSee the guide, [below](#title) and [the web](https://example.org/a).\n"
    whole = setup_script.for_an_index((ROOT / "README.md").read_text(encoding="utf-8"), None)
    assert re.findall(r"\]\((?!https?:|#)[^)]*\)", whole) == []


@pytest.fixture
def build_extension(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "packaging"))
    return importlib.import_module("build_extension")


def test_the_zips_bring_the_packages_that_the_tests_ran_with(build_extension: ModuleType) -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for scipy, python in re.findall(r"(scipy==[\d.]+); python_version == '([\d.]+)'", "\n".join(extras["blender"])):
        bundle = next(bundle for bundle in build_extension.BUNDLES if bundle.python == python)
        assert scipy in bundle.packages
        assert f"SCIPY_{python} := {scipy.removeprefix('scipy==')}\n" in makefile
        assert set(bundle.platforms) >= {"windows-x64", "macos-arm64", "macos-x64", "linux-x64"}
    assert len(build_extension.BUNDLES) >= 2


def test_wheels_and_actions_are_pinned(build_extension: ModuleType, tmp_path: Path) -> None:
    names = [line.split()[1] for line in build_extension.HASHES.read_text(encoding="utf-8").splitlines()]
    for bundle in build_extension.BUNDLES:
        for package in bundle.packages:
            fits = [name for name in names if name.startswith(package.replace("==", "-"))]
            assert any(f"cp{bundle.python.replace('.', '')}-" in name or "py3-none-any" in name for name in fits), (
                package
            )
    (wrong := tmp_path / names[0]).write_bytes(b"")
    with pytest.raises(SystemExit, match="not the one in"):
        build_extension.check_hash(wrong)
    workflows = [path.read_text(encoding="utf-8") for path in (ROOT / ".github" / "workflows").glob("*.yml")]
    used = re.findall(r"uses: (\S+)", "\n".join(workflows))
    assert used
    assert [action for action in used if not re.fullmatch(r"[\w/-]+@[0-9a-f]{40}", action)] == []


@pytest.mark.slow
def test_a_staged_extension_names_its_wheels(
    build_extension: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked = []

    def pretend(folder: Path, python: str, tags: tuple[str, ...], package: str) -> Path:
        name, _, version = package.partition("==")
        folder.mkdir(parents=True, exist_ok=True)
        abi = "cp" + python.replace(".", "")
        path = folder / f"{name}-{version}-{abi}-{abi}-{tags[0]}.whl"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("p/tests/b.py", "1")
            archive.writestr("p.dist-info/METADATA", f"Name: {name}\nVersion: {version}\nLicense-Expression: MIT\n")
            archive.writestr("p.dist-info/LICENSE.txt", "Name: GEOS\nFiles: a.so\nLicense: LGPL-2.1\n")
        asked.append((python, tags, package))
        return path

    monkeypatch.setattr(build_extension, "wheel", pretend)
    monkeypatch.setenv("REPOSITORY_URL", "https://host/owner/name/")
    reached = "4.2.0"
    taken: set[tuple[str, str]] = set()
    for bundle in build_extension.BUNDLES[:2]:
        asked.clear()
        wheels = build_extension.fetch_wheels(tmp_path / "wheels", bundle)
        assert len(wheels) == len(asked) == len(bundle.packages) * len(bundle.platforms)
        source = build_extension.stage(tmp_path / "source", bundle, wheels)
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
        told = (source / "licences.txt").read_text(encoding="utf-8").splitlines()
        assert told[-2:] == [f"{bundle.packages[-1].replace('==', ' ')}: MIT", "  in it GEOS: LGPL-2.1"]
        assert (source / "manual" / "docs" / "guide" / "README.html").is_file()
        assert not (source / "tests").exists()
    assert reached is None  # every Blender has a zip


@pytest.mark.slow
def test_the_zip_has_what_the_addon_needs_and_no_more(build_extension: ModuleType, tmp_path: Path) -> None:
    pytest.importorskip("bpy")
    path = tmp_path / "extension.zip"
    blender = [sys.executable, str(build_extension.blender_command())]
    build = ["build", f"--source-dir={ROOT}", f"--output-filepath={path}"]
    subprocess.run([*blender, *build], check=True, capture_output=True, timeout=60)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path / "nested_cages")
    core = tmp_path / "nested_cages" / "nestedcages_core"
    rooms = {entry.name for entry in (ROOT / "nestedcages_core").iterdir()} - {"__pycache__"}
    left_out = {"__main__.py", "batch", "command", "checker.py", "checker_distance.py"}
    assert rooms - {entry.name for entry in core.iterdir()} == left_out
    assert {entry.name for entry in core.parent.iterdir()} == {
        "__init__.py", "addon", "blender_manifest.toml", "LICENSE", "nestedcages_core"
    }  # fmt: skip
    processes = {"asyncio", "subprocess", "multiprocessing", "concurrent", "socket", "urllib"}
    for path in core.parent.rglob("*.py"):
        nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
        imported = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
        imported |= {node.module or "" for node in nodes if isinstance(node, ast.ImportFrom) and not node.level}
        threads = [
            node for node in nodes if isinstance(node, ast.Attribute | ast.Name) and "Thread" in ast.unparse(node)
        ]
        assert not threads, path.name
        called = {node.func.id for node in nodes if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
        assert not processes & {name.partition(".")[0] for name in imported}, path.name
        assert not {"eval", "exec", "__import__"} & called, path.name
    assert [path.name for path in core.parent.rglob("*.blend") if not Path(f"{path}.license").is_file()] == []
    cage = "import nestedcages_core as core; print(core.nested_cages([(0, 0), (2, 0), (2, 2), (1, 3), (0, 2)], 4)[0])"
    made = subprocess.run(
        [sys.executable, "-c", cage], cwd=core.parent, check=True, capture_output=True, text=True, timeout=60
    )
    assert made.stdout.startswith("Level(4 vertices")


TAGS = (
    "3D View, Add Curve, Add Mesh, Animation, Bake, Camera, Compositing, Development, Game Engine, Geometry Nodes, "
    "Grease Pencil, Import-Export, Lighting, Material, Modeling, Mesh, Node, Object, Paint, Pipeline, Physics, Render, "
    "Rigging, Scene, Sculpt, Sequencer, System, Text Editor, Tracking, User Interface, UV"
)
"""Tags that extensions.blender.org has for add-ons."""


def test_the_manifest_keeps_the_rules_of_the_extensions_site() -> None:
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    for sentence in (manifest["tagline"], *manifest["permissions"].values()):
        assert len(sentence) <= 64, sentence
        assert sentence[-1].isalnum(), sentence
    assert set(manifest["tags"]) <= set(TAGS.split(", "))
    assert "blender" not in manifest["name"].lower()
    assert all(re.fullmatch(r"\d{4}(-\d{4})? \S.*", holder) for holder in manifest["copyright"])
    holders = " ".join(manifest["copyright"])
    for bundled in ("SciPy", "OpenBLAS", "LAPACK", "libgfortran", "Shapely", "GEOS", "tinycss2", "cssselect2"):
        assert bundled in holders, bundled
    assert "network" not in manifest["permissions"]


@pytest.mark.slow
def test_the_listing_says_what_is_bundled_and_has_pictures_of_the_right_size(
    build_extension: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("matplotlib")
    import release

    def wheel(name: str, licence: str) -> Path:
        path = tmp_path / f"{name}-1.0-py3-none-any.whl"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr(f"{name}-1.0.dist-info/METADATA", f"Name: {name}\nVersion: 1.0\n{licence}\n\ntext")
        return path

    old = wheel("old", "Classifier: License :: OSI Approved :: BSD License")
    wheels = [wheel("new", "License-Expression: BSD-3-Clause"), old, old]
    assert release.licences(wheels) == ["new 1.0: BSD-3-Clause", "old 1.0: BSD License"]
    with pytest.raises(SystemExit, match=r"none-1\.0-py3-none-any\.whl does not say its licence"):
        release.licences([wheel("none", "Summary: x")])
    release.listing(tmp_path / "listing", wheels)
    for name, size in (("icon", (256, 256)), ("featured", (1920, 1080))):
        head = (tmp_path / "listing" / f"{name}.png").read_bytes()[16:24]
        assert struct.unpack(">II", head) == size
    described = (tmp_path / "listing" / "description.md").read_text(encoding="utf-8")
    for bundle in build_extension.BUNDLES:
        assert all(package.partition("==")[0] in described for package in bundle.packages)
    assert "  icon.png\n" in release.checksums(tmp_path / "listing")


def test_every_picture_of_the_gallery_is_made_again_by_one_command(build_extension: ModuleType) -> None:
    import pictures

    shown = {path.stem for path in (*(ROOT / "docs" / "gallery").iterdir(), *(ROOT / "docs").glob("*.gif"))}
    assert shown - {Path(name).stem for _, name in pictures.CLIPS.values()} <= set(pictures.examples())
    assert all((ROOT / "docs" / name).is_file() for _, name in pictures.CLIPS.values())


def test_the_workflows_name_what_is_there_run_the_least_blender_and_build_the_docs() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    least = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))["blender_version_min"]
    assert re.search(rf"^BLENDERS_3\.11 .*\b{re.escape(least)}\b", makefile, re.MULTILINE)
    oldest, made = f"test-blender-3.11-{least}", set()
    for path in (ROOT / ".github" / "workflows").glob("*.yml"):
        text = path.read_text(encoding="utf-8")
        made |= set(re.findall(r"run: make (\S+)", text))
        for name in re.findall(r"(?:packaging|examples|tests)/[\w/.]+", text):
            assert (ROOT / name).exists(), name
    assert {oldest, "docs"} <= made <= {oldest, *re.findall(r"^([a-z-]+):", makefile, re.MULTILINE)}
