"""The demo: a drawn letter comes in, its animated and certified cages go out, with a picture of how they came about.

Run as ``python examples/demo.py`` or ``make demo``; writes build/demo/letter_a.blend and build/demo/letter_a.png.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import bpy
import numpy as np

from check_animation import check_animation
from extension import registered
from picture import Fill, Outline, Panel, colour, render

HERE = Path(__file__).resolve().parent
DRAWING = HERE / "letter_a.svg"
OUTPUT = HERE.parent / "build" / "demo"
LEVELS = "64, 24"
FLOW_POSES = 6  # poses that show how the drawing shrinks

BODY, INK, TRACE = colour("#d3dce8"), colour("#27364b"), colour("#8796ab")
COARSE, CAGES = (
    colour("#d55e00"),
    (colour("#0072b2"), colour("#009e73")),
)  # after Okabe and Ito: also for the colour-blind
LINE, FINE_LINE, DOT = 0.006, 0.0022, 0.010  # widths and radius, in widths of a panel


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


def panels(fine: bpy.types.Object, cages: list[bpy.types.Object]) -> list[Panel]:
    """Input, flow and result, read from the animation."""
    first = cages[0]
    start, inside = first["nested_cages_flow_start"], first["nested_cages_reinflation_start"]
    end = cages[-1]["nested_cages_end"]
    drawing, coarse = loops_at(fine, start), Outline(loops_at(first, start), COARSE, LINE, DOT)
    shrunk = loops_at(fine, inside)
    trace = [Outline(loops_at(fine, frame), TRACE, FINE_LINE) for frame in np.linspace(start, inside, FLOW_POSES)[:-1]]
    home = loops_at(fine, end)
    result = [
        Outline(loops_at(cage, end), paint, LINE, DOT)
        for cage, paint in zip(reversed(cages), reversed(CAGES), strict=True)
    ]
    return [
        Panel("a drawing and a coarse mesh", [Fill(drawing, BODY), Outline(drawing, INK, LINE), coarse]),
        Panel("the drawing shrinks into it", [Fill(shrunk, BODY), *trace, Outline(shrunk, INK, LINE), coarse]),
        Panel("and pushes it out to a cage, twice", [Fill(home, BODY), Outline(home, INK, LINE), *result]),
    ]


def main() -> int:
    began = time.monotonic()
    OUTPUT.mkdir(parents=True, exist_ok=True)
    blend, picture = OUTPUT / "letter_a.blend", OUTPUT / "letter_a.png"
    drawing = import_drawing()
    with registered():
        bpy.ops.object.nested_cages_generate(levels=LEVELS)
        collection = next(item for item in bpy.data.collections if "nested_cages_source" in item)
        fine, *cages = sorted(collection.objects, key=lambda item: item["nested_cages_level"])
        bpy.context.scene.frame_set(bpy.context.scene.frame_start)
        bpy.ops.wm.save_as_mainfile(filepath=str(blend), compress=True)

    outcome = check_animation(bpy.context.scene)
    render(picture, panels(fine, cages))

    print()
    print(f"{drawing.name}: {len(fine.data.vertices)} vertices")
    for cage in cages:
        print(f"{cage.name}: {len(cage.data.vertices)} vertices, frames {cage['nested_cages_flow_start']} to", end=" ")
        print(f"{cage['nested_cages_end']}, {cage['nested_cages_seconds']:.2f} s. {cage['nested_cages_certificate']}.")
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
        print(f"Wrote {path.relative_to(HERE.parent)}")
    print(f"Done in {time.monotonic() - began:.0f} s")
    return int(bool(outcome.problems))


if __name__ == "__main__":
    sys.exit(main())
