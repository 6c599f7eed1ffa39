"""Time to generate cages for many drawings in Blender again, everything remembered, to show, bind and unbind them, and
to ask all operators whether they can be used, with one drawing selected and many plain objects in the scene.

    python benchmarks/many_drawings.py --drawings 50 100 200 --objects 5000

Needs Blender as a Python module (bpy). CPU seconds; the longest step is one that Escape has to wait for.
"""

from __future__ import annotations

import argparse
import atexit
import time
from collections.abc import Callable
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np

from binding import PACKAGE, extension

VERTICES, LEVELS, PER_ROW, REDRAWS = 24, "12, 6", 20, 10


def draw(count: int) -> None:
    """Selected closed curves in rows, all different, in an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    turns = np.linspace(0.0, 2.0 * np.pi, VERTICES, endpoint=False)
    for number in range(count):
        radius = np.where(np.arange(VERTICES) % 2, 0.5, 1.0) * (1.0 + 0.2 * np.sin(number + np.arange(VERTICES)))
        data = bpy.data.curves.new(f"Drawing {number}", "CURVE")
        spline = data.splines.new("POLY")
        spline.points.add(VERTICES - 1)
        flat = [radius * np.cos(turns), radius * np.sin(turns), np.zeros(VERTICES), np.ones(VERTICES)]
        spline.points.foreach_set("co", np.column_stack(flat).ravel())
        spline.use_cyclic_u = True
        made = bpy.data.objects.new(data.name, data)
        made.location = (3.0 * (number % PER_ROW), 3.0 * (number // PER_ROW), 0.0)
        bpy.context.scene.collection.objects.link(made)
        made.select_set(True)
        bpy.context.view_layer.objects.active = made


def seconds(work: Callable[[], Any]) -> float:
    """CPU seconds of a call."""
    before = time.process_time()
    work()
    return time.process_time() - before


def polls(base: Any) -> float:
    """CPU seconds to ask all operators once."""
    found, operators = [base.Operator], []
    while found:
        found += (kind := found.pop()).__subclasses__()
        operators += [kind] if "_OT_" in kind.__name__ else []
    return min(seconds(lambda: [each.poll(bpy.context) for each in operators]) for _ in range(REDRAWS))


def measure(base: Any, overlay: Any, count: int, objects: int) -> str:
    """A row of the table."""
    draw(count)
    for _ in range(objects):
        bpy.context.scene.collection.objects.link(bpy.data.objects.new("Plain", None))
    steps: list[float] = []

    def stepped(work: Any) -> None:
        ended = False
        while not ended:
            before = time.process_time()
            ended = next(work, None) is None
            steps.append(time.process_time() - before)

    plain, base.tasks = base.tasks, SimpleNamespace(drain=stepped)
    drawings = list(bpy.context.selected_objects)
    totals = []
    try:
        for _ in range(3):
            steps.clear()
            for drawing in drawings:
                drawing.select_set(True)
            bpy.ops.object.nested_cages_generate(levels=LEVELS)
            totals.append(sum(steps))
    finally:
        base.tasks = plain
    scene = bpy.context.scene
    actions, markers = len(bpy.data.actions), len(scene.timeline_markers)
    change = np.median([seconds(lambda at=frame: scene.frame_set(at)) for frame in range(2, 2 + REDRAWS)])
    redraw = np.median([seconds(lambda: list(overlay.looks(bpy.context))) for _ in range(REDRAWS)])
    bpy.context.view_layer.objects.active = drawings[0]
    for drawing in drawings:
        drawing.select_set(drawing == drawings[0])
    asked = polls(base)
    for drawing in drawings:
        drawing.select_set(True)
    bind = seconds(bpy.ops.object.nested_cages_bind)
    for drawing in drawings:
        drawing.select_set(True)
    unbind = seconds(bpy.ops.object.nested_cages_unbind)
    return (
        f"{count:8d} {totals[0]:8.2f} {min(totals[1:]):8.2f} {max(steps):8.3f} {actions:8d} {markers:8d} "
        f"{1e3 * change:9.1f} {1e3 * redraw:9.1f} "
        f"{1e3 * asked:8.2f} {bind:7.2f} {unbind:8.2f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drawings", type=int, nargs="+", default=[50, 100, 200])
    parser.add_argument("--objects", type=int, default=5000, help="plain objects in the scene")
    given = parser.parse_args()
    package = extension()
    package.register()
    atexit.register(package.unregister)
    base, overlay = (import_module(f"{PACKAGE}.addon.{name}") for name in ("operators.base", "ui.overlay"))
    rows = [measure(base, overlay, count, given.objects) for count in given.drawings]
    print("drawings  first s  again s   step s  actions  markers  frame ms redraw ms polls ms  bind s unbind s")
    print("\n".join(rows))


if __name__ == "__main__":
    main()
