"""Random edits of rigged drawings, of characters in one cage, and of puppets."""

from __future__ import annotations

from random import Random

import pytest

bpy = pytest.importorskip("bpy")

from support.animator import Animator, Puppeteer  # noqa: E402
from support.blender import empty_scene, extension  # noqa: E402, F401 - fixtures
from support.drawings import outlive  # noqa: E402
from support.rigger import Rigger  # noqa: E402

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("seed", [1, 2, *range(100, 140)])
def test_rigs_outlive_random_edits(seed, tmp_path) -> None:
    outlive(Rigger(Random(seed), str(tmp_path / "rig.blend")), 14 if seed < 100 else 60, seed)


@pytest.mark.parametrize("seed", [0, 1, 2, *range(100, 120)])
@pytest.mark.parametrize("kind", [Animator, Puppeteer])
def test_characters_and_puppets_outlive_random_edits(kind, seed, tmp_path) -> None:
    pytest.importorskip("shapely")
    outlive(kind(Random(seed), str(tmp_path / "character")), 10 if seed < 100 else 30, seed)
