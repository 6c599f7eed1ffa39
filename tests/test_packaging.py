"""What is shipped: the README for package indexes, the wheels in the zips, and the versions that must agree."""

from __future__ import annotations

import importlib
import importlib.util
import re
import tomllib
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
        assert set(bundle.platforms) == set(build_extension.PLATFORMS)
    assert len(build_extension.BUNDLES) >= 2


def test_a_staged_extension_names_its_wheels(
    build_extension: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked = []

    def pretend(folder: Path, python: str, tags: tuple[str, ...], package: str) -> Path:
        name, _, version = package.partition("==")
        folder.mkdir(parents=True, exist_ok=True)
        abi = "cp" + python.replace(".", "")
        path = folder / f"{name}-{version}-{abi}-{abi}-{tags[0]}.whl"
        path.write_bytes(b"")
        asked.append((python, tags, package))
        return path

    monkeypatch.setattr(build_extension, "wheel", pretend)
    wheels = build_extension.fetch_wheels(tmp_path / "wheels")
    assert len(wheels) == len(asked) == sum(len(b.packages) * len(b.platforms) for b in build_extension.BUNDLES)
    source = build_extension.stage(tmp_path / "source", wheels)
    manifest = tomllib.loads((source / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert set(manifest["platforms"]) == set(build_extension.PLATFORMS)
    assert {Path(name).name for name in manifest["wheels"]} == {path.name for path in wheels}
    assert all((source / name).is_file() for name in manifest["wheels"])
    assert (source / "manual" / "docs" / "guide" / "README.html").is_file()
    assert not (source / "tests").exists()


def test_the_workflows_name_files_and_commands_that_are_there() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE))
    for path in (ROOT / ".github" / "workflows").glob("*.yml"):
        text = path.read_text(encoding="utf-8")
        assert set(re.findall(r"run: make ([a-z-]+)", text)) <= targets
        for name in re.findall(r"(?:packaging|examples|tests)/[\w/.]+", text):
            assert (ROOT / name).exists(), name
