"""All ways to bind a drawing in Blender on every shape: errors at rest and under affine poses, and the time to bind.

    python benchmarks/binding.py --picture build/binding.png

Needs Blender as a Python module (bpy) and matplotlib; the picture is a bent glyph by each, as Blender evaluates it.
`--data FOLDER` takes your own shapes, pairs of files `name_V.csv` and `name_E.csv`.
"""

from __future__ import annotations

import argparse
import importlib.util
import sys
import time
from importlib import import_module
from types import ModuleType
from typing import Any

import bpy
import numpy as np

from bent import BENT, arguments, bend, draw, left_outside
from clone import ROOT
from data import shape

PACKAGE = "nested_cages_extension"  # any name: Blender gives extensions names of its own


def extension() -> ModuleType:
    """The root package as Blender's extension."""
    spec = importlib.util.spec_from_file_location(PACKAGE, ROOT / "__init__.py", submodule_search_locations=[str(ROOT)])
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = module
    spec.loader.exec_module(module)
    return module


def scene(fine: Any, cage: Any) -> tuple[Any, Any]:
    """An empty scene with the drawing as a wire and its cage as filled faces."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    filling = import_module(f"{PACKAGE}.addon.scene.filling")
    wire = bpy.data.meshes.new("Fine")
    wire.from_pydata([(*point, 0.0) for point in fine.vertices.tolist()], fine.edges.tolist(), [])
    corners = np.column_stack([cage.vertices, np.zeros(len(cage.vertices))])
    data = filling.filled("Cage", corners, cage)
    made = [bpy.data.objects.new("Fine", wire), bpy.data.objects.new("Cage", data)]
    for obj in made:
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return made[0], made[1]


def main() -> None:
    given, names = arguments(__doc__)
    package = extension()
    package.register()
    try:
        run(names, given)
    finally:
        package.unregister()  # some versions of bpy hang at exit otherwise


def run(names: list[str], given: argparse.Namespace) -> None:
    core = import_module(f"{PACKAGE}.nestedcages_core")
    following = import_module(f"{PACKAGE}.addon.binding.deform_modifiers")
    print(f"{'shape':12s} {'bound by':20s} {'at rest':>9s} {'affine':>9s} {'seconds':>8s}")
    bent = {}
    for name in names:
        fine = shape(name, given.data)
        fine = core.Mesh(fine.vertices, fine.edges)  # as the extension's own core knows it
        cage = core.nested_cages(fine, [given.vertices]).cages[0]
        for method, kind in following.NAMES.items():
            drawing, control = scene(fine, cage)
            began = time.perf_counter()
            bound = following.attach(bpy.context, drawing, control, method)
            seconds = time.perf_counter() - began
            rest, affine = following.measure(bpy.context, drawing, control) if bound else (np.nan, np.nan)
            print(f"{name:12s} {kind:20s} {rest:9.1e} {affine:9.1e} {seconds:8.2f}", flush=True)
            if name == BENT and bound:
                posed = bend(cage, fine.vertices.min(axis=0))
                control.data.vertices.foreach_set("co", np.column_stack([posed, np.zeros(len(posed))]).ravel())
                control.data.update()
                points = following.evaluated_points(bpy.context, drawing)[:, :2]
                moved, around = fine.moved(points), cage.moved(posed)
                bent[f"{kind}, outside: {left_outside(moved, around)}"] = (moved, around)
    if given.picture and bent:
        draw(bent, given.picture)


if __name__ == "__main__":
    main()
