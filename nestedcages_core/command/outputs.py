"""Output: cages as SVG and GeoJSON, and the report as JSON."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import invalid_file
from ..formats import Feature, measures, to_geojson, to_svg, write_files
from ..formats.decimals import turned_over
from ..formats.pictures import corresponding
from ..geometry.mesh import Mesh
from ..levels import Level
from .making import Made, Result
from .options import STREAM
from .printing import STANDARD_OUTPUT
from .sources import DOWN, Source


def svg_of(result: Result) -> str:
    """The shapes and their cages in the frame of the input: the page, the pixels, or a map with north up."""
    meshes, levels = dict[str, Mesh](), list[int]()
    for number, each in enumerate(result.made):
        prefix = f"{number}-" if len(result.made) > 1 else ""
        meshes[f"{prefix}drawing"] = each.fine
        meshes |= {f"{prefix}cage-{k}": level.cage for k, level in enumerate(each.levels, 1)}
        levels += [0, *(-k if level.inside else k for k, level in enumerate(each.levels, 1))]
    return to_svg(meshes, frame=result.source.frame, levels=levels, y_up=result.source.y_up)


def geojson_of(result: Result, given: Namespace) -> str:
    """A feature for each cage. Raises NestedCagesError where a map is to be turned over."""
    height, pixels = _turn(result.source, given)
    features = [_feature(each, k, level.cage, height) for each in result.made for k, level in enumerate(each.levels, 1)]
    return to_geojson(features, indent=1, crs=result.source.crs, pixels=pixels, pieces=given.pieces)


def frames_of(results: Sequence[Result], given: Namespace) -> str:
    """The cages of several pictures, as frames at the times 0, 1, …, with corresponding vertices in the same order.

    Raises NestedCagesError where a picture lacks cages, or the pictures are to be turned over and differ in size.
    """
    counts = [len(result.made[0].levels) if result.made else 0 for result in results]
    missing = [Path(result.source.path).name for result, n in zip(results, counts, strict=True) if n < max(counts)]
    if missing or not max(counts):
        raise invalid_file(f"not written, since {', '.join(missing or ['every picture'])} lacks cages.")
    whole = results[0].source
    if any(result.source.pixels != whole.pixels for result in results):
        if given.flip_y:
            raise invalid_file("the pictures differ in size, so their frames cannot be turned over together.")
        whole = Source(whole.path, whole.kind, pixels=DOWN)
    height, pixels = _turn(whole, given)
    made = [result.made[0] for result in results]
    rows = [corresponding([each.levels[k].cage for each in made]) for k in range(max(counts))]
    frames = zip(made, zip(*rows, strict=True), strict=True)
    features = [
        _feature(each, k, cage, height, time)
        for time, (each, cages) in enumerate(frames)
        for k, cage in enumerate(cages, 1)
    ]
    return to_geojson(features, indent=1, pixels=pixels, pieces=given.pieces)


def _turn(source: Source, given: Namespace) -> tuple[float | None, Mapping[str, Any] | None]:
    """The height at half of which y turns over, None for not at all, and how coordinates lie then."""
    if not given.flip_y:
        return None, source.pixels
    if source.pixels is None:
        raise invalid_file("A map has the north up; --flip-y is for drawings and pictures.")
    return float(source.pixels.get("height", 0.0)), {**source.pixels, "y": "down" if source.y_up else "up"}


def _feature(made: Made, number: int, cage: Mesh, height: float | None, time: int | None = None) -> Feature:
    """A cage as a feature, turned over at half of a height."""
    level, mesh = made.levels[number - 1], cage if height is None else turned_over(cage, height)
    properties = {
        **measures(mesh),
        **made.shape.properties,
        **({} if time is None else {"time": time}),
        "level": -number if level.inside else number,
        "vertices": len(mesh.vertices),
        "excess": level.report.excess,
        "clearance": level.report.clearance,
    }
    return Feature(mesh, properties, made.shape.id if time is None and len(made.levels) == 1 else None)


def put(texts: Mapping[str, str]) -> None:
    """Write files as one unit; after them the standard output."""
    write_files({path: text for path, text in texts.items() if path != STREAM})
    if STREAM not in texts:
        return
    if sys.stdout is None or sys.stdout.closed:
        raise invalid_file("The standard output is closed; name a file.")
    try:
        sys.stdout.buffer.write(texts[STREAM].encode("utf-8"))
        sys.stdout.buffer.flush()
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), STANDARD_OUTPUT) from error


def entry(result: Result, written: Sequence[str], errors: Sequence[str]) -> dict[str, Any]:
    """The report's entry for a file."""
    shapes = [
        {
            "name": each.shape.name,
            "id": each.shape.id,
            "vertices": len(each.fine.vertices),
            "loops": len(each.fine.loops),
            "levels": [_measures(level) for level in each.levels],
        }
        for each in result.made
    ]
    source = result.source
    about = {"file": source.path, "kind": source.kind, "notes": [*source.notes], "errors": [*errors]}
    return {**about, "shapes": shapes, "written": [*written]}


def _measures(level: Level) -> dict[str, Any]:
    report = level.report
    return {
        "vertices": len(level.cage.vertices),
        **{name: bool(getattr(report, name)) for name in ("strict", "simple")},
        **{name: float(getattr(report, name)) for name in ("clearance", "wanted_clearance", "excess")},
        "grid": report.grid,
        "start": report.start,
        "iterations": dict(report.iterations),
        "seconds": sum(report.seconds.values()),
        "filled": list(report.lost.filled),
        "joined": [list(loops) for loops in report.lost.joined],
        "notes": list(report.notes),
    }


def report(entries: Sequence[Mapping[str, Any]]) -> str:
    """The report on all files as JSON."""
    return json.dumps({"format": "nested-cages report", "version": 1, "inputs": entries}, indent=1)


def summary(result: Result, errors: Sequence[str]) -> str:
    """A line on a file: shapes, vertices, those of the levels together, the largest excess of each, failures."""
    shapes = [each.fine for each in result.made]
    words = [f"{len(shapes)} shapes, {sum(len(mesh.vertices) for mesh in shapes)} vertices"]
    for k in range(max((len(each.levels) for each in result.made), default=0)):
        levels = [each.levels[k] for each in result.made if k < len(each.levels)]
        count, most = sum(len(level.vertices) for level in levels), max(level.excess for level in levels)
        words.append(f"level {k + 1}: {count} vertices, excess at most {100.0 * most:.3g} %")
    return f"{result.source.path}: {'; '.join([*words, *([f'{len(errors)} failed'] if errors else [])])}"
