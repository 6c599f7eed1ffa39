"""Blender: many sets of cages, panels and update handlers with them, a large animation, binding; needs bpy.

Everything is asked for by operators, as a user does. CPU seconds, or milliseconds where the table says so.
"""

from __future__ import annotations

import importlib.util
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import cache
from inspect import isfunction
from pathlib import Path
from types import MethodType
from typing import Any

import numpy as np

from common import Options, Server, parts, table

PACKAGE = "nested_cages_extension"
"""Any name: Blender gives extensions names of its own."""
DRAWINGS, OBJECTS, REDRAWS = (25, 100, 200), 5000, 10
"""Sets in a scene, plain objects beside them, and repetitions of what is fast."""
VERTICES, LEVELS, PER_ROW = 24, "12, 6", 20
LARGE, FRAMES = 10_000, 24
"""Vertices of a large drawing, and poses of a bound one."""
LIMBS = (
    ((0.0, 0.2), (0.0, 1.0), 0.38), ((0.0, 1.2), (0.0, 1.5), 0.1), ((0.0, 1.62), (0.0, 1.75), 0.3),
    ((-0.1, 1.7), (-0.1, 1.71), 0.04), ((0.1, 1.7), (0.1, 1.71), 0.04), ((-0.35, 1.2), (-0.95, 1.15), 0.12),
    ((-0.95, 1.15), (-1.5, 1.1), 0.1), ((-1.55, 1.1), (-1.7, 1.1), 0.12), ((0.35, 1.2), (0.95, 1.15), 0.12),
    ((0.95, 1.15), (1.5, 1.1), 0.1), ((-0.22, 0.0), (-0.28, -1.2), 0.15), ((0.22, 0.0), (0.28, -1.2), 0.15),
)  # fmt: skip
"""Ends and radius of each limb of a figure 3.5 high."""


# What runs in a server, with the add-on of this commit or another one


@cache
def blender(tree: str) -> Any:
    """The module bpy with the add-on of a checkout."""
    import bpy

    path = Path(tree) / "__init__.py"
    spec = importlib.util.spec_from_file_location(PACKAGE, path, submodule_search_locations=[tree])
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = module
    spec.loader.exec_module(module)
    module.register()
    return bpy


class Anything:
    """Stands for the layout of a panel: takes every call, and every value of a property."""

    def __getattr__(self, name: str) -> Anything:
        return self

    def __call__(self, *arguments: object, **named: object) -> Anything:
        return self

    def __setattr__(self, name: str, value: object) -> None:
        pass

    def __iter__(self) -> Iterator[Anything]:
        return iter((self, self))  # a header and a body


class Drawn:
    """Stands for a panel."""

    layout = Anything()

    def __init__(self, kind: type) -> None:
        self.kind = kind

    def __getattr__(self, name: str) -> Any:
        found = getattr(self.kind, name)
        return MethodType(found, self) if isfunction(found) else found


def seconds(work: Callable[[], Any]) -> float:
    """CPU seconds of a call."""
    before = time.process_time()
    work()
    return time.process_time() - before


def milliseconds(work: Callable[[], Any]) -> float:
    """The median of some calls."""
    return 1e3 * float(np.median([seconds(work) for _ in range(REDRAWS)]))


def outline(bpy: Any, name: str, points: np.ndarray) -> Any:
    """A selected mesh object with a closed outline (n, 2)."""
    mesh, ring = bpy.data.meshes.new(name), np.arange(len(points))
    mesh.from_pydata([(x, y, 0.0) for x, y in points], np.column_stack([ring, np.roll(ring, -1)]).tolist(), [])
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    made.select_set(True)
    bpy.context.view_layer.objects.active = made
    return made


def select(bpy: Any, objects: list[Any]) -> None:
    """Selects these alone; the last one is active."""
    for each in bpy.context.selected_objects:
        each.select_set(False)
    for each in objects:
        each.select_set(True)
    bpy.context.view_layer.objects.active = objects[-1]


def kinds(base: type) -> list[type]:
    """All classes of the add-on below one of Blender's."""
    found, own = [base], list[type]()
    while found:
        found += (kind := found.pop()).__subclasses__()
        own += [kind] if kind.__module__.startswith(PACKAGE) and hasattr(kind, "bl_rna") else []
    return own


def panels(bpy: Any) -> None:
    """Draw all that the add-on shows now."""
    for kind in kinds(bpy.types.Panel):
        if not hasattr(kind, "poll") or kind.poll(bpy.context):
            Drawn(kind).draw(bpy.context)


