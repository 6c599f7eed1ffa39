"""The job's slices, and cancelling it at every stage."""

from __future__ import annotations

import bpy
import pytest

from drawings import poly_curve, snapshot, star


def job(addon):
    drawing = addon.convert.fine_drawing(addon.convert.read(bpy.context, poly_curve("Drawing", [star()])))
    options = addon.generate.Options(levels=(20, 10))
    return addon.job.Job(addon.generate.Generation([addon.generate.Request(drawing)], options))


def test_slices_reach_the_same_end_as_one_go(addon) -> None:
    slow, fast = job(addon), job(addon)
    slices = 1
    while not slow.advance(0.0):
        slices += 1
    fast.drain()
    assert slices > 8
    for one, other in zip(slow.generation.results[0].levels, fast.generation.results[0].levels, strict=True):
        assert (one.cage == other.cage).all()


def test_the_running_job_is_known_while_it_runs(addon) -> None:
    assert addon.job.running() is None
    work = job(addon)
    work.start()
    assert addon.job.running() is work
    work.stop()
    assert addon.job.running() is None
    assert work.advance()


def test_while_a_job_runs_there_is_no_second_one(addon) -> None:
    work = job(addon)
    work.start()
    try:
        assert not bpy.ops.object.nested_cages_generate.poll()
        assert bpy.ops.object.nested_cages_cancel.poll()
        bpy.ops.object.nested_cages_cancel()
        assert work.cancelled
    finally:
        work.stop()
    assert not bpy.ops.object.nested_cages_cancel.poll()


@pytest.mark.parametrize("slices", [0, 1, 3, 6, 10, 15])
def test_a_job_that_is_dropped_leaves_the_scene(addon, slices) -> None:
    work = job(addon)
    bpy.context.view_layer.update()
    before = snapshot()
    work.start()
    for _ in range(slices):
        work.advance(0.0)
    work.stop()
    assert snapshot() == before
