"""The demo: a drawn letter comes in, its animated and certified cages go out, with a picture of how they came about.

Run as ``python examples/demo.py`` or ``make demo``; writes build/demo/letter_a.blend and build/demo/letter_a.png, or
the same into another folder: ``python examples/demo.py FOLDER``.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from extension import PACKAGE, ROOT, registered
from picture import Panel, Shape, extent, render

DRAWING = ROOT / "examples" / "letter_a.svg"
LEVELS = "32, 20"
CLEARANCE = 0.004  # metres; large enough to see the gaps in the picture
FLOW_POSES = 5  # poses that show how the drawing shrinks

BODY, INK, GHOST, TRACE = "#c3cfdf", "#27364b", "#eef2f7", "#7c8ba1"
# Lines after Okabe and Ito, also for the colour-blind, and the same in pale for areas.
COARSE, CAGES, CAGE_AREAS = "#d55e00", ("#0072b2", "#009e73"), ("#dcecf8", "#e0f4ec")
LINE, THIN_LINE, DOT = 0.006, 0.0026, 0.010  # widths and radius, in widths of a panel


def drawn_cages() -> Any:
    """The drawing in an otherwise empty scene, and its cages, while the extension is registered."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_curve.svg(filepath=str(DRAWING))
    (drawing,) = bpy.data.objects
    drawing.name = "Letter A"
    drawing.scale = (10.0, 10.0, 10.0)  # drawings come in millimetres; a metre is easier to look at
    return import_module(PACKAGE).cages([drawing], LEVELS, clearance=CLEARANCE)[0]


def loops_at(item: bpy.types.Object, frame: float) -> list[np.ndarray]:
    """The closed loops (k, 2) of a mesh object as Blender shows it on a frame, in the plane of the scene."""
    bpy.context.scene.frame_set(int(frame), subframe=frame % 1)
    mesh = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    onward = dict(edge.vertices for edge in mesh.edges)
    points = np.array([item.matrix_world @ vertex.co for vertex in mesh.vertices])[:, :2]
    loops = []
    while onward:
        loop = [onward.popitem()[1]]
        while loop[-1] in onward:
            loop.append(onward.pop(loop[-1]))
        loops.append(points[loop])
    return loops


def panels(fine: bpy.types.Object, cages: list[bpy.types.Object], frames: list[tuple[int, ...]]) -> list[Panel]:
    """Input, flow and result, read from the animation."""
    (start, inside, *_), end = frames[0], frames[-1][-1]
    drawing, shrunk, home = (loops_at(fine, frame) for frame in (start, inside, end))
    mesh = Shape(loops_at(cages[0], start), COARSE, LINE, DOT)
    flow = [Shape(loops_at(fine, frame), TRACE, THIN_LINE) for frame in np.linspace(start, inside, FLOW_POSES)[:-1]]
    results = [loops_at(cage, end) for cage in cages]
    areas = [Shape(loops, area) for loops, area in zip(results, CAGE_AREAS, strict=True)]
    lines = [Shape(loops, line, LINE, DOT) for loops, line in zip(results, CAGES, strict=True)]
    bodies = [[Shape(loops, BODY), Shape(loops, INK, LINE)] for loops in (drawing, shrunk, home)]
    return [
        Panel("a drawing and a coarse mesh", [*bodies[0], mesh]),
        Panel("the drawing shrinks into it", [Shape(drawing, GHOST), *flow, *bodies[1], mesh]),
        Panel("and grows back, inside two cages", [*areas[::-1], *bodies[2], *lines]),
    ]


def main(arguments: list[str]) -> int:
    began = time.monotonic()
    output = Path(arguments[0]).resolve() if arguments else ROOT / "build" / "demo"
    output.mkdir(parents=True, exist_ok=True)
    blend, picture = output / "letter_a.blend", output / "letter_a.png"
    with registered():
        made = drawn_cages()
        fine, cages, certificates = made.fine, list(made), made.certificates
        bpy.context.scene.frame_set(bpy.context.scene.frame_start)
        bpy.ops.wm.save_as_mainfile(filepath=str(blend), compress=True)
    shown = panels(fine, cages, [certificate.frames for certificate in certificates])
    render(picture, shown, extent(shown))
    print(f"\nLetter A: {len(fine.data.vertices)} vertices")
    for cage, certificate in zip(cages, certificates, strict=True):
        print(f"{cage.name}: {len(cage.data.vertices)} vertices, frames {certificate.frames[0]} to", end=" ")
        print(f"{certificate.frames[-1]}, {certificate.seconds:.2f} s. {certificate.sentence}.", flush=True)
    checked = subprocess.run([sys.executable, "-m", "nestedcages_core", "check", blend], cwd=ROOT, check=False)
    for path in (blend, picture):
        print(f"Wrote {os.path.relpath(path)}")
    print(f"Done in {time.monotonic() - began:.0f} s")
    return checked.returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
