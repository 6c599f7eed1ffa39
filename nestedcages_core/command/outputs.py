"""Output: cages as SVG and GeoJSON, and the report as JSON."""

from __future__ import annotations

import json
import sys
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
from .options import STEM, STREAM, WRITTEN
from .progress import STANDARD_OUTPUT
from .sources import DOWN, Source, is_up

REPORT_FORMAT, REPORT_VERSION = "nested-cages report", 1
"""Identifies the reports."""


def targets(paths: Sequence[str], source: Source) -> dict[str, str]:
    """The files to write for a source, with their formats: by extension; SVG of a drawing on the standard output."""
    stem = "stdin" if source.path == STREAM else Path(source.path).stem
    own = "svg" if source.kind == "drawing" else "geojson"
    return {path.replace(STEM, stem): own if path == STREAM else WRITTEN[Path(path).suffix.lower()] for path in paths}


def text_of(result: Result, kind: str, *, flip_y: bool, pieces: int | None) -> str:
    """The text of an output. Raises NestedCagesError where a map is to be turned over."""
    if kind == "svg":
        return _svg(result)
    height, pixels = _turn(result.source, flip_y)
    features = [_feature(each, k, level, height) for each in result.made for k, level in enumerate(each.levels, 1)]
    return to_geojson(features, indent=1, crs=result.source.crs, pixels=pixels, pieces=pieces)


def frames_of(results: Sequence[Result], *, flip_y: bool, pieces: int | None) -> str:
    """The cages of several pictures, as frames at the times 0, 1, …, with corresponding vertices in the same order.

    Raises NestedCagesError where a picture lacks cages, or the pictures are to be turned over and differ in size.
    """
    counts = [len(result.made[0].levels) if result.made else 0 for result in results]
    missing = [Path(result.source.path).name for result, n in zip(results, counts, strict=True) if n < max(counts)]
    if missing or not max(counts):
        raise invalid_file(f"not written, since {', '.join(missing or ['every picture'])} lacks cages.")
    same = all(result.source.pixels == results[0].source.pixels for result in results)
    if flip_y and not same:
        raise invalid_file("the pictures differ in size, so their frames cannot be turned over together.")
    height, pixels = _turn(results[0].source, flip_y) if same else (None, DOWN)
    rows = []
    for number in range(max(counts)):
        levels = [result.made[0].levels[number] for result in results]
        cages = corresponding([level.cage for level in levels])
        rows.append(
            [
                _feature(result.made[0], number + 1, level, height, cage, time)
                for time, (result, level, cage) in enumerate(zip(results, levels, cages, strict=True))
            ]
        )
    frames = [feature for frame in zip(*rows, strict=True) for feature in frame]
    return to_geojson(frames, indent=1, pixels=pixels, pieces=pieces)


def _turn(source: Source, flip_y: bool) -> tuple[float | None, Mapping[str, Any] | None]:
    """The height at half of which y turns over, None for not at all, and how coordinates lie then.

    Raises NestedCagesError for a map.
    """
    if not flip_y:
        return None, source.pixels
    if source.pixels is None:
        raise invalid_file("A map has the north up; --flip-y is for drawings and pictures.")
    turned = "down" if is_up(source.pixels) else "up"
    return float(source.pixels.get("height", 0.0)), {**source.pixels, "y": turned}


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


def report(entries: Sequence[Mapping[str, Any]]) -> str:
    """The report on all files as JSON."""
    return json.dumps({"format": REPORT_FORMAT, "version": REPORT_VERSION, "inputs": list(entries)}, indent=1)


def entry(result: Result, written: Sequence[str], errors: Sequence[str]) -> dict[str, Any]:
    """The report's entry for a file."""
    source = result.source
    return {
        "file": source.path,
        "kind": source.kind,
        "notes": list(source.notes),
        "errors": list(errors),
        "shapes": [
            {
                "name": each.shape.name,
                "id": each.shape.id,
                "vertices": len(each.fine.vertices),
                "loops": len(each.fine.loops),
                "levels": [_measures(level) for level in each.levels],
            }
            for each in result.made
        ],
        "written": list(written),
    }


def table(entries: Sequence[Mapping[str, Any]]) -> str:
    """One line per file of the report: shapes, vertices, those of the levels, excess at most, seconds, failures."""
    rows = [("file", "shapes", "vertices", "cages", "excess", "seconds", "")]
    for said in entries:
        shapes, failed = said["shapes"], len(said["errors"])
        count = max((len(shape["levels"]) for shape in shapes), default=0)
        levels = [[shape["levels"][k] for shape in shapes if k < len(shape["levels"])] for k in range(count)]
        rows.append(
            (
                said["file"],
                str(len(shapes)),
                str(sum(shape["vertices"] for shape in shapes)),
                ", ".join(str(sum(cage["vertices"] for cage in level)) for level in levels),
                ", ".join(f"{100.0 * max(cage['excess'] for cage in level):.3g} %" for level in levels),
                f"{sum(cage['seconds'] for level in levels for cage in level):.1f}",
                f"{failed} failed" if failed else "",
            )
        )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows)
    return "\n".join(lines)


def _measures(level: Level) -> dict[str, Any]:
    said = level.report
    return {
        "vertices": len(level.cage.vertices),
        **{name: bool(getattr(said, name)) for name in ("strict", "simple")},
        **{name: float(getattr(said, name)) for name in ("clearance", "wanted_clearance", "excess")},
        "grid": said.grid,
        "start": said.start,
        "iterations": dict(said.iterations),
        "seconds": sum(said.seconds.values()),
        "filled": list(said.lost.filled),
        "joined": [list(loops) for loops in said.lost.joined],
        "notes": list(said.notes),
    }


def _svg(result: Result) -> str:
    """The shapes and their cages in the frame of the input: the page, the pixels, or a map with north up."""
    meshes: dict[str, Mesh] = {}
    levels: list[int] = []
    for number, each in enumerate(result.made):
        prefix = f"{number}-" if len(result.made) > 1 else ""
        meshes[f"{prefix}drawing"] = each.fine
        meshes.update({f"{prefix}cage-{k}": level.cage for k, level in enumerate(each.levels, 1)})
        levels += [0, *(-k if level.inside else k for k, level in enumerate(each.levels, 1))]
    return to_svg(meshes, frame=result.source.frame, levels=levels, y_up=is_up(result.source.pixels))


def _feature(
    made: Made, number: int, level: Level, height: float | None, cage: Mesh | None = None, time: int | None = None
) -> Feature:
    """A level as a feature, turned over at half of a height; cage: the same with its vertices in another order."""
    mesh = level.cage if cage is None else cage
    mesh = mesh if height is None else turned_over(mesh, height)
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
