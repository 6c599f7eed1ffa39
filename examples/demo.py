"""The demo: a drawn letter comes in, its animated and certified cages go out, with a picture of how they came about.

Run as ``python examples/demo.py`` or ``make demo``; writes build/demo/letter_a.blend and build/demo/letter_a.png, or
the same into another folder: ``python examples/demo.py FOLDER``.
"""

from __future__ import annotations

import os
import sys
import time
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np

from check_animation import check_animation, played
from extension import PACKAGE, registered
from picture import Fill, Outline, Panel, colour, render

HERE = Path(__file__).resolve().parent
DRAWING = HERE / "letter_a.svg"
OUTPUT = HERE.parent / "build" / "demo"
LEVELS = "32, 20"
CLEARANCE = 0.004  # metres; large enough to see the gaps in the picture
FLOW_POSES = 5  # poses that show how the drawing shrinks

BODY, INK, GHOST, TRACE = colour("#c3cfdf"), colour("#27364b"), colour("#eef2f7"), colour("#7c8ba1")
# Lines after Okabe and Ito, also for the colour-blind, and the same in pale for areas.
COARSE, CAGES = colour("#d55e00"), (colour("#0072b2"), colour("#009e73"))
CAGE_AREAS = (colour("#dcecf8"), colour("#e0f4ec"))
LINE, FINE_LINE, DOT = 0.006, 0.0026, 0.010  # widths and radius, in widths of a panel


def import_drawing() -> bpy.types.Object:
    """The drawing as the only object of an empty scene, selected."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_curve.svg(filepath=str(DRAWING))
    (drawing,) = bpy.data.objects
    drawing.name = "Letter A"
    drawing.scale = (10.0, 10.0, 10.0)  # drawings come in millimetres; a metre is easier to look at
    drawing.select_set(True)
    bpy.context.view_layer.objects.active = drawing
    bpy.context.view_layer.update()
    return drawing


def loops_at(item: bpy.types.Object, frame: float) -> list[np.ndarray]:
    """The closed loops (k, 2) of a mesh object as Blender shows it on a frame, in the plane of the scene."""
    bpy.context.scene.frame_set(int(frame), subframe=frame % 1)
    mesh = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    onward = dict(edge.vertices for edge in mesh.edges)
    points = np.array([item.matrix_world @ vertex.co for vertex in mesh.vertices])[:, :2]
    loops: list[np.ndarray] = []
    while onward:
        start, vertex = onward.popitem()
        loop = [start]
        while vertex != start:
            loop.append(vertex)
            vertex = onward.pop(vertex)
        loops.append(points[loop])
    return loops


def panels(fine: bpy.types.Object, cages: list[bpy.types.Object], frames: list[tuple[int, ...]]) -> list[Panel]:
    """Input, flow and result, read from the animation."""
    first = cages[0]
    (start, inside, *_), end = frames[0], frames[-1][-1]
    drawing, shrunk, home = (loops_at(fine, frame) for frame in (start, inside, end))
    coarse = loops_at(first, start)
    polygon = Outline(coarse, COARSE, LINE, DOT)
    trace = [Outline(loops_at(fine, frame), TRACE, FINE_LINE) for frame in np.linspace(start, inside, FLOW_POSES)[:-1]]
    areas: list[Fill | Outline] = []
    lines: list[Fill | Outline] = []
    for cage, line, area in reversed(list(zip(cages, CAGES, CAGE_AREAS, strict=True))):
        loops = loops_at(cage, end)
        areas.append(Fill(loops, area))
        lines.append(Outline(loops, line, LINE, DOT))
    return [
        Panel("a drawing and a coarse mesh", [Fill(drawing, BODY), Outline(drawing, INK, LINE), polygon]),
        Panel(
            "the drawing shrinks into it",
            [Fill(drawing, GHOST), *trace, Fill(shrunk, BODY), Outline(shrunk, INK, LINE), polygon],
        ),
        Panel("and grows back, inside two cages", [*areas, Fill(home, BODY), Outline(home, INK, LINE), *lines]),
    ]


def main(arguments: list[str]) -> int:
    began = time.monotonic()
    output = Path(arguments[0]).resolve() if arguments else OUTPUT
    output.mkdir(parents=True, exist_ok=True)
    blend, picture = output / "letter_a.blend", output / "letter_a.png"
    drawing = import_drawing()
    with registered():
        try:
            bpy.ops.object.nested_cages_generate(levels=LEVELS, clearance=CLEARANCE)
        except RuntimeError as error:  # how a script sees what the operator reports as an error
            print(f"There are no cages: {error}", file=sys.stderr)
            return 1
        (made,) = played()
        certificates = import_module(PACKAGE).CageSet.of(drawing).certificates
        fine, cages = made.fine, made.cages
        bpy.context.scene.frame_set(bpy.context.scene.frame_start)
        bpy.ops.wm.save_as_mainfile(filepath=str(blend), compress=True)

    outcome = check_animation(bpy.context.scene, [made])
    render(picture, panels(fine, cages, made.frames))

    print()
    print(f"{drawing.name}: {len(fine.data.vertices)} vertices")
    for cage, certificate in zip(cages, certificates, strict=True):
        print(f"{cage.name}: {len(cage.data.vertices)} vertices, frames {certificate.frames[0]} to", end=" ")
        print(f"{certificate.frames[-1]}, {certificate.seconds:.2f} s. {certificate.sentence}.")
    for problem in outcome.problems:
        print(problem, file=sys.stderr)
    if outcome.problems:
        print(
            f"The animation does not hold: {len(outcome.problems)} problems in {outcome.poses} poses.", file=sys.stderr
        )
    else:
        print(f"Animation: {outcome.poses} poses on frames and half frames checked: no cage touches what it encloses,")
        print("and on the last frame the fine mesh has the drawing's coordinates, bit by bit.")
    for path in (blend, picture):
        print(f"Wrote {os.path.relpath(path)}")
    print(f"Done in {time.monotonic() - began:.0f} s")
    return int(bool(outcome.problems))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
