"""Large drawings: 10,000 vertices in 200 steps go into shape keys, and the file comes back as it was saved."""

from __future__ import annotations

import bpy
import numpy as np

from drawings import at_frame, circle, evaluated

FINE, CAGE, STEPS, FLOW_END, TIGHTENING = 10_000, 40, 200, 60, 180


def ring(count: int) -> np.ndarray:
    return np.column_stack([np.arange(count), np.roll(np.arange(count), -1)])


class Certificate:
    """What the output tells of a cage."""

    loops_kept, clearance, excess = True, 0.01, 0.1


class Report:
    """What the output tells of how a cage was made."""

    start, seconds, notes = "flow", {"flow": 1.0}, ()


def result(addon):
    """A drawing that shrinks and comes home inside a cage, as a computation would give it."""
    fine, cage = circle(FINE), circle(CAGE, 1.3)
    steps = np.arange(STEPS)
    shrink = 1.0 - 0.4 * np.sin(np.pi * np.minimum(steps, TIGHTENING) / TIGHTENING)
    shrink[TIGHTENING:] = 1.0
    grow = 1.0 + 0.1 * np.maximum(steps - FLOW_END, 0) / (STEPS - FLOW_END)
    level = addon.generation.generate.CageLevel(
        fine_edges=ring(FINE),
        cage_edges=ring(CAGE),
        fine_steps=(fine[None] * shrink[:, None, None]).astype(np.float32),
        cage_steps=(cage[None] * grow[:, None, None]).astype(np.float32),
        flow_end=FLOW_END,
        tightening=TIGHTENING,
        certificate=Certificate,
        report=Report,
    )
    frame = addon.scene.plane.Frame(np.eye(4), 0.0, 1.0, True)
    return addon.generation.generate.Result(addon.scene.convert.Drawing("Large", frame, (fine,)), (level,))


def test_a_large_drawing_is_written_saved_and_loaded(addon, tmp_path) -> None:
    made = result(addon)
    (level,) = made.levels
    timing = addon.animation.timeline.Timing(1, 2)
    (collection,), lost = addon.generation.output.write(bpy.context.scene, [made], timing)
    assert not lost
    end = collection["nested_cages_end"]
    assert end == 1 + 2 * (STEPS - 1)
    path = str(tmp_path / "large.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, compress=False)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    fine, cage = (bpy.data.objects[name] for name in ("Large Fine", "Large Cage 1"))
    moving = (level.fine_steps != level.fine_steps[-1]).any(axis=(1, 2)).sum()
    assert len(fine.data.shape_keys.key_blocks) == 1 + moving
    for step in (0, 1, 59, 60, 111, 179, 180, STEPS - 1):
        depsgraph = at_frame(1 + 2 * step)
        for obj, steps in ((fine, level.fine_steps), (cage, level.cage_steps)):
            np.testing.assert_allclose(evaluated(obj, depsgraph)[:, :2], steps[step], rtol=0.0, atol=1e-6)
    np.testing.assert_array_equal(evaluated(fine, at_frame(end))[:, :2], level.fine_steps[-1])