def sets(tree: str, count: int, objects: int) -> list[str]:
    """What a scene with so many sets of cages costs."""
    bpy = blender(tree)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    plain = bpy.data.objects.new("Plain", None)
    for each in (plain, *(bpy.data.objects.new("Plain", None) for _ in range(objects))):
        bpy.context.scene.collection.objects.link(each)
    turns, drawings = np.linspace(0.0, 2.0 * np.pi, VERTICES, endpoint=False), []
    for number in range(count):
        radius = np.where(np.arange(VERTICES) % 2, 0.5, 1.0) * (1.0 + 0.2 * np.sin(number + np.arange(VERTICES)))
        drawings.append(outline(bpy, f"Drawing {number}", (radius * [np.cos(turns), np.sin(turns)]).T))
        drawings[-1].location = (3.0 * (number % PER_ROW), 3.0 * (number // PER_ROW), 0.0)
    select(bpy, drawings)
    times = [seconds(lambda: bpy.ops.object.nested_cages_generate(levels=LEVELS))]
    select(bpy, drawings)
    times.append(seconds(lambda: bpy.ops.object.nested_cages_generate(levels=LEVELS)))
    with tempfile.TemporaryDirectory() as folder:
        times.append(seconds(lambda: bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/sets.blend", copy=True)))
    frames = iter(range(2, 2 + REDRAWS))
    shown = [milliseconds(lambda: bpy.context.scene.frame_set(next(frames)))]

    def move() -> None:
        plain.location.x += 1.0
        bpy.context.view_layer.update()

    with_handlers = milliseconds(move)
    handlers = (getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers))
    kept = [(each, list(each)) for each in handlers if isinstance(each, list)]
    for each, functions in kept:
        each[:] = [function for function in functions if not (function.__module__ or "").startswith(PACKAGE)]
    shown.append(with_handlers - milliseconds(move))
    for each, functions in kept:
        each[:] = functions
    for some in (drawings[:1], drawings):
        select(bpy, some)
        shown.append(milliseconds(lambda: panels(bpy)))
    select(bpy, drawings)
    times += [seconds(lambda: bpy.ops.object.nested_cages_bind())]
    return [*(f"{each:.2f}" for each in times), *(f"{each:.2f}" for each in shown)]


def large(tree: str, vertices: int) -> list[str]:
    """A large drawing with its animation: the operator, and what of it is not the method itself."""
    bpy = blender(tree)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    turns = np.linspace(0.0, 2.0 * np.pi, vertices, endpoint=False)
    points = (1.0 + 0.2 * np.cos(9.0 * turns)) * np.array([np.cos(turns), np.sin(turns)])
    drawing = outline(bpy, "Large", points.T)
    stored = np.array([vertex.co[:2] for vertex in drawing.data.vertices], dtype=float)
    whole = seconds(lambda: bpy.ops.object.nested_cages_generate(levels="64"))
    core = importlib.import_module(f"{PACKAGE}.nestedcages_core")
    method = seconds(
        lambda: core.nested_cages(stored, 64, clearance=1.0000001e-5 * float(np.hypot(*np.ptp(stored, 0))))
    )
    keys = sum(len(mesh.shape_keys.key_blocks) for mesh in bpy.data.meshes if mesh.shape_keys)
    return [str(keys), f"{whole:.2f}", f"{method:.2f}", f"{whole - method:.2f}"]


def bound(tree: str, vertices: int) -> list[str]:
    """A figure of twelve parts in one cage: seconds to make and bind it, milliseconds of a pose."""
    bpy = blender(tree)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    half = np.linspace(-np.pi / 2.0, np.pi / 2.0, vertices // len(LIMBS) // 2)
    for number, (start, end, radius) in enumerate(LIMBS):
        a, b = np.array(start), np.array(end)
        turn = np.arctan2(*(b - a)[::-1])
        ends = ((b, turn + half), (a, turn + np.pi + half))
        arcs = [c + radius * np.column_stack([np.cos(t), np.sin(t)]) for c, t in ends]
        outline(bpy, f"Part {number}", np.concatenate(arcs))
    made = seconds(lambda: bpy.ops.object.nested_cages_generate(levels="31", together=True, show_flow=False))
    cage = next(each for each in bpy.data.objects if each.name.endswith("Cage 1"))
    bind = seconds(lambda: bpy.ops.object.nested_cages_bind())
    rest = np.array([vertex.co for vertex in cage.data.vertices])
    arm = rest[:, 0] < -0.9

    def pose(turn: float) -> None:
        bent, (c, s) = rest.copy(), (np.cos(turn), np.sin(turn))
        bent[arm, :2] = (rest[arm, :2] - (-0.95, 1.15)) @ [[c, s], [-s, c]] + (-0.95, 1.15)
        cage.data.vertices.foreach_set("co", bent.astype(np.float32).ravel())
        cage.data.update()
        bpy.context.view_layer.update()

    pose(0.0)
    posed = seconds(lambda: [pose(np.pi / 3.0 * frame / FRAMES) for frame in range(FRAMES)])
    return [str(len(rest)), f"{made:.2f}", f"{bind:.2f}", f"{1e3 * posed / FRAMES:.1f}"]


# Tables


def run(options: Options) -> str:
    """Sets, a large drawing, and binding."""
    if importlib.util.find_spec("bpy") is None:
        return "Blender as a Python module (bpy) is missing."
    rows: dict[str, list[list[object]]] = {"sets": [], "large": [], "bound": []}
    sizes: dict[str, list[tuple[int, ...]]] = {
        "sets": [(5, 50)] if options.quick else [(count, OBJECTS) for count in DRAWINGS],
        "large": [(LARGE // 10,)] if options.quick else [(LARGE,)],
        "bound": [(2_000,)] if options.quick else [(20_000,)],
    }
    for commit, tree in options.trees().items():
        for name, many in sizes.items():
            for size in many if options.wants(name) else ():
                with Server(tree, f"blender:{name}") as measure:
                    rows[name].append([commit, size[0], *measure(str(tree), *size)])
    heads = {
        "sets": ("generate", "again", "save", "bind", "frame ms", "handlers ms", "panels ms", "all selected ms"),
        "large": ("keys", "generate", "the method alone", "the rest"),
        "bound": ("cage", "generate", "bind", "pose ms"),
    }
    first = {"sets": "drawings", "large": "vertices", "bound": "vertices"}
    return parts({name: table((name, first[name], *heads[name]), found) for name, found in rows.items() if found})
