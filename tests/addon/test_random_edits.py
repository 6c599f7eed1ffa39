"""A short sequence of random edits of each kind: jobs and scenes, copies of sets, characters, puppets."""

from random import Random

import pytest

from support.animator import Animator, Puppeteer
from support.artist import Artist
from support.drawings import outlive
from support.flock import Flock

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


@pytest.mark.parametrize(("kind", "edits"), [(Flock, 10), (Animator, 4), (Puppeteer, 4)])
def test_a_flock_a_character_and_a_puppet_outlive_random_edits(kind, edits, tmp_path) -> None:
    pytest.importorskip("shapely")
    outlive(kind(Random(0), str(tmp_path / "scene")), edits, 0)
