"""Large drawings: 10,000 vertices in 200 steps go into shape keys, and the file comes back as it was saved."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from support.drawings import at_frame, circle, evaluated, facts

FINE, CAGE, STEPS, FLOW_END, TIGHTENING = 10_000, 40, 200, 60, 180


def result(addon, core):
    """A drawing that shrinks and comes home inside a cage, as a computation would give it."""
    fine, cage = core.Mesh.from_loops([circle(FINE)]), core.Mesh.from_loops([circle(CAGE, 1.3)])
    steps = np.arange(STEPS)
    shrink = 1.0 - 0.4 * np.sin(np.pi * np.minimum(steps, TIGHTENING) / TIGHTENING)
    shrink[TIGHTENING:] = 1.0
    grow = 1.0 + 0.1 * np.maximum(steps - FLOW_END, 0) / (STEPS - FLOW_END)
    moving, growing = fine.vertices * shrink[:, None, None], cage.vertices * grow[:, None, None]
    way = core.Reinflation(moving[FLOW_END : TIGHTENING + 1], growing[FLOW_END:], 0)
    report = core.NestingReport(True, True, 0.01, 0.01, 0.1, "flow", {}, {"flow": 1.0})
    flow = core.FlowResult(moving[: FLOW_END + 1], 0, "inside")
    level = core.Level(fine, cage, cage.moved(growing[-1]), flow, way, report)
    frame = addon.scene.plane.Frame(np.eye(4), 0.0, 1.0, True)
    drawing = addon.scene.convert.Drawing("Large", frame, (fine.vertices,))
    return addon.generation.generate.Result(drawing, (level,)), moving, growing


@pytest.mark.slow
def test_a_large_drawing_is_written_saved_and_loaded(addon, core, tmp_path) -> None:
    made, moving, growing = result(addon, core)
    timing = addon.animation.timeline.Timing(1, 2)
    (collection,), lost = addon.generation.output.write(bpy.context.scene, [made], timing)
    assert not lost
    end = facts(collection)["end"]
    assert end == 1 + 2 * (STEPS - 1)
    path = str(tmp_path / "large.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, compress=False)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    fine, cage = (bpy.data.objects[name] for name in ("Large Fine", "Large Cage 1"))
    count = (moving != moving[-1]).any(axis=(1, 2)).sum()
    assert len(fine.data.shape_keys.key_blocks) == 1 + count
    for step in (0, 1, 59, 60, 111, 179, 180, STEPS - 1):
        depsgraph = at_frame(1 + 2 * step)
        for obj, steps in ((fine, moving), (cage, growing)):
            np.testing.assert_allclose(evaluated(obj, depsgraph)[:, :2], steps[step], rtol=0.0, atol=1e-6)
    np.testing.assert_array_equal(evaluated(fine, at_frame(end))[:, :2], moving[-1].astype(np.float32))
