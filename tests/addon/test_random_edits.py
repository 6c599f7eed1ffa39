"""A short sequence of random edits of each kind: jobs and scenes, copies of sets, rigs, characters, puppets."""

from __future__ import annotations

from random import Random

import pytest

from support.animator import Animator, Puppeteer
from support.artist import Artist
from support.drawings import outlive
from support.flock import Flock
from support.rigger import Rigger

pytestmark = pytest.mark.slow

CRASHED = 41
"""A sequence in which Verify Cages crashed Blender 5.0."""


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.usefixtures("hasty")
@pytest.mark.parametrize("seed", [0, CRASHED])
def test_a_scene_outlives_random_edits_between_and_during_jobs(extension, window, reports, tmp_path, seed) -> None:
    """Every tick does one step, so that a seed says what happens when."""
    Artist(seed, extension, window, tmp_path).live_through(16)
    reports.read()  # without a traceback


def test_a_flock_outlives_random_edits(tmp_path) -> None:
    outlive(Flock(tmp_path / "flock.blend", 0), 10, 0)


def test_a_rig_outlives_random_edits(tmp_path) -> None:
    outlive(Rigger(Random(0), str(tmp_path / "rig.blend")), 12, 0)


def test_a_character_outlives_random_edits(tmp_path) -> None:
    outlive(Animator(Random(0), str(tmp_path / "character")), 4, 0)


def test_a_puppet_outlives_random_edits(tmp_path) -> None:
    pytest.importorskip("shapely")
    outlive(Puppeteer(Random(0), str(tmp_path / "puppet")), 4, 0)
